"""Hermite's cubic polynomials between two lines of a table, compiled."""

from __future__ import annotations

from frbcli.compiled import compiled

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
