"""Forces of a film whose law makes oil, at one eccentricity, for many velocities. Compiled.

Seen from a frame that turns with half the speed, the balance of the cells is A p + load = q(p): the matrix A depends on
the gap alone, the load is linear in the velocity, and only the source q of a cell follows its own pressure. So the
equations are assembled once for an eccentricity, and Newton's method changes their diagonal scaling only.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import compiled_cell
from frbcli.film.cavitation.law import Scales
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES, solve_blocks

SETTLED = 2e-4  # of the largest pressure: a correction after which what is left is its square
PLAIN, DAMPING, LIMIT = 8, 0.5, 60  # iterations without damping; how it goes on from one to the next; all
# Layers of the states of the cells: pressure above p_cav and source, and their slopes by w.
ABOVE_CAVITY, SOURCE, RISE, FALL, LAYERS = range(5)
penalty_cell = compiled_cell(Penalty)


@compiled()
def _residual(stencil: Array, loads: Array, area: Array, v_r: float, v_t: float, cells: Array, right: Array) -> None:
    """The last layer of right (m, k, k + 1) <- minus what does not balance."""
    m, k = area.shape
    above = cells[ABOVE_CAVITY]
    for i in range(m):
        before, behind = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        for j in range(k):
            off = loads[0, i, j] + v_r * loads[1, i, j] + v_t * loads[2, i, j] - area[i, j] * cells[SOURCE, i, j]
            off += stencil[CENTRE, i, j] * above[i, j] + stencil[BEFORE, i, j] * above[before, j]
            off += stencil[BEHIND, i, j] * above[behind, j]
            if j > 0:
                off += stencil[BELOW, i, j] * above[i, j - 1]
            if j + 1 < k:
                off += stencil[ABOVE, i, j] * above[i, j + 1]
            right[i, j, k] = -off


@compiled()
def _matrix(stencil: Array, area: Array, cells: Array, damping: float, newton: Array) -> None:
    """newton (ENTRIES, m, k) <- Newton's matrix by w, which is kept back by the damping in 1/s."""
    m, k = area.shape
    rise = cells[RISE]
    for i in range(m):
        before, behind = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        for j in range(k):
            newton[CENTRE, i, j] = stencil[CENTRE, i, j] * rise[i, j] + area[i, j] * (damping - cells[FALL, i, j])
            newton[BEFORE, i, j] = stencil[BEFORE, i, j] * rise[before, j]
            newton[BEHIND, i, j] = stencil[BEHIND, i, j] * rise[behind, j]
            if j > 0:
                newton[BELOW, i, j] = stencil[BELOW, i, j] * rise[i, j - 1]
            if j + 1 < k:
                newton[ABOVE, i, j] = stencil[ABOVE, i, j] * rise[i, j + 1]


@compiled()
def _settle(
    law: Array, stencil: Array, loads: Array, area: Array, unit: float, velocity: tuple[float, float], w: Array,
    scratch: tuple[Array, Array, Array, Array],
) -> int:  # fmt: skip
    """w (m, k) <- unknowns, in units of `unit`, of the film that moves with the velocity; scratch: cells (LAYERS, m, k)
    <- its states, matrix, blocks and right sides of the equations. Returns the iterations, LIMIT if it has not
    settled."""
    m, k = w.shape
    v_r, v_t = velocity
    cells, newton, blocks, right = scratch
    parameters, scales = (law[0], law[1], law[2]), Scales(unit, 0.0, 0.0)
    speed = math.sqrt(v_r * v_r + v_t * v_t) + law[0]
    for iteration in range(LIMIT):
        largest, change = 0.0, 0.0
        for i in range(m):
            for j in range(k):
                p, _, q, p_w, _, q_w = penalty_cell(w[i, j], parameters, scales)
                change = max(change, abs(p - cells[ABOVE_CAVITY, i, j]))
                largest = max(largest, abs(p))
                cells[ABOVE_CAVITY, i, j], cells[SOURCE, i, j] = p, q
                cells[RISE, i, j], cells[FALL, i, j] = p_w, q_w
        if iteration > 0 and change < SETTLED * largest:
            return iteration
        _residual(stencil, loads, area, v_r, v_t, cells, right)
        _matrix(stencil, area, cells, speed * DAMPING ** (iteration - PLAIN) if iteration >= PLAIN else 0.0, newton)
        solve_blocks(newton, blocks, right, newton[0, 0], right[0, 0])
        for i in range(m):
            for j in range(k):
                w[i, j] += right[i, j, k]
    return LIMIT


@compiled(makes_arrays=True)
def row_forces(
    law: Array, unit: float, stencil: Array, loads: Array, area: Array, push: Array, width: Array,
    velocities: Array, forces: Array,
) -> int:  # fmt: skip
    """forces (d, l, 2) <- integrals of the pressure above p_cav for the velocities (d, l, 2).

    law: (3,) parameters of the penalty; unit: of w, next to the size of the velocity, 1/s; stencil, loads, area, push,
    width: of RowEquations. Along l velocities are best sorted by size, the largest first: each begins where the one
    before it has led. Returns the most iterations of one, LIMIT if it has not settled. """
    m, k = area.shape
    cells, newton = np.zeros((LAYERS, m, k)), np.zeros((ENTRIES, m, k))
    blocks, right = np.zeros((m, k, k)), np.zeros((m, k, k + 1))
    scratch = (cells, newton, blocks, right)
    w, begun, before = np.zeros((m, k)), np.zeros((m, k)), np.zeros((m, k))
    most = 0
    for a in range(velocities.shape[0]):
        for b in range(velocities.shape[1]):
            v_r, v_t = velocities[a, b, 0], velocities[a, b, 1]
            for i in range(m):
                for j in range(k):
                    now = w[i, j]
                    w[i, j] = begun[i, j] if b == 0 else now if b == 1 else 2.0 * now - before[i, j]
                    before[i, j] = now
            size = math.sqrt(v_r * v_r + v_t * v_t) + unit
            most = max(most, _settle(law, stencil, loads, area, size, (v_r, v_t), w, scratch))
            if b == 0:
                begun[:] = w
            f_r, f_t = 0.0, 0.0
            for i in range(m):
                p = 0.0
                for j in range(k):
                    p += width[j] * cells[ABOVE_CAVITY, i, j]
                f_r += push[0, i] * p
                f_t += push[1, i] * p
            forces[a, b, 0], forces[a, b, 1] = f_r, f_t
    return most
