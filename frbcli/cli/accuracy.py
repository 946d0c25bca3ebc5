"""`frb accuracy`: cost against error."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Names, Terminal, case_argument, output_options, short_number
from frbcli.cli.compiling import compilation_shown
from frbcli.cli.files import OUTPUT, check_outputs, here
from frbcli.cli.live import live_lines, of_runs
from frbcli.cli.picture_options import picture_options
from frbcli.cli.pictures import draw
from frbcli.cli.quantities import TIME_OPTION
from frbcli.errors import INTERRUPTED

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.studies.ladder import AccuracyLadder, Rung, RungError, RungResult

COLUMNS = ("", "film", "tol.", "CPU", "max", "rms", "onset", "thr.", "force")
EXPLANATION = (
    "* choice of the plan, + on Pareto's front; film: short bearing, or elements of a\n"
    "finite one; tol.: local error of a step; CPU: time in s; max, rms: error of the\n"
    "eccentricity; onset: error of the rotor speed at the onset of whirl, in Hz;\n"
    "thr.: error of the linear threshold, in Hz; force: relative error of the\n"
    "film forces."
)
RESOLVED = 0.01  # Hz; resolution of the table


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

    target = output or here(case.name, "-accuracy.png")
    check_outputs(picture=target if picture else None)
    with live_lines(terminal) as show, compilation_shown(terminal, case, show):
        tell = of_runs(terminal, show)
        found = accuracy(case, until, theory, coupling, lambda rung, *rest: tell(rung.name, *rest))
    _report(found, terminal)
    reference = _document(found.reference) | {"compared_with": _rung(found.coarser)}
    reference["change"] = reference.pop("error")
    terminal.emit({
        "command": "accuracy",
        "case": case.name,
        **({} if found.complete else {"status": "interrupted"}),
        "until_s": found.until_s,
        "reference": reference,
        "ladder": [_document(item) | {"planned": item.planned, "pareto": item in found.front} for item in found.ladder],
        **({"failed": [_rung(rung) | {"message": problem} for rung, problem in found.failed]} if found.failed else {}),
    })
    if picture and found.ladder:
        from frbcli.plot.accuracy import accuracy_figure

        draw(terminal, lambda: accuracy_figure(found), target)
    return 0 if found.complete else INTERRUPTED


def _report(found: AccuracyLadder, terminal: Terminal) -> None:
    several = len({item.rung.coupling for item in found.ladder}) > 1
    rows = [
        _cells(item, several, ("*" if item.planned else "") + ("+" if item in found.front else ""))
        for item in found.ladder
    ]
    terminal.table(f"{found.case.title or found.case.name}, first {found.until_s:g} s", COLUMNS, rows)
    terminal.result(EXPLANATION)
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


def _cells(item: RungResult, several: bool, mark: str) -> tuple[str, ...]:
    rung, error = item.rung, item.error
    film = rung.theory if rung.mesh is None else f"{rung.mesh[0]}x{rung.mesh[1]}"
    return (
        mark,
        "\n".join((film, rung.coupling.replace("-", "-\n"))) if several else film,
        short_number(rung.tolerance).replace(".0e", "e"),
        f"{item.cpu_s:.3g}",
        short_number(error.eccentricity_largest),
        short_number(error.eccentricity_rms),
        _difference(error.onset_Hz),
        _difference(error.threshold_Hz),
        short_number(error.force_relative),
    )


def _difference(value: float) -> str:
    if math.isnan(value) or abs(value) >= RESOLVED:
        return "-" if math.isnan(value) else f"{value:+.2f}"
    return short_number(value)


def _rung(rung: Rung) -> dict[str, Any]:
    return {
        "theory": rung.theory,
        "cavitation": rung.cavitation,
        "mesh": rung.mesh,
        "tolerance": rung.tolerance,
        "coupling": rung.coupling,
    }


def _document(item: RungResult) -> dict[str, Any]:
    stated = {"stated": dict(item.stated)} if item.stated else {}
    return _rung(item.rung) | {"status": item.status, "cpu_s": item.cpu_s, "error": _error(item.error)} | stated


def _error(error: RungError) -> dict[str, Any]:
    return {
        "eccentricity_largest": error.eccentricity_largest,
        "eccentricity_rms": error.eccentricity_rms,
        "window_s": [0.0, error.until_s],
        "onset_speed_Hz": error.onset_Hz,
        "threshold_Hz": error.threshold_Hz,
        "film_force_relative": error.force_relative,
    }
