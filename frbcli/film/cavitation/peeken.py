"""Peeken's two-phase model (3.38), (3.39): dissolved air comes out of the oil below p_cav, isothermally."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, CellState, FilmOil, Key, Law, Numbers, Scales


@dataclass(frozen=True)
class Peeken(Law):
    """bunsen: alpha_B, the volume of dissolved air per volume of oil, in (0, 1]."""

    bunsen: float

    name = "peeken"
    label = "Peeken"
    equation = "(3.39)"
    meaning = "Peeken's model."
    cell_words = "dissolved air comes out of the oil"
    keys = (Key("bunsen", 0.1, "Bunsen's coefficient, share of dissolved gas", "0.1", least=0.0),)
    cost = 1.0
    compared = (("bunsen", (0.1, 0.5, 1.0)),)  # air in oil has about 0.1

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        return cls(given.bunsen)

    @classmethod
    def legend(cls, given: Any) -> str:
        return f"Peeken, $\\alpha_B$ = {given.bunsen:g}"

    def cells(self, w: Array, scales: Scales) -> CellState:
        """theta = 1 / (1 + r), r = alpha (p_cav - p) / p: (1 - u) / (1 - u + alpha u) of the fall u = 1 - p / p_cav.

        w = theta - 1 - u ratio is a quadratic in u. Newton's method may ask below p = 0, where it goes on linearly.
        """
        cavity = scales.cavitation + scales.ambient  # absolute
        ratio, a = cavity / scales.reference, self.bunsen
        partial = np.clip(w, -1.0 - ratio, 0.0)
        linear = a + ratio - partial * (1.0 - a)
        root = np.sqrt(np.maximum(linear**2 + 4.0 * ratio * (1.0 - a) * partial, 0.0))
        fall = -2.0 * partial / (linear + root)
        full = w > 0.0
        steep = np.where(full, 0.0, a / (1.0 - fall * (1.0 - a)) ** 2)  # dtheta / d(p / p_cav)
        rise_slope = 1.0 / (steep + ratio)
        fall = fall - np.minimum(w - partial, 0.0) * rise_slope
        zero = np.zeros_like(w)
        return CellState(
            pressure=scales.cavitation + np.where(full, w * scales.reference, -fall * cavity),
            fraction=np.where(full, 1.0, 1.0 + w + fall * ratio),
            source=zero,
            pressure_slope=cavity * rise_slope,
            fraction_slope=steep * rise_slope,
            source_slope=zero,
        )

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        if w > 0.0:
            return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0
        a = parameters[0]
        cavity = scales.cavitation + scales.ambient
        ratio = cavity / scales.reference
        partial = max(w, -1.0 - ratio)
        linear = a + ratio - partial * (1.0 - a)
        root = math.sqrt(max(linear * linear + 4.0 * ratio * (1.0 - a) * partial, 0.0))
        fall = -2.0 * partial / (linear + root)
        steep = a / (1.0 - fall * (1.0 - a)) ** 2
        fall -= (w - partial) / (steep + ratio)
        rise = 1.0 / (steep + ratio)
        return scales.cavitation - fall * cavity, 1.0 + w + fall * ratio, 0.0, cavity * rise, steep * rise, 0.0

    def curve(self, ratio: Array) -> Array:
        """theta (3.38), (3.39) of oil whose dissolved air comes out below p_cav; the ratio is above 0."""
        below = np.minimum(ratio, 1.0)
        return np.asarray(below / (below + self.bunsen * (1.0 - below)), dtype=np.float64)
