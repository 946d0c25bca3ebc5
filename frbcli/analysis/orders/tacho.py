"""The rotor speed from a signal with pulses."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array

LEAST_PULSES = 3
REVOLUTIONS = 8  # that a speed is taken over


def tacho_speed(time: Array, signal: Array, pulses: int) -> Array:
    """(n,) rotor speed in Hz from a signal with so many pulses per revolution, at the times (n,) in s.

    A pulse begins where the signal rises through the middle between its least and its largest value, interpolated
    between samples. The speed is that over REVOLUTIONS about a pulse, fewer at the ends, as a rectangular pulse is
    known to a sample only. Raises ValueError if there are too few pulses.
    """
    level = 0.5 * (signal.min() + signal.max())
    rises = np.flatnonzero((signal[:-1] < level) & (signal[1:] >= level))
    if len(rises) < LEAST_PULSES:
        raise ValueError(f"has {len(rises)} pulses, at least {LEAST_PULSES} are needed.")
    share = (level - signal[rises]) / (signal[rises + 1] - signal[rises])
    moments = time[rises] + share * (time[rises + 1] - time[rises])
    number = np.arange(len(moments))
    half = max(1, REVOLUTIONS * pulses // 2)
    first, last = np.maximum(number - half, 0), np.minimum(number + half, len(moments) - 1)
    speeds = (last - first) / (pulses * (moments[last] - moments[first]))
    return np.asarray(np.interp(time, 0.5 * (moments[first] + moments[last]), speeds), dtype=np.float64)
