"""Where a journal rests in the two forms of the two-phase model, and how much oil they create."""

from __future__ import annotations

import math

from validation.chapter6 import at_rest, eccentricity
from validation.chapter6_rows import AXIAL, BATH, CIRCUMFERENTIAL, PENALTY, PUBLISHED, TWO_BAR
from validation.measured import listed

SPEED_Hz = 30.0
SUPPLIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "circumferential groove, 1 bar, free to air": (CIRCUMFERENTIAL, ()),
    "circumferential groove, 1 bar, oil bath": (CIRCUMFERENTIAL, (BATH,)),
    "circumferential groove, 2 bar, free to air": (CIRCUMFERENTIAL, (TWO_BAR,)),
    "axial groove, 1 bar, free to air": (AXIAL, ()),
}
HEAD = """## Two forms of the two-phase model

The source uses the form (4.31), which does not conserve oil, with artificial diffusion on 10 x 20 quadratic elements.
`frb` has both: `form = "published"` reproduces it, `form = "conservative"` is the default. They differ where the
source supplies oil at ambient pressure through a circumferential groove: the film has no pressurised supply and
starves. There the published form creates the oil that leaves at the ends, and the resting position is that of the
penalty model; with the conservative form the eccentricity at rest is large and the onset of whirl early. Rows that
depend on this supply therefore say in which form they were measured.

Eccentricity at rest, 30 Hz, x_1 = 0.99; created: oil that leaves the film less what enters it, as a share of it.

| supply | penalty | published | conservative | created, published | created, conservative |
| --- | --- | --- | --- | --- | --- |"""


def table() -> list[str]:
    """The section on the two forms."""
    lines = [HEAD]
    for words, (case, settings) in SUPPLIES.items():
        found = [at_rest(case, SPEED_Hz, *settings, *model) for model in ((PENALTY,), (PUBLISHED,), ())]
        created = [
            math.nan if result.loads is None else -100.0 * result.loads.oil.defect_relative for result in found[1:]
        ]
        eccentricities = " | ".join(listed([eccentricity(result)], ".3f") for result in found)
        shares = " | ".join(f"{round(share)} %" if math.isfinite(share) else "-" for share in created)
        lines.append(f"| {words} | {eccentricities} | {shares} |")
    return lines
