"""The films of a machine as forces that follow from the motion alone; bores that turn enter by their mean."""

from __future__ import annotations

from typing import cast

import numpy as np

from frbcli.film.cells.data import CENTRIFUGAL, VolumeFilms
from frbcli.film.rectangles.film_force import FilmData
from frbcli.scene.system import System


def smooth_films(system: System) -> tuple[FilmData, ...]:
    """The films of a system; those on cells tabulated as the mean over the angle of their openings."""
    if not isinstance(system.films, VolumeFilms):
        return cast(tuple[FilmData, ...], system.films)
    from frbcli.film.cells.mean_film import mean_film  # with the solver of cells, which takes long to load

    found: list[FilmData] = []
    for i, film in enumerate(system.volumes):
        openings = film.section.holes
        drop = 0.0
        ring = int(system.bodies[i, 1])
        centrifugal = float(system.films.numbers[i, CENTRIFUGAL])
        if openings and ring >= 0 and centrifugal > 0.0 and openings[0].pressure > 0.0:
            share = _ring_share(system, i, ring)
            drop = centrifugal * share**2 * film.section.pressure_scale / openings[0].pressure
        found.append(mean_film(film, len(openings), drop))
    return tuple(found)


def _ring_share(system: System, film: int, ring: int) -> float:
    """The speed of a ring over omega_J + omega_S of the film inside of it, concentric."""
    drags = np.array(system.drags)
    ratio = drags[film] / drags[np.any(system.bodies == ring, axis=1)].sum()
    return float(ratio / (1.0 + ratio))
