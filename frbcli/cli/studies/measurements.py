"""Commands that use a measurement: `frb fit`, numbers of a case from a measured run; `frb balance`, correction masses.

Other commands share its options, which say what columns of a measurement hold a motion, and the run that it makes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.options import (
    CASE_FILE,
    INPUT,
    KEY_RANGE,
    LENGTH_OPTION,
    SPEED_OPTION,
    Command,
    KeyRange,
    Names,
    UnitOption,
    WrittenOption,
    check_outputs,
    force_option,
    forced,
    here,
    signal_option,
    speeds_option,
)
from frbcli.cli.progress import READING, OutputOptions, computing, csv_option, display, outputs_options

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.balancing import Balancing, TrialRun
    from frbcli.case.schema import Case
    from frbcli.results.store import Run
    from frbcli.studies.fit import Fit


_GIVEN = "frbcli.measurement"  # in the context of a command
EITHER = (("time", "rate"), ("speed_column", "speed_at", "tacho"))  # options of which one is enough
_UNITS = {kind: UnitOption(kind, unit, example) for kind, unit, example in
          (("length", "m", "um"), ("time", "s", "ms"), ("speed", "Hz", "rpm"))}  # fmt: skip
Function = TypeVar("Function", bound=Callable[..., Any])


class Rate(WrittenOption):
    """Samples per second, or the name of a single number of the file."""

    name = "rate"

    def read(self, text: str) -> float | str:
        """Samples per second, 1/s, or the name."""
        try:
            rate = float(text)
        except ValueError:
            return text
        if not rate > 0.0:
            raise ValueError("samples per second are not above 0.")
        return rate


def measured_options(function: Function) -> Function:
    """Give a command the options of a measurement; it receives `measurement: Measurement | None`."""
    named: dict[str, tuple[dict[str, Any], str]] = {
        "x": ({"metavar": "COLUMN"}, "Column of the displacement in x of a measurement; of WAV the channel, from 1."),
        "y": ({"metavar": "COLUMN"}, "Column of the displacement in y; without it there are no events."),
        "time": ({"metavar": "COLUMN"}, "Column of the times; by default the one called so."),
        "rate": ({"type": Rate()}, "Samples per second, without a column of times; or a number of the file, as fs."),
        "speed-column": ({"metavar": "COLUMN"}, "Column of the rotor speed."),
        "speed-time": ({"metavar": "COLUMN"}, "Column of the times of the rotor speed, where it has its own."),
        "speed-at": ({"metavar": "SPEED", "type": SPEED_OPTION}, 'A constant rotor speed, e.g. "100 Hz".'),
        "tacho": ({"metavar": "COLUMN"}, "Column of a signal with pulses, from which the rotor speed follows."),
        "pulses": (
            {"type": click.IntRange(min=1), "metavar": "N", "default": 1, "show_default": True},
            "Pulses per revolution.",
        ),
        "slow-roll": (
            {"metavar": "SPEED", "type": SPEED_OPTION},
            'Subtract what turns with the rotor at this slow speed, e.g. "10 Hz": runout and bow. Needs --tacho.',
        ),
        "unit": ({"type": _UNITS["length"], "show_default": "of the file, or 1 um"}, "Unit of the displacements."),
        "time-unit": ({"type": _UNITS["time"], "show_default": "of the file, or 1 s"}, "Unit of the times."),
        "speed-unit": ({"type": _UNITS["speed"], "show_default": "of the file, or 1 Hz"}, "Unit of the rotor speed."),
    }
    command: Any = function
    command = click.option("--clearance", "measurement", metavar="LENGTH", type=LENGTH_OPTION, callback=_measurement,
                        help='Bearing clearance, to which levels and events refer, e.g. "35 um".')(command)  # fmt: skip
    for name, (kind, meaning) in reversed(named.items()):  # read before the clearance, which makes one of all
        kind |= {"is_eager": True, "expose_value": False, "callback": _remember}
        command = click.option(f"--{name}", help=meaning, **kind)(command)
    return command  # type: ignore[no-any-return]


def show_columns(path: Path, terminal: Terminal) -> None:
    """A table of what a measured file holds, a row for each column, with its unit, or what it is if it is none."""
    from frbcli.results.measured import read_columns

    listed = read_columns(path).listed()
    rows = [(row["name"], " x ".join(map(str, row["shape"])), row["unit"] or "-", row["kind"]) for row in listed]
    terminal.table(str(path), ("name", "shape", "unit", "kind"), rows)
    terminal.emit({"command": "waterfall", "run": path, "columns": listed})


def _remember(context: click.Context, option: click.Parameter, value: Any) -> None:
    context.meta.setdefault(_GIVEN, {})[option.name] = value


def _measurement(context: click.Context, _: click.Parameter, clearance: float | None) -> Measurement | None:
    from frbcli.analysis.measured import Measurement

    given = context.meta[_GIVEN]
    if given["x"] is None:
        return None
    for names in EITHER:
        several = [f"--{name.replace('_', '-')}" for name in names if given[name] is not None]
        if len(several) > 1:
            raise click.UsageError(f"{' and '.join(several)} state the same quantity: give one of them.")
    return Measurement(
        x=given["x"],
        clearance=clearance,
        y=given["y"],
        time=given["time"],
        rate=given["rate"],
        speed=given["speed_column"],
        speed_Hz=given["speed_at"],
        tacho=given["tacho"],
        pulses=given["pulses"],
        unit_m=given["unit"],
        time_unit_s=given["time_unit"],
        speed_unit_Hz=given["speed_unit"],
        speed_time=given["speed_time"],
        slow_roll_Hz=given["slow_roll"],
    )


def run_of(path: Path, measurement: Measurement | None, terminal: Terminal, relative: bool = True) -> Run:
    """The run in a file: a computed one, or a measurement, whose units are remarked. relative: whether amplitudes refer
    to a clearance. Raises as read_run and measured_run do."""
    from frbcli.results.measured import READERS, read_columns

    if not path.exists() and path.suffix.lower() in READERS:
        read_columns(path)  # which raises: a file that is not there is said before its options are
    if path.suffix.lower() in READERS:
        if measurement is None:
            columns = f"`frb waterfall {path} --columns` lists its columns."
            raise click.UsageError(f"{path} is a measurement: name the column of its motion by --x COLUMN. {columns}")
        if measurement.clearance is None and relative:
            words = "A measurement needs --clearance, to which amplitudes refer; frb waterfall --linear does without."
            raise click.UsageError(words)
        from frbcli.analysis.measured import measured_run

        run = measured_run(path, measurement)
        for remark in run.remarks:
            terminal.remark(remark)
        return run
    if measurement is not None:
        raise click.UsageError(f"{path} is a run, which needs no --x.")
    from frbcli.results.store import read_run

    return read_run(path)


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
def fit_case(
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
    from frbcli.results.write import NEW
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
    _show_fit(terminal, fitted)
    if save is not None:
        from frbcli.results.write import write

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


def _show_fit(terminal: Terminal, fitted: Fit) -> None:
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


EXAMPLE = 'a=trial.csv:"5 g*mm@30deg"'
MOST_ROWS = 24  # of points at speeds; JSON and CSV have all


class TrialOption(WrittenOption):
    """A plane, the file of its trial run, the unbalance and its angle, as a=trial.csv:5 g*mm@30deg."""

    name = "trial"

    def read(self, text: str) -> tuple[str, Path, float, float]:
        """Plane, path, kg m and degrees."""
        from frbcli.units import ANGLE, quantity

        plane, equals, rest = text.partition("=")
        file, colon, given = rest.rpartition(":")
        size, at, angle = given.rpartition("@")
        if not (plane.strip() and equals and file.strip() and colon and at):
            raise ValueError(f"is no trial run. Write e.g. {EXAMPLE}.")
        unbalance = quantity(size.strip(), "kg*m", "5 g*mm")
        turned = quantity(angle.strip(), ANGLE, "30 deg")
        if not unbalance > 0.0:
            raise ValueError("has no unbalance above 0.")
        degrees = quantity("1 rad", ANGLE) * turned / quantity("1 deg", ANGLE)
        path = INPUT.convert(file.strip(), None, click.get_current_context(silent=True))
        return plane.strip(), path, unbalance, degrees


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
def balance_rotor(
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
    _show_corrections(terminal, balancing)
    if csv is not None:
        from frbcli.results.write import write_table

        write_table(balancing.to_pandas(), csv, forced())
        terminal.result(f"table: {csv}")
    terminal.emit(balance_document(balancing, run_file) | {"csv": csv})


def balance_document(balancing: Balancing, run_file: Path) -> dict[str, object]:
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
    from frbcli.results.measured import READERS

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


def _show_corrections(terminal: Terminal, balance: Balancing) -> None:
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
