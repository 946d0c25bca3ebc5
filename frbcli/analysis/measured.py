"""A measured motion as a run: the same spectra, orders and events as of a computed one; less its slow roll.

The slow-roll vector is what a probe sees once in a revolution as the rotor turns slowly, without dynamic forces. It is
the runout of the surface under the probe with the bow of the shaft, and belongs to the angle of the rotor at all
speeds: subtracted, it leaves the motion of the rotor.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from frbcli.analysis.events import Event, find_events
from frbcli.analysis.forced import ForcedLine, constant_lines, forced_lines, forced_references
from frbcli.analysis.signals import even_steps, point_of, require_rising, sampled_at
from frbcli.analysis.tacho import MARK, Tacho, tacho_speed
from frbcli.arrays import Array
from frbcli.errors import did_you_mean
from frbcli.results.measured import read_columns
from frbcli.results.measured_columns import Columns, is_interval, wrong_file
from frbcli.results.records import LARGEST, SMALLEST, Signal, wrong_values
from frbcli.results.store import Run
from frbcli.units import SPEED, ValueFault, display, quantity

BAND = 0.1  # of the slow speed, by which the speed may be off it
LEAST_REVOLUTIONS = 3.0  # about that speed
MEASURED = "measured"  # the command of such a run
USUAL = {"--unit": 1e-6, "--time-unit": 1.0, "--speed-unit": 1.0}  # SI, of columns without a unit
SPELLINGS = {  # of units, in measured files
    "u/min": "rpm", "upm": "rpm", "seconds": "s", "second": "s", "days": "day", "rad_s": "rad/s", "radps": "rad/s",
}  # fmt: skip
RATE_OF_TIME = ("m/s", "m/s^2")  # SI units of what a sensor of motion may give instead of a displacement
MOST_NUMBERS = 8  # of a file, in a remedy
EXAMPLES = {"--unit": '"125 um"', "--time-unit": '"1 ms"', "--speed-unit": '"1 rpm"'}
SAME = 1e-6  # relative difference of two units that are one
NAMES = {"--unit": "um", "--time-unit": "s", "--speed-unit": "Hz"}  # of the units in USUAL
ANGULAR = re.compile(r"omega\w*|ω|Ω|w", re.IGNORECASE)  # names of a speed in rad/s, as equations have it
NEAR = 0.1  # of a step, by which times may differ that are the same
LEAST_TURNS = 0.1  # of the rotor in a measurement
SLOWEST = 1.0  # samples per second: a smaller number is an interval


@dataclass(frozen=True)
class SlowRoll:
    """vector: complex amplitude A of Re(A exp(i angle)), in the unit of the signal; revolutions: that it was taken
    over."""

    vector: complex
    revolutions: float

    def at(self, angle: Array) -> Array:
        """(n,) the slow roll at angles (n,) of the rotor in rad."""
        return np.asarray((self.vector * np.exp(1j * angle)).real)


def slow_roll(signal: Array, angle: Array, speed: Array, slow: float) -> SlowRoll:
    """The slow-roll vector of a signal (n,) at angles (n,) in rad and speeds (n,) in Hz of the rotor, where these are
    within BAND of the speed `slow` in Hz, by least squares together with a straight line.

    Raises ValueError if the rotor turns less than LEAST_REVOLUTIONS there."""
    near = np.abs(np.abs(speed) - slow) <= BAND * slow
    turned = np.abs(np.diff(angle))[near[1:] & near[:-1]].sum() / (2.0 * np.pi)
    if turned < LEAST_REVOLUTIONS:
        least, most = float(np.abs(speed).min()), float(np.abs(speed).max())
        raise ValueError(
            f"turns {turned:.2g} times within {BAND:.0%} of {slow:g} Hz, and {LEAST_REVOLUTIONS:g} times are needed: "
            f"its speed is {least:.4g} to {most:.4g} Hz."
        )
    there = angle[near]
    line = (there - there.mean()) / np.ptp(there)
    columns = np.column_stack([np.cos(there), -np.sin(there), np.ones_like(there), line])
    real, imaginary = np.linalg.lstsq(columns, signal[near], rcond=None)[0][:2]
    return SlowRoll(complex(real, imaginary), float(turned))


@dataclass(frozen=True)
class Measurement:
    """The columns of a file that hold a motion.

    Parameters
    ----------
    x : str
        Column of the displacement of a journal.
    clearance : float, optional
        Radial clearance in m, to which amplitudes refer. Without it there are amplitudes in m, and no events.
    y : str, optional
        Column of the other displacement; frb finds events only if both are given.
    time : str, optional
        Column of the times. Default: the only one that is called time, t, Zeit or the like.
    rate : float or str, optional
        Samples per second instead of `time`, or the name of a single number of the file, such as "fs".
    speed : str, optional
        Column of the rotor speed.
    speed_Hz : float, optional
        A constant rotor speed in Hz, instead of `speed`.
    tacho : str, optional
        Column of a signal with pulses, from which the rotor speed follows, instead of `speed`.
    pulses : int
        Pulses of `tacho` per revolution.
    unit_m, time_unit_s, speed_unit_Hz : float, optional
        What 1 in the columns of displacements, times and speeds is, in m, s and Hz. None: the unit of the file, or of
        the name of the column, or else 1 um, 1 s and 1 Hz. `Run.remarks` states the units that were used.
    speed_time : str, optional
        Column of the times of `speed`, where it was sampled at others than the displacements.
    slow_roll_Hz : float, optional
        A slow speed in Hz that the measurement has, whose motion with the angle of the rotor is subtracted from the
        displacements at all speeds; needs `tacho`.

    Examples
    --------
    >>> from frbcli import Measurement
    >>> given = Measurement("x", clearance=35e-6, y="y", time="t", speed="n")
    >>> given.pulses
    1
    """

    x: str
    clearance: float | None = None
    y: str | None = None
    time: str | None = None
    rate: float | str | None = None
    speed: str | None = None
    speed_Hz: float | None = None
    tacho: str | None = None
    pulses: int = 1
    unit_m: float | None = None
    time_unit_s: float | None = None
    speed_unit_Hz: float | None = None
    speed_time: str | None = None
    slow_roll_Hz: float | None = None


def measured_run(path: str | Path, given: Measurement) -> Run:
    """Read a measured motion as a run, with the events that are found in it.

    Parameters
    ----------
    path : str or Path
        A CSV, WAV, MAT or UFF file.
    given : Measurement
        The columns of the motion and their units.

    Returns
    -------
    Run
        The signals time_s, speed_Hz, journal_x_m, journal_y_m, in SI, x and y less their means: the zero of a sensor is
        not the centre of a bearing. Without a column for y that is zero, and no events are sought. `remarks` state the
        units, pulses that were missing or double, and the slow roll.

    Raises
    ------
    InputError
        For a file that cannot be read or is ragged, a column that is missing or doubtful, times that do not rise or
        have gaps, and a rotor that turns faster than the samples show.

    Examples
    --------
    >>> import frbcli
    >>> given = frbcli.Measurement("x", clearance=35e-6, y="y", time="t", speed="n", unit_m=1e-6)
    >>> run = frbcli.measured_run("measured.csv", given)  # doctest: +SKIP
    """
    path = Path(path)
    columns = read_columns(path)
    if given.clearance is not None and not SMALLEST <= given.clearance <= LARGEST:
        raise wrong_file(
            path, f"cannot refer to a clearance of {given.clearance:g} m.", 'Give e.g. --clearance "35 um".'
        )
    signals, remarks, references, per_minute = _signals(columns, given)
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
        references=references | ({} if given.clearance is None else {"clearance_m": given.clearance}),
        checkpoint=None,
        remarks=remarks,
        per_minute=per_minute,
    )
    if given.y is not None and given.clearance is not None:
        lines = constant_lines(run, given.clearance)
        run.references.update(forced_references(lines))
        events = [*(_forced(run, line) for line in lines), *find_events(run)]
        run.events.extend(asdict(event) for event in events)
    return run


def measured_probes(path: str | Path, given: Measurement, probes: Sequence[tuple[str, str | None]]) -> Run:
    """Read several probes of one file as a run, the first of them named "journal", or each by its column of x,
    "journal_NAME", where there are several. probes: columns of x and y, y None where it was not measured; given: what
    else holds for all of them. Raises InputError as measured_run does; no events are sought."""
    runs = [measured_run(path, replace(given, x=x, y=y, clearance=None)) for x, y in probes]
    if len(runs) == 1:
        return runs[0]
    signals = {name: signal for name, signal in runs[0].signals.items() if not name.startswith("journal")}
    for (x, _), run in zip(probes, runs, strict=True):
        signals |= {f"journal_{x}_{axis}_m": run.signal(f"journal_{axis}_m") for axis in "xy"}
    remarks = dict.fromkeys(remark for run in runs for remark in run.remarks)
    return replace(runs[0], signals=signals, remarks=tuple(remarks))


def _forced(run: Run, line: ForcedLine) -> Event:
    """A line that keeps its frequency at all rotor speeds, from the beginning of a measurement on."""
    t_s, speed = float(run["time_s"][0]), float(run["speed_Hz"][0])
    ratio = line.frequency_Hz / abs(speed) if speed else None
    return Event("forced", None, t_s, speed, line.frequency_Hz, ratio, "journal", line.amplitude)


def events_at(run: Run, point: str, clearance: float) -> list[dict[str, Any]]:
    """The events of a run that its motion at one point shows, as they are found in a measurement of that: neither other
    points nor the critical speeds of the linearised machine help. point: "journal", "disk", "journal_NAME" or
    "disk_NAME"; clearance in m. None where y is zero throughout: it was not measured.
    """
    seen = point_of(run, point)
    if not np.any(run[f"{seen}_y_m"]):
        return []
    signals = {"time_s": run.signal("time_s"), "speed_Hz": run.signal("speed_Hz")}
    signals |= {f"journal_{axis}_m": run.signal(f"{seen}_{axis}_m") for axis in "xy"}
    references = {"clearance_m": clearance, **forced_references(forced_lines(run))}
    alone = replace(run, signals=signals, references=references, status="finished")
    return [asdict(replace(event, point=seen)) for event in find_events(alone)]


def _signals(
    columns: Columns, given: Measurement
) -> tuple[dict[str, Signal], tuple[str, ...], dict[str, float], bool]:
    """(the signals of a run at even steps, what is to be said of them, its references, whether its speeds are in
    revolutions per minute)."""
    units = _Units(columns)
    x = units.column(given.x, given.unit_m, "m", "--unit")
    y = np.zeros_like(x) if given.y is None else units.column(given.y, given.unit_m, "m", "--unit")
    time = _times(units, given, len(x))
    _require_common_times(columns, given)
    if len({len(x), len(y), len(time)}) > 1:
        raise wrong_file(columns.path, "has columns of unequal length.", "Give columns that were measured together.")
    speed, tacho = _speeds(units, given, time)
    _check_sampling(columns, given, time, speed)
    seen = {"x": x} if given.y is None else {"x": x, "y": y}
    seen, rolled = _without_slow_roll(columns, given, tacho, seen)
    x, y = seen["x"], seen.get("y", y)
    pulses = "" if tacho is None else tacho.remark(given.tacho or "")
    values = even_steps(time, {"speed_Hz": speed, "journal_x_m": x - x.mean(), "journal_y_m": y - y.mean()})
    signals = {name: Signal(values[name], {"time_s": "s", "speed_Hz": "Hz"}.get(name, "m")) for name in values}
    wrong = wrong_values(signals)
    if wrong:
        raise wrong_file(columns.path, f"gives a {wrong} that no machine has.", "Check the units of its columns.")
    references = {} if tacho is None or tacho.mark is None else {MARK: tacho.mark}
    return signals, tuple(filter(None, (units.sentence(), pulses, rolled))), references, units.per_minute


def _without_slow_roll(
    columns: Columns, given: Measurement, tacho: Tacho | None, seen: Mapping[str, Array]
) -> tuple[dict[str, Array], str]:
    """(displacements (n,) in m without their slow roll, if that is asked for, what is to be said of it)."""
    if given.slow_roll_Hz is None:
        return dict(seen), ""
    if tacho is None:
        problem = "does not hold the angle of the rotor, with which the slow roll turns."
        raise wrong_file(columns.path, problem, "Give --tacho COLUMN, or leave --slow-roll out.")
    left, vectors, revolutions = dict[str, Array](), list[str](), 0.0
    for name, signal in seen.items():
        try:
            roll = slow_roll(signal, tacho.angle, tacho.speed_Hz, given.slow_roll_Hz)
        except ValueError as error:
            remedy = "Give --slow-roll a speed that it keeps for a while, well below the critical speeds."
            raise wrong_file(columns.path, f"has a rotor that {error}", remedy) from None
        left[name], revolutions = signal - roll.at(tacho.angle), roll.revolutions
        vectors.append(f"{name} {1e6 * abs(roll.vector):.4g} um at {math.degrees(cmath.phase(roll.vector)):.4g} deg")
    at = f"{given.slow_roll_Hz:g} Hz over {revolutions:.3g} revolutions"
    return left, f"Slow roll subtracted, of {at}: {', '.join(vectors)}."


class _Units:
    """The columns of a file in SI, with a record of the units that were taken."""

    def __init__(self, columns: Columns) -> None:
        self.columns = columns
        self._used: dict[str, str] = {}
        self.per_minute = False  # whether speeds are in revolutions per minute

    def sentence(self) -> str:
        """The units of the columns that were read."""
        return f"Units: {', '.join(f'{name} in {unit}' for name, unit in self._used.items())}."

    def column(self, name: str, one: float | None, unit: str, option: str, gaps: bool = False) -> Array:
        """A column in SI, with NaN at gaps if these are wanted.

        one: what 1 in it is, None for what the file says or else the usual unit. Raises InputError if the file says
        that it is something else.
        """
        columns = self.columns
        values, stated = columns.values[columns.named(name)] if gaps else columns[name], columns.unit(name)
        one = self._one(name, stated, one, unit, option)
        self.per_minute |= unit == SPEED and math.isclose(one, 1.0 / 60.0, rel_tol=SAME)
        largest = float(np.nanmax(np.abs(values), initial=0.0))
        if not largest <= LARGEST / one:
            problem = f'has values of up to {largest:.3g} in "{name}", and {option} is {one:g} {unit}.'
            raise wrong_file(columns.path, problem, f"Check {option}.")
        return np.asarray(values * one)

    def _one(self, name: str, stated: str | None, one: float | None, unit: str, option: str) -> float:
        """Value in SI of 1 in a column."""
        in_unit = None if stated is None else _in_si(stated, unit)
        path = self.columns.path
        if stated is not None and unit == "m" and any(_in_si(stated, other) for other in RATE_OF_TIME):
            problem = f'has "{name}" in {stated}, which is no displacement.'
            raise wrong_file(path, problem, "Integrate it over time first.")
        if one is None and stated is not None and in_unit is None:
            problem = f'says that "{name}" is in {stated}, which is no unit of this kind.'
            raise wrong_file(path, problem, f"Say by {option} what 1 {stated} means, e.g. {EXAMPLES[option]}.")
        if one is None and stated is None and unit == SPEED and ANGULAR.fullmatch(name):
            problem = f'has no unit of "{name}", which is Hz or rad/s.'
            raise wrong_file(path, problem, f'Give {option} "1 rad/s" or {option} "1 Hz".')
        if one is None:
            assumed = f"{NAMES[option]} (no unit in the file; {option} changes it)"
            self._used[name] = assumed if stated is None else stated
            return in_unit or USUAL[option]
        if in_unit is not None and not math.isclose(in_unit, one, rel_tol=SAME):
            problem = f'says that "{name}" is in {stated}, but {option} is {one:g} {unit}.'
            raise wrong_file(path, problem, f'Give {option} "1 {stated}".')
        self._used[name] = stated if in_unit is not None and stated else display(one, unit)
        return one


def _in_si(stated: str, unit: str) -> float | None:
    """The SI value of a unit in a file; None if it is no unit, or another kind of one."""
    for spelled in (stated, SPELLINGS.get(stated.lower(), stated.lower())):
        try:
            return quantity(f"1 {spelled}", unit)
        except ValueFault:
            continue
    return None


def _times(units: _Units, given: Measurement, count: int) -> Array:
    columns = units.columns
    own = columns.own_times.get(columns.named(given.x))
    if own is not None:
        return require_rising(columns, "time", own)
    rate = columns.rate if given.rate is None else given.rate
    name = columns.time_name if given.time is None and rate is None else given.time
    if name is not None:
        return require_rising(columns, name, units.column(name, given.time_unit_s, "s", "--time-unit"))
    if rate is None:
        numbers = ", ".join(f"{name} = {value:g}" for name, value in list(columns.numbers.items())[:MOST_NUMBERS])
        or_number = f", or --rate NAME of one of its numbers: {numbers}." if numbers else "."
        remedy = f"Give --time COLUMN, --rate NUMBER{or_number}"
        raise wrong_file(columns.path, "does not hold the times of its samples.", remedy)
    if isinstance(rate, str):
        rate = _number(columns, rate)
    if not SMALLEST <= rate <= LARGEST:
        raise wrong_file(columns.path, f"cannot have {rate:g} samples per second.", "Give --rate.")
    if rate < SLOWEST:
        problem = f"cannot have {rate:g} samples per second, which looks like the time between two samples."
        raise wrong_file(columns.path, problem, f"Give --rate {1.0 / rate:.9g}.")
    return np.arange(count) / rate


def _require_common_times(columns: Columns, given: Measurement) -> None:
    """Raises InputError for a column that stands behind other times than those that are used, as files have it in
    which each channel has its own."""
    names, used = list(columns.values), columns.time_name if given.time is None else given.time
    if used is None or given.rate is not None:
        return
    used = columns.named(used)
    speed = [] if given.speed is None or given.speed_time is not None else [given.speed]
    for name in filter(None, (given.x, given.y, given.tacho, *speed)):
        behind = names[: names.index(columns.named(name))]
        own = next((each for each in reversed(behind) if columns.holds_times(each)), used)
        others = columns.values[own]
        if own != used and others.shape == columns.values[used].shape and not _same(columns.values[used], others):
            problem = f'has "{name}" behind the times "{own}", which differ from "{used}".'
            remedy = f'Give --speed-time "{own}".' if name in speed else "Give columns that have their times in common."
            raise wrong_file(columns.path, problem, remedy)


def _same(times: Array, others: Array) -> bool:
    """Whether two columns of times agree to a tenth of their steps."""
    step = (times[-1] - times[0]) / (len(times) - 1)
    return bool(np.nanmax(np.abs(times - others)) <= NEAR * abs(step))


def _number(columns: Columns, name: str) -> float:
    """A single number of the file as samples per second."""
    if name in columns.numbers:
        value = columns.numbers[name]
        return 1.0 / value if is_interval(name) and 0.0 < value < SLOWEST else value
    remedy = f"Give --rate in samples per second. {did_you_mean(name, columns.numbers)}".strip()
    raise wrong_file(columns.path, f'has no single number "{name}".', remedy)


def _speeds(units: _Units, given: Measurement, time: Array) -> tuple[Array, Tacho | None]:
    """(the rotor speed (n,) in Hz at the times (n,) in s, the tacho pulses if it follows from them)."""
    columns = units.columns
    if given.speed is not None:
        speed = units.column(given.speed, given.speed_unit_Hz, SPEED, "--speed-unit", gaps=True)
        own = columns.own_times.get(columns.named(given.speed))
        if given.speed_time is not None:
            own = units.column(given.speed_time, given.time_unit_s, "s", "--time-unit", gaps=True)
        return sampled_at(time, columns, given.speed, time if own is None else own, speed), None
    if given.speed_Hz is not None:
        return np.full(len(time), given.speed_Hz), None
    if given.tacho is None:
        remedy = "Give --speed-column COLUMN, --speed-at, or --tacho COLUMN."
        raise wrong_file(columns.path, "does not hold the rotor speed.", remedy)
    pulses = columns[given.tacho]
    try:
        if len(pulses) != len(time):
            raise ValueError("has another length than the displacements.")
        turning = tacho_speed(time, pulses, given.pulses)
    except ValueError as error:
        raise wrong_file(columns.path, f'column "{given.tacho}" {error}', "Choose the column of the pulses.") from None
    return turning.speed_Hz, turning


def _check_sampling(columns: Columns, given: Measurement, time: Array, speed: Array) -> None:
    """Raises InputError if the rotor turns faster than the samples can show; this also finds a wrong unit of times or
    speeds before anything is computed with them."""
    lasts_s = float(time[-1] - time[0])
    rate = (len(time) - 1) / max(lasts_s, SMALLEST)
    fastest = float(np.max(np.abs(speed)))
    turned = fastest * lasts_s
    if not 2.0 * fastest < rate or 0.0 < turned < LEAST_TURNS:
        problem = f"has {rate:.4g} samples per second, too few for a rotor of up to {fastest:.4g} Hz."
        if turned < LEAST_TURNS:
            problem = f"lasts {lasts_s:.3g} s, in which a rotor of {fastest:.4g} Hz turns {turned:.2g} times."
        times_by = "--rate" if given.time is None else "--time-unit"
        speeds_by = "--speed-unit" if given.speed else "--speed-at" if given.tacho is None else "--pulses"
        remedy = f"Check {times_by} and {speeds_by}; more than two samples per revolution are needed."
        raise wrong_file(columns.path, problem, remedy)
