"""Rules that tie the keys of thrust bearings together. See checks.py."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, table, tables
from frbcli.case.rotor import OF_SECTIONS
from frbcli.units import ANGLE, display

ROUND = 1e-9


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


def _pads(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    inner, outer = (number(bearing, key, "m") for key in ("inner_radius", "outer_radius"))
    if inner and outer and inner >= outer:
        problem = f"is {display(inner, 'm')}, not below the outer radius of {display(outer, 'm')}."
        yield Breach((*path, "inner_radius"), problem, "Exchange the two radii, or correct them.")
    angle, taper_angle = (number(bearing, key, ANGLE) for key in ("pad_angle", "taper_angle"))
    pads = bearing.get("pads")
    if isinstance(pads, int) and not isinstance(pads, bool) and angle and pads * angle > 2.0 * math.pi * (1.0 + ROUND):
        degrees = math.degrees(angle)
        problem = f"makes the pads overlap: {pads} of {degrees:.5g} deg are {pads * degrees:.5g} deg."
        remedy = f'With {pads} pads write at most pad_angle = "{360.0 / pads:.5g} deg", or take fewer pads.'
        yield Breach((*path, "pad_angle"), problem, remedy)
    if angle and taper_angle and taper_angle > angle * (1.0 + ROUND):
        problem = f"is {math.degrees(taper_angle):.5g} deg, longer than the pad of {math.degrees(angle):.5g} deg."
        yield Breach((*path, "taper_angle"), problem, "Make it shorter, at most as long as pad_angle.")
