"""Force and moments of a steady film whose journal moves and tilts, with all derivatives.

The coordinates q = (x, y, tilt_x, tilt_y) of the journal in the middle of the bearing move the journal over a land by
u = P q / C, its displacement in the middle of the land and the growth of this over the width, over the clearance. The
loads of the land that belong to u do the same virtual work as force and moments: these are P^T of them.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, replace
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, CARRIED_GAS, STATES
from frbcli.film.cells.elimination.block_cyclic import solve_blocks
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import pushed, pushing
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.mesh.tilted import tilted_cells
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.steady_force import film_at
from frbcli.film.cells.tilted.clipped import mean_change
from frbcli.film.cells.tilted.lands import parts
from frbcli.film.gap import Section, graded_ring
from frbcli.film.rectangles.film import FieldSlopes, FilmForce

COORDINATES = 4  # of the journal: its displacement along x and y, and its tilts about them
BY_TOTAL = [COORDINATES, 2 * COORDINATES]  # where changes with u end, and with its rate


@dataclass(frozen=True)
class TiltedLand:
    """A land on its cells, of a law that does not follow the motion. map: P, (4, 4), see above."""

    film: VolumeFilm
    map: Array

    def places(self, z: Array) -> Array:
        """Positions over the width of the bearing, 0 at its near end z = -B/2, of positions z over the width of the
        land."""
        centre, width = self.map[0, 3], self.map[2, 3]
        return np.asarray(0.5 + (centre + width * (z - 0.5)) / self.film.section.bearing_width)

    def motion_of(self, ends: Array) -> Motion:
        """A journal that stands with displacements (2, 2) over the clearance at the ends of its bearing."""
        near, far = (ends[0] + z * (ends[1] - ends[0]) for z in self.places(np.array([0.0, 1.0])))
        middle, slope = 0.5 * (near + far), far - near
        return Motion((middle[0], middle[1]), (0.0, 0.0), 0.0, (slope[0], slope[1]))

    def motion(self, place: Array, rate: Array, total: float) -> Motion:
        """Of the journal over the land, from its coordinates in m and rad, their rates, and omega_J + omega_S."""
        u, v = (self.map @ each / self.film.section.clearance for each in (place, rate))
        return Motion((u[0], u[1]), (v[0], v[1]), total, (u[2], u[3]), (v[2], v[3]))


@dataclass(frozen=True)
class TiltedFilm:
    """A whole bearing whose journal tilts. section: over the whole width, or one of the two next to a groove in the
    middle."""

    section: Section
    lands: tuple[TiltedLand, ...]

    @property
    def along(self) -> int:
        """Cells along the whole width."""
        return sum(land.film.grid.shape[1] for land in self.lands)

    def at_ends(self, journal: Array) -> Array:
        """(2, 2, ...) displacement at both ends of the bearing, of a journal (4, ...)."""
        x, y, tilt_x, tilt_y = journal
        half = 0.5 * self.section.bearing_width
        return np.asarray([(x + z * tilt_y, y - z * tilt_x) for z in (-half, half)])

    def ends(self, place: Array) -> Array:
        """(2, 2) displacements over the clearance at both ends of the bearing of a journal at `place` (4,)."""
        return self.at_ends(place) / self.section.clearance

    def finer(self, cells: tuple[int, int]) -> TiltedFilm:
        """The same film on other cells, see tilted_film."""
        land = self.lands[0]
        mirrored = len(self.lands) == 1 and land.map[2, 3] < 0.0
        return tilted_film(self.section, land.film.law, cells, land.film.scales.reference, mirrored)


def tilted_film(
    section: Section, law: Law, cells: tuple[int, int], reference: float, mirrored: bool = False
) -> TiltedFilm:
    """A bearing of a section over its whole width, see whole_width, or of two next to a groove.

    cells: around, equal ones, and along the whole width; reference: see VolumeFilm; mirrored: see lands.
    """
    lands, (around, along) = [], cells
    sections = parts(section, mirrored)
    spans = [(groove.position, 0.5 * groove.opening) for groove in section.grooves]
    edges = np.array([middle + side * half for middle, half in spans for side in (-1.0, 1.0)])
    ring = graded_ring(around, 0.0, 1.0, edges, exact=True)
    for one, side, centre in sections:
        grid = volume_grid(one, ring, *tilted_cells(along // len(sections)))
        width = side * one.width
        by_tilt = np.array([[0.0, centre], [-centre, 0.0], [0.0, width], [-width, 0.0]])
        plane = np.vstack([np.eye(2), np.zeros((2, 2))])
        lands.append(TiltedLand(VolumeFilm(one, grid, law, reference), np.hstack([plane, by_tilt])))
    return TiltedFilm(section, tuple(lands))


def tilted_force(
    film: TiltedFilm, place: Array, rate: Array, total: float, start: Array | None = None
) -> FilmForce:
    """Force and moments (4,) in N and N m of a whole film whose oil has settled, and derivatives (4, 4).

    place, rate: (4,) coordinates of the journal in m and rad, and their rates; total: omega_J + omega_S; start: (lands,
    m, k) field of a motion near by, if one is known. Raises NotConverged.
    """
    if np.linalg.norm(film.ends(place), axis=1).max() >= 1.0:
        raise FilmUnsolved("the journal touches its shell at an end")
    force, by_place, by_rate, spun = np.zeros(4), np.zeros((4, 4)), np.zeros((4, 4)), np.zeros(4)
    fields, slopes = [], []
    for number, land in enumerate(film.lands):
        motion, to_u = land.motion(place, rate, total), land.map / land.film.section.clearance
        solver, solution = _solved(land.film, motion, None if start is None else start[number])
        loads, changes = _land_force(solver, motion, solution)
        by_u, by_v, by_total = np.split(changes.loads, BY_TOTAL, axis=1)
        force += land.map.T @ loads
        by_place += land.map.T @ by_u @ to_u
        by_rate += land.map.T @ by_v @ to_u
        spun += land.map.T @ by_total[:, 0]
        fields.append(solution.w)
        slopes.append((changes.field[:, :, :COORDINATES] @ to_u, changes.field[:, :, -1]))
    law, followed = film.lands[0].film.law, None
    if law.keeps_oil and not law.carries_gas:
        moved, faster = (np.array(each) for each in zip(*slopes, strict=True))
        followed = FieldSlopes(place, total, moved, faster, np.zeros_like(faster), spun)
    return FilmForce(force, by_place, by_rate, np.array(fields), slopes=followed)


def settled_force(film: TiltedFilm, place: Array, rate: Array, total: float) -> Array:
    """The force and moments of tilted_force alone. Raises NotConverged."""
    force = np.zeros(COORDINATES)
    for land in film.lands:
        solution = land_solution(land.film, land.motion(place, rate, total))
        force += land.map.T @ _loads(land.film, land.film.mean_pressure(solution.state))
    return force


def land_solution(film: VolumeFilm, motion: Motion) -> VolumeSolution:
    """The steady solution of a land. Raises FilmUnsolved."""
    return _solved(film, motion, None)[1]


def _solved(film: VolumeFilm, motion: Motion, start: Array | None) -> tuple[FilmSolver, VolumeSolution]:
    """The steady solution of a land, sought from the field `start`, then from a full film. Raises FilmUnsolved."""
    solver = FilmSolver(film_at(film, math.hypot(*motion.d), motion.omega))
    try:
        return solver, solver.steady(motion, start)
    except FilmUnsolved:
        if start is None:
            raise
        return solver, solver.steady(motion)


class LandChanges(NamedTuple):
    """What changes with u, with its rate and with omega_J + omega_S: of the field (m, k, 9) and of the loads (4, 9), in
    N, N s and N s."""

    field: Array
    loads: Array


def _land_force(solver: FilmSolver, motion: Motion, solution: VolumeSolution) -> tuple[Array, LandChanges]:
    """Loads (4,) that belong to u in N, and what they and the field change with."""
    film, state, (m, k) = solver.film, solution.state, solver.film.grid.shape
    stencil, *slopes = land_slopes(solver, motion, solution)
    fields = np.concatenate([np.zeros((m, k, k)), *(-each for each in slopes)], axis=2)
    solve_blocks(stencil, np.zeros((m, k, k)), fields, stencil[0, 0], fields[0, 0])
    changes = fields[:, :, k:]
    loads = [_loads(film, mean_change(film, state, changes[:, :, i])) for i in range(changes.shape[2])]
    return _loads(film, film.mean_pressure(state)), LandChanges(changes, np.array(loads).T)


def land_slopes(
    solver: FilmSolver, motion: Motion, solution: VolumeSolution
) -> tuple[Array, Array, Array, Array]:
    """Derivatives of the balances of the cells of a land in its settled state: the stencil (ENTRIES, m, k) by their
    unknowns, and (m, k, 4) by u and by its rate, (m, k, 1) by omega_J + omega_S, in which they are linear."""
    (m, k), pace = solution.w.shape, math.copysign(max(abs(motion.omega), 1.0), motion.omega)
    states, nothing = np.zeros((STATES, m, k)), np.zeros((m, k))
    states[:CARRIED_GAS], states[BEFORE_UPSTREAM] = astuple(solution.state), solution.before
    turned = solver.leaving(replace(motion, omega=motion.omega + pace), states, nothing)
    both, moving = (solver.leaving(motion, states, nothing, g) for g in (1.0, 0.0))
    return solver.stencil.copy(), (both - moving)[:, :, 1:], moving[:, :, 1:], (turned - moving)[:, :, :1] / pace


def unit_loads(film: VolumeFilm) -> Array:
    """(4, n) of _loads per unit of the pressure of each cell."""
    unit = pushing(film)
    return np.concatenate([unit, (film.grid.height - 0.5) * unit]).reshape(COORDINATES, -1)


def _loads(film: VolumeFilm, pressure: Array) -> Array:
    """(4,) loads that belong to u in N, of scaled gauge pressures (m, k)."""
    return np.array([*pushed(film, pressure), *pushed(film, (film.grid.height - 0.5) * pressure)])
