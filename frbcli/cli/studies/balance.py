"""`frb balance`: correction masses from the synchronous motion of a run."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.files import INPUT, check_outputs, force_option, forced
from frbcli.cli.options import Command, Names, speeds_option
from frbcli.cli.progress import READING, computing, csv_option, display
from frbcli.cli.studies.fit import measured_options, run_of

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.balancing import Balancing, TrialRun
    from frbcli.results.store import Run

EXAMPLE = 'a=trial.csv:"5 g*mm@30deg"'
MOST_ROWS = 24  # of points at speeds; JSON and CSV have all


class TrialOption(click.ParamType[tuple[str, Path, float, float]]):
    """A plane, the file of its trial run, the unbalance and its angle, as a=trial.csv:5 g*mm@30deg."""

    name = "trial"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Plane, path, kg m and degrees. Fails the option for anything else."""
        from frbcli.units import ANGLE, quantity

        if isinstance(value, tuple):
            return value
        plane, equals, rest = str(value).partition("=")
        file, colon, given = rest.rpartition(":")
        size, at, angle = given.rpartition("@")
        if not (plane.strip() and equals and file.strip() and colon and at):
            self.fail(f"{value!r} is no trial run. Write e.g. {EXAMPLE}.", param, ctx)
        try:
            unbalance = quantity(size.strip(), "kg*m", "5 g*mm")
            turned = quantity(angle.strip(), ANGLE, "30 deg")
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)
        if not unbalance > 0.0:
            self.fail(f"{value!r} has no unbalance above 0.", param, ctx)
        degrees = quantity("1 rad", ANGLE) * turned / quantity("1 deg", ANGLE)
        return plane.strip(), INPUT.convert(file.strip(), param, ctx), unbalance, degrees


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN", type=INPUT)
@click.option("--planes", type=Names(), default=(), metavar="A,B", show_default="as in --trial",
              help="Disks where masses can be added.")  # fmt: skip
@click.option("--trial", "trials", multiple=True, type=TrialOption(), metavar="PLANE=FILE:UNBALANCE@ANGLE",
              show_default="coefficients are computed for the case of RUN",
              help=f"A run with a trial unbalance in a plane, e.g. {EXAMPLE}. Repeatable.")  # fmt: skip
@speeds_option("the one that RUN holds, or eight of its ramp")
@click.option("--probe", "points", multiple=True, metavar="POINT", show_default="all of the shaft",
              help="Point of the run that takes part, e.g. journal_left. Repeatable.")  # fmt: skip
@click.option("--triggered", is_flag=True,
              help="Measurements without pulses began at the same angle of the rotor.")  # fmt: skip
@csv_option
@force_option()
@measured_options
@output_options
def command(
    run_file: Path,
    planes: tuple[str, ...],
    trials: tuple[tuple[str, Path, float, float], ...],
    speeds: tuple[float, ...],
    points: tuple[str, ...],
    triggered: bool,
    csv: Path | None,
    measurement: Measurement | None,
    terminal: Terminal,
) -> None:
    """Find the unbalance that has to be added in planes of a rotor, so that RUN would not move with it.

    Influence coefficients are computed for the case of a computed run. A measured one needs a trial run for each plane,
    with the same columns; --x a,b takes several probes.
    """
    from frbcli.balancing import TrialRun, balance
    from frbcli.case.run import speed_unit_of
    from frbcli.results.write import TABLES

    check_outputs((csv, TABLES["csv"]))
    with display(terminal, READING):
        run = _recorded(run_file, measurement, terminal)
        tried = [TrialRun(plane, _recorded(file, measurement, terminal), *given) for plane, file, *given in trials]
    terminal = terminal.with_speeds_in(speed_unit_of(run))
    with _progress(terminal, run, tried):
        balancing = balance(run, planes, speeds or None, points or None, tried, triggered)
    _show(terminal, balancing)
    if csv is not None:
        from frbcli.results.write import write_table

        write_table(balancing.to_pandas(), csv, forced())
        terminal.result(f"table: {csv}")
    terminal.emit(document(balancing, run_file) | {"csv": csv})


def document(balancing: Balancing, run_file: Path) -> dict[str, object]:
    """As JSON."""
    from frbcli.balancing import POINTS
    from frbcli.columns import documents

    return {
        "command": "balance",
        "run": run_file,
        "status": balancing.status,
        "influence": "trials" if balancing.trials else "computed",
        "planes": balancing.table().documents(),
        "residual": balancing.residual,
        "condition": balancing.condition,
        "speeds_Hz": balancing.speeds_Hz,
        "points": documents(POINTS, balancing.points),
        "doubts": balancing.doubts,
    }


def _recorded(path: Path, measurement: Measurement | None, terminal: Terminal) -> Run:
    """The run in a file, of a measurement with all probes of --x and --y."""
    from frbcli.results.measured.reading import READERS

    across, up = ([] if text is None else [name.strip() for name in text.split(",")]
                  for text in ((None, None) if measurement is None else (measurement.x, measurement.y)))  # fmt: skip
    if path.suffix.lower() not in READERS or measurement is None or len(across) < 2 or not path.exists():
        computed = path.suffix.lower() not in READERS  # a computed trial run among measurements has no columns
        return run_of(path, None if computed else measurement, terminal, relative=False)
    if up and len(up) != len(across):
        raise click.UsageError(f"--x has {len(across)} columns and --y {len(up)}: give one for each probe, or no --y.")
    from frbcli.analysis.measured import measured_probes

    upward: list[str | None] = [*up] if up else [None] * len(across)
    run = measured_probes(path, measurement, list(zip(across, upward, strict=True)))
    for remark in run.remarks:
        terminal.remark(remark)
    return run


def _progress(terminal: Terminal, run: Run, trials: Sequence[TrialRun]) -> Any:
    """Shown while influence coefficients are computed."""
    if trials or not run.case_text:
        return nullcontext()
    from frbcli.case.reading.load import load_case_text

    return computing(terminal, load_case_text(run.case_text, name=run.case_name), kernels="rest")


def _show(terminal: Terminal, balance: Balancing) -> None:
    from frbcli.balancing import POINTS
    from frbcli.columns import table_of

    for doubt in balance.doubts:
        terminal.sentence(f"Doubtful: {doubt}")
    terminal.show(f"{balance.run.title}: {'doubtful ' if balance.doubts else ''}corrections", balance.table())
    zero = "the trial unbalances" if balance.trials else "`phase` of a disk"
    terminal.sentence(
        "Add the correction: it is opposite to the unbalance. Angles are on the rotor, in the sense of rotation, from "
        f"the zero of {zero}."
    )
    rows = balance.points
    table = table_of(POINTS, rows[-MOST_ROWS:])
    terminal.show("Synchronous amplitudes, and as expected with the corrections", table)
    if len(rows) > MOST_ROWS:
        terminal.result(f"The last {MOST_ROWS} of {len(rows)}: --json has all.")
    vectors = 2 * len(rows)
    by = "trial runs" if balance.trials else "the linear response of the case"
    terminal.sentence(
        f"Residual {100.0 * balance.residual:.2g} % of {vectors} vectors at "
        f"{terminal.speeds.listed(balance.speeds_Hz)}; condition number {balance.condition:.3g}; "
        f"influence coefficients of {by}."
    )
