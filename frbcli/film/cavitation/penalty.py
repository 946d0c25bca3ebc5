"""The penalty model (3.31), (3.32): a source that grows exponentially where the pressure falls below p_cav."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import FRONTS, Array, CellState, Scales

PREFACTOR = 0.01  # a of (3.31)


@dataclass(frozen=True)
class Penalty:
    """q = prefactor exp(-steepness (P - P_cav)), with P scaled in 1/s.

    prefactor: in 1/s; steepness: b of (3.32) over the ambient pressure (absolute reading) or over half the reference
    speed (dimensionless reading), both in s.
    """

    prefactor: float
    steepness: float
    conserves = False
    order = FRONTS
    clips = False

    def cells(self, w: Array, scales: Scales) -> CellState:
        """x = P - P_cav solves x - q(x) = w reference, in closed form by Wright's omega function of steepness q."""
        from scipy.special import wrightomega

        b = self.steepness
        target = w * scales.reference
        omega = wrightomega(np.log(self.prefactor * b) - b * target)
        # Where the source is large, target + q would be a small difference of large numbers.
        logarithm = -np.log(np.maximum(omega, 1.0) / (self.prefactor * b)) / b
        above = np.where(omega > 1.0, logarithm, target + omega / b)
        return CellState(
            pressure=scales.cavitation + above,
            fraction=np.ones_like(w),
            source=omega / b,
            pressure_slope=scales.reference / (1.0 + omega),
            fraction_slope=np.zeros_like(w),
            source_slope=-scales.reference * omega / (1.0 + omega),
        )


def steepness_exponent(eccentricity: float) -> float:
    """b of (3.32)."""
    return float(10.0 ** (4.0 - 2.0 * eccentricity))
