"""Newton's method for rest: the journals move until no force is left over on them.

A machine, a journal under a load and a film in any form differ in the forces that are left over alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from frbcli.arrays import Array
from frbcli.film.parabola import share_within

Films = TypeVar("Films")

ITERATIONS = 80
GAP_KEPT = 0.25  # a step may shrink 1 - eps of a journal to this share of it
SHORTER = 0.5  # of the share of a step that is tried, while the force that is left over does not fall
NEAR = 0.1  # share that a step leaves of the force left over, below which its change shows what the slopes lack
STUCK, GAIN = 10, 1e-3  # shortened steps in a row that each take less than this share of the force that is left over


@dataclass(frozen=True)
class ForceBalance(Generic[Films]):
    """Journals at given places. residual: (c films,) N left over on them, or N m; slope: (c films, c films) its
    derivative by the places; films: their state there, from which places near by are solved."""

    residual: Array
    slope: Array
    films: Films

    @property
    def left(self) -> float:
        """Size of the residual, N."""
        return float(np.linalg.norm(self.residual))


@dataclass(frozen=True)
class Search:
    """When a search ends. step: over the clearance, a full step below it has arrived; negligible: over the clearance, a
    step below it is not taken any more, where films are dear; force: N, and so has less left
    over; share: smallest one of a step that is tried until less is left over; patience: places that may be no better
    one after the other, where forces have jumps; gap: over the clearance, a journal that is nearer to its shell and
    still not held there does not rest."""

    step: float
    force: float
    share: float
    patience: int = 0
    gap: float = 0.0
    negligible: float = 0.0


@dataclass(frozen=True)
class SearchEnd(Generic[Films]):
    """Where a search ended. position: (films, c) in m and rad; settled: whether the journals rest there; lacking:
    (c films, c films) what the slopes have been seen to lack on the way."""

    position: Array
    balance: ForceBalance[Films]
    settled: bool
    lacking: Array


def search_rest(
    balance: Callable[[Array, ForceBalance[Films] | None], ForceBalance[Films]],
    start: Array,
    ends: Callable[[Array], Array],
    search: Search,
    lacking: Array | None = None,
    besides: Callable[[Array], float] | None = None,
) -> SearchEnd[Films]:
    """Where journals rest, sought from `start` (films, c) in m, with tilts in rad where they have any, or (n,) of any
    unknowns.

    balance: of the journals at a position (films, c), and the balance at the position before, if there is one; ends:
    (k, 2) what has to stay within the gap at a position, over the clearance and linear in it; lacking: what the slopes
    are known to lack, see SearchEnd; besides: size of a step in what moves no journal, over the clearance, too. Raises
    what balance raises.
    """
    first = balance(start, None)
    best = here = SearchEnd(start, first, False, np.zeros_like(first.slope) if lacking is None else lacking)
    still = ends(np.zeros_like(start))
    since = stuck = 0
    for _ in range(ITERATIONS):
        current = here.balance
        if current.left < search.force:
            return replace(here, settled=True)
        slope = current.slope + here.lacking
        if not np.isfinite(slope).all() or _singular(slope):
            break
        solved = np.asarray(np.linalg.solve(slope, -current.residual), dtype=np.float64)
        step = solved.reshape(*here.position.shape)
        there, moved = ends(here.position), ends(step) - still
        if _leaves(there, moved, search.gap):
            break
        share = whole = min([1.0, *(largest_share(*pair) for pair in zip(there, moved, strict=True))])
        size = max(float(np.abs(moved).max()), besides(step) if besides else 0.0)
        if size < search.negligible:
            return replace(here, settled=True)
        arrives = size < search.step
        while True:
            following = here.position + share * step
            new = balance(following, current)
            if arrives or new.left < current.left or SHORTER * share <= search.share:
                break
            share *= SHORTER
        settled = arrives and share == 1.0
        lacks = here.lacking if settled else _lacking(here.lacking, current, new, share * solved)
        here = SearchEnd(following, new, settled, lacks)
        since = 0 if arrives or new.left < best.balance.left else since + 1
        best = here if since == 0 else best
        stuck = stuck + 1 if share < whole and new.left > (1.0 - GAIN) * current.left else 0
        if here.settled or since > search.patience or stuck == STUCK:
            break
    return best


def _singular(slope: Array) -> bool:
    """Whether a matrix is singular, whatever the units of its rows and columns."""
    for axis in (1, 0):
        size = np.abs(slope).max(axis=axis, keepdims=True)
        if not size.all():
            return True
        slope = slope / size
    return bool(np.linalg.matrix_rank(slope) < len(slope))


def _lacking(before: Array, current: ForceBalance[Films], new: ForceBalance[Films], step: Array) -> Array:
    """(c films, c films) what the slopes lack, as those by the speeds of rings do, after a step (c films,): from the
    change of the residual along the step (Broyden, Math. Comp. 19, 1965). None while the step is long."""
    if not 0.0 < new.left < NEAR * current.left:
        return np.zeros_like(before)
    predicted = 0.5 * (current.slope + new.slope) @ step + before @ step
    return before + np.outer(new.residual - current.residual - predicted, step) / (step @ step)


def _leaves(places: Array, moved: Array, gap: float) -> bool:
    """Whether a journal at places (k, 2) has less than the gap left and a step by `moved` (k, 2) takes it still nearer
    to its shell; all over the clearance."""
    beyond = np.linalg.norm(places, axis=1) > 1.0 - gap
    return bool((beyond & ((places * moved).sum(axis=1) > 0.0)).any())


def largest_share(position: Array, step: Array) -> float:
    """Largest share of a step (2,), at most 1, after which a journal at `position` (2,) keeps GAP_KEPT of its gap; both
    over the clearance."""
    return share_within(position, step, 1.0 - GAP_KEPT * (1.0 - float(np.linalg.norm(position))))
