"""Films whose journals tilt in their shells.

Films in shells that are not in line, around journals that keep their direction, for machines at rest.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.film.cells.balance.ends import FLOWS, outflow
from frbcli.film.cells.data import SHEARED
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.linearised import film_at
from frbcli.film.cells.loads import loads
from frbcli.film.cells.tilted_film import (
    COORDINATES,
    TiltedFilm,
    TiltedLand,
    TiltedVolumes,
    land_solution,
    linear_tilted,
    settled_force,
    tilted_force,
    tilted_volumes,
    unit_loads,
)
from frbcli.film.gap import Section
from frbcli.film.grid import FINER
from frbcli.film.kinds.cells import VolumeKind, begin_wet, no_wet
from frbcli.film.kinds.contract import Compared, FieldFilm, Films, LinearOf, Part
from frbcli.film.rectangles.film import FilmForce

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
ALONG, SHARES = 0.5 * (1.0 + _NODES[:, None]), 0.5 * _WEIGHTS  # places along a film, and their shares of it


@dataclass(frozen=True)
class TiltedFilms(VolumeKind):
    """own: the films; misalignments: (films, 2) tilts of the shells about x and y, rad; cells: (around, along) over the
    whole width, of a film that no groove divides; settled, centrifugal (films,): see FILM; states: at which forces are
    compared, of a run. Derivatives are as for films that are not mass-conserving."""

    own: tuple[TiltedFilm, ...]
    misalignments: Array
    cells: tuple[int, int]
    settled: float
    states: int
    centrifugal: tuple[float, ...] = ()

    coordinates: ClassVar[int] = COORDINATES
    stations: ClassVar[int] = 2

    @cached_property
    def data(self) -> TiltedVolumes:
        """The films as arrays."""
        return tilted_volumes(self.own, self.settled, self.centrifugal)

    @property
    def loop(self) -> Any:
        return self.data

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        start = None if near is None else near.foreseen(place, total).field
        return tilted_force(self.own[i], place, rate, total, start)

    @property
    def standing(self) -> Array:
        return np.hstack([np.zeros_like(self.misalignments), -self.misalignments])

    def seen(self, journals: Array) -> Array:
        return np.concatenate([film.at_ends(journal) for film, journal in zip(self.own, journals, strict=True)])

    def harmonic_gaps(self, places: Array) -> Array:
        """See Films.harmonic_gaps: of 1 / H along the axis, too."""
        first, last = np.moveaxis(self.ends(places).reshape(-1, self.stations, 2), 1, 0)[:, :, None]
        at = first + ALONG * (last - first)
        return np.asarray(1.0 / (SHARES / np.sqrt(np.maximum(1.0 - (at**2).sum(axis=2), 1e-6))).sum(axis=1))

    @property
    def sheared(self) -> Array:
        shares = self.data.cells[:, SHEARED].sum(axis=(1, 2)) / (2.0 * np.pi)
        return np.asarray([shares[one:end].mean() for one, end in pairwise(self.data.first.tolist())])

    def first_state(self, places: Array, totals: Array) -> tuple[Array, Array]:
        moves = [place.any() and total != 0.0 for place, total in zip(places, totals, strict=True)]
        of = self._lands
        wet = no_wet([land.film for _, land in of])
        for number, (i, land) in enumerate(of):
            solution, motion = None, land.motion(places[i], np.zeros(COORDINATES), float(totals[i]))
            if moves[i]:
                with contextlib.suppress(NotConverged):
                    solution = land_solution(land.film, motion)
            begin_wet(land.film, motion, solution, wet[:, number])
        return wet, np.zeros((2, len(of), FLOWS))

    def linear(self, i: int, cells: tuple[int, int]) -> LinearOf:
        around, half = cells
        return partial(linear_tilted, self.own[i].finer((around, 2 * half)))

    @property
    def _lands(self) -> list[tuple[int, TiltedLand]]:
        return [(i, land) for i, film in enumerate(self.own) for land in film.lands]

    @property
    def fields_of_films(self) -> tuple[tuple[int, VolumeFilm], ...]:
        return tuple((i, land.film) for i, land in self._lands)

    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        """See Films.power_and_flow: the moment that turns against half of the total is the moment of the pressures
        about the middle of the shell, each where it acts."""
        couette, flow, load = 0.0, 0.0, np.zeros(COORDINATES)
        for land in self.own[i].lands:
            motion = land.motion(place, np.zeros(COORDINATES), total)
            film, solution = film_at(land.film, math.hypot(*motion.d), total), land_solution(land.film, motion)
            couette -= loads(film, motion, solution, slip).torque.couette
            load += land.map.T @ (unit_loads(film) @ film.mean_pressure(solution.state).ravel())
            flow += outflow(film, motion, film.pressure(solution.state))
        x, y, tilt_x, tilt_y = place.tolist()
        moment = x * load[1] - y * load[0] + tilt_x * load[3] - tilt_y * load[2]
        return couette * slip + 0.5 * float(moment) * total, flow

    @property
    def compared_states(self) -> int:
        return self.states

    def compared(self) -> Compared:
        """See Films.compared: on twice the cells each way, forces at both ends (4,) that do the same work."""
        fine = [film.finer((FINER * self.cells[0], FINER * film.along)) for film in self.own]

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            to_ends = np.linalg.inv(self.own[i].at_ends(np.eye(COORDINATES)).reshape(COORDINATES, COORDINATES)).T
            better, own = (settled_force(film, place, rate, total) for film in (fine[i], self.own[i]))
            return to_ends @ better, to_ends @ own

        return forces

    @property
    def fields(self) -> tuple[TiltedField, ...]:
        return tuple(map(TiltedField, self.own))


@dataclass(frozen=True)
class TiltedField(FieldFilm):
    """The fields of a film whose journal tilts. See FieldFilm."""

    film: TiltedFilm

    @property
    def section(self) -> Section:
        return self.film.section

    def coordinates(self, d: Array) -> Array:
        """(4,) of the journal in m and rad."""
        return np.concatenate([self.section.clearance * d[:2], d[2:]])

    def ends(self, d: Array) -> Array:
        return self.film.ends(self.coordinates(d))

    def parts(self, d: Array, total: float) -> tuple[Part, ...]:
        place, still = self.coordinates(d), np.zeros(COORDINATES)
        return tuple((land.film, land.motion(place, still, total)) for land in self.film.lands)


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

    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        whole = np.concatenate([place, self.tilted.standing[i, 2:]])
        return self.tilted.power_and_flow(i, whole, total, slip, drag, near)

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
