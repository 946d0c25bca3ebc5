"""Columns of numbers from files of measuring instruments: CSV, WAV, MAT. Knows no physics."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from frbcli.errors import Fault, InputError, printable
from frbcli.results.delimited import MOST_COLUMNS, DelimitedTable, read_table
from frbcli.results.records import LARGEST, MOST_SAMPLES

Values = NDArray[np.float64]

SUFFIXES = (".csv", ".txt", ".wav", ".mat")
LARGEST_FILE = 1024**3  # bytes
MOST_NAMED = 20  # columns in an error
TOLD = (ValueError, OSError, NotImplementedError, Warning)  # whose words a reader of the file is meant to read
NO_TABLE = "Write CSV with one line of names, and numbers below."


@dataclass(frozen=True)
class Columns:
    """Columns (n,) of a file by their names. rate: samples per second where the file tells it, as WAV does; units: of
    columns that have one in the file; lines: of a text, the number of the line of each row; doubtful: what is wrong
    with columns that cannot be used."""

    path: Path
    values: Mapping[str, Values]
    rate: float | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    lines: tuple[int, ...] | None = None
    doubtful: Mapping[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Values:
        """A column. Raises InputError if there is none of this name, or its values are not finite."""
        for known in (name, name.rpartition(".")[0]):  # columns of a matrix are called after it
            if known in self.doubtful:
                raise wrong_file(self.path, f'"{known}" {self.doubtful[known]}.', "Name a column of real numbers.")
        if name not in self.values:
            raise wrong_file(self.path, f'has no column "{name}".', f"It has: {self._names()}.")
        column = self.values[name]
        with np.errstate(invalid="ignore"):
            good = np.abs(column) <= LARGEST  # NaN is not
        if not np.all(good):
            first = int(np.argmin(good))
            what = f"the number {column[first]:g}" if np.isfinite(column[first]) else "no number"
            raise wrong_file(
                self.path, f'has {what} in {self.row(first)} of the column "{name}".', "Leave such rows out."
            )
        return column

    def row(self, place: int) -> str:
        """The name of a row, counted from 0 here and from 1 in the name."""
        return f"row {place + 1}" + (f" (line {self.lines[place]})" if self.lines else "")

    def _names(self) -> str:
        names = [printable(name) for name in self.values]
        return ", ".join(names[:MOST_NAMED]) + (
            f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        )


def read_columns(path: Path) -> Columns:
    """The columns of a file.

    CSV (or txt): a line of names, perhaps one of units, then numbers, separated by comma, semicolon, tab or blanks;
    lines above the names, and those that begin with #, are left out; with a semicolon, tab or blanks, numbers may have
    a decimal comma. WAV: the channels, named 1, 2 and so on, from -1 to 1 where they are whole numbers. MAT: the
    variables that are vectors, and the columns of those that are matrices as NAME.1, NAME.2. Raises InputError for what
    is none of these.
    """
    if not path.is_file():
        problem = "is no file." if path.exists() else "does not exist."
        raise wrong_file(path, problem, "Give the file of a measurement.")
    readers = {".csv": _csv, ".txt": _csv, ".wav": _wav, ".mat": _mat}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise wrong_file(path, "is of no known kind.", f"Known are {', '.join(SUFFIXES)}.")
    if path.stat().st_size > LARGEST_FILE:
        raise wrong_file(path, f"has more than {LARGEST_FILE // 1024**2} MB.", "Cut it into several files.")
    try:
        found = reader(path)
    except Exception as error:  # of three libraries, which raise errors of their own
        reason = " ".join(str(error).split()) if isinstance(error, TOLD) else "it is damaged"
        problem = f"cannot be read: {printable(reason)[:200].rstrip('.')}."
        raise wrong_file(path, problem, "Write it as CSV with one line of names.") from None
    counts = [len(values) for values in found.values.values()]
    if not found.doubtful and (not counts or min(counts) < 2):
        raise wrong_file(path, "holds no columns of numbers.", NO_TABLE)
    if max(counts, default=0) > MOST_SAMPLES:
        raise wrong_file(path, f"has more than {MOST_SAMPLES} samples.", "Cut it into several files.")
    return found


def wrong_file(path: Path, problem: str, remedy: str) -> InputError:
    """The error of the file of a measurement."""
    return InputError(f"measurement {path}", (Fault("file", "", None, problem, remedy),))


def _csv(path: Path) -> Columns:
    table = read_table(path.read_bytes())
    units = {name: unit for name, unit in zip(table.names, table.units, strict=True) if unit}
    named = Counter(table.names)
    doubtful = {name: f"is the name of {count} columns" for name, count in named.items() if count > 1}
    values = {name: _numbers(table, place) for place, name in enumerate(table.names) if name and named[name] == 1}
    return Columns(path, values, None, units, table.lines, doubtful)


def _numbers(table: DelimitedTable, place: int) -> Values:
    """A column, NaN where it holds no number."""
    import pandas as pd

    column = table.values[place]
    if column.dtype == bool:
        return np.full(len(column), np.nan)
    return np.asarray(pd.to_numeric(column, errors="coerce").to_numpy(dtype=np.float64))


def _wav(path: Path) -> Columns:
    """Channels from -1 to 1. Whole numbers of 8 bits have no sign: 128 is zero. Those of 24 bits come as ones of 32."""
    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("error", wavfile.WavFileWarning)  # a file that ends too early
        warnings.filterwarnings("ignore", "Chunk .*not understood", wavfile.WavFileWarning)  # notes beside the samples
        rate, samples = wavfile.read(path)
    if not samples.size:
        raise ValueError("it has no samples")
    if rate <= 0:
        raise ValueError("it has no samples per second")
    channels = np.asarray(samples, dtype=np.float64).reshape(len(samples), -1).T
    if len(channels) > MOST_COLUMNS:
        raise ValueError(f"it has {len(channels)} channels, more than {MOST_COLUMNS}")
    if np.issubdtype(samples.dtype, np.integer):
        whole = np.iinfo(samples.dtype)
        middle = 0.5 * (whole.min + whole.max + 1)
        channels = (channels - middle) / (whole.max + 1 - middle)
    return Columns(path, {str(number): channel for number, channel in enumerate(channels, start=1)}, float(rate))


def _mat(path: Path) -> Columns:
    from scipy.io import loadmat

    columns: dict[str, Values] = {}
    doubtful: dict[str, str] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of a variable that stands there twice
        variables = loadmat(path)
    for name, value in variables.items():
        if name.startswith("__") or not isinstance(value, np.ndarray) or not _is_number(value) or value.size < 2:
            continue  # scalars are settings
        if np.iscomplexobj(value):
            doubtful[name] = "holds complex numbers"
        elif value.ndim > 2:
            doubtful[name] = f"has {value.ndim} dimensions"
        elif 1 in value.shape:
            columns[name] = np.asarray(value, dtype=np.float64).ravel()
        elif value.shape[1] > min(value.shape[0], MOST_COLUMNS):
            doubtful[name] = f"has {value.shape[1]} columns of {value.shape[0]} rows: transpose it"
        else:
            matrix = np.asarray(value, dtype=np.float64)
            columns |= {f"{name}.{number}": column for number, column in enumerate(matrix.T, start=1)}
    return Columns(path, columns, doubtful=doubtful)


def _is_number(value: NDArray[np.generic]) -> bool:
    return np.issubdtype(value.dtype, np.number) or value.dtype == bool
