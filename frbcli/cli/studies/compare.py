"""`frb compare`: one case with several models of its films."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Names, Terminal, case_or_run_argument, output_options
from frbcli.cli.files import INPUT, OUTPUT, OUTPUT_FOLDER, check_outputs, here
from frbcli.cli.pictures.picture_options import picture_options
from frbcli.cli.pictures.pictures import draw
from frbcli.cli.runs.compiling import compilation_shown
from frbcli.cli.runs.live import live_lines, of_runs
from frbcli.cli.runs.transient import exit_code
from frbcli.cli.studies.against import beside_measured
from frbcli.cli.studies.gathered import gathered
from frbcli.cli.studies.measured import measured_options
from frbcli.errors import Fault, InputError

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.case.schema import Case
    from frbcli.studies.compare import Comparison, VariantResult

WIDTH = 80


@dataclass(frozen=True)
class Models:
    """What is compared, see the options of the command."""

    cavitation: tuple[str, ...]
    theory: tuple[str, ...]
    coupling: tuple[str, ...]
    thermal: tuple[str, ...]


@click.command()
@case_or_run_argument
@click.option("--cavitation", type=Names(), default=(), metavar="A,B", help="Cavitation models. [that of CASE]")
@click.option("--theory", type=Names(), default=(), metavar="A,B", help="Film theories. [that of CASE]")
@click.option("--coupling", type=Names(), default=(), metavar="A,B", help="Couplings with the rotor. [that of CASE]")
@click.option("--thermal", type=Names(), default=(), metavar="A,B", help="Models of heat: none, lumped. [that of CASE]")
@click.option("--test", default="runup", show_default=True, metavar="TEST",
              help="The scene: runup, rotation, squeeze, whirl.")  # fmt: skip
@click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [CASE-compare.png, here]")
@click.option("--picture/--no-picture", default=True, help="A picture of all.")
@click.option("--keep", metavar="DIR", type=OUTPUT_FOLDER, help="Keep the run files in this directory.")
@click.option("--measured", "file", metavar="FILE", type=INPUT,
              help="Of a run: a measured run-up to set beside it, CSV, WAV or MAT, see --x.")  # fmt: skip
@click.option("--signal", default="journal", show_default=True, help="Its point in the run: journal, disk_NAME, ...")
@measured_options
@picture_options
@output_options
@gathered("models", Models)
def command(
    case: Case | Path,
    models: Models,
    test: str,
    output: Path | None,
    picture: bool,
    keep: Path | None,
    file: Path | None,
    signal: str,
    measurement: Measurement | None,
    terminal: Terminal,
) -> int:
    """Run CASE with several models of its films: events, deviations and cost in one table and one picture; or set a
    measurement beside RUN.h5.

    Without --cavitation, --theory and --coupling it is compared with all models whose films have no state and low cost.
    """
    from frbcli.bearing_tests.plan import TESTS, with_model
    from frbcli.studies.compare import compare

    if isinstance(case, Path) or file is not None:
        if not isinstance(case, Path) or file is None or any(vars(models).values()) or test != "runup" or keep:
            raise click.UsageError("A measurement stands beside a run: frb compare RUN.h5 --measured FILE --x COLUMN.")
        beside_measured(terminal, case, file, measurement, signal, output if picture else None, picture)
        return 0
    target = output or here(case.name, "-compare.png")
    if test in TESTS:
        return _kinematic(case, test, models, target, picture, terminal)
    check_outputs(picture=target if picture else None)
    others = (with_model(case, law) for law in models.cavitation)  # asked for after their names are checked
    with live_lines(terminal) as show, compilation_shown(terminal, case, show, others):
        tell = of_runs(terminal, show)
        found = compare(
            case, models.cavitation, models.theory, test, keep, lambda variant, *rest: tell(variant.name, *rest),
            models.coupling, models.thermal,
        )  # fmt: skip
    _report(found, bool(models.coupling), terminal)
    if models.thermal:
        _report_heat(found, terminal)
    results = [document | (_heat(result) if result.variant.thermal else {})
               for document, result in zip(found.table().documents(), found.results, strict=True)]  # fmt: skip
    whole = {} if found.status == "finished" else {"status": found.status, "message": found.message}
    terminal.emit({"command": "compare", "case": case.name, "test": found.test, **whole, "results": results})
    if picture and all(len(result.run) > 1 for result in found.results):
        from frbcli.plot.studies.compare import comparison_figure

        draw(terminal, lambda: comparison_figure(found), target)
    return max(exit_code(status) for status in (found.status, *(result.run.status for result in found.results)))


def _kinematic(case: Case, test: str, wanted: Models, target: Path, picture: bool, terminal: Terminal) -> int:
    """A kinematic test with several models; their films all have finite length."""
    from frbcli.cli.bearings.kinematic import run_test
    from frbcli.film.cavitation.table import laws, names

    for option, given, problem in (
        ("--thermal", wanted.thermal, f"is not for a {test}, whose film keeps its temperature."),
        ("--coupling", wanted.coupling, f"is not for a {test}, in which no rotor moves."),
        ("--theory", set(wanted.theory) - {"finite"}, f"is not for a {test}, which solves the whole film."),
    ):
        if given:
            raise InputError(case.name, (Fault(option, ",".join(given), None, problem, "Leave it out."),))
    if case.film.bearing_model:
        problem = f"is one model in a {test}: there is nothing to compare it with."
        raise InputError(
            case.name, (Fault("film.theory", case.film.bearing_model, None, problem, f"Call `frb {test}`."),)
        )
    models = wanted.cavitation or names(law for law in laws() if law.cavitates)
    return run_test(case, test, models, target, picture, terminal, compared=True) or 0


def _report(found: Comparison, couplings: bool, terminal: Terminal) -> None:
    from frbcli.columns import heads, legend
    from frbcli.studies.comparison_columns import COUPLINGS, MODELS, VARIANT

    title = found.case.title or found.case.name
    table = COUPLINGS if couplings else MODELS
    rows = found.table().cells(table)
    if couplings and len({(result.variant.cavitation, result.variant.theory) for result in found.results}) > 1:
        rows = [(f"{result.variant.cavitation}\n{result.variant.theory}\n{name}", *rest)
                for result, (name, *rest) in zip(found.results, rows, strict=True)]  # fmt: skip
    terminal.table(title, heads(VARIANT, table), rows)
    terminal.result(fill(f"{legend(VARIANT, table)}.", WIDTH))
    for result in found.results:
        if result.run.status != "finished":
            terminal.result(f"{result.variant.name}: {result.run.status} at {result.run.t_end_s:.4g} s")
    if found.status != "finished":
        terminal.result(f"Not all models were run: {' '.join(found.message.split()) or found.status}")


def _report_heat(found: Comparison, terminal: Terminal) -> None:
    """What heat changes at the end of the runs."""
    rows = [
        (
            result.variant.name,
            ", ".join(f"{ratio:.4f}" for ratio in result.ring_ratios.values()) or "-",
            "-" if math.isnan(result.loss) else f"{result.loss:.4g}",
            ", ".join(f"{hottest:.1f}" for hottest in _hottest(result)) or "-",
        )
        for result in found.results
    ]
    terminal.table("at the end", ("films", "ring over rotor", "loss, W", "films, degC"), rows)


def _heat(result: VariantResult) -> dict[str, Any]:
    """What heat changes at the end, in JSON."""
    return {
        "thermal": result.variant.thermal,
        "ring_speed_ratios": result.ring_ratios,
        "loss_W": None if math.isnan(result.loss) else result.loss,
    }


def _hottest(result: VariantResult) -> list[float]:
    """Temperatures of the films in degC at the end."""
    names = [name.replace("flow", "temperature").removesuffix("_m3_s") + "_K" for name in result.run.signals
             if name.startswith("flow")]  # fmt: skip
    return [float(result.run[name][-1]) - 273.15 for name in names]
