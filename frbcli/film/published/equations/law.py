"""The step (4.32) to (4.35) as elements and nodes need it, compiled; cavitation/two_phase.py is its plain form."""

from __future__ import annotations

import math
from typing import NamedTuple

from frbcli.compiled import compiled
from frbcli.film.cavitation.two_phase import TwoPhase

POLISHING = 2  # Newton steps after the closed form of a cubic's root


class Step(NamedTuple):
    """start: x_0; slope: theta'_0; linear: m of (4.34); cavitation, cavity: p_cav, gauge and absolute, in 1/s."""

    start: float
    slope: float
    linear: float
    cavitation: float
    cavity: float


def make_step(law: TwoPhase, cavitation: float, ambient: float) -> Step:
    """The step of a law; cavitation: scaled gauge pressure p_cav, ambient: scaled absolute pressure."""
    start, slope = 2.0 * law.steepness - 1.0, law.outer_slope
    linear = slope * (1.0 - start) / (1.0 - start * slope)
    return Step(start, slope, linear, cavitation, cavitation + ambient)


@compiled()
def oil_fraction(step: Step, pressure: float) -> tuple[float, float, float]:
    """theta (4.32), dtheta/dp (4.33) and d2theta/dp2 at a scaled gauge pressure."""
    y = 1.0 + (pressure - step.cavitation) / step.cavity
    s, x_0, m = step.slope, step.start, step.linear
    if y > 1.0:
        return 1.0 + s * (y - 1.0), s / step.cavity, 0.0
    if y < x_0:
        return s * y, s / step.cavity, 0.0
    height, length = 1.0 - s * x_0, (1.0 - x_0) * step.cavity
    place = (y - x_0) / (1.0 - x_0)
    theta = height * ((1.0 - m) * place * place * (3.0 - 2.0 * place) + m * place) + s * x_0
    first = height * ((1.0 - m) * 6.0 * place * (1.0 - place) + m) / length
    return theta, first, height * (1.0 - m) * (6.0 - 12.0 * place) / length**2


@compiled()
def step_pressure(step: Step, ratio: float, w: float) -> tuple[float, float]:
    """Scaled gauge pressure with theta - 1 + ratio (y - 1) = w, y = p / p_cav, and its derivative by w."""
    s, x_0, m = step.slope, step.start, step.linear
    bottom = s * x_0 - 1.0 + (x_0 - 1.0) * ratio
    if w > 0.0:
        return step.cavitation + step.cavity * w / (ratio + s), step.cavity / (ratio + s)
    if w < bottom:
        rise = x_0 - 1.0 + (w - bottom) / (ratio + s)
        return step.cavitation + step.cavity * rise, step.cavity / (ratio + s)
    height = 1.0 - s * x_0
    cubic, linear, target = height * (1.0 - m), height * m + (1.0 - x_0) * ratio, w - bottom
    # With u = place - 1/2 the cubic reads u^3 - p u = q, whose middle root is a sine.
    p = (1.5 * cubic + linear) / (2.0 * cubic)
    q = (0.5 * (cubic + linear) - target) / (2.0 * cubic)
    radius = math.sqrt(p / 3.0)
    place = 0.5 - 2.0 * radius * math.sin(math.asin(max(-1.0, min(1.0, q / (2.0 * radius**3)))) / 3.0)
    for _ in range(POLISHING):
        place = max(0.0, min(1.0, place))
        defect = cubic * place * place * (3.0 - 2.0 * place) + linear * place - target
        place -= defect / (6.0 * cubic * place * (1.0 - place) + linear)
    place = max(0.0, min(1.0, place))
    rate = 6.0 * cubic * place * (1.0 - place) + linear
    return step.cavitation + step.cavity * (x_0 - 1.0) * (1.0 - place), step.cavity * (1.0 - x_0) / rate
