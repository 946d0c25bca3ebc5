"""The Reynolds or Swift-Stieber condition (3.30): the pressure ends at p_cav with no slope. Oil appears in the cavity.

As a complementarity: either the pressure is above p_cav, or a source keeps it there. w < 0 is the source.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, CellState, Law, Numbers, Scales, source_at_edge


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
    edges = True
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

    def edged(self, state: CellState, w: Array, scales: Scales, rate: Array, through: Array) -> CellState:
        """See Law.edged. s is linear in w, so that pressure and source have no kink: w reference = 2 s A / (2 through),
        which is the pressure and once more that at s = 1 where s > 1."""
        opens, value = np.maximum(rate, 0.0), w * scales.reference
        most = np.broadcast_to(0.5 * opens / through, w.shape)
        place = np.divide(value, 2.0 * most, out=np.where(value > 0.0, 1.0, 0.0), where=most > 0.0)
        near = np.clip(place, 0.0, 1.0)
        return CellState(
            pressure=scales.cavitation + np.where(place < 1.0, most * near**2, value - most),
            fraction=state.fraction,
            source=0.5 * opens * (1.0 - near) ** 2 - through * np.minimum(value, 0.0),
            pressure_slope=scales.reference * near,
            fraction_slope=state.fraction_slope,
            source_slope=-scales.reference * through * (1.0 - near),
        )

    def edge_source(self, pressure: Array, scales: Scales, rate: Array, through: Array) -> Array:
        """See Law.edge_source."""
        return source_at_edge(pressure - scales.cavitation, rate, through)

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        if w > 0.0:
            return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0
        return scales.cavitation, 1.0, -w * scales.reference, 0.0, 0.0, -scales.reference
