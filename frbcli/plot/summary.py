"""Summary of a run: eccentricity or distance with its events, waterfall, rotor speed.

Orbits and spectra of a run at chosen moments, side by side.

Speed of floating rings over the rotor speed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from frbcli.analysis.signals import SlicedColumn, films, joined, located, points, speed_at
from frbcli.analysis.spectrum import Spectrogram
from frbcli.analysis.subsynchronous import whirl_names
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case_text
from frbcli.case.run import speed_unit_of
from frbcli.equilibrium.ring_speed import concentric_ratios
from frbcli.errors import InputError
from frbcli.plot.curves import Over, curves_figure, draw_curves
from frbcli.plot.motion import draw_distances, draw_eccentricity, draw_largest
from frbcli.plot.signals import (
    MICRO,
    bearing_of,
    case_tables,
    curve,
    cut,
    ends,
    events,
    extremes,
    heading,
    is_searchable,
    motion,
    shell,
    uncertain_times,
)
from frbcli.plot.style import (
    BAND,
    BLACK,
    BLUE,
    COLOURS,
    GREY,
    MOST_MARKED,
    SKY,
    NotebookFigure,
    draw_bands,
    legend_beside,
    mark_times,
    new_figure,
    orbit_axes,
    set_title,
    styled,
)
from frbcli.plot.waterfall import draw_levels, level_label, orders, reading, run_spectra
from frbcli.results.columns import touching_name
from frbcli.results.container import refuse
from frbcli.results.records import SPEED, Signal, pieces
from frbcli.results.store import Run
from frbcli.units import SpeedUnit

SIGNAL = "journal"
FEWEST_SAMPLES = 64  # for a spectrum; a run that ends before has none

NAMES = {
    "critical-speed": "critical speed",
    "self-excited": "self-excited",
    "onset": "onset of whirl",
    "offset": "end of whirl",
    "lock-in": "lock-in",
    "contact": "contact",
    "clearance-step": "clearance step",
    "loss": "loss",
    "forced": "forced",
    "top-speed": "top speed",
    "standstill": "standstill",
}


def summary_figure(run: Run) -> Figure:
    """Eccentricity, or without films the distance of all points, with the events marked, waterfall of the journal and
    rotor speed over one time axis. Bands about the events are their uncertainties, where the run has them.

    Raises RunFileError if the run holds no samples.
    """
    begin, end = ends(run)
    title, subtitle = heading([run])
    marked = _marks(events(run), speed_unit_of(run))
    words = [subtitle]
    if not run.events and not is_searchable(run):
        words.append("too long for a search for events")
    if len(marked) > MOST_MARKED:
        words.append(f"the first {MOST_MARKED} of {len(marked)} events")
    bands = uncertain_times(run)
    if bands:
        words.append("bands: uncertainty of the events")
    with styled():
        figure = new_figure(title, ", ".join(word for word in words if word), height=7.6)
        above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(3.0, 4.0, 1.4))
        _draw_motion(above, run)
        above.set_xlim(begin, end)
        legend_beside(above)
        if len(run) >= FEWEST_SAMPLES:
            spectra = run_spectra(run, SIGNAL, None, "x")
            mesh = draw_levels(middle, run, SIGNAL, spectra, "time")
            bar = figure.colorbar(mesh, ax=[above, middle, below], location="bottom", shrink=0.6, pad=0.02,
                                  extend="both", aspect=40)  # fmt: skip
            label = level_label(run, SIGNAL).replace("amplitude", "amplitude of the journal")
            bar.set_label(f"{label}; {reading(spectra)}".replace(": ", ":\n"))  # one line is wider than the picture
            bar.outline.set_visible(False)
        _draw_speed(below, run)
        for axes in (above, middle):
            axes.set_xlabel("")
        marked = marked[:MOST_MARKED]
        for axes in (above, middle):
            for time, half in bands:
                axes.axvspan(time - half, time + half, color=GREY, alpha=BAND, linewidth=0.0)
        left_out = mark_times((above, middle), [time for time, _ in marked], [text for _, text in marked])
        if left_out:
            words.append(f"{left_out} of {len(marked)} events have no room for their names")
            set_title(figure, title, ", ".join(word for word in words if word))
    return figure


def _draw_motion(axes: Axes, run: Run) -> None:
    """Eccentricities, of several films the largest ones; without films distances."""
    named = list(films(run.signals))
    if len(named) > 1:
        for film, colour in zip(named, itertools.cycle(COLOURS), strict=False):
            draw_largest(axes, run, film, colour, label=film)
    else:
        (draw_eccentricity if named else draw_distances)(axes, [run])


def _draw_speed(axes: Axes, run: Run) -> None:
    for name, colour in zip(_turning(run), itertools.cycle((GREY, SKY)), strict=False):
        label = ", ".join(word for word in ("ring", name) if word)
        axes.plot(*curve(run, run.signal(joined("ring_speed", name, "Hz"))), color=colour, label=label)
    draw_bands(axes, run.error.get("ring_speed_uncertainty_Hz"))
    axes.plot(*curve(run, run.signal(SPEED)), color=BLACK, label="rotor")
    legend_beside(axes)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time in s")
    axes.yaxis.set_major_locator(MaxNLocator(3))
    axes.set_ylabel("speed in Hz")


def _marks(happened: list[dict[str, Any]], unit: SpeedUnit) -> list[tuple[float, str]]:
    """Time and words of what is marked; of the whirls of floating rings the first onset of each that has a name."""
    marks, known = [], set()
    for event, name in zip(happened, whirl_names(happened), strict=True):
        if not name:
            marks.append((event["t_s"], _words(event, unit)))
        elif event["kind"] == "onset" and name not in known:
            known.add(name)
            shown = name.replace("_i", "$_i$").replace("_o", "$_o$")
            marks.append((event["t_s"], _words(event | {"kind": shown}, unit)))
    return marks


def _words(event: dict[str, Any], unit: SpeedUnit) -> str:
    """Label of an event: kind or who touches what, speed, frequency."""
    film = f" {event['film'].replace('_', ' ')}" if event.get("film") else ""
    name = touching_name(event) or f"{NAMES.get(event['kind'], event['kind'])}{film}"
    ratio = event.get("frequency_ratio")
    share = f", {ratio:.2f}X" if ratio is not None and ratio != 1.0 else ""
    return f"{name}\n{unit.words(event['speed_Hz'], 1)}{share}"


Values = NDArray[np.float64]

TURNS = 12.0  # revolutions of an orbit
LONGEST_s, SHORTEST_s = 0.2, 2e-3
WIDTH, ROW = 7.2, 2.5  # inches
FINE = 40.0  # points of a revolution: through fewer samples a curve would have corners
MARGIN = 12  # samples on either side that values between samples need
REACH, KAISER = 10, 5.0  # samples on either side that give a value between, and the shape of their window
ENLARGED = 0.1  # of the clearance: a smaller orbit is drawn without it
AHEAD = 2.2  # of the rotor speed: up to where a spectrum is drawn
CLEAR = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5}  # behind a name: lines of others
CLOSE, LINE_pt = 0.2, 10.0  # share of an axis within which names stand one below the other, so far apart


def speeds_figure(
    run: Run, times_s: Sequence[float], spectra: Spectrogram, signal: str = "journal",
    words: Callable[[float], str] = "{:.4g} Hz".format,
) -> Figure:  # fmt: skip
    """A row for each of some moments in s: the orbit of the last revolutions until then, and the spectrum of the
    window about it, from the spectra of `run_spectra`; words: of a speed in Hz.

    Raises RunFileError if the run has no samples there.
    """
    with styled():
        figure = NotebookFigure(figsize=(WIDTH, ROW * len(times_s)))
        rows = figure.subplots(len(times_s), 2, squeeze=False, width_ratios=(1.0, 2.0))
        for (left, right), time_s in zip(rows, times_s, strict=True):
            draw_orbit_until(left, run, time_s, signal)
            draw_spectrum_at(right, run, time_s, spectra, signal)
            left.set_title(f"{words(speed_at(run, time_s))}, {time_s:.4g} s")
    return figure


def draw_orbit_until(axes: Axes, run: Run, time_s: float, signal: str = "journal") -> None:
    """The orbit of the last revolutions before a time in s; with the clearance for a journal whose orbit is not too
    small to be seen in it."""
    speed = max(abs(speed_at(run, time_s)), 1e-9)
    begin, end = ends(run)
    until = min(max(time_s, begin + SHORTEST_s), end)
    span = min(max(TURNS / speed, SHORTEST_s), LONGEST_s)
    first, last = cut(run, max(begin, until - span), until)
    times = math.ceil(FINE * span * speed / (last - first))
    x, y = (MICRO * between(part, first, last, times) for part in motion(run, signal))
    axes.plot(x, y, color=BLUE, linewidth=0.8)
    middle, reach = np.zeros(2), float(np.max(np.hypot(x, y)))
    room = shell(run, bearing_of(run, signal)) if located(run, signal)[0] == "journal" else None
    if room is not None:
        radius = MICRO * room
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.0))
        reach = max(reach, radius)
    extent = 0.5 * max(float(np.ptp(x)), float(np.ptp(y)))
    if 0.0 < extent < ENLARGED * reach:
        middle, reach = np.array([np.min(x) + 0.5 * np.ptp(x), np.min(y) + 0.5 * np.ptp(y)]), 1.15 * extent
    orbit_axes(axes, 1.08 * reach, *middle)


def between(part: Signal, first: int, last: int, times: int) -> Values:
    """The samples of a motion from `first` to before `last`, and `times` as many values between them, interpolated as
    band-limited to half of the sampling rate. At an end of the run, beyond which nothing is known, the last few samples
    are left out."""
    whole = part[max(first - MARGIN, 0) : min(last + MARGIN, len(part))]
    if times <= 1 or len(whole) <= 4 * MARGIN:
        return part[first:last]
    # scipy.signal has this function, and takes longer to import than the whole picture to draw
    places, reach = np.arange(len(whole)), np.arange(-REACH * times, REACH * times + 1)
    fine = np.linspace(0.0, len(whole) - 1.0, (len(whole) - 1) * times + 1)
    ends = np.array([0, len(whole) - 1])
    spread = np.zeros(len(fine), dtype=whole.dtype)
    spread[::times] = whole - np.interp(places, ends, whole[ends])
    window = np.sinc(reach / times) * np.kaiser(len(reach), KAISER)
    values = np.convolve(spread, window, "same") + np.interp(fine, ends, whole[ends])
    return np.asarray(values[MARGIN * times : len(values) - MARGIN * times])


def draw_spectrum_at(axes: Axes, run: Run, time_s: float, spectra: Spectrogram, signal: str = "journal") -> None:
    """Peak amplitudes over frequency of the spectrum nearest to a time in s, with the frequencies of interest."""
    column = int(np.argmin(np.abs(spectra.time_s - time_s)))
    speed = abs(float(spectra.speed_Hz[column]))
    highest = min(float(spectra.frequency_Hz[-1]), max(AHEAD * speed, 8.0 / spectra.window_s))
    kept = spectra.frequency_Hz <= highest
    axes.plot(spectra.frequency_Hz[kept], MICRO * spectra.amplitude[kept, column], color=BLUE)
    if highest > 0.0:
        axes.set_xlim(0.0, highest)
    axes.set_ylim(bottom=0.0)
    lines = sorted((float(abs(frequencies[column])), name) for name, frequencies in orders(run, signal, spectra))
    last, lower = -np.inf, 0.0
    for at, name in lines:
        if 0.0 < at < highest:
            axes.axvline(at, color=GREY, linewidth=0.8, linestyle=(0, (2, 3)))
            lower = lower + LINE_pt if at - last < CLOSE * highest else 0.0
            axes.annotate(name, (at, 1.0), xycoords=axes.get_xaxis_transform(), xytext=(2, -2 - lower),
                          textcoords="offset points", va="top", fontsize=8.0, color=GREY, bbox=CLEAR)  # fmt: skip
            last = at
    axes.set(xlabel="frequency in Hz", ylabel="amplitude in µm")


def times_of_speeds(run: Run, speeds_Hz: Sequence[float]) -> list[float]:
    """The first time in s at which the rotor turns as fast as each of some speeds; those it does not reach are left
    out."""
    times = []
    for wanted in speeds_Hz:
        before = 0.0
        for start, stop in pieces(0, len(run)):
            speed = np.abs(run.read(SPEED, start, stop))
            reached = np.flatnonzero((speed >= abs(wanted)) & (before <= abs(wanted)))
            if len(reached):
                times.append(float(run.read("time_s", start + int(reached[0]), start + int(reached[0]) + 1)[0]))
                break
            before = float(speed[-1])
    return times


SLOWEST = 0.02  # share of the highest rotor speed below which the ratio is not drawn
ROOM = 1.15  # above the highest curve
START = 0.05  # share of the run after which the highest value is sought: a rotor that falls drags its rings


def ring_speed_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """omega_F / omega_R of each ring, the runs overlaid, from from_time to to_time in s; dashed the ratio of concentric
    surfaces, where the torques of both films balance.

    Raises RunFileError if a run has no ring that turns.
    """
    for run in runs:
        ends(run)
        if not _turning(run):
            raise refuse(run.path, "has no ring that turns.", "Draw a run of a case with floating rings.")
    names = _turning(runs[0])
    curves = [(name, [_ratio(run, name) for run in runs]) for name in names]
    concentric = _concentric(runs[0]) if len({run.case_text for run in runs}) == 1 else {}
    highest = max(
        extremes(ratio, int(START * len(run)), len(run))[1]
        for _, each in curves
        for run, ratio in zip(runs, each, strict=True)
    )

    def panel(axes: Axes) -> None:
        draw_curves(axes, runs, curves, over, (from_time, to_time))
        _draw_concentric(axes, concentric)
        axes.set(ylim=(0.0, ROOM * max(highest, *concentric.values(), 1e-3)), ylabel="ring speed over rotor speed")

    return curves_figure(runs, [panel], over)


def _draw_concentric(axes: Axes, concentric: dict[str, float]) -> None:
    """A dashed line for each ratio of concentric surfaces, named above the axes, with its ring where ratios differ."""
    names = []
    for value in sorted(set(concentric.values())):
        alike = [name for name, own in concentric.items() if own == value]
        ring = f"{alike[0]} " if len(alike) < len(concentric) else ""
        names.append(f"{ring}{value:.3f}")
        axes.axhline(value, color=GREY, linestyle=(0, (5, 3)), linewidth=0.9)
    if names:
        words = f"dashed: torque balance, concentric: {', '.join(names)}"
        axes.set_title(words, loc="right", color=GREY, fontsize=9)


def _turning(run: Run) -> list[str]:
    return [name for name in points(run.signals, "ring") if joined("ring_speed", name, "Hz") in run.signals]


def _ratio(run: Run, name: str) -> SlicedColumn:
    """Speed of a ring over the rotor speed, NaN where the rotor hardly turns."""
    ring, rotor = run.signal(joined("ring_speed", name, "Hz")), run.signal(SPEED)
    least = SLOWEST * max(map(abs, extremes(rotor, 0, len(run))))

    def part(first: int, last: int) -> Array:
        speed = np.abs(rotor[first:last])
        ratio: Array = np.full(len(speed), np.nan)
        return np.divide(ring[first:last], speed, out=ratio, where=speed > least)

    return SlicedColumn(len(run), part)


def _concentric(run: Run) -> dict[str, float]:
    """The ring speeds of the run's case, none if this version of frb would not run it."""
    case_tables(run)
    try:
        return concentric_ratios(load_case_text(run.case_text))
    except InputError:
        return {}
