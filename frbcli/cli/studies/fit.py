"""`frb fit`: numbers of a case from a measured run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import CASE_FILE, INPUT, forced, here
from frbcli.cli.options import KEY_RANGE, Command, KeyRange, Names, signal_option
from frbcli.cli.outputs import OutputOptions, outputs_options
from frbcli.cli.progress import READING, computing, display
from frbcli.cli.studies.measured import measured_options, run_of

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.case.schema import Case
    from frbcli.studies.fit import Fit

EXPLANATION = (
    "error: standard error; what lies at a bound has none. The errors are of the measurement's scatter: what the case "
    "leaves out is not in them."
)
POOR = 2.0  # times the scatter of the measurement: the case does not describe it


@click.command(cls=Command)
@case_argument
@click.option("--measured", "file", required=True, metavar="FILE", type=INPUT,
              help="A measured run-up: CSV, WAV or MAT, see --x; or a run.")  # fmt: skip
@click.option("--vary", type=Names(), required=True, metavar="KEY,KEY", help="The numbers of CASE that are sought.")
@click.option("--bounds", multiple=True, type=KEY_RANGE, metavar="KEY=LOW..HIGH",
              show_default="a third to three times its value",
              help="Range of a number, in the units of CASE. Repeatable.")  # fmt: skip
@signal_option()
@click.option("--save", metavar="CASE.toml", type=CASE_FILE, help="Write the case with the numbers found.")
@measured_options
@outputs_options("CASE-fit.png, here")
@output_options
def command(
    case: Case,
    file: Path,
    vary: tuple[str, ...],
    bounds: tuple[KeyRange, ...],
    signal: str,
    save: Path | None,
    measurement: Measurement | None,
    outputs: OutputOptions,
    terminal: Terminal,
) -> None:
    """Find numbers of CASE with which its run-up agrees with a measured one: synchronous amplitudes, frequency and
    amplitude of the whirl, its onset."""
    from frbcli.case.reading.listing import values as listed
    from frbcli.results.files.write import NEW
    from frbcli.studies.fit import fit
    from frbcli.units import display as with_unit

    places = outputs.check(here(case.name, "-fit.png"), (save, NEW))
    limits = _bounds(case, bounds)
    with display(terminal, READING):
        measured = run_of(file, measurement, terminal)
    units = {value.key: value.unit for value in listed(case)}
    with computing(terminal, case) as shown:

        def watch(number: int, tried: Mapping[str, float]) -> None:
            numbers = (f"{key} {with_unit(float(f'{value:.5g}'), units.get(key, ''))}" for key, value in tried.items())
            shown.redraw(f"run {number}: {', '.join(numbers)}")

        fitted = fit(case, measured, vary, limits, signal, watch)
    _show(terminal, fitted)
    if save is not None:
        from frbcli.results.files.write import write

        write(save, NEW, fitted.case.source_text, forced())
        terminal.result(f"case: {save}")
    terminal.emit(
        {
            "command": "fit",
            "case": case.name,
            "numbers": fitted.table().documents(),
            "correlation": fitted.correlation,
            "chi": fitted.chi,
            "runs": fitted.runs,
            "case_file": save,
            **places.write(terminal, fitted),
        }
    )


def _show(terminal: Terminal, fitted: Fit) -> None:
    terminal.show(fitted.case.heading, fitted.table())
    terminal.sentence(EXPLANATION)
    terminal.result(f"{fitted.runs} runs; residuals of {fitted.chi:.2g} times the scatter of the measurement.")
    if fitted.chi > POOR:
        terminal.result("They are larger than the scatter: the case does not describe all of what was measured.")


def _bounds(case: Case, given: tuple[KeyRange, ...]) -> dict[str, tuple[float, float]]:
    """Bounds by keys, in SI: each is read as a value of the case."""
    from frbcli.case.reading.listing import values

    bounds_of = {}
    for span in given:
        changed = (case.with_settings(f"{span.key}={end}") for end in (span.low, span.high))
        low, high = (next((v.value for v in values(each) if v.key == span.key), None) for each in changed)
        if not (isinstance(low, float) and isinstance(high, float)):
            raise click.UsageError(f"--bounds {span.key} is no number of the case.")
        bounds_of[span.key] = (low, high)
    return bounds_of
