"""Cases whose limit cycles cannot be computed, refused before any computation."""

from __future__ import annotations

import math

from frbcli.case.schema import Case
from frbcli.scene.gate.analysis import CYCLES, SPEED_CYCLES, WHIRLS
from frbcli.scene.gate.gate import require
from frbcli.scene.speeds import default_speeds


def check(case: Case, shooting: bool = False, with_unbalance: bool = False) -> tuple[float, float]:
    """The range of speeds of a case in rad/s, the slowest above zero. shooting: whether cycles may be found by shooting
    on the time loop; with_unbalance: whether the whirls with it are asked for as well. Raises InputError."""
    require(case, WHIRLS if with_unbalance else SPEED_CYCLES if shooting else CYCLES)
    speeds = default_speeds(case)
    return 2.0 * math.pi * speeds[0], 2.0 * math.pi * speeds[-1]
