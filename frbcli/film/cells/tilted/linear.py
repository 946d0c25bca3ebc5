"""A film whose journal tilts, linearised about its settled state with the oil of its cells as states, as LinearFilm."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.gas.linear import linear_states
from frbcli.film.cells.linearised import LinearFilm, by_neighbours, lying
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.tilted.force import COORDINATES, TiltedFilm, TiltedLand, land_slopes, unit_loads


def linear_tilted(
    film: TiltedFilm, share: float, place: Array, total: float, start: Array | None = None
) -> LinearFilm:
    """The film, on cells that lie by a share of one further around, with its journal at rest at `place` (4,) in m and
    rad. film: of a law whose forces are the pressures of its cells; total: omega_J + omega_S in rad/s; start: (lands,
    m, k) field to begin from. Raises NotConverged."""
    from scipy.sparse import block_diag  # takes long to load

    lands = [
        _linear_land(TiltedLand(lying(land.film, share), land.map), place, total, None if start is None else field)
        for land, field in zip(film.lands, film.lands if start is None else start, strict=True)
    ]
    return LinearFilm(
        flow=block_diag([land.flow for land in lands], "csc"),
        storage=block_diag([land.storage for land in lands], "csc"),
        by_place=np.vstack([land.by_place for land in lands]),
        by_rate=np.vstack([land.by_rate for land in lands]),
        by_total=np.concatenate([land.by_total for land in lands]),
        push=np.hstack([land.push for land in lands]),
        sheared=np.concatenate([land.sheared for land in lands]),
        field=np.array([land.field for land in lands]),
        ordered=all(land.ordered for land in lands),
    )


def _linear_land(land: TiltedLand, place: Array, total: float, start: Array | None) -> LinearFilm:
    from scipy.sparse import diags

    film, motion = land.film, land.motion(place, np.zeros(COORDINATES), total)
    solver, to_u = FilmSolver(film), land.map / film.section.clearance
    solution = solver.steady(motion, start, upwind=True)
    if film.law.carries_gas:
        slopes = linear_states(film, motion, solution, np.zeros(film.grid.shape), tilts=True)
        moved = slopes.by_place @ to_u, slopes.by_rate @ to_u, slopes.by_total
        push = land.map.T @ slopes.push
        return LinearFilm(slopes.flow, slopes.storage, *moved, push, slopes.sheared, solution.field, ordered=True)
    stencil, by_u, by_v, by_total = land_slopes(solver, motion, solution)
    stored = np.where(film.grid.fixed, 0.0, film.grid.area * film.gaps(motion) * solution.state.fraction_slope)
    return LinearFilm(
        flow=by_neighbours(stencil),
        storage=diags(stored.ravel(), format="csc"),
        by_place=by_u.reshape(-1, COORDINATES) @ to_u,
        by_rate=by_v.reshape(-1, COORDINATES) @ to_u,
        by_total=by_total.ravel(),
        push=land.map.T @ (unit_loads(film) * solution.state.pressure_slope.ravel()),
        sheared=np.zeros(stored.size),  # films that follow a tilt have the torque of a full one
        field=solution.field,
    )
