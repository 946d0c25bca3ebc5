"""Rules of a cartridge, its two places and its body, and of the inertias and pins of rings. See checks.py."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, ring_films, table
from frbcli.units import display

BODY = {"mass": "9 g", "inertia": "0.2 kg*mm^2", "tilt_inertia": "1 kg*mm^2"}


def cartridge_breaches(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of a cartridge."""
    ring = table(bearing, "ring")
    for key, example in BODY.items() if isinstance(bearing.get("ring"), dict) else ():
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
    given = bearing.get("positions")
    items = given if isinstance(given, list) else []
    return [((*path, "positions", index), number({"": item}, "", "m")) for index, item in enumerate(items)]
