"""Static equilibrium of a ball bearing, the loads of its balls there, and its basic rating life L10 from these loads.

ISO/TS 16281 (basic reference rating life), which is L10 = (C / P)^3 of ISO 281 for the distribution of loads that ISO
281 assumes: with gamma = d cos(alpha) / D, i rows of Z balls and

    rho = 1.044 ((1 - gamma) / (1 + gamma))^1.72 (f_i / f_o (2 f_o - 1) / (2 f_i - 1))^0.41
    Q_ci = C / (0.407 Z (i cos alpha)^0.7) (1 + rho^(10/3))^0.3
    Q_ce = C / (0.389 Z (i cos alpha)^0.7) (1 + rho^(-10/3))^0.3

a ring that turns bears the cubic mean of the loads, one that stands their mean with the power 10/3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.elements.rolling.bearing import BallBearing
from frbcli.elements.rolling.force import BELOW, KNOWN, RINGS, BallNumbers, ball_bearing_force, rings
from frbcli.errors import NotConverged

SETTLED, CARRIED = 1e-12, 1e-6  # of the load: what is left over at rest, and where steps no longer help
STEPS = 80
FIRST = 1e-6  # m, beyond which the place along a load's line is sought
ROUND = 1e-15  # m, below which a deflection is round-off of the places


@dataclass(frozen=True)
class Balls:
    """The balls of one row at rest. angles: from the x-axis, rad; inner_angle, outer_angle: contact angles in rad, NaN
    without contact; inner_load, outer_load: N. All but the angles (..., n)."""

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
    of, memory = bearing.numbers, bearing.memory
    x, y = float(place[0]), float(place[1])
    f_x, f_y, *k = ball_bearing_force(of, x, y, omega, cage, memory)
    z = of.preload if of.held else float(memory[0])
    sums = rings(of, x, y, z, omega, cage, memory)
    force = np.array([f_x, f_y, -sums[2]])
    return RestingRings(np.array([x, y, z]), force, np.reshape(k, (2, 2)), sums[8], balls_of(of, memory, cage))


def balls_of(of: BallNumbers, memory: Array, cage: float) -> Balls:
    """The balls that the kernel has left in its memory (..., w)."""
    known = memory[..., RINGS:].reshape(*memory.shape[:-1], of.points, KNOWN)
    a, r, u, v = np.moveaxis(known[..., :4], -1, 0)
    inner, outer = np.hypot(a - u, r - v) - of.inner, np.hypot(u, v) - of.outer
    inner_load, outer_load = (
        k * np.where(each > ROUND, each, 0.0) ** 1.5 for k, each in ((of.k_inner, inner), (of.k_outer, outer))
    )
    inner_angle = np.where(inner_load > 0.0, np.arctan2(a - u, r - v), np.nan)
    outer_angle = np.where(outer_load > 0.0, np.arctan2(u, v), np.nan)
    around = BELOW + cage + 2.0 * math.pi * np.arange(of.points) / of.points
    return Balls(around, inner_angle, outer_angle, inner_load, outer_load)


def under_load(bearing: BallBearing, load: Array, omega: float, cage: float = 0.0) -> RestingRings:
    """The bearing under a load (2,) in N on the inner ring, at omega rad/s and an angle of the cage in rad.

    Newton's method on the displacement, from where the ring carries the load along its line; a step is halved until the
    imbalance falls. Raises NotConverged.
    """
    of, memory, size = bearing.numbers, bearing.memory, float(np.linalg.norm(load))
    place = np.zeros(2) if size == 0.0 else _along(of, memory, load / size, size, omega, cage)
    step, least = np.zeros(2), math.inf
    for _ in range(STEPS):
        x, y = (place + step).tolist()
        f_x, f_y, *k = ball_bearing_force(of, x, y, omega, cage, memory)
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


def _along(of: BallNumbers, memory: Array, line: Array, size: float, omega: float, cage: float) -> Array:
    """(2,) place in m on a line at which the force against it is as large as the load."""
    low, high = 0.0, FIRST

    def carried(way: float) -> float:
        x, y = (way * line).tolist()
        f_x, f_y, *_ = ball_bearing_force(of, x, y, omega, cage, memory)
        return -float(line @ [f_x, f_y])

    while carried(high) < size:
        low, high = high, 2.0 * high
        if high > of.radial:
            raise NotConverged(f"A ball bearing does not carry {size:.4g} N within its grooves.")
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if carried(middle) < size else (low, middle)
    return high * line


STANDING, TURNING, WEIBULL = 10.0 / 3.0, 3.0, 0.9


def rating_life(bearing: BallBearing, balls: Balls, rating: float) -> float:
    """L10 in revolutions under the loads of the balls of each row; rating: C of the whole bearing in N. Infinite
    without a load."""
    gamma, f_i, f_o = bearing.gamma, bearing.inner, bearing.outer
    grooves = f_i / f_o * (2.0 * f_o - 1.0) / (2.0 * f_i - 1.0)
    rho = 1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * grooves**0.41
    each = rating / (bearing.balls * (bearing.rows * math.cos(bearing.contact_angle)) ** 0.7)
    inner = each / 0.407 * (1.0 + rho**STANDING) ** 0.3
    outer = each / 0.389 * (1.0 + rho**-STANDING) ** 0.3
    bears_inner = float(np.mean(balls.inner_load**TURNING)) ** (1.0 / TURNING)
    bears_outer = float(np.mean(balls.outer_load**STANDING)) ** (1.0 / STANDING)
    damage = bearing.rows * ((bears_inner / inner) ** STANDING + (bears_outer / outer) ** STANDING)
    return 1e6 * damage**-WEIBULL if damage > 0.0 else math.inf
