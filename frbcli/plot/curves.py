"""Signals as curves over time or rotor speed, of one run or of several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from frbcli.plot.signals import cut, labels, thin, times
from frbcli.plot.style import COLOURS
from frbcli.results.container import refuse
from frbcli.results.store import Run

Values = NDArray[np.float64]
Over = Literal["time", "speed"]
Span = tuple[float | None, float | None]

STANDS = 1e-6  # of the highest speed per sample: less is no change of speed
OVERLAID = 0.75  # opacity of curves that lie upon each other
WORDS = {"time": "time in s", "speed": "rotor speed in Hz"}


def draw_curves(
    axes: Axes, runs: Sequence[Run], signals: Sequence[tuple[str, Sequence[Values]]], over: Over, span: Span
) -> None:
    """Curves of all runs on axes of a figure, from and to the times of span in s.

    signals: names for the legend, each with its values (n,) in every run. Over speed, the way up and the way down are
    two curves. Raises RunFileError if there is nothing to draw.
    """
    several = len(runs) > 1 or len(signals) > 1
    colour = 0
    for number, (run, told) in enumerate(zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True)):
        shown = cut(run, *span)
        for name, values in signals:
            for way, time_s, drawn in _ways(run, over, shown, values[number]):
                label = ", ".join(word for word in (told, name, way) if word)
                place = time_s if over == "time" else np.interp(time_s, times(run), run["speed_Hz"])
                alpha = OVERLAID if several or way else 1.0
                axes.plot(place, drawn, color=COLOURS[colour % len(COLOURS)], label=label, alpha=alpha)
                colour += 1
    axes.margins(x=0.0)


def finish(axes: Axes, over: Over) -> None:
    """The name of the axis below."""
    axes.set_xlabel(WORDS[over])


def _ways(run: Run, over: Over, shown: slice, values: Values) -> list[tuple[str, Values, Values]]:
    """The way up and the way down of the rotor speed with their thinned curves; all of a curve over time."""
    time_s, values = times(run)[shown], values[shown]
    if over == "time":
        return [("", *thin(time_s, values))]
    speed = run["speed_Hz"][shown]
    change = np.gradient(speed)
    least = STANDS * float(np.max(np.abs(speed)))
    ways = [
        (name, *thin(time_s[chosen], values[chosen]))
        for name, chosen in (("run-up", change > least), ("run-down", change < -least))
        if np.count_nonzero(chosen) > 1
    ]
    if not ways:
        raise refuse(run.path, "was made at constant speed.", "Draw it over time.")
    return ways if len(ways) > 1 else [("", *ways[0][1:])]
