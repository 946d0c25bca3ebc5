"""The bearings of tests/data/ball-bearing.csv; and a ball bearing as the minimum of one energy, with dense matrices of
all displacements and no elimination: the equations of frbcli/elements/ball_force.py, slow and easy to read."""

from dataclasses import dataclass
from math import radians

import numpy as np
from scipy.optimize import minimize

from frbcli.arrays import Array
from frbcli.elements.ball import BallBearing
from frbcli.elements.ball_force import BELOW, BallNumbers
from frbcli.materials import ROLLING

STEEL, NITRIDE = ROLLING["steel"], ROLLING["silicon nitride"]
A = BallBearing(8, 3.175e-3, 14e-3, radians(15.0), 0.53, 0.53, STEEL, STEEL, preload=60.0)
B = BallBearing(9, 4e-3, 18e-3, radians(25.0), 0.52, 0.53, NITRIDE, STEEL, preload=60.0)
MICROMETRE = 1e-6


@dataclass(frozen=True)
class PlainRings:
    """The bearing at rest. displacement: (3,) of the inner ring, m; places: (n, 2) u and v of the balls, m; force:
    (2,) on the inner ring, N; stiffness: (2, 2) -dF/dd under the preload, N/m; energy: of contacts, preload and
    centrifugal forces, J."""

    displacement: Array
    places: Array
    force: Array
    stiffness: Array
    energy: float


def solve_plain(of: BallNumbers, displacement: Array, omega: float, cage: float = 0.0) -> PlainRings:
    """The bearing at a displacement (x, y) in m and a speed in rad/s; cage: its angle in rad."""
    psi = BELOW + cage + 2.0 * np.pi * np.arange(of.points) / of.points
    free = np.arange(3 if of.held else 2, 3 + 2 * of.points)
    start = np.zeros(3 + 2 * of.points)
    start[:2], start[2] = displacement, of.preload if of.held else 0.0
    start[3::2], start[4::2] = 0.0, of.outer + MICROMETRE

    def at(q: Array) -> tuple[float, Array, Array]:
        everything = start.copy()
        everything[free] = start[free] + MICROMETRE * q
        return _energy(of, psi, everything, of.centrifugal * omega**2)

    scaled = minimize(
        lambda q: at(q)[0], np.zeros(len(free)), method="trust-exact",
        jac=lambda q: MICROMETRE * at(q)[1][free],
        hess=lambda q: MICROMETRE**2 * at(q)[2][np.ix_(free, free)],
        options={"gtol": 1e-15, "maxiter": 500},
    ).x  # fmt: skip
    for _ in range(3):  # beyond what differences of energies resolve
        _, gradient, matrix = at(scaled)
        scaled = scaled - np.linalg.lstsq(matrix[np.ix_(free, free)], gradient[free], rcond=None)[0] / MICROMETRE
    energy, gradient, matrix = at(scaled)
    inner, coupled = matrix[np.ix_(free, free)], matrix[free, :2]
    stiffness = matrix[:2, :2] - coupled.T @ np.linalg.lstsq(inner, coupled, rcond=None)[0]
    start[free] += MICROMETRE * scaled
    return PlainRings(start[:3], start[3:].reshape(-1, 2), -gradient[:2], stiffness, energy)


def _energy(of: BallNumbers, psi: Array, q: Array, centrifugal: float) -> tuple[float, Array, Array]:
    """Energy in J with its gradient and matrix by q = (x, y, z, u_0, v_0, u_1, ...)."""
    size = len(q)
    energy, gradient, matrix = -float(of.preload) * q[2] * (1 - of.held), np.zeros(size), np.zeros((size, size))
    gradient[2] -= of.preload * (1 - of.held)
    for j, angle in enumerate(psi):
        u, v = 3 + 2 * j, 4 + 2 * j
        energy -= of.share * centrifugal * q[v]
        gradient[v] -= of.share * centrifugal
        ring = np.zeros((2, size))
        ring[0, 2], ring[1, 0], ring[1, 1] = 1.0, np.cos(angle), np.sin(angle)
        ball = np.zeros((2, size))
        ball[0, u] = ball[1, v] = 1.0
        centre = np.array([of.axial, of.radial])
        for k, touch, slope, zero in (
            (of.k_outer, of.outer, ball, np.zeros(2)), (of.k_inner, of.inner, ring - ball, centre),
        ):  # fmt: skip
            line = zero + slope @ q
            length = np.hypot(*line)
            if length <= touch:
                continue
            normal, delta = line / length, length - touch
            energy += of.share * 0.4 * k * delta**2.5
            gradient += of.share * k * delta**1.5 * normal @ slope
            along, across = np.outer(normal, normal), np.eye(2) - np.outer(normal, normal)
            matrix += of.share * k * slope.T @ (1.5 * delta**0.5 * along + delta**1.5 / length * across) @ slope
    return energy, gradient, matrix
