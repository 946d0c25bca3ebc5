"""A ball bearing: its geometry, contacts, frequencies, and where it rests under a radial load.

The contact angle without load is that of the grooves, or follows from the radial clearance G, by which one ring moves
from one side to the other: cos(alpha_0) = 1 - G / (2 A), A = (f_i + f_o - 1) d (Harris, Rolling Bearing Analysis,
chapter 2).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.materials.solids import Elastic
from frbcli.rolling.force import BELOW, KNOWN, BallBearings, ball_bearing_force, rings
from frbcli.rolling.hertz import HertzContact, contact

MEAN_POINTS = 24  # at which balls that are spread evenly are summed, at least; twice as many balls are as good
SETTLED, CARRIED = 1e-12, 1e-6  # of the load: what is left over at rest, and where steps no longer help
STEPS = 80
FIRST = 1e-6  # m, beyond which the place along a load's line is sought
ROUND = 1e-15  # m, below which a deflection is round-off of the places


@dataclass(frozen=True)
class BallBearing:
    """One or two equal rows of balls between two rings, SI units.

    balls: of one row; pitch_diameter: of the circle of their centres; contact_angle: without load, rad; inner, outer:
    radii of the grooves over the diameter of a ball; ball, ring: their materials; rows: 1 or 2; preload: along the axis
    on each row, N, or None where the rings are held at `offset`, the axial displacement in m from their first contact;
    turning: whether the balls pass, or act as if they were spread evenly.
    """

    balls: int
    ball_diameter: float
    pitch_diameter: float
    contact_angle: float
    inner: float
    outer: float
    ball: Elastic
    ring: Elastic
    rows: int = 1
    preload: float | None = None
    offset: float = 0.0
    turning: bool = True

    @property
    def gamma(self) -> float:
        """d cos(alpha_0) / D."""
        return self.ball_diameter * math.cos(self.contact_angle) / self.pitch_diameter

    @property
    def cage_ratio(self) -> float:
        """Speed of the cage over that of the shaft."""
        return 0.5 * (1.0 - self.gamma)

    @property
    def pass_outer(self) -> float:
        """Balls that pass a place of the outer ring, per revolution of the shaft."""
        return self.balls * self.cage_ratio

    @property
    def pass_inner(self) -> float:
        """Balls that pass a place of the inner ring, per revolution of the shaft."""
        return 0.5 * self.balls * (1.0 + self.gamma)

    @property
    def ball_spin(self) -> float:
        """Turns of a ball about its own axis, per revolution of the shaft."""
        return 0.5 * self.pitch_diameter / self.ball_diameter * (1.0 - self.gamma**2)

    @property
    def grooves(self) -> float:
        """A: distance of the groove centres where a ball just touches both, m."""
        return (self.inner + self.outer - 1.0) * self.ball_diameter

    @cached_property
    def contacts(self) -> tuple[HertzContact, HertzContact]:
        """Those of a ball with the inner and the outer ring."""
        d, gamma = self.ball_diameter, self.gamma
        inner = 2.0 / d + 2.0 / d * gamma / (1.0 - gamma), 2.0 / d - 1.0 / (self.inner * d)
        outer = 2.0 / d - 2.0 / d * gamma / (1.0 + gamma), 2.0 / d - 1.0 / (self.outer * d)
        return contact(self.ball, self.ring, *inner), contact(self.ball, self.ring, *outer)

    @property
    def centrifugal(self) -> float:
        """Centrifugal force of a ball over the square of the speed of the shaft, N s^2."""
        mass = self.ball.density * math.pi / 6.0 * self.ball_diameter**3
        return 0.5 * mass * self.pitch_diameter * self.cage_ratio**2

    @property
    def points(self) -> int:
        """Places around at which balls are summed."""
        return self.balls if self.turning else max(MEAN_POINTS, 4 * -(-self.balls // 2))


def joined(bearings: Sequence[BallBearing]) -> BallBearings:
    """All ball bearings of a machine, for the kernels."""

    def column(values: Sequence[float]) -> Array:
        return np.array(values, dtype=np.float64)

    angles = [bearing.contact_angle for bearing in bearings]
    sizes = [bearing.ball_diameter for bearing in bearings]
    return BallBearings(
        points=np.array([bearing.points for bearing in bearings], dtype=np.int64),
        share=column([bearing.rows * bearing.balls / bearing.points for bearing in bearings]),
        axial=column([each.grooves * math.sin(angle) for each, angle in zip(bearings, angles, strict=True)]),
        radial=column([each.grooves * math.cos(angle) for each, angle in zip(bearings, angles, strict=True)]),
        inner=column([(each.inner - 0.5) * d for each, d in zip(bearings, sizes, strict=True)]),
        outer=column([(each.outer - 0.5) * d for each, d in zip(bearings, sizes, strict=True)]),
        k_inner=column([bearing.contacts[0].stiffness for bearing in bearings]),
        k_outer=column([bearing.contacts[1].stiffness for bearing in bearings]),
        centrifugal=column([bearing.centrifugal for bearing in bearings]),
        held=np.array([bearing.preload is None for bearing in bearings], dtype=np.int64),
        preload=column([b.offset if b.preload is None else b.rows * b.preload for b in bearings]),
        cage=column([bearing.cage_ratio if bearing.turning else 0.0 for bearing in bearings]),
    )


def scratch(bearings: BallBearings) -> Array:
    """(b, 1 + points, KNOWN) for the kernels: nothing is known yet."""
    return np.zeros((len(bearings.points), 1 + int(bearings.points.max(initial=0)), KNOWN))


@dataclass(frozen=True)
class Balls:
    """The balls of one row at rest. angles: from the x-axis, rad; inner_angle, outer_angle: contact angles in rad, NaN
    without contact; inner_load, outer_load: N. All (n,)."""

    angles: Array
    inner_angle: Array
    outer_angle: Array
    inner_load: Array
    outer_load: Array


@dataclass(frozen=True)
class RestingRings:
    """A ball bearing at rest. displacement: (3,) of the inner ring, m; force: (3,) on it, N; stiffness: (2, 2) N/m,
    under a preload by a constant force with the rings free along the axis; axial_stiffness: with the ring held in x and
    y, N/m."""

    displacement: Array
    force: Array
    stiffness: Array
    axial_stiffness: float
    balls: Balls


def at_displacement(bearing: BallBearing, place: Array, omega: float, cage: float = 0.0) -> RestingRings:
    """The bearing with its inner ring at a place (2,) in m, at omega rad/s and an angle of the cage in rad."""
    data = joined([bearing])
    row = scratch(data)[0]
    x, y = float(place[0]), float(place[1])
    f_x, f_y, *k = ball_bearing_force(data, 0, x, y, omega, cage, row)
    z = float(data.preload[0] if data.held[0] else row[0, 0])
    sums = rings(data, 0, x, y, z, omega, cage, row)
    force = np.array([f_x, f_y, -sums[2]])
    return RestingRings(np.array([x, y, z]), force, np.reshape(k, (2, 2)), sums[8], _balls(data, row, cage))


def _balls(data: BallBearings, row: Array, cage: float) -> Balls:
    """The balls that the kernel has left in its scratch row (1 + points, KNOWN)."""
    points = int(data.points[0])
    a, r, u, v = row[1 : 1 + points, :4].T
    inner, outer = np.hypot(a - u, r - v) - data.inner[0], np.hypot(u, v) - data.outer[0]
    inner_load, outer_load = (
        k[0] * np.where(each > ROUND, each, 0.0) ** 1.5 for k, each in ((data.k_inner, inner), (data.k_outer, outer))
    )
    inner_angle = np.where(inner_load > 0.0, np.arctan2(a - u, r - v), np.nan)
    outer_angle = np.where(outer_load > 0.0, np.arctan2(u, v), np.nan)
    around = BELOW + cage + 2.0 * math.pi * np.arange(points) / points
    return Balls(around, inner_angle, outer_angle, inner_load, outer_load)


def under_load(bearing: BallBearing, load: Array, omega: float, cage: float = 0.0) -> RestingRings:
    """The bearing under a load (2,) in N on the inner ring, at omega rad/s and an angle of the cage in rad.

    Newton's method on the displacement, from where the ring carries the load along its line; a step is halved until the
    imbalance falls. Raises NotConverged.
    """
    data = joined([bearing])
    row, size = scratch(data)[0], float(np.linalg.norm(load))
    place = np.zeros(2) if size == 0.0 else _along(data, row, load / size, size, omega, cage)
    step, least = np.zeros(2), math.inf
    for _ in range(STEPS):
        x, y = (place + step).tolist()
        f_x, f_y, *k = ball_bearing_force(data, 0, x, y, omega, cage, row)
        missed = load + np.array([f_x, f_y])
        left = float(np.linalg.norm(missed))
        if left >= least:
            step *= 0.5
            continue
        place, least = place + step, left
        stiffness = np.reshape(k, (2, 2))
        # along what carries nothing, as a ring within its clearance, it stays
        step = np.linalg.lstsq(stiffness, missed, rcond=1e-12)[0]
        if left <= SETTLED * size:
            break
    if least <= CARRIED * size:
        return at_displacement(bearing, place, omega, cage)
    raise NotConverged(f"A ball bearing does not carry {size:.4g} N: {least:.3g} N are left.")


def _along(data: BallBearings, row: Array, line: Array, size: float, omega: float, cage: float) -> Array:
    """(2,) place in m on a line at which the force against it is as large as the load."""
    low, high = 0.0, FIRST

    def carried(way: float) -> float:
        x, y = (way * line).tolist()
        f_x, f_y, *_ = ball_bearing_force(data, 0, x, y, omega, cage, row)
        return -float(line @ [f_x, f_y])

    while carried(high) < size:
        low, high = high, 2.0 * high
        if high > data.radial[0]:
            raise NotConverged(f"A ball bearing does not carry {size:.4g} N within its grooves.")
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if carried(middle) < size else (low, middle)
    return high * line
