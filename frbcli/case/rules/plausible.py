"""Values outside the usual range, mostly by a wrong unit: refused unless the case confirms them by `confirm`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from frbcli.case.quantities import LARGEST
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, Located, at, number, ring_films, table, tables
from frbcli.case.rules.film_checks import warm_clearance
from frbcli.film.operating import RING_SPEED, ring_rotation_strains, shaft_rotation_strain
from frbcli.materials.solids import BRASS, STEEL
from frbcli.units import SPEED, display, readable

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
    given = data.get("confirm")
    confirmed = given if isinstance(given, list) else []
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
