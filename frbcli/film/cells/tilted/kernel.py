"""Films whose journals tilt as arrays for the compiled kernels: the lands of all films of a machine side by side.

The coordinates of a journal are its displacements at both ends of its bearing, over the clearance: (near x, near y,
far x, far y), near at z = -B/2. In between its displacement is linear along the axis, and so is the gap.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices
from frbcli.film.cells.block_cyclic import TILTED, ring_solver
from frbcli.film.cells.data import TIGHTLY, Records, places_along, volume_films

if TYPE_CHECKING:
    from frbcli.film.cells.tilted.steady_force import TiltedFilm


class TiltedVolumes(NamedTuple):
    """Lands of equal numbers of cells m x k; films, ring, cells: as VolumeFilms has them, of each land.

    places: (lands, PLACES, k + 1) along the axis of the bearing; first: (films + 1,) first land of each film, and their
    number.
    """

    films: Records
    ring: Array
    cells: Array
    places: Array
    first: Indices


def tilted_volumes(
    films: Sequence[TiltedFilm], settled: float = TIGHTLY, centrifugal: Sequence[float] = ()
) -> TiltedVolumes:
    """The films as arrays; all lands have grids of the same shape. settled, centrifugal (films,): see FILM."""
    lands = [land for film in films for land in film.lands]
    drops = [drop for film, drop in zip(films, centrifugal, strict=False) for _ in film.lands]
    data = volume_films([land.film for land in lands], drops, settled)
    k = lands[0].film.grid.shape[1]
    grids = [land.film.grid for land in lands]
    places = np.array([
        places_along(land.places(grid.height), land.places(grid.z), np.diff(grid.z))
        for land, grid in zip(lands, grids, strict=True)
    ])  # fmt: skip
    data.films["solver_at"] = ring_solver(k, TILTED)
    first = np.cumsum([0, *(len(film.lands) for film in films)])
    return TiltedVolumes(data.films, data.ring, data.cells, places, first)
