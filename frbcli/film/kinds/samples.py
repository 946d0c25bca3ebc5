"""The force of one film at many moments of a motion, compiled."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.mean_fields.table import MeanFilm
from frbcli.film.penalty_table.table import PenaltyTableFilm
from frbcli.film.rectangles.film_force import FilmData, film_force
from frbcli.film.rectangles.short import ShortFilm

# Columns of film_samples: force (x, y), derivatives by d (xx, xy, yx, yy), by v (xx, xy, yx, yy), by omega (x, y).
FORCE, BY_D, BY_V, BY_OMEGA, COLUMNS = 0, 2, 6, 10, 12
DIFFERENCE = 1e-6  # relative, of the speed, for films whose force depends on it by more than the motion of the gap


def film_samples(film: FilmData, d: Array, v: Array, omega: Array) -> Array:
    """(n, COLUMNS) N, N and N s: force on the journal by one bearing and its derivatives at n moments.

    d: (n, 2) displacement over the clearance; v: (n, 2) its rate in 1/s; omega: (n,) omega_J + omega_S in rad/s.
    """
    rows = np.empty((len(d), COLUMNS))
    _sample(film, d, v, omega, rows)
    if isinstance(film, PenaltyTableFilm | MeanFilm):
        step = DIFFERENCE * np.maximum(np.abs(omega), 1.0)
        ahead, behind = np.empty_like(rows), np.empty_like(rows)
        _sample(film, d, v, omega + step, ahead)
        _sample(film, d, v, omega - step, behind)
        rows[:, BY_OMEGA:] = (ahead[:, :2] - behind[:, :2]) / (2.0 * step[:, None])
    return rows


def at_viscosity(film: FilmData, scale: float) -> FilmData:
    """The film of so many times the viscosity, as one that is asked for its force at so many times the velocities:
    pressures at openings that turn fall with the speed as it is."""
    return film._replace(drop=film.drop / scale**2) if isinstance(film, MeanFilm) else film


def have_closed_forms(films: Sequence[FilmData]) -> bool:
    """Whether the force of every film is a formula, without lines of a table or of a mesh."""
    return all(isinstance(film, ShortFilm) for film in films)


@compiled()
def _sample(film: Any, d: Array, v: Array, omega: Array, rows: Array) -> None:
    """The rows of film_samples; by omega as far as it moves the gap, through w = v - (omega/2) J d (4.5)."""
    for i in range(d.shape[0]):
        f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = film_force(
            film, d[i, 0], d[i, 1], v[i, 0], v[i, 1], omega[i]
        )
        rows[i, 0], rows[i, 1] = f_x, f_y
        rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5] = k_xx, k_xy, k_yx, k_yy
        rows[i, 6], rows[i, 7], rows[i, 8], rows[i, 9] = d_xx, d_xy, d_yx, d_yy
        rows[i, 10] = 0.5 * (d_xx * d[i, 1] - d_xy * d[i, 0])
        rows[i, 11] = 0.5 * (d_yx * d[i, 1] - d_yy * d[i, 0])


def drag_factor(d: Array) -> tuple[Array, Array]:
    """Sommerfeld's integral of 1 / H over the turn at displacements (n, 2) over the clearance: (n,), and its gradient
    (n, 2)."""
    square = np.maximum(1.0 - np.sum(d**2, axis=1), 1e-6)
    factor = 2.0 * math.pi / np.sqrt(square)
    return factor, factor[:, None] * d / square[:, None]
