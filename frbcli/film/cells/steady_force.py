"""Force and derivatives of a steady film on volumes: where a rotor rests and a run begins."""

from __future__ import annotations

import math
from dataclasses import astuple, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import FilmUnsolved
from frbcli.film.cells.balance.balances import FLOWS, balances
from frbcli.film.cells.balance.boundaries import ALL
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    PRESSURE,
    PRESSURE_SLOPE,
    STATES,
)
from frbcli.film.cells.block_cyclic import ENTRIES, solve_blocks
from frbcli.film.cells.cavity_edge import edge_slopes
from frbcli.film.cells.data import ALL_SIDES, AREA, BY_ITSELF, BY_X, SIDES
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.tilted.loads import press_cells
from frbcli.film.cells.tilted.motion import seen_by_grid
from frbcli.film.rectangles.film import FieldSlopes, FilmForce

SPEED_STEP = 1e-6  # share of the speed by which it is changed for a derivative
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
    try:
        solution = solver.steady(motion, start)
    except FilmUnsolved:
        if start is None:
            raise
        solution = solver.steady(motion)
    return settled_force(solver, motion, solution)


def settled_force(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """Force and derivatives, in SI units, of a steady film that a solver has solved, with the slopes of its field if it
    is mass-conserving. Where the edge of its cavity lies within cells, its sources follow the motion, too."""
    if solution.filling < ALL:
        return _force_at_flow(solver, motion, solution)
    film, clearance = solver.film, solver.film.section.clearance
    changes, by_changes = film_changes(solver, motion, solution)
    moved, faster = changes[:, :, :2] / clearance, changes[:, :, 4]
    by_moved, by_moving, by_faster = np.split(by_changes, [2, 4], axis=1)
    followed = None
    if not film.law.carries_gas:
        place, fraction = clearance * np.array(motion.d), solution.state.fraction_slope
        followed = FieldSlopes(place, motion.omega, moved, faster, fraction, by_faster[:, 0])
    return FilmForce(
        np.array(force(film, film.mean_pressure(solution.state))),
        by_moved / clearance,
        by_moving / clearance,
        solution.field,
        None if film.edged else solution.state.fraction,
        followed,
    )


def film_changes(
    solver: FilmSolver, motion: Motion, solution: VolumeSolution, tilts: bool = False
) -> tuple[Array, Array]:
    """What changes with the displacement over the clearance, its rate, and omega_J + omega_S: the unknowns of a film
    that a solver has settled, (m, k, 2 c + 1), and the c loads, (c, 2 c + 1) in N and N s. c: the 2 of the
    displacement, or 4 with its growth over the width, to which moments over the width belong; tilts: whether that
    counts."""
    film, data, (m, k), states = solver.film, solver.data, solution.w.shape, settled_states(solution)
    own, ring, places, cells = data.films[0], data.ring[0], data.places[0], data.cells[0]
    stencil, by_place, by_rate, by_total = oil_slopes(own, ring, places, cells, states, motion, tilts)
    if film.edged:
        for slopes, source in zip((by_place, by_rate), edge_slopes(film, motion, states[PRESSURE]), strict=True):
            slopes -= cells[AREA][:, :, None] * source
    fields = np.concatenate([np.zeros((m, k, k)), -by_place, -by_rate, -by_total], axis=2)
    solve_blocks(stencil, np.zeros((m, k, k)), fields, stencil[0, 0], fields[0, 0])
    changes, push = fields[:, :, k:], np.zeros((4, m, k))
    press_cells(own, ring, cells, states, np.zeros((m, k, k + SIDES)), push)
    by_cells = own.force_scale * push[:2] * states[PRESSURE_SLOPE]
    shares = (1.0, film.grid.height - 0.5)[: 1 + tilts]
    return changes, np.tensordot(np.concatenate([share * by_cells for share in shares]), changes, 2)


def settled_states(solution: VolumeSolution) -> Array:
    """(STATES, m, k) of the cells of a solution."""
    states = np.zeros((STATES, *solution.w.shape))
    states[:CARRIED_GAS], states[BEFORE_UPSTREAM] = astuple(solution.state), solution.before
    return states


def oil_slopes(
    own: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: Motion, tilts: bool = False
) -> tuple[Array, Array, Array, Array]:
    """Derivatives of what leaves the cells of a settled film, see balances for the arguments: the stencil
    (ENTRIES, m, k) by their unknowns, and (m, k, c) by the displacement and the velocity over the clearance, (m, k, 1)
    by omega_J + omega_S, in which it is linear but for artificial diffusion. c, tilts: see film_changes."""
    m, k = states.shape[1:]
    stencil, nothing, step = np.zeros((ENTRIES, m, k)), np.zeros((m, k)), math.copysign(1.0, motion.omega)
    step = step * max(abs(motion.omega), 1.0) * (SPEED_STEP if own.diffuses else 1.0)

    def left(omega: float, g: float) -> Array:
        """(m, k, 1 + c) what leaves the cells, and by a velocity of the journal that moves it by g of itself."""
        fields = np.zeros((m, k, k + (ALL_SIDES if tilts else SIDES)))
        at = seen_by_grid(replace(motion, omega=omega), g, tilts)
        balances(own, ring, places, cells, states, at, nothing, stencil, fields, np.zeros(FLOWS))
        net, near, far = -fields[:, :, [k + BY_ITSELF]], -fields[:, :, k + BY_X : k + SIDES], -fields[:, :, k + SIDES :]
        return np.concatenate([net, near + far, 0.5 * (far - near)] if tilts else [net, near], axis=2)

    faster, both, here = left(motion.omega + step, 0.0), left(motion.omega, 1.0), left(motion.omega, 0.0)
    return stencil, (both - here)[:, :, 1:], here[:, :, 1:], (faster - here)[:, :, :1] / step


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
