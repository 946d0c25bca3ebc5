"""A film whose law makes oil where the pressure falls too low, without openings: forces, solved and tabulated."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cells.balance.boundaries import end_slopes
from frbcli.film.cells.mesh.grid import VolumeGrid, axial_weights, fitted_grid
from frbcli.film.gap import Section, gap_height, gap_rate
from frbcli.film.grid import Mesh
from frbcli.film.kept import kept_beside
from frbcli.film.penalty_table.table import LIMIT, PenaltyTableFilm, row_forces, slow_speed, source_table, table_numbers
from frbcli.film.rectangles.film_force import FilmData

CENTRED = 1e-6  # eccentricity that counts as the centre


@dataclass(frozen=True)
class RowEquations:
    """The balances of the cells at an eccentricity, by pressures above p_cav and by velocities.

    stencil: (ENTRIES, m, k) matrix; loads: (3, m, k) net outflow at the cavitation pressure: at rest, and per velocity
    along and across the line of centres; area: (m, k); push: (2, m) and width: (k,) weights of the force.
    """

    stencil: Array
    loads: Array
    area: Array
    push: Array
    width: Array


def row_equations(section: Section, grid: VolumeGrid, eccentricity: float) -> RowEquations:
    """The equations of a section without openings, its ends at given pressures; the line of centres lies along x."""
    level = (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale
    groove = section.far_pressure / section.pressure_scale if section.far == "groove" else 0.0
    face, middle = (gap_height(section, (eccentricity, 0.0), phi[:, None]) for phi in (grid.phi[1:], grid.centre))
    around, cube = face**3 * np.diff(grid.z) / grid.around, middle**3 * np.diff(grid.phi)[:, None] * section.aspect
    before, behind, below, above, rest = (np.zeros(grid.shape) for _ in range(5))
    before -= np.roll(around, 1, axis=0)
    behind -= around
    below[:, 1:], above[:, :-1] = -cube / grid.along, -cube / grid.along
    centre = -(before + behind + below + above)
    first, last = end_slopes(grid.height, section.seals)
    ends = (section.near, first, 0, above, level), (section.far, last, -1, below, level - groove)
    for edge, slope, row, inwards, rise in ends:
        if edge != "symmetry":
            conductance = cube[:, 0] * slope.rise
            centre[:, row] += conductance * (1.0 + slope.bend)
            inwards[:, row] -= conductance * slope.bend
            rest[:, row] += conductance * rise
    squeezed = (grid.area * gap_rate(v, grid.centre)[:, None] for v in ((1.0, 0.0), (0.0, 1.0)))
    return RowEquations(
        np.array([centre, before, behind, below, above]),
        np.array([rest, *squeezed]),
        np.ascontiguousarray(grid.area),
        np.array([-np.diff(np.cos(grid.phi)), -np.diff(np.sin(grid.phi))]),
        axial_weights(grid.z, section.far == "symmetry"),
    )


@dataclass(frozen=True)
class SourceFilm:
    """A section with a penalty on mesh.circumferential x mesh.axial cells. A law that follows the speed of rotation
    takes the cavitation pressure at all edges."""

    section: Section
    law: Penalty
    mesh: Mesh

    @property
    def relative(self) -> bool:
        """Whether the law's pressure follows the speed of rotation."""
        return self.law.by_speed

    @property
    def numbers(self) -> Array:
        """Numbers of the table, see table_numbers."""
        return table_numbers(self.law.steepness, self.relative)

    def forces(self, eccentricity: float, velocities: Array) -> Array:
        """(d, l, 2) integrals of P (cos Theta, sin Theta) over the section for w (d, l, 2), 1/s or over the speed of
        rotation, along and across the line of centres; see row_forces. Raises NotConverged."""
        eccentricity = max(eccentricity, CENTRED)
        section, along = _half(self.section, self.mesh.axial)
        grid = fitted_grid(section, (eccentricity, 0.0), self.mesh.circumferential, along)
        equations = row_equations(section, grid, eccentricity)
        law = np.array(self.law.followed(eccentricity, speed=1.0).parameters)
        forces = np.empty(velocities.shape)
        most = row_forces(
            law,
            slow_speed(-math.log(1.0 - eccentricity), self.numbers),
            equations.stencil,
            equations.loads,
            equations.area,
            equations.push,
            equations.width,
            np.ascontiguousarray(velocities),
            forces,
        )
        if most == LIMIT or not np.all(np.isfinite(forces)):
            raise NotConverged(
                f"the film did not settle at an eccentricity of {eccentricity:.4f} while it was tabulated; "
                'set film.solution = "cells", or another accuracy.mesh'
            )
        return forces

    def force(self, displacement: Array, velocity: Array, omega: float) -> Array:
        """(2,) force of the whole bearing in N, solved for this motion; SI units. Raises NotConverged."""
        clearance = self.section.clearance
        d, v = np.asarray(displacement) / clearance, np.asarray(velocity) / clearance
        w = v + 0.5 * omega * np.array([d[1], -d[0]])
        eccentricity = math.hypot(*d)
        c, s = d / eccentricity if eccentricity > CENTRED else np.array([1.0, 0.0])
        turn = np.array([[c, s], [-s, c]])
        rate = max(abs(omega), 1.0) if self.relative else 1.0
        at = self.forces(eccentricity, (turn @ w / rate)[None, None, :])[0, 0]
        force: Array = self.section.force_scale * rate * turn.T @ at
        return force

    def film(self) -> FilmData:
        """The film, tabulated, for the time loop. Raises NotConverged."""
        # A law derived from this one in Python may have other equations with the same numbers.
        table = _kept_table(self) if type(self.law) is Penalty else penalty_table(self)
        return PenaltyTableFilm(self.section.force_scale, table, self.numbers)


def penalty_table(film: SourceFilm) -> Array:
    """The table of a film, see source_table. Raises NotConverged."""
    return source_table(film.forces, film.numbers)


_kept_table = kept_beside(row_forces)(penalty_table)


def _half(section: Section, along: int) -> tuple[Section, int]:
    """The half of a section that is symmetric about its own middle, and the cells along it."""
    if section.far == "symmetry":
        return section, max(2, (along + 1) // 2)
    if section.far_pressure != 0.0:
        return section, along
    half = replace(section, width=0.5 * section.width, copies=2 * section.copies, far="symmetry")
    return half, max(2, (along + 1) // 2)
