"""The gap that is left under a journal pressed into its shell: surfaces are rough, a film between them never ends."""

from __future__ import annotations

import math

from numba import njit

from frbcli.film.rectangles.table import LARGEST_ECCENTRICITY

KEPT = 0.2  # of the gap at which the surfaces touch: what no load presses out


def gap_limits(contact_eccentricity: float) -> tuple[float, float]:
    """(eccentricity from which the film's gap closes more slowly than the journal moves, least gap over the clearance)
    for surfaces that touch from this eccentricity on; the gap stays where films can be computed."""
    least = max(KEPT * (1.0 - contact_eccentricity), 1.0 - LARGEST_ECCENTRICITY)
    return 1.0 - least / KEPT, least


@njit(cache=True, error_model="numpy")
def kept_gap(stops_from, least, d_x, d_y):  # type: ignore[no-untyped-def]
    """(x, y, xx, yy, xy): the displacement (x, y) that the film feels of (d_x, d_y), over the clearance, and its
    derivatives, a symmetric matrix, which also is what the film feels of the velocity.

    Beyond stops_from the felt eccentricity goes as tanh to 1 - least, with a slope from 1 to 0: the gap, its rate and
    so the force have no jump, and a gap that does not close any more squeezes nothing.
    """
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if eccentricity <= stops_from:
        return d_x, d_y, 1.0, 1.0, 0.0
    n_x, n_y, left = d_x / eccentricity, d_y / eccentricity, 1.0 - least - stops_from
    way = math.tanh((eccentricity - stops_from) / left)
    along, radial = (stops_from + left * way) / eccentricity, 1.0 - way * way
    xx, yy = radial * n_x * n_x + along * n_y * n_y, radial * n_y * n_y + along * n_x * n_x
    return along * d_x, along * d_y, xx, yy, (radial - along) * n_x * n_y
