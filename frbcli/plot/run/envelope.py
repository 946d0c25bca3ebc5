"""The envelope of a signal with many samples: the lowest and the highest value of each short span.

A run is read a piece at a time, so that a long run needs no more memory than a short one.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from frbcli.arrays import Array
from frbcli.results.records import TIME, pieces
from frbcli.results.store import Run

DRAWN_POINTS = 4000  # more than a picture has columns of pixels
SHORTEST = 4  # samples of a span; with fewer, all are drawn


class EnvelopeColumn(Protocol):
    """Values (n,) of which slices (m,) can be had: a signal, or what is computed of several."""

    def __getitem__(self, part: slice, /) -> Array: ...


class Envelope:
    """Fewer points that draw the same line: the lowest and the highest of each span at their places, and the last.

    count: of the points that will come, in their order.
    """

    def __init__(self, count: int) -> None:
        stretch = count // (DRAWN_POINTS // 2)
        self._stretch = stretch if stretch >= SHORTEST else 1
        self._kept: list[Array] = []
        self._rest = np.empty((2, 0))

    def add(self, place: Array, values: Array) -> None:
        """Take the next points: values (m,) at places (m,)."""
        points = np.concatenate([self._rest, np.stack([place, values])], axis=1)
        whole = max(points.shape[1] - 1, 0) // self._stretch * self._stretch  # the last point is for `points` to keep
        rows = points[1, :whole].reshape(-1, self._stretch)
        first = np.arange(0, whole, self._stretch)
        kept = np.unique(np.concatenate([first + rows.argmin(axis=1), first + rows.argmax(axis=1)]))
        self._kept.append(points[:, kept])
        self._rest = points[:, whole:]

    def points(self) -> tuple[Array, Array]:
        """Places and values (k,) of the line."""
        values = self._rest[1]
        whole = len(values) == self._stretch
        kept = np.unique([values.argmin(), values.argmax(), len(values) - 1]) if whole else np.arange(len(values))[-1:]
        place, values = np.concatenate([*self._kept, self._rest[:, kept]], axis=1)
        return place, values


def curve(run: Run, column: EnvelopeColumn, first: int = 0, last: int | None = None) -> tuple[Array, Array]:
    """Times and values (k,) that draw the samples of a column from `first` to before `last`, by default all."""
    last = len(run) if last is None else last
    line = Envelope(last - first)
    for start, stop in pieces(first, last):
        line.add(run.read(TIME, start, stop), column[start:stop])
    return line.points()


def extremes(column: EnvelopeColumn, first: int, last: int) -> tuple[float, float]:
    """The lowest and the highest value of some samples; what is no number does not count. (inf, -inf) without any."""
    lowest, highest = np.inf, -np.inf
    for start, stop in pieces(first, last):
        values = column[start:stop]
        lowest = float(np.fmin.reduce(values, initial=lowest))
        highest = float(np.fmax.reduce(values, initial=highest))
    return lowest, highest


def at_times(run: Run, column: EnvelopeColumn, times: Array) -> Array:
    """The values (k,) of a column at ascending times (k,) in s, on the line between the samples."""
    values = np.empty(len(times))
    for start, stop in pieces(0, len(run)):
        stop = min(stop + 1, len(run))  # up to the first sample of the next piece
        time_s = run.read(TIME, start, stop)
        first = 0 if start == 0 else np.searchsorted(times, time_s[0])
        here = slice(first, len(times) if stop == len(run) else np.searchsorted(times, time_s[-1]))
        values[here] = np.interp(times[here], time_s, column[start:stop])
    return values
