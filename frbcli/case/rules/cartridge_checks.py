"""Rules of cartridges, contact and the keys of a machine.

Rules of a cartridge, its two places and its body, and of the inertias and pins of rings. See checks.py.

Rules that tie the keys of [contact] together, and to the clearances. See checks.py.

Which keys of a case are numbers of the machine, and which say how it is run, computed and recorded.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, ring_films, table
from frbcli.case.schema import Case
from frbcli.errors import Fault
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
    """A pin of a ring that does not turn, and one beside the ring."""
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
        problem = "is more than roughness, which is that of both surfaces."
        yield Breach(("contact", "journal_roughness"), problem, "Correct one of the two.")
    if roughness and radius and roughness > STEEPEST * radius > 0.0:
        problem = f"is {roughness / radius:.3g} of summit_radius, and summits are flat: at most {STEEPEST:g} of it."
        yield Breach(("contact", "roughness"), problem, "Correct one of the two.")
    density = number(contact, "summit_density", "1/m^2")
    if roughness and radius and density and (crowd := density * radius * roughness) > MOST_CROWDED:
        problem = f"lets summits touch on {(crowd / MOST_CROWDED) ** 2:.3g} times the area, where the mean planes meet."
        remedy = f'Give no more than "{MOST_CROWDED / (radius * roughness):.2g} 1/m^2" with this radius and roughness.'
        yield Breach(("contact", "summit_density"), problem, remedy)


OF_THE_RUN = ("name", "title", "confirm", "speed", "motion", "start", "accuracy", "output")
TABLES = tuple(
    key for key in (field.alias or name for name, field in Case.model_fields.items()) if key not in OF_THE_RUN
)
# Keys of these tables that are no numbers of the machine: of the reduction of its rotor, of kinematic tests, of the
# course and the end of a run.
OTHERS = re.compile(r"rotor\.cutoff|.*\.ramp|.*\.clearance_steps\..*\.time|thermal\.hottest_film|contact\.eccentricity")

_NUMBERED = re.compile(r"\.\d+(?=\.|$)")


def machine_fault(key: str, option: str) -> Fault | None:
    """Why a key cannot be varied as a number of the machine; None if it is one. option: where it was given."""
    table = key.partition(".")[0].strip()
    if table in TABLES and not OTHERS.fullmatch(_NUMBERED.sub(".0", key.strip())):
        return None
    problem = "is no number of the machine: it is a setting of the run or of its computation."
    tables = ", ".join(f"[{name}]" for name in TABLES[:-1])
    remedy = f"Vary a key of {tables} or [{TABLES[-1]}], e.g. bearing.clearance; frb sweep takes any key."
    return Fault(option, key, None, problem, remedy)
