"""Equations of a ring of columns of quadratic elements without symmetry, solved column by column, compiled.

Eliminated in this order: the middle node of each element, the middle line of each column, then the lines between the
columns one after the other, line 0 being the border that closes the ring. Without pivoting between the blocks: the
artificial diffusion keeps their diagonals large.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from frbcli.compiled import compiled
from frbcli.film.grid import Array

# Local node 3 p + q at line p and place q of an element, without the middle one.
FOUR = 4  # rows that are subtracted at once
OUTER = np.array([0, 1, 2, 3, 5, 6, 7, 8])


class Block(NamedTuple):
    """Equations of which the first are eliminated: own (m, m), ahead (m, c) their rows; below (n, m), rest (n, c) the
    others; pivot (m,): scratch. Blocks of their own, so that the compiler sees that none is another."""

    own: Array
    ahead: Array
    below: Array
    rest: Array
    pivot: Array


class RingLines(NamedTuple):
    """Room for the elimination of a x k elements with r right-hand sides, n = 2 k + 1, m = k + 1.

    middle (a, m, 2 n + r), lines (a, n, 2 n + r): the middle lines by both lines beside them, the lines by the next one
    and line 0; column, front: what is being eliminated.
    """

    middle: Array
    lines: Array
    column: Block
    front: Block


@register_jitable
def make_ring(around: int, along: int, rights: int) -> RingLines:
    """Room for around (>= 3) x along elements and a number of right-hand sides."""
    n, m = 2 * along + 1, along + 1
    width = 2 * n + rights
    column, front = _block(m, 2 * n, width), _block(n, 2 * n, width)
    return RingLines(np.zeros((around, m, width)), np.zeros((around, n, width)), column, front)


@register_jitable
def _block(pivots: int, others: int, width: int) -> Block:
    return Block(
        np.zeros((pivots, pivots)),
        np.zeros((pivots, width)),
        np.zeros((others, pivots)),
        np.zeros((others, width)),
        np.zeros(pivots),
    )


@compiled()
def solve_ring(ring: RingLines, matrix: Array, right: Array, solution: Array) -> None:
    """solution (2 a, n, r) of the elements' matrices (e, 9, 9) and right-hand sides (e, 9, r), both overwritten.

    A node with a given value has a diagonal entry, and no other in its row. Not finite where a pivot vanishes.
    """
    around, n = ring.lines.shape[:2]
    m, rights = ring.middle.shape[1], right.shape[2]
    front, column = ring.front, ring.column
    front.own[:, :] = 0.0
    front.ahead[:, :] = 0.0
    front.below[:, :] = 0.0
    front.rest[:, :] = 0.0
    for i in range(around):
        _condense_centres(matrix, right, i, m - 1)
        _fill_column(matrix, right, i, column, m, n)
        _eliminate(column, ring.middle, i)
        if i == 0:
            _begin(column.rest, front, n)
        else:
            _add(column.rest, front, n, i == around - 1)
            _eliminate(front, ring.lines, i)
            _advance(front, n)
    # Line 0, whose rows are the last ones
    for u in range(n):
        for v in range(n):
            front.own[u, v] = front.rest[n + u, n + v]
        for s in range(rights):
            front.ahead[u, 2 * n + s] = front.rest[n + u, 2 * n + s]
    invert(front.own, front.pivot)
    for s in range(rights):
        for u in range(n):
            total = 0.0
            for v in range(n):
                total += front.own[u, v] * front.ahead[v, 2 * n + s]
            solution[0, u, s] = total
        for i in range(around - 1, 0, -1):
            following = 2 * (i + 1) if i < around - 1 else 0
            for u in range(n):
                total = ring.lines[i, u, 2 * n + s]
                for v in range(n):
                    total -= ring.lines[i, u, n + v] * solution[0, v, s]
                    if following > 0:
                        total -= ring.lines[i, u, v] * solution[following, v, s]
                solution[2 * i, u, s] = total
        for i in range(around):
            behind = (2 * i + 2) % (2 * around)
            for u in range(m):
                total = ring.middle[i, u, 2 * n + s]
                for v in range(n):
                    total -= ring.middle[i, u, v] * solution[2 * i, v, s]
                    total -= ring.middle[i, u, n + v] * solution[behind, v, s]
                solution[2 * i + 1, 2 * u, s] = total
            _substitute_centres(matrix, right, solution, i, s, m - 1)


@compiled(fastmath={"contract", "reassoc"})
def _condense_centres(matrix: Array, right: Array, i: int, along: int) -> None:
    """The middle nodes of column i out of the equations of the others; their rows are divided by the pivots."""
    for e in range(i * along, (i + 1) * along):
        inverse = 1.0 / matrix[e, 4, 4]
        for b in range(9):
            matrix[e, 4, b] *= inverse
        for s in range(right.shape[2]):
            right[e, 4, s] *= inverse
        for a in range(9):
            share = matrix[e, a, 4]
            if a != 4 and share != 0.0:
                for b in range(9):
                    matrix[e, a, b] -= share * matrix[e, 4, b]
                for s in range(right.shape[2]):
                    right[e, a, s] -= share * right[e, 4, s]


@compiled()
def _fill_column(matrix: Array, right: Array, i: int, column: Block, m: int, n: int) -> None:
    """The equations of column i: those of its middle line are to be eliminated from those of the lines beside it."""
    along, rights = m - 1, right.shape[2]
    column.own[:, :] = 0.0
    column.ahead[:, :] = 0.0
    column.below[:, :] = 0.0
    column.rest[:, :] = 0.0
    for j in range(along):
        e = i * along + j
        for a in OUTER:
            p, row = a // 3, _place(a, j, n)
            for b in OUTER:
                q, at = b // 3, _place(b, j, n)
                if p == 1 and q == 1:
                    column.own[row, at] += matrix[e, a, b]
                elif p == 1:
                    column.ahead[row, at] += matrix[e, a, b]
                elif q == 1:
                    column.below[row, at] += matrix[e, a, b]
                else:
                    column.rest[row, at] += matrix[e, a, b]
            to = column.ahead if p == 1 else column.rest
            for s in range(rights):
                to[row, 2 * n + s] += right[e, a, s]


@compiled()
def _place(a: int, j: int, n: int) -> int:
    """Place of the local node a of element j on the middle line, or on the two lines beside it."""
    p, q = a // 3, a % 3
    if p == 1:
        return j + q // 2
    return (n if p == 2 else 0) + 2 * j + q


@compiled()
def _begin(rest: Array, front: Block, n: int) -> None:
    """The front is line 1 between column 0 and the next one, beside the border, from the rows of column 0."""
    rights = rest.shape[1] - 2 * n
    for u in range(n):
        for v in range(n):
            front.rest[n + u, n + v] = rest[u, v]
            front.below[n + u, v] = rest[u, n + v]
            front.ahead[u, n + v] = rest[n + u, v]
            front.own[u, v] = rest[n + u, n + v]
        for s in range(rights):
            front.rest[n + u, 2 * n + s] = rest[u, 2 * n + s]
            front.ahead[u, 2 * n + s] = rest[n + u, 2 * n + s]


@compiled()
def _add(rest: Array, front: Block, n: int, closing: bool) -> None:
    """Add the rows of a column, behind which the border comes where it closes the ring."""
    rights, behind = rest.shape[1] - 2 * n, n if closing else 0
    for u in range(n):
        for v in range(n):
            front.own[u, v] += rest[u, v]
            front.ahead[u, behind + v] += rest[u, n + v]
            front.below[behind + u, v] += rest[n + u, v]
            front.rest[behind + u, behind + v] += rest[n + u, n + v]
        for s in range(rights):
            front.ahead[u, 2 * n + s] += rest[u, 2 * n + s]
            front.rest[behind + u, 2 * n + s] += rest[n + u, 2 * n + s]


@compiled()
def _advance(front: Block, n: int) -> None:
    """The next line becomes the current one."""
    width = front.rest.shape[1]
    for u in range(n):
        for v in range(n):
            front.own[u, v] = front.rest[u, v]
            front.below[u, v] = 0.0
            front.below[n + u, v] = front.rest[n + u, v]
            front.ahead[u, v] = 0.0
            front.rest[n + u, v] = 0.0
        for c in range(n, width):
            front.ahead[u, c] = front.rest[u, c]
        for c in range(width):
            front.rest[u, c] = 0.0


@compiled()
def _eliminate(block: Block, kept: Array, i: int) -> None:
    """kept[i] <- own^-1 ahead, and rest less what that takes from it."""
    invert(block.own, block.pivot)
    values = kept[i]
    values[:, :] = 0.0
    subtract_product(block.own, block.ahead, values)
    for u in range(values.shape[0]):
        for c in range(values.shape[1]):
            values[u, c] = -values[u, c]
    subtract_product(block.below, values, block.rest)


@compiled()
def _substitute_centres(matrix: Array, right: Array, solution: Array, i: int, s: int, along: int) -> None:
    """The values at the odd places of the middle line of column i."""
    lines = solution.shape[0]
    for j in range(along):
        e = i * along + j
        total = right[e, 4, s]
        for a in OUTER:
            total -= matrix[e, 4, a] * solution[(2 * i + a // 3) % lines, 2 * j + a % 3, s]
        solution[2 * i + 1, 2 * j + 1, s] = total




@compiled(fastmath={"contract"})
def invert(a: Array, pivot: Array) -> None:
    """a (k, k) <- its inverse, by Gauss and Jordan's elimination in place; pivot (k,) is overwritten."""
    k = a.shape[0]
    for p in range(k):
        inverse = 1.0 / a[p, p]
        a[p, p] = 1.0
        for j in range(k):
            a[p, j] *= inverse
            pivot[j] = a[p, j]
        for i in range(k):
            factor = a[i, p]
            if i != p and factor != 0.0:
                a[i, p] = 0.0
                for j in range(k):
                    a[i, j] -= factor * pivot[j]


@compiled(fastmath={"contract"})
def subtract_product(a: Array, b: Array, rest: Array) -> None:
    """rest (m, n) <- rest - a (m, k) b (k, n), four rows of b into two rows at once."""
    rows, k = a.shape
    n, whole, paired = b.shape[1], k - k % FOUR, rows - rows % 2
    for i in range(0, paired, 2):
        for j in range(0, whole, FOUR):
            s0, s1, s2, s3 = a[i, j], a[i, j + 1], a[i, j + 2], a[i, j + 3]
            t0, t1, t2, t3 = a[i + 1, j], a[i + 1, j + 1], a[i + 1, j + 2], a[i + 1, j + 3]
            for c in range(n):
                b0, b1, b2, b3 = b[j, c], b[j + 1, c], b[j + 2, c], b[j + 3, c]
                rest[i, c] -= s0 * b0 + s1 * b1 + s2 * b2 + s3 * b3
                rest[i + 1, c] -= t0 * b0 + t1 * b1 + t2 * b2 + t3 * b3
        for j in range(whole, k):
            s0, t0 = a[i, j], a[i + 1, j]
            for c in range(n):
                rest[i, c] -= s0 * b[j, c]
                rest[i + 1, c] -= t0 * b[j, c]
    for i in range(paired, rows):
        for j in range(k):
            s0 = a[i, j]
            for c in range(n):
                rest[i, c] -= s0 * b[j, c]
