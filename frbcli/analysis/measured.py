"""A measured motion as a run: the same spectra, orders and events as of a computed one."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from frbcli.analysis.events import find_events
from frbcli.analysis.orders.tacho import tacho_speed
from frbcli.analysis.signals import Values, joined, located
from frbcli.analysis.spectra.sampling import even_steps, times
from frbcli.results.measured import Columns, read_columns, wrong_file
from frbcli.results.records import LARGEST, SMALLEST, wrong_values
from frbcli.results.signals import Signal
from frbcli.results.store import Run
from frbcli.units import SPEED, ValueFault, quantity

MEASURED = "measured"  # the command of such a run
SAME = 1e-6  # relative difference of two units that are one


@dataclass(frozen=True)
class Measurement:
    """Where a motion stands in a file. x, y: columns of the displacement of a journal, y may be left out; time: column
    of the times, or rate in samples per second; speed: column of the rotor speed, or speed_Hz a constant one, or tacho
    the column of a signal with `pulses` per revolution; unit_m, time_unit_s, speed_unit_Hz: what 1 in the columns of
    displacements, times and speeds is; clearance: m, to which amplitudes refer."""

    x: str
    clearance: float
    y: str | None = None
    time: str | None = None
    rate: float | None = None
    speed: str | None = None
    speed_Hz: float | None = None
    tacho: str | None = None
    pulses: int = 1
    unit_m: float = 1.0
    time_unit_s: float = 1.0
    speed_unit_Hz: float = 1.0


def measured_run(path: Path, given: Measurement) -> Run:
    """A run with the signals time_s, speed_Hz, journal_x_m, journal_y_m, and with the events that are found in it.
    Without a y that is zero, and no events are sought: they need both.

    A mean is taken from x and y: the zero of a sensor is not the centre of a bearing. Raises InputError for a file that
    cannot be read or is ragged, a column that is missing or doubtful, times that do not rise or have gaps, and a rotor
    that turns faster than the samples show.
    """
    columns = read_columns(path)
    if not SMALLEST <= given.clearance <= LARGEST:
        raise wrong_file(
            path, f"cannot refer to a clearance of {given.clearance:g} m.", 'Give e.g. --clearance "35 um".'
        )
    signals = _signals(columns, given)
    run = Run(
        path=path,
        title=f"{path.stem}, {MEASURED}",
        command=MEASURED,
        case_name=path.stem,
        case_text="",
        versions={},
        signals=signals,
        status="finished",
        t_end_s=float(signals["time_s"].values[-1]),
        events=[],
        cost={},
        error={},
        references={"clearance_m": given.clearance},
        checkpoint=None,
    )
    if given.y is not None:
        run.events.extend(asdict(event) for event in find_events(run))
    return run


def events_at(run: Run, point: str, clearance: float) -> list[dict[str, Any]]:
    """The events of a run that its motion at one point shows, as they are found in a measurement of that: neither other
    points nor the critical speeds of the linearised machine help. point: "journal", "disk", "journal_NAME" or
    "disk_NAME"; clearance in m. None where y is zero throughout: it was not measured.
    """
    seen = joined(*located(run, point))
    if not np.any(run[f"{seen}_y_m"]):
        return []
    signals = {"time_s": run.signal("time_s"), "speed_Hz": run.signal("speed_Hz")}
    signals |= {f"journal_{axis}_m": run.signal(f"{seen}_{axis}_m") for axis in "xy"}
    alone = replace(run, signals=signals, references={"clearance_m": clearance}, status="finished")
    return [asdict(replace(event, point=seen)) for event in find_events(alone)]


def _signals(columns: Columns, given: Measurement) -> dict[str, Signal]:
    """The signals of a run at even steps."""
    used = [name for name in (given.x, given.y, given.time, given.speed, given.tacho) if name is not None]
    if len({len(columns[name]) for name in used}) > 1:
        raise wrong_file(columns.path, "has columns of unequal length.", "Give columns that were measured together.")
    x = _column(columns, given.x, given.unit_m, "m", "--unit")
    y = np.zeros_like(x) if given.y is None else _column(columns, given.y, given.unit_m, "m", "--unit")
    time = _times(columns, given, len(x))
    speed = _speeds(columns, given, time)
    _check_sampling(columns, given, time, speed)
    values = even_steps(time, {"speed_Hz": speed, "journal_x_m": x - x.mean(), "journal_y_m": y - y.mean()})
    units = {"time_s": "s", "speed_Hz": "Hz"}
    signals = {name: Signal(values[name], units.get(name, "m")) for name in values}
    wrong = wrong_values(signals)
    if wrong:
        raise wrong_file(columns.path, f"gives a {wrong} that no machine has.", "Check the units of its columns.")
    return signals


def _column(columns: Columns, name: str, one: float, unit: str, option: str) -> Values:
    """A column in SI; one: what 1 in it is. Raises InputError if the file says that it is something else."""
    values, stated = columns[name], columns.units.get(name)
    found = None if stated is None else _in_si(stated, unit)
    if found is not None and not math.isclose(found, one, rel_tol=SAME):
        problem = f'says that "{name}" is in {stated}, but {option} is {one:g} {unit}.'
        raise wrong_file(columns.path, problem, f'Give {option} "1 {stated}".')
    if not float(np.max(np.abs(values))) <= LARGEST / one:
        problem = f'has values of up to {np.max(np.abs(values)):.3g} in "{name}", and {option} is {one:g} {unit}.'
        raise wrong_file(columns.path, problem, f"Check {option}.")
    return np.asarray(values * one)


def _in_si(stated: str, unit: str) -> float | None:
    """What a unit in a file is in SI, None if it is no unit, or another kind of one."""
    try:
        return quantity(f"1 {stated}", unit)
    except ValueFault:
        return None


def _times(columns: Columns, given: Measurement, count: int) -> Values:
    if given.time is not None:
        return times(columns, given.time, _column(columns, given.time, given.time_unit_s, "s", "--time-unit"))
    rate = columns.rate if given.rate is None else given.rate
    if rate is None:
        raise wrong_file(columns.path, "does not tell the times of its samples.", "Give --time COLUMN or --rate.")
    if not SMALLEST <= rate <= LARGEST:
        raise wrong_file(columns.path, f"cannot have {rate:g} samples per second.", "Give --rate.")
    return np.arange(count) / rate


def _speeds(columns: Columns, given: Measurement, time: Values) -> Values:
    if given.speed is not None:
        return _column(columns, given.speed, given.speed_unit_Hz, SPEED, "--speed-unit")
    if given.speed_Hz is not None:
        return np.full(len(time), given.speed_Hz)
    if given.tacho is None:
        remedy = "Give --speed COLUMN, --speed-at, or --tacho COLUMN."
        raise wrong_file(columns.path, "does not tell the rotor speed.", remedy)
    pulses = columns[given.tacho]
    try:
        return tacho_speed(time, pulses, given.pulses)
    except ValueError as error:
        raise wrong_file(columns.path, f'column "{given.tacho}" {error}', "Choose the column of the pulses.") from None


def _check_sampling(columns: Columns, given: Measurement, time: Values, speed: Values) -> None:
    """Raises InputError if the rotor turns faster than the samples show, which also tells of a wrong unit of times or
    speeds before anything is computed with them."""
    rate = (len(time) - 1) / max(float(time[-1] - time[0]), SMALLEST)
    fastest = float(np.max(np.abs(speed)))
    if not 2.0 * fastest < rate:
        problem = f"has {rate:.4g} samples per second, too few for a rotor of up to {fastest:.4g} Hz."
        times_by = "--rate" if given.time is None else "--time-unit"
        speeds_by = "--speed-unit" if given.speed else "--speed-at" if given.tacho is None else "--pulses"
        remedy = f"Check {times_by} and {speeds_by}; more than two samples per revolution are needed."
        raise wrong_file(columns.path, problem, remedy)
