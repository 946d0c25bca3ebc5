"""Films whose force follows from the motion alone: closed forms, tables, chains between axial grooves, and solutions
that were tabulated before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.gap import Section
from frbcli.film.grid import FINER, Mesh
from frbcli.film.kinds.contract import Compared, Films, couette_power
from frbcli.film.penalty_table.film import SourceFilm
from frbcli.film.penalty_table.table import PenaltyTableFilm, with_half_the_nodes
from frbcli.film.rectangles.end_flow import EndFlow, end_flow, make_end_flow
from frbcli.film.rectangles.film import FilmForce, direct_force, evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData


@dataclass(frozen=True)
class TableFilms(Films):
    """data: of each film; sections: over the whole width, see whole_width of gap.py; scales: None, or by what the
    velocities of each film have to be multiplied for its table, see Films.scaled; shares: None, or of their gauge
    supply pressures, see Films.supplied: r F(w / r) is the force with r times these."""

    data: tuple[FilmData, ...]
    sections: tuple[Section, ...]
    scales: tuple[float, ...] | None = field(default=None, kw_only=True)
    shares: tuple[float, ...] | None = field(default=None, kw_only=True)

    @property
    def loop(self) -> Any:
        """The films as the time loop takes them."""
        return self.data

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        if self.scales is None:
            return evaluate(self.data[i], self.clearances[i], place, rate, total)
        s = self.scales[i]
        force = evaluate(self.data[i], self.clearances[i], place, s * np.asarray(rate), s * total)
        r = 1.0 if self.shares is None else self.shares[i]
        return FilmForce(r * force.force, r * force.by_displacement, r * s * force.by_velocity)

    @cached_property
    def end_flows(self) -> tuple[EndFlow, ...]:
        return tuple(make_end_flow(section, film) for section, film in zip(self.sections, self.data, strict=True))

    def heat_ends(self) -> Any:
        return self.end_flows

    def power_and_flow(
        self, i: int, place: Array, total: float, slip: float, drag: float, near: FilmForce | None = None
    ) -> tuple[float, float]:
        d, c = place / self.clearances[i], self.clearances[i]
        power = couette_power(place, c, self.force(i, place, np.zeros(2), total).force, total, slip, drag)
        scale = 1.0 if self.scales is None else self.scales[i]
        w = 0.5 * total * np.array([d[1], -d[0]])
        leaving = end_flow(self.end_flows[i], float(d[0]), float(d[1]), float(w[0]), float(w[1]), scale)
        return power, c * leaving

    def scaled(self, scales: Array, clearances: Array) -> Self | None:
        return replace(self, clearances=tuple(clearances.tolist()), scales=tuple(scales.tolist()))

    def supplied(self, shares: Array) -> Self:
        scales = np.ones(self.count) if self.scales is None else np.asarray(self.scales)
        return replace(self, scales=tuple((scales / shares).tolist()), shares=tuple(shares.tolist()))

    def smooth(self, ring_shares: Sequence[float]) -> tuple[FilmData, ...]:
        return self.data


@dataclass(frozen=True)
class RectangleFilms(TableFilms):
    """Gaps made of rectangles. laws: of the films; theory: "short" | "finite"; mesh: the finest of the films'."""

    laws: tuple[str, ...]
    theory: str
    mesh: Mesh

    def compared(self) -> Compared:
        """See Films.compared: against the film of finite length, of the short bearing the error of the theory."""
        finer = Mesh(FINER * self.mesh.axial, FINER * self.mesh.circumferential)
        # Films between axial grooves have no table: the same film on the finer mesh is the reference.
        fine = [
            make_film(section, self.theory, law, finer) if section.grooves else None
            for section, law in zip(self.sections, self.laws, strict=True)
        ]

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            section, better = self.sections[i], fine[i]
            if better is None:
                exact = direct_force(section, self.laws[i], finer, place, rate, total)
            else:
                exact = evaluate(better, section.clearance, place, rate, total).force
            return exact, self.force(i, place, rate, total).force

        return forces


@dataclass(frozen=True)
class SolutionFilms(TableFilms):
    """Films tabulated from solutions on cells. solved: what the tables are made of; mesh: cells."""

    solved: tuple[SourceFilm, ...]
    mesh: Mesh

    def with_half_the_nodes(self) -> Self:
        tables = (film for film in self.data if isinstance(film, PenaltyTableFilm))
        return replace(self, data=tuple(film._replace(table=with_half_the_nodes(film.table)) for film in tables))

    def compared(self) -> Compared:
        finer = Mesh(FINER * self.mesh.axial, FINER * self.mesh.circumferential)
        fine = [replace(film, mesh=finer) for film in self.solved]

        def forces(i: int, place: Array, rate: Array, total: float) -> tuple[Array, Array]:
            return fine[i].force(place, rate, total), self.force(i, place, rate, total).force

        return forces
