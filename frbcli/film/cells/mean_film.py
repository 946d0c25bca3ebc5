"""The table of film/mean_fields.py from solutions on cells."""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solve_circulant

from frbcli.arrays import Array
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.mesh.grid import force_weights
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.mean_fields import FIELDS, MeanFilm
from frbcli.film.rectangles.table import DEPTH_STEP, eccentricity_axis

ANGLES = 4  # of the openings to the line of centres, over the angle after which they look the same


def mean_film(film: VolumeFilm, openings: int, drop: float) -> MeanFilm:
    """The film with the mean over the angle of its equal openings, `openings` of them in a turn, 0 if it has none.

    film: with a law that solves a linear equation, and clips or not; drop: see MeanFilm.
    """
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
    scale = section.copies * section.radius * section.width * section.pressure_scale
    level = film.scales.cavitation if film.law.clips else float(10.0 * np.min(values))
    return MeanFilm(scale, level, drop, np.ascontiguousarray(np.concatenate([lines, slopes], axis=3)), weights)


def _pressure(solver: FilmSolver, d: tuple[float, float], v: Array) -> Array:
    """(m, k) before it is clipped."""
    return np.asarray(solver.steady(Motion(d, (float(v[0]), float(v[1])), 0.0)).state.pressure)
