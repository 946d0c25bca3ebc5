"""Tables over time out of a file of a measuring instrument or of a calculation: CSV, WAV, MAT or UFF.

The case gets the numbers instead of the key `file`, so that a run has all that it was made of. Of the rotor speed it
gets times and speeds instead of the keys `points` or `file`, and from, to and duration that follow from them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frbcli.arrays import Array
from frbcli.case.model import SMALLEST, Model, unit_of
from frbcli.case.over_time import OverTime
from frbcli.case.reading.files import Refused, with_file
from frbcli.case.reading.tables import Breach, pairs, table, tables
from frbcli.case.reading.tables import Path as Key
from frbcli.errors import InputError
from frbcli.units import SPEED, ValueFault, quantity

if TYPE_CHECKING:
    from frbcli.results.measured_columns import Columns


MOST_NUMBERS = 60_000  # of all tables of a case, whose text a run file holds
TIMES, RATES = ("t", "time", "zeit"), ("fs", "rate", "sampling_rate", "sample_rate")
EVEN, MOSTLY = 0.01, 0.9  # share by which steps of time may differ, and share of them from which a table is even
FEWEST_EVEN = 20  # rows of a table in which gaps are sought
SPARSE = 10.0  # times the interval that most rows of an uneven table do not exceed: a gap
SUFFIX = re.compile(r"(.+)_([A-Za-z0-9]+)")  # of names such as time_s, as frb export writes them


@dataclass(frozen=True)
class TableKind:
    """What a file holds over time. unit: SI; x, y: names of its columns, in small letters and without unit."""

    unit: str
    x: tuple[str, ...]
    y: tuple[str, ...]


FORCE = TableKind("N", ("x", "fx", "force_x", "1"), ("y", "fy", "force_y", "2"))
ACCELERATION = TableKind("m/s^2", ("x", "ax", "acceleration_x", "1"), ("y", "ay", "acceleration_y", "2"))
PRESSURE_TABLE = TableKind("Pa", ("pressure", "supply_pressure", "p"), ())
TEMPERATURE_TABLE = TableKind("K", ("temperature", "supply_temperature"), ())
LOAD = TableKind("N", ("load", "axial_load", "force"), ())
WALLS = ("shaft", "housing")
IN_A_BEARING = ("inner", "outer", "damper")  # tables of films
KINDS = {"force": FORCE, "base": ACCELERATION}  # tables of the case file that can have `file`


def with_time_tables(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with the numbers of each `file` over time instead of that key, and the faults.

    folder: that a relative path counts from. A table whose file has faults keeps the key.
    """
    breaches, left = list[Breach](), MOST_NUMBERS
    for kind, wanted in KINDS.items():

        def joined(name: str, kept: dict[str, Any], wanted: TableKind = wanted) -> dict[str, Any]:
            nonlocal left
            numbers = read_table(folder / name, wanted, left)
            left -= sum(map(len, numbers.values()))
            return {**kept, "over_time": {"source": name, **numbers}}

        for path, _ in tables(data, kind):
            data, faults = with_file(data, path, joined, ("over_time",))
            breaches += faults
    return data, breaches


def read_table(path: Path, wanted: TableKind, most: int = MOST_NUMBERS) -> dict[str, list[float]]:
    """The columns time, x and, where there are two, y of a file, in SI. Raises Refused."""
    from frbcli.results.measured import read_columns

    try:
        columns = read_columns(path)
        time = _times(columns)
        x, y = _named(columns, wanted)
        values = {"x": _values(columns, x, wanted)} | ({"y": _values(columns, y, wanted)} if y else {})
    except InputError as error:
        (fault,) = error.faults
        raise Refused(fault.problem, fault.remedy) from None
    series = {"time": time, **values}
    shortest, longest = min(map(len, series.values())), max(map(len, series.values()))
    if shortest != longest:
        raise Refused(f"has columns of {shortest} and of {longest} rows.", "Give all columns the same rows.")
    if longest * len(series) > most:
        problem = f"has {longest} rows of {len(series)} columns; the tables of a case hold {MOST_NUMBERS} numbers."
        raise Refused(problem, "Cut it, or sample it at fewer times.")
    _check_times(columns, time, list(values.values()))
    return {name: column.tolist() for name, column in series.items()}


def read_tacho(path: Path, name: str, pulses: int) -> dict[str, list[float]]:
    """Times in s and speeds x in Hz of a column with so many pulses per revolution, a row for each revolution. Raises
    Refused."""
    import numpy as np

    from frbcli.analysis.tacho import tacho_speed
    from frbcli.results.measured import read_columns

    if not isinstance(pulses, int) or pulses < 1:
        raise Refused(f"has {pulses} pulses per revolution.", "Write e.g. pulses = 1.")
    try:
        columns = read_columns(path)
        signal, time = columns[name], _times(columns)
    except InputError as error:
        (fault,) = error.faults
        raise Refused(fault.problem, fault.remedy) from None
    _check_times(columns, time, [signal])
    try:
        speed = tacho_speed(time, signal, pulses).speed_Hz
    except ValueError as error:
        raise Refused(f'has a column "{name}" that {error}', "Give a signal with pulses as tacho.") from None
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    rows = np.interp(np.arange(1.0, turned[-1]), turned, time)
    inside = rows[(rows > time[0]) & (rows < time[-1])]
    moments = np.concatenate([time[:1], inside, time[-1:]])
    return {"time": moments.tolist(), "x": np.interp(moments, time, speed).tolist()}


def _plain(columns: Columns) -> Iterator[tuple[str, str]]:
    """The names of the columns: as people write them, in small letters and without unit, and as in the file."""
    from frbcli.results.delimited import without_unit

    for name in columns.values:
        plain = without_unit(name).strip().lower()
        yield plain, name
        if suffix := SUFFIX.fullmatch(plain):
            yield suffix.group(1), name


def _times(columns: Columns) -> Array:
    import numpy as np

    named = dict(_plain(columns))
    for name in TIMES:
        if name in named:
            return columns[named[name]] * _unit(columns, named[name], "s")
    rates = [value for name, value in columns.numbers.items() if name.lower() in RATES]
    rate = columns.rate or (rates[0] if rates else None)
    if rate is None or not rate > 0.0:
        raise Refused('has no column "time".', 'Call the column of its times "time" or "t"; a WAV needs none.')
    return np.arange(max(map(len, columns.values.values()), default=0)) / rate


def _named(columns: Columns, wanted: TableKind) -> tuple[str, str]:
    """The columns of x and y; of a single one there is no y."""
    named = dict(_plain(columns))
    x, y = ([named[name] for name in names if name in named][:1] for names in (wanted.x, wanted.y))
    if x and (y or not wanted.y):
        return x[0], y[0] if y else ""
    others = [name for plain, name in _plain(columns) if name in columns.values and plain not in TIMES]
    single = [name for name in dict.fromkeys(others) if name not in {named.get(time) for time in TIMES}]
    if len(single) == 1:
        return single[0], ""
    listed = ", ".join(f'"{name}"' for name in columns.values)
    if not wanted.y:
        raise Refused(f'has no column "{wanted.x[0]}".', f'Call it "{wanted.x[0]}". It has: {listed}.')
    remedy = f'Call them "{wanted.x[0]}" and "{wanted.y[0]}", or give one column besides the time. It has: {listed}.'
    raise Refused("has no columns of the values in x and y.", remedy)


def _values(columns: Columns, name: str, wanted: TableKind) -> Array:
    none, one = (_unit(columns, name, wanted.unit, number) for number in (0, 1))
    values = columns[name] * (one - none) + none
    values[abs(values) < SMALLEST] = 0.0  # round-off, as of a sine at its zero
    return values


def _unit(columns: Columns, name: str, si: str, number: int = 1) -> float:
    """SI value of a number in a column. Raises Refused for a unit of something else."""
    unit = columns.unit(name) or ""
    suffix = SUFFIX.fullmatch(name)
    if not unit.strip("-1 ") and suffix is None:
        return float(number)
    try:
        return quantity(f"{number} {unit if unit.strip('-1 ') else suffix.group(2) if suffix else si}", si)
    except ValueFault:
        if not unit.strip("-1 "):
            return float(number)  # the end of a name that is no unit
        problem = f'has "{unit}" as unit of the column "{name}".'
        raise Refused(problem, f"Give it in {si} or a unit like it.") from None


def _check_times(columns: Columns, time: Array, values: Sequence[Array]) -> None:
    """Times rise, and the table has no gap: no missing rows among even ones, and among uneven ones no interval that is
    much longer than most and across which a line would make up the values."""
    import numpy as np

    if len(time) < 2:
        raise Refused("has fewer than two rows.", "Give the values at two times at least.")
    steps = np.diff(time)
    if not np.all(steps > 0.0):
        row = int(np.argmin(steps > 0.0)) + 1
        problem = f"has the time {time[row]:.6g} s in {columns.row(row)}, not later than the row before."
        raise Refused(problem, "Order its rows by rising times, each once.")
    if len(time) < FEWEST_EVEN:
        return
    usual = float(np.median(steps))
    even = np.abs(steps - usual) <= EVEN * usual
    if np.mean(even) >= MOSTLY:
        wide, others = steps > 1.5 * usual, f"other rows are {usual:.4g} s apart"
    else:
        most = float(np.quantile(steps, MOSTLY))
        wide = (steps > SPARSE * most) & _differ(values)
        others = f"most rows are at most {most:.4g} s apart, and the values on both sides differ"
    if np.any(wide):
        row = int(np.argmax(wide)) + 1
        problem = f"has a gap of {steps[row - 1]:.4g} s before {columns.row(row)}; {others}."
        raise Refused(problem, "Fill the gap, or cut the table there.")


def _differ(values: Sequence[Array]) -> Any:
    """Whether values of neighbouring rows differ, by more than a small share of the range of their column."""
    import numpy as np

    return np.any([np.abs(np.diff(each)) > EVEN * np.ptp(each) for each in values], axis=0)


@dataclass(frozen=True)
class InputOverTime:
    """An input of a case that changes over time: its key, its values in SI, and their unit."""

    key: str
    values: OverTime
    unit: str


def inputs_of(model: Model, key: str = "") -> Iterator[InputOverTime]:
    """The inputs over time of a case, or of a part of it under a key."""
    for name, field in type(model).model_fields.items():
        child, here = getattr(model, name), f"{key}.{field.alias or name}".lstrip(".")
        match child:
            case OverTime():
                if (unit := unit_of(field)) is not None:
                    yield InputOverTime(here, child, unit)
            case Model():
                yield from inputs_of(child, here)
            case (Model(), *_):
                for number, part in enumerate(child):
                    yield from inputs_of(part, here if len(child) == 1 else f"{here}.{number}")


def with_input_files(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with the numbers of each `{ file = ... }` of an input in its place, and the faults.

    folder: that a relative path counts from.
    """
    breaches = list[Breach]()
    for path, wanted in _places(data):

        def numbers(name: str, kept: dict[str, Any], wanted: TableKind = wanted) -> dict[str, Any]:
            if kept:
                raise Refused("is given with other keys.", "Keep the file alone.")
            return {"source": name, **read_table(folder / name, wanted)}

        data, faults = with_file(data, path, numbers)
        breaches += faults
    return data, breaches


def _places(data: Mapping[str, Any]) -> Iterator[tuple[Key, TableKind]]:
    """The paths of all keys that can be inputs over time, with what their files hold."""
    bearings = tables(data, "bearing")
    yield ("axial", "load"), LOAD
    for path, holder in ((("thermal",), table(data, "thermal")), *bearings):
        yield (*path, "supply_temperature"), TEMPERATURE_TABLE
        for wall in WALLS:
            yield (*path, wall), TEMPERATURE_TABLE
            if "temperature" in table(holder, wall):
                yield (*path, wall, "temperature"), TEMPERATURE_TABLE
    for path, _ in bearings:
        for within in ((), *((film,) for film in IN_A_BEARING)):
            yield (*path, *within, "supply", "pressure"), PRESSURE_TABLE


MEASURED = TableKind("Hz", ("speed", "n", "rotor_speed"), ())
GIVEN_TIMES, SPEEDS = "times", "speeds"
RAMP = {"from": SPEED, "to": SPEED, "duration": "s"}  # keys that follow
REMEDY = 'Write e.g. [["0 s", "0 Hz"], ["1 s", "900 Hz"]].'


def with_speed_points(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with times and speeds instead of speed.points and speed.file, and the faults.

    folder: that a relative path counts from.
    """
    speed = table(data, "speed")
    if not {"points", "file", GIVEN_TIMES, SPEEDS} & speed.keys():
        return data, []
    given = [key for key in ("points", "file", GIVEN_TIMES) if key in speed]
    if len(given) > 1:
        return data, [Breach(("speed", given[0]), f"is given with {given[1]}.", "Keep one of them.")]
    try:
        written = _written(speed, folder)
        times, speeds = (_column(each, unit) for each, unit in zip(written, ("s", SPEED), strict=True))
        _check(times, speeds)
    except Refused as fault:
        return data, [Breach(("speed", *given), *fault.args)]
    follows = {"from": speeds[0], "to": max(speeds, key=abs), "duration": times[-1]}
    clashes = [_differs(key, speed[key], value) for key, value in follows.items() if key in speed]
    kept = {key: value for key, value in speed.items() if key not in ("points", "file", "tacho", "pulses")}
    ramp = {key: f"{value!r} {RAMP[key]}" for key, value in follows.items() if key not in kept}
    columns = dict(zip((GIVEN_TIMES, SPEEDS), written, strict=True))
    return data | {"speed": {**kept, **ramp, **columns}}, [breach for breach in clashes if breach]


def _differs(key: str, given: object, follows: float) -> Breach | None:
    try:
        if quantity(given, RAMP[key]) == follows:
            return None
    except ValueFault:
        pass
    problem = "is given with points or a file, which it follows from."
    return Breach(("speed", key), problem, "Leave it out, or set the whole table: speed = { from, to, duration }.")


def _written(speed: dict[str, Any], folder: Path) -> tuple[Any, Any]:
    """Times and speeds as they were written, perhaps with units; of a file as numbers in s and Hz."""
    if isinstance(speed.get("file"), str):
        tacho = speed.get("tacho")
        path = folder / str(speed["file"])
        columns = read_tacho(path, str(tacho), speed.get("pulses", 1)) if tacho else read_table(path, MEASURED)
        return columns["time"], columns["x"]
    if GIVEN_TIMES in speed or SPEEDS in speed:
        return speed.get(GIVEN_TIMES), speed.get(SPEEDS)
    points = pairs(speed.get("points"))
    if points is None:
        raise Refused("is no list of times with speeds, nor the name of a file.", REMEDY)
    return points


def _column(given: object, unit: str) -> list[float]:
    if not isinstance(given, list):
        raise Refused("needs as many times as speeds.", REMEDY)
    try:
        return [quantity(each, unit) for each in given]
    except ValueFault as fault:
        raise Refused(f"has a value that {fault.problem}", REMEDY) from None


def _check(times: Sequence[float], speeds: Sequence[float]) -> None:
    if len(times) != len(speeds) or not 2 <= len(times) <= MOST_NUMBERS // 2:
        raise Refused(f"has {len(times)} times and {len(speeds)} speeds.", f"Give 2 to {MOST_NUMBERS // 2} of both.")
    if times[0] != 0.0:
        raise Refused(f"begins at {times[0]:.9g} s, and a run at 0 s.", "Let the times count from the first.")
    falling = next((row for row in range(1, len(times)) if not times[row] > times[row - 1]), 0)
    if falling:
        raise Refused(f"has the time {times[falling]:.9g} s in row {falling + 1}, not later than the row before.",
                    "Order the rows by rising times.")  # fmt: skip
    below = next((row for row, speed in enumerate(speeds) if speed < 0.0), -1)
    if below >= 0:
        raise Refused(f"has the speed {speeds[below]:.6g} Hz in row {below + 1}.", "Give speeds of 0 and above.")
    if max(speeds) == 0.0:
        raise Refused("has no speed above 0.", REMEDY)
