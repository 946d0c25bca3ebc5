"""A film with turning openings as the mean over their angle: fields on cells, clipped and integrated at every call.

Before it is clipped (3.29) the pressure is a sum of the fields of a unit w_r, of a unit w_t, and of the pressure given
at the openings. They are tabulated over the eccentricity for some angles of the openings to the line of centres. The
mean of the forces depends on eccentricity and motion alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.parabola import hermite
from frbcli.film.rectangles.table import DEPTH_STEP

FIELDS = 3  # of w_r, of w_t, of the given pressures


class MeanFilm(NamedTuple):
    """force_scale as in ShortFilm; level: scaled gauge pressure of the cavity, no pressure below it acting; drop: by
    which the share of the given pressures falls with the square of omega_J + omega_S, in s^2; table: (n, angles, k, 2
    FIELDS, m) fields of the lines of m cells around, and their derivatives by x = -ln(1 - eps); weights: (angles, 2, k,
    m) of the cells in the force along and across the line of centres."""

    force_scale: float
    level: float
    drop: float
    table: Array
    weights: Array


@compiled(inline=True)
def fields_at(
    low: Array, high: Array, i: int, h0: float, h1: float, h2: float, h3: float
) -> tuple[float, float, float]:
    """The fields of w_r, of w_t and of the given pressures in cell i, between two eccentricities of a table: low, high
    (2 FIELDS, m); h0 to h3: see hermite."""
    return (
        h0 * low[0, i] + h1 * high[0, i] + h2 * low[3, i] + h3 * high[3, i],
        h0 * low[1, i] + h1 * high[1, i] + h2 * low[4, i] + h3 * high[4, i],
        h0 * low[2, i] + h1 * high[2, i] + h2 * low[5, i] + h3 * high[5, i],
    )


@compiled(makes_arrays=True)
def mean_force(
    film: MeanFilm, eccentricity: float, w_r: float, w_t: float, omega: float,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Force and derivatives, see table_force.

    Between the middles of two cells pressure and weight are straight lines, and the integral of the part above the
    level is exact: so the force has continuous derivatives.
    """
    table, weights = film.table, film.weights
    angles, k, m = table.shape[1], table.shape[2], table.shape[4]
    x = -math.log(1.0 - eccentricity)
    cell = min(int(x / DEPTH_STEP), table.shape[0] - 2)
    a = x / DEPTH_STEP - cell
    (h0, h1, h2, h3), (s1, s2, s3) = hermite(a, DEPTH_STEP)
    scale = 1.0 / (1.0 - eccentricity)  # dx/deps
    s1, s2, s3 = s1 * scale, s2 * scale, s3 * scale
    given = max(0.0, 1.0 - film.drop * omega * omega)
    p, unit_r, unit_t, slope = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    sums = np.zeros((2, 4))  # along and across: force, by w_r, by w_t, by the eccentricity
    for j in range(angles):
        for line in range(k):
            low, high = table[cell, j, line], table[cell + 1, j, line]
            for i in range(m):
                r, t, g = fields_at(low, high, i, h0, h1, h2, h3)
                r_x = s1 * (high[0, i] - low[0, i]) + s2 * low[3, i] + s3 * high[3, i]
                t_x = s1 * (high[1, i] - low[1, i]) + s2 * low[4, i] + s3 * high[4, i]
                g_x = s1 * (high[2, i] - low[2, i]) + s2 * low[5, i] + s3 * high[5, i]
                unit_r[i], unit_t[i] = r, t
                p[i] = w_r * r + w_t * t + given * g - film.level
                slope[i] = w_r * r_x + w_t * t_x + given * g_x
            for c in range(2):
                own = weights[j, c, line]
                for i in range(m):
                    n = i + 1 if i + 1 < m else 0
                    by, by_n = _above(p[i], p[n], own[i], own[n])
                    sums[c, 0] += by * p[i] + by_n * p[n]
                    sums[c, 1] += by * unit_r[i] + by_n * unit_r[n]
                    sums[c, 2] += by * unit_t[i] + by_n * unit_t[n]
                    sums[c, 3] += by * slope[i] + by_n * slope[n]
    share = 1.0 / angles
    return (
        share * sums[0, 0], share * sums[1, 0], share * sums[0, 1], share * sums[0, 2], share * sums[1, 1],
        share * sums[1, 2], share * sums[0, 3], share * sums[1, 3],
    )  # fmt: skip


@compiled(inline=True)
def _above(p: float, q: float, u: float, v: float) -> tuple[float, float]:
    """The derivatives by p and q of the integral over 0 <= s <= 1 of max(p + (q - p) s, 0) (u + (v - u) s). It is of
    first degree in (p, q), so that it is their sum times p and q."""
    if p >= 0.0 and q >= 0.0:
        return u / 3.0 + v / 6.0, u / 6.0 + v / 3.0
    if p <= 0.0 and q <= 0.0:
        return 0.0, 0.0
    if p > 0.0:
        e = p / (p - q)
        by_q = e * e * (0.5 * u + (v - u) * e / 3.0)
        return e * (u + 0.5 * (v - u) * e) - by_q, by_q
    e = q / (q - p)
    by_p = e * e * (0.5 * v + (u - v) * e / 3.0)
    return by_p, e * (v + 0.5 * (u - v) * e) - by_p
