"""Rules that tie the keys of films together: gap, supply, oil, heat, contact. See checks.py for how they read."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from frbcli.case.film import ColdClearance, Profile
from frbcli.case.oil import ATMOSPHERE, HOTTEST_FILM, Grade, Oil, Vogel
from frbcli.case.over_time import is_over_time, values_of
from frbcli.case.reading.tables import Breach, Path, has_table, number, ring_films, table, tables
from frbcli.case.supplies import supply_named
from frbcli.materials import VogelLaw
from frbcli.units import NUMBER, display

PROFILE: TypeAdapter[tuple[tuple[float, float], ...]] = TypeAdapter(Profile)
TURN, SAME = 2.0 * math.pi, 1e-9  # rad; share of the clearance
THICKEST_MACHINED = 0.05  # clearance of a lobe over the radius
VISCOSITY_RANGE = (1e-6, 1e4)
COLDEST = 200.0  # K, of an oil: a smaller number was meant in degrees Celsius
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
    elif "temperature" in film and "vogel" not in oil and not has_table(oil, "viscosity"):
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
        remedy = "A grade has data from 40 to 150 degC, given points only near them."
        if temperature < COLDEST:
            remedy = 'A number without a unit is in kelvin: 60 degrees Celsius are "60 degC".'
        yield Breach(path, problem, remedy)


def is_constant(oil: Mapping[str, Any]) -> bool:
    """Whether the viscosity of the table [oil] is one for all temperatures."""
    return "viscosity" in oil and not has_table(oil, "viscosity") and "vogel" not in oil


def viscosity_law(oil: Mapping[str, Any]) -> VogelLaw | None:
    """Viscosity over temperature of the table [oil]; None without one, or where it cannot be read."""
    try:
        if "vogel" in oil:
            return Vogel.model_validate(oil["vogel"]).law()
        if "points" in table(oil, "viscosity"):
            return Oil.model_validate(oil).law
        return Grade.model_validate(oil.get("viscosity")).law()
    except ValidationError:
        return None


def warm_clearance(film: Mapping[str, Any], diameter: float | None) -> float | None:
    """The warm radial clearance [m] of a film's table, None where it cannot be read."""
    if not has_table(film, "clearance"):
        return number(film, "clearance", "m")
    try:
        return ColdClearance.model_validate(film["clearance"]).warm(diameter) if diameter else None
    except ValidationError:
        return None


WALLS = ("shaft", "housing")


def thermal_breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of heat in the tables of a case."""
    thermal, oil = table(data, "thermal"), table(data, "oil")
    if not thermal or thermal.get("model") == "none":
        yield from _without_heat(data)
        return
    if is_constant(oil):
        problem = "is constant, but [thermal] has films that warm up."
        remedy = 'Give a grade, { grade = "SAE 10W-40" }, or oil.vogel in its place.'
        yield Breach(("oil", "viscosity"), problem, remedy)
    hottest = number(thermal, "hottest_film", "K", HOTTEST_FILM)
    for path, value in _temperatures(data, thermal):
        yield from law_breaches(oil, value, path)
        if value is not None and hottest is not None and value >= hottest:
            problem = f"is {display(value, 'K')}, not below thermal.hottest_film, {display(hottest, 'K')}."
            yield Breach(path, problem, "Lower it. Temperatures in degrees Celsius have the unit degC.")
    for path, bearing in tables(data, "bearing"):
        films = [((*path, *at), film) for end in ring_films(bearing) for at, film in end]
        for film_path, film in films or [(path, bearing)]:
            yield from _film(film_path, film)


def _film(path: Path, film: Mapping[str, Any]) -> Iterator[Breach]:
    """Keys of a film that heat makes superfluous."""
    if "viscosity" in film:
        problem = "is constant, but [thermal] has films that warm up."
        remedy = "Remove it: the viscosity follows from [oil] at the film's temperature."
        yield Breach((*path, "viscosity"), problem, remedy)
    if "temperature" in film:
        problem = "has no effect: [thermal] finds the film's temperature."
        yield Breach((*path, "temperature"), problem, 'Remove it, or write thermal.model = "none".')
    if "clearance_steps" in film and has_table(film, "clearance"):
        problem = "gives clearances of no temperature, and the clearance before them is a cold one."
        remedy = "Give that at thermal.reference_temperature as a length, as the steps do."
        yield Breach((*path, "clearance_steps"), problem, remedy)


def _temperatures(data: Mapping[str, Any], thermal: Mapping[str, Any]) -> Iterator[tuple[Path, float | None]]:
    """The temperatures that the oil meets, by their keys."""
    if "start_temperature" in thermal:
        yield ("thermal", "start_temperature"), number(thermal, "start_temperature", "K")
    places: list[tuple[Path, Mapping[str, Any]]] = [(("thermal",), thermal), *tables(data, "bearing")]
    for path, holder in places:
        for key in ("supply_temperature", *WALLS):
            if key in holder and holder[key] != "adiabatic":
                values = values_of(holder[key], "K")
                yield from (((*path, key), limit(values)) for limit in (min, max) if values)


def _without_heat(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Keys of bearings that have an effect with heat only."""
    if "thermal" in data:
        yield from _inputs_without_heat(data)
        return
    for path, bearing in tables(data, "bearing"):
        for key in (*WALLS, "supply_temperature"):
            if key in bearing:
                yield Breach((*path, key), "has no effect without heat.", "Remove it, or add the table [thermal].")


def _inputs_without_heat(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Temperatures over time where [thermal] has no model."""
    for path, holder in ((("thermal",), table(data, "thermal")), *tables(data, "bearing")):
        for key in (*WALLS, "supply_temperature"):
            if is_over_time(holder.get(key)):
                problem = "changes over time, and without heat all films keep their temperature."
                yield Breach((*path, key), problem, 'Write thermal.model = "lumped", or one temperature.')


OF_SPRING = ("policy", "stiffness")
OF_ASPERITIES = {"roughness": '"0.5 um"', "summit_radius": '"20 um"', "summit_density": '"1e10 1/m^2"'}
WITH_DEFAULT = (  # of asperities, too
    "mean_height", "modulus", "hardness", "friction", "wear", "flow_factors", "journal_roughness",
)  # fmt: skip
STEEPEST = 0.3  # roughness over summit_radius: summits of rough surfaces are flat
MOST_CROWDED = math.sqrt(2.0) / math.pi  # density, radius and roughness: all of the area, pi^2 N^2 b^2 s^2 F_2(0) = 1


def contact_breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Keys of the other model, keys that are missing, and summits that are no summits."""
    contact = table(data, "contact")
    if contact.get("model", "spring") == "spring":
        if contact.get("policy") == "elastic" and "stiffness" not in contact:
            problem = "is missing; elastic contact needs it."
            yield Breach(("contact", "stiffness"), problem, 'Add stiffness = "1e8 N/m".')
        for key in (*OF_ASPERITIES, *WITH_DEFAULT):
            if key in contact:
                problem = "has an effect on rough surfaces only."
                yield Breach(("contact", key), problem, 'Add model = "asperities", or remove it.')
    elif contact["model"] == "asperities":
        yield from _breaches_of_asperities(contact)


def _breaches_of_asperities(contact: Mapping[str, Any]) -> Iterator[Breach]:
    for key in OF_SPRING:
        if key in contact:
            yield Breach(("contact", key), "has an effect between smooth surfaces only.", "Remove it.")
    for key, example in OF_ASPERITIES.items():
        if key not in contact:
            yield Breach(("contact", key), "is missing; asperities need it.", f"Add {key} = {example}.")
    if "wear" in contact and "hardness" not in contact:
        yield Breach(("contact", "hardness"), "is missing; wear goes with 1 / hardness.", 'Add hardness = "2 GPa".')
    roughness, radius = number(contact, "roughness", "m"), number(contact, "summit_radius", "m")
    journal = number(contact, "journal_roughness", "m")
    if journal is not None and contact.get("flow_factors") is not True:
        problem = "has an effect on flow factors only."
        yield Breach(("contact", "journal_roughness"), problem, "Add flow_factors = true, or remove it.")
    elif journal and roughness and journal > roughness:
        problem = "is more than roughness, which holds for both surfaces together."
        yield Breach(("contact", "journal_roughness"), problem, "Correct one of the two.")
    if roughness and radius and roughness > STEEPEST * radius > 0.0:
        problem = f"is {roughness / radius:.3g} of summit_radius, and summits are flat: at most {STEEPEST:g} of it."
        yield Breach(("contact", "roughness"), problem, "Correct one of the two.")
    density = number(contact, "summit_density", "1/m^2")
    if roughness and radius and density and (crowd := density * radius * roughness) > MOST_CROWDED:
        problem = f"lets summits touch on {(crowd / MOST_CROWDED) ** 2:.3g} times the area, where the mean planes meet."
        remedy = f'Give no more than "{MOST_CROWDED / (radius * roughness):.2g} 1/m^2" with this radius and roughness.'
        yield Breach(("contact", "summit_density"), problem, remedy)
