"""Rules that tie the keys of elements without a film together, and rules of cases without any film. See checks.py."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.elements import EMPTY_MATRIX, WITHOUT_FILM, BallBearingKeys
from frbcli.case.files.coefficient_files import MASSES, column_lengths, is_negative, over_speed_problem
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, table, tables
from frbcli.units import NUMBER, display

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
    kinds = {bearing.get("kind") for _, bearing in tables(data, "bearing")}
    return kinds == {"ball"} and not {"rotor", "speed"} & data.keys()


def element_breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of elements without a film, of dampers and of supports."""
    for path, bearing in tables(data, "bearing"):
        if bearing.get("kind") == "coefficients":
            yield from _coefficients(path, bearing)
        if bearing.get("kind") == "ball":
            yield from _balls(path, bearing)
        for body in ("damper", "support"):
            yield from _body((*path, body), bearing.get(body), data)
    if has_films(data):
        return
    for place in OF_FILMS:
        holder = data if len(place) == 1 else table(data, place[0])
        if place[-1] in holder:
            yield Breach(place, "has no effect: no bearing has a film.", REMEDY)
    if "motion" in data:
        yield Breach(("motion",), "moves a journal in a film, and no bearing of the case has a film.", REMEDY)


def _body(path: Path, given: object, data: Mapping[str, Any]) -> Iterator[Breach]:
    """What is wrong with the body of a damper or a support."""
    if not isinstance(given, dict):
        return
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
    ball, pitch = (number(bearing, key, "m") for key in ("ball_diameter", "pitch_diameter"))
    balls = bearing.get("balls")
    if ball is None or pitch is None or not isinstance(balls, int) or balls < 3:
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


def _preload(path: Path, bearing: Mapping[str, Any], angle: bool) -> Iterator[Breach]:
    """Rings with a contact angle hold together under a preload alone."""
    given = bearing.get("preload")
    none = given is None or (not isinstance(given, dict) and number(bearing, "preload", "N") == 0.0)
    if none and angle:
        problem = "is missing: without it the rings of an angular contact bearing part under a radial load."
        yield Breach((*path, "preload"), problem, 'Write e.g. preload = "50 N", or { offset = "5 um" }.')


def _matrix(given: object) -> tuple[float, ...] | None:
    """The entries of a mass matrix, None if it cannot be read; one quantity holds for both directions."""
    if given is None:
        return tuple(entry for row in EMPTY_MATRIX for entry in row)
    if isinstance(given, list | tuple) and len(given) == 2 and all(isinstance(r, list | tuple) for r in given):
        entries = [number({"": entry}, "", "kg") for row in given for entry in row]
    else:
        entries = [number({"": given}, "", "kg"), 0.0, 0.0, number({"": given}, "", "kg")]
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
    speeds = [number({"": value}, "", "Hz") for value in values.get("speed", [])]
    masses = [[number({"": value}, "", "kg") for value in values[name]] for name in given]
    if None in speeds or any(None in column for column in masses) or len(given) not in (0, len(MASSES)):
        return
    problem = over_speed_problem([s or 0.0 for s in speeds], [[m or 0.0 for m in column] for column in masses])
    if problem:
        yield Breach((*path, "speed" if "ascend" in problem else "mxx"), problem, "Correct it.")
