"""Films with the penalty (3.31), (3.32) at the nodes: Newton's method in an unknown that its steepness leaves alone."""

from __future__ import annotations

import math

from numba import njit

from frbcli.film.cavitation.compiled import wright_omega
from frbcli.film.quadratic.film import DIMENSIONLESS_PENALTY
from frbcli.film.quadratic.operator import subtract_flow, working_matrices
from frbcli.film.quadratic.ring import factorise
from frbcli.film.quadratic.ring_solve import solve

ITERATIONS = 60
TOLERANCE = 1e-6  # of a Newton step over the largest unknown; the next one would be about its square
SLOWEST = 1.0  # rad/s: the dimensionless pressure refers to a speed that must not vanish


@njit(cache=True, error_model="numpy")
def penalty_scales(film, eccentricity, omega):  # type: ignore[no-untyped-def]
    """a in 1/s and b in s of q = a exp(-b (P - P_cav)), (3.31) and (3.32)."""
    prefactor, steepness = film.prefactor, film.steepness * 10.0 ** (4.0 - 2.0 * eccentricity)
    if film.law == DIMENSIONLESS_PENALTY:
        speed = max(abs(omega), SLOWEST)
        return prefactor * speed, steepness / speed
    return prefactor, steepness


@njit(cache=True, error_model="numpy")
def solve_penalty(film, unknown, pressure, slope, w_x, w_y, omega, a, b):  # type: ignore[no-untyped-def]
    """Fill pressure (1, 2 a, 2 k + 1) and slope (2 a, 2 k + 1), b times the source; needs film.stiff.

    unknown (2 a, 2 k + 1): x - q(x) of x = P - P_cav, where Newton's method begins and what it ends with. Returns the
    number of its steps, 0 if they do not end. The ring keeps the factors of the last but one state, as far from the
    last as the tolerance.
    """
    right, p = pressure[0], pressure[0]
    start = math.log(a * b)
    step = pressure.copy()
    lines, places = unknown.shape
    for iteration in range(1, ITERATIONS + 1):
        right = step[0]
        for i in range(lines):
            for j in range(places):
                if film.fixed[i, j] > 0.0:
                    p[i, j] = film.given[i, j]
                    slope[i, j] = 0.0
                else:
                    target = unknown[i, j]
                    root = wright_omega(start - b * target)
                    slope[i, j] = root
                    p[i, j] = film.level + (target + root / b if root < 1.0 else (start - math.log(root)) / b)
                right[i, j] = (
                    omega * film.push[i, j] - w_x * film.moment[0, i, j] - w_y * film.moment[1, i, j]
                    + film.weight[i, j] * slope[i, j] / b
                )  # fmt: skip
        subtract_flow(film, p, right)
        working_matrices(film, slope)
        factorise(film.ring, film.working)
        solve(film.ring, step)
        largest, moved = 0.0, 0.0
        for i in range(lines):
            for j in range(places):
                if film.fixed[i, j] == 0.0:
                    change = (1.0 + slope[i, j]) * right[i, j]
                    unknown[i, j] += change
                    p[i, j] += right[i, j]
                    largest, moved = max(largest, abs(unknown[i, j])), max(moved, abs(change))
        if moved <= TOLERANCE * largest:
            return iteration
    return 0
