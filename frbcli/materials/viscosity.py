"""Viscosity over temperature: Vogel's law (3.12), from coefficients, from three or from two measured values."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

ZERO_CELSIUS = 273.15
LARGEST_EXPONENT = 700.0  # of the exponential of a float


@dataclass(frozen=True)
class VogelLaw:
    """eta(T) = eta_0 exp(A / (T + C)) in Pa s (3.12), T in K; eta_0 in Pa s, A and C in K."""

    eta_0: float
    a: float
    c: float

    def at(self, temperature: float) -> float:
        """The dynamic viscosity in Pa s at a temperature in K; infinite below the pole of the law."""
        if temperature + self.c <= 0.0:
            return math.inf
        exponent = self.a / (temperature + self.c)
        return self.eta_0 * math.exp(exponent) if exponent < LARGEST_EXPONENT else math.inf

    def times(self, factor: float) -> VogelLaw:
        """The law of an oil that shear makes thinner by a factor."""
        return replace(self, eta_0=factor * self.eta_0)


def through_three(temperatures: Sequence[float], viscosities: Sequence[float]) -> VogelLaw:
    """The law through three viscosities in Pa s at ascending temperatures in K.

    Of y = ln eta the differences give C: (y1 - y2)/(y2 - y3) (T3 - T2)/(T2 - T1) = (T3 + C)/(T1 + C).
    """
    (t1, t2, t3), (y1, y2, y3) = temperatures, (math.log(value) for value in viscosities)
    ratio = (y1 - y2) / (y2 - y3) * (t3 - t2) / (t2 - t1)
    c = (t3 - ratio * t1) / (ratio - 1.0)
    a = (y1 - y2) * (t1 + c) * (t2 + c) / (t2 - t1)
    return VogelLaw(math.exp(y1 - a / (t1 + c)), a, c)


def walther(temperature: float, first: tuple[float, float], second: tuple[float, float]) -> float:
    """Kinematic viscosity in mm^2/s at a temperature in K by the line of ASTM D341 through two (K, mm^2/s):
    log log(nu + 0.7) is linear in log T."""
    (t1, w1), (t2, w2) = ((math.log(t), math.log(math.log10(nu + 0.7))) for t, nu in (first, second))
    w = w1 + (w2 - w1) * (math.log(temperature) - t1) / (t2 - t1)
    return float(10.0 ** math.exp(w) - 0.7)
