"""The motion of a run at even steps of the rotor's angle, and the amplitude of one order in it.

There the synchronous motion turns once per revolution whatever the speed does. A Hann window of R revolutions that
turns with order q (times the rotor speed) then gives the amplitude of that order, and is blind to the orders q + j/R
for |j| >= 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import oaconvolve
from scipy.signal.windows import hann

from frbcli.analysis import signals
from frbcli.analysis.signals import Motion, RunLike, Values

SAMPLES_PER_REVOLUTION = 32  # a rotor's natural frequency then lies below the limit of sampling from some 10 Hz upwards
START_s = 0.3  # the rotor falls from its starting position to its place in the first tenths of a second
START_REVOLUTIONS = 5.0


@dataclass(frozen=True)
class Revolutions:
    """Even steps of the rotor's angle: revolution (m,), the time (m,) when each is reached and the speed (m,) there,
    which is negative where the rotor turns the other way round."""

    revolution: Values
    time_s: Values
    speed_Hz: Values

    @property
    def settled(self) -> int:
        """The first sample after the start of the run."""
        by_angle = np.searchsorted(self.revolution, START_REVOLUTIONS)
        by_time = np.searchsorted(self.time_s, (self.time_s[0] if len(self.time_s) else 0.0) + START_s)
        return int(max(by_angle, by_time))


def revolutions(time_s: Values, speed_Hz: Values) -> Revolutions:
    """Even steps of the angle that the speed (n,) at the times (n,) turns the rotor by, in either sense."""
    size = np.abs(speed_Hz)
    revolution = np.concatenate([[0.0], np.cumsum(0.5 * (size[1:] + size[:-1]) * np.diff(time_s))])
    even = np.arange(0.0, revolution[-1], 1.0 / SAMPLES_PER_REVOLUTION)
    time_even = np.interp(even, revolution, time_s)
    return Revolutions(even, time_even, np.interp(time_even, time_s, speed_Hz))


def by_angle(run: RunLike, kind: str, name: str, turns: Revolutions) -> Motion:
    """The motion x + iy of a point at these steps, seen from behind where the rotor turns the other way round: forward
    motion then has a positive order always."""
    motion = np.asarray(np.interp(turns.time_s, run["time_s"], signals.motion_of(run, kind, name)))
    return np.where(turns.speed_Hz < 0.0, np.conj(motion), motion)


def order_motion(motion: Motion, order: float, window: int) -> Motion:
    """The forward motion of an order, seen from a frame that turns with it: `motion` (n,) at even angles ->
    (n - w + 1,), w samples per window of so many revolutions.

    Value i belongs to the middle of the window, sample i + w // 2; empty if the motion is shorter than a window.
    """
    width = window * SAMPLES_PER_REVOLUTION
    if len(motion) < width:
        return np.empty(0, dtype=np.complex128)
    shape = hann(width, sym=False)
    turning = shape / shape.sum() * np.exp(2j * np.pi * order * np.arange(width) / SAMPLES_PER_REVOLUTION)
    found = oaconvolve(motion, turning, mode="valid")
    return np.asarray(found * np.exp(-2j * np.pi * order * np.arange(len(found)) / SAMPLES_PER_REVOLUTION))


def order_amplitude(motion: Motion, order: float, window: int) -> Values:
    """The amplitude of order_motion."""
    return np.asarray(np.abs(order_motion(motion, order, window)), dtype=np.float64)
