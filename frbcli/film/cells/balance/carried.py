"""The oil fraction that the surfaces carry through the faces of cells: of second order where it is smooth.

At a face it is theta_u + L(a, b): theta_u of the cell upstream of the face, a the difference from the cell before that
one, b the difference across the face. L = 0 (upwind) has an error of first order, which acts as a diffusion of the oil;
L = b / 2 is of second order, but overshoots at fronts. Between these chooses the limiter of van Albada,

    L = a b (a + b) / (2 (a^2 + b^2)) where a b > 0, else 0.

The oil fraction before the upstream cell is held at a guess while Newton's method solves: so the equations keep their
two neighbours around, and their derivatives are exact. Oil that is compressed is no part of it, see balances.py.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled

UPWIND = np.nan  # held in place of an oil fraction: L is 0 at that face


def before_upstream(theta: Array, omega: float) -> Array:
    """(m, k) oil fraction of the cell before the upstream one of the face after each cell, full at the most.

    theta: (m, k); omega: of what carries the oil, its sign counts."""
    loose = np.minimum(theta, 1.0)
    return np.roll(loose, 1, axis=0) if omega >= 0.0 else np.roll(loose, -2, axis=0)


def limited(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """L and its derivatives by a and b, in array notation."""
    smooth = a * b > 0.0
    size = np.where(smooth, a * a + b * b, 1.0)
    rise = a * b * (a + b)
    found = rise, b * (2.0 * a + b) - 2.0 * a * rise / size, a * (a + 2.0 * b) - 2.0 * b * rise / size
    value, by_a, by_b = (np.where(smooth, 0.5 * one / size, 0.0) for one in found)
    return value, by_a, by_b


@compiled()
def limited_at(a: float, b: float) -> tuple[float, float, float]:
    """L and its derivatives by a and b at one face, see `limited`."""
    if not a * b > 0.0:
        return 0.0, 0.0, 0.0
    half = 0.5 / (a * a + b * b)
    value = half * a * b * (a + b)
    return value, half * (b * (2.0 * a + b) - 4.0 * a * value), half * (a * (a + 2.0 * b) - 4.0 * b * value)


@compiled(inline=True)
def carried_at(t: float, t_n: float, before: float, forward: bool) -> tuple[float, float, float]:
    """The oil fraction that the surfaces carry through the face between a cell of the oil fraction t and the next one
    around, t_n, and its derivatives by both; before: see before_upstream. Of compressed oil it is the mean."""
    over, over_n = max(t - 1.0, 0.0), max(t_n - 1.0, 0.0)
    loose, loose_n = t - over, t_n - over_n
    upstream, across = (loose, loose_n - loose) if forward else (loose_n, loose - loose_n)
    more, by_before, by_across = limited_at(upstream - before, across)
    theta = upstream + more + 0.5 * (over + over_n)
    by_upstream = 1.0 + by_before - by_across
    here, next_ = (by_upstream, by_across) if forward else (by_across, by_upstream)
    return theta, 0.5 if t > 1.0 else here, 0.5 if t_n > 1.0 else next_
