"""Peeken's two-phase model (3.38), (3.39): dissolved air comes out of the oil below p_cav, isothermally."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import Array, CellState, Scales


@dataclass(frozen=True)
class Peeken:
    """bunsen: alpha_B, the volume of dissolved air per volume of oil, in (0, 1]."""

    bunsen: float
    conserves = True
    order = 1.0  # oil and air mix everywhere in the cavity, and flow upwind
    clips = False

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
