"""`frb check`: the faults of a case, or what will be modelled for it."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.options import Command
from frbcli.cli.studies.static_tables import heat_document, reduction_document, show_heat, show_reduction
from frbcli.columns import document, documents, table_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from frbcli.case.reading.listing import Value as ListedValue
    from frbcli.case.schema import Case
    from frbcli.rotor.loads import SpeedProfile
    from frbcli.runs.second_run import TriedError
    from frbcli.scene.cost import ExpectedCost
    from frbcli.scene.machine.findings import FilmOperation, Findings
    from frbcli.scene.planning.film_choice import Decision, Plan
    from frbcli.scene.planning.plan import ExpectedError


LEAST_TURNING = 0.02  # of the gap
UNTRIED = "; frb check measures it on the machine itself when its kernels are compiled (frb warm-up, or a run)"
BY_CELLS_WITH_RINGS = "machines with rings have 0.1 to 8 times the error of their cells"


@click.command(cls=Command)
@case_argument
@click.option("--all", "everything", is_flag=True, help="Show all values of the case in SI, too.")
@output_options
def command(case: Case, everything: bool, terminal: Terminal) -> None:
    """Validate CASE; show what it amounts to and the plan: what will be modelled, what is left out, and why."""
    from frbcli.case.reading.listing import values
    from frbcli.scene.cost import compile_B
    from frbcli.scene.cost_limits import require_affordable
    from frbcli.scene.machine.findings import FILM_OPERATION, findings, operating_points
    from frbcli.scene.planning.cell_choice import run_up_profile
    from frbcli.scene.planning.kinematic_plan import kinematic_plan
    from frbcli.scene.planning.plan import cost_of_run, expected_error, make_plan

    listed = values(case)
    terminal.result(f"{case.name}: {case.title}".rstrip(": "))
    if not case.given_bearings:
        _check_thrust(case, listed, everything, terminal)
        return
    if case.given_rotor is None and not case.bearings:
        _check_balls(case, listed, everything, terminal)
        return
    loads = findings(case)
    _show_findings(case, loads, terminal)
    doubts = _show_remarks(case, terminal)
    _show_values(listed, everything, terminal)
    films = operating_points(case)
    _show(films, terminal)
    kinematic = case.motion is not None and (case.given_rotor is None or case.given_speed is None)
    test = "squeeze" if case.motion is not None and case.motion.frequency else "rotation"
    # after the values, which explain a refused plan
    expected: dict[str, float | int | None] | None = None
    lines: tuple[Decision, ...] = ()
    if kinematic:
        decisions = kinematic_plan(case, test=test).decisions
    else:
        plan, profile = make_plan(case), run_up_profile(case)
        cost, error = cost_of_run(case, plan, profile), expected_error(plan)
        tried, remark = _tried(case, plan, profile, terminal)
        totals = (_about_error(case, plan, error, tried, remark), *_about_cost(cost, compile_B(case), bool(case.films)))
        decisions, lines = plan.decisions, totals
        expected = {
            "eccentricity_error": error.eccentricity if tried is None else tried.error,
            "tried_until_s": None if tried is None else tried.until_s,
            "film_force_error_relative": error.film_force,
            "cpu_s": cost.cpu_s,
            "cpu_before_s": cost.before_s,
            "cpu_after_s": cost.after_s,
            "cpu_second_run_s": cost.second_s,
            "memory_B": cost.memory_B,
            "steps": cost.steps,
            "film_solves": cost.film_solves,
        }
    _show_plan((*decisions, *lines), terminal)
    if not kinematic:  # after the plan, which explains a refusal
        require_affordable(case, plan, cost)
    heat = None if kinematic or case.heat is None else _heat(case, terminal)
    terminal.emit(
        _document(case, listed, decisions)
        | {"findings": _findings_document(case, loads), "remarks": doubts}
        | {"films": documents(FILM_OPERATION, films), "expected": expected}
        | ({} if heat is None else {"thermal": heat})
        | ({"axial": _axial(case)} if case.loads_a_collar and not kinematic else {})
    )


def _check_thrust(case: Case, listed: Sequence[ListedValue], everything: bool, terminal: Terminal) -> None:
    """What `frb thrust` models of a case of thrust bearings alone."""
    from frbcli.scene.gate.static import require_thrust_sheet
    from frbcli.scene.planning.plan import thrust_plan

    _show_values(listed, everything, terminal)
    require_thrust_sheet(case)
    plan = thrust_plan(case)
    _show_plan(plan, terminal)
    terminal.emit(_document(case, listed, plan))


def _show_remarks(case: Case, terminal: Terminal) -> tuple[str, ...]:
    from frbcli.scene.machine.findings import remarks

    doubts = remarks(case)
    for doubt in doubts:
        terminal.sentence(f"Note: {doubt}")
    return doubts


def _check_balls(case: Case, listed: Sequence[ListedValue], everything: bool, terminal: Terminal) -> None:
    """What `frb bearing` models of a case of ball bearings alone."""
    from frbcli.elements.ball import BallBearingElement
    from frbcli.scene.planning.film_choice import Decision

    _show_values(listed, everything, terminal)
    plan = [Decision(*element.line) for element in BallBearingElement.of(case)]
    doubts = _show_remarks(case, terminal)
    _show_plan(plan, terminal)
    terminal.emit(_document(case, listed, plan) | {"remarks": doubts})


def _axial(case: Case) -> dict[str, object]:
    """The collar under its axial load at the top speed, for JSON; the plan shows it on the terminal."""
    from frbcli.linear.columns import AXIAL
    from frbcli.linear.sheets.thrust import axial_state
    from frbcli.scene.gate.rule import run_omega

    return document(AXIAL, axial_state(case, run_omega(case)))


def _show_plan(plan: Sequence[Decision], terminal: Terminal) -> None:
    terminal.table("plan", ("choice", "value", "reason"), [(d.choice, d.value, d.reason) for d in plan])


def _document(case: Case, listed: Sequence[ListedValue], decisions: Sequence[Decision]) -> dict[str, object]:
    """What the JSON of every case has."""
    return {
        "command": "check",
        "case": case.name,
        "title": case.title,
        "status": "ok",
        "values": _value_documents(listed),
        "bare_numbers": _value_documents([value for value in listed if value.bare]),
        "plan": [asdict(decision) for decision in decisions],
    }


def _show_values(listed: Sequence[ListedValue], everything: bool, terminal: Terminal) -> None:
    """All values, where asked for, and the numbers without a unit with how they were read."""
    if everything:
        terminal.table("values", ("key", "SI", "reads"), _values(listed))
    for value in listed:
        if value.bare:
            terminal.sentence(f"Note: {value.key} = {value.value:.12g}: no unit, read as {value.unit}.")


def _value_documents(values: Sequence[ListedValue]) -> list[dict[str, object]]:
    return [{"key": value.key, "value": value.value, "unit": value.unit} for value in values]


def _heat(case: Case, terminal: Terminal) -> dict[str, object]:
    """Temperatures at the top speed, when everything is warm. They are solutions of the films, whose kernels come from
    disk or are compiled for JSON: a look at a case does not wait for a compiler."""
    from frbcli.cli.progress import computing, display
    from frbcli.compiled import CompilationNeededError, without_compiling
    from frbcli.equilibrium.static_machine import warm_machine
    from frbcli.errors import NotConverged

    try:
        if terminal.json:
            with computing(terminal, case, kernels="rest"):
                warm = warm_machine(case)
        else:
            with display(terminal), without_compiling():
                warm = warm_machine(case)
    except NotConverged as error:
        terminal.sentence(f"No steady temperatures at the top speed: {error}")
        return {"problem": str(error)}
    except CompilationNeededError:
        terminal.sentence(
            "Steady temperatures at the top speed are solutions of the films, whose kernels are not compiled yet. "
            "frb warm-up compiles all that this case needs, once; afterwards frb check shows the temperatures."
        )
        return {}
    show_heat(terminal, case, warm, "heat at the top speed, when everything is warm")
    return heat_document(warm)


def _findings_document(case: Case, loads: Findings) -> dict[str, object]:
    from frbcli.scene.machine.findings import FILM_LOADS, FILM_TILTS
    from frbcli.scene.machine.turbocharger import shaft_of

    return {
        "mass_kg": loads.mass,
        "natural_frequencies_Hz": loads.frequencies_Hz,
        "supported": loads.supported,
        "reduction": None if loads.mass is None else reduction_document(shaft_of(case).reduction),
        "films": documents(FILM_LOADS, loads.films),
        "tilts": documents(FILM_TILTS, loads.tilts),
    }


def _tried(case: Case, plan: Plan, profile: SpeedProfile, terminal: Terminal) -> tuple[TriedError | None, str]:
    """The error of the run as two short ones find it; None without them, and where they would need a compiler, with a
    remark for that."""
    from frbcli.scene.planning.plan import planned_trial

    trial = planned_trial(case, plan, profile)
    if trial is None or (terminal.quiet and not terminal.json):  # nobody reads it
        return None, ""
    from frbcli.cli.progress import display
    from frbcli.compiled import CompilationNeededError, without_compiling
    from frbcli.runs.second_run import tried_error

    try:
        with display(terminal), without_compiling():
            return tried_error(case, trial), ""
    except CompilationNeededError:
        return None, UNTRIED


def _about_error(case: Case, plan: Plan, error: ExpectedError, tried: TriedError | None, remark: str) -> Decision:
    """The line of the expected error. remark: why a machine is not tried, "" without a remark."""
    from frbcli.scene.films import rings
    from frbcli.scene.planning.film_choice import Decision

    if tried is not None:
        around, along = tried.cells
        until = f"until {tried.until_s:.2g} s, {case.speed_unit.words(tried.speed_Hz)}"
        parts = f"of the eccentricities {until}, from short runs on these and on {around} x {along} cells"
        return Decision("expected error", f"{tried.error:.2g}", parts)
    parts = "of the eccentricities before a whirl grows" if case.films else "of the displacements, over the length"
    if plan.form.by_cells and rings(case):
        parts += f"; {BY_CELLS_WITH_RINGS}"
    parts += remark
    if error.film_force is not None:
        parts += f"; film forces {error.film_force:.1g}, relative"
    return Decision("expected error", f"{error.eccentricity:.1g}", parts)


def _about_cost(cost: ExpectedCost, compile_B: float, with_films: bool) -> tuple[Decision, ...]:
    """Expected cost, the last lines of the plan; compile_B: memory of the first start, which compiles."""
    from frbcli.scene.cost import clock
    from frbcli.scene.cost_limits import memory
    from frbcli.scene.planning.film_choice import Decision

    solved = f", {cost.film_solves} film solves" if with_films else ""
    solves = f"{cost.steps} steps{solved}, on one core of a server"
    parts = f"{clock(cost.before_s)} before the first step, {clock(cost.after_s)} for the error at the end"
    if cost.second_s:
        parts += f", {clock(cost.second_s)} for the uncertainty of its events"
    first = memory(max(cost.memory_B, compile_B))
    return (
        Decision("expected cost", f"{clock(cost.cpu_s)} of CPU time", solves),
        Decision("before, after", clock(cost.total_s - cost.cpu_s), parts),
        Decision("memory", memory(cost.memory_B), f"of the whole process; {first} where it compiles the kernels"),
    )


def _show_findings(case: Case, loads: Findings, terminal: Terminal) -> None:
    from frbcli.scene.machine.findings import FILM_LOADS, FILM_TILTS
    from frbcli.scene.machine.turbocharger import shaft_of

    if loads.mass is not None:
        terminal.sentence(loads.rotor)
        show_reduction(terminal, shaft_of(case).reduction)
    if loads.films:
        terminal.show("static loads, at the top speed", table_of(FILM_LOADS, loads.films))
    if loads.tilts:
        terminal.show("tilt of the journals", table_of(FILM_TILTS, loads.tilts))
    tilting = ", ".join(f"{film.film or 'the film'} by {film.change:.0%}" for film in loads.tilts if film.matters)
    if tilting:
        terminal.sentence(f"Note: as journals tilt, the gap at the ends changes, in {tilting}. {_about_tilt(case)}")


def _about_tilt(case: Case) -> str:
    """What results make of the tilt of journals, with the setting for it where the case allows it."""
    from frbcli.case.model import altered
    from frbcli.scene.gate.gate import faults
    from frbcli.scene.gate.rule import RUN, STABILITY

    if case.film.tilt == "follows":
        return "The films follow it."
    follows = altered(case, {"film": altered(case.film, {"tilt": "follows"})})
    if faults(follows, STABILITY):
        return "Results take the gap as even along the axis."
    runs = "" if faults(follows, RUN) else "runs, "
    return f'With film.tilt = "follows" {runs}stability, damped modes and response follow it.'


def _values(listed: Sequence[ListedValue]) -> Iterator[tuple[str, str, str]]:
    """The values, each under the name of its table: the full names would be too wide."""
    table = ""
    for value in listed:
        holder, _, key = value.key.rpartition(".")
        if holder != table:
            table = holder
            yield (f"[{holder}]" if holder else "", "", "")
        yield (key, *value.cells)


def _show(films: tuple[FilmOperation, ...], terminal: Terminal) -> None:
    from frbcli.scene.machine.findings import FILM_OPERATION

    if films:
        terminal.show("films at the top speed", table_of(FILM_OPERATION, films))
    turbulent = ", ".join(f"{film.reynolds:.0f} in {film.name}" for film in films if not film.laminar)
    if turbulent:
        terminal.sentence(
            f"Warning: Reynolds number {turbulent}, not below 2300: the flow is not laminar, as the Reynolds equation "
            "assumes."
        )
    grown = [film for film in films if abs(film.turning) > LEAST_TURNING * film.clearance]
    if grown:
        changes = ", ".join(f"of {film.name} by {film.turning / film.clearance:+.0%}" for film in grown)
        terminal.sentence(
            f"Note: centrifugal growth of shaft and rings changes the gap {changes}. Runs "
            'include it with thermal.centrifugal_growth = "follows"; without it, add it to the clearance if needed.'
        )
