"""The table of film/mean_fields.py from solutions on cells.

Outflow of a film with turning openings through its ends, as the mean over their angle: from the fields of the table, by
the same flows as of a finite-volume film, compiled.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.ends import opens_far, side_flow
from frbcli.film.cells.balance.states import PRESSURE, STATES
from frbcli.film.cells.data import Records, VolumeFilms, level
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.mesh.grid import force_weights
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.mean_fields import FIELDS, MeanFilm, fields_at
from frbcli.film.parabola import hermite
from frbcli.film.rectangles.film_force import NEAR_CENTRE
from frbcli.film.rectangles.table import DEPTH_STEP, eccentricity_axis

if TYPE_CHECKING:
    from frbcli.film.cells.solver import FilmSolver

ANGLES = 4  # of the openings to the line of centres, over the angle after which they look the same


def mean_film(film: VolumeFilm, openings: int, drop: float) -> MeanFilm:
    """The film with the mean over the angle of its equal openings, `openings` of them in a turn, 0 if it has none.

    film: with a law that solves a linear equation, and clips or not; drop: see MeanFilm.
    """
    from scipy.interpolate import CubicSpline  # all three take long to load
    from scipy.linalg import solve_circulant

    from frbcli.film.cells.solver import FilmSolver

    section, grid = film.section, film.grid
    count, (m, k) = (ANGLES if openings else 1), grid.shape
    eccentricities = eccentricity_axis()
    values = np.empty((len(eccentricities), count, FIELDS, m, k))
    weights = np.empty((count, 2, k, m))
    push = -np.stack([np.diff(np.cos(grid.phi)), np.diff(np.sin(grid.phi))])
    loads = force_weights(section, grid)
    solver, rate = FilmSolver(film), film.scales.reference * section.aspect
    for j in range(count):
        angle = 2.0 * math.pi * j / (count * max(openings, 1))
        along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
        for c, direction in enumerate((along, across)):
            weights[j, c] = ((direction @ push)[:, None] * loads).T
        for i, eccentricity in enumerate(eccentricities):
            d = (float(eccentricity * along[0]), float(eccentricity * along[1]))
            still = _pressure(solver, d, np.zeros(2))
            values[i, j, 0] = (_pressure(solver, d, rate * along) - still) / rate
            values[i, j, 1] = (_pressure(solver, d, rate * across) - still) / rate
            values[i, j, 2] = still
    # Straight lines between the cells smooth the pressure; what is tabulated makes up for it.
    column = np.zeros(m)
    column[[0, 1, -1]] = 2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0
    sharp = solve_circulant(column, np.moveaxis(values, 3, 0).reshape(m, -1)).reshape(m, *values.shape[:3], k)
    lines = np.ascontiguousarray(sharp.transpose(1, 2, 4, 3, 0))
    slopes = CubicSpline(DEPTH_STEP * np.arange(len(eccentricities)), lines, axis=0)(
        DEPTH_STEP * np.arange(len(eccentricities)), 1
    )
    level = film.scales.cavitation if film.law.clips else float(10.0 * np.min(values))
    table = np.ascontiguousarray(np.concatenate([lines, slopes], axis=3))
    return MeanFilm(section.force_scale, level, drop, table, weights)


def _pressure(solver: FilmSolver, d: tuple[float, float], v: Array) -> Array:
    """(m, k) before it is clipped."""
    return np.asarray(solver.steady(Motion(d, (float(v[0]), float(v[1])), 0.0)).state.pressure)


class MeanEndFlow(NamedTuple):
    """fields: of the pressure; films (1,), ring, places, cells: of the film, see VolumeFilms; far_open: see opens_far;
    apart: rad between the angles of the openings that are tabulated; unit: m^2 of a flow of 1, over the clearance."""

    fields: MeanFilm
    films: Records
    ring: Array
    places: Array
    cells: Array
    far_open: bool
    apart: float
    unit: float


def mean_end_flow(film: VolumeFilm, fields: MeanFilm, data: VolumeFilms, i: int) -> MeanEndFlow:
    """Mean end flow of film i of `data`."""
    section = film.section
    apart = 2.0 * math.pi / (fields.table.shape[1] * max(len(section.holes), 1))
    own = data.films[i : i + 1], data.ring[i], data.places[i], data.cells[i]
    return MeanEndFlow(fields, *own, opens_far(film), apart, section.area)


@compiled(makes_arrays=True)
def mean_end_flows(flow: MeanEndFlow, motions: Array, omega: Array, scale: float) -> Array:
    """(n,) of table_end_flow in motions (n, 4) of d and w, at omega (n,), omega_J + omega_S in rad/s."""
    fields, own = flow.fields, flow.films[0]
    table, n, flows = fields.table, motions.shape[0], np.zeros(motions.shape[0])
    angles, k, m = table.shape[1], table.shape[2], table.shape[4]
    states, line_of = np.zeros((STATES, m, k)), np.empty(m)
    for moment in range(n):
        d_x, d_y, w_x, w_y = motions[moment, 0], motions[moment, 1], motions[moment, 2], motions[moment, 3]
        e = math.sqrt(d_x * d_x + d_y * d_y)
        c, s = (d_x / e, d_y / e) if e > NEAR_CENTRE else (1.0, 0.0)
        e = min(e, LARGEST_ECCENTRICITY)
        w_r, w_t = scale * (c * w_x + s * w_y), scale * (c * w_y - s * w_x)
        x = -math.log(1.0 - e) / DEPTH_STEP
        cell = min(int(x), table.shape[0] - 2)
        (h0, h1, h2, h3), _ = hermite(x - cell, DEPTH_STEP)
        given = max(0.0, 1.0 - fields.drop * omega[moment] * omega[moment])
        for j in range(angles):
            for line in range(k):
                low, high = table[cell, j, line], table[cell + 1, j, line]
                for i in range(m):
                    r, t, g = fields_at(low, high, i, h0, h1, h2, h3)
                    line_of[i] = w_r * r + w_t * t + given * g
                for i in range(m):  # straight lines between the cells have these means over them
                    around = line_of[i - 1 if i > 0 else m - 1] + line_of[i + 1 if i + 1 < m else 0]
                    states[PRESSURE, i, line] = max((around + 4.0 * line_of[i]) / 6.0, fields.level)
            d_x, d_y = e * math.cos(j * flow.apart), e * math.sin(j * flow.apart)
            at = level(d_x, d_y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            flows[moment] += side_flow(own, flow.ring, flow.places, flow.cells, states, at, flow.far_open)
        flows[moment] *= flow.unit / (angles * scale)
    return flows
