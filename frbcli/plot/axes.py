"""Pictures on given axes: every function takes `ax`, draws on it and returns it; without `ax` it makes a new figure.

    figure, (left, right) = pyplot.subplots(1, 2)
    frbcli.draw_orbit(run, ax=left, label="35 um")
    frbcli.draw_orbit(other, ax=left, label="40 um")
    frbcli.draw_waterfall(run, ax=right)

What is drawn over other curves has colours of its own, and `label` begins its names in the legend.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, cast

from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from frbcli.analysis.spectrum import Direction
from frbcli.linear.response import Response
from frbcli.linear.sheets.bearing import ECCENTRICITY, BearingSheet
from frbcli.linear.stability import Stability
from frbcli.plot.curves import Over, draw_curves, finish
from frbcli.plot.machine.bearing import draw_coefficient
from frbcli.plot.machine.modes import draw_frequencies
from frbcli.plot.machine.response import draw_amplitude
from frbcli.plot.motion import LAST_s, draw_eccentricity, draw_orbits, draw_quantity
from frbcli.plot.signals import ends
from frbcli.plot.style import BLACK, COLOURS, NotebookFigure, legend_beside, styled
from frbcli.plot.summary import draw_spectrum_at
from frbcli.plot.waterfall import DECIBELS, LevelScale, draw_levels, run_spectra
from frbcli.results.store import Run

PALETTE = [to_hex(colour) for colour in COLOURS if colour != BLACK]  # of curves, not of what is around them


def eccentricity(
    run: Run, ax: Axes | None = None, from_time: float | None = None, to_time: float | None = None,
    over: Over = "time", label: str = "",
) -> Axes:  # fmt: skip
    """Draw the relative eccentricity of all films over time or rotor speed.

    Parameters
    ----------
    run : Run
        A run, see `read_run`, `runup` and `measured_run`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; by default new ones, in the figure `ax.figure`.
    from_time, to_time : float, optional
        Begin and end in s; by default of the whole run.
    over : {"time", "speed"}
        The axis.
    label : str
        Begins the names of the curves in the legend, for several runs on the same axes.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    RunFileError
        If the run holds no samples between these times.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> ax = frbcli.draw_eccentricity(run)  # doctest: +SKIP
    """
    with _overlaid(ax, label) as axes:
        draw_eccentricity(axes, [run], (), (from_time, to_time), over)
        finish(axes, over)
    return axes


def orbit(
    run: Run, ax: Axes | None = None, bearing: str = "", from_time: float | None = None,
    to_time: float | None = None, label: str = "",
) -> Axes:  # fmt: skip
    """Draw the orbit of the journal of a bearing in its clearance.

    Parameters
    ----------
    run, ax, label : as of `draw_eccentricity`
    bearing : str
        Name of the bearing; by default the first.
    from_time, to_time : float, optional
        Begin and end in s; by default the last 0.1 s.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    RunFileError
        If the run lacks the bearing.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> ax = frbcli.draw_orbit(run)  # doctest: +SKIP
    """
    end = ends(run)[1] if to_time is None else to_time
    with _overlaid(ax, label) as axes:
        draw_orbits(axes, [run], bearing, (max(end - LAST_s, 0.0) if from_time is None else from_time, end))
    return axes


def waterfall(
    run: Run, ax: Axes | None = None, signal: str = "journal", over: Over = "time", window_s: float | None = None,
    direction: Direction = "x", scale: LevelScale = DECIBELS,
) -> Axes:  # fmt: skip
    """Draw the spectra of a point over time or rotor speed, without the scale of colours.

    Parameters
    ----------
    run, ax, over : as of `draw_eccentricity`
    signal : str
        The point: "journal", "disk", or the name of a bearing or disk.
    window_s : float, optional
        Length of the windows in s; by default as the ramp asks for.
    direction : {"x", "y", "forward"}
        One coordinate, or the motion that turns with the rotor.
    scale : LevelScale
        Levels in dB or amplitudes in um, their limits, and the lines drawn in.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    InputError
        If the run does not have the point, or is shorter than a window.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> ax = frbcli.draw_waterfall(run, over="speed")  # doctest: +SKIP
    """
    ax = _axes(ax)
    draw_levels(ax, run, signal, run_spectra(run, signal, window_s, direction), over, scale=scale)
    return ax


def spectrum(
    run: Run, time_s: float, ax: Axes | None = None, signal: str = "journal", window_s: float | None = None,
    label: str = "",
) -> Axes:  # fmt: skip
    """Draw the peak amplitudes of x of a point over frequency, about a time.

    Parameters
    ----------
    run, ax, label : as of `draw_eccentricity`
    time_s : float
        The time in s.
    signal : str
        The point: "journal", "disk", or the name of a bearing or disk.
    window_s : float, optional
        Length of the window in s; by default as the ramp asks for.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    InputError
        If the run does not have the point, or is shorter than the window.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> ax = frbcli.draw_spectrum(run, 2.0)  # doctest: +SKIP
    """
    with _overlaid(ax, label) as axes:
        draw_spectrum_at(axes, run, time_s, run_spectra(run, signal, window_s, "x"), signal)
    return axes


def ring_speed(run: Run, ax: Axes | None = None, over: Over = "time", label: str = "") -> Axes:
    """Draw the speeds of all floating rings in Hz over time or rotor speed.

    Parameters
    ----------
    run, ax, over, label : as of `draw_eccentricity`

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    RunFileError
        If the run has no ring that turns.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> ax = frbcli.draw_ring_speed(run)  # doctest: +SKIP
    """
    names = [name for name in run.signals if name.startswith("ring_speed")]
    curves = [(name.removesuffix("_Hz").replace("_", " "), [run.signal(name)]) for name in names]
    with _overlaid(ax, label) as axes:
        draw_curves(axes, [run], curves, over, (None, None))
        axes.set_ylabel("ring speed in Hz")
        finish(axes, over)
    return axes


def film_signal(
    run: Run, kind: str, ax: Axes | None = None, part: int = 0, over: Over = "time", label: str = ""
) -> Axes:
    """Draw a signal of the films that a run has recorded, most of them by `output.signals`.

    Parameters
    ----------
    run, ax, over, label : as of `draw_eccentricity`
    kind : str
        "force", "film-thickness", "power", "torque", "oil-flow", "tilt" or "supply-pressure".
    part : int
        0 and 1 are x and y of "force" and "tilt".

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    RunFileError
        If the run lacks the signal.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> ax = frbcli.draw_film_signal(run, "power")  # doctest: +SKIP
    """
    with _overlaid(ax, label) as axes:
        draw_quantity(axes, [run], kind, part, over)
        finish(axes, over)
    return axes


def campbell(analysis: Stability, ax: Axes | None = None, label: str = "") -> Axes:
    """Draw damped eigenfrequencies in Hz over the rotor speed; filled dots grow.

    Parameters
    ----------
    analysis : Stability
        See `stability`.
    ax, label : as of `draw_eccentricity`

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> ax = frbcli.draw_campbell(frbcli.stability(case))  # doctest: +SKIP
    """
    with _overlaid(ax, label) as axes:
        draw_frequencies(axes, [point for point in analysis.sweep if point.rests])
        axes.set_xlabel("rotor speed in Hz")
    return axes


def response(motion: Response, ax: Axes | None = None, label: str = "") -> Axes:
    """Draw the amplitudes of all points over the rotor speed, dotted where a whirl grows.

    Parameters
    ----------
    motion : Response
        See `response`.
    ax, label : as of `draw_eccentricity`

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> ax = frbcli.draw_response(frbcli.response(case))  # doctest: +SKIP
    """
    with _overlaid(ax, label) as axes:
        draw_amplitude(axes, motion)
    return axes


def bearing(
    sheet: BearingSheet, quantity: str = "stiffness", ax: Axes | None = None, label: str = ""
) -> Axes:
    """Draw stiffness or damping of the films over rotor speed or eccentricity.

    Parameters
    ----------
    sheet : BearingSheet
        See `bearing_sheet` and `sommerfeld_chart`.
    quantity : {"stiffness", "damping"}
        In N/m or N s/m.
    ax, label : as of `draw_eccentricity`

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> ax = frbcli.draw_bearing(frbcli.bearing_sheet(case))  # doctest: +SKIP
    """
    with _overlaid(ax, label) as axes:
        draw_coefficient(axes, sheet, quantity)
        axes.set_xlabel("eccentricity" if sheet.over == ECCENTRICITY else "rotor speed in Hz")
    return axes


@contextmanager
def _overlaid(ax: Axes | None, label: str) -> Iterator[Axes]:
    """The given axes, or axes of a new figure. What is drawn on them within it has the colours that follow after the
    curves before, and names that begin with the label, in a legend."""
    axes = _axes(ax)
    lines, areas = list(axes.lines), list(axes.collections)
    yield axes
    drawn = [line for line in axes.lines if line not in lines]
    filled = [area for area in axes.collections if area not in areas]
    both: list[Any] = [*drawn, *filled]
    named = [each for each in both if not str(each.get_label()).startswith("_")]
    for each in named or (drawn[:1] if label else []):
        name = str(each.get_label())
        each.set_label(label if name.startswith("_") else ", ".join(filter(None, (label, name))))
    before, own = ([colour for colour in PALETTE if colour in map(_colour, each)] for each in (lines, drawn))
    changed = {colour: PALETTE[(len(before) + number) % len(PALETTE)] for number, colour in enumerate(own)}
    if before:
        for line in drawn:
            line.set_color(changed.get(_colour(line), _colour(line)))
        for area in filled:
            for colour in {to_hex(cast("Any", face)) for face in area.get_facecolor()} & set(changed):
                area.set_facecolor(changed[colour])
    legend_beside(axes)


def _colour(line: Line2D) -> str:
    return str(to_hex(cast("Any", line.get_color())))


def _axes(ax: Axes | None) -> Axes:
    """The given axes, or axes of a new figure."""
    if ax is not None:
        return ax
    with styled():
        return NotebookFigure().subplots()
