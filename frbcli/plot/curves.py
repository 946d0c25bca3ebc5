"""Signals as curves over time or rotor speed, of one run or of several."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.arrays import Array
from frbcli.plot.signals import Envelope, EnvelopeColumn, curve, cut, extremes, heading, labels
from frbcli.plot.style import COLOURS, legend_below, new_figure, styled
from frbcli.results.files.container import refuse
from frbcli.results.records import SPEED, Signal, pieces
from frbcli.results.store import Run

Over = Literal["time", "speed"]
Span = tuple[float | None, float | None]

HEIGHT = 4.4  # inches of a picture
STANDS = 1e-6  # of the highest speed per sample: less is no change of speed
MANY = 200_000  # samples; of more, each may change the speed by less
OVERLAID = 0.75  # opacity of curves that lie upon each other
WORDS = {"time": "time in s", "speed": "rotor speed in Hz"}
WAYS = {"run-up": 1.0, "run-down": -1.0}


@dataclass(frozen=True)
class ScaledSignal:
    """A signal in another unit, read in pieces like a signal."""

    signal: Signal
    factor: float
    offset: float = 0.0

    def __len__(self) -> int:
        return len(self.signal)

    def __getitem__(self, part: slice, /) -> Array:
        return np.asarray(self.factor * self.signal[part] + self.offset)


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
    axes: Axes, runs: Sequence[Run], signals: Sequence[tuple[str, Sequence[EnvelopeColumn]]], over: Over, span: Span
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


def _ways(run: Run, over: Over, shown: tuple[int, int], column: EnvelopeColumn) -> list[tuple[str, Array, Array]]:
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
