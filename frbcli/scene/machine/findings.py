"""What a case amounts to before anything is computed: mass, natural frequencies, static loads, Sommerfeld numbers.

The films of a case in operation: warm gap, viscosity, Reynolds number, growth of the journal (section 4.1.5.4).

By how much a shaft tilts in its bearings, and what that would change in gaps that are taken as even along the axis.

The journals are in the middle of their shells: they are held there, so that no film has to be solved. At rest the
weight bends the shaft, at the top speed the unbalance does; in a conical whirl both ends of the shaft pass through
their gaps against each other, which tilts it the most.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import larger_semi_axis
from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.film import ColdClearance, FilmGeometry
from frbcli.case.over_time import node_at
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, spaced, speed_shown
from frbcli.elements.ball import RATING_PRESSURE, BallBearingElement, at_displacement
from frbcli.elements.supports import DamperElement
from frbcli.errors import NotConverged
from frbcli.film.gap import (
    LAMINAR_BELOW,
    RING_SPEED,
    reynolds_number,
    ring_rotation_strains,
    shaft_rotation_strain,
    sommerfeld_number,
)
from frbcli.materials import SOLIDS, STEEL, Solid
from frbcli.rotor.assembly import COORDINATES, PLANE, LinearRotor, held_rotor
from frbcli.scene.films import ROTOR, film_places
from frbcli.scene.gate.rule import run_omega
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.units import display


@dataclass(frozen=True)
class FilmOperation:
    """One film at the top speed of a case, SI units.

    omega: omega_J + omega_S in rad/s; warming: what heat has added to the cold clearance in m; turning: what the growth
    of a shaft and a ring that turn would add to the clearance in m, which is left out.
    """

    name: str
    clearance: float
    viscosity: float
    omega: float
    reynolds: float
    warming: float
    turning: float

    @property
    def laminar(self) -> bool:
        """Whether (3.3) holds."""
        return self.reynolds < LAMINAR_BELOW


# Of a FilmOperation
FILM_OPERATION = (
    Column("film", "", "name of the film", attrgetter("name"), shown=(Shown("film", spaced),)),
    Column("clearance", "m", "clearance", shown=(Shown("gap, um", ".4g", "um"),)),
    Column("warming", "m", "what heat has added to it", shown=(Shown("by heat, um", "+.3g", "um"),)),
    Column("turning", "m", "what centrifugal growth would add", shown=(Shown("by spin, um", "+.2g", "um"),)),
    Column("viscosity", "Pa s", "viscosity of the oil", shown=(Shown("mPa*s", ".4g", "mPa s"),)),
    Column("speed", "Hz", "sum of the speeds of journal and shell", lambda film: film.omega / (2.0 * math.pi),
           shown=(speed_shown(head="speeds, Hz"),)),
    Column("reynolds_number", "", "Reynolds number (3.3)", attrgetter("reynolds"), shown=(Shown("Re (3.3)", ".0f"),)),
    Column("laminar", "", "whether (3.3) holds"),
)  # fmt: skip


def operating_points(case: Case) -> tuple[FilmOperation, ...]:
    """Every film of a case at its top speed: of [speed], or of a kinematic test."""
    omega = 2.0 * math.pi * _top_speed(case)
    operations: list[FilmOperation] = []
    for bearing in case.bearings:
        if bearing.kind == "single-film":
            strain = shaft_rotation_strain(_shaft(case), omega, 0.5 * bearing.diameter)
            operations.append(_operation(case, bearing, bearing.name or "film", omega, -strain))
        else:
            operations.extend(_floating(case, bearing, omega))
    operations += [_operation(case, each.given, each.film, 0.0, 0.0) for each in DamperElement.of(case)]
    return tuple(operations)


def _floating(case: Case, bearing: FloatingRingBearing, omega: float) -> tuple[FilmOperation, FilmOperation]:
    ring = RING_SPEED * omega if bearing.ring.spin == "free" else 0.0
    within, without = 0.5 * bearing.inner.diameter, 0.5 * bearing.outer.diameter
    shaft = shaft_rotation_strain(_shaft(case), omega, within)
    inside, outside = ring_rotation_strains(bearing.ring.solid, ring, within, without)
    name = f"{bearing.name} ".lstrip()
    return (
        _operation(case, bearing.inner, f"{name}inner", omega + ring, inside - shaft),
        _operation(case, bearing.outer, f"{name}outer", ring, -outside),
    )


def _shaft(case: Case) -> Solid:
    return STEEL if case.thermal is None else SOLIDS[case.thermal.shaft_material]


def _operation(case: Case, film: FilmGeometry, name: str, omega: float, strain: float) -> FilmOperation:
    radius, viscosity = 0.5 * film.diameter, case.viscosity(film)
    given = film.given_clearance
    return FilmOperation(
        name=name,
        clearance=film.clearance,
        viscosity=viscosity,
        omega=omega,
        reynolds=reynolds_number(case.oil.density, omega, radius, film.clearance, viscosity),
        warming=film.clearance - given.cold if isinstance(given, ColdClearance) else 0.0,
        turning=radius * strain,
    )


def _top_speed(case: Case) -> float:
    speeds = [] if case.given_speed is None else [case.given_speed.start, case.given_speed.end]
    return max([*speeds, abs(case.motion.speed or 0.0) if case.motion is not None else 0.0])


# Shares of the clearance from which a change of the gap at the ends is shown, of bent shafts and of conical whirls.
BENT_LIMIT, CONE_LIMIT = 0.1, 0.25
FLAT = 1e-12  # rad: a journal that tilts less is held by a body that does not tilt


@dataclass(frozen=True)
class FilmTilt:
    """The tilt of a journal against its shell, in rad. weight: at rest; unbalance: of its whirl around that at the top
    speed; cone: in the widest conical whirl, 0 of a rotor in one bearing; reach: by what share of the clearance a tilt
    of 1 rad changes the gap at the ends."""

    film: str
    weight: float
    unbalance: float
    cone: float
    reach: float

    @property
    def bent(self) -> float:
        """Change of the gap at the ends by weight and unbalance together, over the clearance."""
        return self.reach * (self.weight + self.unbalance)

    @property
    def whirling(self) -> float:
        """Change of the gap at the ends in the widest conical whirl, over the clearance."""
        return self.reach * self.cone

    @property
    def change(self) -> float:
        """The larger change of the gap at the ends."""
        return max(self.bent, self.whirling)

    @property
    def matters(self) -> bool:
        """Whether the tilt is worth a look."""
        return self.bent > BENT_LIMIT or self.whirling > CONE_LIMIT


def _in_mrad(tilt: float) -> str:
    return f"{1e3 * tilt:.3g}"


# Of a FilmTilt
FILM_TILTS = (
    Column("film", "", "name of the film", shown=(Shown("film"),)),
    Column("weight", "rad", "tilt of the journal at rest, by the weight", shown=(Shown("weight, mrad", _in_mrad),)),
    Column("unbalance", "rad", "tilt by the unbalance at the top speed", shown=(Shown("unbalance", _in_mrad),)),
    Column("cone", "rad", "largest tilt in a conical whirl", shown=(Shown("cone", _in_mrad),)),
    Column("bent", "", "gap change at the ends by weight and unbalance, over clearance",
           shown=(Shown("bent gap", ".1%"),)),
    Column("whirling", "", "gap change in a conical whirl, over clearance",
           shown=(Shown("cone gap", ".1%"),)),
)  # fmt: skip


def film_tilts(case: Case) -> tuple[FilmTilt, ...]:
    """The films whose journals tilt, none where bearings do not hold the rotor. Raises InputError if its shaft has no
    modes."""
    if not case.bearings:
        return ()
    rotor = make_rotor(case, COORDINATES)
    maps, flat = rotor.journals[:, len(PLANE) :], replace(rotor, journals=rotor.journals[:, : len(PLANE)])
    try:
        weight = maps @ held_rotor(flat).shape
        unbalance = maps @ _whirl(flat, run_omega(case))
    except (NotConverged, np.linalg.LinAlgError):
        return ()
    if not (np.isfinite(weight).all() and np.isfinite(unbalance).all()):
        return ()
    cone, films = _cone(case), zip(film_places(case), maps, weight, unbalance, strict=True)
    return tuple(
        FilmTilt(
            place.name.replace("_", " "),
            float(np.hypot(*at_rest)),
            float(larger_semi_axis(turning)),
            cone,
            0.5 * place.geometry.width / place.geometry.clearance,
        )
        for place, tilts, at_rest, turning in films
        if place.inside == ROTOR and np.abs(tilts).max() > FLAT
    )


def _whirl(rotor: LinearRotor, omega: float) -> NDArray[np.complex128]:
    """(n,) complex amplitudes of the motion with unbalance and bow at omega rad/s, journals held in the middle."""
    here, p = rotor.at(omega), rotor.journals.reshape(-1, rotor.size)
    dynamic = here.stiffness + 1j * omega * (here.damping + omega * here.gyroscopic) - omega**2 * here.mass
    held = np.block([[dynamic, p.T], [p, np.zeros((len(p), len(p)))]])
    pulled = np.concatenate([omega**2 * here.unbalance + here.bent, np.zeros(len(p))])
    return np.asarray(np.linalg.solve(held, pulled)[: rotor.size])


def _cone(case: Case) -> float:
    """Tilt of a straight shaft whose outermost bearings with films have opposite eccentricities of 1."""
    places = [(bearing.position or 0.0, sum(film.clearance for film in bearing.films)) for bearing in case.bearings]
    (first, one), (last, other) = min(places), max(places)
    return (one + other) / (last - first) if last > first else 0.0


NEXT = 1e-6  # m: a bearing where two sections meet lies on both
ALIKE = 0.1  # of the diameter of the shaft, by which a journal's may differ
OF_SHAFT = ("journal", "disk")  # begin the names of the nodes that turn with it


@dataclass(frozen=True)
class FilmLoad:
    """The static load of one film in N, and what follows from it: mean_pressure, of the load over width and diameter,
    Pa; sommerfeld_number: (3.14) at the top speed, NaN where nothing turns; supply: in words."""

    film: str
    load: float
    mean_pressure: float
    sommerfeld_number: float
    supply: str


# Of a FilmLoad
FILM_LOADS = (
    Column("film", "", "name of the film", shown=(Shown("film"),)),
    Column("load", "N", "static load", shown=(Shown("N", ".4g"),)),
    Column("mean_pressure", "Pa", "load over width and diameter", shown=(Shown("N/(DB), bar", ".3g", "bar"),)),
    Column("sommerfeld_number", "", "Sommerfeld number (3.14) at the top speed", shown=(Shown("So", ".3g"),)),
    Column("supply", "", "oil supply", shown=(Shown("supply"),), key=""),
)


@dataclass(frozen=True)
class Findings:
    """mass: of the rotor in kg, None without one; frequencies_Hz: natural ones, ascending, supported: how; films: empty
    where no load is known; tilts: of the journals that tilt."""

    mass: float | None
    frequencies_Hz: tuple[float, ...]
    supported: str
    films: tuple[FilmLoad, ...]
    tilts: tuple[FilmTilt, ...] = ()

    @property
    def rotor(self) -> str:
        """A sentence on the rotor, "" without one."""
        frequencies = ", ".join(f"{frequency:.1f}" for frequency in self.frequencies_Hz)
        natural = f"; natural frequencies {self.supported}: {frequencies} Hz" if frequencies else ""
        return "" if self.mass is None else f"Rotor of {self.mass:.4g} kg{natural}."


def findings(case: Case) -> Findings:
    """What is found of a case before a run. Raises InputError if its shaft has no modes."""
    films = tuple(
        _film(case, film.name, place.geometry, load, film.omega)
        for film, place, load in zip(operating_points(case), film_places(case), static_loads(case), strict=False)
    )
    if case.given_rotor is None:
        return Findings(None, (), "", films)
    shaft = shaft_of(case)
    frequencies, supported = shaft.natural_frequencies
    return Findings(shaft.mass, frequencies, supported, films, film_tilts(case) if case.given_speed is not None else ())


def static_loads(case: Case) -> tuple[float, ...]:
    """N on each film, in their order; the load of a kinematic test; none where none is known, or where the bearings do
    not hold the rotor."""
    if case.given_rotor is None:
        return () if case.motion is None or case.motion.load is None else (case.motion.load,)
    rotor = make_rotor(case)
    try:
        loads = held_rotor(rotor).load.reshape(-1, 2) / rotor.multiplicity[:, None]
    except NotConverged:
        return ()
    loads_N = np.hypot(*loads.T)
    return tuple(loads_N.tolist()) if np.isfinite(loads_N).all() else ()


def _film(case: Case, name: str, film: FilmGeometry, load: float, omega: float) -> FilmLoad:
    number = sommerfeld_number(load, film.width, 0.5 * film.diameter, film.clearance, case.viscosity(film), omega)
    return FilmLoad(name, load, load / (film.width * film.diameter), number, film.supply.words)


def remarks(case: Case) -> tuple[str, ...]:
    """What a case has that contradicts itself or is probably not meant, a sentence each."""
    sentences = [*_dented_balls(case), *_loose_rows(case)]
    if case.given_rotor is None:
        return tuple(sentences)
    shaft = shaft_of(case)
    if not (shaft.eccentricity or shaft.bow) and not case.forces and not case.bases:
        sentences.append("The rotor has no unbalance: it moves by itself only where it is unstable.")
    return (*sentences, *_rubs_on_the_shaft(case), *_journals_off_the_shaft(case), *_names_off_their_place(case))


def _dented_balls(case: Case) -> Iterator[str]:
    """Ball bearings whose preload alone would dent them."""
    for element in BallBearingElement.of(case):
        pressure = element.rings.preload_pressure
        if pressure > RATING_PRESSURE:
            shown = display(float(f"{pressure:.3g}"), "Pa")
            yield (
                f"The preload alone makes a Hertz pressure of {shown} in {element.key}: "
                f"balls leave dents above {display(RATING_PRESSURE, 'Pa')} (ISO 76)."
            )


def _loose_rows(case: Case) -> Iterator[str]:
    """Pairs of rows of which an axial load unloads one."""
    for element in BallBearingElement.of(case):
        if not element.rings.pair:
            continue
        for omega in (0.0, element.top):
            rows = (at_displacement(row, np.zeros(2), omega) for row in element.rings.apart(omega))
            if any(row.balls.inner_load.max() <= 0.0 for row in rows):
                yield f"The axial load takes the whole preload off one row of {element.key}: its balls may slide."
                break


def _rubs_on_the_shaft(case: Case) -> Iterator[str]:
    """Stops whose friction has both places on the shaft."""
    for number, spring in enumerate(case.springs, start=1):
        turning = all(node_at(case, place).startswith(OF_SHAFT) for place in spring.ends if place)
        if spring.friction and spring.between is not None and turning:
            yield (
                f"The stop {number} rubs between two places of the shaft, {' and '.join(spring.between)}: they turn "
                "together, but its friction is that against a place which does not turn."
            )


def _journals_off_the_shaft(case: Case) -> Iterator[str]:
    """Journals whose diameter differs from the shaft's there."""
    ends = np.cumsum([section.length for section in case.shaft])
    for bearing in case.bearings:
        film, position = bearing.films[0], bearing.position
        if position is None or not case.shaft or not 0.0 <= position <= ends[-1]:
            continue
        nearby = {int(np.searchsorted(ends, place)) for place in (position - NEXT, position + NEXT)}
        diameters = [case.shaft[min(max(at, 0), len(case.shaft) - 1)].diameter for at in nearby]
        if all(abs(film.diameter / diameter - 1.0) > ALIKE for diameter in diameters):
            shaft = display(diameters[0], "m")
            yield (
                f"The journal of {bearing.name or 'the bearing'} has {display(film.diameter, 'm')}, "
                f"the shaft at its position {shaft}."
            )


def _names_off_their_place(case: Case) -> Iterator[str]:
    """Bearings that are called after a disk, and stand nearer to another one."""
    for bearing in case.bearings:
        position = bearing.position
        called = [disk for disk in case.disks if disk.name and disk.name.lower() in bearing.name.lower()]
        if position is None or len(called) != 1:
            continue
        (own,) = called
        rivals = [disk for disk in case.disks if disk is not own and disk.name and disk.name not in bearing.name]
        near = [disk.name for disk in rivals if abs(disk.position - position) < abs(own.position - position)]
        mixed = [name for name in near if any(name.lower() in other.name.lower() for other in case.bearings)]
        if mixed:
            yield f"The bearing {bearing.name} stands nearer to {mixed[0]} than to {own.name}."
