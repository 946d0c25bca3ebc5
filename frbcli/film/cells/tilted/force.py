"""Force and moments of a steady film whose journal moves and tilts, with all derivatives.

The coordinates q = (x, y, tilt_x, tilt_y) of the journal in the middle of the bearing move the journal over a land by
u = P q / C, its displacement in the middle of the land and the growth of this over the width, over the clearance. The
loads of the land that belong to u do the same virtual work as force and moments: these are P^T of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES, solve_blocks
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import pushed, pushing
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.mesh.tilted import tilted_cells
from frbcli.film.cells.motion import Motion, Storage
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.steady_force import film_at
from frbcli.film.cells.tilted.clipped import mean_change
from frbcli.film.cells.tilted.lands import parts
from frbcli.film.gap import Section, gap_rate, graded_ring
from frbcli.film.grid import Array
from frbcli.film.rectangles.film import FilmForce

COORDINATES = 4  # of the journal: its displacement along x and y, and its tilts about them
STEP = 1e-3  # of the gap: differences of five points are exact for the cubes of gaps
POINTS = ((-2.0, 1.0 / 12.0), (-1.0, -2.0 / 3.0), (1.0, 2.0 / 3.0), (2.0, -1.0 / 12.0))


@dataclass(frozen=True)
class TiltedLand:
    """A land on its cells, of a law that does not follow the motion. map: P, (4, 4), see above."""

    film: VolumeFilm
    map: Array

    def places(self, z: Array) -> Array:
        """Where positions z over the width of the land lie over that of the bearing, 0 at its near end z = -B/2."""
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
    """A whole bearing whose journal tilts. section: over the whole width, or one of the two beside a groove in the
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
    """A bearing of a section over its whole width, see whole_width, or of two beside a groove.

    cells: around, equal ones, and along the whole width; reference: see VolumeFilm; mirrored: see lands.
    """
    lands, (around, along) = [], cells
    sections = parts(section, mirrored)
    spans = [(groove.position, 0.5 * groove.opening) for groove in section.grooves]
    edges = np.array([middle + side * half for middle, half in spans for side in (-1.0, 1.0)])
    ring = graded_ring(around, 0.0, 1.0, edges)
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
    force, by_place, by_rate, fields = np.zeros(4), np.zeros((4, 4)), np.zeros((4, 4)), []
    for number, land in enumerate(film.lands):
        clearance, motion = land.film.section.clearance, land.motion(place, rate, total)
        solution = land_solution(land.film, motion, None if start is None else start[number])
        loads, by_u, by_v = _land_force(land.film, motion, solution)
        force += land.map.T @ loads
        by_place += land.map.T @ by_u @ land.map / clearance
        by_rate += land.map.T @ by_v @ land.map / clearance
        fields.append(solution.w)
    return FilmForce(force, by_place, by_rate, np.array(fields))


def settled_force(film: TiltedFilm, place: Array, rate: Array, total: float) -> Array:
    """The force and moments of tilted_force alone. Raises NotConverged."""
    force = np.zeros(COORDINATES)
    for land in film.lands:
        solution = land_solution(land.film, land.motion(place, rate, total))
        force += land.map.T @ _loads(land.film, land.film.mean_pressure(solution.state))
    return force


def land_solution(film: VolumeFilm, motion: Motion, start: Array | None = None) -> VolumeSolution:
    """The steady solution of a land, sought from the field `start`, then from a full film. Raises FilmUnsolved."""
    solver = FilmSolver(film_at(film, math.hypot(*motion.d), motion.omega))
    try:
        return solver.steady(motion, start)
    except FilmUnsolved:
        if start is None:
            raise
        return solver.steady(motion)


def _land_force(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> tuple[Array, Array, Array]:
    """Loads (4,) that belong to u in N, and their derivatives (4, 4) by u in N and by its rate in N s."""
    state, (m, k) = solution.state, film.grid.shape
    stencil, by_u, by_v = land_slopes(film, motion, solution)
    fields = np.concatenate([np.zeros((m, k, k)), -by_u, -by_v], axis=2)
    solve_blocks(stencil, np.zeros((m, k, k)), fields, stencil[0, 0], fields[0, 0])
    changes = np.array([_loads(film, mean_change(film, state, fields[:, :, k + i])) for i in range(2 * COORDINATES)])
    return _loads(film, film.mean_pressure(state)), changes[:COORDINATES].T, changes[COORDINATES:].T


def land_slopes(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> tuple[Array, Array, Array]:
    """Derivatives of the balances of the cells of a land in its settled state: the stencil (ENTRIES, m, k) by their
    unknowns, and (m, k, 4) by u and by its rate."""
    grid, state = film.grid, solution.state
    balance = CellBalances(film.section, grid, motion, solution.before)
    storage = Storage(gap_rate(motion.velocity_at(grid.height), grid.centre[:, None]), np.zeros(grid.shape))
    _, entries = balance.residual(state, storage)
    stencil = np.zeros((ENTRIES, *grid.shape))
    stencil[CENTRE], stencil[BEFORE], stencil[BEHIND] = entries.centre, entries.before, entries.behind
    stencil[BELOW], stencil[ABOVE] = entries.below, entries.above
    stored = np.where(grid.fixed, 0.0, grid.area * state.fraction)
    numbers = range(COORDINATES)
    by_u = np.stack([_by_place(film, motion, solution, i) for i in numbers], axis=2)
    by_v = np.stack([stored * gap_rate(_unit(i, grid.height), grid.centre[:, None]) for i in numbers], axis=2)
    return stencil, by_u, by_v


def _unit(i: int, z: Array) -> tuple[Array, Array]:
    """(k,) displacement along x and y at positions z (k,) over the width, of coordinate i of u."""
    along = np.ones_like(z) if i < 2 else z - 0.5
    return (along, 0.0 * along) if i % 2 == 0 else (0.0 * along, along)


def _by_place(film: VolumeFilm, motion: Motion, solution: VolumeSolution, i: int) -> Array:
    """(m, k) derivative by coordinate i of u of what flows out of each cell."""
    grid, state = film.grid, solution.state
    step = STEP * (1.0 - math.hypot(*motion.d) - 0.5 * math.hypot(*motion.slope))
    step = max(step, STEP * STEP)
    total = np.zeros(grid.shape)
    for side, weight in POINTS:
        u = np.array([*motion.d, *motion.slope])
        u[i] += side * step
        moved = replace(motion, d=(u[0], u[1]), slope=(u[2], u[3]))
        fluxes, _, _ = CellBalances(film.section, grid, moved, solution.before).fluxes(state.pressure, state.fraction)
        total += weight / step * fluxes.net_outflow(grid.share)
    return np.where(grid.fixed, 0.0, total)


def unit_loads(film: VolumeFilm) -> Array:
    """(4, n) of _loads per unit of the pressure of each cell."""
    unit = pushing(film)
    return np.concatenate([unit, (film.grid.height - 0.5) * unit]).reshape(COORDINATES, -1)


def _loads(film: VolumeFilm, pressure: Array) -> Array:
    """(4,) loads that belong to u in N, of scaled gauge pressures (m, k)."""
    return np.array([*pushed(film, pressure), *pushed(film, (film.grid.height - 0.5) * pressure)])
