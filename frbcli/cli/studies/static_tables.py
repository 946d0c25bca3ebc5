"""Tables of static results. The table of `frb stability` in 80 columns: static equilibria and, for each speed, the
least damped modes; the error of the coefficients that static results are made of; and losses, flows and heat of a
machine at a speed, also as part of a JSON document.

All growing modes are listed, then the least damped ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from frbcli.columns import document, documents, heads, table_of
from frbcli.linear.columns import AXIAL, FILM, MODES, STABILITY

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from frbcli.case.schema import Case
    from frbcli.cli.common import Terminal
    from frbcli.equilibrium.static_machine import FilmTemperature, WarmMachine
    from frbcli.linear.sheets.film_state import FilmState
    from frbcli.linear.stability import Stability
    from frbcli.linear.stability_point import StabilityPoint
    from frbcli.rotor.reduction import Reduction
    from frbcli.thermal.model import SteadyHeat

WARMTH = "film, degC"
MACHINE = ("film", "eps", "h, um", "p, bar", WARMTH, "loss, W", "flow, l/min", "err. K, C")
LITRES_PER_MINUTE, ZERO_CELSIUS = 6e4, 273.15  # of a m^3/s; K
MOST_SPEEDS, MOST_LINES = 20, 40  # of the table; JSON and the picture have every speed
IN_LINE = 2  # in the one line of a single film
NONE = "none"  # no static equilibrium, or no coefficients there


def show_points(terminal: Terminal, analysis: Stability, every_speed: bool) -> None:
    """The table, and the speeds without modes, with the reason at the first of them. every_speed: show all speeds."""
    several = max((len(point.films) for point in analysis.points), default=0) > 1
    films = max(1, *(len(point.films) for point in analysis.points))
    most = min(MOST_SPEEDS, max(1, MOST_LINES // films))
    every = 1 if every_speed else math.ceil(len(analysis.points) / most)
    shown = analysis.points[every - 1 :: every]
    lines, unit = _film_lines if several else _lines, terminal.speeds
    rows = [line for point in shown for line in lines(point, unit.number(point.speed_Hz))]
    place, mode = (heads(columns, STABILITY) for columns in (FILM, MODES))
    columns = (unit.name, "film", *place, *mode) if several else (unit.name, *place, *mode[:2] * IN_LINE, *mode[2:])
    terminal.table(analysis.case.heading, columns, rows)
    if several:
        terminal.result("Modes of the machine: all that grow (damping below 0), then the least damped.")
    if every > 1:
        extent = f"{len(shown)} of {len(analysis.points)} speeds"
        terminal.result(f"{extent}; --json gives all, --speed the given ones.")
    _show_problems(terminal, analysis.points)


def _show_problems(terminal: Terminal, points: Sequence[StabilityPoint]) -> None:
    missing = [point for point in points if point.problem]
    if len(missing) > 1:
        speeds = [point.speed_Hz for point in missing]
        span = terminal.speeds.span(min(speeds), max(speeds))
        terminal.result(f"No modes at {len(missing)} of {len(points)} speeds from {span}. The first of them:")
    for point in missing[:1]:
        terminal.sentence(point.problem)


def _lines(point: StabilityPoint, speed: str) -> list[tuple[str, ...]]:
    """A line of a single film; further ones hold what else grows."""
    if not point.rests:
        return [(speed, NONE, *[""] * (2 * IN_LINE + 2))]
    modes = point.modes_with_errors[: max(IN_LINE, len(point.growing))]
    cells = table_of(MODES, modes).cells(STABILITY)
    place = (table_of(FILM, point.films[:1]).cells(STABILITY) or [("-", "-")])[0]
    lines = []
    for start in range(0, max(1, len(cells)), IN_LINE):
        pairs = [cell for mode in cells[start : start + IN_LINE] for cell in mode[:2]]
        fastest = cells[start][2] if cells else "-"
        head = (speed, *place) if start == 0 else ("",) * 3
        lines.append((*head, *pairs, *[""] * (2 * IN_LINE - len(pairs)), fastest))
    return lines


def _film_lines(point: StabilityPoint, speed: str) -> list[tuple[str, ...]]:
    """A line for each film, with one mode in each."""
    if not point.rests:
        return [(speed, NONE, *[""] * 5)]
    count = max(len(point.films), len(point.growing))
    places = table_of(FILM, point.films).cells(STABILITY)
    films = [(film.name.replace("_", " "), *place) for film, place in zip(point.films, places, strict=True)]
    modes = table_of(MODES, point.modes_with_errors[:count]).cells(STABILITY)
    films += [("",) * 3] * (count - len(films))
    modes += [("",) * 3] * (count - len(modes))
    speeds = [speed, *[""] * (count - 1)]
    return [(head, *film, *mode) for head, film, mode in zip(speeds, films, modes, strict=True)]


def show_coefficient_error(terminal: Terminal, points: Iterable[StabilityPoint]) -> None:
    """The largest error of the coefficients of some points."""
    show_largest_error(terminal, ((film.error, point.speed_Hz) for point in points for film in point.films))


def show_reduction(terminal: Terminal, reduction: Reduction | None) -> None:
    """What the reduction of a shaft keeps, and what that changes."""
    if reduction is not None:
        terminal.sentence(f"Reduction of the shaft to {reduction.words}.")


def reduction_document(reduction: Reduction | None) -> dict[str, float] | None:
    """The same in JSON, None for a shaft that is not reduced."""
    if reduction is None:
        return None
    static = len(reduction.modes.frequencies) - reduction.free
    changes = {"frequency_relative": reduction.frequency, "amplitude_relative": reduction.amplitude}
    return {"free_modes": reduction.free, "static_modes": static, **changes}


def show_collar(terminal: Terminal, analysis: Stability) -> None:
    """Where the collar of the thrust bearing rests at the fastest speed, and what its films are there."""
    at_rest = [point for point in analysis.points if point.axial is not None]
    for point in at_rest[-1:]:
        cells = dict(zip(heads(AXIAL, STABILITY), table_of(AXIAL, [point.axial]).cells(STABILITY)[0], strict=True))
        state = ", ".join(f"{head} {cell}" for head, cell in cells.items())
        terminal.sentence(f"Collar of the thrust bearing at {terminal.speeds.words(point.speed_Hz)}: {state}.")


def show_largest_error(terminal: Terminal, errors: Iterable[tuple[float, float]]) -> None:
    """The largest of some errors of coefficients, each with its speed in Hz; NaN is not known."""
    known = [(error, speed) for error, speed in errors if not math.isnan(error)]
    if known:
        error, speed = max(known)
        terminal.sentence(
            "Expected error of the films' stiffness and damping, from other meshes: up to "
            f"{float(f'{100.0 * error:.1g}'):g} % of their largest entry, at {terminal.speeds.words(speed)}."
        )


def heat_document(warm: WarmMachine) -> dict[str, object]:
    """Temperatures, viscosities, losses and flows, of one bearing each, and the balance of heat."""
    from frbcli.equilibrium.linearised import HEAT_BALANCE, WARM_FILMS, WARM_RINGS

    films, rings = documents(WARM_FILMS, warm.films), documents(WARM_RINGS, warm.rings)
    return {"films": films, "rings": rings, **document(HEAT_BALANCE, warm.steady)}


def show_heat(terminal: Terminal, case: Case, warm: WarmMachine, title: str) -> None:
    """The films and rings of a warm machine, and where its heat goes."""
    from frbcli.equilibrium.linearised import WARM_RINGS

    _show_films(terminal, warm.films, title, "bearing" if _bearings(case) > 1 else "machine")
    if warm.rings:
        terminal.show("rings", table_of(WARM_RINGS, warm.rings))
    _show_balance(terminal, warm.steady)


def show_machine(terminal: Terminal, case: Case, states: Sequence[FilmState]) -> None:
    """The films of a machine at one speed, a line each, their losses and flows in all, and the speeds of its rings."""
    totals = Totals.of(case, states)
    rows = [_machine_row(state) for state in states]
    whole = "both bearings" if totals.bearings > 1 else "machine"
    rows.append((whole, *[""] * 4, f"{totals.power:.4g}", f"{LITRES_PER_MINUTE * totals.flow:.3g}", ""))
    kept = [column for column, head in enumerate(MACHINE) if head != WARMTH or case.heat is not None]
    rows = [tuple(row[column] for column in kept) for row in rows]
    heading = f"{case.heading} at {terminal.speeds.words(totals.speed_Hz)}"
    terminal.table(heading, [MACHINE[column] for column in kept], rows)
    ratios = [f"{name.replace('_', ' ')} {ratio:.3f}" for name, ratio in totals.rings.items()]
    rings = f"; ring speed over rotor speed: {', '.join(ratios)}" if ratios else ""
    terminal.sentence(f"h: smallest film thickness; p: largest absolute pressure{rings}.")


def _machine_row(state: FilmState) -> tuple[str, ...]:
    warm = "-" if math.isnan(state.temperature) else f"{state.temperature - ZERO_CELSIUS:.1f}"
    numbers = (f"{state.eccentricity:.3f}", f"{1e6 * state.film_thickness_min:.3g}", f"{1e-5 * state.p_max:.3g}", warm,
               f"{state.power:.4g}", f"{LITRES_PER_MINUTE * state.side_flow:.3g}", f"{state.error:.0e}")  # fmt: skip
    return (state.film.replace("_", " ") or "bearing", *("-" if number == "nan" else number for number in numbers))


@dataclass(frozen=True)
class Totals:
    """A whole machine at a speed in Hz: power in W and flow in m^3/s of its bearings, rings: their speeds over the
    rotor's, by bearing; bearings: 2 where the films are of one of two equal bearings."""

    speed_Hz: float
    power: float
    flow: float
    rings: dict[str, float]
    bearings: int

    @classmethod
    def of(cls, case: Case, states: Sequence[FilmState]) -> Totals:
        """Of the states of all films at one speed; unknown ones count as nothing."""
        bearings, speed = _bearings(case), states[0].speed_Hz
        power, flow = (bearings * sum(value for value in values if not math.isnan(value))
                       for values in ([s.power for s in states], [s.side_flow for s in states]))  # fmt: skip
        rings = {state.film.rpartition("_")[0] or "ring": state.shell_speed_Hz / speed for state in states
                 if speed and state.shell_speed_Hz and state.film.endswith("inner")}  # fmt: skip
        return cls(speed, power, flow, rings, bearings)


def _bearings(case: Case) -> int:
    """Number of equal bearings, of which the films of a case are one."""
    return 2 if case.given_rotor is not None and case.rotor.symmetric else 1


def machine_document(terminal: Terminal, case: Case, speed_Hz: float) -> dict[str, object]:
    """Losses, flows and ring speeds of a machine at a speed, in JSON, which are shown, too; empty where they are not
    supported, and with heat, whose own table has them."""
    from frbcli.linear.sheets.bearing import bearing_sheet
    from frbcli.scene.gate.gate import faults
    from frbcli.scene.gate.rule import BEARING

    if speed_Hz == 0.0 or case.heat is not None or faults(case, BEARING):
        return {}
    sheet = bearing_sheet(case, [speed_Hz])
    show_machine(terminal, case, sheet.points)
    totals = Totals.of(case, sheet.points)
    whole = {"power_W": totals.power, "side_flow_m3_s": totals.flow, "ring_speed_ratios": totals.rings}
    return {"machine": {"speed_Hz": speed_Hz, **whole, "films": sheet.table().documents()}}


def film_document(steady: SteadyHeat) -> dict[str, object]:
    """The heat of a single film, of a bearing test."""
    from frbcli.equilibrium.linearised import HEAT_BALANCE, WARM_FILMS
    from frbcli.equilibrium.static_machine import film_temperatures

    return {"films": documents(WARM_FILMS, film_temperatures(steady, [""])), **document(HEAT_BALANCE, steady)}


def show_film(terminal: Terminal, steady: SteadyHeat, title: str) -> None:
    """A single film when it is warm, and where its heat goes."""
    from frbcli.equilibrium.static_machine import film_temperatures

    _show_films(terminal, film_temperatures(steady, [""]), title)
    _show_balance(terminal, steady)


def _show_films(terminal: Terminal, films: Sequence[FilmTemperature], title: str, whole: str = "") -> None:
    from frbcli.equilibrium.linearised import WARM_FILMS

    table = table_of(WARM_FILMS, films)
    rows = table.cells()
    if len(films) > 1:  # loss and flow
        power, flow = sum(film.power for film in films), sum(film.flow for film in films)
        rows.append((whole, *[""] * (len(rows[0]) - 3), f"{power:.4g}", f"{LITRES_PER_MINUTE * flow:.3g}"))
    terminal.table(title, table.heads(), rows)


def _walls(given: float) -> str:
    return f"{abs(given):.4g} W {'flow into' if given >= 0.0 else 'come from'} shaft and housing"


def _show_balance(terminal: Terminal, steady: SteadyHeat) -> None:
    terminal.sentence(
        f"Heat: {steady.carried:.4g} W leave with the oil, {_walls(steady.given)}; "
        f"{steady.balance:.0e} of it unaccounted for."
    )
