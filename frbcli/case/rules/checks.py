"""Rules that tie several keys of a case together.

They read the tables as the user wrote them, so that they also work when another key is at fault. A rule is skipped if
one of its values is absent or cannot be read.

Values outside the usual range, mostly by a wrong unit: refused unless the case confirms them by `confirm`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from frbcli.case.model import LARGEST
from frbcli.case.oil import ATMOSPHERE
from frbcli.case.reading.tables import (
    Breach,
    Located,
    Path,
    as_number,
    at,
    has_table,
    listed,
    number,
    ring_films,
    table,
    tables,
)
from frbcli.case.rotor import OF_SECTIONS, SYMMETRIC
from frbcli.case.rules.element_checks import (
    balls_alone,
    cartridge_breaches,
    element_breaches,
    has_films,
    pin_breaches,
    positions,
    thrust_alone,
    thrust_breaches,
    tilt_breaches,
)
from frbcli.case.rules.film_checks import (
    contact_breaches,
    film_breaches,
    is_constant,
    law_breaches,
    thermal_breaches,
    warm_clearance,
)
from frbcli.case.run import DEFAULT_HOLD, OUTPUT_STEP
from frbcli.film.gap import RING_SPEED, ring_rotation_strains, shaft_rotation_strain
from frbcli.materials import BRASS, STEEL
from frbcli.units import NUMBER, SPEED, display, readable

FASTEST_SURFACE = 500.0  # m/s; limit of the strength of steel shafts
LARGEST_GROWTH = 0.5  # of the clearance, by centrifugal growth
THINNEST_FILM = 1e-6  # m; the roughness of surfaces
THICKEST_FILM = 0.1  # of the radius; the Reynolds equation is for thin films


@dataclass(frozen=True)
class _Doubt:
    """A value to be confirmed: the key that is probably wrong, the name of the confirmation, and the problem."""

    path: Path
    name: str
    problem: str
    unit: str


@dataclass(frozen=True)
class _Speed:
    """The top speed of a case in Hz, and its key."""

    path: Path
    value: float

    @property
    def omega(self) -> float:
        return 2.0 * math.pi * self.value


def implausible(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every implausible value of the tables of a case that is not confirmed."""
    confirmed = listed(data, "confirm")
    doubts: dict[Path, list[_Doubt]] = {}
    for doubt in _doubts(data):
        if doubt.name not in confirmed:
            doubts.setdefault(doubt.path, []).append(doubt)
    for path, raised in doubts.items():
        yield Breach(path, f"{'; '.join(doubt.problem for doubt in raised)}.", _remedy(raised, at(data, path)))


def _remedy(raised: list[_Doubt], value: object) -> str:
    names = ", ".join(f'"{doubt.name}"' for doubt in raised)
    bare = "" if isinstance(value, str | dict) else f" A number without a unit is in {readable(raised[0].unit)}."
    return f"Correct speed, diameter or clearance, or confirm it at the top of the file: confirm = [{names}].{bare}"


def _doubts(data: Mapping[str, Any]) -> Iterator[_Doubt]:
    top = _top_speed(data)
    fastest = 0.0
    for path, bearing in tables(data, "bearing"):
        ends: Sequence[Sequence[Located]] = ring_films(bearing)
        for end in ends or [[((), bearing)]]:
            diameter = _size(end[0][1], "diameter", "m")
            if top is not None and diameter:
                fastest = max(fastest, math.pi * diameter * top.value)
            growths = _ring_growths(end[0][1], end[1][1], top) if ends else _journal_growth(bearing, top)
            for (place, film), growth in zip(end, growths, strict=True):
                yield from _film((*path, *place), film, growth, top)
        yield from _film((*path, "damper"), table(bearing, "damper"), 0.0, top)
    for path, bearing in tables(data, "thrust_bearing"):
        yield from _pads(path, bearing)
    if top is not None and fastest > FASTEST_SURFACE:
        problem = f"gives a surface speed of the journal of {fastest:.4g} m/s, above {FASTEST_SURFACE:g} m/s"
        yield _Doubt(top.path, "surface-speed", problem, SPEED)


def _film(path: Path, film: Mapping[str, Any], growth: float, top: _Speed | None) -> Iterator[_Doubt]:
    """growth: change of the clearance by centrifugal growth, in m."""
    diameter = _size(film, "diameter", "m")
    clearances = [((*path, "clearance"), warm_clearance(film, diameter))]
    clearances += [((*path, *at, "clearance"), _size(step, "clearance", "m"))
                   for at, step in tables(film, "clearance_steps")]  # fmt: skip
    for where, clearance in clearances:
        if not clearance or clearance < 0.0:
            continue
        if clearance < THINNEST_FILM:
            problem = f"is {display(clearance, 'm')}, below {display(THINNEST_FILM, 'm')}"
            yield _Doubt(where, "clearance", problem, "m")
        if diameter and clearance > THICKEST_FILM * diameter / 2:
            problem = f"is {display(clearance, 'm')}, above a tenth of the radius, too large for a thin film"
            yield _Doubt(where, "clearance", problem, "m")
        if top is not None and abs(growth) > LARGEST_GROWTH * clearance:
            problem = f"changes by {growth / clearance:+.0%} by centrifugal growth at {display(top.value, SPEED)}"
            yield _Doubt(where, "gap-growth", problem, "m")


def _pads(path: Path, bearing: Mapping[str, Any]) -> Iterator[_Doubt]:
    """The depths of the films on the pads of a thrust bearing."""
    radius = _size(bearing, "outer_radius", "m")
    for key in ("taper", "end_play"):
        depth = _size(bearing, key, "m")
        if depth and radius and depth > THICKEST_FILM * radius:
            problem = f"is {display(depth, 'm')}, above a tenth of the outer radius, too large for a thin film"
            yield _Doubt((*path, key), "clearance", problem, "m")


def _journal_growth(bearing: Mapping[str, Any], top: _Speed | None) -> tuple[float, ...]:
    """Change of the clearance of a bearing with one film by centrifugal growth."""
    diameter = _size(bearing, "diameter", "m")
    if top is None or not diameter:
        return (0.0,)
    return (-0.5 * diameter * shaft_rotation_strain(STEEL, top.omega, 0.5 * diameter),)


def _ring_growths(inside: Mapping[str, Any], outside: Mapping[str, Any], top: _Speed | None) -> tuple[float, ...]:
    """Changes of the clearances of the films inside and outside of a floating ring by centrifugal growth."""
    inner, outer = (_size(film, "diameter", "m") for film in (inside, outside))
    if top is None or not inner or not outer:
        return 0.0, 0.0
    shaft = shaft_rotation_strain(STEEL, top.omega, 0.5 * inner)
    bore, rim = ring_rotation_strains(BRASS, RING_SPEED * top.omega, 0.5 * inner, 0.5 * outer)
    return 0.5 * inner * (bore - shaft), -0.5 * outer * rim


def _top_speed(data: Mapping[str, Any]) -> _Speed | None:
    places = (("speed", "to"), ("speed", "from"), ("motion", "speed"))
    places_and_values = [((section, key), _size(table(data, section), key, SPEED)) for section, key in places]
    speeds = [_Speed(path, value) for path, value in places_and_values if value is not None]
    return max(speeds, key=lambda speed: speed.value, default=None)


def _size(values: Mapping[str, Any], key: str, unit: str) -> float | None:
    """The absolute value; None where it is no quantity and the models refuse it."""
    value = number(values, key, unit)
    return abs(value) if value is not None and abs(value) <= LARGEST else None


__all__ = ["Breach", "breaches"]

MOST_SAMPLES = 20_000_000


def breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of a case's tables."""
    yield from implausible(data)
    bearings = tables(data, "bearing")
    if "bearing" not in data and not thrust_alone(data):
        needed = "the motion of a journal is one in a bearing" if "motion" in data else "it carries the rotor"
        yield Breach(("bearing",), f"is missing; {needed}.", "Add the table [bearing].")
    if data.get("bearing") == []:
        yield Breach(("bearing",), "is empty.", "Add the table [bearing].")
    yield from _oil(data)
    if "oil" not in data and has_films(data):
        yield Breach(("oil",), "is missing.", "Add the table [oil].")
    yield from element_breaches(data)
    yield from thermal_breaches(data)
    for path, bearing in bearings:
        for film_path, film in _films(path, bearing):
            yield from film_breaches(film_path, film, data)
        yield from _ring(path, bearing)
        yield from _damper(path, bearing)
    yield from _names("bearing", bearings)
    yield from _names("thrust bearing", tables(data, "thrust_bearing"))
    yield from _names("disk", tables(data, "disk"))
    yield from _rotor(data, bearings)
    yield from contact_breaches(data)
    yield from _run(data)
    yield from _motion(table(data, "motion"))
    yield from thrust_breaches(data)
    for key in () if thrust_alone(data) or balls_alone(data) else ("rotor", "speed"):
        if key not in data and "motion" not in data and not (key == "speed" and "drive" in data):
            yield Breach((key,), "is missing.", f"Add the table [{key}].")
    if {"speed", "drive"} <= data.keys():
        yield Breach(("speed",), "is given with [drive], from which the speed follows.", "Keep one of the two.")


def _oil(data: Mapping[str, Any]) -> Iterator[Breach]:
    if not has_table(data, "oil"):
        return
    oil = data["oil"]
    constant = is_constant(oil)
    if "viscosity" in oil and "vogel" in oil:
        yield Breach(("oil", "vogel"), "gives the viscosity a second time.", "Keep viscosity or vogel.")
    if "viscosity" not in oil and "vogel" not in oil:
        yield Breach(("oil", "viscosity"), "is missing.", 'Add e.g. viscosity = "12 mPa*s" to [oil].')
    elif not constant and "temperature" not in oil and "thermal" not in data:
        needs = "Vogel's law needs it" if "vogel" in oil else "the viscosity of a grade or of points needs it"
        yield Breach(("oil", "temperature"), f"is missing; {needs}.", 'Add e.g. temperature = "100 degC".')
    viscosity = table(oil, "viscosity")
    if "density" not in oil and viscosity.get("points") is not None:
        problem = "is missing; a kinematic viscosity needs it."
        yield Breach(("oil", "density"), problem, 'Add e.g. density = "850 kg/m^3".')
    points = [point for point in listed(viscosity, "points") if isinstance(point, list)]
    if len({str(point[:1]) for point in points}) < len(points):
        yield Breach(("oil", "viscosity", "points"), "has one temperature twice.", "Give two temperatures.")
    for key in ("temperature", "shear_factor"):
        if key in oil and constant:
            problem = "has no effect: the viscosity is constant."
            yield Breach(("oil", key), problem, "Remove it, or give oil.vogel instead of the viscosity.")
    yield from law_breaches(oil, number(oil, "temperature", "K"), ("oil", "temperature"))
    ambient, cavitation = number(oil, "ambient_pressure", "Pa", ATMOSPHERE), number(oil, "cavitation_pressure", "Pa")
    if ambient and cavitation and cavitation > ambient:
        problem = f"is {display(cavitation, 'Pa')}, above the ambient pressure of {display(ambient, 'Pa')}."
        yield Breach(("oil", "cavitation_pressure"), problem, "Pressures are absolute; lower it, or leave it away.")


def _ring(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    for (film, inside), (_, outside) in ring_films(bearing):
        inner, outer = number(inside, "diameter", "m"), number(outside, "diameter", "m")
        if inner and outer and inner >= outer:
            problem = f"is {display(inner, 'm')}, not below the outer film's, {display(outer, 'm')}."
            yield Breach((*path, *film, "diameter"), problem, "Exchange inner and outer, or correct the diameters.")
    ring = table(bearing, "ring")
    yield from pin_breaches(path, bearing)
    if bearing.get("kind") == "cartridge":
        yield from cartridge_breaches(path, bearing)
        return
    yield from tilt_breaches(path, bearing)
    if has_table(bearing, "ring") and not {"mass", "material"} & ring.keys():
        remedy = 'Add e.g. mass = "30 g", or material = "brass", from which it follows.'
        yield Breach((*path, "ring", "mass"), "is missing.", remedy)
    if {"mass", "width"} <= ring.keys():
        yield Breach((*path, "ring", "width"), "has no effect: the mass is given.", "Remove one of the two.")


def _damper(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    ringed = ring_films(bearing)
    film = ringed[0][1][1] if ringed else bearing
    inner, outer = number(film, "diameter", "m"), number(table(bearing, "damper"), "diameter", "m")
    if inner and outer and inner >= outer:
        problem = f"is {display(outer, 'm')}, not above the value of the film in the shell, {display(inner, 'm')}."
        yield Breach((*path, "damper", "diameter"), problem, "It is the outer diameter of the shell.")


def _names(what: str, named: list[tuple[Path, dict[str, Any]]]) -> Iterator[Breach]:
    seen: list[object] = []
    for place, (path, part) in enumerate(named, start=1):
        name = part.get("name", str(place))
        if name in seen:
            yield Breach((*path, "name"), f"is also the name of another {what}.", f"Give each {what} its own name.")
        seen.append(name)


def _rotor(data: Mapping[str, Any], bearings: list[tuple[Path, dict[str, Any]]]) -> Iterator[Breach]:
    kind = table(data, "rotor").get("kind")
    if kind in OF_SECTIONS:
        if not data.get("shaft") and "file" not in table(data, "rotor"):
            yield Breach(("shaft",), "is missing.", "Add [[shaft]] sections with length and diameter, or rotor.file.")
        if {"modes", "cutoff"} <= set(table(data, "rotor")):
            yield Breach(("rotor", "cutoff"), "is given with modes.", "Keep one of the two.")
        if sum(2 if bearing.get("kind") == "cartridge" else 1 for _, bearing in bearings) < 2:
            yield Breach(("bearing",), "is given once; a turbocharger rotor needs two.", "Write [[bearing]] twice.")
        for path, bearing in bearings:
            if "position" not in bearing and bearing.get("kind") != "cartridge":
                yield Breach((*path, "position"), "is missing.", 'Add e.g. position = "80 mm".')
        yield from _on_shaft(data, bearings)
    elif kind in SYMMETRIC:
        if "bow_phase" in table(data, "rotor") and not number(table(data, "rotor"), "bow", "m", 0.0):
            yield Breach(("rotor", "bow_phase"), "has no effect: there is no bow.", 'Add e.g. bow = "10 um".')
        for key in ("shaft", "disk"):
            if key in data:
                yield Breach((key,), f"does not go with a {kind} rotor.", 'Remove it, or take kind = "turbocharger".')
        for path, bearing in bearings:
            if bearing.get("kind") == "cartridge":
                problem = f"does not tilt around a {kind} rotor, which moves in its plane."
                remedy = 'Take kind = "floating-ring" with half of its mass and inertia, or a turbocharger rotor.'
                yield Breach((*path, "kind"), problem, remedy)
            elif "tilt_inertia" in table(bearing, "ring"):
                problem = f"has no effect: a ring around a {kind} rotor moves in its plane."
                yield Breach((*path, "ring", "tilt_inertia"), problem, 'Remove it, or take kind = "turbocharger".')


def _on_shaft(data: Mapping[str, Any], bearings: list[tuple[Path, dict[str, Any]]]) -> Iterator[Breach]:
    for path, section in tables(data, "shaft"):
        outer, inner = (number(section, key, "m", 0.0) for key in ("diameter", "inner_diameter"))
        if outer and inner and inner >= outer:
            yield Breach((*path, "inner_diameter"), f"leaves no shaft of {display(outer, 'm')}.", "Make it smaller.")
    for path, disk in tables(data, "disk"):
        polar, diametral = (number(disk, f"{axis}_inertia", "kg*m^2", 0.0) for axis in ("polar", "diametral"))
        if polar and diametral is not None and polar > 2 * diametral * (1 + 1e-9):
            problem = "is more than twice the diametral inertia, which is not possible."
            yield Breach((*path, "polar_inertia"), problem, "Exchange or correct the two.")
    lengths = [number(section, "length", "m") for _, section in tables(data, "shaft")]
    if not lengths or None in lengths:
        return
    total = sum(length for length in lengths if length is not None)
    for path, part in (*bearings, *tables(data, "thrust_bearing"), *tables(data, "disk")):
        places = [((*path, "position"), number(part, "position", "m")), *positions(path, part)]
        for key, position in places:
            if position is not None and not 0 <= position <= total * (1 + 1e-9):
                problem = f"is {display(position, 'm')}, not on the shaft of {display(total, 'm')}."
                yield Breach(key, problem, "Positions count from the start of the first section.")


def _run(data: Mapping[str, Any]) -> Iterator[Breach]:
    start, speed = table(data, "start"), table(data, "drive" if "drive" in data else "speed")
    displacement = [as_number(each, NUMBER) for each in listed(start, "displacement")]
    if len(displacement) == 2:
        x, y = displacement
        if x is not None and y is not None and math.hypot(x, y) >= 1:
            yield Breach(("start", "displacement"), "is outside the clearance.", "Its length must be below 1.")
    if "displacement" in start and "position" in start:
        yield Breach(("start", "position"), "is given with a displacement.", "Keep one of the two.")
    duration, step = number(speed, "duration", "s"), number(table(data, "output"), "step", "s", OUTPUT_STEP)
    if not duration or not step or min(duration, step) < 0:
        return
    if step >= duration:
        problem = f"is {display(step, 's')}, not below the duration of {display(duration, 's')}."
        yield Breach(("output", "step"), problem, "Shorten the step.")
    whole = duration + (number(speed, "hold", "s", 0.0 if "drive" in data else DEFAULT_HOLD) or 0.0)
    whole += number(speed, "down_duration", "s", duration) or 0.0
    yield from _kept(table(table(data, "output"), "films"), whole)
    if whole / step > MOST_SAMPLES:
        problem = f"makes {whole / step:.3g} samples of one run."
        yield Breach(("output", "step"), problem, "Lengthen it, or shorten the run.")


def _kept(films: Mapping[str, Any], whole: float) -> Iterator[Breach]:
    """Films that a run keeps, between times of it. whole: s that it lasts at most."""
    begin, end = (number(films, key, "s") for key in ("from", "to"))
    if begin is None or end is None:
        return
    if begin >= end:
        yield Breach(("output", "films", "to"), "is not after from.", "Exchange or correct the two.")
    elif begin >= whole:
        problem = f"is not before the end of the run, {display(whole, 's')}."
        yield Breach(("output", "films", "from"), problem, "Correct it.")


def _motion(motion: Mapping[str, Any]) -> Iterator[Breach]:
    if "load" in motion and "eccentricity" in motion:
        yield Breach(("motion", "load"), "is given with an eccentricity.", "Keep one of the two.")
    for key in ("eccentricity_rate", "whirl_speed"):
        if key in motion and "velocity" in motion:
            yield Breach(("motion", "velocity"), f"is given with motion.{key}.", "Keep one of the two.")


def _films(path: Path, bearing: dict[str, Any]) -> Iterator[tuple[Path, dict[str, Any]]]:
    if bearing.get("kind") == "single-film":
        yield path, bearing
    for end in ring_films(bearing):
        yield from (((*path, *at), film) for at, film in end)
    if has_table(bearing, "damper"):
        yield (*path, "damper"), bearing["damper"]
