"""Hertz's contact of two elastic bodies with four principal curvatures: approach, ellipse and largest pressure.

Harris, Rolling Bearing Analysis, chapter 6: with the ellipticity kappa = a / b, complete elliptic integrals K and E of
the parameter m = 1 - 1 / kappa^2, the sum S of the curvatures and 1 / E* = sum of (1 - nu^2) / E,

    F = ((kappa^2 + 1) E - 2 K) / ((kappa^2 - 1) E)          the difference of the curvatures over S
    a = (2 kappa^2 E / pi)^(1/3) L,  b = a / kappa,  L = (3 Q / (2 S E*))^(1/3)
    delta = (2 K / pi) (pi / (2 kappa^2 E))^(1/3) S L^2 / 2
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from frbcli.materials.solids import Elastic

NEARLY_ROUND = 1e-4  # difference of the curvatures below which F is 3/4 ln kappa but for its third power


@dataclass(frozen=True)
class HertzContact:
    """A contact without its load. curvature: sum S of the principal curvatures, 1/m; modulus: E* in Pa; ellipticity:
    long over short axis; first, second: the complete elliptic integrals K and E."""

    curvature: float
    modulus: float
    ellipticity: float
    first: float
    second: float

    @property
    def stiffness(self) -> float:
        """K in N/m^1.5 of the load Q = K delta^1.5."""
        kappa, s = self.ellipticity, self.curvature
        approach = 2.0 * self.first / math.pi * (math.pi / (2.0 * kappa**2 * self.second)) ** (1.0 / 3.0)
        return float(2.0 * self.modulus * s / 3.0 * (2.0 / (s * approach)) ** 1.5)

    def axes(self, load: float) -> tuple[float, float]:
        """Long and short half axis in m of the ellipse under a load in N."""
        size = (1.5 * load / (self.curvature * self.modulus)) ** (1.0 / 3.0)
        long = (2.0 * self.ellipticity**2 * self.second / math.pi) ** (1.0 / 3.0) * size
        return long, long / self.ellipticity

    def pressure(self, load: float) -> float:
        """Largest pressure in Pa under a load in N."""
        if load <= 0.0:
            return 0.0
        long, short = self.axes(load)
        return 1.5 * load / (math.pi * long * short)


def contact(one: Elastic, other: Elastic, rolling: float, across: float) -> HertzContact:
    """The contact of two bodies; rolling, across: sums of both bodies' curvatures in 1/m along two directions at right
    angles, concave ones negative. Raises ValueError if a body does not touch the other in a point."""
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    low, high = sorted((rolling, across))
    if low <= 0.0:
        raise ValueError(f"curvatures of {low:.4g} 1/m along a contact: the bodies are not apart next to it")
    total, difference = rolling + across, (high - low) / (rolling + across)

    def integrals(kappa: float) -> tuple[float, float]:
        return float(ellipkm1(1.0 / kappa**2)), float(ellipe(1.0 - 1.0 / kappa**2))

    def missed(log_kappa: float) -> float:
        kappa = math.exp(log_kappa)
        first, second = integrals(kappa)
        return float(((kappa**2 + 1.0) * second - 2.0 * first) / ((kappa**2 - 1.0) * second) - difference)

    log_kappa = 4.0 / 3.0 * difference
    if difference > NEARLY_ROUND:  # kappa is below the ratio of the curvatures
        log_kappa = float(brentq(missed, 0.5 * difference, math.log(high / low), xtol=1e-15))
    kappa = math.exp(log_kappa)
    modulus = 1.0 / (one.compliance + other.compliance)
    return HertzContact(total, modulus, kappa, *integrals(kappa))
