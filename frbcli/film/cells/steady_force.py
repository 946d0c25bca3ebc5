"""Force and derivatives of a steady film on volumes: where a rotor rests and a run begins."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cells.balance.balances import BY_ITSELF, BY_X, BY_Y, FLOWS, SIDES, GridMotion, balances
from frbcli.film.cells.balance.feed import ALL
from frbcli.film.cells.balance.newton_step import film_loads, film_newton
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    PRESSURE,
    PRESSURE_SLOPE,
    STATES,
    TURNOVER,
    cell_states,
)
from frbcli.film.cells.cavity_edge import edge_slopes, set_edges
from frbcli.film.cells.data import AREA, LOAD, PUSH_X, PUSH_Y
from frbcli.film.cells.elimination.block_cyclic import ENTRIES, solve_blocks
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.grid import Array
from frbcli.film.rectangles.film import FieldSlopes, FilmForce

NUDGE = 1e-4  # of the gap, the pace and the filling, for derivatives of a film whose supply is limited
HELD, CARRIED = 1e-9, 1e9  # s: moved so little or so much by a velocity that one of the two derivatives is all there is


def film_at(film: VolumeFilm, eccentricity: float, omega: float) -> VolumeFilm:
    """The film with its law as it is at an eccentricity and a speed of a journal that does not whirl."""
    law = film.law.followed(eccentricity, omega)
    return film if law == film.law else VolumeFilm(film.section, film.grid, law, film.scales.reference, film.edged)


def steady_solution(film: VolumeFilm, motion: Motion, start: Array | None = None) -> VolumeSolution:
    """The steady film for a motion. Raises NotConverged."""
    return FilmSolver(film_at(film, math.hypot(*motion.d), motion.omega)).steady(motion, start)


def steady_force(
    film: VolumeFilm, displacement: Array, velocity: Array, omega: float, start: Array | None = None
) -> FilmForce:
    """Force and derivatives of a film whose oil has settled, in SI units. start: field of a motion near by, if
    one is known. Raises NotConverged."""
    c = film.section.clearance
    d, v = np.asarray(displacement) / c, np.asarray(velocity) / c
    motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
    solver = FilmSolver(film_at(film, math.hypot(*motion.d), omega))
    try:
        solution = solver.steady(motion, start)
    except FilmUnsolved:
        if start is None:
            raise
        solution = solver.steady(motion)
    return settled_force(solver, motion, solution)


def settled_force(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """Force and derivatives, in SI units, of a steady film that a solver has solved."""
    film, data = solver.film, solver.data
    if solution.filling < ALL:
        return _force_at_flow(solver, motion, solution)
    if film.edged:
        return _force_with_edges(solver, motion, solution)
    if film.law.keeps_oil and not film.law.carries_gas:
        return _force_with_oil(solver, motion, solution)
    c, (m, k) = film.section.clearance, film.grid.shape
    nothing, states = np.zeros((m, k)), np.zeros((STATES, m, k))
    states[BEFORE_UPSTREAM] = solution.before
    if solution.gas is not None:
        states[CARRIED_GAS], states[TURNOVER] = solution.gas.carried
    slopes = []
    for g in (CARRIED, HELD):
        scratch = np.zeros((ENTRIES, m, k)), np.zeros((m, k, k)), np.zeros((m, k, k + SIDES))
        values = film_newton(
            data, 0, solution.w.copy(), GridMotion(*motion.d, motion.omega, *motion.v, g=g), nothing, states, *scratch,
            np.zeros(FLOWS),
        )  # fmt: skip
        slopes.append(np.array(values[2:]).reshape(2, 2) / c)
    at = np.array(force(film, film.mean_pressure(solution.state)))
    return FilmForce(at, slopes[0] / CARRIED, slopes[1], solution.field, solution.state.fraction)


def _force_with_oil(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """See settled_force, of a film that keeps its oil, with the slopes of its field."""
    film, data, (m, k) = solver.film, solver.data, solution.w.shape
    own, ring, width, cells = data.films[0], data.ring[0], data.width[0], data.cells[0]
    states, law = np.zeros((STATES, m, k)), np.append(given_parameters(film.law), np.nan)
    cell_states(own, cells, law, 0.0, solution.w, states)
    states[BEFORE_UPSTREAM] = solution.before
    stencil, *slopes = oil_slopes(own, ring, width, cells, states, motion)
    fields = np.concatenate([np.zeros((m, k, k)), *(-each for each in slopes)], axis=2)
    solve_blocks(stencil, np.zeros((m, k, k)), fields, stencil[0, 0], fields[0, 0])
    by_place, by_rate, by_total = np.split(fields[:, :, k:], [2, 4], axis=2)
    by_place, by_rate = by_place / film.section.clearance, by_rate / film.section.clearance
    weight = own.force_scale * cells[LOAD] * states[PRESSURE_SLOPE]
    loads = np.stack([ring[push][:, None] * weight for push in (PUSH_X, PUSH_Y)])
    stiffness, damping, spun = (np.tensordot(loads, each) for each in (by_place, by_rate, by_total))
    place, fraction_slope = film.section.clearance * np.array(motion.d), solution.state.fraction_slope
    followed = FieldSlopes(place, motion.omega, by_place, by_total[:, :, 0], fraction_slope, spun[:, 0])
    at_rest = np.array(force(film, film.mean_pressure(solution.state)))
    return FilmForce(at_rest, stiffness, damping, solution.field, solution.state.fraction, followed)


def oil_slopes(
    own: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: Motion
) -> tuple[Array, Array, Array, Array]:
    """Derivatives of what leaves the cells of a film that keeps its oil, see balances for the arguments: the stencil
    (ENTRIES, m, k) by their unknowns, and (m, k, 2) by the displacement and the velocity over the clearance, (m, k, 1)
    by omega_J + omega_S, in which it is linear."""
    (m, k), (x, y) = states.shape[1:], motion.d
    stencil, nothing, step = np.zeros((ENTRIES, m, k)), np.zeros((m, k)), math.copysign(1.0, motion.omega)
    step = step * max(abs(motion.omega), 1.0)

    def left(omega: float, g: float) -> Array:
        """(m, k, SIDES) what leaves the cells, and by a velocity of the journal that moves it by g of itself."""
        fields, at = np.zeros((m, k, k + SIDES)), GridMotion(x, y, omega, g=g)
        balances(own, ring, width, cells, states, at, nothing, stencil, fields, np.zeros(FLOWS))
        return -fields[:, :, k:]

    by_total = (left(motion.omega + step, 0.0) - left(motion.omega, 0.0))[:, :, [BY_ITSELF]] / step
    by_both, by_rate = (left(motion.omega, g)[:, :, [BY_X, BY_Y]] for g in (1.0, 0.0))
    return stencil, by_both - by_rate, by_rate, by_total


def _force_with_edges(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """See settled_force, of a film with the edge of its cavity within cells, whose sources follow the motion, too."""
    film, data, (m, k) = solver.film, solver.data, solution.w.shape
    own, ring, width, cells = data.films[0], data.ring[0], data.width[0], data.cells[0]
    states, nothing, law = np.zeros((STATES, m, k)), np.zeros((m, k)), np.append(given_parameters(film.law), np.nan)
    cell_states(own, cells, law, 0.0, solution.w, states)
    set_edges(film, motion, solution.w, states)
    by_place, by_rate = edge_slopes(film, motion, states[PRESSURE])
    slopes = []
    for g in (CARRIED, HELD):
        stencil, blocks, fields = np.zeros((ENTRIES, m, k)), np.zeros((m, k, k)), np.zeros((m, k, k + SIDES))
        at = GridMotion(*motion.d, motion.omega, *motion.v, g=g)
        balances(own, ring, width, cells, states, at, nothing, stencil, fields, np.zeros(FLOWS))
        fields[:, :, [k + BY_X, k + BY_Y]] += cells[AREA][:, :, None] * (g * by_place + by_rate)
        solve_blocks(stencil, blocks, fields, stencil[0, 0], fields[0, 0])
        values = film_loads(own, ring, cells, states, fields)
        slopes.append(np.array(values[2:]).reshape(2, 2) / film.section.clearance)
    at_rest = np.array(force(film, film.mean_pressure(solution.state)))
    return FilmForce(at_rest, slopes[0] / CARRIED, slopes[1], solution.field)


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
        found = solver.filled(filling, there, solution.w)
        return np.array([*force(film, film.mean_pressure(found.state)), found.flows.supply])

    by_filling, *by_motion = (
        (at(number, size) - at(number, -size)) / (2.0 * size) for number, size in enumerate(sizes)
    )
    at_flow = [each[:2] - by_filling[:2] * each[2] / by_filling[2] for each in by_motion]
    here, slopes = np.array(force(film, film.mean_pressure(solution.state))), np.column_stack(at_flow) / c
    return FilmForce(here, slopes[:, :2], slopes[:, 2:], solution.w, solution.state.fraction)
