"""What a case amounts to before anything is computed: mass, natural frequencies, static loads, Sommerfeld numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown
from frbcli.errors import NotConverged
from frbcli.film.operating import sommerfeld_number
from frbcli.rotor.assembly import held_rotor
from frbcli.scene.films import film_places
from frbcli.scene.machine.operating import operating_points
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.shaft_tilt import FilmTilt, film_tilts
from frbcli.scene.shafts.table import shaft_of
from frbcli.units import display

NEXT = 1e-6  # m: a bearing where two sections meet lies on both
ALIKE = 0.1  # of the diameter of the shaft, by which a journal's may differ


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
    if case.given_rotor is None:
        return ()
    sentences: list[str] = []
    shaft = shaft_of(case)
    if not (shaft.eccentricity or shaft.bow) and not case.forces and not case.bases:
        sentences.append("The rotor has no unbalance: it moves by itself only where it is unstable.")
    return (*sentences, *_journals_off_the_shaft(case), *_names_off_their_place(case))


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
