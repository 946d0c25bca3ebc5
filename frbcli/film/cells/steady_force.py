"""Force and derivatives of a steady film on volumes: where a rotor rests and a run begins."""

from __future__ import annotations

import math

import numpy as np

from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cells.balances import FLOWS, SIDES
from frbcli.film.cells.block_cyclic import ENTRIES
from frbcli.film.cells.data import BY_ECCENTRICITY_AND_SPEED, STANDS, volume_films
from frbcli.film.cells.newton_step import film_newton
from frbcli.film.cells.plain.balance import Motion
from frbcli.film.cells.plain.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.plain.loads import force
from frbcli.film.cells.states import STATES
from frbcli.film.grid import Array
from frbcli.film.rectangles.bearing import FilmForce

HELD, CARRIED = 1e-9, 1e9  # s: moved so little or so much by a velocity that one of the two derivatives is all there is


def film_at(film: VolumeFilm, follows: int, eccentricity: float, omega: float) -> VolumeFilm:
    """The film with its penalty's parameters at an eccentricity and a speed, see law_parameters."""
    law = film.law
    if follows == STANDS or not isinstance(law, Penalty):
        return film
    rate = max(abs(omega), 1.0) if follows == BY_ECCENTRICITY_AND_SPEED else 1.0
    steepness = law.steepness * 10.0 ** (-2.0 * eccentricity) / rate
    followed = Penalty(law.prefactor * rate, steepness)
    return VolumeFilm(film.section, film.grid, followed, film.scales.reference)


def steady_solution(film: VolumeFilm, follows: int, motion: Motion, start: Array | None = None) -> VolumeSolution:
    """The steady film for a motion. Raises NotConverged."""
    return film_at(film, follows, math.hypot(*motion.d), motion.omega).steady(motion, start)


def steady_force(
    film: VolumeFilm, follows: int, displacement: Array, velocity: Array, omega: float, start: Array | None = None
) -> FilmForce:
    """As film.bearing.evaluate, for a film whose oil has settled. Raises NotConverged."""
    c = film.section.clearance
    d, v = np.asarray(displacement) / c, np.asarray(velocity) / c
    motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
    solution = steady_solution(film, follows, motion, start)
    data = volume_films([film_at(film, follows, math.hypot(*motion.d), omega)])
    m, k = film.grid.shape
    nothing = np.zeros((m, k))
    slopes = []
    for g in (CARRIED, HELD):
        scratch = np.zeros((STATES, m, k)), np.zeros((ENTRIES, m, k)), np.zeros((m, k, k)), np.zeros((m, k, k + SIDES))
        values = film_newton(
            data.numbers[0], data.ring[0], data.width[0], data.cells[0], solution.w.copy(), *motion.d, omega, 0.0,
            nothing, g, *motion.v, 0.0, *scratch, np.zeros(FLOWS),
        )  # fmt: skip
        slopes.append(np.array(values[2:]).reshape(2, 2) / c)
    at = np.array(force(film, film.pressure(solution.state)))
    return FilmForce(at, slopes[0] / CARRIED, slopes[1])
