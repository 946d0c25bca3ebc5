"""Films whose journals tilt in their shells, for machines at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from frbcli.film.cells.tilted.force import COORDINATES, TiltedFilm, tilted_force
from frbcli.film.grid import Array
from frbcli.film.kinds.contract import Films
from frbcli.film.rectangles.film import FilmForce


@dataclass(frozen=True)
class TiltedFilms(Films):
    """own: the films, none of which keeps oil; misalignments: (films, 2) tilts of the shells about x and y, rad."""

    own: tuple[TiltedFilm, ...]
    misalignments: Array

    coordinates: ClassVar[int] = COORDINATES

    @property
    def loop(self) -> Any:
        """The time loop has no such films."""
        raise NotImplementedError

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        """See Films.force."""
        return tilted_force(self.own[i], place, rate, total, None if near is None else near.field)

    @property
    def standing(self) -> Array:
        """See Films.standing."""
        return np.hstack([np.zeros_like(self.misalignments), -self.misalignments])

    def ends(self, places: Array) -> Array:
        """See Films.ends."""
        return np.concatenate([film.ends(place) for film, place in zip(self.own, places, strict=True)])

    def power_and_flow(self, i: int, place: Array, total: float, slip: float, drag: float) -> tuple[float, float]:
        """Not known: cases with heat do not have these films."""
        raise NotImplementedError

    def heat_ends(self) -> Any:
        """As power_and_flow."""
        raise NotImplementedError
