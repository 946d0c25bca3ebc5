"""`frb rotation`, `frb squeeze`, `frb whirl`: the kinematic bearing tests of section 4.2.2, and their comparison."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import here
from frbcli.cli.machines.static_tables import film_document, show_film
from frbcli.cli.options import Command, cavitation_option
from frbcli.cli.progress import OutputOptions, computing, outputs_options
from frbcli.errors import INTERRUPTED, NotConverged

if TYPE_CHECKING:
    from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest
    from frbcli.case.schema import Case

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
    _report(outcome, terminal)
    head = {"command": "compare", "case": case.name, "test": test} if compared else {"command": test, "case": case.name}
    whole = {} if outcome.complete else {"status": "interrupted"}
    terminal.emit({**head, **whole, "results": [_document(outcome, result) for result in outcome.results]})
    if all(result.loads is None for result in outcome.results):
        outputs = replace(outputs, picture=None)
    outputs.write(terminal, outcome)
    if not outcome.complete:
        return INTERRUPTED
    return NotConverged.exit_code if any(result.status != "ok" for result in outcome.results) else None


def _report(test: KinematicTest, terminal: Terminal) -> None:
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


def _document(test: KinematicTest, result: KinematicResult) -> dict[str, Any]:
    """A result in JSON; null where there is no solution."""
    from frbcli.bearing_tests.columns import STRIBECK, history_columns, result_columns
    from frbcli.columns import document, named
    from frbcli.scene.films import states_moment

    moment = states_moment(test.case)
    history = () if result.plan.test == "rotation" else named(history_columns(moment), "", attrgetter("history"))
    stribeck = () if result.stribeck is None else named(STRIBECK, "", attrgetter("stribeck"))
    row = document((*result_columns(moment, test.carries_gas), *history, *stribeck), result)
    return row if result.heat is None else row | {"thermal": film_document(result.heat)}
