"""The films of a machine, the section of each that has to be solved, and how they turn with rotor and rings.

Films are in the order in which the time loop sees them.

The tilt of a journal against its shell in a kinematic test, and where it closes the gap.

A tilt (t_x, t_y) is a small rotation about the axes through the middle of the bearing: the centre of the journal at z
lies at (x + z t_y, y - z t_x).

The channels of floating rings: the pressure of their feed holes, or how they couple the two films of a ring.

The keys of a case's bearings and films, as a case file or --set writes them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.elements import Element
from frbcli.case.film import FilmGeometry, FilmModel, RingFilm
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.case.supplies import MIDDLE, Bores
from frbcli.elements.supports import DamperElement
from frbcli.errors import Fault
from frbcli.film.cavitation.law import FilmOil, Law
from frbcli.film.cavitation.table import law_named
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.mesh.grid import run_grid
from frbcli.film.gap import (
    NO_BATH,
    Channel,
    Diffusion,
    FeedHole,
    Section,
    channel_resistance,
    ends_at_ambient,
    smallest_gap,
    whole_width,
)
from frbcli.scene.gate.rule import ROTATION, SQUEEZE

Pair = tuple[float, float]
NONE = (0.0, 0.0)
AROUND = 36  # places of a whirl, between which only lobed shells have less gap


def tilt_of(case: Case) -> Pair:
    """Tilt of the journal against the shell in rad."""
    motion, bearing = case.motion, case.bearings[0]
    journal = NONE if motion is None or motion.tilt is None else motion.tilt
    shell = bearing.misalignment if bearing.kind == "single-film" else None
    return journal if shell is None else (journal[0] - shell[0], journal[1] - shell[1])


def tilt_rate_of(case: Case) -> Pair:
    """How fast the journal tilts, in rad/s."""
    motion = case.motion
    return NONE if motion is None or motion.tilt_rate is None else motion.tilt_rate


def tilts(case: Case) -> bool:
    """Whether the gap of the bearing, or its rate of change, differs along the axis."""
    return tilt_of(case) != NONE or tilt_rate_of(case) != NONE


def states_moment(case: Case) -> bool:
    """Whether a kinematic test states the moment of the film force."""
    return case.motion is not None and (case.motion.states_moment or tilts(case))


def slope_of(tilt: Pair, section: Section) -> Pair:
    """Growth of the displacement over the clearance, or of its rate, over the width of the whole bearing."""
    length = section.bearing_width / section.clearance
    return length * tilt[1] + 0.0, -length * tilt[0] + 0.0  # no negative zero


def gaps_at_ends(section: Section, d: Pair, slope: Pair) -> Pair:
    """The least H at the ends z < 0 and z > 0 of a bearing; in between it is linear in z."""
    at = [(d[0] + side * slope[0], d[1] + side * slope[1]) for side in (-0.5, 0.5)]
    return smallest_gap(section, at[0]), smallest_gap(section, at[1])


def displacement_of(case: Case) -> Pair:
    """Displacement over the clearance that a rotation is given."""
    assert case.motion is not None
    e, angle = case.motion.eccentricity or 0.0, case.motion.angle
    return e * math.cos(angle), e * math.sin(angle)


def places_of(case: Case, test: str) -> list[Pair]:
    """Displacements over the clearance at which a test brings the ends of the journal nearest to the shell: the gap, a
    concave function of them, is least at the ends of a line and on the rim of a disk."""
    assert case.motion is not None
    e, toward = case.motion.eccentricity or 0.0, tilt_of(case)
    if test == ROTATION:
        return [displacement_of(case)]
    if test == SQUEEZE:
        return [(0.0, -e), (0.0, e)]
    begin = math.atan2(-toward[0], toward[1])  # the direction of the slope
    angles = (begin + 2.0 * math.pi * i / AROUND for i in range(AROUND))
    return [(e * math.cos(angle), e * math.sin(angle)) for angle in angles]


def least_gaps(section: Section, places: list[Pair], slope: Pair) -> Pair:
    """The least of gaps_at_ends of all places."""
    low, high = zip(*(gaps_at_ends(section, place, slope) for place in places), strict=True)
    return min(low), min(high)


def tilt_key(case: Case) -> tuple[str, str]:
    """The key that tilts the journal against the shell, and its value."""
    for key in ("tilt", "tilt_rate"):
        given = getattr(case.motion, key, None)
        if given is not None and any(given):
            return f"motion.{key}", as_text(given)
    tilt = tilt_of(case)
    return f"{bearing_key(case, 0)}.misalignment", as_text((-tilt[0], -tilt[1]))


def misaligned(case: Case) -> Iterator[tuple[str, str]]:
    """The key and the value of each shell that is not in line."""
    for index, bearing in enumerate(case.bearings):
        if bearing.misalignment is not None and any(bearing.misalignment):
            yield f"{bearing_key(case, index)}.misalignment", as_text(bearing.misalignment)


def as_text(given: Pair) -> str:
    """A tilt in rad, or its rate, as a fault shows it."""
    return f"{given[0]:.6g}, {given[1]:.6g}"


INLETS = "a groove around one end of the outer film, or an end in an oil bath"


def coupled(bearing: FloatingRingBearing) -> bool:
    """Whether the channels of a ring couple its films."""
    return bearing.channels == "coupled"


def coupled_rings(case: Case) -> Iterator[tuple[str, FloatingRingBearing]]:
    """The rings whose channels couple their films, each with the key that says so."""
    for index, bearing in enumerate(case.bearings):
        if bearing.kind == "floating-ring" and coupled(bearing):
            yield f"{bearing_key(case, index)}.channels", bearing


def coupling_faults(case: Case, problem: str, remedy: str) -> Iterator[Fault]:
    """The faults of all channels that couple films, where these are not modelled."""
    return (Fault(key, "coupled", None, problem, remedy) for key, _ in coupled_rings(case))


def opens_to_groove(bearing: FloatingRingBearing) -> bool:
    """Whether the channels open to a groove around the middle of the outer film, which holds its pressure."""
    return bearing.outer.supply.splits


def feed_holes_in_outer_film(bearing: FloatingRingBearing) -> Bores | None:
    """The feed holes of the outer film at the channels; None if these are not coupled or open to a groove."""
    supply = bearing.inner.supply.channels
    if supply is None or not coupled(bearing) or opens_to_groove(bearing):
        return None
    offset = (supply.axial_position - MIDDLE) * bearing.inner.width / bearing.outer.width
    return altered(supply, {"axial_position": MIDDLE + offset})


def centrifugal_pressure(case: Case, bearing: FloatingRingBearing) -> float:
    """Centrifugal pressure of a channel over the square of the ring speed, (4.27), Pa s^2."""
    if not bearing.centrifugal_pressure:
        return 0.0
    inside, outside = 0.5 * bearing.inner.diameter, 0.5 * bearing.outer.diameter
    return 0.5 * case.oil.density * (outside**2 - inside**2)


def resistance(case: Case, bearing: FloatingRingBearing) -> float:
    """Flow resistance of one channel in Pa s / m^3."""
    supply = bearing.inner.supply.channels
    assert supply is not None
    length = 0.5 * (bearing.outer.diameter - bearing.inner.diameter)
    return channel_resistance(supply.diameter, length, case.oil_viscosity)


def coupled_channels(case: Case, volumes: Sequence[VolumeFilm]) -> tuple[Channel, ...]:
    """The coupled channels of all rings. volumes: of all films in their order, the feed holes as their last holes."""
    channels: list[Channel] = []
    film = 0
    for bearing in case.bearings:
        if bearing.kind != "floating-ring":
            film += 1
            continue
        supply = bearing.inner.supply.channels
        if coupled(bearing) and supply is not None:
            inner = volumes[film].section.holes[-supply.count :]
            outer = volumes[film + 1].section.holes[-supply.count :]
            for index in range(supply.count):
                channels.append(
                    Channel(
                        inner=FeedHole(film, inner[index]),
                        outer=None if opens_to_groove(bearing) else FeedHole(film + 1, outer[index]),
                        resistance=resistance(case, bearing),
                        groove_pressure=bearing.outer.supply.gauge(case.oil.ambient_pressure),
                        centrifugal=centrifugal_pressure(case, bearing),
                    )
                )
        film += 2
    return tuple(channels)


def channel_faults(case: Case) -> Iterator[Fault]:
    """The faults of coupled channels."""
    for key, bearing in coupled_rings(case):
        problem, remedy = _problem(bearing)
        if problem:
            yield Fault(key, "coupled", None, problem, remedy)


def _problem(bearing: FloatingRingBearing) -> tuple[str, str]:
    supply, outer = bearing.inner.supply.channels, bearing.outer
    if supply is None:
        return "needs channels, and the inner film has no feed holes.", 'Write inner.supply.kind = "bores".'
    if supply.on == "journal":
        return "needs channels through the ring; the feed holes are in the journal.", 'Write inner.supply.on = "shell".'
    if not outer.supply.feeds and not {"oil-bath"} & {bearing.inner.ends, outer.ends}:
        return "leaves the bearing without a supply from outside.", f"Give it {INLETS}."
    if outer.supply.splits:
        if supply.axial_position == MIDDLE:
            return "", ""
        problem = "asks for feed holes next to a central groove, which makes two different outer films."
        return problem, "Put the feed holes in the middle, or the groove at an end of the outer film."
    if bearing.ring.spin == "free" and not outer.supply.plain:
        problem = f"asks for {outer.supply.kind} in the housing, which the feed holes of a turning ring pass."
        return problem, f"Give it {INLETS}, or a ring that does not turn."
    if bearing.ring.spin == "free" and outer.shell is not None:
        problem = f"asks for {outer.shell.words} in the housing, which the feed holes of a turning ring pass."
        return problem, f"Remove outer.{outer.shell.key}."
    return "", ""


ELEMENT = 2.0 * math.pi / 20.0  # L of (4.42) in rad: of the elements of figure 6.2


def film_section(case: Case, bearing: FilmGeometry, feed_holes: Bores | None = None) -> Section:
    """The part of the film that has to be solved: half of it where it is symmetric about the middle.

    feed_holes: of the channels of a ring, which the film has in addition to its own supply; they are the last of its
    holes. """
    radius, width, ambient = 0.5 * bearing.diameter, bearing.width, case.oil.ambient_pressure
    opened = bearing.supply.openings(radius, width, bearing.ends, ambient)
    copies, far, holes = opened.copies, opened.far, opened.holes
    if feed_holes is not None:
        if far == "symmetry" and feed_holes.axial_position != MIDDLE:
            copies, far = 1, bearing.ends
        if bearing.supply.mirrored:
            feed_holes = altered(feed_holes, {"axial_position": 1.0 - feed_holes.axial_position})
        holes += feed_holes.holes(radius, width, ambient)
    return Section(
        radius=radius,
        width=width / copies,
        bearing_width=width,
        clearance=bearing.clearance,
        viscosity=case.viscosity(bearing),
        ambient_pressure=ambient,
        cavitation_pressure=case.oil.cavitation_pressure,
        copies=copies,
        near=bearing.ends,
        far=far,
        far_pressure=opened.far_pressure,
        grooves=opened.grooves,
        holes=holes,
        profile=bearing.shell,
        sealed=bearing.sealed,
        bath=bearing.bath,
        largest_flow=bearing.supply.largest_flow / copies,
        flow_roughness=case.contact.flow_roughness,
        shear=case.contact.shear,
        diffusion=diffusion_of(case, bearing),
    )


def diffusion_of(case: Case, film: FilmGeometry) -> Diffusion | None:
    """The artificial diffusion of a film of the two-phase model in its published form, None of others."""
    given = case.film.two_phase
    if case.cavitation(film) != TwoPhase.name or given.form != "published":
        return None
    return Diffusion(ELEMENT if given.diffusion != "none" else 0.0, along=given.diffusion == "consistent")


def is_published(case: Case) -> bool:
    """Whether films of a case have the published form."""
    return any(diffusion_of(case, film) is not None for film in case.films)


def film_rectangle(section: Section) -> Section | None:
    """The section over the whole width, as the modal film is solved on it; None if it has openings or a profile."""
    return None if section.grooves or section.holes or section.profile else whole_width(section)


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
        if bearing.kind == "single-film":
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
    return tuple(bearing for bearing in case.bearings if bearing.kind == "floating-ring")


def turning_rings(case: Case) -> tuple[tuple[FloatingRingBearing, ...], ...]:
    """The rings that turn, in the order of their numbers: the bearings around each, two of a cartridge."""
    return tuple(around for around in _around_rings(case) if around[0].ring.spin == "free")


def _around_rings(case: Case) -> Iterator[tuple[FloatingRingBearing, ...]]:
    """The bearings around each ring."""
    for given in case.given_bearings:
        if around := tuple(part for part in given.parts if part.kind == "floating-ring"):
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
    return tuple(key for key, each in keyed if each.kind == "cartridge" and each.ring.spin == "free")


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
        if bearing.kind == "floating-ring" and 0 <= place.outside == place.grid_body and not coupled(bearing):
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
    top = case.speed.top if top_Hz is None else top_Hz
    speed = 2.0 * math.pi * max(top, 1.0)
    reference = PUMPED * 0.5 * speed / section.aspect
    return VolumeFilm(section, run_grid(section, cells), law, reference, edged)


def bearing_key(case: Case, index: int) -> str:
    """The key of a bearing with a film: "bearing", or "bearing.0" where there are several, with or without one."""
    keyed = zip(case.bearing_keys, case.placed_bearings, strict=True)
    return [key for key, bearing in keyed if not isinstance(bearing, Element)][index]


def film_keys(case: Case) -> tuple[str, ...]:
    """The keys of all films in the order of film_places, e.g. "bearing" or "bearing.1.inner"."""
    keyed = zip(case.given_keys, case.given_bearings, strict=True)
    own = (f"{key}.{film}".rstrip(".") for key, bearing in keyed for film in bearing.film_keys)
    return (*own, *(each.key for each in DamperElement.of(case)))


def cavitation_keys(case: Case) -> tuple[tuple[str, str], ...]:
    """Where the cavitation model of each film is written, a key of its own or film.cavitation, and the model."""
    return tuple(
        (f"{key}.cavitation" if isinstance(film, RingFilm) and film.cavitation else "film.cavitation", name)
        for key, film, name in zip(film_keys(case), case.films, case.cavitations, strict=True)
    )
