"""What asperities.py computes, in the form of the equations: for readers, and for the tests that hold it to them."""

from __future__ import annotations

import math

from scipy.integrate import quad

from frbcli.film.roughness.asperities import LAST, Asperities, reach, summit_integral


def plain_pressure(asperities: Asperities, gap: float) -> float:
    """Pressure in Pa of the summits over a gap in m."""
    x = (gap - asperities.mean_height) / asperities.roughness
    if x >= LAST:
        return 0.0
    elastic = asperities.elastic * summit_integral(2.5, x)
    return min(elastic, asperities.plastic * summit_integral(2.0, x)) if math.isfinite(asperities.plastic) else elastic


def plain_touch(asperities: Asperities, f: int, clearance: float, eccentricity: float) -> tuple[float, float]:
    """Integrals in N of the pressure over a bearing, and of its part along the line of centres."""
    area = 2.0 * asperities.radii[f] * asperities.widths[f]
    arc = math.acos(max(-1.0, min(1.0, (clearance - reach(asperities)) / eccentricity)))

    def along(power: int) -> float:
        def density(theta: float) -> float:
            return plain_pressure(asperities, clearance - eccentricity * math.cos(theta)) * math.cos(theta) ** power

        return float(area * quad(density, 0.0, arc, epsabs=0.0, epsrel=1e-9, limit=200)[0])

    return along(0), along(1)
