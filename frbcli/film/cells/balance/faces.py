"""Flows and oil of many cells, one after the other in memory, as loops that the compiler turns into vectors.

All arrays are of one dimension and as long as there are cells. A flow goes through a face between a cell and the next
one, around or along.

The force on a journal by the pressures of a film, or forces at both ends of its bearing, with derivatives, compiled.

Those do the same virtual work as the pressures on a journal that moves and tilts: a pressure at the place z along the
axis pushes with the share z at the far end, and with the rest at the near one. A pressure that is clipped at p_cav
between the middles of cells: `clipped_means` of film.py.
"""

from __future__ import annotations

from typing import Any, NamedTuple, cast

import numpy as np
from numba import njit

from frbcli.arrays import Array
from frbcli.compiled import AS_KERNELS, Kernel, compiled
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE, carried_at
from frbcli.film.cells.data import (
    BETWEEN_MIDDLES,
    BY_ENDS,
    BY_ITSELF,
    BY_X,
    BY_Y,
    LOAD,
    MIDDLES,
    NO_CLIP,
    PUSH_X,
    PUSH_Y,
)
from frbcli.film.cells.film import CURVED

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


@compiled()
def rise(p: float, n: float, s: float) -> tuple[float, float, float, float, float, float, float, float]:
    """Shares that count in the cells of p and of n, p > 0 >= n, and their derivatives by p, n and S.

    The derivatives of x are (1 - x) and x over p - n. They enter with p or S, which over p - n are of usual size even
    in a film that begins at 1e-314 Pa, the square of which is nothing.
    """
    size = p - n
    x = p / size
    y = x * x * (3.0 - 2.0 * x)
    turn = 6.0 * x * (1.0 - x) * CURVED * (s / size)
    own, other = CURVED * y * (1.0 - 0.5 * y), 0.5 * CURVED * y * y
    return (
        0.5 * x * p - own * s, -other * s,
        0.5 * x * (2.0 - x) - (1.0 - y) * turn * (1.0 - x), 0.5 * x * x - (1.0 - y) * turn * x, -own,
        -y * turn * (1.0 - x), -y * turn * x, -other,
    )  # fmt: skip


@compiled(inline=True)
def shared(p: float, q: float, s: float) -> tuple[float, float, float, float, float, float, float, float]:
    """Shares that count in the cells of p and of q, one of which at least is positive, and their derivatives by p, q
    and S."""
    a_p, a_q, a_s, c_p, c_q, c_s = 0.5, 0.0, -0.5 * CURVED, 0.0, 0.5, -0.5 * CURVED
    if q <= 0.0:
        to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = rise(p, q, s)
    elif p <= 0.0:
        to_q, to_p, c_q, c_p, c_s, a_q, a_p, a_s = rise(q, p, s)
    else:
        to_p, to_q = a_p * p + a_s * s, c_q * q + c_s * s
    return to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s


@compiled()
def _pressed(film: np.record, ring: Array, cells: Array, states: Array, fields: Array, push: Array) -> None:
    """push[2] (m, k) <- pressures of the cells as forces take them, times their weights; push[:2] <- by what forces
    along x and y change with each."""
    m, k = states.shape[1], states.shape[2]
    cavity, clips = film.scales.cavitation, film.clips != NO_CLIP
    for i in range(m):
        for j in range(k):
            here = states[PRESSURE, i, j] + states[PRESSURE_SLOPE, i, j] * fields[i, j, k + BY_ITSELF]
            counts = not clips or here >= cavity
            push[2, i, j] = cells[LOAD, i, j] * (here if counts else cavity)
            push[0, i, j] = ring[PUSH_X, i] * cells[LOAD, i, j] if counts else 0.0
            push[1, i, j] = ring[PUSH_Y, i] * cells[LOAD, i, j] if counts else 0.0


@compiled()
def _pressed_between(film: np.record, ring: Array, cells: Array, states: Array, fields: Array, push: Array) -> None:
    """_pressed of a pressure that is clipped between the middles of cells, see `clipped_means`."""
    m, k = states.shape[1], states.shape[2]
    cavity = film.scales.cavitation
    for i in range(m):
        for j in range(k):
            own = states[PRESSURE_SLOPE, i, j] * fields[i, j, k + BY_ITSELF]
            push[3, i, j] = states[PRESSURE, i, j] + own - cavity
            push[0, i, j] = push[1, i, j] = 0.0
            push[2, i, j] = cells[LOAD, i, j] * cavity
    for i in range(m):
        before, n = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        after = n + 1 if n + 1 < m else 0
        for j in range(k):
            p, q = push[3, i, j], push[3, n, j]
            if p <= 0.0 and q <= 0.0:
                continue
            s = push[3, before, j] + push[3, after, j] - p - q
            to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = shared(p, q, s)
            at, behind = cells[LOAD, i, j], cells[LOAD, n, j]
            push[2, i, j] += at * to_p
            push[2, n, j] += behind * to_q
            for side in range(2):
                here, there = at * ring[PUSH_X + side, i], behind * ring[PUSH_X + side, n]
                by_s = here * a_s + there * c_s
                push[side, i, j] += here * a_p + there * c_p - by_s
                push[side, n, j] += here * a_q + there * c_q - by_s
                push[side, before, j] += by_s
                push[side, after, j] += by_s


@compiled()
def press_cells(film: np.record, ring: Array, cells: Array, states: Array, fields: Array, push: Array) -> None:
    """push[2] (m, k) <- pressures of the cells as forces take them after their own change in fields (m, k, k + sides),
    times their weights; push[:2] <- by what forces along x and y, over the film's scale, change with each pressure.
    push: (4, m, k) to work in."""
    if film.clips == BETWEEN_MIDDLES:
        _pressed_between(film, ring, cells, states, fields, push)
    else:
        _pressed(film, ring, cells, states, fields, push)


@compiled()
def film_loads(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, fields: Array, push: Array,
    loads: Array, slopes: Array,
) -> None:  # fmt: skip
    """loads (2,) <- the force on the journal in N after the cells' own change in fields; slopes (2, 2) <- its
    derivatives by the journal's velocities in N s. Or (4,) of both ends of the bearing, see data.py for their order,
    and (4, 4) by the rates of its coordinates. push: see press_cells."""
    if loads.shape[0] == 2:
        _summed(film, ring, cells, states, fields, loads, slopes)
    else:
        press_cells(film, ring, cells, states, fields, push)
        _summed_at_ends(film, ring, places, states, fields, push, loads, slopes)


@compiled()
def _above(
    cavity: float, states: Array, fields: Array, i: int, j: int, one: int, other: int
) -> tuple[float, float, float]:
    """Pressure of a cell above p_cav after its own change in fields, and what it changes with by two layers of them."""
    slope = states[PRESSURE_SLOPE, i, j]
    own = states[PRESSURE, i, j] + slope * fields[i, j, states.shape[2]] - cavity
    return own, slope * fields[i, j, one], slope * fields[i, j, other]


@compiled()
def _clipped_push(
    film: np.record, ring: Array, cells: Array, states: Array, fields: Array, one: int, other: int
) -> tuple[float, float, float, float, float, float]:
    """Force (x, y) over the film's scale after its own change in fields (m, k, k + SIDES), see film_loads, and its
    derivatives by what two layers of fields are changes with: (x, y) of one, (x, y) of the other."""
    m, k = states.shape[1], states.shape[2]
    cavity = film.scales.cavitation
    f_x, f_y, one_x, one_y, other_x, other_y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(k):  # four cells in a row: b, p, q, z
        b, one_b, other_b = _above(cavity, states, fields, m - 1, j, one, other)
        p, one_p, other_p = _above(cavity, states, fields, 0, j, one, other)
        q, one_q, other_q = _above(cavity, states, fields, 1, j, one, other)
        for i in range(m):
            n = i + 1 if i + 1 < m else 0
            z, one_z, other_z = _above(cavity, states, fields, n + 1 if n + 1 < m else 0, j, one, other)
            at, behind = cells[LOAD, i, j], cells[LOAD, n, j]
            f_x += ring[PUSH_X, i] * at * cavity
            f_y += ring[PUSH_Y, i] * at * cavity
            if p > 0.0 or q > 0.0:
                s = b + z - p - q
                to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = shared(p, q, s)
                at_x, at_y = at * ring[PUSH_X, i], at * ring[PUSH_Y, i]
                behind_x, behind_y = behind * ring[PUSH_X, n], behind * ring[PUSH_Y, n]
                f_x += at_x * to_p + behind_x * to_q
                f_y += at_y * to_p + behind_y * to_q
                by_p, by_q = at_x * a_p + behind_x * c_p, at_x * a_q + behind_x * c_q
                by_s = at_x * a_s + behind_x * c_s
                one_x += by_p * one_p + by_q * one_q + by_s * (one_b + one_z - one_p - one_q)
                other_x += by_p * other_p + by_q * other_q + by_s * (other_b + other_z - other_p - other_q)
                by_p, by_q = at_y * a_p + behind_y * c_p, at_y * a_q + behind_y * c_q
                by_s = at_y * a_s + behind_y * c_s
                one_y += by_p * one_p + by_q * one_q + by_s * (one_b + one_z - one_p - one_q)
                other_y += by_p * other_p + by_q * other_q + by_s * (other_b + other_z - other_p - other_q)
            b, one_b, other_b = p, one_p, other_p
            p, one_p, other_p = q, one_q, other_q
            q, one_q, other_q = z, one_z, other_z
    return f_x, f_y, one_x, one_y, other_x, other_y


@compiled()
def _summed(
    film: np.record, ring: Array, cells: Array, states: Array, fields: Array, loads: Array, slopes: Array
) -> None:
    """film_loads of a journal that does not tilt: in one sweep, which is faster than by press_cells."""
    m, k = states.shape[1], states.shape[2]
    cavity, clips = film.scales.cavitation, film.clips != NO_CLIP
    x, y, xx, xy, yx, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if film.clips == BETWEEN_MIDDLES:
        x, y, xx, yx, xy, yy = _clipped_push(film, ring, cells, states, fields, k + BY_X, k + BY_Y)
    for i in range(0 if film.clips == BETWEEN_MIDDLES else m):
        p, by_x, by_y = 0.0, 0.0, 0.0
        for j in range(k):
            weight, slope = cells[LOAD, i, j], states[PRESSURE_SLOPE, i, j]
            here = states[PRESSURE, i, j] + slope * fields[i, j, k + BY_ITSELF]
            if clips and here < cavity:
                p += weight * cavity
            else:
                p += weight * here
                by_x += weight * slope * fields[i, j, k + BY_X]
                by_y += weight * slope * fields[i, j, k + BY_Y]
        push_x, push_y = ring[PUSH_X, i], ring[PUSH_Y, i]
        x, y = x + push_x * p, y + push_y * p
        xx, xy, yx, yy = xx + push_x * by_x, xy + push_x * by_y, yx + push_y * by_x, yy + push_y * by_y
    scale = film.force_scale
    loads[0], loads[1] = scale * x, scale * y
    slopes[0, 0], slopes[0, 1], slopes[1, 0], slopes[1, 1] = scale * xx, scale * xy, scale * yx, scale * yy


@compiled()
def _summed_at_ends(
    film: np.record, ring: Array, places: Array, states: Array, fields: Array, push: Array, loads: Array,
    slopes: Array,
) -> None:  # fmt: skip
    """film_loads at both ends of a bearing."""
    m, k, first = states.shape[1], states.shape[2], states.shape[2] + BY_ENDS
    for a in range(4):
        loads[a] = 0.0
        for b in range(4):
            slopes[a, b] = 0.0
    for j in range(k):  # sums of a circumference stay in registers
        x, y, x_0, x_1, x_2, x_3, y_0, y_1, y_2, y_3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(m):
            slope, p = states[PRESSURE_SLOPE, i, j], push[2, i, j]
            x += ring[PUSH_X, i] * p
            y += ring[PUSH_Y, i] * p
            by_x, by_y = slope * push[0, i, j], slope * push[1, i, j]
            u_0, u_1 = fields[i, j, first], fields[i, j, first + 1]
            u_2, u_3 = fields[i, j, first + 2], fields[i, j, first + 3]
            x_0, x_1, x_2, x_3 = x_0 + by_x * u_0, x_1 + by_x * u_1, x_2 + by_x * u_2, x_3 + by_x * u_3
            y_0, y_1, y_2, y_3 = y_0 + by_y * u_0, y_1 + by_y * u_1, y_2 + by_y * u_2, y_3 + by_y * u_3
        near, far = film.force_scale * (1.0 - places[MIDDLES, j]), film.force_scale * places[MIDDLES, j]
        for a, share in ((0, near), (2, far)):
            loads[a] += share * x
            loads[a + 1] += share * y
            slopes[a, 0] += share * x_0
            slopes[a, 1] += share * x_1
            slopes[a, 2] += share * x_2
            slopes[a, 3] += share * x_3
            slopes[a + 1, 0] += share * y_0
            slopes[a + 1, 1] += share * y_1
            slopes[a + 1, 2] += share * y_2
            slopes[a + 1, 3] += share * y_3
