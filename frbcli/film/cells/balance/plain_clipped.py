"""Forces of a pressure that is clipped at p_cav (3.29), with the edge of the cavity between the middles of two cells.

To clip cell by cell would let the force jump as the edge moves over a cell. Here the pressure above p_cav goes on a
straight line from a cell p to the next one n, so that a share x of the way between their middles is above p_cav,

    x = 1 where both are,   p / (p - n) where p > 0 > n,   n / (n - p) where n > 0 > p,   0 where none is,

and half of x p and of x n, of what is above p_cav, counts as mean pressure of the two cells. In addition to the
straight line counts -y S / 32 with y = x^2 (3 - 2 x), S = p_before - p - n + p_beyond being twice the curvature over
the way: the sum of what the pressure is above its chord, -S / 24, and of what the cells' own pressures are off by.
Where oil flows around, this is +S / 48, for the balances take the flow through a face by the fall of pressure over it;
where it flows along the width, it is nothing. Half of it is taken. Without it a force would be wrong by the slopes at
both edges of a cavity, in second order. """

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array

CURVED = 1.0 / 32.0  # of S, see above


def clipped_means(above: Array) -> Array:
    """(m, k) mean pressures above p_cav of cells around a ring, for forces; above: (m, k) in their middles, less than 0
    in the cavity."""
    before, after, beyond = (np.roll(above, by, axis=0) for by in (1, -1, -2))
    here_full, after_full = above > 0.0, after > 0.0
    size = np.where(here_full ^ after_full, np.abs(above) + np.abs(after), 1.0)
    part = np.where(here_full, above, after) / size
    x = np.where(here_full & after_full, 1.0, np.where(here_full | after_full, part, 0.0))
    y = x**2 * (3.0 - 2.0 * x)
    curved = CURVED * y * (before - above - after + beyond)
    to_here = 0.5 * x * np.maximum(above, 0.0) - curved * np.where(here_full, 1.0 - 0.5 * y, 0.5 * y)
    to_after = 0.5 * x * np.maximum(after, 0.0) - curved * np.where(here_full, 0.5 * y, 1.0 - 0.5 * y)
    return np.asarray(to_here + np.roll(to_after, 1, axis=0))
