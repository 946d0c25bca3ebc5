"""The half-Sommerfeld (Guembel) condition (3.29): the pressure below the cavitation pressure is replaced by it.

The clipped pressure is integrated exactly along phi: where a quadratic element changes sign its root is the limit of
the integral. Forces are then continuously differentiable, and their derivatives are integrals over the same region.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.parabola import parabola_roots
from frbcli.film.rectangles.modal import GAUSS_POINTS, GAUSS_WEIGHTS, SHAPE, element_lengths, gauss_angles


def force_weights(vertices: Array) -> Array:
    """(2, 3, m) integrals of each element's shape functions times cos(Theta) and sin(Theta)."""
    angles = gauss_angles(vertices)
    shares = element_lengths(vertices)[:, None] * GAUSS_WEIGHTS
    return np.stack([SHAPE @ (shares * np.cos(angles)).T, SHAPE @ (shares * np.sin(angles)).T])


@compiled()
def _roots(p0: float, p1: float, p2: float) -> tuple[float, float]:
    """The two crossing points of the quadratic through p0, p1, p2 at 0, 1/2, 1, ascending; 2.0 where there is none."""
    a, b = 2.0 * (p0 - 2.0 * p1 + p2), -3.0 * p0 + 4.0 * p1 - p2
    first, second = parabola_roots(a, b, p0)
    if not 0.0 < first < 1.0:
        first = 2.0
    if not 0.0 < second < 1.0:
        second = 2.0
    return min(first, second), max(first, second)


@compiled()
def clipped_line(fields: Array, level: float, vertices: Array, lengths: Array, weights: Array, result: Array) -> None:
    """Integrals over one turn at one axial position, over the region where the pressure fields[0] exceeds the level.

    fields: (r, 2 m) nodal values: the pressure, then its derivatives; result (r, 2) += integrals of (fields[0] - level)
    and of each derivative times cos(Theta), sin(Theta).
    """
    m, r = lengths.shape[0], fields.shape[0]
    for e in range(m):
        i0, i1, i2 = 2 * e, 2 * e + 1, (2 * e + 2 if e + 1 < m else 0)
        p0, p1, p2 = fields[0, i0] - level, fields[0, i1] - level, fields[0, i2] - level
        if p0 <= 0.0 and p1 <= 0.0 and p2 <= 0.0:
            continue
        if p0 >= 0.0 and p1 >= 0.0 and p2 >= 0.0:
            for c in range(2):
                w0, w1, w2 = weights[c, 0, e], weights[c, 1, e], weights[c, 2, e]
                result[0, c] += w0 * p0 + w1 * p1 + w2 * p2
                for k in range(1, r):
                    result[k, c] += w0 * fields[k, i0] + w1 * fields[k, i1] + w2 * fields[k, i2]
            continue
        cut_element(fields, i0, i1, i2, p0, p1, p2, vertices[e], lengths[e], result)


@compiled()
def cut_element(
    fields: Array, i0: int, i1: int, i2: int, p0: float, p1: float, p2: float, start_angle: float, length: float,
    result: Array,
) -> None:  # fmt: skip
    """result += integrals over the part of one element where the quadratic through p0, p1, p2 is positive."""
    first, second = _roots(p0, p1, p2)
    middle = start_angle + 0.5 * length
    cos_middle, sin_middle = math.cos(middle), math.sin(middle)
    start = 0.0
    for piece in range(3):
        end = min(1.0, first if piece == 0 else (second if piece == 1 else 1.0))
        if end <= start:
            continue
        for g in range(3):
            xi = start + (end - start) * GAUSS_POINTS[g]
            n0, n1, n2 = (1 - xi) * (1 - 2 * xi), 4 * xi * (1 - xi), xi * (2 * xi - 1)
            pressure = n0 * p0 + n1 * p1 + n2 * p2
            if pressure <= 0.0:
                break  # the whole piece lies below the level
            share = GAUSS_WEIGHTS[g] * (end - start) * length
            # The angle from the middle is small: its series is exact to round-off and much quicker.
            a = (xi - 0.5) * length
            b = a * a
            cos_a = 1.0 - b / 2.0 * (1.0 - b / 12.0 * (1.0 - b / 30.0 * (1.0 - b / 56.0 * (1.0 - b / 90.0))))
            sin_a = a * (1.0 - b / 6.0 * (1.0 - b / 20.0 * (1.0 - b / 42.0 * (1.0 - b / 72.0))))
            cosine = share * (cos_middle * cos_a - sin_middle * sin_a)
            sine = share * (sin_middle * cos_a + cos_middle * sin_a)
            result[0, 0] += cosine * pressure
            result[0, 1] += sine * pressure
            for k in range(1, fields.shape[0]):
                value = n0 * fields[k, i0] + n1 * fields[k, i1] + n2 * fields[k, i2]
                result[k, 0] += cosine * value
                result[k, 1] += sine * value
        start = end
