"""The position of one journal in which its film carries a given load, and how far a step towards rest may go."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from frbcli.errors import NotConverged
from frbcli.film.parabola import share_within

Array = NDArray[np.float64]

ITERATIONS = 40
SETTLED = 1e-5  # force left over, relative to the load
NUDGE = 1e-3  # share of the gap by which the position is moved for a derivative
GAP_KEPT = 0.3  # a step may shrink the narrowest gap to this share of it
SMALLEST_SHARE, SHORTER = 0.05, 0.4  # of a step that is tried; of the one tried before
POOR = 0.3  # of the force left over before: above it the derivatives are made anew


def largest_share(position: Array, step: Array, kept: float) -> float:
    """Largest share of a step (2,), at most 1, after which a journal at `position` (2,) keeps `kept` of its gap; both
    over the clearance."""
    return share_within(position, step, 1.0 - kept * (1.0 - float(np.linalg.norm(position))))


def position_under_load(missing: Callable[[Array], Array], load: Array, start: Array) -> Array:
    """(2,) displacement over the clearance in which no force is missing, sought from `start`.

    missing: the force (2,) in N that a displacement leaves over of the load (2,). Newton's method with derivatives by
    differences, kept up to date by Broyden's formula while that works. Raises NotConverged.
    """
    size = float(np.linalg.norm(load))
    position, fresh = start, True
    residual = missing(position)
    slope = _differences(missing, position, residual)
    for _ in range(ITERATIONS):
        left = float(np.linalg.norm(residual))
        if left < SETTLED * size:
            return position
        whole = np.asarray(-np.linalg.solve(slope, residual), dtype=np.float64)
        step = largest_share(position, whole, GAP_KEPT) * whole
        share = 1.0
        while True:
            following = position + share * step
            new = missing(following)
            if np.linalg.norm(new) < left or share < SMALLEST_SHARE:
                break
            share *= SHORTER
        if np.linalg.norm(new) >= left and fresh:
            break
        moved = following - position
        fresh = bool(np.linalg.norm(new) > POOR * left)
        position, change, residual = following, new - residual, new
        slope = (
            _differences(missing, position, residual)
            if fresh
            else slope + np.outer(change - slope @ moved, moved) / (moved @ moved)
        )
    raise NotConverged(f"{np.linalg.norm(residual) / size:.1e} of the load is left over at {np.round(position, 3)}.")


def _differences(missing: Callable[[Array], Array], position: Array, residual: Array) -> Array:
    nudge = NUDGE * (1.0 - float(np.linalg.norm(position)))
    return np.column_stack([(missing(position + nudge * unit) - residual) / nudge for unit in np.eye(2)])
