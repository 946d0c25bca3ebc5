"""`frb compare`: one case with several models of its films; `frb accuracy`: cost against error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, case_argument, case_or_run_argument, output_options
from frbcli.cli.options import (
    INPUT,
    OUTPUT_FOLDER,
    TIME_OPTION,
    Command,
    cavitation_option,
    coupling_option,
    gathered,
    here,
    next_to,
    signal_option,
    theory_option,
    thermal_option,
)
from frbcli.cli.progress import OutputOptions, computing, display, outputs_options
from frbcli.cli.studies.measurements import measured_options, run_of
from frbcli.cli.transient import exit_code
from frbcli.columns import documents, short_number, table_of
from frbcli.errors import INTERRUPTED, input_error

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.case.schema import Case
    from frbcli.studies.accuracy import AccuracyLadder, RungResult
    from frbcli.studies.against import AgainstMeasured
    from frbcli.studies.compare import Comparison


KINDS = ("critical-speed", "self-excited", "onset", "offset", "lock-in")


@dataclass(frozen=True)
class Models:
    """The models that are compared, see the options of the command."""

    cavitation: tuple[str, ...]
    theory: tuple[str, ...]
    coupling: tuple[str, ...]
    thermal: tuple[str, ...]


@click.command(cls=Command)
@case_or_run_argument
@cavitation_option
@theory_option("as in CASE")
@coupling_option
@thermal_option
@click.option("--test", type=click.Choice(["runup", "rundown", "rotation", "squeeze", "whirl"]), default="runup",
              show_default=True, help="The scene.")  # fmt: skip
@click.option("--keep", metavar="DIR", type=OUTPUT_FOLDER, help="Keep the run files in this directory.")
@click.option("--measured", "file", metavar="FILE", type=INPUT,
              help="A measured run-up to compare with RUN.h5: CSV, WAV or MAT, see --x.")  # fmt: skip
@signal_option()
@measured_options
@outputs_options("CASE-compare.png, here")
@output_options
@gathered("models", Models)
def compare_models(
    case: Case | Path,
    models: Models,
    test: str,
    keep: Path | None,
    file: Path | None,
    signal: str,
    measurement: Measurement | None,
    outputs: OutputOptions,
    terminal: Terminal,
) -> int:
    """Run CASE with several models of its films: events, deviations and cost in one table and one picture; or compare
    RUN.h5 with a measurement.

    Without --cavitation, --theory and --coupling CASE is compared with all models of low cost whose films keep
    neither oil nor gas.
    """
    from frbcli.scene.planning.kinematic_plan import TESTS, with_model
    from frbcli.studies.compare import HEAT, compare

    if isinstance(case, Path) or file is not None:
        if not isinstance(case, Path) or file is None or any(vars(models).values()) or test != "runup" or keep:
            raise click.UsageError("Compare a measurement with a run: frb compare RUN.h5 --measured FILE --x COLUMN.")
        beside_measured(terminal, case, file, measurement, signal, outputs)
        return 0
    if test in TESTS:
        return _kinematic(case, test, models, outputs, terminal)
    places = outputs.check(here(case.name, "-compare.png"))
    others = (with_model(case, law) for law in models.cavitation)  # asked for after their names are checked
    with computing(terminal, case, others) as shown:
        observe = shown.of_runs()
        compared = compare(
            case, models.cavitation, models.theory, test, keep, lambda variant, *rest: observe(variant.name, *rest),
            models.coupling, models.thermal,
        )  # fmt: skip
    _report_models(compared, bool(models.coupling), terminal)
    warm = table_of(HEAT, compared.results)
    if models.thermal:
        terminal.show("at the end", warm)
    results = [row | (heat if heat["thermal"] else {})
               for row, heat in zip(compared.table().documents(), warm.documents(), strict=True)]  # fmt: skip
    whole = {} if compared.status == "finished" else {"status": compared.status, "message": compared.message}
    terminal.emit({"command": "compare", "case": case.name, "test": compared.test, **whole, "results": results})
    if not all(len(result.run) > 1 for result in compared.results):
        places = replace(places, picture=None)
    places.write(terminal, compared)
    return max(exit_code(status) for status in (compared.status, *(result.run.status for result in compared.results)))


def _kinematic(case: Case, test: str, wanted: Models, outputs: OutputOptions, terminal: Terminal) -> int:
    """A kinematic test with several models; their films all have finite length."""
    from frbcli.cli.studies.bearing import run_test
    from frbcli.film.cavitation.table import laws, names

    for option, given, problem in (
        ("--thermal", wanted.thermal, f"is not for a {test}, whose film keeps its temperature."),
        ("--coupling", wanted.coupling, f"is not for a {test}, in which no rotor moves."),
        ("--theory", set(wanted.theory) - {"finite"}, f"is not for a {test}, which solves the whole film."),
    ):
        if given:
            raise input_error(case.name, option, ",".join(given), problem, "Leave it out.")
    models = wanted.cavitation or names(law for law in laws() if law.cavitates)
    return run_test(case, test, models, outputs, terminal, compared=True) or 0


def _report_models(comparison: Comparison, couplings: bool, terminal: Terminal) -> None:
    from frbcli.studies.compare import COUPLING_TABLE, MODELS

    name, table = COUPLING_TABLE if couplings else MODELS, comparison.table().with_speeds_in(terminal.speeds)
    rows = table.cells(name)
    if couplings and len({(result.variant.cavitation, result.variant.theory) for result in comparison.results}) > 1:
        rows = [(f"{result.variant.cavitation}\n{result.variant.theory}\n{coupling}", *rest)
                for result, (coupling, *rest) in zip(comparison.results, rows, strict=True)]  # fmt: skip
    terminal.table(comparison.case.heading, table.heads(name), rows)
    terminal.sentence(f"{table.legend(name)}.")
    for result in comparison.results:
        if result.run.status != "finished":
            terminal.result(f"{result.variant.name}: {result.run.status} at {result.run.t_end_s:.4g} s")
    if comparison.status != "finished":
        terminal.result(f"Not all models were run: {' '.join(comparison.message.split()) or comparison.status}")


def beside_measured(
    terminal: Terminal, run_file: Path, file: Path, measurement: Measurement | None, signal: str,
    outputs: OutputOptions,
) -> None:  # fmt: skip
    """Tables, picture and JSON of a run and a measurement."""
    from frbcli.case.run import speed_unit_of
    from frbcli.results.store import read_run
    from frbcli.studies.against import DEVIATIONS, against_measured

    places = outputs.check(next_to(run_file, "-measured.png"))
    with display(terminal):
        run = read_run(run_file)
        comparison = against_measured(run, run_of(file, measurement, terminal), signal)
    terminal = terminal.with_speeds_in(speed_unit_of(run))
    _show_deviations(terminal, comparison)
    terminal.emit(
        {
            "command": "compare",
            "run": run_file,
            "measured": file,
            "events": {"computed": comparison.computed_events, "measured": comparison.measured_events},
            "deviations": documents(DEVIATIONS, comparison.deviations()),
            **places.write(terminal, comparison),
        }
    )


def _show_deviations(terminal: Terminal, comparison: AgainstMeasured) -> None:
    from frbcli.studies.against import DEVIATIONS

    rows = []
    for kind in KINDS:
        speeds = [
            next((event["speed_Hz"] for event in events if event["kind"] == kind), None)
            for events in (comparison.computed_events, comparison.measured_events)
        ]
        if any(speed is not None for speed in speeds):
            rows.append((kind, *("-" if speed is None else terminal.speeds.words(speed, 1) for speed in speeds)))
    where = comparison.point.replace("_", " ")
    terminal.table(f"first events of the {where}, rotor speed", ("event", "computed", "measured"), rows)
    terminal.show("ridges", table_of(DEVIATIONS, comparison.deviations()))


@click.command(cls=Command)
@case_argument
@click.option("--until", type=TIME_OPTION, metavar="TIME", show_default="as in CASE",
              help='End of the run, e.g. "2 s".')  # fmt: skip
@theory_option("all that apply")
@coupling_option
@outputs_options("CASE-accuracy.png, here")
@output_options
def accuracy_ladder(
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
    _report_ladder(ladder, terminal)
    terminal.emit(_ladder_document(ladder))
    if not ladder.ladder:
        places = replace(places, picture=None)
    places.write(terminal, ladder)
    return 0 if ladder.complete else INTERRUPTED


def _ladder_document(ladder: AccuracyLadder) -> dict[str, Any]:
    from frbcli.studies.accuracy import RESULT, RUNG

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


def _report_ladder(ladder: AccuracyLadder, terminal: Terminal) -> None:
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
