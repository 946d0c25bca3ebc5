"""Rules that tie several keys of a case together.

They read the tables as the user wrote them, so that they also speak when some other key is at fault: a value that is
absent or cannot be read is simply not there, and the rules that need it are silent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from frbcli.case.bearing import ColdClearance
from frbcli.case.lines import Path
from frbcli.case.schema import ATMOSPHERE, DEFAULT_HOLD, OUTPUT_STEP, Vogel
from frbcli.units import NUMBER, ValueFault, display, quantity

# A film is thin, the Reynolds equation its limit for clearance/radius -> 0.
THICKEST_FILM = 0.05
MOST_SAMPLES = 20_000_000
VISCOSITY_RANGE = (1e-6, 1e4)


@dataclass(frozen=True)
class Breach:
    """A rule that is broken: the key to change, what is wrong, and the remedy."""

    path: Path
    problem: str
    remedy: str


def breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of a case's tables."""
    bearings = _tables(data, "bearing")
    if data.get("bearing") == []:
        yield Breach(("bearing",), "is empty.", "Add the table [bearing].")
    yield from _oil(data)
    for path, bearing in bearings:
        for film_path, film in _films(path, bearing):
            yield from _film(film_path, film, data)
        yield from _ring(path, bearing)
    yield from _names(bearings)
    yield from _rotor(data, bearings)
    yield from _run(data)
    yield from _motion(_table(data, "motion"))
    for key in ("rotor", "speed"):
        if key not in data and "motion" not in data:
            yield Breach((key,), "is missing.", f"Add the table [{key}].")


def _oil(data: Mapping[str, Any]) -> Iterator[Breach]:
    oil = data.get("oil")
    if not isinstance(oil, dict):
        return
    if "viscosity" in oil and "vogel" in oil:
        yield Breach(("oil", "vogel"), "gives the viscosity a second time.", "Keep viscosity or vogel.")
    if "viscosity" not in oil and "vogel" not in oil:
        yield Breach(("oil", "viscosity"), "is missing.", 'Add e.g. viscosity = "12 mPa*s" to [oil].')
    if "viscosity" not in oil and "vogel" in oil and "temperature" not in oil:
        yield Breach(("oil", "temperature"), "is missing; Vogel's law needs it.", 'Add e.g. temperature = "100 degC".')
    yield from _vogel(oil, _number(oil, "temperature", "K"), ("oil", "temperature"))
    ambient, cavitation = _number(oil, "ambient_pressure", "Pa", ATMOSPHERE), _number(oil, "cavitation_pressure", "Pa")
    if ambient and cavitation and cavitation > ambient:
        problem = f"is {display(cavitation, 'Pa')}, above the ambient pressure of {display(ambient, 'Pa')}."
        yield Breach(("oil", "cavitation_pressure"), problem, "Pressures are absolute; lower it, or leave it away.")


def _vogel(oil: Mapping[str, Any], temperature: float | None, path: Path) -> Iterator[Breach]:
    try:
        vogel = Vogel.model_validate(oil.get("vogel"))
    except ValidationError:
        return
    if temperature is None:
        return
    viscosity = vogel.at(temperature)
    if not VISCOSITY_RANGE[0] <= viscosity <= VISCOSITY_RANGE[1]:
        problem = f"makes the viscosity {viscosity:.3g} Pa*s by Vogel's law."
        yield Breach(path, problem, "Check eta_0, A and C; the temperature T in eta_0 exp(A / (T + C)) is in kelvin.")


def _film(path: Path, film: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[Breach]:
    oil = _table(data, "oil")
    diameter, width = _number(film, "diameter", "m"), _number(film, "width", "m")
    clearance = _clearance(film, diameter)
    if diameter and clearance is not None and not 0 < clearance < THICKEST_FILM * diameter / 2:
        problem = f"is {display(clearance, 'm')}, no thin film at a diameter of {display(diameter, 'm')}."
        yield Breach((*path, "clearance"), problem, "It is the radial gap, about a thousandth of the radius.")
    if "temperature" in film and "vogel" not in oil:
        yield Breach((*path, "temperature"), "has no effect: [oil] has no Vogel's law.", "Add oil.vogel or remove it.")
    elif "temperature" in film:
        yield from _vogel(oil, _number(film, "temperature", "K"), (*path, "temperature"))
    ambient = _number(oil, "ambient_pressure", "Pa", ATMOSPHERE)
    supply = _table(film, "supply")
    yield from _supply((*path, "supply"), supply, width, ambient)
    if supply.get("kind") == "bores":
        yield from _bores((*path, "supply"), supply, diameter, width)


def _supply(path: Path, supply: Mapping[str, Any], width: float | None, ambient: float | None) -> Iterator[Breach]:
    pressure = _number(supply, "pressure", "Pa")
    if pressure and ambient and pressure < ambient:
        problem = f"is {display(pressure, 'Pa')}, below the ambient pressure of {display(ambient, 'Pa')}."
        yield Breach((*path, "pressure"), problem, "Pressures are absolute: ambient plus gauge pressure.")
    count, angle = _number(supply, "count", NUMBER, 1.0), _number(supply, "opening_angle", "rad")
    if count and angle and count * angle >= 2 * math.pi:
        yield Breach((*path, "opening_angle"), f"leaves no film between {count:.0f} grooves.", "Make it smaller.")
    for key in ("width", "diameter"):  # of a pocket, of a bore
        size = _number(supply, key, "m")
        if size and width and size > width:
            yield Breach((*path, key), f"is wider than the bearing ({display(width, 'm')}).", "Make it narrower.")


def _bores(
    path: Path, supply: Mapping[str, Any], diameter: float | None, width: float | None
) -> Iterator[Breach]:
    count, bore = _number(supply, "count", NUMBER, 1.0), _number(supply, "diameter", "m")
    place = _number(supply, "axial_position", NUMBER, 0.5)
    if count and bore and diameter and count * bore >= math.pi * diameter:
        problem = f"makes {count:.0f} bores overlap on a circumference of {display(math.pi * diameter, 'm')}."
        yield Breach((*path, "diameter"), problem, "Make it smaller, or take fewer bores.")
    if bore and width and bore <= width and place is not None and 0 <= place <= 1:
        over = 0.5 * bore - width * min(place, 1.0 - place)
        if over > 0.0:
            problem = f"puts the bores {display(over, 'm')} outside of the film."
            least = 0.5 * bore / width
            remedy = f"Take a value from {least:.3g} to {1.0 - least:.3g}, or smaller bores."
            yield Breach((*path, "axial_position"), problem, remedy)


def _ring(path: Path, bearing: Mapping[str, Any]) -> Iterator[Breach]:
    inner, outer = (_number(_table(bearing, side), "diameter", "m") for side in ("inner", "outer"))
    if inner and outer and inner >= outer:
        problem = f"is {display(inner, 'm')}, not inside of the outer film's {display(outer, 'm')}."
        yield Breach((*path, "inner", "diameter"), problem, "Exchange inner and outer, or correct the diameters.")


def _names(bearings: list[tuple[Path, dict[str, Any]]]) -> Iterator[Breach]:
    seen: set[str] = set()
    for number, (path, bearing) in enumerate(bearings, start=1):
        name = bearing.get("name", str(number))
        if isinstance(name, str) and name in seen:
            yield Breach((*path, "name"), "is the name of another bearing, too.", "Give each bearing its own name.")
        seen.add(str(name) if isinstance(name, str) else "")


def _rotor(data: Mapping[str, Any], bearings: list[tuple[Path, dict[str, Any]]]) -> Iterator[Breach]:
    kind = _table(data, "rotor").get("kind")
    if kind == "turbocharger":
        if not data.get("shaft"):
            yield Breach(("shaft",), "is missing.", "Add [[shaft]] sections with length and diameter.")
        if len(bearings) < 2:
            yield Breach(("bearing",), "is there once; a turbocharger's rotor needs two.", "Write [[bearing]] twice.")
        for path, bearing in bearings:
            if "position" not in bearing:
                yield Breach((*path, "position"), "is missing.", 'Add e.g. position = "80 mm".')
        yield from _on_shaft(data, bearings)
    elif kind in ("rigid", "jeffcott"):
        for key in ("shaft", "disk"):
            if key in data:
                yield Breach((key,), f"does not go with a {kind} rotor.", 'Remove it, or take kind = "turbocharger".')


def _on_shaft(data: Mapping[str, Any], bearings: list[tuple[Path, dict[str, Any]]]) -> Iterator[Breach]:
    lengths = [_number(section, "length", "m") for _, section in _tables(data, "shaft")]
    if not lengths or None in lengths:
        return
    total = sum(length for length in lengths if length is not None)
    for path, part in (*bearings, *_tables(data, "disk")):
        position = _number(part, "position", "m")
        if position is not None and not 0 <= position <= total * (1 + 1e-9):
            problem = f"is {display(position, 'm')}, not on the shaft of {display(total, 'm')}."
            yield Breach((*path, "position"), problem, "Positions count from the start of the first section.")


def _run(data: Mapping[str, Any]) -> Iterator[Breach]:
    contact, start, speed = _table(data, "contact"), _table(data, "start"), _table(data, "speed")
    if contact.get("policy") == "elastic" and "stiffness" not in contact:
        yield Breach(("contact", "stiffness"), "is missing; elastic contact needs it.", 'Add stiffness = "1e8 N/m".')
    displacement = start.get("displacement")
    if isinstance(displacement, list) and len(displacement) == 2:
        x, y = (_number({"": item}, "", NUMBER) for item in displacement)
        if x is not None and y is not None and math.hypot(x, y) >= 1:
            yield Breach(("start", "displacement"), "is outside of the clearance.", "Its length must be below 1.")
    if "displacement" in start and "position" in start:
        yield Breach(("start", "position"), "is given beside a displacement.", "Keep one of the two.")
    duration, step = _number(speed, "duration", "s"), _number(_table(data, "output"), "step", "s", OUTPUT_STEP)
    if not duration or not step or min(duration, step) < 0:
        return
    if step >= duration:
        problem = f"is {display(step, 's')}, not below the duration of {display(duration, 's')}."
        yield Breach(("output", "step"), problem, "Shorten the step.")
    whole = duration + (_number(speed, "hold", "s", DEFAULT_HOLD) or 0.0)
    whole += _number(speed, "down_duration", "s", duration) or 0.0
    if whole / step > MOST_SAMPLES:
        problem = f"makes {whole / step:.3g} samples of one run."
        yield Breach(("output", "step"), problem, "Lengthen it, or run shorter.")


def _motion(motion: Mapping[str, Any]) -> Iterator[Breach]:
    if "load" in motion and "eccentricity" in motion:
        yield Breach(("motion", "load"), "is given beside an eccentricity.", "Keep one of the two.")


def _clearance(film: Mapping[str, Any], diameter: float | None) -> float | None:
    given = film.get("clearance")
    if not isinstance(given, dict):
        return _number(film, "clearance", "m")
    try:
        return ColdClearance.model_validate(given).warm(diameter) if diameter else None
    except ValidationError:
        return None


def _films(path: Path, bearing: dict[str, Any]) -> Iterator[tuple[Path, dict[str, Any]]]:
    if bearing.get("kind") == "single-film":
        yield path, bearing
    if bearing.get("kind") == "floating-ring":
        for side in ("inner", "outer"):
            yield (*path, side), _table(bearing, side)


def _tables(data: Mapping[str, Any], key: str) -> list[tuple[Path, dict[str, Any]]]:
    """The tables of [key] or [[key]] with their paths."""
    found = data.get(key)
    if isinstance(found, dict):
        return [((key,), found)]
    tables = enumerate(found) if isinstance(found, list) else ()
    return [((key, index), table) for index, table in tables if isinstance(table, dict)]


def _table(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    found = data.get(key)
    return found if isinstance(found, dict) else {}


def _number(table: Mapping[str, Any], key: str, unit: str, default: float | None = None) -> float | None:
    """The SI value of a key; `default` where it is absent, None where it cannot be read."""
    if key not in table:
        return default
    try:
        return quantity(table[key], unit)
    except ValueFault:
        return None
