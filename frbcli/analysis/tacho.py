"""The rotor speed from a signal with pulses: a keyphasor, an encoder, a sine of a pickup.

Pulses that are missing or double are found by their intervals. What cannot be made even is refused: noise instead of
pulses, a mark that is seen now and then, a gap in which the rotor went on turning.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Truths

LEAST_PULSES = 3
SPEED_REVOLUTIONS = 8  # that a speed is taken over
BLOCKS = 50  # of a signal, in each of which its least and largest values are sought: one spike moves no level
LEAST_RANGE = 0.02  # of the whole range, which the range of most blocks must reach; else pulses are few
ABOVE_NOISE = 10.0  # standard deviations of the noise, likewise
HYSTERESIS = 0.1  # of the range, either way of the level
OF_NOISE = 5.0  # standard deviations of the noise, either way of the level
MOST_HYSTERESIS = 0.35  # of the range: with more noise than that there are no pulses
SECOND_DIFFERENCE = 0.6745 * 6.0**0.5  # median of the second difference of noise with a standard deviation of 1
MANY, FEW = 0.35, 0.1  # share of pulses that may be missing or double; of a wheel with even revolutions
MOST_MISSING, MOST_DOUBLE = 20, 4  # pulses between two
DROP, DROP_END = 0.5, 1.0  # changes of the logarithm of intervals for which a pulse is left out, also at an end
FILL, FILL_MORE = 0.2, 0.05  # for which an interval is divided, and for each of its parts
NEAR, REACH = 7, 8  # intervals on either side: that one is compared with, that a search takes in
UNEVEN, UNEVEN_WHEEL = 0.25, 0.06  # difference of an interval from those around it; of revolutions of uneven teeth
MOST_UNEVEN = 0.02  # share of such revolutions
STEADY = 0.1  # difference of intervals, relative, of a rotor that neither starts nor stops
MARK = "mark_rev"  # reference of a run: the angle in revolutions, integrated from its first sample, at the pulses
MOST_SPREAD = 0.03  # revolutions, of that angle at the pulses
KEPT = 3  # times that a speed is corrected by the drift of its angle


@dataclass(frozen=True)
class Tacho:
    """speed_Hz, angle: (n,) at the times of the samples, the latter in rad, 0 at the first pulse; missing, double: how
    many pulses were added and left out; mark: the angle in revolutions at which the rotor is at a pulse, integrated
    from the speed since the first sample; None where it differs between pulses, or a revolution has several."""

    speed_Hz: Array
    angle: Array
    missing: int
    double: int
    mark: float | None = None

    def remark(self, name: str) -> str:
        """What a reader has to know of the pulses in a column; nothing if all were regular."""
        if not self.missing and not self.double:
            return ""
        return (
            f'Pulses of "{name}": {self.missing} missing ones were added and {self.double} double ones left out, by '
            "their intervals."
        )


def tacho_speed(time: Array, signal: Array, pulses: int) -> Tacho:
    """The rotor speed from a signal (n,) with so many pulses per revolution, at the times (n,) in s.

    A pulse begins where the signal rises through its middle level, interpolated between samples, after it was below by
    more than a hysteresis that follows from its range and its noise. The speed is that over SPEED_REVOLUTIONS about a
    pulse, fewer at the ends, as a rectangular pulse is known to a sample only. The angle is a cubic spline through the
    pulses. Raises ValueError if there are too few pulses, or these are uneven.
    """
    rises = _rises(signal, *_levels(signal))
    if len(rises) < LEAST_PULSES:
        raise ValueError(f"has {len(rises)} pulses, at least {LEAST_PULSES} are needed.")
    level = _levels(signal)[0]
    share = (level - signal[rises]) / (signal[rises + 1] - signal[rises])
    moments = time[rises] + share * (time[rises + 1] - time[rises])
    moments, missing, double = _regular(moments, pulses)
    speed = np.asarray(np.interp(time, *_mean_speeds(moments, pulses)), dtype=np.float64)
    mark = _mark(time, speed, moments) if pulses == 1 else None
    if pulses == 1 and mark is None:
        speed = _kept_to_pulses(time, speed, moments)
        mark = _mark(time, speed, moments)
    return Tacho(speed, _angles(time, moments, pulses), missing, double, mark)


def _turned(time: Array, speed: Array, moments: Array) -> Array:
    """Revolutions from the first sample to each of the moments (m,) in s, integrated from the speed in Hz."""
    angle = np.append(0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time)))
    return np.asarray(np.interp(moments, time, angle), dtype=np.float64)


def _kept_to_pulses(time: Array, speed: Array, moments: Array) -> Array:
    """The speed (n,) in Hz, changed so that the angle integrated from it stays at the pulses at moments (m,). A mean
    speed misses some of a revolution where a slow rotor begins to speed up. What is added is smooth, too."""
    half = SPEED_REVOLUTIONS // 2
    for _ in range(KEPT):
        drift = np.pad(np.arange(len(moments)) - _turned(time, speed, moments), half, mode="edge")
        slow = np.convolve(drift, np.full(2 * half + 1, 1.0 / (2 * half + 1)), "valid")
        rates = np.diff(slow) / np.diff(moments)
        speed = speed + np.interp(time, 0.5 * (moments[1:] + moments[:-1]), rates, 0.0, 0.0)
    return np.asarray(np.maximum(speed, 0.0), dtype=np.float64)


def _mark(time: Array, speed: Array, moments: Array) -> float | None:
    """See Tacho."""
    mean = complex(np.exp(2j * np.pi * _turned(time, speed, moments)).mean())
    spread = np.sqrt(-2.0 * np.log(min(abs(mean), 1.0))) / (2.0 * np.pi) if mean else np.inf
    return float(np.angle(mean) / (2.0 * np.pi)) if spread < MOST_SPREAD else None


def _angles(time: Array, moments: Array, pulses: int) -> Array:
    """(n,) rad at times (n,): a spline through the pulses at moments (m,), a straight line before and behind them."""
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(moments, 2.0 * np.pi / pulses * np.arange(len(moments)))
    within = np.clip(time, moments[0], moments[-1])
    return np.asarray(spline(within) + spline(within, 1) * (time - within), dtype=np.float64)


def _mean_speeds(moments: Array, pulses: int) -> tuple[Array, Array]:
    """Times (m,) and speeds (m,) in Hz over whole revolutions about pulses; the outermost ones are those that a line
    through the next two gives at the first and the last pulse."""
    number, count = np.arange(len(moments)), len(moments)
    whole = np.minimum(SPEED_REVOLUTIONS, 2 * np.minimum(number, count - 1 - number) // pulses)
    width = np.minimum(np.maximum(whole, 1) * pulses, count - 1)
    first = np.clip(number - width // 2, 0, count - 1 - width)
    last = first + width
    speeds = width / (pulses * (moments[last] - moments[first]))
    middles, kept = np.unique(0.5 * (moments[first] + moments[last]), return_index=True)
    v = speeds[kept]
    if len(middles) < 2:
        return middles, v
    ends = [v[at] + (v[next_] - v[at]) / (middles[next_] - middles[at]) * (moments[at] - middles[at])
            for at, next_ in ((0, 1), (-1, -2))]  # fmt: skip
    speeds = np.concatenate([[max(ends[0], 0.0)], v, [max(ends[1], 0.0)]])
    return np.concatenate([moments[:1], middles, moments[-1:]]), speeds


def _levels(signal: Array) -> tuple[float, float]:
    """(the middle level of a signal, the hysteresis either way of it)."""
    blocks = np.array_split(signal, min(BLOCKS, len(signal)))
    low, high = (float(np.median([reach(block) for block in blocks])) for reach in (np.min, np.max))
    noise = float(np.median(np.abs(np.diff(signal, 2)))) / SECOND_DIFFERENCE if len(signal) > 2 else 0.0
    if high - low < max(LEAST_RANGE * float(np.ptp(signal)), ABOVE_NOISE * noise):
        low, high = float(signal.min()), float(signal.max())
    hysteresis = min(max(HYSTERESIS * (high - low), OF_NOISE * noise), MOST_HYSTERESIS * (high - low))
    return 0.5 * (low + high), hysteresis


def _rises(signal: Array, level: float, hysteresis: float) -> NDArray[np.int64]:
    """The samples (m,) before a signal rises through a level, once from below the hysteresis to above it."""
    number = np.arange(len(signal))
    beyond = np.where(signal >= level + hysteresis, 1, np.where(signal <= level - hysteresis, -1, 0))
    if hysteresis == 0.0:
        beyond = np.where(signal >= level, 1, -1)
    reached = np.maximum.accumulate(np.where(beyond != 0, number, 0))  # of the last sample beyond
    state = beyond[reached]
    above = np.flatnonzero((state[1:] == 1) & (state[:-1] == -1)) + 1
    below = np.maximum.accumulate(np.where(signal < level, number, -1))
    return np.asarray(below[above - 1], dtype=np.int64)


def _regular(moments: Array, pulses: int) -> tuple[Array, int, int]:
    """(moments (m,) of pulses without double ones and with missing ones, how many were missing, how many double).

    More of them than a share are the pattern of a wheel, if its revolutions are even, or no pulses. Raises ValueError
    if revolutions are uneven, or if many pulses are missing at one place.
    """
    few = FEW if pulses > 1 and _uneven(moments, pulses, UNEVEN_WHEEL) < FEW else MANY
    mended, missing, double = _mended(moments)
    mended, outermost = _with_ends(mended)
    missing += outermost
    if missing + double > few * len(moments):
        mended, missing, double = moments, 0, 0
    if (left := _uneven(mended, pulses, UNEVEN)) > MOST_UNEVEN:
        raise ValueError(
            f"has pulses at uneven intervals: {left:.0%} of the revolutions differ by more than {UNEVEN:.0%} from "
            "those around them."
        )
    _require_no_gap(mended)
    return mended, missing, double


def _mended(moments: Array) -> tuple[Array, int, int]:
    """As `_regular`, by the sequences of pulses whose intervals change least, wherever two of them differ."""
    steps = np.diff(moments)
    uneven = np.flatnonzero(np.abs(np.diff(np.log(steps))) > np.log(1.0 + UNEVEN))
    if len(uneven) == 0:
        return moments, 0, 0
    apart = np.flatnonzero(np.diff(uneven) > 2 * REACH)
    firsts, lasts = uneven[np.append(0, apart + 1)] - REACH, uneven[np.append(apart, len(uneven) - 1)] + REACH + 1
    kept = np.ones(len(moments), dtype=np.bool_)
    added: list[Array] = []
    for first, last in zip(np.maximum(firsts, 0), np.minimum(lasts, len(steps)), strict=True):
        chosen, counts = _smoothest(moments[first : last + 1])
        kept[first : last + 1] = False
        kept[first + chosen] = True
        for begin, end, count in zip(chosen[:-1], chosen[1:], counts, strict=True):
            step = moments[first + end] - moments[first + begin]
            added.append(moments[first + begin] + step * np.arange(1, count) / count)
    missing = np.concatenate(added)
    return np.sort(np.concatenate([moments[kept], missing])), len(missing), int(np.sum(~kept))


def _with_ends(moments: Array) -> tuple[Array, int]:
    """(moments with those that are missing in the outermost intervals, if the rotor is steady there, their number)."""
    whole = moments
    for steps, begin, sense in ((np.diff(moments), moments[0], 1.0), (np.diff(moments)[::-1], moments[-1], -1.0)):
        near = steps[1:4]
        count = round(steps[0] / float(np.median(near))) if len(near) > 2 and np.ptp(near) < STEADY * near.max() else 1
        if 2 <= count <= MOST_MISSING:
            whole = np.append(whole, begin + sense * steps[0] * np.arange(1, count) / count)
    return np.sort(whole), len(whole) - len(moments)


def _smoothest(moments: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(the pulses (k,) among some (m,) that make the smoothest sequence, in how many intervals to divide those between
    them (k - 1,)): the least sum of the changes of their logarithms, of DROP for each pulse that is left out and FILL
    for each interval that is divided. It is found by dynamic programming over the last interval of a sequence.

    The outermost intervals are not divided: they are long where a rotor starts or stops.
    """
    count, steps = len(moments), np.diff(moments)
    usual = [float(np.median(steps[max(place - REACH, 0) : place + REACH])) for place in range(count)]
    back = np.arange(1, MOST_DOUBLE + 2)
    cost = np.full((count, len(back), 2), np.inf)
    length = np.zeros_like(cost)
    parts = np.ones(cost.shape, dtype=np.int64)
    before = np.full(cost.shape, -1, dtype=np.int64)
    for last in range(1, count):
        for at, first in enumerate(last - back[back <= last]):
            step = moments[last] - moments[first]
            many = round(step / usual[last])
            parts[last, at, 1] = many if 1 < many <= MOST_MISSING else 1
            length[last, at] = np.log(step / parts[last, at])
            through = (cost[first] + np.abs(length[last, at][:, None, None] - length[first])).reshape(2, -1)
            best, least = through.argmin(axis=1), through.min(axis=1)
            alone = np.where(parts[last, at] == 1, DROP_END * first, np.inf)  # as the first interval
            before[last, at] = np.where(alone < least, -1, best)
            divided = np.where(parts[last, at] > 1, FILL + FILL_MORE * parts[last, at], 0.0)
            cost[last, at] = np.minimum(least, alone) + DROP * at + divided
    ends = np.where(parts == 1, cost + DROP_END * (count - 1 - np.arange(count))[:, None, None], np.inf)
    place, at, way = (int(each) for each in np.unravel_index(int(ends.argmin()), ends.shape))
    chosen, counts = [place], list[int]()
    while place >= 0:
        counts.append(int(parts[place, at, way]))
        previous, place = int(before[place, at, way]), place - int(back[at])
        chosen.append(place)
        if previous < 0:
            break
        at, way = divmod(previous, 2)
    return np.array(chosen[::-1]), np.array(counts[::-1])


def _uneven(moments: Array, pulses: int, most: float) -> float:
    """The share of revolutions that stand out by more than `most`."""
    return float(np.mean(np.append(_stand_out(moments[pulses:] - moments[:-pulses], most), False)))


def _stand_out(steps: Array, most: float) -> Truths:
    """Whether intervals (m,) are shorter, or longer, than those before and behind them, by more than `most`.

    A rotor that starts or stops has intervals between those before and those behind.
    """
    before, behind = _around(steps)
    low, high = np.minimum(before, behind), np.maximum(before, behind)
    return (steps < low / (1.0 + most)) | (steps > high * (1.0 + most))


def _require_no_gap(moments: Array) -> None:
    """Raises ValueError for an interval without pulses between steady ones, in which the rotor went on turning; before
    one in which it stood still, it becomes slower."""
    steps = np.diff(moments)
    before, behind = _around(steps)
    for place in np.flatnonzero(np.minimum(steps / before, steps / behind) > MOST_MISSING):
        last, next_ = steps[max(place - 2, 0) : place], steps[place + 1 : place + 3]
        if min(np.ptp(last) / last.max(), np.ptp(next_) / next_.max()) < STEADY:
            begin, end = moments[place], moments[place + 1]
            raise ValueError(f"has no pulses from {begin:.4g} s to {end:.4g} s, though the rotor turns before it.")


def _around(steps: Array) -> tuple[Array, Array]:
    """The median of NEAR intervals (m,) before each one and of as many behind it, as far as there are any.

    At the ends it is that of the other side if the rotor is steady there, else infinite.
    """
    count = len(steps)
    medians, steady = [], []
    for sense in (-1, 1):
        near = np.full((NEAR, count), np.nan)
        for k in range(NEAR):
            other = np.arange(count) + sense * (1 + k)
            inside = (other >= 0) & (other < count)
            near[k, inside] = steps[other[inside]]
        known = np.where(np.isnan(near), near[0], near)
        medians.append(np.where(np.isnan(near[0]), np.inf, np.median(known, axis=0)))
        steady.append(np.ptp(known, axis=0) < STEADY * known.max(axis=0))
    before, behind = medians
    first, last = np.isinf(before) & steady[1], np.isinf(behind) & steady[0]
    return np.where(first, behind, before), np.where(last, before, behind)
