"""The rotor speed from a signal with pulses: a keyphasor, an encoder, a sine of a pickup."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array

LEAST_PULSES = 3
REVOLUTIONS = 8  # that a speed is taken over
BLOCKS = 50  # of a signal, in each of which its least and largest values are sought: one spike moves no level
LEAST_RANGE = 0.02  # of the whole range, which the range of most blocks must reach; else pulses are few
ABOVE_NOISE = 10.0  # standard deviations of the noise, likewise
HYSTERESIS = 0.1  # of the range, either way of the level
OF_NOISE = 5.0  # standard deviations of the noise, either way of the level
MOST_HYSTERESIS = 0.35  # of the range: with more noise than that there are no pulses
SECOND_DIFFERENCE = 0.6745 * 6.0**0.5  # median of the second difference of noise with a standard deviation of 1
MISSING = 1.6  # times the intervals before and behind: a pulse is missing between
DOUBLE = 0.75  # times them, at most: an interval at both sides of a pulse that is none
SUM = (0.75, 1.3)  # times them: the two intervals around a pulse that is none, together
FEW = 0.1  # share of pulses that may be missing or double; more of them are the pattern of a wheel
MOST_MISSING = 20  # pulses between two
MARK = "mark_rev"  # reference of a run: the angle in revolutions, integrated from its first sample, at the pulses
MOST_SPREAD = 0.03  # revolutions, of that angle at the pulses


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
    more than a hysteresis that follows from its range and its noise. The speed is that over REVOLUTIONS about a pulse,
    fewer at the ends, as a rectangular pulse is known to a sample only. The angle is a cubic spline through the pulses.
    Raises ValueError if there are too few pulses.
    """
    rises = _rises(signal, *_levels(signal))
    if len(rises) < LEAST_PULSES:
        raise ValueError(f"has {len(rises)} pulses, at least {LEAST_PULSES} are needed.")
    level = _levels(signal)[0]
    share = (level - signal[rises]) / (signal[rises + 1] - signal[rises])
    moments = time[rises] + share * (time[rises + 1] - time[rises])
    moments, missing, double = _regular(moments)
    speed = np.asarray(np.interp(time, *_mean_speeds(moments, pulses)), dtype=np.float64)
    mark = _mark(time, speed, moments) if pulses == 1 else None
    return Tacho(speed, _angles(time, moments, pulses), missing, double, mark)


def _mark(time: Array, speed: Array, moments: Array) -> float | None:
    """See Tacho."""
    angle = np.append(0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time)))
    mean = complex(np.exp(2j * np.pi * np.interp(moments, time, angle)).mean())
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
    whole = np.minimum(REVOLUTIONS, 2 * np.minimum(number, count - 1 - number) // pulses)
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


def _regular(moments: Array) -> tuple[Array, int, int]:
    """(moments (m,) of pulses without double ones and with missing ones, how many were missing, how many double).

    An interval is compared with those before and behind it, so that a rotor that starts or stops misses none.
    """
    few = FEW * len(moments)
    double = _double(np.diff(moments))
    kept = moments if len(double) > few else np.delete(moments, double)
    left_out = len(moments) - len(kept)
    steps = np.diff(kept)
    before, behind = _around(steps, 1)
    ratio = np.minimum(steps / before, steps / behind)
    wide = np.flatnonzero(ratio > MISSING)
    added = [
        kept[place] + steps[place] * np.arange(1, count) / count
        for place in wide
        for count in (round(2.0 * steps[place] / (before[place] + behind[place])),)
        if 2 <= count <= MOST_MISSING
    ]
    missing = sum(map(len, added))
    if not missing or len(wide) > few:
        return kept, 0, left_out
    return np.sort(np.concatenate([kept, *added])), missing, left_out


def _double(steps: Array) -> NDArray[np.int64]:
    """The numbers of the pulses that split an interval in two; steps (m - 1,): between m pulses."""
    if len(steps) < LEAST_PULSES:
        return np.empty(0, dtype=np.int64)
    before, behind = _around(steps, 1)
    left, right = steps[:-1], steps[1:]
    least, most = (bound(before[:-1], behind[1:]) for bound in (np.minimum, np.maximum))
    together = left + right
    split = (np.maximum(left, right) < least) & (np.minimum(left, right) < DOUBLE * least)
    split &= (together > SUM[0] * least) & (together < SUM[1] * most)
    return np.flatnonzero(split) + 1


def _around(steps: Array, apart: int) -> tuple[Array, Array]:
    """The median of three intervals (m,) before each one and of three behind it, as far as there are any; at the ends
    the other side's are doubled, so that the first and the last intervals are never too long."""
    count = len(steps)
    medians = []
    for sense in (-1, 1):
        near = np.full((3, count), np.nan)
        for k in range(3):
            other = np.arange(count) + sense * (apart + k)
            inside = (other >= 0) & (other < count)
            near[k, inside] = steps[other[inside]]
        filled = np.where(np.isnan(near[0]), np.inf, 0.0)
        known = np.where(np.isnan(near), near[0], near)
        medians.append(np.where(np.isinf(filled), np.inf, np.median(known, axis=0)))
    return medians[0], medians[1]
