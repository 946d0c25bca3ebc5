"""A planned case as a rotor, its speed and its films: what every study starts from.

Here, and nowhere else, the form that a plan has chosen becomes a kind of films. The machine of a run has a system for
each segment of time in which its clearances and its unbalance stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.film import FilmGeometry
from frbcli.case.schema import Case
from frbcli.elements.pin import held_by_pins, pin_rows
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cells.channels import with_channels
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.tilted_film import tilted_film
from frbcli.film.gap import Section, whole_width
from frbcli.film.grid import Mesh
from frbcli.film.kinds.cells import CellFilms
from frbcli.film.kinds.contract import Films, NoFilms, RectangleFilms, SolutionFilms
from frbcli.film.kinds.tilted import InclinedFilms, TiltedFilms
from frbcli.film.penalty_table.film import SourceFilm
from frbcli.film.rectangles.film import FilmForce, make_film
from frbcli.film.roughness.asperities import Asperities, make_asperities
from frbcli.film.roughness.contact import ElasticShell, Rubbing
from frbcli.rotor.assembly import COORDINATES, PLANE, LinearRotor
from frbcli.scene.changes import case_at, change_times, step_times
from frbcli.scene.films import (
    FilmPlace,
    centrifugal_pressures,
    coupled_channels,
    film_places,
    film_section,
    make_law,
    turning,
    turning_rings,
    turns_with_oil,
    volume_film,
)
from frbcli.scene.forms import NO_FILM, SOLUTIONS
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.cell_choice import compared_states
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.tilted import CELLS, INCLINED, TILTED, cells_of

# What the balances of a film may be off by over its pace: over the tolerance of a step, and its limits. A film that is
# off by 1e-4 of its pace in each stage leaves 1e-6 of the clearance in a run.
COARSEST = 8, 2  # cells of a film whose section and law alone are taken
SETTLED_OVER_TOLERANCE, SETTLED_RANGE = 4.0, (2e-5, 1e-3)


def make_films(case: Case, plan: Plan, top_Hz: float | None = None) -> Films:
    """The films of a case as its plan has them, tabulated where they have tables. top_Hz: largest speed of the rotor,
    default the one of the run."""
    makers = {NO_FILM: lambda *_: NoFilms(), CELLS: _cells, SOLUTIONS: _solutions}
    makers |= {TILTED: _tilted, INCLINED: _inclined}
    return makers.get(plan.form, _rectangles)(case, plan, top_Hz)


def _clearances(case: Case) -> tuple[float, ...]:
    return tuple(place.geometry.clearance for place in film_places(case))


def _cells(case: Case, plan: Plan, top_Hz: float | None) -> Films:
    cells, places = cells_of(plan), film_places(case)
    volumes = tuple(volume_film(case, place, cells, top_Hz, plan.edged) for place in places)
    drops = centrifugal_pressures(case, [film.section for film in volumes])
    data = volume_films(volumes, drops, settled_share(plan.tolerance))
    data = with_channels(data, volumes, coupled_channels(case, volumes))
    return CellFilms(
        clearances=_clearances(case),
        own=volumes,
        data=data,
        cells=cells,
        factor=case.film.cavitation_factor,
        states=compared_states(cells),
        viscosity=case.oil_viscosity,
        exponents=np.array([_exponents(case, *each) for each in zip(places, volumes, strict=True) if case.heat]),
    )


def _exponents(case: Case, place: FilmPlace, film: VolumeFilm) -> Array:
    """(p,) powers of the scale of the pressures that the parameters of a film's law are proportional to; 0 of those
    that are 0 or infinite, as the bulk modulus of oil that does not give way, and remain so."""
    cavitation, section = case.cavitation(place.geometry), film.section
    doubled = replace(section, viscosity=2.0 * section.viscosity)
    first, last = (given_parameters(make_law(case, cavitation, each)) for each in (section, doubled))
    some = (first != 0.0) & np.isfinite(first)
    return np.where(some, np.log2(np.where(some, last, 1.0) / np.where(some, first, 1.0)), 0.0)


def settled_share(tolerance: float) -> float:
    """What the balances of the cells may be off by in a stage, over the pace of their film; tolerance: of a step."""
    tightest, loosest = SETTLED_RANGE
    return min(max(SETTLED_OVER_TOLERANCE * tolerance, tightest), loosest)


def _solutions(case: Case, plan: Plan, _: float | None) -> Films:
    places = [place.geometry for place in film_places(case)]
    solved = tuple(source_film(case, geometry, plan.mesh) for geometry in places)
    sections = tuple(whole_section(case, geometry) for geometry in places)
    data = tuple(film.film() for film in solved)
    return SolutionFilms(_clearances(case), data, sections, solved=solved, mesh=plan.mesh)


def source_film(case: Case, geometry: FilmGeometry, mesh: Mesh) -> SourceFilm:
    """A penalty film without openings, as it is tabulated for a run."""
    section = film_section(case, geometry)
    law = make_law(case, case.cavitation(geometry), section)
    assert isinstance(law, Penalty)
    return SourceFilm(section, law, mesh)


def _tilted(case: Case, plan: Plan, top_Hz: float | None) -> TiltedFilms:
    places, cells = film_places(case), cells_of(plan)
    misalignments = np.array([place.misalignment for place in places])
    flat = [volume_film(case, place, COARSEST, top_Hz) for place in places]
    sections = [whole_width(film.section) for film in flat]
    lands = min((section.copies for section in sections), default=1)  # lands of all films have equal numbers of cells
    own = tuple(
        tilted_film(section, film.law, (cells[0], cells[1] * section.copies // lands), film.scales.reference,
                    place.geometry.supply.mirrored)
        for place, film, section in zip(places, flat, sections, strict=True)
    )  # fmt: skip
    drops = centrifugal_pressures(case, sections)
    return TiltedFilms(
        _clearances(case), own, misalignments, cells, settled_share(plan.tolerance), compared_states(cells), drops
    )


def _inclined(case: Case, plan: Plan, top_Hz: float | None) -> Films:
    return InclinedFilms(_clearances(case), _tilted(case, plan, top_Hz))


def _rectangles(case: Case, plan: Plan, _: float | None) -> Films:
    sections = tuple(whole_section(case, place.geometry) for place in film_places(case))
    laws, meshes = case.cavitations, tuple(mesh for _, mesh in plan.films)
    films = zip(sections, laws, meshes, strict=True)
    data = tuple(make_film(section, plan.theory, law, mesh) for section, law, mesh in films)
    return RectangleFilms(_clearances(case), data, sections, laws=laws, theory=plan.theory, mesh=plan.mesh)


def whole_section(case: Case, film: FilmGeometry) -> Section:
    """The section of a film over the whole width, see whole_width of film/gap.py."""
    return whole_width(film_section(case, film))


@dataclass(frozen=True)
class System:
    """A machine.

    rotor: the linear system; films: see Films; names: of the films. bodies: (films, 2) what lies inside and outside of
    each film, see FilmPlace; turning: see RotorData; drags: eta R^3 B / C of each whole bearing in N m s, the Couette
    torque per slip and drag_integral; ring_count: of rings that turn; laws: names of the films' cavitation models;
    torque: see FilmModel; own_length: see length, 0 of a machine with films; asperities: of rough surfaces; pins:
    (rings or 0, PIN) of the rings, see solve/inputs.py; shell: in which smooth surfaces rest where nothing else carries
    them, None where contact ends a run; free_speed: whether the rotor's speed is free; its angle then comes before the
    angles of the rings. """

    rotor: LinearRotor
    films: Films
    names: tuple[str, ...]
    bodies: NDArray[np.int64]
    turning: Array
    drags: tuple[float, ...]
    ring_count: int = 0
    laws: tuple[str, ...] = ()
    torque: str = "all"
    own_length: float = 0.0
    asperities: Asperities | None = None
    pins: Array = field(default_factory=lambda: pin_rows(()))
    shell: ElasticShell | None = None
    free_speed: bool = False

    def force(
        self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None, slip: float | None = None
    ) -> FilmForce:
        """Force and derivatives of film i, see Films, and of its rough surfaces. slip: omega_J - omega_S; without it
        their friction has the sense of the total, omega_J + omega_S: a ring turns more slowly than its rotor."""
        if self.shell is not None:
            return self.shell.force(
                lambda felt, felt_rate: self.films.force(i, felt, felt_rate, total, near), place, rate,
                self.clearances[i],
            )  # fmt: skip
        slip = total if slip is None else slip
        film = self.films.force(i, place, rate, total, near)
        return self.rubbing(i).with_summits(film, place, rate, slip, 0.5 * (total - slip))

    def felt(self, i: int, place: Array) -> Array:
        """(coordinates,) what film i feels of a journal at a place: an elastic shell keeps a gap."""
        return place if self.shell is None else self.shell.felt(place, self.clearances[i])

    def rubbing(self, i: int) -> Rubbing:
        """The summits of film i."""
        return Rubbing(self.asperities, i, self.clearances[i])

    @property
    def clearances(self) -> tuple[float, ...]:
        """(films,) m."""
        return self.films.clearances

    @property
    def length(self) -> float:
        """Length in m by which displacements outside of films are divided: the clearance of the first film, or without
        films a length of the machine (reference_length)."""
        return self.clearances[0] if self.clearances else self.own_length

    def journals_of(self, q: Array) -> Array:
        """(films, coordinates, ...) where the journals are in their shells, of displacements q (n, ...)."""
        moved = self.rotor.journals @ q
        standing = self.films.standing
        return np.asarray(moved + standing.reshape(*standing.shape, *(1,) * (q.ndim - 1)))

    def eccentricities(self, q: Array) -> Array:
        """(films, ...) largest eccentricity along each film, of displacements q (n, ...)."""
        ends = self.films.seen(self.journals_of(q))
        ratios = np.hypot(ends[:, 0], ends[:, 1]).reshape(len(self.names), self.films.stations, *q.shape[1:])
        return np.asarray(ratios.max(axis=1) / np.reshape(self.clearances, (-1, *(1,) * (q.ndim - 1))))

    @property
    def remembering(self) -> tuple[bool, ...]:
        """Which films keep oil of their own."""
        return self.films.remembering

    @property
    def remembers(self) -> bool:
        """Whether any film is mass-conserving."""
        return any(self.remembering)

    @property
    def spins(self) -> tuple[int, ...]:
        """Degrees of freedom in which the rings turn."""
        return tuple(range(self.rotor.size - self.ring_count, self.rotor.size))

    @property
    def rotation(self) -> int | None:
        """Degree of freedom in which a rotor turns whose speed is free, None of any other."""
        return self.rotor.size - self.ring_count - 1 if self.free_speed else None

    @property
    def pinned(self) -> NDArray[np.bool_]:
        """(rings,) which of them a pin holds, at rest: their films pull at them in one sense."""
        return held_by_pins(self.pins, self.ring_count)

    def omegas(self, omega: float, ring_speeds: Array) -> Array:
        """(films,) omega_J + omega_S of each film, rad/s."""
        return np.asarray(self.turning[:, 0] @ np.concatenate([[omega], ring_speeds]), dtype=np.float64)

    def slips(self, omega: float, ring_speeds: Array) -> Array:
        """(films,) omega_J - omega_S of each film, rad/s."""
        return np.asarray(self.turning[:, 1] @ np.concatenate([[omega], ring_speeds]), dtype=np.float64)

    @property
    def rough_rings(self) -> bool:
        """Whether the friction of rough surfaces turns rings, or holds them."""
        return self.asperities is not None and self.ring_count > 0

    def motions(self, sample: Array) -> Iterator[tuple[Array, Array, float]]:
        """Place and rate of the journal of each film in its shell, see Films, and omega_J + omega_S in rad/s. sample:
        (2 n + 1 ...) q, v and the speed of the rotor in rad/s."""
        n = self.rotor.size
        q, v = sample[:n], sample[n : 2 * n]
        omegas = self.omegas(float(sample[2 * n]), v[list(self.spins)]).tolist()
        for selection, place, total in zip(self.rotor.journals, self.journals_of(q), omegas, strict=True):
            yield place, selection @ v, total


def make_system(
    case: Case, plan: Plan, rotor: LinearRotor | None = None, top_Hz: float | None = None, free_speed: bool = False
) -> System:
    """The system of a case; its films are tabulated here. rotor: default: of the case; top_Hz: largest speed of the
    rotor, default: of the run; free_speed: whether its speed is free."""
    places, ringed = film_places(case), turning_rings(case)
    films = make_films(case, plan, top_Hz)
    with_oil = [plan.form.by_cells and turns_with_oil(case, place) for place in places]
    return System(
        rotor=make_rotor(case, COORDINATES[: films.coordinates], free_speed) if rotor is None else rotor,
        films=films,
        names=tuple(place.name for place in places),
        bodies=np.array([[place.inside, place.outside] for place in places], dtype=np.int64).reshape(-1, 2),
        turning=turning(places, len(ringed), with_oil),
        drags=tuple(film_drag(case, place.geometry) for place in places),
        ring_count=len(ringed),
        laws=case.cavitations,
        torque=case.film.torque,
        own_length=plan.length,
        asperities=rough_surfaces(case),
        pins=pin_rows([around[0].pin for around in ringed]),
        shell=elastic_shell(case) if films.coordinates == len(PLANE) else None,
        free_speed=free_speed,
    )


def elastic_shell(case: Case) -> ElasticShell | None:
    """The shell of smooth surfaces that give way in contact, None where contact ends a run or asperities touch."""
    contact = case.contact
    if contact.rough or contact.policy != "elastic" or contact.stiffness is None:
        return None
    return ElasticShell(contact.eccentricity, contact.stiffness)


def rough_surfaces(case: Case) -> Asperities | None:
    """The asperities of a case in all of its films, None between smooth surfaces."""
    contact = case.contact
    if contact.roughness is None or contact.summit_radius is None or contact.summit_density is None:
        return None
    films = [place.geometry for place in film_places(case)]
    return make_asperities(
        contact.roughness, contact.summit_radius, contact.summit_density, contact.modulus, contact.hardness,
        contact.friction, 0.5 * np.array([film.diameter for film in films]), np.array([film.width for film in films]),
        contact.mean_height,
    )  # fmt: skip


def rubbing_of(case: Case) -> Rubbing:
    """The summits of the only film of a case."""
    return Rubbing(rough_surfaces(case), 0, film_places(case)[0].geometry.clearance)


def film_drag(case: Case, film: FilmGeometry) -> float:
    """eta R^3 B / C of a whole bearing in N m s, see System."""
    return case.viscosity(film) * (0.5 * film.diameter) ** 3 * film.width / film.clearance


@dataclass(frozen=True)
class Segment:
    """A machine from the time `start` in s on. case: with the clearances and the unbalance that it has then; of
    segments that differ in the unbalance alone the systems have the same films."""

    start: float
    case: Case
    system: System


def make_segments(case: Case, plan: Plan) -> tuple[Segment, ...]:
    """The machine of a case in all segments of a run, the first from its beginning; films are tabulated here."""
    segments, steps = list[Segment](), step_times(case)
    for start in (0.0, *change_times(case)):
        then = case_at(case, start)
        free = case.drive is not None
        if segments and start not in steps:
            before = segments[-1].system
            rotor = make_rotor(then, COORDINATES[: before.films.coordinates], free_speed=free)
            system = replace(before, rotor=rotor)
        else:
            system = make_system(then, plan, free_speed=free)
        segments.append(Segment(start, then, system))
    return tuple(segments)
