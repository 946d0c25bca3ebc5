"""Basic rating life L10 of a ball bearing from the loads of its balls and its basic dynamic load rating.

ISO/TS 16281 (basic reference rating life), which is L10 = (C / P)^3 of ISO 281 for the distribution of loads that ISO
281 assumes: with gamma = d cos(alpha) / D, i rows of Z balls and

    rho = 1.044 ((1 - gamma) / (1 + gamma))^1.72 (f_i / f_o (2 f_o - 1) / (2 f_i - 1))^0.41
    Q_ci = C / (0.407 Z (i cos alpha)^0.7) (1 + rho^(10/3))^0.3
    Q_ce = C / (0.389 Z (i cos alpha)^0.7) (1 + rho^(-10/3))^0.3

a ring that turns bears the cubic mean of the loads, one that stands their mean with the power 10/3.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.elements.rolling.bearing import BallBearing
from frbcli.elements.rolling.rest import Balls

STANDING, TURNING, WEIBULL = 10.0 / 3.0, 3.0, 0.9


def rating_life(bearing: BallBearing, balls: Balls, rating: float) -> float:
    """L10 in revolutions under the loads of the balls of each row; rating: C of the whole bearing in N. Infinite
    without a load."""
    gamma, f_i, f_o = bearing.gamma, bearing.inner, bearing.outer
    grooves = f_i / f_o * (2.0 * f_o - 1.0) / (2.0 * f_i - 1.0)
    rho = 1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * grooves**0.41
    each = rating / (bearing.balls * (bearing.rows * math.cos(bearing.contact_angle)) ** 0.7)
    inner = each / 0.407 * (1.0 + rho**STANDING) ** 0.3
    outer = each / 0.389 * (1.0 + rho**-STANDING) ** 0.3
    bears_inner = float(np.mean(balls.inner_load**TURNING)) ** (1.0 / TURNING)
    bears_outer = float(np.mean(balls.outer_load**STANDING)) ** (1.0 / STANDING)
    damage = bearing.rows * ((bears_inner / inner) ** STANDING + (bears_outer / outer) ** STANDING)
    return 1e6 * damage**-WEIBULL if damage > 0.0 else math.inf
