"""Commands for single bearings: `frb bearing` and `frb thrust`, the sheets of films, balls and thrust bearings.

`frb rotation`, `frb squeeze` and `frb whirl`: the kinematic bearing tests of section 4.2.2, and their comparison.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.options import (
    CASE_FILE,
    LENGTH_OPTION,
    LOAD_OPTION,
    REST_OPTION,
    Command,
    cavitation_option,
    film_option,
    forced,
    here,
    speeds_option,
)
from frbcli.cli.progress import OutputOptions, computing, display, outputs_options
from frbcli.cli.studies.static_tables import LITRES_PER_MINUTE, film_document, show_film, show_machine
from frbcli.errors import INTERRUPTED, NotConverged, did_you_mean

if TYPE_CHECKING:
    import pandas as pd

    from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest
    from frbcli.case.schema import Case
    from frbcli.cli.progress import Outputs
    from frbcli.linear.sheets.ball import BallSheet, BallState
    from frbcli.linear.sheets.bearing import BearingSheet
    from frbcli.linear.sheets.film_state import FilmState
    from frbcli.linear.sheets.thrust import ThrustSheet


Item = TypeVar("Item")
FEW_POINTS, SCREEN_ROWS = 2, 8  # points that are always shown in full; rows of all films on one screen
EXPLANATION = (
    "{}. Errors of stiffness and damping are over their largest entry. The rise is with {:.4g} kg/m^3 and "
    "{:.4g} J/(kg K). All per bearing."
)
SETTLED = "Coefficients of mass-conserving films are of oil that has settled; they do not determine stability."

PRESSED = (
    "{} is pressed into its shell, which keeps a gap of {:.2g} um. Damping in so narrow a gap comes from an arc "
    "shorter than an element: hence its error, and real surfaces are rougher than this gap. Let them touch earlier: "
    "contact.eccentricity is {:g}, and 0.99 leaves errors of a few per cent."
)


@click.command(cls=Command)
@case_argument
@click.option("--over", type=click.Choice(["speed", "eccentricity"]), default="speed", show_default=True,
              help="Horizontal axis; over the eccentricity the load is computed.")  # fmt: skip
@speeds_option("20 over the range; with --over eccentricity the highest", REST_OPTION)
@click.option("--load", "loads", type=LOAD_OPTION, multiple=True, metavar="LOAD",
              show_default="the rotor's",
              help='Load along -y on a single film, e.g. "30 N"; repeatable, on each of ball bearings.')  # fmt: skip
@click.option("--ross", metavar="FILE.toml", type=CASE_FILE,
              help="Write stiffness and damping over speed as ROSS reads them, a file per film.")  # fmt: skip
@film_option("Show this film alone, with all of its numbers.", "all")
@click.option("--all", "everything", is_flag=True, help="Show K, C and all speeds of all films.")
@outputs_options("CASE-bearing.png, here")
@output_options
def bearing(
    case: Case,
    over: str,
    speeds: tuple[float, ...],
    loads: tuple[float, ...],
    ross: Path | None,
    film: str | None,
    everything: bool,
    outputs: OutputOptions,
    terminal: Terminal,
) -> int | None:
    """Static equilibrium, coefficients, power loss, oil flow and pressure of every film of CASE."""
    from frbcli.linear.sheets.bearing import bearing_sheet, sommerfeld_chart
    from frbcli.linear.sheets.film_state import heat_capacity
    from frbcli.results.write import ROSS

    if not case.bearings and any(bearing.kind == "ball" for bearing in case.elements):
        if over == "eccentricity" or film is not None:
            raise click.UsageError("A ball bearing has no film: --over eccentricity and --film are of films.")
        return ball_sheet(case, speeds, loads, ross, outputs, terminal)
    if len(loads) > 1:
        raise click.UsageError("A film has one --load; several are of ball bearings.")
    if speeds and min(speeds) == 0.0:
        raise click.UsageError("--speed is 0: a film carries nothing there.")
    load = loads[0] if loads else None
    _check_options(over, speeds, load, ross)
    _check_film(case, film)
    elements = _ross_files(case, ross)
    places = outputs.check(here(case.name, "-bearing.png"), *((file, ROSS) for file in elements.values()))
    with computing(terminal, case, kernels="rest") as shown:
        if over == "speed":
            sheet = bearing_sheet(case, speeds or None, load, shown.counting())
        else:
            sheet = sommerfeld_chart(case, speed_Hz=speeds[0] if speeds else None, observe=shown.counting())
    _show_films(terminal, sheet, (film,) if film is not None else sheet.films, everything or film is not None)
    oil = {"oil_density_kg_m3": case.oil.density, "oil_heat_capacity_J_kg_K": heat_capacity(case)}
    return _written(terminal, sheet, sheet.to_pandas(), elements, places, {"over": over, **oil})


def _check_options(over: str, speeds: tuple[float, ...], load: float | None, ross: Path | None) -> None:
    if over == "eccentricity" and (load is not None or len(speeds) > 1):
        raise click.UsageError("Over eccentricity there is one --speed and no --load: the load follows from the films.")
    if over == "eccentricity" and ross is not None:
        raise click.UsageError("--ross is a table over speed.")


def _check_film(case: Case, film: str | None) -> None:
    from frbcli.scene.films import bearing_films

    names = [place.name for place in bearing_films(case)]
    if film is not None and film not in names:
        known = did_you_mean(film, names) if any(names) else "It has one film, without a name."
        raise click.UsageError(f"--film {film} is not a film of {case.name}. {known}")


def _ross_files(case: Case, ross: Path | None) -> dict[str, Path]:
    """The file for ROSS of each film, if they are asked for."""
    if ross is None:
        return {}
    from frbcli.results.export import ross_files
    from frbcli.scene.films import bearing_films

    return ross_files(ross, [place.name for place in bearing_films(case)])


def _written(
    terminal: Terminal, sheet: BearingSheet | BallSheet, table: pd.DataFrame, elements: dict[str, Path],
    places: Outputs, more: dict[str, Any],
) -> int | None:  # fmt: skip
    """Write the files of a sheet and its JSON document; the exit code. table: of the sheet, with a column "film", of
    ball bearings their names; elements: the files for ROSS; more: of the document."""
    from frbcli.results.export import write_ross

    for film, path in elements.items():
        write_ross(table[table["film"] == film], path, forced())
        terminal.result(f"ROSS: {path}")
    document = {"command": "bearing", "case": sheet.case.name, **more, "points": sheet.table().documents()}
    terminal.emit({**document, **places.write(terminal, sheet), "ross": list(elements.values()) or None})
    return None if any(not point.problem for point in sheet.points) else NotConverged.exit_code


def _show_problems(terminal: Terminal, points: Sequence[FilmState] | Sequence[BallState]) -> None:
    problems = [point for point in points if point.problem]
    if problems:
        terminal.result(f"No state at {len(problems)} of {len(points)} points. The first: {problems[0].problem}")


def _show_films(terminal: Terminal, sheet: BearingSheet, films: Sequence[str], full: bool) -> None:
    """The sheets of some films; not full: without matrices, at so many of the points as fill a screen, unless there are
    few of them."""
    from frbcli.columns import legend, table_of, with_speeds_in
    from frbcli.linear.columns import FILMS, MATRICES, MIXED, WARM
    from frbcli.linear.sheets.film_state import heat_capacity

    if len(films) > 1:
        _show_machine(terminal, sheet, full)
        if not full:
            _show_notes(terminal, sheet)
            return
    columns, points = with_speeds_in(terminal.speeds, sheet.columns), len(sheet.of(films[0]))
    full = full or points <= FEW_POINTS
    rows = points if full else SCREEN_ROWS
    for film, label in zip(sheet.films, sheet.labels, strict=True):
        if film not in films:
            continue
        name = " ".join(filter(None, (sheet.case.heading, film.replace("_", " "))))
        warm = {} if sheet.case.heat is None else {WARM: "film when everything is warm"}
        mixed = {MIXED: "mixed friction"} if sheet.case.contact.rough else {}
        matrices = dict(zip(MATRICES, ("stiffness K in N/um", "damping C in N s/mm"), strict=True))
        states = table_of(columns, _spread(sheet.of(film), rows))
        for table, title in ({FILMS: f"{name}, {label}"} | mixed | (warm | matrices if full else {})).items():
            terminal.show(title, states, table)
    terminal.sentence(EXPLANATION.format(legend(columns, FILMS), sheet.case.oil.density, heat_capacity(sheet.case)))
    if sheet.case.contact.rough:
        terminal.sentence(f"{legend(columns, MIXED)}.")
    if not full:
        terminal.sentence(f"--all shows stiffness K, damping C and all {points} points.")
    _show_notes(terminal, sheet)


def _show_notes(terminal: Terminal, sheet: BearingSheet) -> None:
    """What limits the numbers: settled oil, films pressed into their shell, points without a state."""
    from frbcli.film.cavitation.table import law_named

    if any(law_named(law).keeps_oil for law in sheet.laws):
        terminal.sentence(SETTLED)
    if sheet.pressed:
        state = max(sheet.pressed, key=lambda each: each.error)
        film = f"The film {state.film.replace('_', ' ')}" if state.film else "The film"
        terminal.sentence(PRESSED.format(film, 1e6 * state.film_thickness_min, sheet.case.contact.eccentricity))
    _show_problems(terminal, sheet.points)


def _show_machine(terminal: Terminal, sheet: BearingSheet, full: bool) -> None:
    """Of several films: a table for each speed with a line for each film and the sum; not full: at few speeds."""
    speeds = list(dict.fromkeys(state.speed_Hz for state in sheet.points))
    shown = speeds if full else _spread(speeds, max(FEW_POINTS, SCREEN_ROWS // len(sheet.films)))
    for speed in shown:
        show_machine(terminal, sheet.case, [state for state in sheet.points if state.speed_Hz == speed])
    if len(shown) < len(speeds):
        terminal.sentence(f"{len(shown)} of {len(speeds)} speeds; --all shows all, with stiffness K and damping C.")
    terminal.sentence("--film FILM shows one film in full.")


def _spread(states: Sequence[Item], rows: int) -> list[Item]:
    """At most so many of the states or speeds, evenly spread, with the first and the last one."""
    if len(states) <= rows:
        return list(states)
    return [states[round(number * (len(states) - 1) / (rows - 1))] for number in range(rows)]


def ball_sheet(
    case: Case, speeds: Sequence[float], loads: Sequence[float], ross: Path | None, outputs: OutputOptions,
    terminal: Terminal,
) -> int | None:  # fmt: skip
    """Compute, show and write the sheet; the exit code."""
    from frbcli.linear.sheets.ball import ball_bearing_sheet
    from frbcli.results.export import ross_files
    from frbcli.results.write import ROSS

    if ross is not None and len(loads) > 1:
        raise click.UsageError("--ross is a table over speed, at one load.")
    names = [bearing.name for bearing in case.elements if bearing.kind == "ball"]
    elements = ross_files(ross, names) if ross is not None else {}
    places = outputs.check(here(case.name, "-bearing.png"), *((file, ROSS) for file in elements.values()))
    with display(terminal) as shown:
        sheet = ball_bearing_sheet(case, speeds or None, loads, shown.counting())
    _show_balls(terminal, sheet)
    return _written(terminal, sheet, sheet.to_pandas().rename(columns={"bearing": "film"}), elements, places, {})


def _show_balls(terminal: Terminal, sheet: BallSheet) -> None:
    from frbcli.columns import legend, table_of, with_speeds_in
    from frbcli.elements.ball import RATING_PRESSURE
    from frbcli.linear.columns import BALL_SHEET, BALLS, FREQUENCIES, STIFFNESSES
    from frbcli.units import display

    for bearing in sheet.bearings:
        name, states = " ".join(filter(None, (sheet.case.heading, bearing))), sheet.of(bearing)
        titles = {BALLS: f"{name}, balls", STIFFNESSES: "rings, um and N/um", FREQUENCIES: "frequencies, Hz"}
        for table, title in titles.items():
            terminal.show(title, table_of(BALL_SHEET, states), table)
    columns = with_speeds_in(terminal.speeds, BALL_SHEET)
    terminal.sentence(f"{legend(columns, BALLS)}. All per bearing, with one ball in the line of the load.")
    dented = [state for state in sheet.points if max(state.inner_p_max, state.outer_p_max) > RATING_PRESSURE]
    if dented:
        share, limit = f"{len(dented)} of {len(sheet.points)} states", display(RATING_PRESSURE, "Pa")
        terminal.sentence(f"{share} have Hertz pressures above {limit}, which leave dents (ISO 76).")
    _show_problems(terminal, sheet.points)


@click.command(cls=Command)
@case_argument
@click.option("--gap", "gaps", multiple=True, type=LENGTH_OPTION, metavar="GAP",
              show_default="10 over the range, without --load",
              help='Gap over the lands, e.g. "12 um". Repeatable.')  # fmt: skip
@click.option("--load", "loads", multiple=True, type=LOAD_OPTION, metavar="LOAD",
              help='Load, e.g. "40 N". Repeatable.')  # fmt: skip
@speeds_option("the highest of CASE")
@outputs_options("CASE-thrust.png, here")
@output_options
def thrust(
    case: Case,
    gaps: tuple[float, ...],
    loads: tuple[float, ...],
    speeds: tuple[float, ...],
    outputs: OutputOptions,
    terminal: Terminal,
) -> None:
    """Load, loss, oil flow, pressure, stiffness and damping of every thrust bearing of CASE."""
    from frbcli.linear.sheets.thrust import thrust_sheet

    places = outputs.check(here(case.name, "-thrust.png"))
    with display(terminal) as shown:
        sheet = thrust_sheet(case, gaps or None, speeds or None, loads, shown.counting())
    _show_thrust(terminal, sheet)
    terminal.emit(
        {
            "command": "thrust",
            "case": case.name,
            "points": sheet.table().documents(),
            **places.write(terminal, sheet),
        }
    )


def _show_thrust(terminal: Terminal, sheet: ThrustSheet) -> None:
    from frbcli.columns import legend, table_of, with_speeds_in
    from frbcli.linear.columns import FILMS, THRUST, TILT_DAMPING, TILT_STIFFNESS

    titles = {FILMS: "thrust bearing", TILT_STIFFNESS: "stiffness in tilt, N m", TILT_DAMPING: "damping in tilt, N m s"}
    for bearing in sheet.bearings:
        rows = table_of(THRUST, sheet.of(bearing))
        terminal.result(" ".join(filter(None, (sheet.case.heading, bearing))))
        for table, title in titles.items():
            terminal.show(title, rows, table)
    for speed in dict.fromkeys(state.speed_Hz for state in sheet.points):
        states = [state for state in sheet.points if state.speed_Hz == speed]
        if len(sheet.bearings) > 1 and [state.bearing for state in states] == list(sheet.bearings):
            power = sum(state.power for state in states)
            flow = sum(state.flow_inner + state.flow_outer for state in states)
            whole = f"{power:.4g} W loss, {LITRES_PER_MINUTE * flow:.3g} l/min oil"
            terminal.sentence(f"All thrust bearings at {terminal.speeds.words(speed)}: {whole}.")
    explained = legend(with_speeds_in(terminal.speeds, THRUST), FILMS)
    terminal.sentence(f"{explained}. Errors are the change from a mesh of half as many elements per side.")


LARGEST = "Values are from the moment of the largest force."


def _command(test: str, description: str) -> Callable[..., Any]:
    """The command of a test."""

    @click.command(cls=Command, help=description)
    @case_argument
    @cavitation_option
    @outputs_options(f"CASE-{test}.png, here")
    @output_options
    def command(case: Case, cavitation: tuple[str, ...], outputs: OutputOptions, terminal: Terminal) -> int | None:
        return run_test(case, test, cavitation, outputs, terminal)

    return command


rotation = _command(
    "rotation", "Rotation of a journal at a displacement or under a load: pressure, forces, torque, oil."
)
squeeze = _command("squeeze", "Vertical oscillation of a journal (4.47): force over time.")
whirl = _command("whirl", "Circular motion of a journal (4.48): pressure at the bottom of the bearing over time.")


def run_test(
    case: Case, test: str, cavitation: tuple[str, ...], options: OutputOptions, terminal: Terminal,
    compared: bool = False,
) -> int | None:  # fmt: skip
    """Run a test, print and draw it; its exit code. compared: write the document of `frb compare`."""
    from frbcli.bearing_tests import kinematic

    outputs = options.check(here(case.name, f"-{'compare' if compared else test}.png"))
    tests = {"rotation": kinematic.rotation, "squeeze": kinematic.squeeze, "whirl": kinematic.whirl}
    with computing(terminal, case, kernels="rest") as shown:
        outcome = tests[test](case, cavitation, shown.counting())
    _report_test(outcome, terminal)
    head = {"command": "compare", "case": case.name, "test": test} if compared else {"command": test, "case": case.name}
    whole = {} if outcome.complete else {"status": "interrupted"}
    terminal.emit({**head, **whole, "results": [_test_document(outcome, result) for result in outcome.results]})
    if all(result.loads is None for result in outcome.results):
        outputs = replace(outputs, picture=None)
    outputs.write(terminal, outcome)
    if not outcome.complete:
        return INTERRUPTED
    return NotConverged.exit_code if any(result.status != "ok" for result in outcome.results) else None


def _report_test(test: KinematicTest, terminal: Terminal) -> None:
    """Two tables: forces and oil."""
    from frbcli.bearing_tests.columns import FORCES, GASES, OIL, error_column, force_size, result_columns
    from frbcli.columns import table_of
    from frbcli.scene.films import states_moment

    largest = max(map(force_size, test.results), default=0.0)
    columns = (*result_columns(states_moment(test.case), test.carries_gas), error_column(largest))
    table = table_of(columns, test.results)
    rows: dict[str, list[Sequence[str]]] = {FORCES: [], OIL: []}
    for result, forces, oil in zip(test.results, table.cells(FORCES), table.cells(OIL), strict=True):
        solved = result.loads is not None
        rows[FORCES].append(forces if solved else (forces[0], "none", *[""] * (len(forces) - 2)))
        rows[OIL].append(oil if solved else (oil[0], *[""] * (len(oil) - 2), oil[-1]))
    for name, heading in ((FORCES, f"{test.case.heading}: {test.test}"), (OIL, "")):
        terminal.table(heading, table.heads(name), rows[name], table.spans(name))
    terminal.sentence(f"{table.legend(FORCES)}; {table.legend(OIL)}.")
    if test.carries_gas:
        terminal.show("", table, GASES)
        terminal.sentence(f"{table.legend(GASES)}.")
    for result in test.results:
        if result.heat is not None:
            show_film(terminal, result.heat, f"{result.cavitation}: the film when it is warm")
        if result.stribeck is not None:
            coefficient, speed = result.stribeck.least
            minimum = f"the least coefficient of friction is {coefficient:.3g}, at {terminal.speeds.words(speed)}."
            terminal.sentence(f"{result.cavitation}: {minimum}")
    if test.test != "rotation":
        terminal.result(LARGEST)
    for result in test.results:
        if result.problem:
            terminal.result(f"{result.cavitation}: {result.status}: {result.problem}")
    if not test.complete:
        terminal.result("Interrupted: the other models were not computed.")


def _test_document(test: KinematicTest, result: KinematicResult) -> dict[str, Any]:
    """A result in JSON; null where there is no solution."""
    from frbcli.bearing_tests.columns import STRIBECK, history_columns, result_columns
    from frbcli.columns import document, named
    from frbcli.scene.films import states_moment

    moment = states_moment(test.case)
    history = () if result.plan.test == "rotation" else named(history_columns(moment), "", attrgetter("history"))
    stribeck = () if result.stribeck is None else named(STRIBECK, "", attrgetter("stribeck"))
    row = document((*result_columns(moment, test.carries_gas), *history, *stribeck), result)
    return row if result.heat is None else row | {"thermal": film_document(result.heat)}
