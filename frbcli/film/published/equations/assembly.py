"""Equation (4.31) on quadratic elements, compiled: residual, Newton's matrix, derivatives by the motion.

With the scaled gauge pressure P the weak form is, N being the shape functions and c the artificial diffusion,

    int N [H theta_t + omega/2 (H theta' P_phi + theta H_phi) + theta H_t] + N_phi (H^3 + c) P_phi
      + N_z (A H^3 + A_c c) P_z + int_ends N g(P) = 0,      A = (R/b)^2.

Columns of the matrix are multiplied by the derivative of the nodes' pressures by their unknowns.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.compiled import compiled
from frbcli.film.grid import Array
from frbcli.film.published.equations.law import Step, oil_fraction

GAMMA, PECLET = 0.5, 3.0  # of (4.42) and (4.43)
LARGEST_EXPONENT = 300.0  # of g on the way to a solution
EDGE_POINTS = 0.5 + 0.5 * math.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
EDGE_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
EDGE_VALUES = np.stack(
    [
        (2.0 * EDGE_POINTS - 1.0) * (EDGE_POINTS - 1.0),
        4.0 * EDGE_POINTS * (1.0 - EDGE_POINTS),
        (2.0 * EDGE_POINTS - 1.0) * EDGE_POINTS,
    ],
    axis=1,
)
DIRECTIONS = 4  # the derivatives are by d_x, d_y, v_x, v_y


class Elements(NamedTuple):
    """The elements of a section: nodes (e, 9); values (9, 9) and slopes (e, 9, 9, 2) of the shape functions; area (e,
    9) of the points; sine, cosine (e, 9) there; length (e,): of the elements around, rad; fixed (nodes,); solid (e,):
    not solved; near, far (e,): whether an end free to air is at z = 0, z = 1; aspect: A; spread: A_c, less than zero
    for no artificial diffusion at all; prefactor, exponent: of g = prefactor exp(exponent P)."""

    nodes: NDArray[np.int64]
    values: Array
    slopes: Array
    area: Array
    sine: Array
    cosine: Array
    length: Array
    fixed: NDArray[np.bool_]
    solid: NDArray[np.bool_]
    near: NDArray[np.bool_]
    far: NDArray[np.bool_]
    aspect: float
    spread: float
    prefactor: float
    exponent: float


class Gap(NamedTuple):
    """The gap at the points (e, 9): H, its slope by phi, its rate in 1/s; half: omega / 2 in rad/s."""

    height: Array
    slope: Array
    rate: Array
    half: float


@compiled()
def artificial_diffusion(length: float, half: float, height: float, steep: float) -> tuple[float, float, float]:
    """c of (4.42), (4.43) for an element's length, and its derivatives by theta' (steep) and by H."""
    unit = abs(half) * height
    beta = unit * steep
    peclet = 0.5 * length * beta / height**3
    root = math.sqrt(PECLET**2 + peclet**2)
    share, bend = peclet / root, PECLET**2 / root**3
    by_beta = GAMMA * length * (share + peclet * bend)
    by_height = GAMMA * length * beta / height * (share - 2.0 * peclet * bend)
    return GAMMA * length * beta * share, by_beta * unit, by_height


@compiled(fastmath={"contract", "reassoc"}, makes_arrays=True)
def assemble(
    elements: Elements,
    step: Step,
    gap: Gap,
    pressure: Array,
    slope: Array,
    rate: float,
    past: Array,
    matrix: Array,
    right: Array,
) -> None:
    """matrix (e, 9, 9) and right (e, 9, 1 or 5) <- Newton's matrix, minus the residual, minus its derivatives.

    pressure, slope: of the nodes, and their derivatives by the unknowns; theta_t = rate theta - past with past (e, 9).
    Rows of fixed nodes get a one on the diagonal.
    """
    values, nodes = elements.values, elements.nodes
    p = np.empty(9)
    by_value, by_around, by_along = np.empty(9), np.empty(9), np.empty(9)
    derived = right.shape[2] > 1
    for e in range(len(nodes)):
        m, r = matrix[e], right[e]
        m[:, :] = 0.0
        r[:, :] = 0.0
        if not elements.solid[e]:
            for a in range(9):
                p[a] = pressure[nodes[e, a]]
            for q in range(9):
                here = around = along = 0.0
                for a in range(9):
                    here += values[q, a] * p[a]
                    around += elements.slopes[e, q, a, 0] * p[a]
                    along += elements.slopes[e, q, a, 1] * p[a]
                theta, steep, bend = oil_fraction(step, here)
                h, h_slope, h_rate = gap.height[e, q], gap.slope[e, q], gap.rate[e, q]
                cube, area = h**3, elements.area[e, q]
                extra = by_steep = by_height = 0.0
                if elements.spread >= 0.0:
                    extra, by_steep, by_height = artificial_diffusion(elements.length[e], gap.half, h, steep)
                change = rate * theta - past[e, q]
                wide = elements.aspect * cube + elements.spread * extra
                source = h * change + gap.half * (h * steep * around + theta * h_slope) + theta * h_rate
                here_source = h * rate * steep + gap.half * (h * bend * around + steep * h_slope) + steep * h_rate
                here_spread = by_steep * bend
                for b in range(9):
                    value = area * values[q, b]
                    s_around, s_along = area * elements.slopes[e, q, b, 0], area * elements.slopes[e, q, b, 1]
                    by_value[b] = here_source * value + gap.half * h * steep * s_around
                    by_around[b] = here_spread * around * value + (cube + extra) * s_around
                    by_along[b] = elements.spread * here_spread * along * value + wide * s_along
                flow_around, flow_along = area * (cube + extra) * around, area * wide * along
                for a in range(9):
                    value, s_around, s_along = values[q, a], elements.slopes[e, q, a, 0], elements.slopes[e, q, a, 1]
                    r[a, 0] -= value * area * source + s_around * flow_around + s_along * flow_along
                    for b in range(9):
                        m[a, b] += value * by_value[b] + s_around * by_around[b] + s_along * by_along[b]
                if derived:
                    by_h = change + gap.half * steep * around
                    across = (3.0 * h * h + by_height) * around
                    axial = (3.0 * elements.aspect * h * h + elements.spread * by_height) * along
                    _by_motion(elements, e, q, by_h, across, axial, theta, gap.half, r)
            if elements.near[e]:
                _free_end(elements, e, 0, p, m, r)
            if elements.far[e]:
                _free_end(elements, e, 2, p, m, r)
        _by_unknowns(elements, e, slope, m, r)


@compiled(inline=True)
def _by_motion(
    elements: Elements, e: int, q: int, by_h: float, across: float, axial: float, theta: float, half: float, r: Array
) -> None:
    """Add the share of point q in minus the derivatives by the journal's displacement and velocity, by_h, across and
    axial being those of the source and of both flows by H."""
    area, sine, cosine = elements.area[e, q], elements.sine[e, q], elements.cosine[e, q]
    for a in range(9):
        value = area * elements.values[q, a]
        flow = area * (elements.slopes[e, q, a, 0] * across + elements.slopes[e, q, a, 1] * axial)
        by_slope = value * half * theta
        r[a, 1] -= (value * by_h + flow) * sine + by_slope * cosine
        r[a, 2] -= -(value * by_h + flow) * cosine + by_slope * sine
        r[a, 3] -= value * theta * sine
        r[a, 4] += value * theta * cosine


@compiled(inline=True)
def _by_unknowns(elements: Elements, e: int, slope: Array, m: Array, r: Array) -> None:
    """Derivatives by the pressures become those by the unknowns, and rows of fixed nodes say that these stay."""
    nodes = elements.nodes
    for a in range(9):
        if elements.fixed[nodes[e, a]]:
            r[a, :] = 0.0
            m[a, :] = 0.0
        for b in range(9):
            m[a, b] *= slope[nodes[e, b]]
        if elements.fixed[nodes[e, a]]:
            m[a, a] = 1.0


@compiled()
def _free_end(elements: Elements, e: int, place: int, p: Array, m: Array, r: Array) -> None:
    """Add the outflow (4.36), (4.37) through an end at the nodes 3 i + place."""
    for q in range(3):
        here = 0.0
        for a in range(3):
            here += EDGE_VALUES[q, a] * p[3 * a + place]
        weight = EDGE_WEIGHTS[q] * elements.length[e]
        outflow = elements.prefactor * math.exp(min(elements.exponent * here, LARGEST_EXPONENT))
        for a in range(3):
            r[3 * a + place, 0] -= weight * EDGE_VALUES[q, a] * outflow
            for b in range(3):
                slope = elements.exponent * outflow * EDGE_VALUES[q, b]
                m[3 * a + place, 3 * b + place] += weight * EDGE_VALUES[q, a] * slope
