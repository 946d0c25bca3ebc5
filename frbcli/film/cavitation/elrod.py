"""Jakobsson, Floberg and Olsson's condition in Elrod's manner (3.34) to (3.37): full, or at p_cav and partly empty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import FRONTS, Array, CellState, Scales


@dataclass(frozen=True)
class Elrod:
    """bulk_modulus: beta of the full film over 12 eta / psi^2, in 1/s; infinite for an incompressible oil."""

    bulk_modulus: float = np.inf
    conserves = True
    order = FRONTS
    clips = False

    def cells(self, w: Array, scales: Scales) -> CellState:
        full = w > 0.0
        above = np.where(full, w, 0.0) * scales.reference
        packed = above / self.bulk_modulus  # ln(theta), (3.35); beyond 1 the law goes on linearly, for Newton's method
        fraction = np.exp(np.minimum(packed, 1.0)) * np.maximum(packed, 1.0) + np.where(full, 0.0, w)
        steep = np.exp(np.minimum(packed, 1.0)) * scales.reference / self.bulk_modulus
        zero = np.zeros_like(w)
        return CellState(
            pressure=scales.cavitation + above,
            fraction=fraction,
            source=zero,
            pressure_slope=np.where(full, scales.reference, 0.0),
            fraction_slope=np.where(full, steep, 1.0),
            source_slope=zero,
        )
