"""The signals of a run: columns of numbers, in memory or in the run's file, read whole or in pieces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from frbcli.arrays import Array
from frbcli.results.files.stored import Stored

PIECE = 262_144  # samples of a signal that are held at a time


@dataclass(frozen=True, eq=False)
class Signal:
    """One column of a run and its unit as people write it, "" for a ratio.

    source: the values (n,), or where they lie in a file: they are then read whenever they are asked for, and
    RunFileError is raised if the file has changed. A slice gives the values (m,) of some samples.
    """

    source: Array | Stored
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
