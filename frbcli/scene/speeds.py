"""The speeds at which machines at rest are computed where none are asked for."""

from __future__ import annotations

import numpy as np

from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.scene.planning.film_choice import form_of

SPEEDS, SPEEDS_WITH_MEMORY = 60, 20  # 5 and 15 Hz apart from 0 to 300 Hz


def default_speeds(case: Case, count: int | None = None) -> tuple[float, ...]:
    """Speeds in Hz, greater than zero, that sweep the range of the case; fewer where a film keeps oil, whose memory
    takes longer to compute, or follows the tilt of its journal."""
    count = count or (SPEEDS_WITH_MEMORY if keeps_oil(case) or form_of(case).static_cells else SPEEDS)
    low, high = sorted((case.speed.start, case.speed.end))
    if low > 0.0:
        return tuple(np.unique(np.linspace(low, high, count)).tolist())
    return tuple(np.linspace(0.0, high, count + 1)[1:].tolist()) if high > 0.0 else ()


def keeps_oil(case: Case) -> bool:
    """Whether a film of the case is mass-conserving."""
    return form_of(case).solved and any(law_named(name).keeps_oil for name in case.cavitations)
