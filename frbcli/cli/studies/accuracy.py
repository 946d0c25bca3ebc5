"""`frb accuracy`: cost against error."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import here
from frbcli.cli.options import TIME_OPTION, Command, coupling_option, theory_option
from frbcli.cli.progress import OutputOptions, computing, outputs_options
from frbcli.columns import documents, short_number
from frbcli.errors import INTERRUPTED

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.studies.ladder import AccuracyLadder, RungResult


@click.command(cls=Command)
@case_argument
@click.option("--until", type=TIME_OPTION, metavar="TIME", show_default="as in CASE",
              help='End of the run, e.g. "2 s".')  # fmt: skip
@theory_option("all that apply")
@coupling_option
@outputs_options("CASE-accuracy.png, here")
@output_options
def command(
    case: Case,
    until: float | None,
    theory: tuple[str, ...],
    coupling: tuple[str, ...],
    outputs: OutputOptions,
    terminal: Terminal,
) -> int:
    """Run CASE up on a ladder of theories, meshes and tolerances against a fine reference: error over cost."""
    from frbcli.studies.accuracy import accuracy, by_theory

    places = outputs.check(here(case.name, "-accuracy.png"))
    with computing(terminal, case, by_theory(case, theory)) as shown:
        observe = shown.of_runs()
        ladder = accuracy(case, until, theory, coupling, lambda rung, *rest: observe(rung.name, *rest))
    _report(ladder, terminal)
    terminal.emit(_document(ladder))
    if not ladder.ladder:
        places = replace(places, picture=None)
    places.write(terminal, ladder)
    return 0 if ladder.complete else INTERRUPTED


def _document(ladder: AccuracyLadder) -> dict[str, Any]:
    from frbcli.studies.ladder import RESULT, RUNG

    (coarser,), (reference,) = documents(RUNG, [ladder.coarser]), documents(RESULT, [ladder.reference])
    reference |= _stated(ladder.reference) | {"compared_with": coarser, "change": reference.pop("error")}
    rungs = zip(ladder.table().documents(), ladder.ladder, strict=True)
    ended = zip(documents(RUNG, [rung for rung, _ in ladder.failed]), ladder.failed, strict=True)
    failed = [row | {"message": problem} for row, (_, problem) in ended]
    return {
        "command": "accuracy",
        "case": ladder.case.name,
        **({} if ladder.complete else {"status": "interrupted"}),
        "until_s": ladder.until_s,
        "reference": reference,
        "ladder": [row | _stated(item) for row, item in rungs],
        **({"failed": failed} if ladder.failed else {}),
    }


def _report(ladder: AccuracyLadder, terminal: Terminal) -> None:
    table = ladder.table()
    rows = table.cells()
    if len({item.rung.coupling for item in ladder.ladder}) > 1:
        rows = [(mark, "\n".join((film, item.rung.coupling.replace("-", "-\n"))), *rest)
                for item, (mark, film, *rest) in zip(ladder.ladder, rows, strict=True)]  # fmt: skip
    terminal.table(f"{ladder.case.heading}, first {ladder.until_s:g} s", table.heads(), rows)
    terminal.sentence(f"* choice of the plan, + on Pareto's front; {table.legend()}.")
    reference, change = ladder.reference.rung, ladder.reference.error
    coarser = "" if reference.mesh is None else "on a coarser mesh and "
    terminal.sentence(
        f"reference: {reference.name}; {coarser}with "
        f"twice the tolerance it changes by {short_number(change.eccentricity_largest)} (max) and "
        f"{short_number(change.eccentricity_rms)} (rms)."
    )
    for item in (item for item in ladder.ladder if item.planned):
        stated = item.stated.get("eccentricity")
        quoted = "" if stated is None else f", its stated error is {short_number(stated)}"
        terminal.sentence(f"the choice of the plan costs {ladder.above_front():.2g} times Pareto's front{quoted}.")
    ended = {item.error.until_s for item in ladder.ladder} - {ladder.until_s}
    if ended:
        terminal.result(f"errors of the eccentricity until {min(ended):.4g} s, where a whirl begins to grow.")
    for item in ladder.ladder:
        if item.status != "finished":
            terminal.result(f"{item.rung.name}: {item.status}")
    for rung, problem in ladder.failed:
        terminal.result(f"{rung.name}: did not begin: {problem}")
    if not ladder.complete:
        terminal.result(f"Interrupted: {len(ladder.ladder)} rungs are done, without thresholds.")


def _stated(item: RungResult) -> dict[str, Any]:
    return {"stated": dict(item.stated)} if item.stated else {}
