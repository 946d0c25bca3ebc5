"""Films. A rotation: pressure, gap and oil fraction along the mid-line (figures 4.13, 4.14), and maps of one section; a
squeeze or a whirl over its periods: the force or the pressure at the probe, with the gap (figures 4.15, 4.16).

Cavitation laws, oil fraction over pressure: the two-phase step for several steepnesses (figure 4.10), the models in one
diagram (figure 4.11).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.arrays import Array
from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest
from frbcli.bearing_tests.steady_film import FilmField
from frbcli.case.model import altered
from frbcli.film.cavitation.law import FilmOil, Law
from frbcli.film.cavitation.table import label_of, laws
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.plot.style import (
    COLOURS,
    GREY,
    LEVEL_MAP,
    Picture,
    legend_below,
    new_figure,
    plain_numbers,
    styled,
)
from frbcli.scene.gate.gate import require

if TYPE_CHECKING:
    from frbcli.case.schema import Case


BAR = 1e5
FULL = 0.999  # oil fraction
DEGREES = 180.0 / np.pi
LINES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (6, 1.5, 1.5, 1.5)))
NARROWEST, WIDER = 1.0, 0.45  # lines of the last model and by how much each before it is wider, so that it stays seen
MAP_HEIGHT = 1.15  # inches of the maps of a model
FRICTION_HEIGHT = 2.4  # inches of the Stribeck curve

HEIGHT = 5.4


def film_figure(test: KinematicTest) -> Figure:
    """Mid-lines of all models above, maps of pressure and oil fraction below, a row for each model with a solution."""
    solved = [result for result in test.results if result.field is not None]
    with styled():
        motion = test.case.motion
        speed = motion.speed if motion is not None and motion.speed else 0.0
        words = f"rotation with {speed:g} Hz"
        if len(solved) == 1 or motion is None or motion.load is None:
            words += f", eccentricity {float(np.hypot(*solved[0].displacement)):.4g}"
        heights = [5.2, MAP_HEIGHT * len(solved) + 0.4]
        if any(result.stribeck for result in solved):
            heights.append(FRICTION_HEIGHT)
        figure = new_figure(test.case.heading, words, height=sum(heights))
        parts: Any = figure.subfigures(len(heights), 1, height_ratios=heights)
        _draw_lines(parts[0], solved)
        _draw_maps(parts[1], solved)
        for part in parts[2:]:
            _draw_friction(part, solved, abs(speed))
    return figure


def _draw_lines(figure: Any, solved: list[KinematicResult]) -> None:
    fields = [result.field for result in solved if result.field is not None]
    moved = len({result.displacement for result in solved}) > 1  # the models' journals rest at different places
    cavitates = any(field.fraction.min() < 1.0 for field in fields)  # else its oil fraction is 1 everywhere
    pressure, gap, *oil = figure.subplots(
        3 if cavitates else 2, 1, sharex=True, height_ratios=(2.4, 1.0, 1.3)[: 2 + cavitates]
    )
    for number, (result, field) in enumerate(zip(solved, fields, strict=True)):
        look = _look(number, len(solved))
        phi, values = mid_line(field, field.pressure, result.plan.section.far)
        pressure.plot(phi, values / BAR, label=label_of(result.cavitation), **look)
        for axes in oil:
            axes.plot(*mid_line(field, field.fraction, result.plan.section.far), **look)
        phi, values = _turn(field, field.gap)
        gap.plot(phi, values, **(look if moved else {"color": GREY}))
    if len(solved) > 1:
        pressure.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    pressure.set(title="along the middle of the film", ylabel="pressure in bar")
    gap.set_ylabel("gap H")
    gap.set_ylim(bottom=0.0)
    for axes in oil:
        axes.set(ylabel="oil fraction", ylim=(0.0, 1.05))
    lowest = [gap, *oil][-1]
    lowest.set(xlim=(0.0, 360.0), xticks=range(0, 361, 45), xlabel="φ in ° (0 at the top, counter-clockwise)")


def _draw_maps(figure: Any, solved: list[KinematicResult]) -> None:
    """A map of pressure for each model, and one of the oil fraction for those whose film is not full everywhere."""
    fields = [result.field for result in solved if result.field is not None]
    cavitated = [number for number, field in enumerate(fields) if float(field.fraction.min()) < FULL]
    rows = figure.subplots(len(solved), 2 if cavitated else 1, sharex=True, sharey=True, squeeze=False)
    maps = [("pressure", "pressure in bar", [field.pressure / BAR for field in fields], list(range(len(fields))))]
    if cavitated:
        maps.append(("oil fraction", "oil fraction", [field.fraction for field in fields], cavitated))
    for column, (what, label, values, shown) in enumerate(maps):
        low, high = (float(of([of(values[number]) for number in shown])) for of in (np.min, np.max))
        for number, (axes, result, field) in enumerate(zip(rows[:, column], solved, fields, strict=True)):
            axes.set_visible(number in shown)
            if number in shown:
                phi, turned = _turn(field, values[number])
                axes.grid(visible=False)
                mesh = axes.pcolormesh(
                    phi, field.z, turned.T, cmap=LEVEL_MAP, vmin=low, vmax=high if high > low else low + 1.0,
                    shading="nearest", rasterized=True,
                )  # fmt: skip
                axes.set_title(f"{label_of(result.cavitation)}, {what}", fontsize=9.0)
        bar = figure.colorbar(mesh, ax=rows[:, column], location="bottom", shrink=0.8, aspect=35)
        bar.set_label(label)
        bar.outline.set_visible(False)
        lowest = rows[shown[-1], column]
        lowest.tick_params(labelbottom=True)
        lowest.set(xlim=(0.0, 360.0), xticks=range(0, 361, 90), xlabel="φ in °; z from 0 to 1 along the section")
    for axes in rows[:, 0]:
        axes.set_ylabel("z", fontsize=8.0)


def _draw_friction(figure: Any, solved: list[KinematicResult], speed: float) -> None:
    """Stribeck curve and share of the asperities, with a line at the speed of the test in Hz."""
    panels = figure.subplots(1, 2, sharex=True)
    for number, curve in enumerate(result.stribeck for result in solved):
        if curve is not None:
            for axes, values in zip(panels, (curve.friction_coefficient, curve.asperity_share), strict=True):
                axes.plot(curve.speed, values, **_look(number, len(solved)))
    panels[0].set_yscale("log")
    plain_numbers(panels[0].yaxis)
    for axes, label in zip(panels, ("coefficient of friction", "share of asperities"), strict=True):
        axes.axvline(speed, color=GREY, linewidth=0.8)
        axes.set_xscale("log")
        plain_numbers(axes.xaxis)
        axes.set(xlabel="speed in Hz (line: of this test)", ylabel=label)


def _look(number: int, count: int) -> dict[str, Any]:
    """Colour, dashes and width of the curve of a model, by its number."""
    width = NARROWEST + WIDER * (count - 1 - number)
    return {"color": COLOURS[number % len(COLOURS)], "linestyle": LINES[number % len(LINES)], "linewidth": width}


def mid_line(field: FilmField, values: Array, far: str) -> tuple[Array, Array]:
    """(phi in deg, values) in the middle: at the plane of symmetry of half a film, else half-way along the section."""
    if far == "symmetry":
        return _turn(field, values[:, -1])
    return _turn(field, np.array([np.interp(0.5, field.z, row) for row in values]))


def _turn(field: FilmField, values: Array) -> tuple[Array, Array]:
    """(phi in deg, values) over one turn from 0 to 360, closed by its neighbours on both sides."""
    phi = np.mod(field.phi, 2.0 * np.pi)
    order = np.argsort(phi)
    phi, values = phi[order] * DEGREES, values[order]
    closed = np.concatenate([[phi[-1] - 360.0], phi, [phi[0] + 360.0]])
    return closed, np.concatenate([values[-1:], values, values[:1]])


def kinematic_figure(test: KinematicTest) -> Figure:
    """The films of a rotation, the history of a squeeze or a whirl."""
    return film_figure(test) if test.test == "rotation" else history_figure(test)


def history_figure(test: KinematicTest) -> Figure:
    """F_y of a squeeze, or the pressure at the probe of a whirl, over time for all models; below, the gap at the
    probe's angle, phi = pi."""
    motion = test.case.motion
    assert motion is not None
    pressures = test.test == "whirl"
    with styled():
        words = f"{test.test} with {motion.frequency:g} Hz, eccentricity {motion.eccentricity:g}"
        if motion.speed:
            words += f", journal turns with {motion.speed:g} Hz"
        if motion.tilt is not None:
            words += ", tilted"
        if len(test.results) == 1:  # else the legend names the models
            words += f", {test.results[0].plan.label}"
        figure = new_figure(test.case.heading, words, height=HEIGHT)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 1.0))
        for number, result in enumerate(test.results):
            history = result.history
            if history is None:
                continue
            values = history.probe_pressure / BAR if pressures else history.force[:, 1]
            label = result.plan.label
            label += "" if result.status == "ok" else ", not converged"
            colour, line = COLOURS[number % len(COLOURS)], LINES[number % len(LINES)]
            above.plot(history.time_s, values, color=colour, linestyle=line, label=label)
            below.plot(history.time_s, history.gap_ratio, color=GREY)
        force = "vertical force on the journal in N"
        above.set_ylabel("pressure at φ = 180°, z = B/4 in bar" if pressures else force)
        below.set_ylabel("gap H\nat φ = 180°")
        below.set_ylim(bottom=0.0)
        below.set_xlabel("time in s")
        below.margins(x=0.0)
        legend_below(figure, above)
    return figure


BAR = 1e5


STEEPNESSES = (0.9, 0.95, 0.99, 0.999)  # x_1, in addition to the case's


DASHES = ((5, 1.5), (1.5, 1), (6, 1.5, 1.5, 1.5), (8, 2), (3, 1, 1, 1, 1, 1))


LAW_LINES: tuple[Any, ...] = ("-", *((0, dash) for dash in DASHES))


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
            axes.set(xlabel="absolute pressure in bar", ylim=(-0.03, 1.06))
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
        linestyle=LAW_LINES[number % len(LAW_LINES)],
        linewidth=OWN if own else PLAIN,
        label=f"{label} (the case)" if own else label,
    )
