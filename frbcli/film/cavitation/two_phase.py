"""The smoothed two-phase model (4.32) to (4.35): a cubic step of theta(p) between x_0 p_cav and p_cav."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.film.cavitation.law import Array, CellState, Scales

# The slope theta'_0 outside of the step: as published 1e-3, a bulk modulus of 1000 p_cav. With w as the unknown none is needed.
PUBLISHED_SLOPE = 1e-3
SMALLEST_SLOPE = 1e-9
SWEEPS = 80


@dataclass(frozen=True)
class TwoPhase:
    """steepness: x_1 of (4.35), the place of the steepest slope over p_cav; outer_slope: theta'_0."""

    steepness: float
    outer_slope: float = SMALLEST_SLOPE
    conserves = True

    def cells(self, w: Array, scales: Scales) -> CellState:
        """w = theta(p) - 1 + (p - p_cav) / reference, solved for p in each cell by bracketed Newton steps."""
        cavity = scales.cavitation + scales.ambient
        ratio = cavity / scales.reference
        x_0 = 2.0 * self.steepness - 1.0
        # y = p / p_cav. Beyond the step all is linear.
        low = np.where(w < self._w(np.array(x_0), ratio), np.minimum(x_0, x_0 + (w + 1.0) / ratio - 1.0 / ratio), x_0)
        y = np.where(w > 0.0, 1.0 + w / (ratio + self.outer_slope), low)
        inside = (w <= 0.0) & (w >= self._w(np.array(x_0), ratio))
        below = w < self._w(np.array(x_0), ratio)
        y = np.where(below, x_0 + (w - self._w(np.array(x_0), ratio)) / (ratio + self.outer_slope), y)
        if np.any(inside):
            y = y.copy()
            y[inside] = self._step_inverse(w[inside], ratio)
        fraction, slope = self.fraction(y)
        y_slope = 1.0 / (slope + ratio)
        zero = np.zeros_like(w)
        return CellState(
            pressure=y * cavity - scales.ambient,
            fraction=fraction,
            source=zero,
            pressure_slope=cavity * y_slope,
            fraction_slope=slope * y_slope,
            source_slope=zero,
        )

    def fraction(self, y: Array) -> tuple[Array, Array]:
        """theta and its slope at y = p / p_cav, (4.32) and (4.33)."""
        x_0, s = 2.0 * self.steepness - 1.0, self.outer_slope
        scaled = np.clip((y - x_0) / (1.0 - x_0), 0.0, 1.0)
        m = s * (1.0 - x_0) / (1.0 - x_0 * s)
        height = 1.0 - s * x_0
        theta = height * ((1.0 - m) * scaled**2 * (3.0 - 2.0 * scaled) + m * scaled) + s * x_0
        slope = height / (1.0 - x_0) * ((1.0 - m) * 6.0 * scaled * (1.0 - scaled) + m)
        theta = np.where(y > 1.0, 1.0 + s * (y - 1.0), np.where(y < x_0, s * y, theta))
        return theta, np.where((y > 1.0) | (y < x_0), s, slope)

    def _w(self, y: Array, ratio: float) -> Array:
        return self.fraction(y)[0] - 1.0 + (y - 1.0) * ratio

    def _step_inverse(self, w: Array, ratio: float) -> Array:
        """y in [x_0, 1] with _w(y) = w; _w increases there."""
        low = np.full_like(w, 2.0 * self.steepness - 1.0)
        high = np.ones_like(w)
        y = 0.5 * (low + high)
        for _ in range(SWEEPS):
            theta, slope = self.fraction(y)
            defect = theta - 1.0 + (y - 1.0) * ratio - w
            low, high = np.where(defect <= 0.0, y, low), np.where(defect >= 0.0, y, high)
            newton = y - defect / (slope + ratio)
            following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
            if np.max(np.abs(following - y)) < 1e-15:
                break
            y = following
        return y
