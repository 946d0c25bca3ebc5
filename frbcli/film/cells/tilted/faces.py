"""Flows and oil of many cells, one after the other in memory, as loops that the compiler turns into vectors.

All arrays are of one dimension and as long as there are cells. A flow goes through a face between a cell and the next
one, around or along.
"""

from __future__ import annotations

from typing import Any, NamedTuple, cast

from numba import njit

from frbcli.arrays import Array
from frbcli.compiled import AS_KERNELS, Kernel
from frbcli.film.cells.balance.states import carried_at

_PartCompiler: Any = AS_KERNELS["pipeline_class"]


class _DisjointCompiler(_PartCompiler):  # type: ignore[misc]
    """numba's compiler for `disjoint` kernels."""

    def compile_extra(self, func: Any) -> Any:
        """See numba's."""
        self.state.flags.noalias = True
        return super().compile_extra(func)


def disjoint(function: Kernel) -> Kernel:
    """A kernel that others call, none of whose arrays share memory with one that it writes to.

    Elsewhere LLVM asks before a loop whether its arrays overlap, and makes no vectors of a loop with many of them. Sums
    are rounded in another order.
    """
    options: Any = AS_KERNELS | {"pipeline_class": _DisjointCompiler, "fastmath": {"contract", "reassoc"}}
    return cast("Kernel", njit(**options)(function))


class FaceFlows(NamedTuple):
    """Flows through the faces behind cells, and their derivatives by the unknowns of both cells and by the gap."""

    flow: Array
    by_own: Array
    by_next: Array
    by_gap: Array


class OwnAndNext(NamedTuple):
    """What belongs to cells, and to the next ones."""

    own: Array
    next: Array


class Sloped(NamedTuple):
    """What follows the unknowns of cells, and its derivatives by them."""

    value: Array
    slope: Array


class StencilRows(NamedTuple):
    """The entries of cells, see block_cyclic.py."""

    centre: Array
    before: Array
    behind: Array
    below: Array
    above: Array


@disjoint
def cubed(gaps: Array, cubes: Array, by_gaps: Array) -> None:
    """cubes <- of gaps, and by_gaps their derivatives."""
    for e in range(gaps.shape[0]):
        square = gaps[e] * gaps[e]
        cubes[e], by_gaps[e] = gaps[e] * square, 3.0 * square


@disjoint
def pressed(
    openings: Array, cubes: Array, by_gaps: Array, growth: float, p: OwnAndNext, slope: OwnAndNext, to: FaceFlows
) -> None:
    """to <- flows by the pressures p through cubes of gaps.

    openings: conductances of a gap of 1; by_gaps: derivatives of the cubes by the gaps; growth: by which the derivative
    by the gap is multiplied; slope: of the pressures.
    """
    for e in range(to.flow.shape[0]):
        fall, through = p.own[e] - p.next[e], cubes[e] * openings[e]
        to.flow[e] = through * fall
        to.by_own[e] = through * slope.own[e]
        to.by_next[e] = through * slope.next[e]
        to.by_gap[e] = growth * (by_gaps[e] * openings[e]) * fall


@disjoint
def drawn(
    swept: Array, pulls: Array, forward: bool, diffuses: bool, growth: float, oil: OwnAndNext, upstream: Array,
    slope: OwnAndNext, share: OwnAndNext, to: FaceFlows,
) -> float:  # fmt: skip
    """to <- what the surfaces carry, per share of a cell that is film; what openings in the cells take of it.

    swept: flows full of oil; pulls: their derivatives by the gaps; oil, upstream, forward: see carried_at; diffuses:
    whether the surfaces carry the mean oil fraction of both cells, see diffusion.py; slope: of the oil fractions.
    """
    outflow = 0.0
    for e in range(to.flow.shape[0]):
        theta, own, other = carried_at(oil.own[e], oil.next[e], upstream[e], forward)
        if diffuses:
            theta, own, other = 0.5 * (oil.own[e] + oil.next[e]), 0.5, 0.5
        through = swept[e] * theta
        to.flow[e] = through
        to.by_own[e] = swept[e] * own * slope.own[e]
        to.by_next[e] = swept[e] * other * slope.next[e]
        to.by_gap[e] = growth * pulls[e] * theta
        outflow += (share.own[e] - share.next[e]) * through
    return outflow


@disjoint
def stored(
    areas: Array, unknown: Array, factors: Array, growth: float, past: Array, oil: Sloped, source: Sloped, left: Array,
    centre: Array, by_gap: Array,
) -> None:  # fmt: skip
    """left <- minus what unknown cells store, factors theta - past, less their source; centre, by_gap <- derivatives of
    what they store by their unknowns and by the rate of the gap, the latter times growth."""
    for e in range(left.shape[0]):
        area = areas[e] * unknown[e]
        left[e] = area * (past[e] + source.value[e] - factors[e] * oil.value[e])
        centre[e] = area * (factors[e] * oil.slope[e] - source.slope[e])
        by_gap[e] = growth * area * oil.value[e]


@disjoint
def balanced(
    share: Array, pressed_in: FaceFlows, pressed_out: FaceFlows, drawn_in: FaceFlows, drawn_out: FaceFlows,
    raised_in: FaceFlows, raised_out: FaceFlows, by_gaps: OwnAndNext, left: Array, to: StencilRows,
) -> None:  # fmt: skip
    """left += what flows in less what flows out of cells: around by pressures and by the surfaces, and along; by_gaps
    <- the derivatives of what flows in and out around; to <- by the derivatives by the unknowns of the cells, added to
    what is in their centres."""
    for e in range(share.shape[0]):
        around = pressed_in.flow[e] - pressed_out.flow[e] + share[e] * (drawn_in.flow[e] - drawn_out.flow[e])
        left[e] += around + raised_in.flow[e] - raised_out.flow[e]
        by_gaps.own[e] = pressed_in.by_gap[e] + share[e] * drawn_in.by_gap[e]
        by_gaps.next[e] = pressed_out.by_gap[e] + share[e] * drawn_out.by_gap[e]
        around = pressed_out.by_own[e] + pressed_in.by_next[e] + share[e] * (drawn_out.by_own[e] - drawn_in.by_next[e])
        to.centre[e] += around + raised_out.by_own[e] + raised_in.by_next[e]
        to.before[e] = -pressed_in.by_own[e] - share[e] * drawn_in.by_own[e]
        to.behind[e] = share[e] * drawn_out.by_next[e] - pressed_out.by_next[e]
        to.below[e] = -raised_in.by_own[e]
        to.above[e] = -raised_out.by_next[e]
