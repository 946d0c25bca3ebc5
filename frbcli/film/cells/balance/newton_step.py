"""One step of Newton's method of a film with cells, and what it does per velocity of the journal, compiled."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cells.balance.balances import balances
from frbcli.film.cells.balance.faces import film_loads
from frbcli.film.cells.balance.states import FRACTION, cell_states, follow_law
from frbcli.film.cells.block_cyclic import CENTRE, solve_ring_at
from frbcli.film.cells.data import AREA, COS, GAP, MIDDLES, SIN, UNKNOWN, GridMotion, VolumeFilms, gap_along


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

    See balances for the arguments; the layer BEFORE_UPSTREAM of states is given. Returns the force on the journal (x,
    y) in N, and its derivatives (xx, xy, yx, yy) by the journal's velocities in N s.
    """
    film, ring, places, cells = films.films[f], films.ring[f], films.places[f], films.cells[f]
    law, spin = np.empty(LAW_NUMBERS), motion.spin
    v_x, v_y = motion.v_x - spin * motion.d_y, motion.v_y + spin * motion.d_x
    follow_law(film, motion.d_x, motion.d_y, v_x, v_y, motion.omega + 2.0 * spin, law)
    cell_states(film, cells, law, film.centrifugal * spin * spin, w, states)
    balances(film, ring, places, cells, states, motion, past, stencil, fields, flows)
    solve_ring_at(film.solver_at, stencil, blocks, fields)
    push, loads, slopes = np.empty((4, *w.shape)), np.empty(2), np.empty((2, 2))
    film_loads(film, ring, places, cells, states, fields, push, loads, slopes)
    return loads[0], loads[1], slopes[0, 0], slopes[0, 1], slopes[1, 0], slopes[1, 1]


@compiled()
def store_rates(
    ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, past: Array, fields: Array,
    rates: Array,
) -> None:  # fmt: skip
    """rates (m, k) <- of the oil H theta of each cell, by the flows that fields hold the balance of: what cells pass to
    each other is the same for both, so that no oil is lost however far the balance is from zero."""
    m, k = rates.shape
    for i in range(m):
        near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
        for j in range(k):
            rates[i, j], h = 0.0, near + places[MIDDLES, j] * rise
            if cells[UNKNOWN, i, j] != 0.0:
                rates[i, j] = h * states[FRACTION, i, j] / motion.g - past[i, j] + fields[i, j, k] / cells[AREA, i, j]
