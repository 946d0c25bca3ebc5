"""A finite-volume film linearised about its settled state, with the oil of its cells as a state of its own.

With the changes w of the cells' unknowns, d of the journal's place and d' of its velocity, the balances (3.9) are

    storage w' + flow w + by_place d + by_rate d' = 0,        F = push w,

in the frame at rest, where the settled film does not change. Of a journal that tilts, d holds its tilts, too
(tilted/linear.py). Journal and shell may also turn faster: the angle by which they turn together is then the last one
of d, of whose rate alone the film knows. Oil is carried upwind, whose derivatives are exact on neighbouring cells, and
laws with kinks count with the derivative on the side on which each cell is. Free gas that the oil carries is one more
state per cell, see gas/linear.py. Openings that take all that their supply gives are one more state of the film: the
filling of their line, see feed.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cells.balance.balances import FLOWS, SUPPLY_NET, GridMotion, balances, without_ends
from frbcli.film.cells.balance.feed import ALL
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    FRACTION_SLOPE,
    PRESSURE,
    PRESSURE_SLOPE,
    STATES,
    cell_states,
)
from frbcli.film.cells.data import AREA, BY_ITSELF, COS, GAP, LOAD, PUSH_X, PUSH_Y, SIDES, SIN, UNKNOWN
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.linear import linear_states
from frbcli.film.cells.loads import CavitationFactor, shear_weights
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.steady_force import film_at, oil_slopes

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

# Where the neighbours of a cell lie around and along, by the entries of the stencil.
NEIGHBOURS = ((CENTRE, 0, 0), (BEFORE, 1, 0), (BEHIND, -1, 0), (BELOW, 0, 1), (ABOVE, 0, -1))
STEP = 1e-5  # of the filling: balances are nearly linear in it


@dataclass(frozen=True)
class LinearFilm:
    """A film of n states at rest, see above, by c coordinates of its journal. SI units but for the cells' own: flow and
    storage (n, n) sparse; by_place (n, c) per m and rad; by_rate (n, c) by their rates; by_total (n,) by omega_J +
    omega_S; push (2 or 4, n) N and N m on the journal; sheared (n,): share of Couette's torque that missing oil leaves;
    field: of the settled film; ordered: whether the states are in the order of their elimination, each with its own
    equation."""

    flow: csc_matrix
    storage: csc_matrix
    by_place: Array
    by_rate: Array
    by_total: Array
    push: Array
    sheared: Array
    field: Array
    ordered: bool = False

    @cached_property
    def _both(self) -> csc_matrix:
        """(n, n) flow + i storage: the entries of both in one order, whose sum is wanted at many s."""
        return (self.flow + 1j * self.storage).tocsc()

    def at(self, s: complex) -> csc_matrix:
        """(n, n) flow + s storage, real where s is, which takes half as long to solve."""
        from scipy.sparse import csc_matrix

        both = self._both
        shifted = both.data.real + (s if s.imag else s.real) * both.data.imag
        return csc_matrix((shifted, both.indices, both.indptr), shape=both.shape)

    def turning(self) -> LinearFilm:
        """The film next to rings: the angle by which journal and shell turn together is one more coordinate, and the
        share of Couette's torque that missing oil leaves one more component of the force."""
        by_place = np.column_stack([self.by_place, np.zeros_like(self.by_total)])
        by_rate, push = np.column_stack([self.by_rate, self.by_total]), np.vstack([self.push, self.sheared])
        return replace(self, by_place=by_place, by_rate=by_rate, push=push)

    def in_plane(self) -> LinearFilm:
        """The film of a journal that keeps its direction."""
        return replace(self, by_place=self.by_place[:, :2], by_rate=self.by_rate[:, :2], push=self.push[:2])


def lying(film: VolumeFilm, share: float) -> VolumeFilm:
    """The film with its cells shifted around by a share of one cell."""
    phi, z, height = film.grid.phi, film.grid.z, film.grid.height
    grid = volume_grid(film.section, phi + share * 2.0 * math.pi / (len(phi) - 1), z, height)
    return VolumeFilm(film.section, grid, film.law, film.scales.reference, film.edged)


def linear_film(
    film: VolumeFilm, place: Array, total: float, start: Array | None = None, factor: CavitationFactor = "none"
) -> LinearFilm:
    """The film with its journal at rest at `place` (2,) in m. film: of a law whose forces are the pressures of its
    cells; total: omega_J + omega_S in rad/s; start: field to begin from; factor: how missing oil lowers the torque.
    Raises NotConverged."""
    clearance = film.section.clearance
    x, y = (place / clearance).tolist()
    at = film_at(film, math.hypot(x, y), total)
    motion, solver = Motion((x, y), (0.0, 0.0), total), FilmSolver(at)
    solution = solver.steady(motion, start, upwind=True)
    weights = shear_weights(at, motion, factor)
    if at.law.carries_gas:
        terms = linear_states(at, motion, solution, weights)
        moved = terms.by_place / clearance, terms.by_rate / clearance, terms.by_total
        return LinearFilm(terms.flow, terms.storage, *moved, terms.push, terms.sheared, solution.field, ordered=True)
    settled = _SettledCells(solver, motion, solution, weights)
    return settled.at_pressure() if solution.filling >= ALL else settled.at_flow()


def by_neighbours(stencil: Array) -> csc_matrix:
    """(n, n) what the entries (ENTRIES, m, k) of a stencil multiply."""
    from scipy.sparse import csc_matrix  # takes long to load

    number = np.arange(stencil[CENTRE].size).reshape(stencil[CENTRE].shape)
    columns = np.concatenate([np.roll(number, shift, (0, 1)).ravel() for _, *shift in NEIGHBOURS])
    entries = np.concatenate([stencil[entry].ravel() for entry, *_ in NEIGHBOURS])
    return csc_matrix((entries, (np.tile(number.ravel(), len(NEIGHBOURS)), columns)), shape=(number.size,) * 2)


class _SettledCells:
    """A settled finite-volume film, of which the derivatives are taken."""

    def __init__(self, solver: FilmSolver, motion: Motion, solution: VolumeSolution, weights: Array) -> None:
        """weights: see shear_weights."""
        self._solver, self._motion, self._solution, self._weights = solver, motion, solution, weights
        data = solver.data
        self._parts = data.films[0], data.ring[0], data.width[0], data.cells[0]
        self._law = np.append(given_parameters(solver.film.law), np.nan)
        self._states = np.zeros((STATES, *solution.w.shape))
        self._set_states()

    def at_pressure(self) -> LinearFilm:
        """The film with its openings as they are."""
        from scipy.sparse import diags  # takes long to load

        own, ring, _, cells = self._parts
        flow, by_place, by_rate, by_total = self._balances(own)
        clearance, (x, y) = self._solver.film.section.clearance, self._motion.d
        gap = ring[GAP] + x * ring[SIN] - y * ring[COS]
        storage = cells[UNKNOWN] * cells[AREA] * gap[:, None] * self._states[FRACTION_SLOPE]
        return LinearFilm(
            flow=flow,
            storage=diags(storage.ravel(), format="csc"),
            by_place=by_place / clearance,
            by_rate=by_rate / clearance,
            by_total=by_total,
            push=self._pushed(self._states[PRESSURE_SLOPE]).reshape(2, -1),
            sheared=(self._weights * self._states[FRACTION_SLOPE]).ravel(),
            field=self._solution.field,
        )

    def at_flow(self) -> LinearFilm:
        """The film with the filling of its supply's line as its last state: line filling' + outflow = given. What the
        openings take is what the cells get without flowing out at open ends."""
        from scipy.sparse import block_diag, bmat

        film, open_ = self.at_pressure(), self._parts[-1][UNKNOWN].ravel() != 0.0
        flow, by_place, *_ = self._balances(without_ends(self._parts[0]))
        outflow, clearance = -(open_ @ flow), self._solver.film.section.clearance
        by_filling, by_supply, push = self._by_filling()
        return LinearFilm(
            flow=bmat([[film.flow, by_filling.reshape(-1, 1)], [outflow.reshape(1, -1), [[by_supply]]]], "csc"),
            storage=block_diag([film.storage, [[self._parts[0].line]]], "csc"),
            by_place=np.vstack([film.by_place, -(open_ @ by_place) / clearance]),
            by_rate=np.vstack([film.by_rate, np.zeros((1, 2))]),
            by_total=np.append(film.by_total, -(open_ @ film.by_total)),
            push=np.column_stack([film.push, push]),
            sheared=np.append(film.sheared, 0.0),
            field=film.field,
        )

    def _set_states(self) -> None:
        own, _, _, cells = self._parts
        cell_states(own, cells, self._law, 0.0, self._solution.w, self._states)
        self._states[BEFORE_UPSTREAM] = self._solution.before

    def _balances(self, own: np.record) -> tuple[csc_matrix, Array, Array, Array]:
        """Derivatives of the balances of the n cells by their unknowns (n, n), by displacement and velocity over the
        clearance (n, 2), and by omega_J + omega_S (n,)."""
        stencil, *slopes = oil_slopes(own, *self._parts[1:], self._states, self._motion)
        by_place, by_rate, by_total = (each.reshape(stencil[CENTRE].size, -1) for each in slopes)
        return by_neighbours(stencil), by_place, by_rate, by_total.ravel()

    def _by_filling(self) -> tuple[Array, float, Array]:
        """Derivatives by the filling: of the balances (n,), of what the openings take, and of the force (2,) in N."""
        filling = self._solution.filling
        step = 0.5 * min(2.0 * STEP, abs(filling), ALL - filling)  # pressures have a kink at both

        def at(change: float) -> tuple[Array, ...]:
            own, ring, width, cells = self._parts
            self._solver.fill(filling + change)
            self._set_states()
            (m, k), (x, y), flows = self._solution.w.shape, self._motion.d, np.zeros(FLOWS)
            stencil, fields = np.zeros((ENTRIES, m, k)), np.zeros((m, k, k + SIDES))
            motion = GridMotion(x, y, self._motion.omega)
            balances(own, ring, width, cells, self._states, motion, np.zeros((m, k)), stencil, fields, flows)
            left = -fields[:, :, k + BY_ITSELF].ravel()
            return left, flows[SUPPLY_NET : SUPPLY_NET + 1], self._pushed(self._states[PRESSURE]).sum(axis=(1, 2))

        left, outflow, push = ((ahead - back) / (2.0 * step) for ahead, back in zip(at(step), at(-step), strict=True))
        return left, float(outflow[0]), push

    def _pushed(self, pressure: Array) -> Array:
        """(2, m, k) forces in N of the cells with scaled gauge pressures, or their derivatives."""
        own, ring, _, cells = self._parts
        weight = own.force_scale * cells[LOAD] * pressure
        return np.stack([ring[row][:, None] * weight for row in (PUSH_X, PUSH_Y)])
