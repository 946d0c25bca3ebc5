"""The stability map: Hopf points and folds over the rotor speed and a second number of the case."""

from __future__ import annotations

from matplotlib.figure import Figure

from frbcli.cycles.stability_map import StabilityMap
from frbcli.plot.style import BLUE, GREEN, GREY, ORANGE, VERMILION, legend_below, new_figure, plain, styled

MARKS = {
    ("hopf", "supercritical"): ("o", BLUE, "Hopf point, soft"),
    ("hopf", "subcritical"): ("o", VERMILION, "Hopf point, hard"),
    ("fold", None): ("D", GREEN, "fold"),
    ("flip", None): ("s", ORANGE, "flip"),
    ("torus", None): ("^", GREY, "torus point"),
}


def stability_map_figure(found: StabilityMap) -> Figure:
    """The special points of each value as marks, the speed to the right and the second number upwards."""
    case = found.case
    with styled():
        figure = new_figure(case.title or case.name, "Hopf points and folds of limit cycles")
        axes = figure.subplots()
        for (kind, criticality), (marker, colour, label) in MARKS.items():
            at = [
                (point.speed_Hz, row.value)
                for row in found.rows
                for point in row.special
                if point.kind == kind and point.criticality == criticality
            ]
            if at:
                speeds, values = zip(*at, strict=True)
                axes.plot(speeds, values, linestyle="", marker=marker, color=colour, markersize=4.5, label=label)
        axes.set_xlabel("rotor speed in Hz")
        axes.set_ylabel(plain(f"{found.key} in {found.unit}" if found.unit else found.key))
        legend_below(figure, axes)
    return figure
