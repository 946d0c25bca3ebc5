"""The content of a run file: the forms of its texts and records, and its signals with their names, units and values;
and arrays that stay in its file until they are asked for: a long run needs no more memory than a short one.

Whatever reads a run relies on this: what is printed is printable, what is computed with is finite and no larger than
any machine needs, and there is never more of it than a picture or a table can show.

An array lies in its file in one piece. The file is opened for each reading and closed again: a run holds nothing open,
and another run may take the place of its file.

Signals that grow during a run. Samples are collected in memory, and moved to a temporary file once they are many, so
that a long run needs no more memory than a short one.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any, BinaryIO
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.columns import Column
from frbcli.results.columns import MACHINE_SIGNALS, PART_SIGNALS
from frbcli.results.container import refuse
from frbcli.units import is_number

IN_MEMORY = 64 * 1024**2  # bytes of all signals of a run that stay in memory


class GrowingSignal:
    """The values (n,) of a signal so far; a slice without step gives some of them."""

    def __init__(self, values: Array | None = None) -> None:
        self._file: IO[bytes] | None = None
        self._moved = 0  # values in the file
        self._fresh: list[Array] = [] if values is None else [values]

    def __len__(self) -> int:
        return self._moved + sum(map(len, self._fresh))

    @property
    def bytes(self) -> int:
        """How many of them are in memory."""
        return sum(values.nbytes for values in self._fresh)

    def append(self, values: Array) -> None:
        """Add values (m,)."""
        self._fresh.append(values)

    def move(self, folder: Path) -> None:
        """Move what is in memory to a file in a folder, which goes with this object or with the process. If there is no
        room for it, it stays in memory."""
        with suppress(OSError):
            if self._file is None:
                self._file = TemporaryFile(dir=folder, prefix="frb-")  # noqa: SIM115
                finalize(self, self._file.close)
            self._file.seek(self._moved * np.dtype(np.float64).itemsize)
            whole = self._joined()
            self._file.write(whole.data)
            self._file.flush()
            self._moved, self._fresh = self._moved + len(whole), []

    def __getitem__(self, part: slice) -> Array:
        first, last, _ = part.indices(len(self))
        if first >= self._moved:
            return self._joined()[first - self._moved : max(first, last) - self._moved]
        values = np.empty(max(last - first, 0))
        count = min(last, self._moved) - first
        assert self._file is not None
        self._file.seek(first * values.itemsize)
        there = values[:count].view(np.uint8).data
        if self._file.readinto(there) != len(there):  # type: ignore[attr-defined]
            raise OSError("the temporary file of a signal was cut short")
        values[count:] = self._joined()[: len(values) - count]
        return values

    def __reduce__(self) -> tuple[type[GrowingSignal], tuple[Array]]:
        return GrowingSignal, (self[:],)  # for another process, which does not have the file

    def until(self, count: int) -> GrownSignal:
        """The first `count` values as they are now."""
        return GrownSignal(self, count)

    def _joined(self) -> Array:
        if len(self._fresh) != 1:
            self._fresh = [np.concatenate([np.empty(0), *self._fresh])]
        return self._fresh[0]


class GrownSignal:
    """The first values (n,) of a signal that may grow on."""

    def __init__(self, signal: GrowingSignal, count: int) -> None:
        self._signal, self._count = signal, count

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, part: slice) -> Array:
        first, last, _ = part.indices(self._count)
        return self._signal[first : max(first, last)]


def keep_small(signals: Iterable[GrowingSignal], folder: Path) -> None:
    """Move signals to files in a folder if they take too much memory."""
    known = list(signals)
    if sum(signal.bytes for signal in known) > IN_MEMORY:
        for signal in known:
            signal.move(folder)


SIZE = 0  # its position in a stamp
COMMANDS = ("runup", "rundown")
STATUSES = ("finished", "standstill", "contact", "starved", "overheated", "not-converged", "interrupted")
WHOLE = STATUSES[:2]  # of a run that nothing has cut short
TIME, SPEED = "time_s", "speed_Hz"
LONGEST_LABEL = 200  # characters
MOST_ENTRIES = 500  # of a table
MOST_EVENTS = 10_000
MOST_SAMPLES = 25_000_000  # a case may ask for 20 million
LARGEST, SMALLEST = 1e15, 1e-15  # in SI: beyond what any machine has, as in a case file
FASTEST_Hz = 1e7
LONGEST_COUNT = 64  # bits
UNEVEN = 1e-3  # share of a time step by which a sample may be off: round-off is less

EVENT_NUMBERS = ("t_s", "speed_Hz")  # every event has them
EVENT_OPTIONAL = ("frequency_Hz", "frequency_ratio")  # or None
EVENT_KEYS = ("kind", "film", *EVENT_NUMBERS, *EVENT_OPTIONAL)
# Records of every run that has ended, and those that come together.
COST_OF_ALL = ("cpu_s", "steps", "rejected_steps", "steps_per_revolution", "film_solves", "ms_per_film_solve",
               "simulated_ms_per_hour")  # fmt: skip
ERROR_OF_ALL = ("time_integration",)
TOGETHER = {"oil_in_m3": "oil_out_m3", "heat_dissipated_J": "heat_carried_J", "wear_depth_m": "wear_angle_deg",
            "eccentricity": "quiet_until_s"}

_NAME = "(_[A-Za-z0-9_-]{1,60})?"  # of a film, a bearing or a wheel, behind the quantity


@dataclass(frozen=True)
class RunPlace:
    """A file as it was when it was checked. path: absolute; stamp: its identity, against a later file there."""

    path: Path
    stamp: tuple[int, ...]

    @classmethod
    def of(cls, path: Path, file: BinaryIO) -> RunPlace:
        """The place of an open file at a path."""
        return cls(path.absolute(), _stamp(file))

    @property
    def size(self) -> int:
        """Size of the file in bytes."""
        return self.stamp[SIZE]

    def read(self, offset: int, array: NDArray[Any]) -> None:
        """Fill an array with what lies at an offset. Raises RunFileError if the file is gone or another one."""
        try:
            with self.path.open("rb", buffering=0) as file:
                file.seek(offset)
                rest = array.reshape(-1).view(np.uint8).data
                while _stamp(file) == self.stamp and len(rest) and (count := file.readinto(rest)):
                    rest = rest[count:]
        except OSError as error:
            raise refuse(self.path, f"cannot be read any more: {error}.", "Read the run again.") from error
        if len(rest):
            raise refuse(self.path, "was changed after it was opened.", "Read the run again.")


@dataclass(frozen=True)
class Stored:
    """An array in a file: where it begins there, its type and shape."""

    place: RunPlace
    offset: int
    dtype: np.dtype[Any]
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, part: slice) -> NDArray[Any]:
        """The rows of a slice without step; of an array (n,) the values (m,)."""
        first, last, _ = part.indices(len(self))
        array = np.empty((max(last - first, 0), *self.shape[1:]), dtype=self.dtype)
        self.place.read(self.offset + first * self.dtype.itemsize * math.prod(self.shape[1:]), array)
        return array

    @property
    def bytes(self) -> int:
        """How many it takes."""
        return math.prod(self.shape) * self.dtype.itemsize

    def whole(self) -> NDArray[Any]:
        """All of it; an array of no dimension, too."""
        array = np.empty(self.shape, dtype=self.dtype)
        self.place.read(self.offset, array)
        return array


class StoredArrays(Mapping[str, NDArray[Any]]):
    """Arrays by their names, each read when it is asked for."""

    def __init__(self, arrays: Mapping[str, Stored]) -> None:
        self._arrays = dict(arrays)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays[name].whole()

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)


def _stamp(file: Any) -> tuple[int, ...]:
    status = os.fstat(file.fileno())
    return status.st_size, status.st_dev, status.st_ino, status.st_mtime_ns


PIECE = 262_144  # samples of a signal that are held at a time


@dataclass(frozen=True, eq=False)
class Signal:
    """One column of a run and its unit as people write it, "" for a ratio.

    source: the values (n,), or where they lie in a file: they are then read whenever they are asked for, and
    RunFileError is raised if the file has changed. A slice gives the values (m,) of some samples.
    """

    source: Array | Stored | GrownSignal
    unit: str

    @property
    def values(self) -> Array:
        """All values (n,)."""
        return self.source[:]

    def __len__(self) -> int:
        return len(self.source)

    def __getitem__(self, part: slice) -> Array:
        return self.source[part]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """All values, for functions of numpy."""
        return np.asarray(self.values, dtype=dtype)


def pieces(first: int, last: int, size: int = PIECE) -> Iterator[tuple[int, int]]:
    """The samples from `first` to before `last` in spans of at most `size`."""
    return ((start, min(start + size, last)) for start in range(first, last, size))


def _forms(signals: Iterable[Column], part: str) -> dict[re.Pattern[str], str]:
    """The forms of the names of signals with their units; part: the form of the name of a part."""
    names = {s: (s.quantity + part, "[xy]" * len(s.shape), s.unit_name) for s in signals}
    return {re.compile("_".join(filter(None, words))): signal.unit for signal, words in names.items()}


_UNITS = _forms(MACHINE_SIGNALS, "") | _forms(PART_SIGNALS, _NAME)
_KIND = re.compile("[a-z]{1,30}(-[a-z]{1,30}){0,3}")
_KEY = re.compile("[A-Za-z][A-Za-z0-9_-]{0,99}")


def wrong_text(texts: Mapping[str, str]) -> str:
    """The name of the first text with a wrong form, "" if there is none: title and case_name are one printable line,
    command and status are among those that there are."""
    for name in ("title", "case_name"):
        if not _is_label(texts[name]):
            return name
    return "command" if texts["command"] not in COMMANDS else "status" if texts["status"] not in STATUSES else ""


def wrong_record(records: Mapping[str, Any]) -> str:
    """The name of the first record with a wrong form, "" if there is none.

    versions: names -> text; references: names -> numbers, lengths above zero; cost: names -> numbers; error: names ->
    numbers or None; events: a list of tables with the keys of EVENT_KEYS.
    """
    forms: dict[str, Callable[[Any], bool]] = {
        "versions": lambda record: _is_table(record, lambda _, value: _is_label(value)),
        "references": lambda record: _is_table(record, _is_reference),
        "cost": lambda record: _is_table(record, lambda _, value: _is_number(value)) and _is_complete(record),
        "error": lambda record: (
            _is_table(record, lambda _, value: value is None or _is_number(value)) and _is_complete(record)
        ),
        "events": lambda record: (
            isinstance(record, list) and len(record) <= MOST_EVENTS and all(map(_is_event, record))
        ),
    }
    return next((name for name, holds in forms.items() if not holds(records[name])), "")


def untold(cost: Mapping[str, Any], error: Mapping[str, Any]) -> str:
    """The missing record of cost or error of a run that has ended, "" if it has all."""
    numbers = [(cost, name) for name in COST_OF_ALL] + [(error, name) for name in ERROR_OF_ALL]
    return next((name for record, name in numbers if not _is_number(record.get(name))), "")


def wrong_unit(units: Mapping[str, str]) -> str:
    """The name of the first signal that no run has, or that has another unit; "" if there is none."""
    for name in (TIME, SPEED):
        if name not in units:
            return name
    return next((name for name, unit in units.items() if unit not in _units(name)), "")


def wrong_values(signals: Mapping[str, Signal]) -> str:
    """The name of the first signal with values that no run has, "" if there is none: a value that is not finite or
    beyond all bounds, times that do not rise evenly. Reads all signals, a piece at a time."""
    count = len(signals[TIME])
    for name, signal in signals.items():
        most = FASTEST_Hz if name.endswith("_Hz") else LARGEST
        for first, last in pieces(0, count):
            values = signal[first:last]
            if not (-most <= values.min() and values.max() <= most):  # NaN is neither
                return name
    return "" if _is_even(signals[TIME]) else TIME


def wrong_event(events: list[dict[str, Any]], time: Signal) -> bool:
    """Whether an event lies outside of the samples of a run. One may lie between the last sample and the next one,
    which is as far off as the samples are even."""
    if not len(time):
        return bool(events)
    begin, end = float(time[:1][0]), float(time[-1:][0])
    reach = end + (1.0 + UNEVEN) * _step(time)
    return any(not begin <= event["t_s"] <= reach for event in events)


def _units(name: str) -> list[str]:
    return [unit for form, unit in _UNITS.items() if form.fullmatch(name)]


def _step(time: Signal) -> float:
    return float(time[-1:][0] - time[:1][0]) / max(len(time) - 1, 1)


def _is_even(time: Signal) -> bool:
    if len(time) < 2:
        return True
    begin, step = float(time[:1][0]), _step(time)
    rounding = 8.0 * math.ulp(max(abs(begin), abs(begin + step * len(time))))
    for first, last in pieces(0, len(time)):
        even = begin + step * np.arange(first, last)
        if np.abs(time[first:last] - even).max() > UNEVEN * step + rounding:
            return False
    return step > rounding and step >= SMALLEST


def _is_table(record: Any, holds: Callable[[str, Any], bool]) -> bool:
    if not isinstance(record, dict) or len(record) > MOST_ENTRIES:
        return False
    return all(_KEY.fullmatch(name) and holds(name, value) for name, value in record.items())


def _is_complete(record: dict[str, Any]) -> bool:
    return all(record.get(name) is None or record.get(other) is not None for name, other in TOGETHER.items())


def _is_reference(name: str, value: Any) -> bool:
    return _is_finite(value) and (not name.startswith(("clearance_m", "length_m")) or value >= SMALLEST)


def _is_event(record: Any) -> bool:
    return (
        _is_table(record, lambda _, value: value in (None, True, False) or _is_number(value) or _is_label(value))
        and all(name in record for name in EVENT_KEYS)
        and _is_label(record["kind"])
        and _KIND.fullmatch(record["kind"]) is not None
        and all(_is_finite(record[name]) for name in EVENT_NUMBERS)
        and all(record[name] is None or _is_finite(record[name]) for name in EVENT_OPTIONAL)
        and (record["film"] is None or _is_label(record["film"]))
    )


def _is_label(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST_LABEL and value.isprintable()


def _is_number(value: Any) -> bool:
    """Whether a cost or an error can have this value. NaN and infinities are unknown; counts fit a processor."""
    return is_number(value) and (isinstance(value, float) or value.bit_length() < LONGEST_COUNT)


def _is_finite(value: Any) -> bool:
    return _is_number(value) and abs(value) <= LARGEST
