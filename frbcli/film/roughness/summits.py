"""How many summits of two rough surfaces meet, and how hard, at a distance x of their mean planes over the roughness.

F_n(x) is the mean of (s - x)^n over the summits s > x of a normal distribution. The force of elastic summits goes with
F_5/2, and the area in which they touch with F_2.

Source: Greenwood, Tripp: The contact of two nominally flat rough surfaces. Proc. Instn. Mech. Engrs. 185 (1970),
625-633.
"""

from __future__ import annotations

import math

from frbcli.compiled import compiled

FLAT, LAST = -4.0, 8.0  # distances between which ln F_5/2 is a polynomial; at the second one no summits meet any more
# Chebyshev coefficients of ln F_5/2 from FLAT to LAST, from the integral
LOGARITHM = (
    -11.6123107489, -20.6174528323, -6.26345464158, -0.736466893402, 0.119477905162, 0.00873086096364,
    -0.0117519214807, 0.00233129505546, 0.000762388731151, -0.000563719733282, 7.16204341107e-05, 6.52624069993e-05,
    -3.49232427432e-05, 1.33684259964e-06, 5.71061698373e-06, -2.38287262562e-06, -1.51399698645e-07,
    5.0642086078e-07, -1.68236249287e-07, -3.1447994786e-08, 4.51476375396e-08,
)  # fmt: skip
# Binomial coefficients of (s - x)^(5/2) in s / x, of even order, times the moments of s: all summits meet
PRESSED = (1.0, 1.875, -0.1171875, -0.0732421875, -0.144195556640625)


def summit_integral(n: float, x: float) -> float:
    """F_n(x) as the integral that defines it."""
    from scipy.integrate import quad  # only here: the time loop takes the functions below

    def density(u: float) -> float:
        return float(u**n * math.exp(-u * x - 0.5 * u * u) if x > 0.0 else u**n * math.exp(-0.5 * (u + x) ** 2))

    middle = max(-x, 1.0)
    whole = sum(quad(density, *ends, epsabs=0.0, epsrel=1e-12)[0] for ends in ((0.0, middle), (middle, middle + 12.0)))
    return float(whole / math.sqrt(2.0 * math.pi) * (math.exp(-0.5 * x * x) if x > 0.0 else 1.0))


@compiled()
def elastic_summits(x: float) -> tuple[float, float]:
    """F_5/2(x) and its derivative, to 1e-6 of the function; 0 from LAST on."""
    if x >= LAST:
        return 0.0, 0.0
    if x < FLAT:
        square = 1.0 / (x * x)
        series, slope = 0.0, 0.0
        for k in range(len(PRESSED) - 1, -1, -1):
            series = series * square + PRESSED[k]
            slope = slope * square + (2.5 - 2 * k) * PRESSED[k]
        power = (-x) ** 1.5
        return -x * power * series, -power * slope
    t = (2.0 * x - FLAT - LAST) / (LAST - FLAT)
    after, own, after_slope, own_slope = 0.0, 0.0, 0.0, 0.0
    for k in range(len(LOGARITHM) - 1, 0, -1):  # Clenshaw's sum and its derivative
        own_slope, after_slope = 2.0 * own + 2.0 * t * own_slope - after_slope, own_slope
        own, after = LOGARITHM[k] + 2.0 * t * own - after, own
    value = math.exp(LOGARITHM[0] + t * own - after)
    return value, value * (own + t * own_slope - after_slope) * 2.0 / (LAST - FLAT)


@compiled()
def touching_summits(x: float) -> tuple[float, float]:
    """F_2(x), in closed form, and its derivative; 0 from LAST on."""
    if x >= LAST:
        return 0.0, 0.0
    share, density = 0.5 * math.erfc(x / math.sqrt(2.0)), math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    return (1.0 + x * x) * share - x * density, -2.0 * (density - x * share)
