"""One step of Newton's method of a film with cells, and what it does per velocity of the journal, compiled."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cells.balance.balances import GridMotion, balances
from frbcli.film.cells.balance.clipped import clipped_push
from frbcli.film.cells.balance.resting import rests
from frbcli.film.cells.balance.states import FRACTION, PRESSURE, PRESSURE_SLOPE, cell_states, follow_law
from frbcli.film.cells.block_cyclic import CENTRE, solve_ring_at
from frbcli.film.cells.data import (
    AREA,
    BETWEEN_MIDDLES,
    BY_ITSELF,
    BY_X,
    BY_Y,
    COS,
    GAP,
    LOAD,
    NO_CLIP,
    PUSH_X,
    PUSH_Y,
    SIN,
    UNKNOWN,
    VolumeFilms,
)


@compiled()
def film_loads(
    film: np.record, ring: Array, cells: Array, states: Array, delta: Array,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """Force on the journal with the changes delta (m, k, k + SIDES): (x, y) after the film's own change, and its
    derivatives (xx, xy, yx, yy) by the journal's velocities, in N and N s."""
    m, k = states.shape[1], states.shape[2]
    scale, cavity, clips = film.force_scale, film.scales.cavitation, film.clips != NO_CLIP
    if film.clips == BETWEEN_MIDDLES:
        f_x, f_y, xx, yx, xy, yy = clipped_push(film, ring, cells, states, delta, k + BY_X, k + BY_Y)
        return scale * f_x, scale * f_y, scale * xx, scale * xy, scale * yx, scale * yy
    f_x, f_y, xx, xy, yx, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(m):
        p, x, y = 0.0, 0.0, 0.0
        if rests(states, i):
            for j in range(k):
                p += cells[LOAD, i, j] * cavity
            f_x += ring[PUSH_X, i] * p
            f_y += ring[PUSH_Y, i] * p
            continue
        for j in range(k):
            weight, slope = cells[LOAD, i, j], states[PRESSURE_SLOPE, i, j]
            here = states[PRESSURE, i, j] + slope * delta[i, j, k + BY_ITSELF]
            if clips and here < cavity:
                p += weight * cavity
            else:
                p += weight * here
                x += weight * slope * delta[i, j, k + BY_X]
                y += weight * slope * delta[i, j, k + BY_Y]
        f_x += ring[PUSH_X, i] * p
        f_y += ring[PUSH_Y, i] * p
        xx += ring[PUSH_X, i] * x
        xy += ring[PUSH_X, i] * y
        yx += ring[PUSH_Y, i] * x
        yy += ring[PUSH_Y, i] * y
    return scale * f_x, scale * f_y, scale * xx, scale * xy, scale * yx, scale * yy


@compiled()
def imbalance(cells: Array, fields: Array) -> tuple[float, float]:
    """Residual in fields (m, k, k + SIDES), see balances, as a rate of the gap in 1/s: the mean over the
    cells, and the largest."""
    m, k = fields.shape[0], fields.shape[1]
    total, area, largest = 0.0, 0.0, 0.0
    for i in range(m):
        for j in range(k):
            left = abs(fields[i, j, k])
            total += left
            area += cells[AREA, i, j]
            largest = max(largest, left / cells[AREA, i, j])
    return total / area, largest


@compiled()
def damp(cells: Array, rate: float, stencil: Array) -> None:
    """Newton's equations with w stored in the cells over a pseudo-time step 1 / rate, see solver.py."""
    m, k = stencil.shape[1], stencil.shape[2]
    for i in range(m):
        for j in range(k):
            stencil[CENTRE, i, j] += rate * cells[UNKNOWN, i, j] * cells[AREA, i, j]


@compiled(makes_arrays=True)
def film_newton(
    films: VolumeFilms, f: int, w: Array, motion: GridMotion, past: Array, states: Array, stencil: Array,
    blocks: Array, fields: Array, flows: Array,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """One step of Newton's method of film f from the unknowns w (m, k): fields (m, k, k + SIDES) <- its changes.

    See balances for the arguments; the layer BEFORE_UPSTREAM of states is given. Returns film_loads.
    """
    film, ring, width, cells = films.films[f], films.ring[f], films.width[f], films.cells[f]
    law, spin = np.empty(LAW_NUMBERS), motion.spin
    v_x, v_y = motion.v_x - spin * motion.d_y, motion.v_y + spin * motion.d_x
    follow_law(film, motion.d_x, motion.d_y, v_x, v_y, motion.omega + 2.0 * spin, law)
    cell_states(film, cells, law, film.centrifugal * spin * spin, w, states)
    balances(film, ring, width, cells, states, motion, past, stencil, fields, flows)
    solve_ring_at(film.solver_at, stencil, blocks, fields)
    return film_loads(film, ring, cells, states, fields)


@compiled()
def store_rates(
    ring: Array, cells: Array, states: Array, d_x: float, d_y: float, g: float, past: Array, fields: Array,
    rates: Array,
) -> None:  # fmt: skip
    """rates (m, k) <- of the oil H theta of each cell, by the flows that fields hold the balance of: what cells pass to
    each other is the same for both, so that no oil is lost however far the balance is from zero."""
    m, k = rates.shape
    for i in range(m):
        h = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
        for j in range(k):
            rates[i, j] = 0.0
            if cells[UNKNOWN, i, j] != 0.0:
                rates[i, j] = h * states[FRACTION, i, j] / g - past[i, j] + fields[i, j, k] / cells[AREA, i, j]
