"""Kinematic tests. A rotation: pressure, gap and oil fraction along the mid-line (figures 4.13, 4.14), and maps of one
section; a squeeze or a whirl over its periods: the force or the pressure at the probe, with the gap (figures 4.15,
4.16)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from frbcli.arrays import Array
from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest
from frbcli.bearing_tests.steady_film import FilmField
from frbcli.film.cavitation.table import label_of
from frbcli.plot.style import COLOURS, GREY, LEVEL_MAP, legend_below, new_figure, plain_numbers, styled

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
        gap.plot(phi, values, **(look if _moved(solved) else {"color": GREY}))
    if len(solved) > 1:
        pressure.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    pressure.set_title("along the middle of the film")
    pressure.set_ylabel("pressure in bar")
    gap.set_ylabel("gap H")
    gap.set_ylim(bottom=0.0)
    for axes in oil:
        axes.set_ylabel("oil fraction")
        axes.set_ylim(0.0, 1.05)
    lowest = [gap, *oil][-1]
    lowest.set_xlim(0.0, 360.0)
    lowest.set_xticks(range(0, 361, 45))
    lowest.set_xlabel("φ in ° (0 at the top, counter-clockwise)")


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
        lowest.set_xlim(0.0, 360.0)
        lowest.set_xticks(range(0, 361, 90))
        lowest.set_xlabel("φ in °; z from 0 to 1 along the section")
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
        axes.set_xlabel("speed in Hz (line: of this test)")
        axes.set_ylabel(label)


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


def _moved(solved: list[KinematicResult]) -> bool:
    """Whether the models' journals rest at different places."""
    return len({result.displacement for result in solved}) > 1


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
