"""Pictures on axes of one's own: every function takes `ax`, draws on it and returns it; without it on a new figure.

    figure, (left, right) = pyplot.subplots(1, 2)
    frbcli.draw_orbit(run, ax=left)
    frbcli.draw_waterfall(run, ax=right)
"""

from __future__ import annotations

from matplotlib.axes import Axes

from frbcli.analysis.spectra.spectrum import Direction
from frbcli.linear.bearing_sheet import ECCENTRICITY, BearingSheet
from frbcli.linear.response import Response
from frbcli.linear.stability import Stability
from frbcli.plot.curves import Over, draw_curves, finish
from frbcli.plot.machine.bearing import draw_coefficient
from frbcli.plot.machine.campbell import draw_frequencies
from frbcli.plot.machine.response import draw_amplitude
from frbcli.plot.run.eccentricity import draw_eccentricity
from frbcli.plot.run.film_signals import draw_film_signal
from frbcli.plot.run.orbit import LAST_s, draw_orbits
from frbcli.plot.run.speeds import draw_spectrum_at
from frbcli.plot.signals import ends
from frbcli.plot.spectra.waterfall import DECIBELS, LevelScale, draw_levels, run_spectra
from frbcli.plot.style import NotebookFigure, legend_beside, styled
from frbcli.results.store import Run


def eccentricity(
    run: Run, ax: Axes | None = None, from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Axes:
    """Relative eccentricity of all films from from_time to to_time in s, over time or rotor speed."""
    ax = _axes(ax)
    draw_eccentricity(ax, [run], (), (from_time, to_time), over)
    finish(ax, over)
    legend_beside(ax)
    return ax


def orbit(
    run: Run, ax: Axes | None = None, bearing: str = "", from_time: float | None = None, to_time: float | None = None
) -> Axes:
    """The orbit of the journal of a bearing in its clearance from from_time to to_time in s, by default the last
    0.1 s."""
    ax = _axes(ax)
    end = ends(run)[1] if to_time is None else to_time
    draw_orbits(ax, [run], bearing, (max(end - LAST_s, 0.0) if from_time is None else from_time, end))
    return ax


def waterfall(
    run: Run, ax: Axes | None = None, signal: str = "journal", over: Over = "time", window_s: float | None = None,
    direction: Direction = "x", scale: LevelScale = DECIBELS,
) -> Axes:  # fmt: skip
    """The spectra of a point over time or rotor speed, as waterfall_figure has them, without the scale of colours."""
    ax = _axes(ax)
    draw_levels(ax, run, signal, run_spectra(run, signal, window_s, direction), over, scale=scale)
    return ax


def spectrum(
    run: Run, time_s: float, ax: Axes | None = None, signal: str = "journal", window_s: float | None = None
) -> Axes:
    """Peak amplitudes over frequency of x of a point about a time in s."""
    ax = _axes(ax)
    draw_spectrum_at(ax, run, time_s, run_spectra(run, signal, window_s, "x"), signal)
    return ax


def ring_speed(run: Run, ax: Axes | None = None, over: Over = "time") -> Axes:
    """Speeds of all floating rings in Hz over time or rotor speed."""
    ax = _axes(ax)
    names = [name for name in run.signals if name.startswith("ring_speed")]
    draw_curves(ax, [run], [(name.removesuffix("_Hz"), [run.signal(name)]) for name in names], over, (None, None))
    ax.set_ylabel("ring speed in Hz")
    finish(ax, over)
    legend_beside(ax)
    return ax


def film_signal(run: Run, kind: str, ax: Axes | None = None, part: int = 0, over: Over = "time") -> Axes:
    """A film signal that a run has recorded by `output.signals`; part: 0 and 1 are x and y of "force"."""
    ax = _axes(ax)
    draw_film_signal(ax, [run], kind, part, over)
    finish(ax, over)
    legend_beside(ax)
    return ax


def campbell(found: Stability, ax: Axes | None = None) -> Axes:
    """Damped eigenfrequencies over the rotor speed; filled dots grow."""
    ax = _axes(ax)
    draw_frequencies(ax, [point for point in found.sweep if point.rests])
    ax.set_xlabel("rotor speed in Hz")
    legend_beside(ax)
    return ax


def response(found: Response, ax: Axes | None = None) -> Axes:
    """Amplitudes of all points over the rotor speed, dotted where a whirl grows."""
    ax = _axes(ax)
    draw_amplitude(ax, found)
    legend_beside(ax)
    return ax


def bearing(sheet: BearingSheet, quantity: str = "stiffness", ax: Axes | None = None) -> Axes:
    """ "stiffness" or "damping" of the films over rotor speed or eccentricity."""
    ax = _axes(ax)
    draw_coefficient(ax, sheet, quantity)
    ax.set_xlabel("eccentricity" if sheet.over == ECCENTRICITY else "rotor speed in Hz")
    legend_beside(ax)
    return ax


def _axes(ax: Axes | None) -> Axes:
    """Those that are given, or those of a new figure."""
    if ax is not None:
        return ax
    with styled():
        return NotebookFigure().subplots()
