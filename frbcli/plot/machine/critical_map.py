"""The undamped critical speed map, with the stiffness of the films of the case over it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.linear.critical_map import CriticalMap
from frbcli.plot.style import BLUE, GREY, ORANGE, VERMILION, legend_below, new_figure, styled

FEW = 10  # speeds of films: they are marked, as fewer than two are no line
FILM_DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)))
FILM_MARKS = ("o", "D", "^")


def critical_map_figure(found: CriticalMap) -> Figure:
    """Critical speeds of forward and backward whirls over the stiffness of a bearing, both logarithmic; red, what the
    films have at each speed: where the curves cross, the rotor has a critical speed, less what damping moves it."""
    case = found.case
    with styled():
        figure = new_figure(case.heading, "undamped critical speeds over the stiffness of each bearing")
        axes = figure.subplots()
        draw_critical_map(axes, found)
        legend_below(figure, axes)
    return figure


def draw_critical_map(axes: Axes, found: CriticalMap) -> None:
    """The map on axes of a figure: critical speeds in Hz over the stiffness in N/m."""
    for values, colour, dashes, name in (
        (found.forward, BLUE, "-", "forward whirl"), (found.backward, ORANGE, (0, (5, 2)), "backward whirl"),
    ):  # fmt: skip
        for number, curve in enumerate(values.T):
            axes.plot(found.stiffness, curve, color=colour, linestyle=dashes, label=name if number == 0 else None)
    for number, springs in enumerate(found.film_stiffness.T if len(found.film_speeds_Hz) else ()):
        if np.isnan(springs).all():
            continue
        bearing = found.case.bearings[number].name
        label = ", ".join(word for word in ("stiffness of the films", bearing) if word)
        marker = FILM_MARKS[number % 3] if len(springs) < FEW else ""
        axes.plot(springs, found.film_speeds_Hz, color=VERMILION, linestyle=FILM_DASHES[number % 3], marker=marker,
                  markersize=5.0, label=label)  # fmt: skip
    top = max(abs(found.case.speed.start), abs(found.case.speed.end))
    axes.axhline(top, color=GREY, linewidth=0.8, linestyle=(0, (1, 2)), label="highest speed of the case")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(float(found.stiffness[0]), float(found.stiffness[-1]))
    lowest = float(np.nanmin([found.forward, found.backward]))
    axes.set_ylim(max(lowest, 0.02 * top), 20.0 * top)
    axes.set_xlabel("stiffness of a bearing in N/m")
    axes.set_ylabel("critical speed in Hz")
