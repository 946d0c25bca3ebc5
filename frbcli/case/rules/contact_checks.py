"""Rules that tie the keys of [contact] together, and to the clearances. See checks.py."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.reading.tables import Breach, number, table

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
