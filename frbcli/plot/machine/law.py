"""Oil fraction over pressure: the two-phase step for several steepnesses (figure 4.10), the models in one diagram
(figure 4.11)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from frbcli.arrays import Array
from frbcli.case.model import altered
from frbcli.film.cavitation.law import FilmOil, Law
from frbcli.film.cavitation.table import label_of, laws
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.plot.style import (
    COLOURS,
    GREY,
    Picture,
    new_figure,
    styled,
)
from frbcli.scene.gate.gate import require

if TYPE_CHECKING:
    from frbcli.case.schema import Case


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
