"""The orbit of a journal inside its clearance circle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from frbcli.analysis.signals import joined, points
from frbcli.plot.signals import MICRO, clearance, cut, heading, labels, motion, times
from frbcli.plot.style import COLOURS, GREY, legend_below, new_figure, styled
from frbcli.results.store import Run

LAST_s = 0.1  # what is shown if no time is given


def orbit_figure(runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None) -> Figure:
    """Orbits of all journals from from_time to to_time in s (default: the last 0.1 s), one panel per bearing.

    A dot marks where an orbit begins. Raises RunFileError if a run has no samples between these times.
    """
    bearings = list(points(runs[0].signals, "journal")) or [""]
    end = min(float(times(run)[-1]) for run in runs) if to_time is None else to_time
    begin = max(end - LAST_s, 0.0) if from_time is None else from_time
    title, subtitle = heading(runs)
    span = f"orbit from {begin:.4g} s to {end:.4g} s"
    with styled():
        figure = new_figure(title, ", ".join(text for text in (subtitle, span) if text), 4.8 * len(bearings), 5.2)
        for axes, bearing in zip(figure.subplots(1, len(bearings), squeeze=False)[0], bearings, strict=True):
            axes.set_title(bearing)
            _draw(axes, runs, bearing, (begin, end))
        legend_below(figure, axes)
    return figure


def _draw(axes: Axes, runs: Sequence[Run], bearing: str, span_s: tuple[float, float]) -> None:
    widest = 0.0
    circles: set[float] = set()
    for number, (run, label) in enumerate(zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True)):
        shown = cut(run, *span_s)
        x, y = (values[shown] * MICRO for values in motion(run, joined("journal", bearing)))
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(x, y, color=colour, linewidth=0.9, label=label)
        axes.plot(x[:1], y[:1], color=colour, marker="o", markersize=4.0)
        radius = clearance(run, bearing) * MICRO
        circles.add(radius)
        widest = max(widest, radius, float(np.max(np.hypot(x, y))))
    for radius in circles:
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.2))
        axes.annotate(
            f"clearance {radius:.4g} µm", (0.0, radius), (0, 3), textcoords="offset points", ha="center", color=GREY
        )
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.axvline(0.0, color=GREY, linewidth=0.5)
    axes.set_aspect("equal")
    axes.set_xlim(-1.12 * widest, 1.12 * widest)
    axes.set_ylim(-1.12 * widest, 1.12 * widest)
    axes.set_xlabel("x in µm")
    axes.set_ylabel("y in µm")
