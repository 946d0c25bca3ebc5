"""Rules that tie the keys of one film together: its gap, its supply, its oil. See checks.py for how they read."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from frbcli.case.film_geometry import ColdClearance, Profile
from frbcli.case.oil import ATMOSPHERE, Grade, Oil, Vogel
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, table, tables
from frbcli.case.supplies.table import supply_named
from frbcli.materials.oils import OILS
from frbcli.materials.viscosity import VogelLaw
from frbcli.units import NUMBER, display

PROFILE: TypeAdapter[tuple[tuple[float, float], ...]] = TypeAdapter(Profile)
TURN, SAME = 2.0 * math.pi, 1e-9  # rad; share of the clearance
THICKEST_MACHINED = 0.05  # clearance of a lobe over the radius
VISCOSITY_RANGE = (1e-6, 1e4)
LONGEST = 1e5  # width over the diameter


def film_breaches(path: Path, film: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of the film at a path of the case's tables."""
    oil = table(data, "oil")
    diameter, width = number(film, "diameter", "m"), number(film, "width", "m")
    clearance = warm_clearance(film, diameter)
    if diameter and width and width > LONGEST * diameter:
        problem = f"is {width / diameter:.3g} times the diameter: no bearing, and no table of its forces is finite."
        yield Breach((*path, "width"), problem, "Check its unit.")
    if diameter and clearance is not None and not 0 < clearance < diameter / 2:
        yield _too_thick((*path, "clearance"), clearance, diameter)
    elif diameter and clearance is not None:
        yield from _lobes((*path, "lobes"), table(film, "lobes"), clearance, diameter)
    yield from _clearance_steps(path, film, diameter, data)
    if "temperature" in film and "viscosity" in film:
        problem = "has no effect: the film has a viscosity of its own."
        yield Breach((*path, "temperature"), problem, "Keep one of the two.")
    elif "temperature" in film and "vogel" not in oil and not isinstance(oil.get("viscosity"), dict):
        yield Breach((*path, "temperature"), "has no effect: [oil] has no Vogel's law.", "Add oil.vogel or remove it.")
    elif "temperature" in film:
        yield from law_breaches(oil, number(film, "temperature", "K"), (*path, "temperature"))
    ambient = number(oil, "ambient_pressure", "Pa", ATMOSPHERE)
    supply = table(film, "supply")
    yield from supply_named(supply.get("kind")).breaches((*path, "supply"), supply, diameter, width, ambient)
    for key in ("lobes", "profile"):
        if supply.get("on") == "journal" and key in film:
            problem = "belongs to the shell, and the feed holes to the journal: no frame has both at rest."
            yield Breach((*path, key), problem, 'Remove it, or write supply.on = "shell".')
    if "profile" in film:
        yield from _profile((*path, "profile"), film, clearance, diameter)


def _too_thick(path: Path, clearance: float, diameter: float) -> Breach:
    problem = f"is {display(clearance, 'm')}, too large for a film at a diameter of {display(diameter, 'm')}."
    return Breach(path, problem, "It is the radial gap, about a thousandth of the radius.")


def _clearance_steps(
    path: Path, film: Mapping[str, Any], diameter: float | None, data: Mapping[str, Any]
) -> Iterator[Breach]:
    steps, before = tables(film, "clearance_steps"), 0.0
    if steps and "speed" not in data and "motion" in data:
        yield Breach((*path, "clearance_steps"), "has no effect on kinematic tests.", "Remove it.")
    for place, step in steps:
        time, clearance = number(step, "time", "s"), number(step, "clearance", "m")
        if diameter and clearance is not None and clearance >= diameter / 2:
            yield _too_thick((*path, *place, "clearance"), clearance, diameter)
        elif diameter and clearance is not None:
            yield from _lobes((*path, "lobes"), table(film, "lobes"), clearance, diameter)
        if time is not None and 0 < time <= before:
            problem = f"is {display(time, 's')}, not after the step before it."
            yield Breach((*path, *place, "time"), problem, "Write the steps in the order of their times.")
        before = max(before, time or 0.0)


def _lobes(path: Path, lobes: Mapping[str, Any], clearance: float, diameter: float) -> Iterator[Breach]:
    preload = number(lobes, "preload", NUMBER)
    if preload is None or not 0 <= preload < 1:
        return
    machined = clearance / (1.0 - preload)
    if machined >= THICKEST_MACHINED * diameter / 2:
        problem = f"makes a machined clearance of {display(machined, 'm')}, too large for a thin film."
        yield Breach((*path, "preload"), problem, "It is 1 - c_b / c_p, with the assembled clearance c_b.")


def _profile(
    path: Path, film: Mapping[str, Any], clearance: float | None, diameter: float | None
) -> Iterator[Breach]:
    """A table of gaps over one turn, none of which is less than the clearance."""
    if "lobes" in film:
        yield Breach(path, "is given with lobes.", "Keep one of the two.")
    try:
        angles, gaps = zip(*PROFILE.validate_python(film["profile"]), strict=True)
    except ValidationError:
        return
    if any(after <= before for before, after in itertools.pairwise(angles)) or angles[-1] - angles[0] >= TURN:
        yield Breach(path, "has angles that do not rise within one turn.", "Order its points by phi.")
    if clearance is not None and min(gaps) < clearance * (1.0 - SAME):
        problem = f"has a gap of {display(min(gaps), 'm')}, less than the clearance of {display(clearance, 'm')}."
        yield Breach(path, problem, "Give the least gap as clearance.")
    if diameter and max(gaps) >= THICKEST_MACHINED * diameter / 2:
        yield Breach(path, f"has a gap of {display(max(gaps), 'm')}, too large for a thin film.", "Check its unit.")


def law_breaches(oil: Mapping[str, Any], temperature: float | None, path: Path) -> Iterator[Breach]:
    """A viscosity by Vogel's law or of a grade that no oil has; path: of the temperature in K."""
    law = viscosity_law(oil)
    if temperature is None or law is None:
        return
    viscosity = law.at(temperature)
    if VISCOSITY_RANGE[0] <= viscosity <= VISCOSITY_RANGE[1]:
        return
    if "vogel" in oil:
        problem = f"makes the viscosity {viscosity:.3g} Pa*s by Vogel's law."
        yield Breach(path, problem, "Check eta_0, A and C; the temperature T in eta_0 exp(A / (T + C)) is in kelvin.")
    else:
        given = "points" if "points" in oil["viscosity"] else "grade"
        problem = f"makes the viscosity of the {given} {viscosity:.3g} Pa*s."
        yield Breach(path, problem, "A grade has data from 40 to 150 degC, given points only near them.")


def viscosity_law(oil: Mapping[str, Any]) -> VogelLaw | None:
    """Viscosity over temperature of the table [oil]; None without one, or where it cannot be read."""
    try:
        if "vogel" in oil:
            return Vogel.model_validate(oil["vogel"]).law
        given = oil.get("viscosity")
        if isinstance(given, dict) and "points" in given:
            return Oil.model_validate(oil).law
        return OILS[Grade.model_validate(given).grade].law
    except ValidationError:
        return None


def warm_clearance(film: Mapping[str, Any], diameter: float | None) -> float | None:
    """The warm radial clearance [m] of a film's table, None where it cannot be read."""
    given = film.get("clearance")
    if not isinstance(given, dict):
        return number(film, "clearance", "m")
    try:
        return ColdClearance.model_validate(given).warm(diameter) if diameter else None
    except ValidationError:
        return None
