"""Outflow of a finite-volume film at its open ends, for the balance of its heat; a groove is no open end. Compiled."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import falls_to_air, flow_at_end, section_end
from frbcli.film.cells.balance.grid_motion import GridMotion, seen_by_grid
from frbcli.film.cells.balance.states import PRESSURE, STATES
from frbcli.film.cells.data import CLOSED, UNKNOWN, VolumeFilms, film_alone
from frbcli.film.cells.film import Motion, VolumeFilm


@compiled(makes_arrays=True)
def side_flow(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, far_open: bool
) -> float:
    """Outflow through the ends in the film's units, by one section."""
    m, k = states.shape[1], states.shape[2]
    total, falls = 0.0, np.empty(m)
    for far in (False, True):
        kind, j, _, _, _ = section_end(film, k, far)
        if kind == CLOSED or (far and not far_open):
            continue
        falls_to_air(film, ring, places, states[PRESSURE], motion, far, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] != 0.0:
                flow, _, _, _ = flow_at_end(film, ring, places, states, motion, far, falls, i)
                total += max(flow, 0.0)
    return total


def outflow(film: VolumeFilm, motion: Motion, pressure: Array, known: VolumeFilms | None = None) -> float:
    """Outflow through the open ends of the whole bearing in m^3/s, or of a land where the lands differ. pressure (m,
    k): scaled gauge pressures of the cells; known: the film as arrays, where its openings are filled in part."""
    section, data = film.section, known or film_alone(film)
    states = np.zeros((STATES, *pressure.shape))
    states[PRESSURE] = pressure
    unit = section.copies * section.radius * section.width * section.clearance
    own = data.films[0], data.ring[0], data.places[0], data.cells[0]
    return unit * float(side_flow(*own, states, seen_by_grid(motion), opens_far(film)))


def opens_far(film: VolumeFilm) -> bool:
    """Whether the end z = 1 of a film's section is an end of the bearing."""
    return film.section.far in ("oil-bath", "free-to-air")
