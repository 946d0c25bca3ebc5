"""What a gap between rough surfaces lets flow and how it resists sliding, compiled; see flow_factors.py. Gaps h and
roughness over the clearance; a roughness of 0: smooth surfaces."""

from __future__ import annotations

import math

from frbcli.compiled import compiled
from frbcli.film.roughness.flow_factors import (
    CUT,
    DEPTH,
    FADES,
    FAR,
    LAST_STRESS,
    RATE,
    SERIES,
    SPREAD,
    STRESS_A,
    STRESS_B,
    STRESS_C,
    STRESS_D,
    TERMS,
    A,
    B,
    C,
    D,
)


@compiled()
def rough_flow(h: float, roughness: float) -> tuple[float, float]:
    """phi_x and its derivative by h."""
    fading = DEPTH * math.exp(-RATE * h / roughness)
    return 1.0 - fading, RATE / roughness * fading


@compiled(inline=True)
def flowing_cube(h: float, roughness: float) -> tuple[float, float]:
    """phi_x h^3 and its derivative by h."""
    cube, slope = h * h * h, 3.0 * h * h
    if roughness > 0.0:
        factor, grows = rough_flow(h, roughness)
        cube, slope = factor * cube, factor * slope + grows * cube
    return cube, slope


@compiled()
def sheared_gap(h: float, roughness: float, sliding: float) -> tuple[float, float]:
    """Phi_s sigma times a sliding speed, by which a rough surface carries more than its mean plane, and its derivative
    by h."""
    if sliding == 0.0:
        return 0.0, 0.0
    x = h / roughness
    if x > FAR:
        near = A * FAR**B * math.exp(-C * FAR + D * FAR * FAR)
        factor = sliding * near * math.exp(-FADES * (x - FAR))
        return roughness * factor, -FADES * factor
    factor = sliding * A * math.exp(B * math.log(x) - C * x + D * x * x)
    return roughness * factor, factor * (B / x - C + 2.0 * D * x)


@compiled()
def stress_factor(h: float, roughness: float) -> float:
    """phi_f + Phi_fs; 1 between smooth surfaces."""
    if roughness == 0.0:
        return 1.0
    x = h / roughness
    z = x / SPREAD
    if z > SERIES:
        factor, moment, power = 1.0, 1.0, 1.0
        for k in range(1, TERMS + 1):
            moment, power = moment * (2.0 * k - 1.0) / (2.0 * k + 7.0), power * z * z
            factor += moment / power
    else:
        low, high = z - 1.0 if z > 1.0 else CUT, z + 1.0
        a, b = 1.0 - z * z, 2.0 * z
        whole, p, q = a**3 * math.log(high / low), low, high
        square = b * b
        powers = (3.0 * a * a * b, 3.0 * a * (square - a), b * (square - 6.0 * a), 3.0 * (a - square), 3.0 * b, -1.0)
        for k in range(6):
            whole += powers[k] * (q - p) / (k + 1.0)
            p, q = p * low, q * high
        factor = 35.0 / 32.0 * z * whole
    if x < LAST_STRESS:
        factor += STRESS_A * math.exp(STRESS_B * math.log(x) - STRESS_C * x + STRESS_D * x * x)
    return factor
