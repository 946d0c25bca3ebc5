"""Rules that tie the keys of thrust bearings together. See checks.py."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, table, tables
from frbcli.case.rotor import OF_SECTIONS
from frbcli.case.surroundings.over_time import values_of
from frbcli.units import ANGLE, SPEED, display

MOST_PADS = 10**6
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
    pads = bearing.get("pads")
    if not isinstance(pads, int) or isinstance(pads, bool) or pads > MOST_PADS:  # has a fault of its own
        pads = 0
    if angle and pads * angle > 2.0 * math.pi * (1.0 + ROUND):
        degrees = math.degrees(angle)
        problem = f"makes the pads overlap: {pads} of {degrees:.5g} deg are {pads * degrees:.5g} deg."
        remedy = f'With {pads} pads write at most pad_angle = "{360.0 / pads:.5g} deg", or take fewer pads.'
        yield Breach((*path, "pad_angle"), problem, remedy)
    if angle and taper_angle and taper_angle > angle * (1.0 + ROUND):
        problem = f"is {math.degrees(taper_angle):.5g} deg, longer than the pad of {math.degrees(angle):.5g} deg."
        yield Breach((*path, "taper_angle"), problem, "Make it shorter, at most as long as pad_angle.")


def _loaded(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of a collar under an axial load."""
    bearings, key = tables(data, "thrust_bearing"), ("axial", "load")
    if not bearings:
        remedy = "Add [[thrust_bearing]], or remove the table; see docs/thrust.md."
        yield Breach(("axial",), "has no thrust bearing that carries its load.", remedy)
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
    pads = bearing.get("pads")
    if isinstance(pads, int) and not isinstance(pads, bool) and 0 < pads < FEWEST:
        problem = f"is {pads}: fewer than three pads do not hold a collar alike in all directions."
        yield Breach((*path, "pads"), problem, "Write pads = 3 or more, or remove [axial].")
    yield from _side(key, table(data, "axial").get("load"), bearing.get("side", "both"))


def _side(key: Path, given: Any, side: object) -> Iterator[Breach]:
    """A load towards the side without pads."""
    values = values_of(given.get("load") if isinstance(given, dict) and "load" in given else given, "N")
    if side not in ONE_SIDE or not values:
        return
    towards = min(values) if side == "right" else -max(values)
    if towards > 0.0 or (towards == 0.0 < max(values, key=abs)):
        return
    away = "is 0: the film pushes the collar off" if not any(values) else "pulls the collar off its pads, which stand"
    problem = f"{away}{' its pads, which stand' if not any(values) else ''} on its {side} side alone."
    yield Breach(key, problem, 'A load above 0 acts towards larger positions, to the right. Or write side = "both".')
