"""A planned case as a rotor, its speed and its films: what every study starts from."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.case.bearing import AxialGrooves, FilmGeometry
from frbcli.case.schema import Case
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.channel_data import with_channels
from frbcli.film.cells.data import REMEMBERS, SHEARED, VolumeFilms, volume_films
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.steady_force import steady_force
from frbcli.film.gap import AxialGroove, Section
from frbcli.film.grid import Array, Mesh
from frbcli.film.penalty_table.film import SourceFilm
from frbcli.film.published.data import ElementFilm, element_film
from frbcli.film.published.film import PublishedFilm, published_force
from frbcli.film.rectangles.bearing import RectangularBearing
from frbcli.film.rectangles.film import FilmForce, evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.ring import with_spins
from frbcli.scene.bearing_model_films import bearing_film
from frbcli.scene.bearing_models import GIVEN
from frbcli.scene.channels import coupled_channels
from frbcli.scene.films import (
    centrifugal_pressures,
    film_places,
    make_law,
    turning,
    turning_rings,
    turns_with_oil,
    volume_film,
)
from frbcli.scene.planned import Plan
from frbcli.scene.published import PUBLISHED
from frbcli.scene.rotors import make_rotor
from frbcli.scene.section import film_section
from frbcli.scene.tabulated import SOLUTIONS

# What the balances of a film may be off by over its pace: over the tolerance of a step, and its limits. A film that is
# off by 1e-4 of its pace in each stage leaves 1e-6 of the clearance in a run.
SETTLED_OVER_TOLERANCE, SETTLED_RANGE = 4.0, (2e-5, 1e-3)


@dataclass(frozen=True)
class System:
    """A machine as the time loop takes it.

    rotor: the linear system; films: ready for the time loop, with their names and clearances in m; bearings or volumes:
    their dimensions and oil, of films without or with cells, the other one being empty; published: of the one film in
    the published form, both then being empty.
    solved: what the tables of penalty films are made of. bodies: (films, 2) what lies
    inside and outside of each film, see FilmPlace; turning: see RotorData; drags: eta R^3 B / C of each whole bearing
    in N m s, the Couette torque per slip and drag_integral; ring_count: of rings that turn; laws: names of the
    films' cavitation models; torque, cavitation_factor: see FilmModel. scales: of tabulated films of a warm
    machine, what their tables have to be scaled by, see warm.py. own_length: see length, 0 of a machine with films.
    A machine without films has none of what belongs to them.
    """

    rotor: LinearRotor
    films: tuple[FilmData, ...] | VolumeFilms | ElementFilm
    names: tuple[str, ...]
    clearances: tuple[float, ...]
    bodies: NDArray[np.int64]
    turning: Array
    drags: tuple[float, ...]
    bearings: tuple[RectangularBearing, ...] = ()
    volumes: tuple[VolumeFilm, ...] = ()
    published: PublishedFilm | None = None
    solved: tuple[SourceFilm, ...] = ()
    ring_count: int = 0
    laws: tuple[str, ...] = ()
    torque: str = "all"
    cavitation_factor: str = "none"
    scales: tuple[float, ...] | None = None
    own_length: float = 0.0

    @property
    def length(self) -> float:
        """What displacements count over that are in no film, m: the clearance of the first film, or without films a
        length of the machine (reference_length.py)."""
        return self.clearances[0] if self.clearances else self.own_length

    @property
    def remembering(self) -> tuple[bool, ...]:
        """Which films keep oil of their own."""
        if self.published is not None:
            return (True,)
        if not isinstance(self.films, VolumeFilms):
            return (False,) * len(self.names)
        return tuple(bool(number != 0.0) for number in self.films.numbers[:, REMEMBERS])

    @property
    def remembers(self) -> bool:
        """Whether any film is mass-conserving."""
        return any(self.remembering)

    @property
    def spins(self) -> tuple[int, ...]:
        """Degrees of freedom in which the rings turn."""
        return tuple(range(self.rotor.size - self.ring_count, self.rotor.size))

    @property
    def sheared(self) -> Array:
        """(films,) share of each gap in which oil is sheared: all but its bores and grooves."""
        if not isinstance(self.films, VolumeFilms):
            return np.ones(len(self.names))
        return np.asarray(self.films.cells[:, SHEARED].sum(axis=(1, 2)) / (2.0 * math.pi))

    def omegas(self, omega: float, ring_speeds: Array) -> Array:
        """(films,) omega_J + omega_S of each film, rad/s."""
        return np.asarray(self.turning[:, 0] @ np.concatenate([[omega], ring_speeds]), dtype=np.float64)

    def film_force(
        self, index: int, displacement: Array, velocity: Array, omega: float, near: FilmForce | None = None
    ) -> FilmForce:
        """As film.bearing.evaluate; a mass-conserving film is steady. near: of the film in a motion near by, from which
        it is sought where its oil does not remember. Raises NotConverged."""
        if isinstance(self.films, VolumeFilms):
            start = None if near is None or self.remembering[index] else near.field
            return steady_force(self.volumes[index], displacement, velocity, omega, start)
        if isinstance(self.films, ElementFilm):
            assert self.published is not None
            return published_force(self.published, displacement, velocity, omega)
        if self.scales is not None:
            s, c = self.scales[index], self.clearances[index]
            found = evaluate(self.films[index], c, displacement, s * np.asarray(velocity), s * omega)
            return FilmForce(found.force, found.by_displacement, s * found.by_velocity)
        return evaluate(self.films[index], self.clearances[index], displacement, velocity, omega)


def make_system(case: Case, plan: Plan, rotor: LinearRotor | None = None, top_Hz: float | None = None) -> System:
    """The system of a case; its films are tabulated here. rotor: default that of the case; top_Hz: largest speed of the
    rotor, default that of the run."""
    places, ringed = film_places(case), turning_rings(case)
    rotor = make_rotor(case) if rotor is None else rotor
    if ringed:
        rotor = with_spins(rotor, [bearing.ring.inertia for bearing in ringed])
    system = System(
        rotor=rotor,
        films=(),
        names=tuple(place.name for place in places),
        clearances=tuple(place.geometry.clearance for place in places),
        bodies=np.array([[place.inside, place.outside] for place in places], dtype=np.int64).reshape(-1, 2),
        turning=turning(places, len(ringed), [turns_with_oil(case, place) for place in places]),
        drags=tuple(film_drag(case, place.geometry) for place in places),
        ring_count=len(ringed),
        laws=case.cavitations,
        torque=case.film.torque,
        own_length=plan.length,
    )
    if not places:
        return system
    if plan.cells is not None and plan.form == PUBLISHED:
        film = published_film(case, film_section(case, places[0].geometry), plan.cells)
        return replace(system, films=element_film(film), published=film)
    if plan.cells is not None:
        volumes = tuple(volume_film(case, place, plan.cells, top_Hz) for place in places)
        data = volume_films(volumes, centrifugal_pressures(case, volumes), settled_share(plan.tolerance))
        data = with_channels(data, volumes, coupled_channels(case, volumes))
        factor = case.film.cavitation_factor
        return replace(system, films=data, volumes=volumes, cavitation_factor=factor)
    bearings = tuple(_bearing(case, place.geometry) for place in places)
    if plan.form == GIVEN:
        return replace(system, bearings=bearings, films=tuple(bearing_film(case, bearing) for bearing in bearings))
    if plan.form == SOLUTIONS:
        solved = tuple(source_film(case, place.geometry, plan.mesh) for place in places)
        return replace(system, bearings=bearings, solved=solved, films=tuple(film.film() for film in solved))
    meshes = tuple(mesh for _, mesh in plan.films)
    films = tuple(planned_film(plan, *each) for each in zip(bearings, system.laws, meshes, strict=True))
    return replace(system, bearings=bearings, films=films)


def source_film(case: Case, geometry: FilmGeometry, mesh: Mesh) -> SourceFilm:
    """A penalty film without openings, as it is tabulated for a run."""
    section = film_section(case, geometry)
    law = make_law(case, case.cavitation(geometry), section)
    assert isinstance(law, Penalty)
    return SourceFilm(section, law, mesh)


def published_film(case: Case, section: Section, elements: tuple[int, int]) -> PublishedFilm:
    """The film of a section with elements around and along."""
    two_phase = case.film.two_phase
    return PublishedFilm(section, TwoPhase(two_phase.steepness), two_phase.diffusion, *elements)


def settled_share(tolerance: float) -> float:
    """What the balances of the cells may be off by in a stage, over the pace of their film; tolerance: of a step."""
    tightest, loosest = SETTLED_RANGE
    return min(max(SETTLED_OVER_TOLERANCE * tolerance, tightest), loosest)


def film_drag(case: Case, film: FilmGeometry) -> float:
    """eta R^3 B / C of a whole bearing in N m s, see System."""
    return case.viscosity(film) * (0.5 * film.diameter) ** 3 * film.width / film.clearance


def planned_film(plan: Plan, bearing: RectangularBearing, cavitation: str, mesh: Mesh) -> FilmData:
    """The film that the plan has chosen for a bearing, on a mesh of its own."""
    return make_film(bearing, plan.theory, cavitation, mesh)


def sections_of(film: FilmGeometry) -> int:
    """Equal rectangles that the developed gap consists of, see RectangularBearing."""
    groove = film.supply.kind == "circumferential-groove"
    return 2 if groove and getattr(film.supply, "axial_position", 0.5) == 0.5 else 1


def _bearing(case: Case, film: FilmGeometry) -> RectangularBearing:
    supply = film.supply
    grooves: tuple[AxialGroove, ...] = ()
    if isinstance(supply, AxialGrooves):
        gauge = supply.pressure - case.oil.ambient_pressure
        turn = 2 * math.pi / supply.count
        grooves = tuple(
            AxialGroove(supply.position + turn * i, supply.opening_angle, gauge) for i in range(supply.count)
        )
    return RectangularBearing(
        width=film.width,
        diameter=film.diameter,
        clearance=film.clearance,
        viscosity=case.viscosity(film),
        sections=sections_of(film),
        ambient_pressure=case.oil.ambient_pressure,
        cavitation_pressure=case.oil.cavitation_pressure,
        supply_pressure=None if isinstance(supply, AxialGrooves) else getattr(supply, "pressure", None),
        grooves=grooves,
    )
