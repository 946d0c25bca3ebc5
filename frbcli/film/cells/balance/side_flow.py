"""Outflow of a finite-volume film at its open ends, for the balance of its heat; a groove is no open end. Compiled."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import end_flow, falls_to_air, section_end
from frbcli.film.cells.balance.ends import STEEPNESS
from frbcli.film.cells.balance.states import PRESSURE, STATES
from frbcli.film.cells.data import (
    BATHED,
    CLOSED,
    COS,
    FREE,
    GAP,
    LENGTH,
    SIN,
    UNKNOWN,
    VolumeFilms,
    volume_films,
)
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.roughness.rough_gap import flowing_cube


@compiled(makes_arrays=True)
def side_flow(
    film: np.record, ring: Array, cells: Array, states: Array, d_x: float, d_y: float, far_open: bool
) -> float:
    """Outflow through the ends in the film's units, by one section; d: in the frame of its cells."""
    m, k = states.shape[1], states.shape[2]
    steepness, total, falls = STEEPNESS / film.scales.ambient, 0.0, np.empty(m)
    for far in (False, True):
        kind, j, b, rise, bend = section_end(film, k, far)
        if kind == CLOSED or (far and not far_open):
            continue
        if kind == FREE:
            falls_to_air(film, ring, states[PRESSURE], d_x, d_y, far, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] == 0.0:
                continue
            h = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
            cube, _ = flowing_cube(h, film.roughness)
            conductance = cube * film.aspect * ring[LENGTH, i] * rise
            flow, _, _, _ = end_flow(
                kind, states[PRESSURE, i, j], states[PRESSURE, i, b], conductance, bend, 0.0, steepness, falls[i],
                ring[BATHED, i],
            )  # fmt: skip
            total += max(flow, 0.0)
    return total


def outflow(film: VolumeFilm, d: tuple[float, float], pressure: Array, known: VolumeFilms | None = None) -> float:
    """Outflow through the open ends of the whole bearing in m^3/s. d: displacement over the clearance; pressure (m, k):
    scaled gauge pressures of the cells; known: the film as arrays, if it is at hand."""
    section, data = film.section, known or volume_films([film])
    states = np.zeros((STATES, *pressure.shape))
    states[PRESSURE] = pressure
    unit = section.copies * section.radius * section.width * section.clearance
    return unit * float(side_flow(data.films[0], data.ring[0], data.cells[0], states, *d, opens_far(film)))


def opens_far(film: VolumeFilm) -> bool:
    """Whether the end z = 1 of a film's section is an end of the bearing."""
    return film.section.far in ("oil-bath", "free-to-air")
