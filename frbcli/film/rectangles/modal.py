"""The Reynolds equation of a rectangular film, fast: axial modes times periodic quadratic elements in phi.

On a rectangular film H depends on phi alone. The generalised eigenvectors of the axial element matrices then split the
two-dimensional problem exactly into one small problem per mode k,

    d/dphi(H^3 dP_k/dphi) - (R/b)^2 lambda_k H^3 P_k = c_k (w . n),      P(phi, z) = sum_k P_k(phi) Z_k(z),

on the same quadratic elements. The middle nodes are condensed, the ends form a cyclic tridiagonal system.

The half-Sommerfeld (Guembel) condition (3.29): the pressure below the cavitation pressure is replaced by it.

The clipped pressure is integrated exactly along phi: where a quadratic element changes sign its root is the limit of
the integral. Forces are then continuously differentiable, and their derivatives are integrals over the same region.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.parabola import parabola_roots

GAUSS_POINTS = np.array([0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15)])
GAUSS_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
SHAPE = np.stack(
    [
        (1 - GAUSS_POINTS) * (1 - 2 * GAUSS_POINTS),
        4 * GAUSS_POINTS * (1 - GAUSS_POINTS),
        GAUSS_POINTS * (2 * GAUSS_POINTS - 1),
    ]
)  # (node, point)
SLOPE = np.stack([4 * GAUSS_POINTS - 3, 4 - 8 * GAUSS_POINTS, 4 * GAUSS_POINTS - 1])

NEARLY_CLOSED = 1e-3  # (R/b)^2 lambda below which round-off and quadrature of a load would move the mean pressure


class RingMatrices(NamedTuple):
    """Scratch of solve_ring on m elements with r right-hand sides: middle (m, 3) row of each element over its
    diagonal; diagonal, upper, cut (m,); condensed (m, r); local (3, 3)."""

    middle: Array
    diagonal: Array
    upper: Array
    cut: Array
    condensed: Array
    local: Array


def gauss_angles(vertices: Array) -> Array:
    """(m, 3) angles of the quadrature points of the m elements between the vertices (m,) of one turn."""
    angles: Array = vertices[:, None] + element_lengths(vertices)[:, None] * GAUSS_POINTS
    return angles


def element_lengths(vertices: Array) -> Array:
    """(m,) lengths of the elements between the vertices of one turn."""
    return np.diff(vertices, append=vertices[0] + 2 * math.pi)


@compiled()
def _element(length: float, cube: Array, decay: float, local: Array) -> None:
    """local (3, 3) <- matrix of d/dphi(H^3 d/dphi) - decay H^3 on one element; cube: H^3 at its three points."""
    for i in range(3):
        for j in range(3):
            entry = 0.0
            for g in range(3):
                entry += (
                    GAUSS_WEIGHTS[g]
                    * cube[g]
                    * (SLOPE[i, g] * SLOPE[j, g] / length + decay * length * SHAPE[i, g] * SHAPE[j, g])
                )
            local[i, j] = entry


@compiled()
def solve_ring(lengths: Array, cube: Array, decay: float, load: Array, ring: RingMatrices, pressure: Array) -> None:
    """Solve -d/dphi(H^3 dP/dphi) + decay H^3 P = load on the ring of m quadratic elements.

    lengths: (m,); cube: (m, 3) H^3 at the quadrature points; load: (r, m, 3) r right-hand sides at the element nodes
    (first end, middle, second end), already integrated. pressure (r, 2 m) <- ends at even indices, middles at odd.
    """
    m, r = lengths.shape[0], load.shape[0]
    middle, diagonal, upper, cut, condensed, local = ring
    for e in range(m):
        diagonal[e] = cut[e] = 0.0
        for k in range(r):
            condensed[e, k] = 0.0
    for e in range(m):
        _element(lengths[e], cube[e], decay, local)
        n = e + 1 if e + 1 < m else 0
        a, b = local[1, 0] / local[1, 1], local[1, 2] / local[1, 1]
        middle[e, 0], middle[e, 1], middle[e, 2] = a, 1.0 / local[1, 1], b
        diagonal[e] += local[0, 0] - local[0, 1] * a
        diagonal[n] += local[2, 2] - local[2, 1] * b
        upper[e] = local[0, 2] - local[0, 1] * b
        for k in range(r):
            condensed[e, k] += load[k, e, 0] - a * load[k, e, 1]
            condensed[n, k] += load[k, e, 2] - b * load[k, e, 1]
    # Cyclic tridiagonal, symmetric: the corner is split off by one rank (Sherman-Morrison).
    corner = upper[m - 1]
    gamma = -diagonal[0]
    diagonal[0] -= gamma
    diagonal[m - 1] -= corner * corner / gamma
    cut[0], cut[m - 1] = gamma, corner
    for e in range(1, m):
        factor = upper[e - 1] / diagonal[e - 1]
        diagonal[e] -= factor * upper[e - 1]
        cut[e] -= factor * cut[e - 1]
        for k in range(r):
            condensed[e, k] -= factor * condensed[e - 1, k]
    for e in range(m - 1, -1, -1):
        if e < m - 1:
            cut[e] -= upper[e] * cut[e + 1]
            for k in range(r):
                condensed[e, k] -= upper[e] * condensed[e + 1, k]
        cut[e] /= diagonal[e]
        for k in range(r):
            condensed[e, k] /= diagonal[e]
    scale = 1.0 / (1.0 + cut[0] + corner * cut[m - 1] / gamma)
    for k in range(r):
        part = (condensed[0, k] + corner * condensed[m - 1, k] / gamma) * scale
        for e in range(m):
            pressure[k, 2 * e] = condensed[e, k] - part * cut[e]
        for e in range(m):
            n = 2 * (e + 1) if e + 1 < m else 0
            pressure[k, 2 * e + 1] = (
                middle[e, 1] * load[k, e, 1] - middle[e, 0] * pressure[k, 2 * e] - middle[e, 2] * pressure[k, n]
            )


def unit_fields(vertices: Array, eccentricity: float, decays: Array, mode_loads: Array) -> Array:
    """Pressure of a unit radial and a unit tangential w, and their derivatives by the eccentricity, mode by mode.

    Frame of the line of centres: H = 1 + eps cos(Theta), right-hand sides cos(Theta) and sin(Theta), see (3.26).
    vertices: (m,); decays: (k,) (R/b)^2 lambda_k; mode_loads: (k,).
    Returns (4, k, 2 m): P_r, P_t, dP_r/deps, dP_t/deps.
    """
    m = len(vertices)
    lengths, angles = element_lengths(vertices), gauss_angles(vertices)
    cosine, sine = np.cos(angles), np.sin(angles)
    gap = 1.0 + eccentricity * cosine
    shares = lengths[:, None] * GAUSS_WEIGHTS
    load = -np.stack([(shares * cosine) @ SHAPE.T, (shares * sine) @ SHAPE.T])
    if decays.min() < NEARLY_CLOSED:  # nothing leaves at the ends: what the surfaces bring in, they take out again
        load -= load.sum(axis=(1, 2), keepdims=True) / (2.0 * math.pi) * (shares @ SHAPE.T)
    ring = RingMatrices(np.empty((m, 3)), np.empty(m), np.empty(m), np.empty(m), np.empty((m, 2)), np.empty((3, 3)))
    fields = np.empty((4, len(decays), 2 * m))
    work = np.empty((2, m, 3)), np.empty((2, m, 3)), np.empty((2, 2 * m))
    loads = np.ascontiguousarray(mode_loads)  # each layout has a kernel of its own
    _mode_fields(lengths, gap**3, 3.0 * gap**2 * cosine, decays, loads, load, ring, work, fields)
    return fields


@compiled()
def _mode_fields(
    lengths: Array, cube: Array, change: Array, decays: Array, mode_loads: Array, load: Array, ring: RingMatrices,
    work: tuple[Array, Array, Array], fields: Array,
) -> None:  # fmt: skip
    """fields <- fields as in unit_fields; change (m, 3): dH^3/deps at the quadrature points; load (2, m, 3) of a mode
    with a load of 1."""
    m = lengths.shape[0]
    own, defect, solution = work
    for k in range(decays.shape[0]):
        for s in range(2):
            for e in range(m):
                for i in range(3):
                    own[s, e, i] = mode_loads[k] * load[s, e, i]
        solve_ring(lengths, cube, decays[k], own, ring, solution)
        # K' P + K P' = 0: the load does not depend on the eccentricity.
        for e in range(m):
            _element(lengths[e], change[e], decays[k], ring.local)
            n = 2 * (e + 1) if e + 1 < m else 0
            for s in range(2):
                for i in range(3):
                    defect[s, e, i] = -(
                        ring.local[i, 0] * solution[s, 2 * e]
                        + ring.local[i, 1] * solution[s, 2 * e + 1]
                        + ring.local[i, 2] * solution[s, n]
                    )
        for s in range(2):
            for i in range(2 * m):
                fields[s, k, i] = solution[s, i]
        solve_ring(lengths, cube, decays[k], defect, ring, solution)
        for s in range(2):
            for i in range(2 * m):
                fields[2 + s, k, i] = solution[s, i]


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
