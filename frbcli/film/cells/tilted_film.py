"""Films whose journals tilt as arrays for the compiled kernels: the lands of all films of a machine side by side.

The coordinates of a journal are its displacements at both ends of its bearing, over the clearance: (near x, near y,
far x, far y), near at z = -B/2. In between its displacement is linear along the axis, and so is the gap.

Force and moments of a steady film whose journal moves and tilts, with all derivatives.

The coordinates q = (x, y, tilt_x, tilt_y) of the journal in the middle of the bearing move the journal over a land by
u = P q / C, its displacement in the middle of the land and the growth of this over the width, over the clearance. The
loads of the land that belong to u do the same virtual work as force and moments: these are P^T of them.

The bearing is made of the lands that are solved for it, whose loads are summed. It is also linearised about its settled
state, with the oil of its cells as states.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices
from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.block_cyclic import TILTED, ring_solver
from frbcli.film.cells.data import TIGHTLY, Records, places_along, volume_films
from frbcli.film.cells.film import Motion, Path, VolumeFilm, VolumeSolution
from frbcli.film.cells.linearised import LinearFilm, film_at, film_changes, linear_cells, lying, settled_states
from frbcli.film.cells.loads import FilmLoads, GasBalance, OilBalance, Torque, pushed, pushing
from frbcli.film.cells.mesh.grid import tilted_cells, volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section, graded_ring
from frbcli.film.rectangles.film import FieldSlopes, FilmForce


class TiltedVolumes(NamedTuple):
    """Lands of equal numbers of cells m x k; films, ring, cells: as VolumeFilms has them, of each land.

    places: (lands, PLACES, k + 1) along the axis of the bearing; first: (films + 1,) first land of each film, and their
    number.
    """

    films: Records
    ring: Array
    cells: Array
    places: Array
    first: Indices


def tilted_volumes(
    films: Sequence[TiltedFilm], settled: float = TIGHTLY, centrifugal: Sequence[float] = ()
) -> TiltedVolumes:
    """The films as arrays; all lands have grids of the same shape. settled, centrifugal (films,): see FILM."""
    lands = [land for film in films for land in film.lands]
    drops = [drop for film, drop in zip(films, centrifugal, strict=False) for _ in film.lands]
    data = volume_films([land.film for land in lands], drops, settled)
    k = lands[0].film.grid.shape[1]
    grids = [land.film.grid for land in lands]
    places = np.array([
        places_along(land.places(grid.height), land.places(grid.z), np.diff(grid.z))
        for land, grid in zip(lands, grids, strict=True)
    ])  # fmt: skip
    data.films["solver_at"] = ring_solver(k, TILTED)
    first = np.cumsum([0, *(len(film.lands) for film in films)])
    return TiltedVolumes(data.films, data.ring, data.cells, places, first)


@dataclass(frozen=True)
class Land:
    """A section of a bearing with the motion that it sees.

    side: 1, or -1 where z of the section runs against z of the bearing; centre: of the middle of the section, in m from
    the bearing's. """

    section: Section
    motion: Motion
    side: float
    centre: float

    def moment(self, loads: FilmLoads) -> tuple[float, float]:
        """Moments in N m about the middle of the bearing, from those about the middle of the section."""
        x, y = loads.force
        return self.side * loads.moment[0] - self.centre * y, self.side * loads.moment[1] + self.centre * x


def lands(section: Section, motion: Motion, mirrored: bool) -> tuple[Land, ...]:
    """The lands of a bearing: its section, or the two next to a groove in the middle where they differ.

    motion: of the bearing, its slopes over the whole width; mirrored: whether z of a single section runs against z of
    the bearing. """
    if not motion.tilts:
        return (Land(section, motion, -1.0 if mirrored else 1.0, 0.0),)
    return tuple(_land(one, motion, side, centre) for one, side, centre in parts(section, mirrored))


def parts(section: Section, mirrored: bool) -> tuple[tuple[Section, float, float], ...]:
    """The sections that a bearing whose journal tilts is solved on, with side and centre of each, see Land."""
    if section.copies == 1:
        return ((section, -1.0 if mirrored else 1.0, 0.0),)
    one = replace(section, copies=1)
    return tuple((one, side, -side * 0.5 * section.width) for side in (1.0, -1.0))


def land_paths(section: Section, path: Path, mirrored: bool) -> tuple[tuple[Section, Path], ...]:
    """The section of each of the lands, and the motion that it sees over time while the bearing sees `path`."""

    def path_of(number: int) -> Path:
        return lambda time: lands(section, path(time), mirrored)[number].motion

    return tuple((land.section, path_of(number)) for number, land in enumerate(lands(section, path(0.0), mirrored)))


def _land(section: Section, motion: Motion, side: float, centre: float) -> Land:
    place, share = centre / section.bearing_width, side * section.width / section.bearing_width
    moved = [
        ((middle[0] + place * growth[0], middle[1] + place * growth[1]), (share * growth[0], share * growth[1]))
        for middle, growth in ((motion.d, motion.slope), (motion.v, motion.slope_rate))
    ]
    (d, slope), (v, slope_rate) = moved
    return Land(section, Motion(d, v, motion.omega, slope, slope_rate), side, centre)


def summed(films: Sequence[tuple[Land, FilmLoads]]) -> FilmLoads:
    """The loads of a bearing, summed over its lands."""
    loads = [each for _, each in films]
    moments = [land.moment(each) for land, each in films]
    if len(loads) == 1:
        return replace(loads[0], moment=moments[0])
    oil = [each.oil for each in loads]
    passed = [max(each.in_m3_s, each.out_m3_s) for each in oil]
    lost = sum(each.defect_relative * size for each, size in zip(oil, passed, strict=True))
    return FilmLoads(
        force=_sum([each.force for each in loads]),
        torque=Torque(sum(each.torque.couette for each in loads), sum(each.torque.poiseuille for each in loads)),
        p_max=max(each.p_max for each in loads),
        p_min=min(each.p_min for each in loads),
        oil_fraction=sum(each.oil_fraction for each in loads) / len(loads),
        oil=OilBalance(
            sum(each.in_m3_s for each in oil),
            sum(each.out_m3_s for each in oil),
            sum(each.supply_m3_s for each in oil),
            sum(each.ends_m3_s for each in oil),
            lost / sum(passed) if sum(passed) > 0.0 else 0.0,
        ),
        moment=_sum(moments),
        gas=_gas([each.gas for each in loads if each.gas is not None]),
    )


def _gas(parts: Sequence[GasBalance]) -> GasBalance | None:
    """The gas of a bearing, summed over its lands, which hold about as much oil."""
    if not parts:
        return None
    return GasBalance(
        sum(each.share for each in parts) / len(parts),
        sum(each.in_m3_s for each in parts),
        sum(each.out_m3_s for each in parts),
        sum(each.released_m3_s for each in parts),
        max(each.defect_relative for each in parts),
    )


def _sum(vectors: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return sum(x for x, _ in vectors), sum(y for _, y in vectors)


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
        changes, by_changes = film_changes(solver, motion, settled_states(solution), tilts=True)
        by_u, by_v, by_total = np.split(by_changes, BY_TOTAL, axis=1)
        force += land.map.T @ _loads(land.film, solver.film.mean_pressure(solution.state))
        by_place += land.map.T @ by_u @ to_u
        by_rate += land.map.T @ by_v @ to_u
        spun += land.map.T @ by_total[:, 0]
        fields.append(solution.w)
        slopes.append((changes[:, :, 1 : 1 + COORDINATES] @ to_u, changes[:, :, -1]))
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


def unit_loads(film: VolumeFilm) -> Array:
    """(4, n) of _loads per unit of the pressure of each cell."""
    unit = pushing(film)
    return np.concatenate([unit, (film.grid.height - 0.5) * unit]).reshape(COORDINATES, -1)


def _loads(film: VolumeFilm, pressure: Array) -> Array:
    """(4,) loads that belong to u in N, of scaled gauge pressures (m, k)."""
    return np.array([*pushed(film, pressure), *pushed(film, (film.grid.height - 0.5) * pressure)])


def linear_tilted(
    film: TiltedFilm, share: float, place: Array, total: float, start: Array | None = None
) -> LinearFilm:
    """The film, on cells that lie by a share of one further around, with its journal at rest at `place` (4,) in m and
    rad. film: of a law whose forces are the pressures of its cells; total: omega_J + omega_S in rad/s; start: (lands,
    m, k) field to begin from. Raises NotConverged."""
    from scipy.sparse import block_diag  # takes long to load

    lands = [
        _linear_land(TiltedLand(lying(land.film, share), land.map), place, total, None if start is None else field)
        for land, field in zip(film.lands, film.lands if start is None else start, strict=True)
    ]
    return LinearFilm(
        flow=block_diag([land.flow for land in lands], "csc"),
        storage=block_diag([land.storage for land in lands], "csc"),
        by_place=np.vstack([land.by_place for land in lands]),
        by_rate=np.vstack([land.by_rate for land in lands]),
        by_total=np.concatenate([land.by_total for land in lands]),
        push=np.hstack([land.push for land in lands]),
        sheared=np.concatenate([land.sheared for land in lands]),
        field=np.array([land.field for land in lands]),
        ordered=all(land.ordered for land in lands),
    )


def _linear_land(land: TiltedLand, place: Array, total: float, start: Array | None) -> LinearFilm:
    film, motion = land.film, land.motion(place, np.zeros(COORDINATES), total)
    solver, to_u = FilmSolver(film), land.map / film.section.clearance
    solution = solver.steady(motion, start, upwind=True)
    full = np.zeros(film.grid.shape)  # films that follow a tilt have the torque of a full one
    cells = linear_cells(solver, motion, solution, full, tilts=True)
    return replace(
        cells, by_place=cells.by_place @ to_u, by_rate=cells.by_rate @ to_u, push=land.map.T @ cells.push
    )  # fmt: skip
