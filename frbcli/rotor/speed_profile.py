"""The prescribed rotor speed: piecewise linear in time, and the angle that belongs to it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array


@dataclass(frozen=True)
class SpeedProfile:
    """times: (k,) s, ascending; speeds: (k,) rad/s at these times; angles: (k,) rad."""

    times: Array
    speeds: Array
    angles: Array

    @property
    def end(self) -> float:
        """Time at the end of the profile, s."""
        return float(self.times[-1])

    def speed(self, t: Array) -> Array:
        """Rotor speed in rad/s at the times t (n,)."""
        return np.interp(t, self.times, self.speeds)

    def rotation(self, t: float) -> tuple[float, float, float]:
        """Angular acceleration in rad/s^2, speed in rad/s and angle in rad at the time t; at a kink, just after it."""
        piece = min(max(int(np.searchsorted(self.times, t, side="right")) - 1, 0), len(self.times) - 2)
        acceleration, speed, angle = rotation(self.times, self.speeds, self.angles, piece, t)
        return float(acceleration), float(speed), float(angle)

    def angle(self, t: float) -> float:
        """Angle of the rotor in rad at the time t."""
        return self.rotation(t)[2]

    def with_stops(self, times: Iterable[float]) -> SpeedProfile:
        """The same speeds with additional points at those of the times in s that lie within the profile."""
        kinks = [t for t in times if self.times[0] < t < self.times[-1]]
        t = np.union1d(self.times, np.array(kinks))
        return speed_profile(t.tolist(), self.speed(t).tolist())

    def until(self, t: float) -> SpeedProfile:
        """The profile up to one of its own times, s."""
        kept = slice(int(np.searchsorted(self.times, t, side="right")))
        return SpeedProfile(self.times[kept], self.speeds[kept], self.angles[kept])


def speed_profile(times: list[float], speeds: list[float]) -> SpeedProfile:
    """Profile through the given speeds (rad/s) at the given times (s), linear in between."""
    t, omega = np.asarray(times, dtype=float), np.asarray(speeds, dtype=float)
    angles = np.concatenate([[0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * np.diff(t))])
    return SpeedProfile(t, omega, angles)


def rotation(times: Array, speeds: Array, angles: Array, piece: int, t: float) -> tuple[float, float, float]:
    """Angular acceleration, speed and angle at the time t inside the given piece of a profile."""
    start = t - times[piece]
    acceleration = (speeds[piece + 1] - speeds[piece]) / (times[piece + 1] - times[piece])
    speed = speeds[piece] + acceleration * start
    return acceleration, speed, angles[piece] + start * (speeds[piece] + 0.5 * acceleration * start)
