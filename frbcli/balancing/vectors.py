"""Synchronous vectors of a run: what its points move with the rotor, with the phase to the rotor's angle.

A point moves with x = Re(A exp(i alpha)), and y likewise, alpha the angle of the rotor. In a computed run it is 0 at
the beginning, in a measurement 0 at each pulse of the tacho.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.analysis.orders.order_tracking import FEWEST as LEAST_REVOLUTIONS
from frbcli.analysis.orders.order_tracking import REVOLUTIONS, STEPS, OrderTrack, order_track
from frbcli.analysis.orders.tacho import MARK
from frbcli.analysis.signals import RunLike, SignalOf, course, joined, points
from frbcli.arrays import Array, Complex
from frbcli.errors import input_error
from frbcli.results.records import TIME

OF_SHAFT = ("journal", "disk")  # kinds of points
SAME, NEAR = 2e-3, 1e-2  # relative: speeds that are equal, and speeds that are close enough to replace each other
HELD = 2.0  # windows: a speed that is held longer has settled in the second half of that time
DWELLS = 0.25  # share of a run that holds one speed
WINDOWS = 0.5  # share of a short run that a window has
FEWEST = 4  # windows of which a scatter is known
SPEEDS, FROM, TO = 8, 0.4, 0.95  # of a ramp: number, and share of its highest speed


@dataclass(frozen=True)
class SynchronousVectors:
    """Vectors of p points at s speeds. values: (s, p, 2) complex amplitudes of x and y in m; scatter: (s, p, 2) of the
    windows in m, 0 where it is not known."""

    speeds_Hz: Array
    points: tuple[str, ...]
    values: Complex
    scatter: Array


def shaft_points(run: RunLike) -> tuple[str, ...]:
    """The points of the shaft whose motion a run has."""
    return tuple(joined(kind, name) for kind in OF_SHAFT for name in points(run.signals, kind))


def synchronous_vectors(
    run: RunLike, names: Sequence[str], speeds_Hz: Sequence[float] | None = None
) -> SynchronousVectors:
    """The vectors of points at speeds in Hz: by default at the one that the run holds, else at SPEEDS of its ramp.

    Raises InputError for a point that the run does not have, a speed that it does not reach, and a rotor that turns the
    other way round."""
    revolutions = _window(run)
    tracks = [order_track(run, 1.0, name, revolutions) for name in names]
    if not float(tracks[0].speed_Hz.max()) > 0.0:
        raise input_error("balance", "speed", "", "is not above 0: the rotor turns the other way round.", "")
    speeds = _usual_speeds(tracks[0]) if speeds_Hz is None else sorted(set(speeds_Hz))
    turned = np.exp(2j * np.pi * run.references.get(MARK, 0.0))
    rows = [[_at(track, speed) for track in tracks] for speed in speeds]
    values = np.array([[value for value, _ in row] for row in rows])
    scatter = np.array([[scatter for _, scatter in row] for row in rows])
    return SynchronousVectors(np.array(speeds), tuple(names), turned * values, scatter)


def _window(run: RunLike) -> int:
    """Revolutions of the windows: fewer than usual in a run that makes few."""
    time, speed = course(SignalOf(run, TIME), SignalOf(run, "speed_Hz"))
    turned = float(np.sum(0.5 * np.abs(speed[1:] + speed[:-1]) * np.diff(time)))
    return max(LEAST_REVOLUTIONS, min(REVOLUTIONS, int(WINDOWS * turned)))


def _usual_speeds(track: OrderTrack) -> list[float]:
    speeds = track.speed_Hz
    for centre in (float(np.median(speeds)), float(speeds.max())):
        near = np.abs(speeds - centre) <= SAME * centre
        if np.count_nonzero(near) > DWELLS * len(speeds):
            return [float(speeds[near].mean())]
    top = float(speeds.max())
    return [float(speed) for speed in np.linspace(max(FROM * top, float(speeds.min())), TO * top, SPEEDS)]


def _at(track: OrderTrack, speed: float) -> tuple[Complex, Array]:
    """Vector (2,) and scatter (2,) in m at a speed in Hz."""
    speeds = track.speed_Hz
    nearest = int(np.argmin(np.abs(speeds - speed)))
    if abs(speeds[nearest] - speed) > NEAR * speed:
        problem = f"is not reached; the run goes from {speeds.min():.4g} to {speeds.max():.4g} Hz."
        raise input_error("balance", "speed", f"{speed:.6g} Hz", problem, "Choose another speed, by --speed.")
    values = np.stack([track.along("x"), track.along("y")], axis=-1)
    near = np.flatnonzero(np.abs(speeds - speeds[nearest]) <= SAME * speed)
    if len(near) > HELD * track.revolutions * STEPS:
        near = near[len(near) // 2 :]
    if len(near) < FEWEST:
        return _between(speeds, values, nearest, speed), np.zeros(2)
    here = values[near]
    line = np.polynomial.polynomial.polyfit(near - near.mean(), here.view(float).reshape(len(near), -1), 1)
    off = here - (line[0] + np.outer(near - near.mean(), line[1])).view(complex).reshape(here.shape)
    return here.mean(axis=0), np.sqrt(np.mean(np.abs(off) ** 2, axis=0))


def _between(speeds: Array, values: Complex, nearest: int, speed: float) -> Complex:
    """The vector (2,) on the line through two windows, the nearest one and its neighbour on the other side."""
    for other in (nearest - 1, nearest + 1):
        if 0 <= other < len(speeds) and (speeds[other] - speed) * (speeds[nearest] - speed) < 0.0:
            share = (speed - speeds[nearest]) / (speeds[other] - speeds[nearest])
            return np.asarray(values[nearest] + share * (values[other] - values[nearest]))
    return np.asarray(values[nearest])


def marked(run: RunLike) -> bool:
    """Whether a run holds the angle of the rotor."""
    return math.isfinite(run.references.get(MARK, math.nan))
