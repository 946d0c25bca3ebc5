"""Films in shells that are not in line, around journals that keep their direction, for machines at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.tilted.balances import tilted_outflow
from frbcli.film.cells.tilted.force import TiltedFilm
from frbcli.film.gap import Section
from frbcli.film.grid import Array
from frbcli.film.kinds.contract import Films
from frbcli.film.kinds.fields import Part
from frbcli.film.kinds.tilted import TiltedFilms
from frbcli.film.rectangles.film import FilmForce

PLANE = slice(0, 2)  # of the four coordinates of a journal that tilts: its displacement


@dataclass(frozen=True)
class InclinedFilms(Films):
    """tilted: the same films around journals that may tilt; those of these films stay parallel to the z-axis."""

    tilted: TiltedFilms

    @property
    def loop(self) -> Any:
        """The time loop has no such films."""
        raise NotImplementedError

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        """See Films.force."""
        whole = np.concatenate([place, self.tilted.standing[i, 2:]])
        found = self.tilted.force(i, whole, np.concatenate([rate, np.zeros(2)]), total, near)
        by_place, by_rate = (slopes[PLANE, PLANE] for slopes in (found.by_displacement, found.by_velocity))
        return FilmForce(found.force[PLANE], by_place, by_rate, found.field)

    def ends(self, places: Array) -> Array:
        """See Films.ends."""
        return self.tilted.ends(np.hstack([places, self.tilted.standing[:, 2:]]))

    @property
    def fields(self) -> tuple[InclinedFilm, ...]:
        """See Films.fields."""
        tilts = self.tilted.standing[:, 2:]
        return tuple(InclinedFilm(film, tilt) for film, tilt in zip(self.tilted.own, tilts, strict=True))


@dataclass(frozen=True)
class InclinedFilm:
    """The fields of a film with a given tilt (2,) of the journal against the shell in rad. See FieldFilm."""

    film: TiltedFilm
    tilt: Array

    @property
    def section(self) -> Section:
        """See FieldFilm."""
        return self.film.section

    def ends(self, d: Array) -> Array:
        """See FieldFilm."""
        return self.film.ends(np.concatenate([self.section.clearance * d, self.tilt]))

    def parts(self, d: Array, total: float) -> tuple[Part, ...]:
        """See FieldFilm."""
        clearance = self.section.clearance
        place = np.concatenate([d * clearance, self.tilt])
        moved = (land.map @ place / clearance for land in self.film.lands)
        motions = (Motion((u[0], u[1]), (0.0, 0.0), total, (u[2], u[3])) for u in moved)
        return tuple((land.film, motion) for land, motion in zip(self.film.lands, motions, strict=True))

    @staticmethod
    def outflow(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> float:
        """See FieldFilm."""
        return tilted_outflow(film, motion, solution)
