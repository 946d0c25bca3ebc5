"""The Reynolds or Swift-Stieber condition (3.30): the pressure ends at p_cav with no slope. Oil appears in the cavity.

As a complementarity: either the pressure is above p_cav, or a source keeps it there. w < 0 is the source.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import Array, Cell, CellState, Law, Numbers, Scales


@dataclass(frozen=True)
class Reynolds(Law):
    """No parameters."""

    name = "reynolds"
    label = "Reynolds"
    equation = "(3.30)"
    cell_words = "the pressure is above `p_cav`, or a source keeps it there"
    conserves = False
    keeps_oil = False
    holds_cavity = True
    cost = 1.0

    def cells(self, w: Array, scales: Scales) -> CellState:
        """w = (p - p_cav) / reference in a full cell; minus the source over the reference in others."""
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

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        if w > 0.0:
            return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0
        return scales.cavitation, 1.0, -w * scales.reference, 0.0, 0.0, -scales.reference
