"""Columns of numbers from files of measuring instruments: CSV, WAV, MAT. Knows no physics."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from frbcli.errors import Fault, InputError

Values = NDArray[np.float64]

SUFFIXES = (".csv", ".txt", ".wav", ".mat")
COMMENT = "#"


@dataclass(frozen=True)
class Columns:
    """Columns (n,) of a file by their names; rate: samples per second where the file tells it, as WAV does."""

    path: Path
    values: dict[str, Values]
    rate: float | None = None

    def __getitem__(self, name: str) -> Values:
        """A column. Raises InputError if there is none of this name, or its values are not finite."""
        if name not in self.values:
            raise wrong_file(self.path, f'has no column "{name}".', f"It has: {', '.join(self.values)}.")
        column = self.values[name]
        if not np.all(np.isfinite(column)):
            first = int(np.argmin(np.isfinite(column)))
            problem = f'has no number in row {first + 1} of the column "{name}".'
            raise wrong_file(self.path, problem, "Leave such rows out.")
        return column


def read_columns(path: Path) -> Columns:
    """The columns of a file.

    CSV (or txt): one line of names, then numbers, separated by comma, semicolon or tab; lines that begin with # are
    left out. WAV: the channels, named 1, 2 and so on, from -1 to 1 where they are whole numbers. MAT: the variables
    that are vectors, and the columns of those that are matrices as NAME.1, NAME.2. Raises InputError for what is none
    of these.
    """
    if not path.is_file():
        raise wrong_file(path, "does not exist.", "Give the file of a measurement.")
    readers = {".csv": _csv, ".txt": _csv, ".wav": _wav, ".mat": _mat}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise wrong_file(path, "is of no known kind.", f"Known are {', '.join(SUFFIXES)}.")
    try:
        found = reader(path)
    except Exception as error:  # of three libraries, which raise errors of their own
        problem = f"cannot be read: {' '.join(str(error).split())[:200]}."
        raise wrong_file(path, problem, "Write it as CSV with one line of names.") from None
    if not found.values or min(map(len, found.values.values())) < 2:
        raise wrong_file(path, "holds no columns of numbers.", "Write CSV with one line of names, and numbers below.")
    return found


def wrong_file(path: Path, problem: str, remedy: str) -> InputError:
    """The error of the file of a measurement."""
    return InputError(f"measurement {path}", (Fault("file", "", None, problem, remedy),))


def _csv(path: Path) -> Columns:
    import pandas as pd

    table = pd.read_csv(path, sep=None, engine="python", comment=COMMENT, skipinitialspace=True)
    numbers = table.apply(pd.to_numeric, errors="coerce")
    return Columns(path, {str(name).strip(): numbers[name].to_numpy(dtype=np.float64) for name in numbers.columns})


def _wav(path: Path) -> Columns:
    from scipy.io import wavfile

    rate, samples = wavfile.read(path)
    scale = float(np.iinfo(samples.dtype).max) if np.issubdtype(samples.dtype, np.integer) else 1.0
    channels = np.asarray(samples, dtype=np.float64).reshape(len(samples), -1).T / scale
    return Columns(path, {str(number): channel for number, channel in enumerate(channels, start=1)}, float(rate))


def _mat(path: Path) -> Columns:
    from scipy.io import loadmat

    columns: dict[str, Values] = {}
    for name, value in loadmat(path).items():
        if name.startswith("__") or not isinstance(value, np.ndarray) or not np.issubdtype(value.dtype, np.number):
            continue
        matrix = np.atleast_2d(np.asarray(value, dtype=np.float64))
        if matrix.ndim == 2 and 1 in matrix.shape:
            columns[name] = matrix.ravel()
        elif matrix.ndim == 2:
            columns |= {f"{name}.{number}": column for number, column in enumerate(matrix.T, start=1)}
    return Columns(path, columns)
