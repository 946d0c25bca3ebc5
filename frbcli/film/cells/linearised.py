"""A film on cells linearised about its settled state, with the oil of its cells as a state of its own.

With the changes w of the cells' unknowns, d of the journal's place and d' of its velocity, the balances (3.9) are

    storage w' + flow w + by_place d + by_rate d' = 0,        F = push w,

in the frame at rest, where the settled film does not change. Oil is carried upwind, whose derivatives are exact on
neighbouring cells, and laws with kinks count with the derivative on the side on which each cell is. Free gas that the
oil carries is one more state per cell, see gas/linear.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cells.balance.balances import BY_X, BY_Y, FLOWS, SIDES, GridMotion, balances
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, FRACTION_SLOPE, PRESSURE_SLOPE, STATES, cell_states
from frbcli.film.cells.data import AREA, COS, GAP, LOAD, PUSH_X, PUSH_Y, SIN, UNKNOWN, volume_films
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.gas.linear import linear_states
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.steady_force import film_at
from frbcli.film.grid import Array

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

# Where the neighbours of a cell lie around and along, by the entries of the stencil.
NEIGHBOURS = ((CENTRE, 0, 0), (BEFORE, 1, 0), (BEHIND, -1, 0), (BELOW, 0, 1), (ABOVE, 0, -1))


@dataclass(frozen=True)
class LinearFilm:
    """A film of n states at rest, see above. SI units but for the cells' own: flow and storage (n, n) sparse;
    by_place (n, 2) per m; by_rate (n, 2) per m/s; push (2, n) N on the journal; field: of the settled
    film; ordered: whether the states stand in the order of their elimination, each with its own equation."""

    flow: csc_matrix
    storage: csc_matrix
    by_place: Array
    by_rate: Array
    push: Array
    field: Array
    ordered: bool = False


def lying(film: VolumeFilm, share: float) -> VolumeFilm:
    """The film on cells that lie by a share of one cell further around."""
    phi, z = film.grid.phi, film.grid.z
    grid = volume_grid(film.section, phi + share * 2.0 * math.pi / (len(phi) - 1), z)
    return VolumeFilm(film.section, grid, film.law, film.scales.reference)


def linear_film(film: VolumeFilm, place: Array, total: float, start: Array | None = None) -> LinearFilm:
    """The film with its journal at rest at `place` (2,) in m. film: of a law whose forces are the pressures of its
    cells; total: omega_J + omega_S in rad/s; start: field to begin from. Raises NotConverged."""
    from scipy.sparse import csc_matrix, diags  # takes long to load

    clearance = film.section.clearance
    x, y = (place / clearance).tolist()
    at = film_at(film, math.hypot(x, y), total)
    motion = Motion((x, y), (0.0, 0.0), total)
    solution = FilmSolver(at).steady(motion, start, upwind=True)
    if at.law.carries_gas:
        found = linear_states(at, motion, solution)
        moved = found.by_place / clearance, found.by_rate / clearance
        return LinearFilm(found.flow, found.storage, *moved, found.push, solution.field, ordered=True)
    data, (m, k) = volume_films([at]), film.grid.shape
    own, ring, width, cells = data.films[0], data.ring[0], data.width[0], data.cells[0]
    states, nothing = np.zeros((STATES, m, k)), np.zeros((m, k))
    cell_states(own, cells, np.append(given_parameters(at.law), np.nan), 0.0, solution.w, states)
    states[BEFORE_UPSTREAM] = solution.before
    stencil, fields = np.zeros((ENTRIES, m, k)), np.zeros((m, k, k + SIDES))

    def by_velocity(g: float) -> Array:
        """(n, 2) derivatives of the balances by a velocity of the journal that moves it by g of itself."""
        motion = GridMotion(x, y, total, g=g)
        balances(own, ring, width, cells, states, motion, nothing, stencil, fields, np.zeros(FLOWS))
        return -fields[:, :, [k + BY_X, k + BY_Y]].reshape(m * k, 2)

    by_rate = by_velocity(0.0)
    by_place = by_velocity(1.0) - by_rate
    number = np.arange(m * k).reshape(m, k)
    columns = np.concatenate([np.roll(number, shift, (0, 1)).ravel() for _, *shift in NEIGHBOURS])
    entries = np.concatenate([stencil[entry].ravel() for entry, *_ in NEIGHBOURS])
    gap = ring[GAP] + x * ring[SIN] - y * ring[COS]
    storage = cells[UNKNOWN] * cells[AREA] * gap[:, None] * states[FRACTION_SLOPE]
    weight = own.force_scale * cells[LOAD] * states[PRESSURE_SLOPE]
    return LinearFilm(
        flow=csc_matrix((entries, (np.tile(number.ravel(), len(NEIGHBOURS)), columns)), shape=(m * k, m * k)),
        storage=diags(storage.ravel(), format="csc"),
        by_place=by_place / clearance,
        by_rate=by_rate / clearance,
        push=np.stack([(ring[row][:, None] * weight).ravel() for row in (PUSH_X, PUSH_Y)]),
        field=solution.field,
    )
