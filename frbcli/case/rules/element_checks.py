"""Rules that tie the keys of elements together, see checks.py.

Checks of elements without a film, of cases without any film, of a cartridge, its two places and its body, of inertias
and pins of rings, and of thrust bearings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.elements import OPPOSED, WITHOUT_FILM, BallBearingKeys
from frbcli.case.over_time import values_of
from frbcli.case.reading.files import MASSES, column_lengths, is_negative, over_speed_problem
from frbcli.case.reading.tables import (
    Breach,
    Path,
    as_number,
    has_table,
    listed,
    number,
    ring_films,
    table,
    tables,
)
from frbcli.case.rotor import OF_SECTIONS
from frbcli.units import ANGLE, NUMBER, SPEED, display

CURVATURES = tuple((key, BallBearingKeys.model_fields[key].default) for key in ("inner_curvature", "outer_curvature"))
GIVEN = ("stiffness", "damping", "mass")
REMEDY = "Remove it, or add a bearing with a film."
# Keys that say how films are computed, recorded or touched.
OF_FILMS = (
    ("film",), ("thermal",), ("contact",), ("accuracy", "mesh"), ("output", "signals"), ("start", "displacement"),
)  # fmt: skip


def has_films(data: Mapping[str, Any]) -> bool:
    """Whether a bearing of the tables may have a film: true for tables that cannot be read."""
    listed = tables(data, "bearing")
    return not listed or any(bearing.get("kind") not in WITHOUT_FILM or "damper" in bearing for _, bearing in listed)


def balls_alone(data: Mapping[str, Any]) -> bool:
    """Whether a case is of ball bearings alone, for their sheet."""
    listed = tables(data, "bearing")
    balls = bool(listed) and all(bearing.get("kind") == "ball" for _, bearing in listed)
    return balls and not {"rotor", "speed"} & data.keys()


def element_breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of elements without a film, of dampers and of supports."""
    for path, bearing in tables(data, "bearing"):
        if bearing.get("kind") == "coefficients":
            yield from _coefficients(path, bearing)
        if bearing.get("kind") == "ball":
            yield from _balls(path, bearing)
            yield from _locating((*path, "locating"), bearing, data)
            yield from _row_distance((*path, "row_distance"), bearing, data)
        for body in ("damper", "support"):
            if has_table(bearing, body):
                yield from _body((*path, body), bearing[body], data)
    if has_films(data):
        return
    for place in OF_FILMS:
        holder = data if len(place) == 1 else table(data, place[0])
        if place[-1] in holder:
            yield Breach(place, "has no effect: no bearing has a film.", REMEDY)
    if "motion" in data:
        yield Breach(("motion",), "moves a journal in a film, and no bearing of the case has a film.", REMEDY)


def _body(path: Path, given: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[Breach]:
    """What is wrong with the body of a damper or a support."""
    if "rotor" not in data:
        problem = "has no effect: a kinematic test moves the journal against its shell."
        yield Breach(path, problem, "Remove it, or add [rotor] and [speed].")
    if given.get("centred") is True and "spring" not in given:
        problem = "has no effect: no spring carries the static load."
        yield Breach((*path, "centred"), problem, 'Remove it, or write e.g. spring = "1e7 N/m".')
    if number(given, "mass", "kg") == 0.0:
        remedy = 'Write a small one, e.g. "1 g": it changes the stiffness by mass times the square of the frequency.'
        yield Breach((*path, "mass"), "is 0, and the shell is a body with an equation of motion.", remedy)


def _coefficients(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    given = [key for key in GIVEN if key in bearing]
    if "over_speed" in bearing:
        if given:
            problem = f"is given with {' and '.join(given)}."
            yield Breach((*path, "over_speed"), problem, "Keep the table over speed, or the constant coefficients.")
        yield from _over_speed((*path, "over_speed"), table(bearing, "over_speed"))
    elif not given and "file" not in bearing:
        remedy = 'Add e.g. stiffness = [["1e6 N/m", "0 N/m"], ["0 N/m", "1e6 N/m"]], or file = "seal.csv".'
        yield Breach((*path, "stiffness"), "is missing, and so are damping, mass and file.", remedy)
    mass = _matrix(bearing.get("mass"))
    if mass is not None and is_negative(mass):
        problem = "is negative in some direction: no body has such a kinetic energy."
        yield Breach((*path, "mass"), problem, "Give a symmetric matrix with positive entries on its diagonal.")


def _balls(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    angle, clearance = "contact_angle" in bearing, "radial_clearance" in bearing
    if angle == clearance:
        problem = "is given with radial_clearance, from which it follows." if angle else "is missing."
        yield Breach((*path, "contact_angle"), problem, 'Keep one: contact_angle = "15 deg", or radial_clearance.')
    yield from _preload(path, bearing, angle)
    friction = table(bearing, "friction")
    if bool(number(friction, "f0", NUMBER)) != ("viscosity" in friction):
        problem = "has no effect without f0." if "viscosity" in friction else "is missing; the friction by f0 needs it."
        yield Breach((*path, "friction", "viscosity"), problem, 'Give both, e.g. f0 = 1, viscosity = "20 mm^2/s".')
    ball, pitch = (number(bearing, key, "m") for key in ("ball_diameter", "pitch_diameter"))
    balls = _count(bearing, "balls", MOST_BALLS)
    if ball is None or pitch is None or balls < 3:
        return
    if pitch * math.sin(math.pi / balls) <= ball:
        least = ball / math.sin(math.pi / balls)
        problem = f"leaves no room: {balls} balls of {display(ball, 'm')} need a circle of {display(least, 'm')}."
        yield Breach((*path, "pitch_diameter"), problem, "Correct it, or take fewer or smaller balls.")
    grooves = [number(bearing, key, NUMBER) if key in bearing else default for key, default in CURVATURES]
    way, (inner, outer) = number(bearing, "radial_clearance", "m"), grooves
    if way is not None and inner is not None and outer is not None and way >= 2.0 * (inner + outer - 1.0) * ball:
        problem = f"is {display(way, 'm')}: the balls leave grooves of these curvatures."
        yield Breach((*path, "radial_clearance"), problem, 'Write e.g. radial_clearance = "10 um".')


def _row_distance(path: Path, bearing: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[Breach]:
    """Rows that hold the shaft in tilt lie next to each other, and lean against each other."""
    distance, ball = number(bearing, "row_distance", "m"), number(bearing, "ball_diameter", "m")
    if distance is None:
        return
    if bearing.get("arrangement", "single") not in OPPOSED:
        problem = "is of two rows that are face to face or back to back."
        yield Breach(path, problem, 'Remove it, or write e.g. arrangement = "back-to-back".')
    if ball is not None and distance < ball:
        problem = f"is {display(distance, 'm')}: balls of {display(ball, 'm')} in both rows overlap."
        yield Breach(path, problem, "Give the distance between the middles of both rows.")
    if "rotor" in data and table(data, "rotor").get("kind") not in OF_SECTIONS:
        remedy = 'Remove it, or write rotor.kind = "turbocharger" with [[shaft]] sections.'
        yield Breach(path, "has no effect: a symmetric rotor does not tilt.", remedy)


def _preload(path: Path, bearing: Mapping[str, Any], angle: bool) -> Iterator[Breach]:
    """Rings with a contact angle hold together under a preload alone."""
    if angle and (bearing.get("preload") is None or number(bearing, "preload", "N") == 0.0):
        problem = "is missing: without it the rings of an angular contact bearing part under a radial load."
        yield Breach((*path, "preload"), problem, 'Write e.g. preload = "50 N", or { offset = "5 um" }.')


def _locating(path: Path, bearing: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[Breach]:
    """A bearing that carries the axial load does so in one direction, in addition to its spring's preload, or as a pair
    of held rows in both."""
    if "locating" not in bearing:
        return
    if "axial" not in data:
        yield Breach(path, "has no effect without an axial load.", 'Remove it, or add [axial] with e.g. load = "40 N".')
    held, opposed = isinstance(bearing.get("preload"), dict), bearing.get("arrangement", "single") in OPPOSED
    if held and opposed and bearing["locating"] != "both":
        problem = "is of rows that an offset holds together: they carry an axial load in both directions."
        yield Breach(path, problem, 'Write locating = "both".')
    elif bearing["locating"] == "both" and not (held and opposed):
        problem = "needs two rows, face to face or back to back, that an offset holds together."
        yield Breach(path, problem, 'Write e.g. arrangement = "back-to-back", preload = { offset = "5 um" }.')
    elif not (held and opposed) and not number(bearing, "preload", "N"):
        problem = "needs a preload by a spring, to which the axial load is added."
        yield Breach(path, problem, 'Write e.g. preload = "50 N", or remove it.')
    if "rotor" in data and table(data, "rotor").get("kind") not in OF_SECTIONS:
        problem = "is of a symmetric rotor, whose two bearings are equal, and one of them carries the axial load."
        yield Breach(path, problem, 'Write rotor.kind = "turbocharger" with [[shaft]] sections and both bearings.')
    axial = table(data, "axial")
    if listed(axial, "load") and values_of(axial["load"], "N"):
        problem = "changes over time, and a ball bearing has one axial load for each speed."
        yield Breach(("axial", "load"), problem, 'Give one load, or { at = "1000 Hz", load = "40 N" }.')


def _matrix(given: object) -> tuple[float, ...] | None:
    """The entries of a mass matrix, None if it cannot be read; one quantity holds for both directions."""
    if isinstance(given, list | tuple):
        entries = [as_number(entry, "kg") for row in given if isinstance(row, list | tuple) for entry in row]
    else:
        one = 0.0 if given is None else as_number(given, "kg")
        entries = [one, 0.0, 0.0, one]
    known = tuple(entry for entry in entries if entry is not None)
    return known if len(known) == len(entries) == 4 else None


def _over_speed(path: Path, values: Mapping[str, Any]) -> Iterator[Breach]:
    lengths = column_lengths(values)
    count = lengths.get("speed", 0)
    for name, length in lengths.items():
        if length != count:
            yield Breach((*path, name), f"has {length} values at {count} speeds.", "Give one at each speed.")
    if "speed" in values and not count:
        yield Breach((*path, "speed"), "is empty.", "Give the speeds in ascending order.")
    given = [name for name in MASSES if name in values]
    if 0 < len(given) < len(MASSES):
        missing = next(name for name in MASSES if name not in values)
        yield Breach((*path, missing), "is missing, while other masses are given.", "Give all four of them.")
    if len(set(lengths.values())) != 1:
        return
    speeds = [as_number(value, "Hz") for value in values.get("speed", [])]
    masses = [[as_number(value, "kg") for value in values[name]] for name in given]
    if None in speeds or any(None in column for column in masses) or len(given) not in (0, len(MASSES)):
        return
    problem = over_speed_problem([s or 0.0 for s in speeds], [[m or 0.0 for m in column] for column in masses])
    if problem:
        yield Breach((*path, "speed" if "ascend" in problem else "mxx"), problem, "Correct it.")


BODY = {"mass": "9 g", "inertia": "0.2 kg*mm^2", "tilt_inertia": "1 kg*mm^2"}


def cartridge_breaches(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of a cartridge."""
    ring = table(bearing, "ring")
    for key, example in BODY.items() if has_table(bearing, "ring") else ():
        if key not in ring:
            problem = "is missing: the body of a cartridge does not follow from its films."
            yield Breach((*path, "ring", key), problem, f'Add e.g. {key} = "{example}".')
    if "width" in ring:
        yield Breach((*path, "ring", "width"), "has no effect: the mass of a cartridge is given.", "Remove it.")
    yield from tilt_breaches(path, bearing)
    places = [place for _, place in positions(path, bearing)]
    if len(places) == 2 and None not in places and not places[0] < places[1]:  # type: ignore[operator]
        problem = "are equal: the ring has two places." if places[0] == places[1] else "descend."
        yield Breach((*path, "positions"), problem, 'Write them from left to right, e.g. ["20 mm", "60 mm"].')


def tilt_breaches(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    """A ring whose inertias no body has."""
    ring = table(bearing, "ring")
    polar, tilt = number(ring, "inertia", "kg*m^2"), number(ring, "tilt_inertia", "kg*m^2")
    if polar and tilt and tilt < 0.5 * polar * (1.0 - 1e-9):
        problem = f"is less than half of ring.inertia, {display(polar, 'kg*m^2')}, which is not possible."
        yield Breach((*path, "ring", "tilt_inertia"), problem, "Exchange or correct the two.")


def pin_breaches(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    """A pin of a ring that does not turn, and one outside of the ring."""
    if table(bearing, "ring").get("spin") == "blocked" and "pin" in bearing:
        remedy = 'Remove it, or write ring.spin = "free".'
        yield Breach((*path, "pin"), "has no effect: the ring is blocked, as by a pin without play.", remedy)
    radius = number(table(bearing, "pin"), "radius", "m")
    for (_, inside), (_, outside) in ring_films(bearing)[:1]:
        inner, outer = number(inside, "diameter", "m"), number(outside, "diameter", "m")
        if radius and inner and outer and not inner <= 2.0 * radius <= outer:
            within = f"{display(0.5 * inner, 'm')} and {display(0.5 * outer, 'm')}"
            problem = f"is {display(radius, 'm')}, and the ring lies between {within} from the axis."
            remedy = f'Write e.g. "{display(0.25 * (inner + outer), "m")}", the middle of the ring.'
            yield Breach((*path, "pin", "radius"), problem, remedy)


def positions(path: Path, bearing: Mapping[str, Any]) -> list[tuple[Path, float | None]]:
    """The places of a cartridge in m with their paths, None for one that cannot be read."""
    given = listed(bearing, "positions")
    return [((*path, "positions", index), as_number(item, "m")) for index, item in enumerate(given)]


MOST_PADS, MOST_BALLS = 10**6, 10**6
ROUND = 1e-9
FEWEST = 3  # pads of a collar under load
ONE_SIDE = ("left", "right")


def thrust_alone(data: Mapping[str, Any]) -> bool:
    """Whether a case is of thrust bearings alone, without a rotor or a bearing."""
    return bool(tables(data, "thrust_bearing")) and not {"bearing", "rotor", "motion"} & data.keys()


def thrust_breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of thrust bearings."""
    for path, bearing in tables(data, "thrust_bearing"):
        yield from _pads(path, bearing)
        if bearing.get("side", "both") == "both" and "end_play" not in bearing:
            problem = "is missing; the gaps of pads on both sides follow from it."
            remedy = 'Add e.g. end_play = "100 um", or write side = "left" or "right".'
            yield Breach((*path, "end_play"), problem, remedy)
        if table(data, "rotor").get("kind") in OF_SECTIONS and "position" not in bearing:
            yield Breach((*path, "position"), "is missing.", 'Add e.g. position = "80 mm", where the collar stands.')
    if "axial" in data:
        yield from _loaded(data)


def _pads(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    inner, outer = (number(bearing, key, "m") for key in ("inner_radius", "outer_radius"))
    if inner and outer and inner >= outer:
        problem = f"is {display(inner, 'm')}, not below the outer radius of {display(outer, 'm')}."
        yield Breach((*path, "inner_radius"), problem, "Exchange the two radii, or correct them.")
    angle, taper_angle = (number(bearing, key, ANGLE) for key in ("pad_angle", "taper_angle"))
    pads = _count(bearing, "pads", MOST_PADS)
    if angle and pads * angle > 2.0 * math.pi * (1.0 + ROUND):
        degrees = math.degrees(angle)
        problem = f"makes the pads overlap: {pads} of {degrees:.5g} deg are {pads * degrees:.5g} deg."
        remedy = f'With {pads} pads write at most pad_angle = "{360.0 / pads:.5g} deg", or take fewer pads.'
        yield Breach((*path, "pad_angle"), problem, remedy)
    if angle and taper_angle and taper_angle > angle * (1.0 + ROUND):
        problem = f"is {math.degrees(taper_angle):.5g} deg, longer than the pad of {math.degrees(angle):.5g} deg."
        yield Breach((*path, "taper_angle"), problem, "Make it shorter, at most as long as pad_angle.")


def _count(values: Mapping[str, Any], key: str, most: int) -> int:
    """A whole number up to `most`; 0 for anything else, which has a fault of its own."""
    given = values.get(key)
    return given if type(given) is int and given <= most else 0


def _loaded(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of a collar under an axial load."""
    bearings, key = tables(data, "thrust_bearing"), ("axial", "load")
    located = [path for path, bearing in tables(data, "bearing") if "locating" in bearing]
    if not bearings and not located:
        remedy = 'Add [[thrust_bearing]] (docs/thrust.md), or write locating = "right" at a ball bearing.'
        yield Breach(("axial",), "has no thrust bearing that carries its load.", remedy)
        return
    for path in located[0 if bearings else 1 :]:
        problem = "is given with another bearing that carries the axial load."
        yield Breach((*path, "locating"), problem, "Keep one of them.")
    if not bearings:
        return
    if len(bearings) > 1:
        problem = f"is given with {len(bearings)} thrust bearings, and one collar carries it."
        yield Breach(key, problem, 'Keep one, with side = "both" where pads stand on both sides.')
    if "oil" not in data:
        yield Breach(("oil",), "is missing.", "Add the table [oil].")
    first = number(table(data, "speed"), "from", SPEED)
    if first is not None and first < 0.0:
        problem = "turns the collar the other way, in which its pads carry nothing."
        yield Breach(("speed", "from"), problem, 'Write from = "0 Hz" or more, or remove [axial].')
    path, bearing = bearings[0]
    pads = _count(bearing, "pads", MOST_PADS)
    if 0 < pads < FEWEST:
        problem = f"is {pads}: fewer than three pads do not hold a collar alike in all directions."
        yield Breach((*path, "pads"), problem, "Write pads = 3 or more, or remove [axial].")
    yield from _side(key, table(data, "axial").get("load"), bearing.get("side", "both"))


def _side(key: Path, given: Any, side: object) -> Iterator[Breach]:
    """A load towards the side without pads."""
    values = values_of(given.get("load", given) if isinstance(given, dict) else given, "N")
    if side not in ONE_SIDE or not values:
        return
    towards = min(values) if side == "right" else -max(values)
    if towards > 0.0 or (towards == 0.0 < max(values, key=abs)):
        return
    away = "is 0: the film pushes the collar off" if not any(values) else "pulls the collar off its pads, which stand"
    problem = f"{away}{' its pads, which stand' if not any(values) else ''} on its {side} side alone."
    yield Breach(key, problem, 'A load above 0 acts towards larger positions, to the right. Or write side = "both".')
