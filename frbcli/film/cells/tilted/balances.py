"""The oil balances of a film whose gap changes along the axis, for its solver.

They are those in array notation, which take such a gap: no time loop asks for them, and in a test of one motion they
cost little beside the elimination.
"""

from __future__ import annotations

import numpy as np

from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.balances import (
    BY_ITSELF,
    CHANNELS_NET,
    ENDS_NET,
    FILLING,
    INFLOW,
    OUTFLOW,
    SUPPLY_NET,
)
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, CARRIED_GAS
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.motion import Motion, Storage
from frbcli.film.grid import Array


def tilted_balances(
    film: VolumeFilm, motion: Motion, states: Array, past: Array, stencil: Array, right: Array, flows: Array
) -> None:
    """Fill stencil, right and flows as `balances` does, without what is stored now; states: see there."""
    grid, k = film.grid, past.shape[1]
    balance = CellBalances(film.section, grid, motion, states[BEFORE_UPSTREAM])
    state = CellState(*states[:CARRIED_GAS])
    residual, entries = balance.residual(state, Storage(np.zeros((1, 1)), past))
    right[:] = 0.0
    right[:, :, k + BY_ITSELF] = -residual
    stencil[CENTRE], stencil[BEFORE], stencil[BEHIND] = entries.centre, entries.before, entries.behind
    stencil[BELOW], stencil[ABOVE] = entries.below, entries.above
    fluxes, _, _ = balance.fluxes(state.pressure, state.fraction)
    ends = np.concatenate([fluxes.near, fluxes.far])
    fed = fluxes.net_outflow(grid.share)[grid.fixed]
    share = grid.share
    taken = np.array([((share - np.roll(share, -1, axis=0)) * fluxes.carried).sum(), fluxes.excess.sum()])
    leaving, entering = np.concatenate([ends, -fed, taken]), np.concatenate([-ends, fed, -taken])
    flows[INFLOW], flows[OUTFLOW] = np.maximum(entering, 0.0).sum(), np.maximum(leaving, 0.0).sum()
    groove = float(fluxes.far.sum()) if film.section.far == "groove" else 0.0
    flows[ENDS_NET], flows[SUPPLY_NET] = ends.sum() - groove, fed.sum() - taken.sum() - groove
    flows[CHANNELS_NET] = flows[FILLING] = 0.0


def tilted_outflow(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> float:
    """Outflow of a solution through the open ends of a section in m^3/s."""
    section = film.section
    balance = CellBalances(section, film.grid, motion, solution.before)
    fluxes, _, _ = balance.fluxes(film.pressure(solution.state), solution.state.fraction)
    ends = fluxes.near if section.far == "groove" else np.concatenate([fluxes.near, fluxes.far])
    unit = section.radius * section.width * section.clearance
    return unit * float(np.maximum(ends, 0.0).sum())
