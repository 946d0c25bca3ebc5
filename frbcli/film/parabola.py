"""Parabolas and cubics through three points and slopes.

Roots and summit of a parabola, in forms that stay exact where its curvature is mere round-off.

Hermite's cubic polynomials between two lines of a table, compiled.
"""

from __future__ import annotations

import math

from frbcli.arrays import Array
from frbcli.compiled import compiled


@compiled()
def parabola_roots(a: float, b: float, c: float) -> tuple[float, float]:
    """The real roots of a x^2 + b x + c, not a number where there are none.

    b and the root of the discriminant are added with one sign, so that nothing cancels: the smaller root is exact
    however small a is, and the larger one goes to infinity. A companion matrix, and the usual formula, lose the smaller
    one.
    """
    discriminant = b * b - 4.0 * a * c
    if discriminant < 0.0:
        return math.nan, math.nan
    q = -0.5 * (b + math.copysign(math.sqrt(discriminant), b))
    if q == 0.0:  # b = 0, and a or c is 0: a double root at 0, or a constant
        root = 0.0 if a != 0.0 else math.nan
        return root, root
    far = q / a if a != 0.0 else math.copysign(math.inf, q)
    return c / q, far


def summit(low: float, middle: float, high: float, before: float, behind: float) -> tuple[float, float]:
    """Place and value of the highest point of the parabola through three values at -before, 0 and behind, the middle
    one being the highest. It lies less than half way to either neighbour; without curvature it is the middle itself."""
    slope_low, slope_high = (middle - low) / before, (high - middle) / behind
    bend = (slope_high - slope_low) / (before + behind)
    if bend >= 0.0:
        return 0.0, middle
    slope = slope_low + bend * before
    return -0.5 * slope / bend, middle - 0.25 * slope * slope / bend


def share_within(place: Array, step: Array, limit: float) -> float:
    """Largest share of a step (2,), at most 1, that leaves a place (2,) within a circle of the radius `limit` about the
    origin, in which it lies."""
    roots = parabola_roots(float(step @ step), 2.0 * float(place @ step), float(place @ place) - limit * limit)
    return min(1.0, max(roots)) if step.any() else 1.0


Values = tuple[float, float, float, float]
Slopes = tuple[float, float, float]


@compiled(inline=True)
def hermite(a: float, step: float) -> tuple[Values, Slopes]:
    """Weights at a share a of the step from one line to the next: the two values and their two slopes are multiplied by
    the first and added to give the value, the difference of the values and the two slopes by the second for its
    slope."""
    return (
        ((1 + 2 * a) * (1 - a) ** 2, a * a * (3 - 2 * a), step * a * (1 - a) ** 2, step * a * a * (a - 1)),
        (6 * a * (1 - a) / step, (1 - a) * (1 - 3 * a), a * (3 * a - 2)),
    )
