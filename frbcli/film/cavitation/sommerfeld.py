"""Sommerfeld's condition, no cavitation at all, and half-Sommerfeld (3.29), which clips its result."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, CellState, Law, Numbers, Scales


@dataclass(frozen=True)
class Sommerfeld(Law):
    """No parameters."""

    name = "sommerfeld"
    label = "Sommerfeld"
    cell_words = "no cavitation: pressures below `p_cav` pull"
    keeps_oil = False
    cavitates = False
    closed = True
    cost = 1.0

    def cells(self, w: Array, scales: Scales) -> CellState:
        """w = (p - p_cav) / reference."""
        zero, one = np.zeros_like(w), np.ones_like(w)
        return CellState(scales.cavitation + w * scales.reference, one, zero, one * scales.reference, zero, zero)

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0


@dataclass(frozen=True)
class HalfSommerfeld(Sommerfeld):
    """Reynolds' equation without cavitation; the loads take no pressure below p_cav (3.29)."""

    name = "half-sommerfeld"
    label = "half-Sommerfeld"
    equation = "(3.29)"
    cell_words = "as `sommerfeld`; the loads are computed with `p_cav` where the pressure is below it"
    cavitates = True
    clips = True
