"""A finite-volume film linearised about its settled state, with the oil of its cells as a state of its own.

With the changes w of the cells' unknowns, d of the journal's place and d' of its velocity, the balances (3.9) are

    storage w' + flow w + by_place d + by_rate d' = 0,        F = push w,

in the frame at rest, where the settled film does not change. Of a journal that tilts, d holds its tilts, too
(tilted_film.py). Journal and shell may also turn faster: the angle by which they turn together is then the last
one of d, of whose rate alone the film knows. Oil is carried upwind, whose derivatives are exact on neighbouring cells,
and laws with kinks count with the derivative on the side on which each cell is. Free gas that the oil carries is one
more state per cell, see gas/balance.py. Openings that take all that their supply gives are one more state of the film:
the filling of their line, see boundaries.py.

The dynamic stiffness Z(s) of mass-conserving films: -F = Z(s) d for a motion d exp(s t) of the journal.

F has c components, two forces and of a film that tilts two moments, d as many coordinates or one more, see LinearFilm.

    Z(s) = push (storage s + flow)^-1 (by_place + s by_rate)

of the linearised film. It is needed at many s, and smooth: a film is projected onto the changes of its oil at a few
frequencies, from the right and from the left, so that Z and its derivative are exact there (two-sided rational Krylov
projection: A. C. Antoulas, Approximation of Large-Scale Dynamical Systems, SIAM 2005, section 11.3).

Force and derivatives of a steady film on volumes: where a rotor rests and a run begins.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.balances import balances
from frbcli.film.cells.balance.boundaries import ALL
from frbcli.film.cells.balance.ends import FLOWS, SUPPLY_NET, without_ends
from frbcli.film.cells.balance.faces import press_cells
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    PRESSURE,
    PRESSURE_SLOPE,
    STATES,
    cell_states,
)
from frbcli.film.cells.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES, solve_blocks
from frbcli.film.cells.cavity_edge import edge_slopes
from frbcli.film.cells.data import ALL_SIDES, AREA, BY_ITSELF, BY_X, SIDES, UNKNOWN, seen_by_grid
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.balance import linear_states
from frbcli.film.cells.loads import CavitationFactor, force, pushed, pushing, shear_weights
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.rectangles.film import FieldSlopes, FilmForce

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


SPEED_STEP = 1e-6  # share of the speed by which it is changed for a derivative
# Of films that are followed: a step over the largest unknown below which their force serves to seek on, and the most
# steps to there.
FOLLOWED, STEPS = 1e-3, 6
NUDGE = 1e-4  # of the gap, the pace and the filling, for derivatives of a film whose supply is limited


def film_at(film: VolumeFilm, eccentricity: float, omega: float) -> VolumeFilm:
    """The film with its law as it is at an eccentricity and a speed of a journal that does not whirl."""
    law = film.law.followed(eccentricity, omega)
    return film if law == film.law else VolumeFilm(film.section, film.grid, law, film.scales.reference, film.edged)


def _solver(film: VolumeFilm, motion: Motion) -> FilmSolver:
    return FilmSolver(film_at(film, math.hypot(*motion.d), motion.omega), film)


def steady_solution(film: VolumeFilm, motion: Motion, start: Array | None = None) -> VolumeSolution:
    """The steady film for a motion. Raises NotConverged."""
    return _solver(film, motion).steady(motion, start)


def steady_force(
    film: VolumeFilm, displacement: Array, velocity: Array, omega: float, start: Array | None = None
) -> FilmForce:
    """Force and derivatives of a film whose oil has settled, in SI units. start: field of a motion near by, if
    one is known. Raises NotConverged."""
    c = film.section.clearance
    d, v = np.asarray(displacement) / c, np.asarray(velocity) / c
    motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
    solver = _solver(film, motion)
    if start is not None and (followed := _followed_force(solver, motion, start)) is not None:
        return followed
    try:
        solution = solver.steady(motion, start)
    except FilmUnsolved:
        if start is None:
            raise
        solution = solver.steady(motion)
    return settled_force(solver, motion, solution)


def _followed_force(solver: FilmSolver, motion: Motion, w: Array) -> FilmForce | None:
    """As settled_force, of a film that is followed from a field w near by: whoever seeks the motion asks again until
    nothing moves, so that it need not be solved to round-off before. None of films that have to be, and where its steps
    do not become small at once."""
    film = solver.film
    if not film.is_followed or any(motion.v) or motion.tilts:
        return None
    states, before = solver.states_at(motion, w), math.inf
    for _ in range(STEPS):
        changes, by_changes = film_changes(solver, motion, states)
        w = w + changes[:, :, 0]
        off = float(np.max(np.abs(changes[:, :, 0])) / np.max(np.abs(w)))
        if not off < before:
            return None
        states, before = solver.states_at(motion, w), off
        if off < FOLLOWED:
            return replace(_force(solver, motion, states, w, changes, by_changes), off=off)
    return None


def settled_force(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """Force and derivatives, in SI units, of a steady film that a solver has solved, with the slopes of its field if it
    is mass-conserving. Where the edge of its cavity lies within cells, its sources follow the motion, too."""
    if solution.filling < ALL:
        return _force_at_flow(solver, motion, solution)
    states = settled_states(solution)
    return _force(solver, motion, states, solution.field, *film_changes(solver, motion, states))


def _force(
    solver: FilmSolver, motion: Motion, states: Array, field: Array, changes: Array, by_changes: Array
) -> FilmForce:
    """Force and derivatives of a film with the states of its cells, see film_changes."""
    film, clearance, state = solver.film, solver.film.section.clearance, CellState(*states[:CARRIED_GAS])
    by_moved, by_moving, by_faster = np.split(by_changes, [2, 4], axis=1)
    followed = None
    if not film.law.carries_gas:
        place, moved = clearance * np.array(motion.d), changes[:, :, 1:3] / clearance
        followed = FieldSlopes(place, motion.omega, moved, changes[:, :, 5], state.fraction_slope, by_faster[:, 0])
    return FilmForce(
        np.array(force(film, film.mean_pressure(state))),
        by_moved / clearance,
        by_moving / clearance,
        field,
        None if film.edged else state.fraction,
        followed,
    )


def film_changes(solver: FilmSolver, motion: Motion, states: Array, tilts: bool = False) -> tuple[Array, Array]:
    """What changes in a film with the states (STATES, m, k) of its cells: its unknowns, (m, k, 2 c + 2), by a step of
    Newton's method, which is nothing in a settled film without memory, with the displacement over the clearance, its
    rate, and omega_J + omega_S; and with these the c loads, (c, 2 c + 1) in N and N s. c: the 2 of the displacement, or
    4 with its growth over the width, to which moments over the width belong; tilts: whether that counts."""
    film, data, (m, k) = solver.film, solver.data, states.shape[1:]
    own, ring, places, cells = data.films[0], data.ring[0], data.places[0], data.cells[0]
    stencil, net, by_place, by_rate, by_total = oil_slopes(own, ring, places, cells, states, motion, tilts)
    if film.edged:
        for slopes, source in zip((by_place, by_rate), edge_slopes(film, motion, states[PRESSURE]), strict=True):
            slopes -= cells[AREA][:, :, None] * source
    right = np.concatenate([net, by_place, by_rate, by_total], axis=2)
    fields = np.empty((m, k, k + right.shape[2]))
    np.negative(right, out=fields[:, :, k:])
    solve_blocks(stencil, np.empty((m, k, k)), fields, stencil[0, 0], fields[0, 0])
    changes, push = fields[:, :, k:], np.zeros((4, m, k))
    press_cells(own, ring, cells, states, np.zeros((m, k, k + SIDES)), push)
    by_cells = own.force_scale * push[:2] * states[PRESSURE_SLOPE]
    shares = (1.0, film.grid.height - 0.5)[: 1 + tilts]
    pushes = np.concatenate([share * by_cells for share in shares])
    return changes, np.tensordot(pushes, changes[:, :, 1:], 2)


def settled_states(solution: VolumeSolution) -> Array:
    """(STATES, m, k) of the cells of a solution."""
    states = np.zeros((STATES, *solution.w.shape))
    for layer, each in enumerate(fields(solution.state)):
        states[layer] = getattr(solution.state, each.name)
    states[BEFORE_UPSTREAM] = solution.before
    return states


def oil_slopes(
    own: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: Motion, tilts: bool = False
) -> tuple[Array, Array, Array, Array, Array]:
    """What leaves the cells of a film (m, k, 1), see balances for the arguments, and its derivatives: the stencil
    (ENTRIES, m, k) by their unknowns, and (m, k, c) by the displacement and the velocity over the clearance, (m, k, 1)
    by omega_J + omega_S, in which it is linear but for artificial diffusion. c, tilts: see film_changes."""
    m, k = states.shape[1:]
    stencil, nothing, step = np.zeros((ENTRIES, m, k)), np.zeros((m, k)), math.copysign(1.0, motion.omega)
    fields = np.empty((m, k, k + (ALL_SIDES if tilts else SIDES)))
    step = step * max(abs(motion.omega), 1.0) * (SPEED_STEP if own.diffuses else 1.0)

    def left(omega: float, g: float) -> Array:
        """(m, k, 1 + c) what leaves the cells, and by a velocity of the journal that moves it by g of itself."""
        at = seen_by_grid(replace(motion, omega=omega), g, tilts)
        balances(own, ring, places, cells, states, at, nothing, stencil, fields, np.zeros(FLOWS))
        sides: Array = -fields[:, :, k:]
        if not tilts:
            return sides
        net, near, far = sides[:, :, :BY_X], sides[:, :, BY_X:SIDES], sides[:, :, SIDES:]
        return np.concatenate([net, near + far, 0.5 * (far - near)], axis=2)

    faster, both, here = left(motion.omega + step, 0.0), left(motion.omega, 1.0), left(motion.omega, 0.0)
    net, by_rate = here[:, :, :1], here[:, :, 1:]
    return stencil, net, (both - here)[:, :, 1:], by_rate, (faster - here)[:, :, :1] / step


def _force_at_flow(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """See settled_force, of a film that takes what its supply gives: so it does when the journal moves, and the filling
    of its openings follows. By central differences of force and flow over the filling and the motion."""
    film, nudge = solver.film, NUDGE * (1.0 - math.hypot(*motion.d))
    c = film.section.clearance
    sizes = (NUDGE * max(abs(solution.filling), NUDGE), nudge, nudge, nudge * motion.rate, nudge * motion.rate)

    def at(number: int, change: float) -> Array:
        """(3,) force and flow with a change of filling, displacement or velocity."""
        moved = change * np.eye(len(sizes))[number]
        filling, (x, y), (v_x, v_y) = solution.filling + float(moved[0]), motion.d + moved[1:3], motion.v + moved[3:]
        there = replace(motion, d=(float(x), float(y)), v=(float(v_x), float(v_y)))
        changed = solver.filled(filling, there, solution.w)
        return np.array([*force(film, film.mean_pressure(changed.state)), changed.flows.supply])

    by_filling, *by_motion = (
        (at(number, size) - at(number, -size)) / (2.0 * size) for number, size in enumerate(sizes)
    )
    at_flow = [each[:2] - by_filling[:2] * each[2] / by_filling[2] for each in by_motion]
    here, slopes = np.array(force(film, film.mean_pressure(solution.state))), np.column_stack(at_flow) / c
    return FilmForce(here, slopes[:, :2], slopes[:, 2:], solution.w, solution.state.fraction)


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
    cells = linear_cells(solver, motion, solution, shear_weights(at, motion, factor))
    if solution.filling < ALL:
        cells = _with_filling(cells, solver, motion, solution)
    return replace(cells, by_place=cells.by_place / clearance, by_rate=cells.by_rate / clearance)


def linear_cells(
    solver: FilmSolver, motion: Motion, solution: VolumeSolution, weights: Array, tilts: bool = False
) -> LinearFilm:
    """The film that a solver has settled with its openings as they are, by the c coordinates of film_changes instead
    of SI units. weights: see shear_weights; tilts: whether the growth of the displacement over the width counts."""
    from scipy.sparse import diags  # takes long to load

    film, data, state = solver.film, solver.data, solution.state
    if film.law.carries_gas:
        return LinearFilm(*linear_states(film, motion, solution, weights, tilts), solution.field, ordered=True)
    parts = data.films[0], data.ring[0], data.places[0], data.cells[0]
    stencil, _, *slopes = oil_slopes(*parts, settled_states(solution), motion, tilts)
    by_place, by_rate, by_total = (each.reshape(solution.w.size, -1) for each in slopes)
    storage = np.where(film.grid.fixed, 0.0, film.grid.area * film.gaps(motion) * state.fraction_slope)
    shares = (1.0, film.grid.height - 0.5)[: 1 + tilts]
    unit = np.concatenate([share * pushing(film) for share in shares]).reshape(by_place.shape[1], -1)
    return LinearFilm(
        flow=by_neighbours(stencil),
        storage=diags(storage.ravel(), format="csc"),
        by_place=by_place,
        by_rate=by_rate,
        by_total=by_total.ravel(),
        push=unit * state.pressure_slope.ravel(),
        sheared=(weights * state.fraction_slope).ravel(),
        field=solution.field,
    )


def by_neighbours(stencil: Array) -> csc_matrix:
    """(n, n) what the entries (ENTRIES, m, k) of a stencil multiply."""
    from scipy.sparse import csc_matrix  # takes long to load

    number = np.arange(stencil[CENTRE].size).reshape(stencil[CENTRE].shape)
    columns = np.concatenate([np.roll(number, shift, (0, 1)).ravel() for _, *shift in NEIGHBOURS])
    entries = np.concatenate([stencil[entry].ravel() for entry, *_ in NEIGHBOURS])
    return csc_matrix((entries, (np.tile(number.ravel(), len(NEIGHBOURS)), columns)), shape=(number.size,) * 2)


def _with_filling(film: LinearFilm, solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> LinearFilm:
    """A film, see linear_cells, with the filling of its supply's line as its last state: line filling' + outflow =
    given. What the openings take is what the cells get without flowing out at open ends."""
    from scipy.sparse import block_diag, bmat

    data, states = solver.data, settled_states(solution)
    own, parts = data.films[0], (data.ring[0], data.places[0], data.cells[0])
    open_ = data.cells[0][UNKNOWN].ravel() != 0.0
    stencil, _, by_place, *_ = oil_slopes(without_ends(own), *parts, states, motion)
    outflow, by_place = -(open_ @ by_neighbours(stencil)), by_place.reshape(len(open_), -1)
    by_filling, by_supply, push = _by_filling(solver, motion, solution)
    return LinearFilm(
        flow=bmat([[film.flow, by_filling.reshape(-1, 1)], [outflow.reshape(1, -1), [[by_supply]]]], "csc"),
        storage=block_diag([film.storage, [[own.line]]], "csc"),
        by_place=np.vstack([film.by_place, -(open_ @ by_place)]),
        by_rate=np.vstack([film.by_rate, np.zeros((1, 2))]),
        by_total=np.append(film.by_total, -(open_ @ film.by_total)),
        push=np.column_stack([film.push, push]),
        sheared=np.append(film.sheared, 0.0),
        field=film.field,
    )


def _by_filling(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> tuple[Array, float, Array]:
    """Derivatives by the filling: of the balances (n,), of what the openings take, and of the force (2,) in N."""
    data, filling, states = solver.data, solution.filling, settled_states(solution)
    own, ring, places, cells = data.films[0], data.ring[0], data.places[0], data.cells[0]
    (m, k), law = solution.w.shape, np.append(given_parameters(solver.film.law), np.nan)
    step = 0.5 * min(2.0 * STEP, abs(filling), ALL - filling)  # pressures have a kink at both

    def at(change: float) -> tuple[Array, ...]:
        solver.fill(filling + change)
        cell_states(own, cells, law, 0.0, solution.w, states)
        flows, stencil, fields = np.zeros(FLOWS), np.zeros((ENTRIES, m, k)), np.zeros((m, k, k + SIDES))
        balances(own, ring, places, cells, states, seen_by_grid(motion), np.zeros((m, k)), stencil, fields, flows)
        left = -fields[:, :, k + BY_ITSELF].ravel()
        return left, flows[SUPPLY_NET : SUPPLY_NET + 1], np.array(pushed(solver.film, states[PRESSURE]))

    left, outflow, push = ((ahead - back) / (2.0 * step) for ahead, back in zip(at(step), at(-step), strict=True))
    return left, float(outflow[0]), push


ROUND_OFF = 1e-11  # of the largest: of directions in which vectors do not reach


@dataclass(frozen=True)
class DynamicStiffness:
    """Z(s) = place + s rate + sum of left_j (right_place_j + s right_rate_j) / (1 + s delay_j), in SI units.

    place, rate: (c, d) of what does not depend on the oil's memory; left: (c, r), right_place, right_rate: (r, d);
    delays: (r,) s of the oil."""

    place: Array
    rate: Array
    left: Complex
    right_place: Complex
    right_rate: Complex
    delays: Complex

    def at(self, s: complex) -> tuple[Complex, Complex]:
        """Z (c, d) at s in 1/s and its derivative by s."""
        share = 1.0 / (1.0 + s * self.delays)
        moved = self.right_place + s * self.right_rate
        slope = self.right_rate - (share * self.delays)[:, None] * moved
        z = self.place + s * self.rate + (self.left * share) @ moved
        return z, self.rate + (self.left * share) @ slope


def without_memory(stiffness: Array, damping: Array) -> DynamicStiffness:
    """The dynamic stiffness of a film of stiffness and damping (c, d)."""
    forces, coordinates = stiffness.shape
    left, right = np.zeros((forces, 0), dtype=complex), np.zeros((0, coordinates), dtype=complex)
    return DynamicStiffness(stiffness, damping, left, right, right, np.zeros(0, dtype=complex))


def weighted(parts: Sequence[tuple[DynamicStiffness, float]]) -> DynamicStiffness:
    """The sum of dynamic stiffnesses, each times its weight."""
    nothing = np.zeros_like(parts[0][0].place)
    return DynamicStiffness(
        sum((weight * part.place for part, weight in parts), nothing),
        sum((weight * part.rate for part, weight in parts), nothing),
        np.concatenate([weight * part.left for part, weight in parts], axis=1),
        np.concatenate([part.right_place for part, _ in parts]),
        np.concatenate([part.right_rate for part, _ in parts]),
        np.concatenate([part.delays for part, _ in parts]),
    )


def stiffness_at(film: LinearFilm, s: complex) -> Complex:
    """Z (c, d) at one s in 1/s, without a projection."""
    right, _ = _changes(film, s)
    return np.asarray(film.push @ right)


def dynamic_stiffness(film: LinearFilm, frequencies: Sequence[float]) -> DynamicStiffness:
    """Z of a film, exact at rest and at the frequencies in rad/s, above 0."""
    rights: list[Array] = []
    lefts: list[Array] = []
    for s in (0.0j, *(1j * frequency for frequency in frequencies)):
        for change, kept in zip(_changes(film, s), (rights, lefts), strict=True):
            kept += [change.real] if s == 0.0 else [change.real, change.imag]
    right, left = (_span(np.concatenate(kept, axis=1)) for kept in (rights, lefts))
    right, left = _filled(right, left), _filled(left, right)
    flow = left.T @ (film.flow @ right)
    storage = left.T @ (film.storage @ right)
    delays, shapes = np.linalg.eig(np.linalg.solve(flow, storage))
    moved = np.linalg.solve(flow, left.T @ np.concatenate([film.by_place, film.by_rate], axis=1))
    by_place, by_rate = np.split(np.linalg.solve(shapes, moved.astype(complex)), 2, axis=1)
    nothing = np.zeros((len(film.push), film.by_place.shape[1]))
    return DynamicStiffness(nothing, nothing, film.push @ right @ shapes, by_place, by_rate, delays.astype(complex))


def _changes(film: LinearFilm, s: complex) -> tuple[Complex, Complex]:
    """(n, d) changes of the cells for unit motions of the journal, and (n, c) what the force takes of their
    balances."""
    from scipy.sparse.linalg import splu  # takes long to load

    # Oil that leaves one cell enters others: the diagonal serves as pivot, as in block_cyclic.py, and the
    # order is the one for a symmetric matrix.
    matrix, at = film.at(s), s if s.imag else s.real
    solver = splu(
        matrix,
        permc_spec="NATURAL" if film.ordered else "MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    right = solver.solve((film.by_place + at * film.by_rate).astype(matrix.dtype))
    return right, solver.solve(film.push.T.astype(matrix.dtype), "T")


def _span(vectors: Array) -> Array:
    """(n, r) orthonormal basis of vectors (n, m). A film with few cells that are part-filled has few motions of its
    own, and vectors that are sums of others but for round-off lead nowhere."""
    size = np.linalg.norm(vectors, axis=0)
    basis, small = np.linalg.qr(vectors / np.where(size > 0.0, size, 1.0))
    turned, values, _ = np.linalg.svd(small)
    return np.asarray(basis @ turned[:, values > ROUND_OFF * values[0]])


def _filled(basis: Array, other: Array) -> Array:
    """The basis with as many vectors as the other one, the missing ones out of that."""
    missing = other.shape[1] - basis.shape[1]
    if missing <= 0:
        return basis
    rest, small = np.linalg.qr(other - basis @ (basis.T @ other))
    turned, _, _ = np.linalg.svd(small)
    return np.hstack([basis, rest @ turned[:, :missing]])
