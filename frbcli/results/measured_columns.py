"""Columns of numbers from a file of a measuring instrument, by their names."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from frbcli.arrays import Array, Truths
from frbcli.errors import FEW, InputError, did_you_mean, input_error, nearest, printable
from frbcli.results.delimited import UNITS, without_unit
from frbcli.results.records import LARGEST

LARGEST_FILE = 1024**3  # bytes
FAR = 10.0  # times all other numbers of a column


# Units at the end of a name, such as time_ms, speed_rpm, journal_x_m; one letter counts behind an underscore alone
_RATES = "rad/s|rad_s|radps|1/min|min-1|rev/min|U/min"
_LONG = f"ms|us|µs|sec|Hz|hz|kHz|rpm|RPM|krpm|mm|um|µm|nm|cm|mil|mils|micron|microns|{_RATES}"


SUFFIX = re.compile(rf".+?(?:_(?:in_)?({_LONG}|s|m)|\s({_LONG}))")
OF_TIMES = re.compile(r"(?:time|timestamp|zeit|temps|t)_(ns|min|h|days?|d)", re.IGNORECASE)  # else ends of other words
WRITTEN_OUT = re.compile(r"(.+?)(\s+in\s+|\s*/\s*)(\S+)")  # n in 1/min, t/s; brackets are read with the head
OVER_TIME = {*UNITS, "rev", "r", "u", "l", "kg", "j"}  # what has a rate: rev/s is a unit, and no rev in seconds


TIME_NAME = re.compile(r"(?:time|timestamp|zeit|temps|t)(?:_?(?:s|sec|ms|us|µs|ns|min|h|days?|d))?", re.IGNORECASE)
TIME_UNITS = ("s", "sec", "second", "seconds", "ms", "us", "µs")
ITSELF = re.compile(r"rpm|RPM|Hz|U/min|1/min|min-1|r/min|rev/min|cpm|krpm|[Ss]econds?")  # names that are a unit


INTERVAL = re.compile(r"(?:dt|ts|t_?s|.*(?:increment|interval|delta[_ ]?[tx]|step|period).*)", re.IGNORECASE)


@dataclass(frozen=True)
class Columns:
    """Columns (n,) of a file by their names.

    rate: samples per second where the file states it, as WAV does; numbers: single numbers besides the columns, such as
    a sampling rate; units: of columns that have one in the file; lines: of a text, the number of the line of each row;
    doubtful: what is wrong with columns that cannot be used; shapes: of variables as they are in the file, where that
    has shapes; own_times: times in s (m,) of columns (m,) that were sampled at others than the rest.
    """

    path: Path
    values: Mapping[str, Array]
    rate: float | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    lines: tuple[int, ...] | None = None
    doubtful: Mapping[str, str] = field(default_factory=dict)
    numbers: Mapping[str, float] = field(default_factory=dict)
    shapes: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    own_times: Mapping[str, Array] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Array:
        """A column. Raises InputError if there is none of this name, or its values are not finite."""
        column = self.values[self.named(name)]
        with np.errstate(invalid="ignore"):
            good = (np.abs(column) <= LARGEST) & ~_are_gaps(column)  # NaN is not
        if not np.any(np.isfinite(column)):
            remedy = "Name a column of numbers; times may be stamps such as 2023-05-04 09:51:39.5."
            raise wrong_file(self.path, f'has no numbers in the column "{name}".', remedy)
        if not np.all(good):
            first = int(np.argmin(good))
            what = f"the number {column[first]:g}" if np.isfinite(column[first]) else "no number"
            raise wrong_file(
                self.path, f'has {what} in {self.row(first)} of the column "{name}".', "Leave such rows out."
            )
        return column

    def named(self, name: str) -> str:
        """The name of a column in the file; `name` may leave out the unit at its end. Raises InputError if there is no
        such column, or it cannot be used."""
        if name in self.values:
            return name
        for known in (name, name.rpartition(".")[0]):  # columns of a matrix are called after it
            if known in self.doubtful:
                parts = [f'"{part}"' for part in self.values if part.rpartition(".")[0] == known]
                remedy = f"Write {' or '.join(parts[:FEW])}." if parts else "Name a column of real numbers."
                raise wrong_file(self.path, f'"{known}" {self.doubtful[known]}.', remedy)
        alike = [known for known in self.values if without_unit(known) == name]
        if len(alike) == 1:
            return alike[0]
        if name in self.numbers:
            problem = f'"{name}" is the single number {self.numbers[name]:g}, not a column.'
            raise wrong_file(self.path, problem, self._known())
        meant = did_you_mean(name, self.values) + " " if nearest(name, self.values) else ""
        raise wrong_file(self.path, f'has no column "{name}".', meant + self._known())

    @property
    def time_name(self) -> str | None:
        """The only column whose name, or unit, says that it holds times, None if there is none or several."""
        words = {name: name.removesuffix(f"/{unit_in(name)}") for name in self.values}
        names = [name for name, word in words.items() if TIME_NAME.fullmatch(without_unit(word).strip())]
        names = names or [name for name in self.values if (self._unit(name) or "").lower() in TIME_UNITS]
        return names[0] if len(names) == 1 else None

    def holds_times(self, name: str) -> bool:
        """Whether the name of a column, or its unit, says that it holds times."""
        word = without_unit(name.removesuffix(f"/{unit_in(name)}")).strip().rstrip("0123456789_. ")
        return TIME_NAME.fullmatch(word) is not None or (self._unit(name) or "").lower() in TIME_UNITS

    def unit(self, name: str) -> str | None:
        """The unit of a column, None where the file does not state it."""
        return self._unit(self.named(name))

    def _unit(self, name: str) -> str | None:
        return self.units.get(name) or unit_in(name)

    def row(self, place: int) -> str:
        """The name of a row, counted from 0 here and from 1 in the name."""
        return f"row {place + 1}" + (f" (line {self.lines[place]})" if self.lines else "")

    def listed(self) -> list[dict[str, Any]]:
        """The content of the file, in its order: name, shape in the file, unit, and its kind where it is no column."""
        rows: list[dict[str, Any]] = []
        for name, values in self.values.items():
            shape = self.shapes.get(name) or self.shapes.get(name.rpartition(".")[0]) or (len(values),)
            rows.append({"name": name, "shape": list(shape), "unit": self._unit(name), "kind": "column"})
        for name, value in self.numbers.items():
            rows.append({"name": name, "shape": [1, 1], "unit": None, "kind": f"number {value:.10g}"})
        for name, reason in self.doubtful.items():
            shape = self.shapes.get(name, ())
            rows.append({"name": name, "shape": list(shape), "unit": None, "kind": f"not usable: {reason}"})
        return rows

    def _known(self) -> str:
        names = [f'"{printable(name)}"' for name in self.values]
        if len(names) <= FEW:
            return f"It has: {', '.join(names)}."
        return f"It has {len(names)} columns: `frb waterfall {self.path.name} --columns` lists them."


def _are_gaps(column: Array) -> Truths:
    """Whether numbers stand for missing ones: digits of 9 alone, such as -9999, far beyond all others."""
    nines = [sign * (10.0**digits - 1.0) for digits in range(3, 8) for sign in (1.0, -1.0)]
    marks = np.isin(column, nines)
    if marks.any():
        others = np.abs(column[~marks & np.isfinite(column)])
        marks &= np.abs(column) > FAR * np.max(others, initial=0.0)
    return marks


def unit_in(name: str) -> str | None:
    """The unit that a name ends with or is, None if there is none."""
    plain = without_unit(name).strip()
    of_struct = plain.rpartition(".")[2]
    if ITSELF.fullmatch(of_struct):
        return of_struct
    if match := OF_TIMES.fullmatch(of_struct) or SUFFIX.fullmatch(plain):
        return str(next(filter(None, match.groups())))
    written = WRITTEN_OUT.fullmatch(plain)
    if written is None or written[3].lower() not in UNITS or plain.lower() in UNITS:
        return None
    is_rate = written[2].strip() == "/" and written[1].split()[-1].lower() in OVER_TIME
    return None if is_rate else written[3]


def is_interval(name: str) -> bool:
    """Whether the name of a number says that it is the time from sample to sample."""
    return INTERVAL.fullmatch(name.strip()) is not None


def wrong_file(path: Path, problem: str, remedy: str) -> InputError:
    """The error of the file of a measurement."""
    return input_error(f"measurement {path}", "file", "", problem, remedy)
