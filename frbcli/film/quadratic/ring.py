"""Factors of a matrix on a ring of columns of quadratic elements, compiled: symmetric, positive definite, no pivoting.

Element columns lie between node lines 2 i. Condensed away in this order: the middle node of each element, the nodes on
the middle line of each column, line after line around the ring; line 0 is the border that all of them keep to the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from frbcli.film.grid import Array

FOUR = 4  # rows are subtracted four at a time, so that what they are subtracted from is loaded and stored once
LANES = 8  # rows are as long as the processor's vectors divide
# Local nodes 3 p + q of an upper triangle of 9 x 9, row after row, and the place of (a, b) in it.
ROW, COLUMN = (np.ascontiguousarray(part) for part in np.triu_indices(9))
PLACE = np.zeros((9, 9), dtype=np.int64)
PLACE[ROW, COLUMN] = PLACE[COLUMN, ROW] = np.arange(45)


class Ring(NamedTuple):
    """Room for the factors. around, along: elements; unknowns: n of each line, from its second node on; padded: that, a
    multiple of four; centre (e, 9): couplings of the middle node, its inverse pivot in place of its own; crossing
    (a, p, 2 N): rows of the middle lines, onto both lines beside them; pivot, next (a, p): inverse pivots of those and
    couplings to the next; lines (a, N, W): rows of the lines onto themselves, the next and line 0; inverse (a, N): of
    their pivots; front (3 N, W): what is being eliminated."""

    around: int
    along: int
    unknowns: int
    padded: int
    centre: Array
    crossing: Array
    pivot: Array
    next: Array
    lines: Array
    inverse: Array
    front: Array


def make_ring(around: int, along: int, free_end: bool) -> Ring:
    """Room for around x along elements; free_end: whether z = 1 is a plane of symmetry, with unknown pressure."""
    unknowns = 2 * along - 1 + int(free_end)
    padded = -(-unknowns // FOUR) * FOUR
    middles = -(-(unknowns // 2) // FOUR) * FOUR
    width = -(-3 * padded // LANES) * LANES
    return Ring(
        around,
        along,
        unknowns,
        padded,
        np.zeros((around * along, 9)),
        np.zeros((around, middles, 2 * padded)),
        np.zeros((around, middles)),
        np.zeros((around, middles)),
        np.zeros((around, padded, width)),
        np.zeros((around, padded)),
        np.zeros((3 * padded, width)),
    )


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def factorise(ring: Ring, stiff: Array) -> None:
    """Fill the ring from the upper triangles (e, 45) of the element matrices, which are overwritten.

    A node with a given pressure has a diagonal entry and no other.
    """
    n, padded, last = ring.unknowns, ring.padded, ring.around - 1
    front = ring.front
    width = front.shape[1]
    for u in range(3 * padded):
        for c in range(width):
            front[u, c] = 0.0
    for u in range(n, padded):
        front[u, u] = 1.0
    for i in range(last + 1):
        left = 2 * padded if i == 0 else 0
        right = 0 if i == 0 else padded if i < last else 2 * padded
        _add_column(ring, stiff, i, left, right)
        if i == 0:
            continue
        _eliminate(front, ring.inverse[i], padded, 3 * padded)
        for u in range(padded):
            for c in range(width):
                ring.lines[i, u, c] = front[u, c]
        for u in range(padded):
            for c in range(padded):
                front[u, c] = front[padded + u, padded + c]
                front[u, padded + c] = 0.0
                front[u, 2 * padded + c] = front[padded + u, 2 * padded + c]
            for c in range(3 * padded):
                front[padded + u, c] = 0.0
        for u in range(n, padded):
            front[u, u] = 1.0
    for u in range(padded):
        for c in range(padded):
            front[u, c] = front[2 * padded + u, 2 * padded + c]
    for u in range(n, padded):
        front[u, u] = 1.0
    _eliminate(front, ring.inverse[0], padded, padded)
    for u in range(padded):
        for c in range(padded):
            ring.lines[0, u, c] = front[u, c]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _eliminate(front, inverse, pivots, size):  # type: ignore[no-untyped-def]
    """Eliminate the first pivots of the size x size upper triangle in front; inverse (pivots,) of the pivots."""
    width = front.shape[1] if size > pivots else size
    for p in range(0, pivots, FOUR):
        for r in range(p, p + FOUR):
            inverse[r] = 1.0 / front[r, r]
            for q in range(r + 1, p + FOUR):
                share = front[r, q] * inverse[r]
                for c in range(q, width):
                    front[q, c] -= share * front[r, c]
        i0, i1, i2, i3 = inverse[p], inverse[p + 1], inverse[p + 2], inverse[p + 3]
        for q in range(p + FOUR, size, 2):
            f0, f1, f2, f3 = front[p, q] * i0, front[p + 1, q] * i1, front[p + 2, q] * i2, front[p + 3, q] * i3
            g0, g1 = front[p, q + 1] * i0, front[p + 1, q + 1] * i1
            g2, g3 = front[p + 2, q + 1] * i2, front[p + 3, q + 1] * i3
            for c in range(q, width):
                a0, a1, a2, a3 = front[p, c], front[p + 1, c], front[p + 2, c], front[p + 3, c]
                front[q, c] -= f0 * a0 + f1 * a1 + f2 * a2 + f3 * a3
                front[q + 1, c] -= g0 * a0 + g1 * a1 + g2 * a2 + g3 * a3


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _add_column(ring, stiff, i, left, right):  # type: ignore[no-untyped-def]
    """Add column i of elements to the front, whose rows from left and right on are the lines beside it.

    The couplings of the two lines lie in the rows of the one that comes first.
    """
    n, k, padded = ring.unknowns, ring.along, ring.padded
    front = ring.front
    rows, pivot, following = ring.crossing[i], ring.pivot[i], ring.next[i]
    middles = n // 2
    for m in range(len(pivot)):
        pivot[m] = following[m] = 0.0
        for c in range(2 * padded):
            rows[m, c] = 0.0
    for j in range(k):
        s, centre = stiff[i * k + j], ring.centre[i * k + j]
        for a in range(9):
            centre[a] = s[PLACE[4, a]]
        inverse = 1.0 / centre[4]
        centre[4] = inverse
        for entry in range(45):
            s[entry] -= centre[ROW[entry]] * centre[COLUMN[entry]] * inverse
        first, end, u = (1 if j == 0 else 0), min(3, n + 1 - 2 * j), 2 * j - 1
        for a in range(first, end):
            for b in range(a, end):
                front[left + u + a, left + u + b] += s[PLACE[a, b]]
                front[right + u + a, right + u + b] += s[PLACE[6 + a, 6 + b]]
            for b in range(first, end):
                if left < right:
                    front[left + u + a, right + u + b] += s[PLACE[a, 6 + b]]
                else:
                    front[right + u + a, left + u + b] += s[PLACE[6 + a, b]]
        for side in range(2):  # the nodes of the middle line at the element's lower and upper edge
            m, own = j - 1 + side, 3 + 2 * side
            if 0 <= m < middles:
                pivot[m] += s[PLACE[own, own]]
                for a in range(first, end):
                    rows[m, u + a] += s[PLACE[own, a]]
                    rows[m, padded + u + a] += s[PLACE[own, 6 + a]]
        if 0 < j < middles:
            following[j - 1] = s[PLACE[3, 5]]
    for m in range(middles):
        pivot[m] = 1.0 / pivot[m]
        if m + 1 < middles:
            share = following[m] * pivot[m]
            pivot[m + 1] -= share * following[m]
            for c in range(2 * padded):
                rows[m + 1, c] -= share * rows[m, c]
    for m in range(0, middles, FOUR):
        reach = min(padded, 2 * (m + FOUR) + 2)  # the nodes up to the edge of the last of these four
        upper, lower = (left, 0), (right, padded)
        if left > right:
            upper, lower = lower, upper
        _subtract_four(front, rows, pivot, m, upper, upper, reach)
        _subtract_four(front, rows, pivot, m, upper, lower, reach)
        _subtract_four(front, rows, pivot, m, lower, lower, reach)


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _subtract_four(front, rows, pivot, m, line, other, reach):  # type: ignore[no-untyped-def]
    """Take four nodes of a middle line, from m on, out of the block of two lines, each (place in front, in rows)."""
    row, own = line
    column, beside = other
    for u in range(0, reach, 2):
        f0, f1 = rows[m, own + u] * pivot[m], rows[m + 1, own + u] * pivot[m + 1]
        f2, f3 = rows[m + 2, own + u] * pivot[m + 2], rows[m + 3, own + u] * pivot[m + 3]
        g0, g1 = rows[m, own + u + 1] * pivot[m], rows[m + 1, own + u + 1] * pivot[m + 1]
        g2, g3 = rows[m + 2, own + u + 1] * pivot[m + 2], rows[m + 3, own + u + 1] * pivot[m + 3]
        for c in range(u if row == column else 0, reach):
            a0, a1 = rows[m, beside + c], rows[m + 1, beside + c]
            a2, a3 = rows[m + 2, beside + c], rows[m + 3, beside + c]
            front[row + u, column + c] -= f0 * a0 + f1 * a1 + f2 * a2 + f3 * a3
            front[row + u + 1, column + c] -= g0 * a0 + g1 * a1 + g2 * a2 + g3 * a3
