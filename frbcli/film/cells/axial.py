"""Across the width of a section: parabolas through the middles of the cells, for flows at the ends and for integrals.

The pressure of a full film is nearly a parabola over the width. Flows between two cells are exact for one; with the two
formulas here those at the ends and the mean pressure are, too, so that few cells along the axis are enough.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.film.grid import Array

BEND = 0.5  # share of the pressure of an end cell by which a parabola may change it; more than that is a front


class EndSlope(NamedTuple):
    """Slope at an end, rise (p_0 + bend (p_0 - p_1) - p_end), by the pressures of the last two cells."""

    rise: float
    bend: float


def end_slope(first: float, second: float) -> EndSlope:
    """For the distances of the middles of the last two cells from the end, over the width."""
    return EndSlope((first + second) / (first * second), first**2 / (second**2 - first**2))


def end_slopes(z: Array) -> tuple[EndSlope, EndSlope]:
    """At z = 0 and z = 1 for the boundaries z (k + 1,) of the cells."""
    middle = 0.5 * (z[1:] + z[:-1])
    if len(middle) == 1:
        return EndSlope(float(1.0 / middle[0]), 0.0), EndSlope(float(1.0 / middle[0]), 0.0)
    near = end_slope(float(middle[0]), float(middle[1]))
    return near, end_slope(float(1.0 - middle[-1]), float(1.0 - middle[-2]))


def axial_weights(z: Array, mirrored: bool) -> Array:
    """(k,) weights of the integral over [0, 1] of values in the middles of cells with the boundaries z (k + 1,).

    Each cell holds the parabola through its own value and its neighbours'; mirrored: a plane of symmetry at z = 1.
    """
    size = np.diff(z)
    k = len(size)
    if k < 3:
        return size
    middle = 0.5 * (z[1:] + z[:-1])
    weights = size.copy()
    for j in range(k):
        centre = min(max(j, 1), k - 1 if mirrored else k - 2)
        if centre == k - 1:  # the cell beyond the plane of symmetry is the last one again
            before, behind = middle[-1] - middle[-2], 2.0 * (1.0 - middle[-1])
            places = (k - 2, k - 1, k - 1)
        else:
            before, behind = middle[centre] - middle[centre - 1], middle[centre + 1] - middle[centre]
            places = (centre - 1, centre, centre + 1)
        curvature = 2.0 / (before + behind) * np.array([1.0 / before, -1.0 / before - 1.0 / behind, 1.0 / behind])
        for place, value in zip(places, curvature, strict=True):
            weights[place] += size[j] ** 3 / 24.0 * value
    return weights
