"""Films in shells that are not in line, around journals that keep their direction, for machines at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.film.kinds.contract import Films, LinearOf
from frbcli.film.kinds.tilted import TiltedField, TiltedFilms
from frbcli.film.rectangles.film import FilmForce

PLANE = slice(0, 2)  # of the four coordinates of a journal that tilts: its displacement


@dataclass(frozen=True)
class InclinedFilms(Films):
    """tilted: the same films around journals that may tilt; here journals stay parallel to the z-axis."""

    tilted: TiltedFilms

    @property
    def loop(self) -> Any:
        """The time loop has no such films."""
        raise NotImplementedError

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        whole = np.concatenate([place, self.tilted.standing[i, 2:]])
        force = self.tilted.force(i, whole, np.concatenate([rate, np.zeros(2)]), total, near)
        by_place, by_rate = (slopes[PLANE, PLANE] for slopes in (force.by_displacement, force.by_velocity))
        return FilmForce(force.force[PLANE], by_place, by_rate, force.field)

    def power_and_flow(self, i: int, place: Array, total: float, slip: float, drag: float) -> tuple[float, float]:
        whole = np.concatenate([place, self.tilted.standing[i, 2:]])
        return self.tilted.power_and_flow(i, whole, total, slip, drag)

    def ends(self, places: Array) -> Array:
        return self.tilted.ends(np.hstack([places, self.tilted.standing[:, 2:]]))

    @property
    def remembering(self) -> tuple[bool, ...]:
        return self.tilted.remembering

    @property
    def starving(self) -> bool:
        return self.tilted.starving

    def linear(self, i: int, cells: tuple[int, int]) -> LinearOf:
        whole, tilt = self.tilted.linear(i, cells), self.tilted.standing[i, 2:]
        return lambda share, place, *more: whole(share, np.concatenate([place, tilt]), *more).in_plane()

    @property
    def fields(self) -> tuple[InclinedFilm, ...]:
        tilts = self.tilted.standing[:, 2:]
        return tuple(InclinedFilm(film, tilt) for film, tilt in zip(self.tilted.own, tilts, strict=True))


@dataclass(frozen=True)
class InclinedFilm(TiltedField):
    """The fields of a film with a given tilt (2,) of the journal against the shell in rad. See FieldFilm."""

    tilt: Array

    def coordinates(self, d: Array) -> Array:
        return np.concatenate([self.section.clearance * d, self.tilt])
