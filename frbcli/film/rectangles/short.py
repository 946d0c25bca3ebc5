"""The extended short bearing of appendix B: no flow along phi, any pressure at the two edges of a section.

Gauge pressures over p_0, divided by 12 eta / psi^2. With A = -(b/R)^2 (w . n) / (2 H^3) the pressure (B.3) of a
section reads P = A z (1 - z) + sigma z on 0 <= z <= 1, with sigma the scaled supply pressure at z = 1.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from frbcli.compiled import compiled

ANGLES = 96  # points of the trapezoidal rule in Sommerfeld's angle where no closed form exists


class ShortFilm(NamedTuple):
    """A short film whose edges have the cavitation pressure. force_scale: N s, turns the integral of P over one section
    into the force of the whole bearing; slenderness: (b/R)^2; clipped: half-Sommerfeld (1) or Sommerfeld (0)."""

    force_scale: float
    slenderness: float
    clipped: int


class SuppliedShortFilm(NamedTuple):
    """A short half-Sommerfeld film with any pressures at its edges. sigma, level: scaled gauge pressures of supply and
    cavity, 1/s; the others as in ShortFilm."""

    force_scale: float
    slenderness: float
    sigma: float
    level: float


def sealed_shape(seals: tuple[float, float]) -> tuple[float, float]:
    """a, b of a section with seals: its pressure by a unit of A is z (1 - z) + a + (b - 1) z, by a unit supply pressure
    at z = 1 it is a + b z. The slope at a sealed end is the pressure there over the length of the seal."""
    near, far = seals
    return (near, 1.0) if far > 0.0 else (near / (1.0 + near), 1.0 / (1.0 + near))


def sealed_share(seals: tuple[float, float]) -> float:
    """Integral of the pressure by A over the same integral with open ends."""
    a, b = sealed_shape(seals)
    return 1.0 + 6.0 * a + 3.0 * (b - 1.0)


@compiled()
def clipped_section(a: float, sigma: float, level: float) -> tuple[float, float]:
    """Integral over 0 <= z <= 1 of max(a z (1 - z) + sigma z - level, 0), exactly, and its derivative by a.

    level <= 0 <= sigma: the edges themselves do not cavitate, the inside may where a is negative.
    """
    total, slope = a / 6.0 + 0.5 * sigma - level, 1.0 / 6.0
    discriminant = (a + sigma) ** 2 + 4.0 * a * -level
    if a < -sigma and discriminant > 0.0:
        root = math.sqrt(discriminant)
        # Between its two roots the parabola is negative: give that part back.
        total += root**3 / (6.0 * a * a)
        slope += root * (2.0 * (a + sigma) - 4.0 * level) / (4.0 * a * a) - root**3 / (3.0 * a**3)
    return total, slope


@compiled()
def short_closed(
    eccentricity: float, w_r: float, w_t: float, slenderness: float, clipped: Any,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Force of one section with equal pressures at both edges and in the cavity, in the frame of the line of centres.

    In Sommerfeld's angle gamma the integrand is a trigonometric polynomial: the classical closed form. slenderness:
    (b/R)^2; clipped: half-Sommerfeld instead of Sommerfeld. Returns the integrals of P (cos Theta, sin Theta) dz
    dTheta: force (r, t), its derivatives by w (rr, rt, tr, tt) and by the eccentricity (r, t), eight numbers.
    """
    s2 = 1.0 - eccentricity * eccentricity
    s = math.sqrt(s2)
    start, turn = 0.0, 2.0 * math.pi
    if clipped:
        reach = math.sqrt(w_r * w_r + w_t * w_t * s2)
        if reach > 0.0:
            limit = math.acos(w_r * eccentricity / reach)
            start = math.atan2(w_t * s, w_r) + limit
            turn -= 2.0 * limit
        else:  # no motion: any half turn gives the limit of the derivatives along no direction; take the rest's mean
            turn = math.pi
    end = start + turn
    sin_0, cos_0, sin_1, cos_1 = math.sin(start), math.cos(start), math.sin(end), math.cos(end)
    sines, cosines = sin_1 - sin_0, cos_1 - cos_0
    doubled = sin_1 * cos_1 - sin_0 * cos_0
    squares = 0.5 * (sin_1 * sin_1 - sin_0 * sin_0)
    i_rr = (0.5 + eccentricity * eccentricity) * turn + 0.5 * doubled - 2.0 * eccentricity * sines
    i_rt = squares + eccentricity * cosines
    i_tt = 0.5 * (turn - doubled)
    k = -slenderness / 12.0 / (s2 * s2 * s)
    rr, rt, tt = k * i_rr, k * s * i_rt, k * s2 * i_tt
    force_r, force_t = rr * w_r + rt * w_t, rt * w_r + tt * w_t
    # Derivatives at fixed limits: the integrand vanishes there.
    rate, s_rate = 5.0 * eccentricity / s2, -eccentricity / s2
    d_rr = k * (2.0 * eccentricity * turn - 2.0 * sines)
    d_rt = k * s * (cosines + s_rate * i_rt)
    return (
        force_r,
        force_t,
        rr,
        rt,
        rt,
        tt,
        rate * force_r + d_rr * w_r + d_rt * w_t,
        rate * force_t + d_rt * w_r + 2.0 * s_rate * tt * w_t,
    )


@compiled()
def short_general(
    eccentricity: float, w_r: float, w_t: float, slenderness: float, sigma: float, level: float,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Force, see short_closed, with the supply pressure sigma at z = 1 and the cavitation pressure `level`, both
    scaled, gauge."""
    s = math.sqrt(1.0 - eccentricity * eccentricity)
    force_r = force_t = rr = rt = tt = by_e_r = by_e_t = 0.0
    for i in range(ANGLES):
        gamma = 2.0 * math.pi * i / ANGLES
        shrink = 1.0 / (1.0 - eccentricity * math.cos(gamma))
        cosine, sine = (math.cos(gamma) - eccentricity) * shrink, s * math.sin(gamma) * shrink
        gap = 1.0 + eccentricity * cosine
        strength = -slenderness / (2.0 * gap**3)
        a = strength * (w_r * cosine + w_t * sine)
        value, slope = clipped_section(a, sigma, level)
        step = 2.0 * math.pi / ANGLES * s * shrink
        force_r += step * value * cosine
        force_t += step * value * sine
        slope *= step
        rr += slope * strength * cosine * cosine
        rt += slope * strength * sine * cosine
        tt += slope * strength * sine * sine
        change = -3.0 * slope * a * cosine / gap
        by_e_r += change * cosine
        by_e_t += change * sine
    return force_r, force_t, rr, rt, rt, tt, by_e_r, by_e_t
