"""Peeken's two-phase model (3.38), (3.39): dissolved air comes out of the oil below p_cav, isothermally."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import Array, CellState, Scales


@dataclass(frozen=True)
class Peeken:
    """bunsen: alpha_B, the volume of dissolved air per volume of oil."""

    bunsen: float
    conserves = True

    def cells(self, w: Array, scales: Scales) -> CellState:
        """theta = 1 / (1 + r), r = alpha (p_cav - p) / p: with y = p / p_cav, theta = y / (y + alpha (1 - y)) below p_cav.

        w = theta - 1 + (p - p_cav) / reference is a quadratic in y.
        """
        cavity = scales.cavitation + scales.ambient  # absolute
        ratio, a = cavity / scales.reference, self.bunsen
        # (w + 1 + ratio (1 - y)) (a + (1 - a) y) = y
        square = ratio * (1.0 - a)
        linear = 1.0 + ratio * a - (w + 1.0 + ratio) * (1.0 - a)
        constant = -(w + 1.0 + ratio) * a
        root = np.sqrt(np.maximum(linear**2 - 4.0 * square * constant, 0.0))
        y = np.where(linear > 0.0, -2.0 * constant / (linear + root), (root - linear) / (2.0 * square))
        full = w > 0.0
        y = np.where(full, 1.0, y)
        below = y + a * (1.0 - y)
        steep = np.where(full, 0.0, a / below**2)  # dtheta/dy
        y_slope = np.where(full, 1.0 / ratio, 1.0 / (steep + ratio))
        zero = np.zeros_like(w)
        return CellState(
            pressure=np.where(full, scales.cavitation + w * scales.reference, y * cavity - scales.ambient),
            fraction=y / below,
            source=zero,
            pressure_slope=cavity * y_slope,
            fraction_slope=steep * y_slope,
            source_slope=zero,
        )
