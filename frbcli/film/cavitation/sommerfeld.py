"""Sommerfeld's condition: no cavitation at all. Half-Sommerfeld (3.29) clips its result when the loads are taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import FRONTS, Array, CellState, Scales


@dataclass(frozen=True)
class Sommerfeld:
    """clips: half-Sommerfeld, the loads take no pressure below p_cav."""

    clips: bool = False
    conserves = True
    order = FRONTS

    def cells(self, w: Array, scales: Scales) -> CellState:
        zero, one = np.zeros_like(w), np.ones_like(w)
        return CellState(scales.cavitation + w * scales.reference, one, zero, one * scales.reference, zero, zero)
