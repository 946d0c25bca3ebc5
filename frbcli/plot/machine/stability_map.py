"""The stability map: curves of Hopf points and folds over the rotor speed and a number of the case, or over two numbers
of it."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.cycles.columns import SPEED, SUBCRITICAL, SUPERCRITICAL
from frbcli.cycles.stability_map import BAUTIN, CUSP, MapCurve, StabilityMap
from frbcli.plot.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    VERMILION,
    legend_below,
    name_of_key,
    new_figure,
    styled,
)

HOPF_STYLES = {
    SUPERCRITICAL: (BLUE, "-", "Hopf points, soft"),
    SUBCRITICAL: (VERMILION, "-", "Hopf points, hard"),
    None: (GREY, "--", "Hopf points, soft or hard unknown"),
}
MARKS = {BAUTIN: ("o", "soft changes to hard"), CUSP: ("^", "cusp of folds")}
UNSTABLE = "#f3e3d3"
MARGIN = 0.15  # of the range of the curves, on both sides


def stability_map_figure(chart: StabilityMap) -> Figure:
    """The curves with the first number to the right and the second one upwards; shaded where rest is unstable."""
    case = chart.case
    with styled():
        figure = new_figure(case.heading, "curves of Hopf points and folds of limit cycles")
        axes = figure.subplots()
        _shade(axes, chart)
        for curve in chart.curves:
            _curve(axes, curve)
        for kind, (marker, label) in MARKS.items():
            at = [(point.over, point.value) for point in chart.special if point.kind == kind]
            if at:
                over, values = zip(*at, strict=True)
                axes.plot(over, values, linestyle="", marker=marker, color=BLACK, markersize=4.5, label=label)
        axes.set_xlim(*_limits(chart))
        axes.set_ylim(chart.growth.values[0], chart.growth.values[-1])
        axes.set_xlabel("rotor speed in Hz" if chart.over == SPEED else name_of_key(chart.over, chart.over_unit))
        axes.set_ylabel(name_of_key(chart.key, chart.unit))
        _legend_once(axes)
        legend_below(figure, axes)
    return figure


def _limits(chart: StabilityMap) -> tuple[float, float]:
    """Where the curves and the marks are, with a margin, within the range of the map; all of it without any."""
    low, high = float(chart.growth.over[0]), float(chart.growth.over[-1])
    over = np.array([point.over for curve in chart.curves for point in curve.points]
                    + [point.over for point in chart.special])  # fmt: skip
    over = over[(low <= over) & (over <= high)]
    if not len(over) or not np.ptp(over) > 0.0:
        return low, high
    margin = MARGIN * float(np.ptp(over))
    return max(low, float(over.min()) - margin), min(high, float(over.max()) + margin)


def _shade(axes: Axes, chart: StabilityMap) -> None:
    """Where the static equilibrium is unstable."""
    grid = np.where(np.isnan(chart.growth.rate), -1.0, chart.growth.rate)
    if grid.max() > 0.0:
        axes.contourf(chart.growth.over, chart.growth.values, grid, levels=[0.0, grid.max()], colors=[UNSTABLE])
        axes.fill([], [], color=UNSTABLE, label="static equilibrium unstable")


def _curve(axes: Axes, curve: MapCurve) -> None:
    if curve.kind != "hopf":
        values = [point.value for point in curve.points]
        axes.plot([point.over for point in curve.points], values, color=GREEN, label="folds")
        return
    for one, other in itertools.pairwise(curve.points):
        colour, style, label = HOPF_STYLES[one.criticality if not one.kind else other.criticality]
        axes.plot([one.over, other.over], [one.value, other.value], color=colour, linestyle=style, label=label)


def _legend_once(axes: Axes) -> None:
    """Each label at its first line only."""
    known: set[str] = set()
    for line in axes.lines:
        label = str(line.get_label())
        if label in known:
            line.set_label("_nolegend_")
        known.add(label)
