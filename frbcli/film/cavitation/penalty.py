"""The penalty model (3.31), (3.32): a source that grows exponentially where the pressure falls below p_cav."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import (
    Cell,
    CellState,
    FilmOil,
    Key,
    Law,
    Numbers,
    Scales,
    slopes_at_edge,
    source_at_edge,
)

PREFACTOR = 0.01  # a of (3.31)
# By which sources are divided in the unknown, 1/s: about what a cell passes on per unit of pressure, of those 48 around
# in a wide gap. Where the film carries, w is a pressure, where it cavitates a source: with both of one size, Newton's
# method crosses the front between them as if it were none (30, 100, 400: 4.2, 3.3, 3.4 iterations; 1: 6.9).
SPREAD = 100.0
LARGE, NOTHING = 1e16, -37.0  # arguments of omega: the largest, and that below which omega is nothing
SLOWEST = 1.0  # rad/s: the dimensionless pressure refers to a speed that must not vanish
STANDS, BY_ECCENTRICITY, BY_ECCENTRICITY_AND_SPEED = 0.0, 1.0, 2.0


@dataclass(frozen=True)
class Penalty(Law):
    """q = prefactor exp(-steepness (P - P_cav)), with P scaled in 1/s.

    prefactor: in 1/s; steepness: b of (3.32) over the ambient pressure (absolute reading) or over half the reference
    speed (dimensionless reading), both in s. follows: whether the steepness is given for the centred journal and
    follows the eccentricity, and whether both are given for 1 rad/s and follow the speed. """

    prefactor: float
    steepness: float
    follows: float = STANDS

    name = "penalty"
    label = "penalty"
    equation = "(3.31), (3.32)"
    meaning = "Penalty model (3.31): on the absolute pressure of (3.9), or on the dimensionless one of (3.19)."
    cell_words = "a source that grows exponentially below `p_cav`, in two readings"
    keys = (
        Key("pressure", "absolute", "of (3.9), or of (3.19)",
            choices=("absolute", "dimensionless")),
    )  # fmt: skip
    conserves = False
    keeps_oil = False
    tabulated = True
    edges = True
    cost = 1.2

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        exponent = steepness_exponent(0.0)
        if given.pressure == "absolute":
            return cls(PREFACTOR, exponent * oil.scale / oil.ambient, BY_ECCENTRICITY)
        return cls(0.5 * PREFACTOR, 2.0 * exponent, BY_ECCENTRICITY_AND_SPEED)

    @property
    def by_speed(self) -> bool:
        """Whether its pressure follows the speed of rotation."""
        return self.follows == BY_ECCENTRICITY_AND_SPEED

    @staticmethod
    def follow(parameters: Numbers, eccentricity: float, speed: float, whirl: float) -> Numbers:
        """(3.32), and the two readings of the pressure."""
        prefactor, steepness, follows = parameters
        if follows != STANDS:
            steepness *= 10.0 ** (-2.0 * eccentricity)
        if follows == BY_ECCENTRICITY_AND_SPEED:
            rate = max(abs(speed), SLOWEST)
            prefactor, steepness = prefactor * rate, steepness / rate
        return prefactor, steepness, STANDS

    def edged(self, state: CellState, w: Array, scales: Scales, rate: Array, through: Array) -> CellState:
        """See Law.edged: a cell next to the edge has this source where the law itself gives less, but not where the
        pressure falls to the cavity pressure over several cells."""
        above, weight = self._above_cavity(state.pressure, scales, rate)
        source = source_at_edge(above, rate, through)
        more = (source > state.source) & (state.pressure_slope > 0.0)  # not in openings
        # The pressure is s^2 rate / (2 through), the source rate (1 - s)^2 / 2, by the pressure -through (1 - s) / s.
        left = np.sqrt(np.divide(2.0 * source, rate, out=np.zeros_like(source), where=more))
        steep = -through * weight * np.divide(left, 1.0 - left, out=np.zeros_like(left), where=left < 1.0)
        return replace(
            state,
            source=np.where(more, source, state.source),
            source_slope=np.where(more, steep * state.pressure_slope, state.source_slope),
        )

    def edge_slopes(self, pressure: Array, scales: Scales, rate: Array, through: Array) -> tuple[Array, Array]:
        """See Law.edge_slopes: the law's own source does not follow the gap, the cavity's pressure does."""
        exponent = -self.steepness * (pressure - scales.cavitation)
        own = self.prefactor * np.exp(np.clip(exponent, NOTHING, -NOTHING))
        above, weight = self._above_cavity(pressure, scales, rate)
        least = self.prefactor * math.exp(NOTHING)
        sinks = np.where(rate > least, 1.0 / (self.steepness * np.maximum(rate, least)), 0.0)
        more = source_at_edge(above, rate, through) > own
        by_rate, by_through = slopes_at_edge(above, weight * sinks, rate, through)
        return np.where(more, by_rate, 0.0), np.where(more, by_through, 0.0)

    def _above_cavity(self, pressure: Array, scales: Scales, rate: Array) -> tuple[Array, Array]:
        """Pressure from which s at the edge follows, and its derivative by the pressure. In a cavity the source makes
        up for the gap that opens. Next to it p'' = a (1 - e^(-b y)) at y above the pressure there, so that the slope
        equals the slope of a parabola of the height y - (1 - e^(-b y)) / b."""
        cavity = -np.log(np.maximum(rate / self.prefactor, math.exp(NOTHING))) / self.steepness
        y = np.maximum(pressure - scales.cavitation - cavity, 0.0)
        weight = -np.expm1(-self.steepness * y)
        return np.maximum(y - weight / self.steepness, 0.0), weight

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """x = P - P_cav solves x - q(x) / SPREAD = w reference, in closed form by Wright's omega function of steepness
        q / SPREAD. Without a branch, so that cells are computed side by side. Where the source is large, target + q
        would be a small difference of large numbers."""
        a, b = parameters[0], parameters[1]
        per_b = 1.0 / b
        target = w * scales.reference
        offset = math.log(a * b / SPREAD)
        omega, logarithm = wright_omega(offset - b * target)
        above = (offset - logarithm) * per_b if omega > 1.0 else target + omega * per_b
        slope = scales.reference / (1.0 + omega)
        return scales.cavitation + above, 1.0, SPREAD * per_b * omega, slope, 0.0, -SPREAD * omega * slope


def steepness_exponent(eccentricity: float) -> float:
    """b of (3.32)."""
    return float(10.0 ** (4.0 - 2.0 * eccentricity))


def wright_omega(x: float) -> tuple[float, float]:
    """The real solution of omega + ln omega = x, and ln omega, to 1e-12 of either up to x = 1e12: two steps of Halley's
    method for ln omega. Without a branch and without a function of libraries but the root, so that a loop over it can
    run on the vector units."""
    at = min(max(x, NOTHING), LARGE)
    root = math.sqrt(math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(at, 1.0))))))
    # To begin with: x / (1 + x) ln x, that by Pade's approximation of 32 ln(root); a parabola; x. Off by 0.08 at most.
    far = 96.0 * (root * root - 1.0) * at / ((root * root + 4.0 * root + 1.0) * (1.0 + at))
    low = min(max(at, -4.0), 1.0)
    near = -0.5783 + low * (0.661 - 0.0523 * low)
    logarithm = far if at > 1.0 else (near if at > -4.0 else at)
    # Its exponential: the series of a 128th of it, squared seven times.
    y = logarithm * (1 / 128)
    z = y * y
    even = 1.0 + z * (1 / 2 + z * (1 / 24 + z * (1 / 720 + z * (1 / 40320 + z * (1 / 3628800)))))
    odd = y * (1.0 + z * (1 / 6 + z * (1 / 120 + z * (1 / 5040 + z * (1 / 362880 + z * (1 / 39916800))))))
    omega = even + odd
    for _ in range(7):
        omega *= omega
    left, slope = at - logarithm - omega, 1.0 + omega
    step = 2.0 * left * slope / (2.0 * slope * slope + left * omega)
    logarithm += step
    series = 1 / 24 + step * (1 / 120 + step * (1 / 720 + step * (1 / 5040)))
    omega *= 1.0 + step * (1.0 + step * (1 / 2 + step * (1 / 6 + step * series)))
    left, slope = at - logarithm - omega, 1.0 + omega
    step = 2.0 * left * slope / (2.0 * slope * slope + left * omega)
    logarithm += step
    omega *= 1.0 + step * (1.0 + 0.5 * step)  # below x = 1 the step is less than 1e-6
    omega = at - logarithm if at > 1.0 else omega
    return (omega if x > NOTHING else 0.0), logarithm
