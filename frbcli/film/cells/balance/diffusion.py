"""The artificial diffusion (4.42), (4.43) of the published two-phase form on finite volumes, compiled.

Equation (4.31) lets the pressure drive the flow (H^3 + c) grad p with c = gamma L beta f, beta = omega/2 H dtheta/dp,

    f = Pe / sqrt(9 + Pe^2),   Pe = L beta / (2 H^3),   gamma = 1/2,

L being the length of an element around. dtheta/dp is the slope of the chord between the two cells of a face, so that c
grad p becomes gamma L omega/2 H f times the fall of the oil fraction over their distance, without kinks within a
cavity. Oil that is compressed is no part of it: where the film is full, nothing diffuses. As published it acts around
and along alike. Along with it the surfaces carry the mean oil fraction of both cells: gamma = 1/2 keeps that from
overshooting as long as cells are no longer than L.

From grooves, holes and baths, which are full, diffusion brings oil into the film that nobody supplies: it is created.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.states import FRACTION, FRACTION_SLOPE, PRESSURE, PRESSURE_SLOPE
from frbcli.film.cells.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE
from frbcli.film.cells.data import (
    ALONG,
    AROUND,
    BATHED,
    BY_ITSELF,
    CLOSED,
    COS,
    EDGE,
    EDGES,
    FACE_COS,
    FACE_GAP,
    FACE_SIN,
    FED,
    FREE,
    GAP,
    LENGTH,
    MIDDLES,
    SIN,
    UNKNOWN,
    GridMotion,
    add_by_motion,
    gap_along,
)

GAMMA, PECLET = 0.5, 3.0  # of (4.42) and (4.43)


class Face(NamedTuple):
    """Between two cells. size: diffusion per gap H and fall of the oil fraction; unit: H^2 times the one of spread_at;
    z, by_ends: see add_by_motion; x, y: g times the sine and cosine of the angle; forth, back: entries of the stencil
    of either cell for the other."""

    size: float
    gap: float
    unit: float
    z: float
    by_ends: bool
    x: float
    y: float
    forth: int
    back: int


@compiled(inline=True)
def spread_at(
    t: float, t_n: float, p: float, p_n: float, by_t: float, by_t_n: float, by_p: float, by_p_n: float, unit: float
) -> tuple[float, float, float, float]:
    """f times the fall of the oil fraction from t to t_n at the pressures p and p_n, and its derivatives by the
    unknowns of both cells and by ln(unit).

    by_...: derivatives by the unknowns; unit: Pe over dtheta/dp."""
    loose, loose_n, steep = min(t, 1.0), min(t_n, 1.0), 0.0
    fall, by_t, by_t_n = loose - loose_n, by_t if t < 1.0 else 0.0, by_t_n if t_n < 1.0 else 0.0
    if p != p_n:
        steep = max(fall / (p - p_n), 0.0)
    elif by_p > 0.0:
        steep = by_t / by_p
    peclet = unit * steep
    root = math.sqrt(PECLET * PECLET + peclet * peclet)
    share, turn = peclet / root, peclet * PECLET * PECLET / (root * root * root)
    own, other = share * by_t + turn * (by_t - steep * by_p), share * by_t_n + turn * (by_t_n - steep * by_p_n)
    return share * fall, own, -other, turn * fall


@compiled()
def spread_oil(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, stencil: Array,
    right: Array,
) -> float:  # fmt: skip
    """Add the diffusion to the balances of a film with such a term and to their derivatives, see balances. Returns what
    it brings into the film from where the oil fraction is given."""
    (_, m, k), created, g, by_ends = states.shape, 0.0, motion.g, motion.by_ends
    reach = 0.5 * GAMMA * film.length * abs(motion.omega)
    for i in range(m):
        n = i + 1 if i + 1 < m else 0
        s, c = ring[FACE_SIN, i], ring[FACE_COS, i]
        near, rise = gap_along(ring[FACE_GAP, i], s, c, motion)
        for j in range(k):
            size, z = reach * (cells[AROUND, i, j] + cells[EDGE, i, j]), places[MIDDLES, j]
            face = Face(size, near + z * rise, reach / GAMMA, z, by_ends, g * s, g * c, BEHIND, BEFORE)
            created += _spread_between(cells, states, i, j, n, j, face, stencil, right)
    if film.spread == 0.0:
        return created
    for i in range(m):
        s, c = ring[SIN, i], ring[COS, i]
        near, rise = gap_along(ring[GAP, i], s, c, motion)
        for j in range(k - 1):
            size, z = reach * film.spread / film.aspect * cells[ALONG, i, j], places[EDGES, j + 1]
            face = Face(size, near + z * rise, reach / GAMMA, z, by_ends, g * s, g * c, ABOVE, BELOW)
            created += _spread_between(cells, states, i, j, i, j + 1, face, stencil, right)
        for far in (False, True):
            end, j = (film.far, k - 1) if far else (film.near, 0)
            full = 0.0 if end.kind == CLOSED else ring[BATHED, i] if end.kind == FREE else 1.0
            if full == 0.0 or cells[UNKNOWN, i, j] == 0.0:
                continue
            z = places[EDGES, k if far else 0]
            h = near + z * rise
            pressure, fraction = (film.share * end.pressure, film.fraction) if end.kind == FED else (0.0, 1.0)
            spread, own, _, by_unit = spread_at(
                states[FRACTION, i, j], fraction, states[PRESSURE, i, j], pressure, states[FRACTION_SLOPE, i, j], 0.0,
                states[PRESSURE_SLOPE, i, j], 0.0, reach / (GAMMA * h * h),
            )  # fmt: skip
            size = full * reach * film.spread * ring[LENGTH, i] * end.reach
            by_gap = size * (spread - 2.0 * by_unit)
            right[i, j, k + BY_ITSELF] -= size * h * spread
            add_by_motion(right, i, j, z, by_ends, -g * s * by_gap, g * c * by_gap)
            stencil[CENTRE, i, j] += size * h * own
            created -= size * h * spread
    return created


@compiled(inline=True)
def _spread_between(
    cells: Array, states: Array, i: int, j: int, n: int, q: int, face: Face, stencil: Array, right: Array
) -> float:
    """Add what goes from the cell (i, j) to the cell (n, q). Returns what comes from a cell whose oil fraction is given
    into one of the film."""
    size, h, unit, z, by_ends, x, y, forth, back = face
    spread, own, other, by_unit = spread_at(
        states[FRACTION, i, j], states[FRACTION, n, q], states[PRESSURE, i, j], states[PRESSURE, n, q],
        states[FRACTION_SLOPE, i, j], states[FRACTION_SLOPE, n, q], states[PRESSURE_SLOPE, i, j],
        states[PRESSURE_SLOPE, n, q], unit / (h * h),
    )  # fmt: skip
    flow, by_gap, k = size * h * spread, size * (spread - 2.0 * by_unit), states.shape[2]
    created = 0.0
    if cells[UNKNOWN, i, j] != 0.0:
        right[i, j, k + BY_ITSELF] -= flow
        add_by_motion(right, i, j, z, by_ends, -x * by_gap, y * by_gap)
        stencil[CENTRE, i, j] += size * h * own
        stencil[forth, i, j] += size * h * other
    else:
        created += flow
    if cells[UNKNOWN, n, q] != 0.0:
        right[n, q, k + BY_ITSELF] += flow
        add_by_motion(right, n, q, z, by_ends, x * by_gap, -y * by_gap)
        stencil[CENTRE, n, q] -= size * h * other
        stencil[back, n, q] -= size * h * own
    else:
        created -= flow
    return created
