"""Cells along the axis of runs under a journal that tilts, and the weights of their pressures in forces and moments.

The pressure is no parabola there, and is steepest at the ends where the gap is narrowest: cells are finer at the ends.
Their unknowns stand so that every face lies midway between two of them. The fall of the pressure from one to the next
is then that at the face for parabolas as well as for straight lines.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.balance.ends import end_slopes

CHEBYSHEV = 0.55  # share of Chebyshev's spacing: of 0.2 to 1 the most exact on 8 to 12 cells in the mean of 20 states
# Integrals of p, where -p'' = 1, and of (2 z - 1) p, where -p'' = 2 z - 1; p = 0 at the ends.
FORCE, MOMENT = 1.0 / 12.0, 1.0 / 180.0


def tilted_cells(along: int) -> tuple[Array, Array]:
    """(along + 1,) boundaries of cells over the width, and (along,) places of their unknowns.

    The places are the middles of cells between equal ones and Chebyshev's.
    """
    equal = np.linspace(0.0, 1.0, along + 1)
    spread = (1.0 - CHEBYSHEV) * equal + CHEBYSHEV * 0.5 * (1.0 - np.cos(np.pi * equal))
    height = 0.5 * (spread[1:] + spread[:-1])
    return np.array([0.0, *(0.5 * (height[1:] + height[:-1])), 1.0]), height


def tilted_weights(z: Array, height: Array) -> Array:
    """(k,) weights of the integral over [0, 1] of values at the places `height` (k,) of cells with the boundaries z.

    They start from parabolas through three places each, and are changed as little as it takes for the closed forms of a
    short bearing to hold on these cells: its force in translation, its moment in tilt, which is L^2 / 60 of it, and the
    integral of a constant. On the fewest cells the last ones of these are left out. """
    k, weights = len(height), _of_parabolas(z, height)
    if k < 3:
        return weights
    tilt = 2.0 * height - 1.0
    flat, tilting = np.linalg.solve(_conductances(height), (np.diff(z) * np.array([np.ones(k), tilt])).T).T
    rows, values = np.array([flat, tilt * tilting, np.ones(k)]), np.array([FORCE, MOMENT, 1.0])
    kept = slice((k + 1) // 2)  # as many as there are weights, which are symmetric
    size = np.sqrt(weights)
    change = np.linalg.lstsq(rows[kept] * size, values[kept] - rows[kept] @ weights, rcond=None)[0]
    return np.asarray(weights + size * change)


def _of_parabolas(z: Array, height: Array) -> Array:
    """(k,) weights of the parabolas through the place of each cell and its neighbours."""
    k = len(height)
    if k < 3:
        return np.diff(z)
    weights = np.zeros(k)
    for j in range(k):
        first = min(max(j - 1, 0), k - 3)
        powers = np.vander(height[first : first + 3] - height[j], 3, increasing=True)
        low, high = z[j] - height[j], z[j + 1] - height[j]
        weights[first : first + 3] += np.linalg.solve(powers.T, [(high**n - low**n) / n for n in (1, 2, 3)])
    return weights


def _conductances(height: Array) -> Array:
    """(k, k) what flows out of the cells of a column along a gap of 1 by their pressures."""
    k, steps = len(height), 1.0 / np.diff(height)
    matrix = np.zeros((k, k))
    for j, step in enumerate(steps):
        matrix[j : j + 2, j : j + 2] += step * np.array([[1.0, -1.0], [-1.0, 1.0]])
    for side, slope in zip((1, -1), end_slopes(height), strict=True):
        end, beyond = (0, 1) if side > 0 else (-1, -2)
        matrix[end, end] += slope.rise * (1.0 + slope.bend)
        matrix[end, beyond] -= slope.rise * slope.bend
    return matrix
