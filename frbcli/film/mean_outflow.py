"""Outflow of a film with turning openings through its ends, as the mean over their angle: from the fields of
film/mean_fields.py, by the same flows as of a finite-volume film. Compiled.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.ends import opens_far, side_flow
from frbcli.film.cells.balance.grid_motion import level
from frbcli.film.cells.balance.states import PRESSURE, STATES
from frbcli.film.cells.data import Records, VolumeFilms
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.mean_fields import MeanFilm, fields_at
from frbcli.film.parabola import hermite
from frbcli.film.rectangles.film_force import NEAR_CENTRE
from frbcli.film.rectangles.table import DEPTH_STEP


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
    unit = section.copies * section.radius * section.width
    own = data.films[i : i + 1], data.ring[i], data.places[i], data.cells[i]
    return MeanEndFlow(fields, *own, opens_far(film), apart, unit)


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
