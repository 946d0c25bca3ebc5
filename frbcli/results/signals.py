"""Signals of a run, and arrays that stay in its file until they are asked for: a long run needs no more memory than a
short one.

An array lies in its file in one piece. The file is opened for each reading and closed again: a run holds nothing open,
and another run may take the place of its file.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.results.files.container import refuse
from frbcli.results.growing import GrownSignal

SIZE = 0  # its position in a stamp


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


def pieces(first: int, last: int, size: int = PIECE) -> Iterator[tuple[int, int]]:
    """The samples from `first` to before `last` in spans of at most `size`."""
    return ((start, min(start + size, last)) for start in range(first, last, size))
