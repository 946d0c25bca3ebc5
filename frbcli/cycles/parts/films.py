"""The films of a machine as forces that follow from the motion alone; bores that turn enter by their mean."""

from __future__ import annotations

import numpy as np

from frbcli.film.rectangles.film_force import FilmData
from frbcli.scene.machine.system import System


def smooth_films(system: System) -> tuple[FilmData, ...]:
    """The films of a system; those on cells tabulated as the mean over the angle of their openings."""
    outside = (int(body) for body in system.bodies[:, 1])
    return system.films.smooth([_ring_share(system, i, ring) if ring >= 0 else 0.0 for i, ring in enumerate(outside)])


def _ring_share(system: System, film: int, ring: int) -> float:
    """The speed of a ring over omega_J + omega_S of the film inside of it, concentric."""
    drags = np.array(system.drags)
    ratio = drags[film] / drags[np.any(system.bodies == ring, axis=1)].sum()
    return float(ratio / (1.0 + ratio))
