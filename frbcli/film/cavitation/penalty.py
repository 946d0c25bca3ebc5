"""The penalty model (3.31), (3.32): a source that grows exponentially where the pressure falls below p_cav = p_0.

The unknown is w = P / reference - q / reference: the inverse is found per cell, so that neither the flat nor the steep part of
the exponential disturbs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import Array, CellState, Scales

PREFACTOR = 0.01  # a of (3.31)
SWEEPS = 60


@dataclass(frozen=True)
class Penalty:
    """q = prefactor exp(-steepness (P - P_cav)), with P scaled in 1/s.

    prefactor: in 1/s; steepness: b of (3.32) over the ambient pressure (absolute reading) or over half the reference
    speed (dimensionless reading), both in s.
    """

    prefactor: float
    steepness: float
    conserves = False

    def cells(self, w: Array, scales: Scales) -> CellState:
        # x = P - P_cav solves x - q(x) = w reference; increasing and concave: Newton from the left does not overshoot.
        target = w * scales.reference
        x = np.where(target > 0.0, target, -np.log(np.maximum(-target, self.prefactor) / self.prefactor) / self.steepness)
        x = np.minimum(x, np.maximum(target, 0.0))
        for _ in range(SWEEPS):
            q = self.prefactor * np.exp(-self.steepness * x)
            step = (x - q - target) / (1.0 + self.steepness * q)
            x = x - step
            if np.max(np.abs(step)) <= 1e-14 * scales.reference:
                break
        q = self.prefactor * np.exp(-self.steepness * x)
        slope = scales.reference / (1.0 + self.steepness * q)
        zero = np.zeros_like(w)
        return CellState(
            pressure=scales.cavitation + x,
            fraction=np.ones_like(w),
            source=q,
            pressure_slope=slope,
            fraction_slope=zero,
            source_slope=-self.steepness * q * slope,
        )


def steepness_exponent(eccentricity: float) -> float:
    """b of (3.32)."""
    return float(10.0 ** (4.0 - 2.0 * eccentricity))
