"""Curves over time or rotor speed: signals of one run or of several; amplitudes by order; and a run in a diagram over
the speed: the largest eccentricity of each film in each short span of time.

The cascade, the older, three-dimensional form of the waterfall: spectra as curves behind each other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from frbcli.analysis.order_tracking import OrderTrack
from frbcli.analysis.signals import SignalColumn, joined, located
from frbcli.analysis.spectrum import Direction, Spectrogram
from frbcli.arrays import Array
from frbcli.plot.signals import MICRO, Envelope, curve, cut, extremes, heading, labels
from frbcli.plot.style import BLUE, COLOURS, GREY, legend_below, new_figure, styled
from frbcli.results.container import refuse
from frbcli.results.records import SPEED, pieces
from frbcli.results.store import Run

Over = Literal["time", "speed"]
Span = tuple[float | None, float | None]

HEIGHT = 4.4  # inches of a picture
APART = 10.0  # ratio of amplitudes by order of which the smaller one is not seen on a common axis
STANDS = 1e-6  # of the highest speed per sample: less is no change of speed
MANY = 200_000  # samples; of more, each may change the speed by less
OVERLAID = 0.75  # opacity of curves that lie upon each other
WORDS = {"time": "time in s", "speed": "rotor speed in Hz"}
WAYS = {"run-up": 1.0, "run-down": -1.0}
SPANS = 200  # of a run: longer than the periods of its whirl
ECCENTRICITY, TIME = "eccentricity", "time_s"
HELD = 0.01  # share of the fastest change of the speed, below which it stays


def curves_figure(
    runs: Sequence[Run], panels: Sequence[Callable[[Axes], None]], over: Over, height: float = HEIGHT
) -> Figure:
    """A picture of runs with a panel for each function that draws one, above a common axis; height: in inches."""
    with styled():
        figure = new_figure(*heading(runs), height=height)
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for panel, draw in zip(axes, panels, strict=True):
            draw(panel)
        finish(axes[-1], over)
        legend_below(figure, axes[0])
    return figure


def draw_curves(
    axes: Axes, runs: Sequence[Run], signals: Sequence[tuple[str, Sequence[SignalColumn]]], over: Over, span: Span
) -> None:
    """Curves of all runs on axes of a figure, from and to the times of span in s.

    signals: names for the legend, each with its values (n,) in every run. Over speed, the way up and the way down are
    two curves. Raises RunFileError if there is nothing to draw.
    """
    several = len(runs) > 1 or len(signals) > 1
    colour = 0
    for number, (run, source) in enumerate(zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True)):
        shown = cut(run, *span)
        for name, columns in signals:
            for way, place, drawn in _ways(run, over, shown, columns[number]):
                label = ", ".join(word for word in (source, name, way) if word)
                alpha = OVERLAID if several or way else 1.0
                axes.plot(place, drawn, color=COLOURS[colour % len(COLOURS)], label=label, alpha=alpha)
                colour += 1
    axes.margins(x=0.0)


def finish(axes: Axes, over: Over) -> None:
    """Write the name of the axis below, time or speed."""
    axes.set_xlabel(WORDS[over])


def _ways(run: Run, over: Over, shown: tuple[int, int], column: SignalColumn) -> list[tuple[str, Array, Array]]:
    """The way up and the way down of the rotor speed with their thinned curves; all of a curve over time."""
    if over == "time":
        return [("", *curve(run, column, *shown))]
    least = STANDS * min(1.0, MANY / (shown[1] - shown[0])) * max(map(abs, extremes(run.signal(SPEED), *shown)))
    counts = dict.fromkeys(WAYS, 0)
    for _, _, _, change in _changes(run, shown):
        for way, sign in WAYS.items():
            counts[way] += int(np.count_nonzero(sign * change > least))
    lines = {way: Envelope(count) for way, count in counts.items() if count > 1}
    if not lines:
        raise refuse(run.path, "was made at constant speed.", "Draw it over time.")
    for start, stop, speed, change in _changes(run, shown):
        values = column[start:stop]
        for way, line in lines.items():
            chosen = WAYS[way] * change > least
            line.add(speed[chosen], values[chosen])
    ways = [(way, *line.points()) for way, line in lines.items()]
    return ways if len(ways) > 1 else [("", *ways[0][1:])]


def _changes(run: Run, shown: tuple[int, int]) -> Iterator[tuple[int, int, Array, Array]]:
    """Pieces of the samples shown, from and to, each with the speed and its change per sample there."""
    first, last = shown
    for start, stop in pieces(first, last):
        begin, end = max(start - 1, first), min(stop + 1, last)  # a change is seen from both neighbours
        speed = run.read(SPEED, begin, end)
        here = slice(start - begin, stop - begin)
        yield start, stop, speed[here], np.gradient(speed)[here]


def orders_figure(
    run: Run, tracks: Sequence[OrderTrack], over: Over = "speed", direction: Direction = "x", log: bool = False
) -> Figure:
    """The peak amplitude of each order of a point, with a panel each where they differ by more than APART;
    a run that goes up and down is drawn to and fro.

    tracks: of the same point, by `frbcli.analysis.order_tracking.order_tracks`; log: logarithmic amplitude.
    """
    title, subtitle = heading([run])
    point = joined(*located(run, tracks[0].signal)).replace("_", " ")
    moves = f"forward motion of the {point}" if direction == "forward" else f"{direction} of the {point}"
    what = f"{moves} by order, windows of {tracks[0].revolutions} revolutions"
    curves = [MICRO * track.amplitude(direction) for track in tracks]
    heights = [float(np.nanmax(curve, initial=0.0)) for curve in curves]
    parted = not log and max(heights) > APART * min(heights)
    with styled():
        count = len(tracks) if parted else 1
        figure = new_figure(title, ", ".join(word for word in (subtitle, what) if word), height=3.0 + 1.6 * count)
        panels = list(figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0])
        for number, (track, curve) in enumerate(zip(tracks, curves, strict=True)):
            axes = panels[number if parted else 0]
            across = track.time_s if over == "time" else track.speed_Hz
            axes.plot(across, curve, color=COLOURS[number % len(COLOURS)], label=named(track.order))
            axes.set_ylabel(f"{named(track.order)} in µm" if parted else "amplitude in µm")
            axes.margins(x=0.0)
            if log:
                axes.set_yscale("log")
            else:
                axes.set_ylim(bottom=0.0)
        panels[-1].set_xlabel("time in s" if over == "time" else "rotor speed in Hz")
        if not parted:
            legend_below(figure, panels[0])
    return figure


def named(order: float) -> str:
    """Label of an order, such as 0.5X."""
    return f"{order:g}X"


@dataclass(frozen=True)
class RunTrack:
    """run: its name; label: its direction and its ramp; rising: whether the speed rises; speed_Hz:
    (n,); largest: (n,) eccentricity of each film by its name."""

    run: str
    label: str
    rising: bool
    speed_Hz: Array
    largest: Mapping[str, Array]


def run_tracks(run: Run, name: str) -> tuple[RunTrack, ...]:
    """The way up of a run, and the way down if the speed falls after its largest."""
    signals = [signal for signal in run.signals if signal == ECCENTRICITY or signal.startswith(f"{ECCENTRICITY}_")]
    span = max(1, len(run) // SPANS)
    speeds: list[float] = []
    times: list[float] = []
    largest: dict[str, list[float]] = {signal: [] for signal in signals}
    for start, stop in pieces(0, len(run)):
        speed = run.read(SPEED, start, stop)
        firsts = np.arange(0, stop - start, span)
        speeds += speed[firsts].tolist()
        times += run.read(TIME, start, stop)[firsts].tolist()
        for signal in signals:
            largest[signal] += np.maximum.reduceat(run.read(signal, start, stop), firsts).tolist()
    over = np.array(speeds)
    top = int(np.argmax(over))
    tracks = []
    for rising, part in ((True, slice(0, top + 1)), (False, slice(top, None))):
        if len(over[part]) > 2 and np.ptp(over[part]) > 0.0:
            label = f"{'run-up' if rising else 'run-down'}, {_ramp(over[part], np.array(times)[part]):.3g} Hz/s"
            films = {signal[len(ECCENTRICITY) + 1 :]: np.array(values)[part] for signal, values in largest.items()}
            tracks.append(RunTrack(name, label, rising, over[part], films))
    return tuple(tracks)


def _ramp(speed_Hz: Array, time_s: Array) -> float:
    """The change of the speed in Hz/s, without the time at which it stays."""
    change = np.abs(np.gradient(speed_Hz, time_s))
    return float(np.median(change[change > HELD * change.max()]))


CURVES = 60
CURVE_HEIGHT = 0.25  # of a curve from the lowest to the highest level, relative to the depth of the stack
SHEAR = 0.22  # how far the last curve stands to the right, relative to the frequency axis
NICE = [1, 2, 5, 10]  # steps of the ticks
ABOVE_CURVES = 10 + CURVES


def draw_cascade(
    axes: Axes,
    found: Spectrogram,
    over: Over,
    values: Array,
    limits: tuple[float, float],
    unit: str,
    lines: list[tuple[str, Array]],
) -> None:
    """Curves over frequency, shifted up and to the right with time or speed; those in front hide those behind.

    values (k, m) and their limits in a unit: heights of the curves; lines: label and frequency (m,) in Hz of each line
    to draw on the floor, e.g. the rotor speed.
    """
    depth = found.time_s if over == "time" else found.speed_Hz
    span = float(np.ptp(depth)) or 1.0
    width = float(found.frequency_Hz[-1])
    shift = SHEAR * width * (depth - depth[0]) / span
    height = CURVE_HEIGHT * span / (limits[1] - limits[0])
    chosen = np.unique(np.linspace(0, len(depth) - 1, min(CURVES, len(depth))).round().astype(int))
    for layer, place in enumerate(chosen[::-1], start=10):
        curve = depth[place] + height * (np.clip(values[:, place], *limits) - limits[0])
        frequency = found.frequency_Hz + shift[place]
        axes.fill_between(frequency, depth[place], curve, facecolor="white", edgecolor="none", zorder=layer)
        axes.plot(frequency, curve, color=BLUE, linewidth=0.7, zorder=layer)
    for label, frequency in lines:
        axes.plot(frequency + shift, depth, color="black", linewidth=0.8, linestyle=(0, (2, 3)), zorder=ABOVE_CURVES)
        axes.annotate(
            label,
            (frequency[-1] + shift[-1], depth[-1]),
            xytext=(4, 1),
            textcoords="offset points",
            zorder=ABOVE_CURVES,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
        )
    _draw_frame(axes, depth, shift, width, span)
    right = width + shift[-1]
    axes.plot([right] * 2, [depth[-1], depth[-1] + CURVE_HEIGHT * span], color="black", linewidth=1.5)
    axes.annotate(f"{limits[1] - limits[0]:.3g} {unit}", (right, depth[-1] + CURVE_HEIGHT * span / 2), (-4, 0),
                  textcoords="offset points", ha="right", va="center")  # fmt: skip
    axes.set(xlabel="frequency in Hz", ylabel=WORDS[over])


def _draw_frame(axes: Axes, depth: Array, shift: Array, width: float, span: float) -> None:
    """Slanting lines of equal frequency: the ticks below belong to the foremost curve."""
    ticks = [tick for tick in MaxNLocator(8, steps=NICE).tick_values(0.0, width) if 0.0 <= tick <= width]
    for tick in ticks:
        axes.plot([tick, tick + shift[-1]], [depth[0], depth[-1]], color=GREY, linewidth=0.4, alpha=0.6)
    axes.grid(False)
    axes.set_xticks(ticks)
    bottom, top = depth[0], depth[0] + (1.02 + CURVE_HEIGHT) * span
    axes.set_ylim(bottom, top)
    depths = MaxNLocator(7, steps=NICE).tick_values(bottom, bottom + span)
    axes.set_yticks([tick for tick in depths if bottom <= tick <= bottom + span])
    axes.set_xlim(0.0, (width + shift[-1]) * 1.02)
    axes.margins(0.0)
