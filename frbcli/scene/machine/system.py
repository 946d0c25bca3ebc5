"""A planned case as a rotor, its speed and its films: what every study starts from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.elements.pin import held_by_pins, pin_rows
from frbcli.film.kinds.contract import Films
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.roughness.asperities import Asperities, make_asperities
from frbcli.film.roughness.elastic_shell import ElasticShell
from frbcli.film.roughness.rubbing import Rubbing
from frbcli.rotor.body import COORDINATES, PLANE
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.films import film_places, turning, turning_rings, turns_with_oil
from frbcli.scene.machine.machine_films import make_films
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.planned import Plan


@dataclass(frozen=True)
class System:
    """A machine.

    rotor: the linear system; films: see Films; names: of the films. bodies: (films, 2) what lies inside and outside of
    each film, see FilmPlace; turning: see RotorData; drags: eta R^3 B / C of each whole bearing in N m s, the Couette
    torque per slip and drag_integral; ring_count: of rings that turn; laws: names of the films' cavitation models;
    torque: see FilmModel; own_length: see length, 0 of a machine with films; asperities: of rough surfaces; pins:
    (rings or 0, PIN) of the rings, see solve/pin.py; shell: in which smooth surfaces rest where nothing else carries
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
        films a length of the machine (reference_length.py)."""
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
    with_oil = [plan.form.turns_cells and turns_with_oil(case, place) for place in places]
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
