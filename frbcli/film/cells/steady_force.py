"""Force and derivatives of a steady film on volumes: where a rotor rests and a run begins."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.balances import FLOWS, GridMotion, balances
from frbcli.film.cells.balance.boundaries import ALL
from frbcli.film.cells.balance.newton_step import film_loads
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    PRESSURE,
    STATES,
    TURNOVER,
    cell_states,
)
from frbcli.film.cells.block_cyclic import ENTRIES, solve_blocks
from frbcli.film.cells.cavity_edge import edge_slopes, gap_rise, set_edges
from frbcli.film.cells.data import AREA, BY_ITSELF, BY_X, BY_Y, SIDES
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.rectangles.film import FieldSlopes, FilmForce

SPEED_STEP = 1e-6  # share of the speed by which it is changed for a derivative
NEARLY = 1e-11  # residual over its terms that Newton's last step, which also tells the slopes, makes round-off
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
        solution = solver.steady(motion, start, enough=NEARLY)
    except FilmUnsolved:
        if start is None:
            raise
        solution = solver.steady(motion, enough=NEARLY)
    return settled_force(solver, motion, solution)


def settled_force(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """Force and derivatives, in SI units, of a steady film that a solver has solved but for Newton's last step, taken
    here, with the slopes of its field if it is mass-conserving. Where the edge of its cavity lies within cells, its
    sources follow the motion, too."""
    if solution.filling < ALL:
        return _force_at_flow(solver, motion, solution)
    film, data, (m, k), clearance = solver.film, solver.data, solution.w.shape, solver.film.section.clearance
    own, ring, width, cells = data.films[0], data.ring[0], data.width[0], data.cells[0]
    states, law, rise = np.zeros((STATES, m, k)), np.append(given_parameters(film.law), np.nan), gap_rise(film, motion)
    if solution.gas is not None:
        states[CARRIED_GAS], states[TURNOVER] = solution.gas.carried
    states[BEFORE_UPSTREAM] = solution.before

    def set_states(w: Array) -> None:
        cell_states(own, cells, law, 0.0, w, states)
        if film.edged:
            set_edges(film, rise, w, states)

    set_states(solution.w)
    stencil, by_place, by_rate, by_total = oil_slopes(own, ring, width, cells, states, motion)
    if film.edged:
        for slopes, source in zip((by_place, by_rate), edge_slopes(film, motion, states[PRESSURE]), strict=True):
            slopes -= cells[AREA][:, :, None] * source
    left = solver.left_over[:, :, None]
    fields = np.concatenate([np.zeros((m, k, k)), left, -by_place, -by_rate, -by_total], axis=2)
    solve_blocks(stencil, np.zeros((m, k, k)), fields, stencil[0, 0], fields[0, 0])
    change, moved, moving, faster = np.split(fields[:, :, k:], [1, 3, 5], axis=2)
    w = solution.w + change[:, :, 0]
    set_states(w)
    state = CellState(*states[:CARRIED_GAS])

    def pushed(changes: Array) -> Array:
        """(2, n) change of the force in N with up to two changes (m, k, n) of the field."""
        delta, count = np.zeros((m, k, k + SIDES)), changes.shape[2]
        delta[:, :, k + BY_X : k + BY_X + count] = changes
        return np.array(film_loads(own, ring, cells, states, delta)[2:]).reshape(2, 2)[:, :count]

    followed = None
    if not film.law.carries_gas:
        place, fraction = clearance * np.array(motion.d), state.fraction_slope
        followed = FieldSlopes(place, motion.omega, moved / clearance, faster[:, :, 0], fraction, pushed(faster)[:, 0])
    return FilmForce(
        np.array(force(film, film.mean_pressure(state))),
        pushed(moved) / clearance,
        pushed(moving) / clearance,
        w if solution.stages is None else solution.stages,
        None if film.edged else state.fraction,
        followed,
    )


def oil_slopes(
    own: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: Motion
) -> tuple[Array, Array, Array, Array]:
    """Derivatives of what leaves the cells of a settled film, see balances for the arguments: the stencil
    (ENTRIES, m, k) by their unknowns, and (m, k, 2) by the displacement and the velocity over the clearance, (m, k, 1)
    by omega_J + omega_S, in which it is linear but for artificial diffusion."""
    (m, k), (x, y) = states.shape[1:], motion.d
    stencil, nothing, step = np.zeros((ENTRIES, m, k)), np.zeros((m, k)), math.copysign(1.0, motion.omega)
    step = step * max(abs(motion.omega), 1.0) * (SPEED_STEP if own.diffuses else 1.0)

    def left(omega: float, g: float) -> Array:
        """(m, k, SIDES) what leaves the cells, and by a velocity of the journal that moves it by g of itself."""
        fields, at = np.zeros((m, k, k + SIDES)), GridMotion(x, y, omega, *motion.v, g=g)
        balances(own, ring, width, cells, states, at, nothing, stencil, fields, np.zeros(FLOWS))
        return -fields[:, :, k:]

    faster, both, here = left(motion.omega + step, 0.0), left(motion.omega, 1.0), left(motion.omega, 0.0)
    by_total = (faster - here)[:, :, [BY_ITSELF]] / step
    by_both, by_rate = (each[:, :, [BY_X, BY_Y]] for each in (both, here))
    return stencil, by_both - by_rate, by_rate, by_total


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
