"""Steady finite-volume films as bearing sheets ask for their pressure and flow, whether or not their gaps are even
along the axis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.balance.side_flow import outflow
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.steady_force import film_at
from frbcli.film.gap import Section

Part = tuple[VolumeFilm, Motion]


class FieldFilm(Protocol):
    """A whole bearing as the parts that are solved for it. d: (2,) displacement of the journal over the clearance, with
    its tilts in rad behind it, (4,), of a film that sees them; total: omega_J + omega_S in rad/s."""

    @property
    def section(self) -> Section:
        """Its section, over the whole width or one of two equal ones."""
        ...

    def ends(self, d: Array) -> Array:
        """(k, 2) displacements over the clearance where the gap may be the smallest along the axis."""
        ...

    def parts(self, d: Array, total: float) -> tuple[Part, ...]:
        """The films with the motions that they see, whose forces, torques and flows add up."""
        ...

    def outflow(self, solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> float:
        """What leaves a part, which the solver has solved, through its open ends, m^3/s."""
        ...


@dataclass(frozen=True)
class EvenFilm(FieldFilm):
    """A film whose gap is the same along the axis. See FieldFilm."""

    film: VolumeFilm

    @property
    def section(self) -> Section:
        return self.film.section

    def ends(self, d: Array) -> Array:
        return np.asarray(d)[None]

    def parts(self, d: Array, total: float) -> tuple[Part, ...]:
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), total)
        return ((film_at(self.film, math.hypot(*motion.d), total), motion),)

    def outflow(self, solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> float:
        return outflow(solver.film, motion.d, solver.film.pressure(solution.state), solver.data)
