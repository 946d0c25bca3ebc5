"""Signals that grow during a run. Samples are collected in memory, and moved to a temporary file once they are many, so
that a long run needs no more memory than a short one."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO
from weakref import finalize

import numpy as np

from frbcli.arrays import Array

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
