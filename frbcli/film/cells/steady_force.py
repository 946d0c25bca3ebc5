"""Force and derivatives of a steady film on volumes: where a rotor rests and a run begins."""

from __future__ import annotations

import math

import numpy as np

from frbcli.errors import FilmUnsolved
from frbcli.film.cells.balance.balances import FLOWS, SIDES, GridMotion
from frbcli.film.cells.balance.newton_step import film_newton
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, CARRIED_GAS, STATES, TURNOVER
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.elimination.block_cyclic import ENTRIES
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.grid import Array
from frbcli.film.rectangles.film import FilmForce

HELD, CARRIED = 1e-9, 1e9  # s: moved so little or so much by a velocity that one of the two derivatives is all there is


def film_at(film: VolumeFilm, eccentricity: float, omega: float) -> VolumeFilm:
    """The film with its law as it is at an eccentricity and a speed of a journal that does not whirl."""
    law = film.law.followed(eccentricity, omega)
    return film if law == film.law else VolumeFilm(film.section, film.grid, law, film.scales.reference)


def steady_solution(film: VolumeFilm, motion: Motion, start: Array | None = None) -> VolumeSolution:
    """The steady film for a motion. Raises NotConverged."""
    return FilmSolver(film_at(film, math.hypot(*motion.d), motion.omega)).steady(motion, start)


def steady_force(
    film: VolumeFilm, displacement: Array, velocity: Array, omega: float, start: Array | None = None
) -> FilmForce:
    """Force and derivatives of a film whose oil has settled, in SI units. start: (m, k) field of a motion near by, if
    one is known. Raises NotConverged."""
    c = film.section.clearance
    d, v = np.asarray(displacement) / c, np.asarray(velocity) / c
    motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
    try:
        solution = steady_solution(film, motion, start)
    except FilmUnsolved:
        if start is None:
            raise
        solution = steady_solution(film, motion)
    return settled_force(film_at(film, math.hypot(*motion.d), omega), motion, solution)


def settled_force(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> FilmForce:
    """Force and derivatives of a steady film that is solved, in SI units."""
    data, c, (m, k) = volume_films([film]), film.section.clearance, film.grid.shape
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
    return FilmForce(at, slopes[0] / CARRIED, slopes[1], solution.w)
