"""What `frb rotation`, `frb squeeze`, `frb whirl` and their comparison share: options, table, JSON."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import attrgetter
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.bearings.heat import film_document, tell_film
from frbcli.cli.common import Names, Terminal
from frbcli.cli.files import OUTPUT, check_outputs, here
from frbcli.cli.pictures.pictures import draw
from frbcli.cli.runs.compiling import compilation_shown
from frbcli.cli.runs.live import counting, live_lines
from frbcli.errors import INTERRUPTED, NotConverged

if TYPE_CHECKING:
    from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest
    from frbcli.case.schema import Case

WIDTH = 80
LARGEST = "Values are those of the moment of the largest force."


def kinematic_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command --cavitation, -o and --picture."""
    cavitation = click.option(
        "--cavitation", type=Names(), default=(), metavar="A,B", help="Cavitation models. [that of CASE]"
    )
    output = click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [CASE-TEST.png]")
    picture = click.option("--picture/--no-picture", default=True, help="A picture of all models.")
    decorated: Callable[..., Any] = cavitation(output(picture(function)))
    return decorated


def run_test(
    case: Case,
    test: str,
    cavitation: tuple[str, ...],
    output: Path | None,
    picture: bool,
    terminal: Terminal,
    compared: bool = False,
) -> int | None:
    """Run a test, print and draw it; its exit code. compared: the document is that of `frb compare`."""
    from frbcli.bearing_tests import kinematic

    target = output or here(case.name, f"-{test}.png")
    check_outputs(picture=target if picture else None)
    tests = {"rotation": kinematic.rotation, "squeeze": kinematic.squeeze, "whirl": kinematic.whirl}
    with live_lines(terminal) as show, compilation_shown(terminal, case, show):
        found = tests[test](case, cavitation, counting(terminal, show))
    report(found, terminal)
    results = [result_document(result) for result in found.results]
    head = {"command": "compare", "case": case.name, "test": test} if compared else {"command": test, "case": case.name}
    whole = {} if found.complete else {"status": "interrupted"}
    terminal.emit({**head, **whole, "results": results})
    if picture:
        draw_test(found, target, terminal)
    return exit_code(found)


def exit_code(found: KinematicTest) -> int | None:
    """130 if it was interrupted, 3 if a model did not converge."""
    if not found.complete:
        return INTERRUPTED
    return NotConverged.exit_code if any(result.status != "ok" for result in found.results) else None


def draw_test(found: KinematicTest, target: Path, terminal: Terminal) -> None:
    """The picture of a test, if it has results."""
    from frbcli.plot.machine.film import film_figure
    from frbcli.plot.machine.history import history_figure

    if all(result.loads is None for result in found.results):
        return
    if found.test == "rotation" and all(result.field is None for result in found.results):
        terminal.remark("No picture: a bearing model has no pressure.")
        return
    draw(terminal, lambda: film_figure(found) if found.test == "rotation" else history_figure(found), target)


def report(found: KinematicTest, terminal: Terminal) -> None:
    """Two tables: forces and oil."""
    from frbcli.bearing_tests.columns import FORCES, OIL, RESULT, error_column, force_size
    from frbcli.columns import heads, legend, table_of

    title = found.case.title or found.case.name
    columns = (*RESULT, error_column(max(map(force_size, found.results), default=0.0)))
    table = table_of(columns, found.results)
    rows: dict[str, list[Sequence[str]]] = {FORCES: [], OIL: []}
    for result, forces, oil in zip(found.results, table.cells(FORCES), table.cells(OIL), strict=True):
        solved = result.loads is not None
        rows[FORCES].append(forces if solved else (forces[0], "none", *[""] * (len(forces) - 2)))
        rows[OIL].append(oil if solved else (oil[0], *[""] * (len(oil) - 2), oil[-1]))
    for name, heading in ((FORCES, f"{title}: {found.test}"), (OIL, "")):
        terminal.table(heading, heads(columns, name), rows[name])
    terminal.result(fill(f"{legend(columns, FORCES)}; {legend(columns, OIL)}.", WIDTH))
    for result in found.results:
        if result.heat is not None:
            tell_film(terminal, result.heat, f"{result.name}: the film when it is warm")
    if found.test != "rotation":
        terminal.result(LARGEST)
    for result in found.results:
        if result.problem:
            terminal.result(f"{result.name}: {result.status}: {result.problem}")
    if not found.complete:
        terminal.result("Interrupted: the other models were not computed.")


def result_document(result: KinematicResult) -> dict[str, Any]:
    """A result in JSON; null where there is no solution."""
    from frbcli.bearing_tests.columns import HISTORY, RESULT
    from frbcli.columns import named, table_of

    history = () if result.plan.test == "rotation" else named(HISTORY, "", attrgetter("history"))
    (document,) = table_of((*RESULT, *history), [result]).documents()
    return document if result.heat is None else document | {"thermal": film_document(result.heat)}
