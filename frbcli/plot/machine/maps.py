"""The stability map: curves of Hopf points and folds over the rotor speed and a number of the case, or over two numbers
of it.

Oil fraction over pressure: the two-phase step for several steepnesses (figure 4.10), the models in one diagram
(figure 4.11).
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.arrays import Array
from frbcli.case.model import altered
from frbcli.cycles.columns import SPEED, SUBCRITICAL, SUPERCRITICAL
from frbcli.cycles.stability_map import BAUTIN, CUSP, MapCurve, StabilityMap
from frbcli.film.cavitation.law import FilmOil, Law
from frbcli.film.cavitation.table import label_of, laws
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.plot.style import (
    BLACK,
    BLUE,
    COLOURS,
    GREEN,
    GREY,
    VERMILION,
    Picture,
    legend_below,
    name_of_key,
    new_figure,
    styled,
)
from frbcli.scene.gate.static import require

if TYPE_CHECKING:
    from frbcli.case.schema import Case


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


BAR = 1e5
STEEPNESSES = (0.9, 0.95, 0.99, 0.999)  # x_1, in addition to the case's
DASHES = ((5, 1.5), (1.5, 1), (6, 1.5, 1.5, 1.5), (8, 2), (3, 1, 1, 1, 1, 1))
LINES: tuple[Any, ...] = ("-", *((0, dash) for dash in DASHES))
POINTS = 4001
PLAIN, OWN = 1.0, 2.0  # width of a line, and of the case's line
LEAST, WIDEST = 1e-6, 1.2  # p / p_cav over which the models are compared


def law_figure(case: Case) -> Picture:
    """theta(p) of the conserving models with the parameters of a case, whose own model is drawn thick. Raises
    InputError for a case whose films cannot be modelled."""
    require(case)
    film, cavity = case.film, case.oil.cavitation_pressure
    with styled():
        words = f"oil fraction over pressure; the case's model: {label_of(film.cavitation)}"
        figure = new_figure(case.heading, words, height=4.6)
        left, right = figure.subplots(1, 2, sharey=True)
        _draw_steps(left, case)
        _draw_models(right, case)
        left.set_ylabel("oil fraction")
        right.set_xlim(0.0, WIDEST * cavity / BAR)
        for axes in (left, right):
            axes.set_xlabel("absolute pressure in bar")
            axes.set_ylim(-0.03, 1.06)
            axes.axvline(cavity / BAR, color=GREY, linewidth=0.8, zorder=0.5)
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=1, fontsize=8.0)
    return figure


def _draw_steps(axes: Axes, case: Case) -> None:
    """The steps (4.32) down to where the widest one ends, a dot at the steepest slope x_1 of each."""
    x, cavity = case.film.given(TwoPhase.name).steepness, case.oil.cavitation_pressure
    values = sorted({*STEEPNESSES, x})
    start = max(0.0, 2.0 * values[0] - 1.0)
    ratio = np.linspace(max(0.0, start - 0.1 * (1.0 - start)), 1.0 + 0.2 * (1.0 - start), POINTS)
    for number, value in enumerate(values):
        own = value == x and case.film.cavitation == TwoPhase.name
        place = np.array([value])
        _draw(axes, number, ratio * cavity, TwoPhase(value).curve(ratio), f"two-phase, $x_1$ = {value:g}", own)
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(place * cavity / BAR, TwoPhase(value).curve(place), color=colour, marker="o", markersize=4.0)
    axes.margins(x=0.0)
    axes.set_title("Two-phase: a step (4.32)")


def _draw_models(axes: Axes, case: Case) -> None:
    """All models whose oil fraction follows from the pressure, from no pressure to above p_cav."""
    cavity = case.oil.cavitation_pressure
    ratio = np.linspace(LEAST, WIDEST, POINTS)
    over_cavity = FilmOil(cavity, case.oil.ambient_pressure, cavity, case.oil.density)
    number = 0
    for law in laws():
        chosen = case.film.given(law.name)
        for given in _compared(law, chosen):
            try:
                fraction = law.scaled(given, over_cavity).curve(ratio)
            except ValueError:  # not with this oil
                continue
            if fraction is None:
                continue
            own = law.name == case.film.cavitation and given == chosen
            _draw(axes, number, ratio * cavity, fraction, law.legend(given), own)
            number += 1
    axes.set_title("Comparison of the models")


def _compared(law: type[Law], given: Any) -> list[Any]:
    """The values of the case for the keys of a law, and others for those which the law compares, sorted by these."""
    variants = [given]
    for key, values in law.compared:
        others = {*values, getattr(given, key)}
        variants = [altered(one, {key: value}) for one in variants for value in sorted(others)]
    return variants


def _draw(axes: Axes, number: int, pressure: Array, fraction: Array, label: str, own: bool) -> None:
    axes.plot(
        pressure / BAR,
        fraction,
        color=COLOURS[number % len(COLOURS)],
        linestyle=LINES[number % len(LINES)],
        linewidth=OWN if own else PLAIN,
        label=f"{label} (the case)" if own else label,
    )
