"""Where a journal is in static equilibrium in the two forms of the two-phase model, and how much oil they create."""

import math

from validation.chapter6 import at_rest, eccentricity
from validation.chapter6_rows import AXIAL, BATH, CIRCUMFERENTIAL, PENALTY, PUBLISHED, TWO_BAR
from validation.measured import listed

SPEED_Hz = 30.0
SUPPLIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "groove around, 1 bar, free to air": (CIRCUMFERENTIAL, ()),
    "groove around, 1 bar, oil bath": (CIRCUMFERENTIAL, (BATH,)),
    "groove around, 2 bar, free to air": (CIRCUMFERENTIAL, (TWO_BAR,)),
    "axial groove, 1 bar, free to air": (AXIAL, ()),
}
HEAD = """## Two forms of the two-phase model

The form (4.31) of the source, `form = "published"`, does not conserve oil; the default is `form = "conservative"`. They
differ where oil is supplied at ambient pressure and the film starves: the published form creates the oil that leaves.

Eccentricity in static equilibrium, 30 Hz, x_1 = 0.99; created: outflow less inflow, as a share of it, in % (published,
conservative).

| supply | penalty | published | conservative | created |
| --- | --- | --- | --- | --- |"""


def table() -> list[str]:
    """The section on the two forms."""
    lines = [HEAD]
    for words, (case, settings) in SUPPLIES.items():
        found = [at_rest(case, SPEED_Hz, *settings, *model) for model in ((PENALTY,), (PUBLISHED,), ())]
        created = [
            math.nan if result.loads is None else -100.0 * result.loads.oil.defect_relative for result in found[1:]
        ]
        eccentricities = " | ".join(listed([eccentricity(result)], ".3f") for result in found)
        shares = ", ".join(f"{round(share)}" if math.isfinite(share) else "-" for share in created)
        lines.append(f"| {words} | {eccentricities} | {shares} |")
    return lines
