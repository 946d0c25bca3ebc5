"""The Reynolds or Swift-Stieber condition (3.30): the pressure ends at p_cav with no slope. Oil appears in the cavity.

As a complementarity: either the pressure is above p_cav, or a source keeps it there. w < 0 is the source.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import FRONTS, Array, CellState, Scales


@dataclass(frozen=True)
class Reynolds:
    """No parameters."""

    conserves = False
    order = FRONTS
    clips = False

    def cells(self, w: Array, scales: Scales) -> CellState:
        full = w > 0.0
        zero = np.zeros_like(w)
        return CellState(
            pressure=scales.cavitation + np.where(full, w, 0.0) * scales.reference,
            fraction=np.ones_like(w),
            source=np.where(full, 0.0, -w) * scales.reference,
            pressure_slope=np.where(full, scales.reference, 0.0),
            fraction_slope=zero,
            source_slope=np.where(full, 0.0, -scales.reference),
        )
