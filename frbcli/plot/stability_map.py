"""The stability map: curves of Hopf points and folds over the rotor speed and a second number of the case."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.cycles.result import SUBCRITICAL, SUPERCRITICAL
from frbcli.cycles.stability_map import BAUTIN, CUSP, MapCurve, StabilityMap
from frbcli.plot.style import BLACK, BLUE, GREEN, GREY, ORANGE, VERMILION, legend_below, new_figure, plain, styled

HOPF_STYLES = {
    SUPERCRITICAL: (BLUE, "-", "Hopf points, soft"),
    SUBCRITICAL: (VERMILION, "-", "Hopf points, hard"),
    None: (GREY, "--", "Hopf points, soft or hard not told"),
}
MARKS = {BAUTIN: ("o", "soft changes to hard"), CUSP: ("^", "cusp of folds")}
UNSTABLE = "#f3e3d3"


def stability_map_figure(found: StabilityMap) -> Figure:
    """The curves with the speed to the right and the second number upwards; shaded where the rotor whirls from rest."""
    case = found.case
    with styled():
        figure = new_figure(case.title or case.name, "curves of Hopf points and folds of limit cycles")
        axes = figure.subplots()
        _shade(axes, found)
        for curve in found.curves:
            _curve(axes, curve)
        for kind, (marker, label) in MARKS.items():
            at = [(point.speed_Hz, point.value) for point in found.special if point.kind == kind]
            if at:
                speeds, values = zip(*at, strict=True)
                axes.plot(speeds, values, linestyle="", marker=marker, color=BLACK, markersize=4.5, label=label)
        starts = [(p.speed_Hz, row.value) for row in found.rows for p in row.special if p.kind in ("flip", "torus")]
        if starts:
            speeds, values = zip(*starts, strict=True)
            axes.plot(speeds, values, linestyle="", marker="s", color=ORANGE, markersize=4.0, label="flip, torus point")
        axes.set_xlim(found.growth.speeds_Hz[0], found.growth.speeds_Hz[-1])
        axes.set_ylim(found.growth.values[0], found.growth.values[-1])
        axes.set_xlabel("rotor speed in Hz")
        axes.set_ylabel(plain(f"{found.key} in {found.unit}" if found.unit else found.key))
        _legend_once(axes)
        legend_below(figure, axes)
    return figure


def _shade(axes: Axes, found: StabilityMap) -> None:
    """Where the resting position is unstable."""
    grid = np.where(np.isnan(found.growth.rate), -1.0, found.growth.rate)
    if grid.max() > 0.0:
        axes.contourf(found.growth.speeds_Hz, found.growth.values, grid, levels=[0.0, grid.max()], colors=[UNSTABLE])


def _curve(axes: Axes, curve: MapCurve) -> None:
    if curve.kind != "hopf":
        values = [point.value for point in curve.points]
        axes.plot([point.speed_Hz for point in curve.points], values, color=GREEN, label="folds")
        return
    for one, other in itertools.pairwise(curve.points):
        colour, style, label = HOPF_STYLES[one.criticality if not one.kind else other.criticality]
        axes.plot([one.speed_Hz, other.speed_Hz], [one.value, other.value], color=colour, linestyle=style, label=label)


def _legend_once(axes: Axes) -> None:
    """Each label at its first line only."""
    known: set[str] = set()
    for line in axes.lines:
        label = str(line.get_label())
        if label in known:
            line.set_label("_nolegend_")
        known.add(label)
