"""A measured motion as a run: the same spectra, orders and events as of a computed one."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from frbcli.analysis.events import find_events
from frbcli.analysis.signals import Values
from frbcli.results.measured import Columns, read_columns, wrong_file
from frbcli.results.signals import Signal
from frbcli.results.store import Run

MEASURED = "measured"  # the command of such a run
UNEVEN = 1e-3  # of the step, by which times may be off it; beyond this the signals are interpolated to even steps
LEAST_PULSES = 3
REVOLUTIONS = 8  # that a speed is taken over


@dataclass(frozen=True)
class Measurement:
    """Where a motion stands in a file. x, y: columns of the displacement of a journal, y may be left out; time: column
    in s, or rate in samples per second; speed: column in Hz, or speed_Hz a constant one, or tacho the column of a
    signal with `pulses` per revolution; unit_m: what 1 in x and y is in m; clearance: m, to which amplitudes refer."""

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


def measured_run(path: Path, given: Measurement) -> Run:
    """A run with the signals time_s, speed_Hz, journal_x_m, journal_y_m, and with the events that are found in it.
    Without a y that is zero, and no events are sought: they need both.

    A mean is taken from x and y: the zero of a sensor is not the centre of a bearing. Raises InputError for a file that
    cannot be read, a column that is missing, or times that do not rise.
    """
    columns = read_columns(path)
    x = given.unit_m * columns[given.x]
    motion = {"journal_x_m": x, "journal_y_m": np.zeros_like(x) if given.y is None else given.unit_m * columns[given.y]}
    count = len(x)
    time = _times(columns, given, count)
    signals = {"time_s": time, "speed_Hz": _speeds(columns, given, time)}
    signals |= {name: values - values.mean() for name, values in motion.items()}
    if any(len(values) != count for values in signals.values()):
        raise wrong_file(path, "has columns of unequal length.", "Give columns that were measured together.")
    signals = _even(signals)
    units = {"time_s": "s", "speed_Hz": "Hz"}
    run = Run(
        path=path,
        title=f"{path.stem}, {MEASURED}",
        command=MEASURED,
        case_name=path.stem,
        case_text="",
        versions={},
        signals={name: Signal(values, units.get(name, "m")) for name, values in signals.items()},
        status="finished",
        t_end_s=float(signals["time_s"][-1]),
        events=[],
        cost={},
        error={},
        references={"clearance_m": given.clearance},
        checkpoint=None,
    )
    if given.y is not None:
        run.events.extend(asdict(event) for event in find_events(run))
    return run


def tacho_speed(time: Values, signal: Values, pulses: int) -> Values:
    """(n,) rotor speed in Hz from a signal with so many pulses per revolution, at the times (n,) in s.

    A pulse begins where the signal rises through the middle between its least and its largest value, interpolated
    between samples. The speed is that over REVOLUTIONS about a pulse, fewer at the ends, as a rectangular pulse is
    known to a sample only. Raises ValueError if there are too few pulses.
    """
    level = 0.5 * (signal.min() + signal.max())
    rises = np.flatnonzero((signal[:-1] < level) & (signal[1:] >= level))
    if len(rises) < LEAST_PULSES:
        raise ValueError(f"has {len(rises)} pulses, at least {LEAST_PULSES} are needed.")
    share = (level - signal[rises]) / (signal[rises + 1] - signal[rises])
    moments = time[rises] + share * (time[rises + 1] - time[rises])
    number = np.arange(len(moments))
    half = max(1, REVOLUTIONS * pulses // 2)
    first, last = np.maximum(number - half, 0), np.minimum(number + half, len(moments) - 1)
    speeds = (last - first) / (pulses * (moments[last] - moments[first]))
    return np.asarray(np.interp(time, 0.5 * (moments[first] + moments[last]), speeds), dtype=np.float64)


def _times(columns: Columns, given: Measurement, count: int) -> Values:
    if given.time is not None:
        time = columns[given.time]
        if np.any(np.diff(time) <= 0.0):
            raise wrong_file(columns.path, f'has times in "{given.time}" that do not rise.', "Sort the rows by time.")
        return time
    rate = given.rate or columns.rate
    if rate is None:
        raise wrong_file(columns.path, "does not tell the times of its samples.", "Give --time COLUMN or --rate.")
    return np.arange(count) / rate


def _speeds(columns: Columns, given: Measurement, time: Values) -> Values:
    if given.speed is not None:
        return columns[given.speed]
    if given.speed_Hz is not None:
        return np.full(len(time), given.speed_Hz)
    if given.tacho is None:
        remedy = "Give --speed COLUMN, --speed-at, or --tacho COLUMN."
        raise wrong_file(columns.path, "does not tell the rotor speed.", remedy)
    try:
        return tacho_speed(time, columns[given.tacho], given.pulses)
    except ValueError as error:
        raise wrong_file(columns.path, f'column "{given.tacho}" {error}', "Choose the column of the pulses.") from None


def _even(signals: dict[str, Values]) -> dict[str, Values]:
    """The same at even steps."""
    time = signals["time_s"]
    step = (time[-1] - time[0]) / (len(time) - 1)
    even = time[0] + step * np.arange(len(time))
    if np.max(np.abs(even - time)) < UNEVEN * step:
        return {**signals, "time_s": even}
    return {name: even if name == "time_s" else np.interp(even, time, values) for name, values in signals.items()}
