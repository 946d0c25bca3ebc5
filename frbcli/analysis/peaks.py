"""Peaks of a curve, how far each stands out of it, intervals in which it is high, and where between two samples it
crosses a level."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array


@dataclass(frozen=True)
class Peak:
    """A local maximum. place: its sample; prominence: how far it stands out of the higher of its two sides, each of
    which reaches to the next higher sample or to the end of the curve; rise: how far it stands out of the side before
    it; before, after: the last and the first sample on its flanks that are at most half of the prominence below it, so
    to say half-way up."""

    place: int
    prominence: float
    rise: float
    before: int
    after: int


def local_maxima(values: Array, least: float = -np.inf) -> NDArray[np.intp]:
    """Samples of `values` (n,) of at least this height that are higher than both neighbours."""
    inner = values[1:-1]
    return np.flatnonzero((inner > values[:-2]) & (inner >= values[2:]) & (inner >= least)) + 1


def summit(left: float, here: float, right: float) -> float:
    """Where the parabola through three neighbouring samples, the middle one at 0, has its top: at most half-way to the
    next sample."""
    bend = left - 2.0 * here + right
    return float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if bend < 0.0 else 0.0


def crossing(values: Array, place: int, level: float, step: int) -> float:
    """Where `values` (n,), which are positive, cross a level between the sample `place`, which reaches it, and the next
    one in the direction of `step`, -1 or 1. What grows or dies is straight over the logarithm. The place itself if the
    next sample is as high, or the curve ends there."""
    if not 0 <= place + step < len(values) or values[place + step] >= level:
        return float(place)
    here, beyond = np.log(values[place]), np.log(max(values[place + step], 1e-300))
    return place + step * float((here - np.log(level)) / (here - beyond))


def prominent_peaks(values: Array, least: float) -> list[Peak]:
    """The peaks of `values` (n,) with at least this prominence, which is greater than zero."""
    if len(values) < 3:
        return []
    found = []
    for place in swings(values, least):
        height = values[place]
        left, right = _foot(values[:place][::-1], height), _foot(values[place + 1 :], height)
        prominence = float(height - max(left, right))
        if prominence >= least:
            half = height - 0.5 * prominence
            before = place - 1 - int(np.argmax(values[:place][::-1] <= half))
            after = place + 1 + int(np.argmax(values[place + 1 :] <= half))
            found.append(Peak(int(place), prominence, float(height - left), before, after))
    return found


def swings(values: Array, least: float) -> list[int]:
    """The maxima from which `values` (n,) fall by `least` before they rise beyond them: few of many in noise."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(values)), prepend=0.0) != 0.0)
    swings: list[int] = []
    lowest, top = np.inf, -1  # since the last swing; the highest sample that is `least` above the lowest one
    for place in np.append(turns, len(values) - 1).tolist():
        value = values[place]
        if top < 0:
            lowest = min(lowest, value)
            top = place if value - lowest >= least else -1
        elif value > values[top]:
            top = place
        elif values[top] - value >= least:
            swings.append(top)
            lowest, top = value, -1
    return swings


def _foot(side: Array, height: float) -> float:
    """The lowest value of a side (n,) of a peak, seen from the peak, before it rises above the peak."""
    higher = side > height
    end = int(np.argmax(higher)) if higher.any() else len(side)
    return float(side[:end].min(initial=height))


def intervals_above(amplitude: Array, begins: float, ends: float, pause: int) -> Iterator[tuple[int, int]]:
    """First and one past the last sample of each interval above `begins`, where dips shorter than `pause` do not count.

    An interval must fall below `ends` to be over, and counts to where it last was above `begins`.
    """
    above = np.flatnonzero(amplitude >= begins)
    if len(above) == 0:
        return
    low = np.concatenate([[0], np.cumsum(amplitude < ends)])
    gaps = np.diff(above)
    breaks = np.flatnonzero((gaps > pause) & (low[above[1:]] > low[above[:-1]]))
    firsts, lasts = above[np.concatenate([[0], breaks + 1])], above[np.concatenate([breaks, [len(above) - 1]])]
    for first, last in zip(firsts, lasts, strict=True):
        still_there = low[-1] == low[last]
        yield int(first), len(amplitude) if still_there else int(last) + 1
