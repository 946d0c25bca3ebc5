"""The penalty model (3.31), (3.32): a source that grows exponentially where the pressure falls below p_cav."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.film.cavitation.law import Array, Cell, CellState, FilmOil, Key, Law, Numbers, Scales

PREFACTOR = 0.01  # a of (3.31)
SLOWEST = 1.0  # rad/s: the dimensionless pressure refers to a speed that must not vanish
STANDS, BY_ECCENTRICITY, BY_ECCENTRICITY_AND_SPEED = 0.0, 1.0, 2.0


@dataclass(frozen=True)
class Penalty(Law):
    """q = prefactor exp(-steepness (P - P_cav)), with P scaled in 1/s.

    prefactor: in 1/s; steepness: b of (3.32) over the ambient pressure (absolute reading) or over half the reference
    speed (dimensionless reading), both in s. follows: whether the steepness is that of the centred journal and follows
    the eccentricity, and whether both are those of 1 rad/s and follow the speed.
    """

    prefactor: float
    steepness: float
    follows: float = STANDS

    name = "penalty"
    label = "penalty"
    equation = "(3.31), (3.32)"
    meaning = "Penalty model (3.31): on the absolute pressure of (3.9), or on the dimensionless one of (3.19)."
    cell_words = "a source that grows exponentially below `p_cav`, in two readings"
    keys = (
        Key("pressure", "absolute", "that of (3.9), or the dimensionless one of (3.19)",
            choices=("absolute", "dimensionless")),
    )  # fmt: skip
    conserves = False
    keeps_oil = False
    tabulated = True

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

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        a, b = parameters[0], parameters[1]
        target = w * scales.reference
        omega = wright_omega(math.log(a * b) - b * target)
        above = -math.log(omega / (a * b)) / b if omega > 1.0 else target + omega / b
        slope = scales.reference / (1.0 + omega)
        return scales.cavitation + above, 1.0, omega / b, slope, 0.0, -omega * slope


def steepness_exponent(eccentricity: float) -> float:
    """b of (3.32)."""
    return float(10.0 ** (4.0 - 2.0 * eccentricity))


def wright_omega(x: float) -> float:
    """The real solution of omega + ln omega = x, by two steps of Fritsch, Shafer and Crowley's iteration."""
    if x < -36.0:
        return math.exp(x)
    if x < 1.0:
        e = math.exp(x)
        omega = e / (1.0 + e) if x < -1.0 else 0.5671432904097838 + 0.36 * x + 0.07 * x * x
    else:
        omega = x - math.log(x) * (1.0 - 1.0 / (1.0 + x))
    for _ in range(2):
        r = x - omega - math.log(omega)
        q = (1.0 + omega) * (1.0 + omega + 2.0 * r / 3.0)
        omega *= 1.0 + r / (1.0 + omega) * (q - 0.5 * r) / (q - r)
    return omega
