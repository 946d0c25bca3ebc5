"""`frb accuracy`: cost against error."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Names, Terminal, case_argument, output_options
from frbcli.cli.files import OUTPUT, check_outputs, here
from frbcli.cli.pictures.picture_options import picture_options
from frbcli.cli.pictures.pictures import draw
from frbcli.cli.quantities import TIME_OPTION
from frbcli.cli.runs.compiling import compilation_shown
from frbcli.cli.runs.live import live_lines, of_runs
from frbcli.columns import short_number
from frbcli.errors import INTERRUPTED

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.columns import Columns
    from frbcli.studies.ladder import AccuracyLadder, RungResult

EXPLANATION = "* choice of the plan, + on Pareto's front; {}."
WIDTH = 80


@click.command()
@case_argument
@click.option("--until", type=TIME_OPTION, metavar="TIME", help="Shorten the run, e.g. to '2 s'. [that of CASE]")
@click.option("--theory", type=Names(), default=(), metavar="A,B", help="Film theories. [all that apply]")
@click.option("--coupling", type=Names(), default=(), metavar="A,B", help="Couplings with the rotor. [that of CASE]")
@click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [CASE-accuracy.png, here]")
@click.option("--picture/--no-picture", default=True, help="A picture of error over cost.")
@picture_options
@output_options
def command(
    case: Case,
    until: float | None,
    theory: tuple[str, ...],
    coupling: tuple[str, ...],
    output: Path | None,
    picture: bool,
    terminal: Terminal,
) -> int:
    """Run CASE up on a ladder of theories, meshes and tolerances against a fine reference: error over cost."""
    from frbcli.studies.accuracy import accuracy
    from frbcli.studies.ladder_columns import RESULT, RUNG

    target = output or here(case.name, "-accuracy.png")
    check_outputs(picture=target if picture else None)
    with live_lines(terminal) as show, compilation_shown(terminal, case, show):
        tell = of_runs(terminal, show)
        found = accuracy(case, until, theory, coupling, lambda rung, *rest: tell(rung.name, *rest))
    _report(found, terminal)
    (coarser,), (reference,) = _documents(RUNG, [found.coarser]), _documents(RESULT, [found.reference])
    reference |= _stated(found.reference) | {"compared_with": coarser, "change": reference.pop("error")}
    rungs = zip(found.table().documents(), found.ladder, strict=True)
    ended = zip(_documents(RUNG, [rung for rung, _ in found.failed]), found.failed, strict=True)
    failed = [document | {"message": problem} for document, (_, problem) in ended]
    terminal.emit({
        "command": "accuracy",
        "case": case.name,
        **({} if found.complete else {"status": "interrupted"}),
        "until_s": found.until_s,
        "reference": reference,
        "ladder": [document | _stated(item) for document, item in rungs],
        **({"failed": failed} if found.failed else {}),
    })
    if picture and found.ladder:
        from frbcli.plot.studies.accuracy import accuracy_figure

        draw(terminal, lambda: accuracy_figure(found), target)
    return 0 if found.complete else INTERRUPTED


def _report(found: AccuracyLadder, terminal: Terminal) -> None:
    from frbcli.columns import heads, legend
    from frbcli.studies.ladder_columns import LADDER

    rows = found.table().cells()
    if len({item.rung.coupling for item in found.ladder}) > 1:
        rows = [(mark, "\n".join((film, item.rung.coupling.replace("-", "-\n"))), *rest)
                for item, (mark, film, *rest) in zip(found.ladder, rows, strict=True)]  # fmt: skip
    terminal.table(f"{found.case.title or found.case.name}, first {found.until_s:g} s", heads(LADDER), rows)
    terminal.result(fill(EXPLANATION.format(legend(LADDER)), WIDTH))
    reference, change = found.reference.rung, found.reference.error
    terminal.result(
        f"reference: {reference.name}; on a coarser mesh and with\n"
        f"twice the tolerance it changes by {short_number(change.eccentricity_largest)} (max) and "
        f"{short_number(change.eccentricity_rms)} (rms)."
    )
    for item in (item for item in found.ladder if item.planned):
        stated = item.stated.get("eccentricity")
        told = "" if stated is None else f", its stated error is {short_number(stated)}"
        terminal.result(f"the choice of the plan costs {found.above_front():.2g} times Pareto's front{told}.")
    ended = {item.error.until_s for item in found.ladder} - {found.until_s}
    if ended:
        terminal.result(f"errors of the eccentricity until {min(ended):.4g} s, where a whirl begins to grow.")
    for item in found.ladder:
        if item.status != "finished":
            terminal.result(f"{item.rung.name}: {item.status}")
    for rung, problem in found.failed:
        terminal.result(f"{rung.name}: did not begin: {problem}")
    if not found.complete:
        terminal.result(f"Interrupted: {len(found.ladder)} rungs are done, without thresholds.")


def _documents(columns: Columns, items: Sequence[object]) -> list[dict[str, Any]]:
    from frbcli.columns import table_of

    return table_of(columns, items).documents()


def _stated(item: RungResult) -> dict[str, Any]:
    return {"stated": dict(item.stated)} if item.stated else {}
