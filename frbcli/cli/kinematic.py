"""What `frb rotation`, `frb squeeze`, `frb whirl` and their comparison share: options, table, JSON."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Names, Terminal
from frbcli.cli.compiling import compilation_shown
from frbcli.cli.files import OUTPUT, check_outputs, here
from frbcli.cli.heat import film_document, tell_film
from frbcli.cli.live import counting, live_lines
from frbcli.cli.pictures import draw
from frbcli.errors import INTERRUPTED, NotConverged

if TYPE_CHECKING:
    from frbcli.bearing_tests.kinematic import KinematicResult, KinematicTest
    from frbcli.case.schema import Case

BAR = 1e5
FORCES = ("films", "eps", "Fx", "Fy", "|F|", "So", "angle", "p_max", "err.")
OIL = ("cavitation", "p_min", "torque", "oil", "in", "out", "balance", "CPU")
EXPLANATION = (
    "Forces of the whole bearing on the journal in N; angle: of the force from the\n"
    "x-axis; So: Sommerfeld number (3.14); p: absolute, in bar; err.: error of the\n"
    "force, from half the cells, over the largest |F| of the table; torque: on the\n"
    "journal, N m; oil: mean oil fraction; in, out: flow in mm^3/s; balance: oil\n"
    "that is lost, or created (negative), over the flow; CPU: time in s."
)
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
    from frbcli.plot.film import film_figure
    from frbcli.plot.history import history_figure

    if all(result.loads is None for result in found.results):
        return
    if found.test == "rotation" and all(result.field is None for result in found.results):
        terminal.remark("No picture: a bearing model has no pressure.")
        return
    draw(terminal, lambda: film_figure(found) if found.test == "rotation" else history_figure(found), target)


def report(found: KinematicTest, terminal: Terminal) -> None:
    """Two tables: forces and oil."""
    title = found.case.title or found.case.name
    largest = max((_size(result) for result in found.results), default=0.0)
    terminal.table(f"{title}: {found.test}", FORCES, [_forces(result, largest) for result in found.results])
    terminal.table("", OIL, map(_oil, found.results))
    terminal.result(EXPLANATION)
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


def _size(result: KinematicResult) -> float:
    """The force in N, 0 without a solution."""
    return 0.0 if result.loads is None else math.hypot(*result.loads.force)


def _forces(result: KinematicResult, largest: float) -> tuple[str, ...]:
    """largest: force in N of all results, which their errors refer to: one that nearly vanishes has a large error of
    its own, which is of no meaning beside the others."""
    loads = result.loads
    if loads is None:
        return (result.name, "none", *[""] * (len(FORCES) - 2))
    (x, y), size = loads.force, _size(result)
    error = result.force_error * size / largest if largest > 0.0 else math.nan
    return (
        result.name,
        f"{math.hypot(*result.displacement):.3f}",
        _number(x, size),
        _number(y, size),
        _number(size, size),
        _told(result.sommerfeld_number, ".3g"),
        f"{math.degrees(math.atan2(y, x)):.0f}°",
        _told(loads.p_max / BAR, ".4g"),
        _told(error, ".0e").replace("e-0", "e-"),
    )


def _told(value: float, form: str) -> str:
    """A number in a form; "-" for an unknown one."""
    return "-" if math.isnan(value) else format(value, form)


def _number(value: float, size: float) -> str:
    """With the decimals that suit numbers of this size."""
    decimals = max(0, 2 - math.floor(math.log10(size))) if size > 0.0 else 0
    return f"{value:.{min(decimals, 6)}f}"


def _oil(result: KinematicResult) -> tuple[str, ...]:
    loads = result.loads
    if loads is None:
        return (result.name, *[""] * (len(OIL) - 2), f"{result.cpu_s:.1f}")
    return (
        result.name,
        _told(loads.p_min / BAR, ".4g"),
        _told(loads.torque.journal, ".3g"),
        _told(loads.oil_fraction, ".3f"),
        _told(loads.oil.in_m3_s * 1e9, ".4g"),
        _told(loads.oil.out_m3_s * 1e9, ".4g"),
        _told(loads.oil.defect_relative, ".0e").replace("e-0", "e-"),
        f"{result.cpu_s:.1f}",
    )


def result_document(result: KinematicResult) -> dict[str, Any]:
    """A result in JSON; null where there is no solution."""
    loads, history = result.loads, result.history
    oil = None if loads is None else loads.oil
    document: dict[str, Any] = {
        "cavitation": result.cavitation or None,
        "theory": result.theory,
        "status": result.status,
        "displacement": result.displacement,
        "force_N": None if loads is None else loads.force,
        "torque_journal_N_m": None if loads is None else loads.torque.journal,
        "torque_shell_N_m": None if loads is None else loads.torque.shell,
        "p_max_Pa": None if loads is None else loads.p_max,
        "p_min_Pa": None if loads is None else loads.p_min,
        "oil_fraction": None if loads is None else loads.oil_fraction,
        "oil_balance": {
            "in_m3_s": None if oil is None else oil.in_m3_s,
            "out_m3_s": None if oil is None else oil.out_m3_s,
            "defect_relative": None if oil is None else oil.defect_relative,
        },
        "error": {"force_relative": result.force_error},
        "cost": {
            "cpu_s": result.cpu_s,
            "unknowns": result.unknowns,
            "newton_iterations": result.newton_iterations,
        },
    }
    if result.heat is not None:
        document["thermal"] = film_document(result.heat)
    if result.plan.test != "rotation":
        document |= {
            "t_s": None if history is None else history.time_s,
            "force_history_N": None if history is None else history.force,
            "probe_pressure_Pa": None if history is None else history.probe_pressure,
            "gap_ratio": None if history is None else history.gap_ratio,
        }
    return document
