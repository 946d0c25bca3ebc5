"""The films of a machine in the order in which the time loop sees them, and how they turn with rotor and rings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.case.bearing import CartridgeBearing, FloatingRingBearing, SingleFilmBearing
from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.films.film_model import FilmModel
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.case.supplies.bores import Bores
from frbcli.elements.damper import DamperElement
from frbcli.film.cavitation.law import FilmOil, Law
from frbcli.film.cavitation.table import law_named
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.mesh.grid import run_grid
from frbcli.film.gap import NO_BATH, Section, ends_at_ambient
from frbcli.scene.channels import centrifugal_pressure, coupled, feed_holes_in_outer_film
from frbcli.scene.section import diffusion_of, film_section

ROTOR, HOUSING = -1, -2  # what a film lies against, if it is not a ring
PUMPED = 0.3  # share of the pressure that the largest speed could build up: a good unit of the unknown w


@dataclass(frozen=True)
class FilmPlace:
    """One film: its geometry; the body inside and outside of it as it turns, a number of a ring, ROTOR or HOUSING,
    which a blocked ring and a shell count as; the body that its openings turn with; the name that results carry; the
    feed holes of coupled channels that it has in addition to its own supply; misalignment: tilt of its shell about x
    and y in rad."""

    geometry: FilmGeometry
    inside: int
    outside: int
    grid_body: int
    name: str
    feed_holes: Bores | None = None
    misalignment: tuple[float, float] = (0.0, 0.0)


def film_places(case: Case) -> tuple[FilmPlace, ...]:
    """All films of a case, as `Case.films`: the inner before the outer one of a floating ring, the bearings in their
    order, and behind them the dampers."""
    places, spins = [], iter(_spins(case))
    for bearing in case.bearings:
        if isinstance(bearing, SingleFilmBearing):
            body, tilt = _opening_body(bearing, ROTOR, HOUSING), bearing.misalignment or (0.0, 0.0)
            places.append(FilmPlace(bearing, ROTOR, HOUSING, body, bearing.name, None, tilt))
        else:
            names = (f"{bearing.name}_{side}".lstrip("_") for side in ("inner", "outer"))
            inner, outer, between = next(names), next(names), next(spins)
            places.append(FilmPlace(bearing.inner, ROTOR, between, _opening_body(bearing.inner, ROTOR, between), inner))
            feed_holes = feed_holes_in_outer_film(bearing)
            body = _opening_body(bearing.outer, between, HOUSING) if feed_holes is None else between
            tilt = bearing.misalignment or (0.0, 0.0)
            places.append(FilmPlace(bearing.outer, between, HOUSING, body, outer, feed_holes, tilt))
    places += [FilmPlace(each.given, HOUSING, HOUSING, HOUSING, each.film) for each in DamperElement.of(case)]
    return tuple(places)


def bearing_films(case: Case) -> tuple[FilmPlace, ...]:
    """The films between surfaces that turn against each other: all but films of dampers."""
    return film_places(case)[: sum(len(bearing.films) for bearing in case.bearings)]


def _opening_body(film: FilmGeometry, inside: int, outside: int) -> int:
    """The body that the openings of a film are in."""
    return {"journal": inside, "shell": outside, "housing": HOUSING}[film.supply.surface]


def rings(case: Case) -> tuple[FloatingRingBearing, ...]:
    """The bearings with floating rings."""
    return tuple(bearing for bearing in case.bearings if isinstance(bearing, FloatingRingBearing))


def turning_rings(case: Case) -> tuple[tuple[FloatingRingBearing, ...], ...]:
    """The rings that turn, in the order of their numbers: the bearings around each, two of a cartridge."""
    return tuple(around for around in _around_rings(case) if around[0].ring.spin == "free")


def _around_rings(case: Case) -> Iterator[tuple[FloatingRingBearing, ...]]:
    """The bearings around each ring."""
    for given in case.given_bearings:
        if around := tuple(part for part in given.parts if isinstance(part, FloatingRingBearing)):
            yield around


def _spins(case: Case) -> Iterator[int]:
    """The body that the ring of each bearing with one turns as: its number, or HOUSING of a blocked one."""
    number = 0
    for around in _around_rings(case):
        free = around[0].ring.spin == "free"
        yield from (number if free else HOUSING for _ in around)
        number += free


def turning_cartridges(case: Case) -> tuple[str, ...]:
    """The keys of the cartridges that turn."""
    keyed = zip(case.given_keys, case.given_bearings, strict=True)
    return tuple(key for key, each in keyed if isinstance(each, CartridgeBearing) and each.ring.spin == "free")


def full_films(case: Case) -> Case:
    """The case with half-Sommerfeld films, full wherever they carry."""
    return altered(case, {"film": FilmModel(cavitation="half-sommerfeld", theory=case.film.theory)})


def bearing_springs(case: Case, films: Iterable[float]) -> tuple[float, ...]:
    """The stiffness of each bearing with a film, from the stiffness of its films in their order: in series around a
    ring."""
    single = iter(films)
    groups = ([next(single) for _ in bearing.films] for bearing in case.bearings)
    return tuple(own[0] if len(own) == 1 else 1.0 / sum(1.0 / each for each in own) for own in groups)


def is_plain(film: FilmGeometry) -> bool:
    """Whether a gap looks the same from every angle: its cells may turn as they like."""
    return film.shell is None and film.supply.plain and film.bath <= NO_BATH


def turns_with_oil(case: Case, place: FilmPlace) -> bool:
    """Whether the cells of a film turn with the mean speed of journal and shell, as the oil between them does."""
    if case.film.grid != "auto":
        return case.film.grid == "half-speed"
    plain = is_plain(place.geometry) and place.feed_holes is None and diffusion_of(case, place.geometry) is None
    return plain and law_named(case.cavitation(place.geometry)).keeps_oil


def turning(places: tuple[FilmPlace, ...], ring_count: int, with_oil: Sequence[bool]) -> Array:
    """(films, 3, 1 + rings) shares of the speeds of rotor and rings in omega_J + omega_S, in omega_J - omega_S, and in
    the speed of the grid; see RotorData. with_oil: (films,) whether its grid turns with the mean of both."""
    shares = np.zeros((len(places), 3, 1 + ring_count))
    for share, place, half_speed in zip(shares, places, with_oil, strict=True):
        for body, signs in ((place.inside, (1.0, 1.0)), (place.outside, (1.0, -1.0))):
            if body != HOUSING:
                share[0, 1 + body] += signs[0]
                share[1, 1 + body] += signs[1]
        if place.grid_body != HOUSING:
            share[2, 1 + place.grid_body] = 1.0
        if half_speed:
            share[2] = 0.5 * share[0]
    return shares


def make_law(case: Case, cavitation: str, section: Section) -> Law:
    """The law of a film; what it follows is of the centred journal at 1 rad/s. Raises KeyError if there is no such."""
    oil = FilmOil(section.pressure_scale, section.ambient_pressure, section.cavitation_pressure, case.oil.density)
    return law_named(cavitation).scaled(case.film.given(cavitation), oil)


def centrifugal_pressures(case: Case, sections: Sequence[Section]) -> tuple[float, ...]:
    """Fall of the pressure given in each film's channels over the square of its ring's speed, (4.27), scaled.

    Half of the difference between the two ends of a channel acts on the inner film (4.29); the pressure at the outer
    end is the pressure of the groove which they open to. """
    around = [bearing for bearing in case.bearings for _ in bearing.films]
    centrifugal = [0.0] * len(sections)
    for number, (place, bearing) in enumerate(zip(bearing_films(case), around, strict=True)):
        if isinstance(bearing, FloatingRingBearing) and 0 <= place.outside == place.grid_body and not coupled(bearing):
            pressure = centrifugal_pressure(case, bearing)
            centrifugal[number] = 0.5 * pressure / sections[number].pressure_scale
    return tuple(centrifugal)


def volume_film(
    case: Case, place: FilmPlace, cells: tuple[int, int], top_Hz: float | None = None, edged: bool = False
) -> VolumeFilm:
    """A film on volumes for a run, equal cells (around, along). top_Hz: top rotor speed, by default the run's; edged:
    see VolumeFilm."""
    geometry, cavitation = place.geometry, case.cavitation(place.geometry)
    section = film_section(case, geometry, place.feed_holes)
    law_class = law_named(cavitation)
    # A pressure that is never below ambient lets oil out only, as into a bath. The flow of (4.37) at no pressure, which
    # the law would have to make up, keeps Newton's method from converging.
    only_out = law_class.holds_cavity and section.cavitation_pressure >= section.ambient_pressure
    if (law_class.closed or only_out) and geometry.ends == "free-to-air":
        section = ends_at_ambient(section)
    law = make_law(case, cavitation, section)
    top = max(abs(case.speed.start), abs(case.speed.end)) if top_Hz is None else top_Hz
    speed = 2.0 * math.pi * max(top, 1.0)
    reference = PUMPED * 0.5 * speed / section.aspect
    return VolumeFilm(section, run_grid(section, cells), law, reference, edged)
