"""Linear equations around a ring of cells: block-cyclic elimination, compiled for each number of cells.

Equations of a ring of columns of cells, solved by blocks: one dense block per column, compiled.

A column is coupled to its two neighbours cell by cell, so that the off-diagonal blocks are diagonal themselves. The
first columns are eliminated one after the other, with the last one as a border, which closes the ring. Without
pivoting: oil that leaves one cell enters others, so that no diagonal entry is smaller than the others of its column
together, but for what a closing gap takes away and what a law makes. Cheaper than a sparse elimination up to some 40
cells along.

The elimination of block_cyclic.py, called by its address.

Its code is written out for some lengths of columns. A kernel that called it as a function would hold all of that, and
so would each kernel above it: they would take twice as long to compile. Only the length that a film has is compiled.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from frbcli.arrays import Array
from frbcli.compiled import address_of, c_function, call_of, compiled
from frbcli.film.cells.vectors import (
    eliminate_column,
    next_column,
    row_length,
    take_in_border,
    take_in_next,
)

CENTRE, BEFORE, BEHIND, BELOW, ABOVE, ENTRIES = range(6)
# CENTRE of the first cell of a column whose solution nobody asks for: it keeps its right-hand sides. No other feels it.
UNASKED = -np.inf
# Right-hand sides of a film that shares no oil with others: its own, and two for the motion of its journal.
USUAL = (0,) * 3


@compiled(fastmath={"contract", "reassoc"})
def _invert(a: Array, columns: Any) -> None:
    """a (k, k) <- its inverse, by Gauss and Jordan's elimination in place."""
    k = len(columns)
    for p in range(k):
        pivot = 1.0 / a[p, p]
        a[p, p] = 1.0
        for j in range(k):
            a[p, j] *= pivot
        for i in range(k):
            if i != p:
                factor = a[i, p]
                a[i, p] = 0.0
                for j in range(k):
                    a[i, j] -= factor * a[p, j]


@compiled(fastmath={"contract", "reassoc"})
def _product(a: Array, b: Array, to: Array, columns: Any, row: Any) -> None:
    """to (k, n) <- a (k, k) b (k, n)."""
    k, n = len(columns), len(row)
    for i in range(k):
        for c in range(n):
            to[i, c] = 0.0
        for j in range(k):
            factor = a[i, j]
            for c in range(n):
                to[i, c] += factor * b[j, c]


@compiled(fastmath={"contract", "reassoc"})
def _subtract_product(a: Array, diagonal: Array, b: Array, to: Array, columns: Any, row: Any) -> None:
    """to (k, n) -= a (k, k) diag(diagonal) b (k, n)."""
    k, n = len(columns), len(row)
    for i in range(k):
        for j in range(k):
            factor = a[i, j] * diagonal[j]
            if factor != 0.0:  # nothing comes back from a cavitated column
                for c in range(n):
                    to[i, c] -= factor * b[j, c]


@compiled(fastmath={"contract", "reassoc"})
def _fill(stencil: Array, i: int, block: Array, columns: Any) -> None:
    """The first k columns of block (k, n) <- the equations of column i by its own unknowns."""
    k = len(columns)
    for a in range(k):
        for b in range(k):
            block[a, b] = 0.0
        block[a, a] = stencil[CENTRE, i, a]
        if a > 0:
            block[a, a - 1] = stencil[BELOW, i, a]
        if a < k - 1:
            block[a, a + 1] = stencil[ABOVE, i, a]


@compiled()
def answer_all(stencil: Array, fields: Array) -> None:
    """Columns that are UNASKED get equations for solve_blocks, which leave their first right-hand side as it is."""
    m, k = stencil.shape[1], stencil.shape[2]
    for i in range(m):
        if stencil[CENTRE, i, 0] == UNASKED:
            for a in range(k):
                stencil[CENTRE, i, a] = 1.0
                for c in range(k + 1, fields.shape[2]):
                    fields[i, a, c] = 0.0


@compiled(fastmath={"contract", "reassoc"}, makes_arrays=True)
def solve_blocks(stencil: Array, blocks: Array, fields: Array, column: Any, row: Any) -> None:
    """fields (m, k, k + r): its last r layers <- the solutions for them as right-hand sides.

    stencil: (ENTRIES, m, k) entries of the cell itself, of the cells before and behind it around the ring, of those
    below and above it in its column, all arrays in one piece. blocks: (m, k, k) scratch, as are the first k layers of
    fields: what a column takes from the last one, so that both are one product. m >= 3. Not finite where the matrix is
    singular. column, row: anything as long as a column and a row of fields.
    """
    m, k, n = len(blocks), len(column), len(row)
    last, held = m - 1, np.empty((k, n))
    # x_i = right_i - blocks_i behind_i x_i+1 - border_i x_last, border and right side by side
    for i in range(last):
        block = blocks[i]
        _fill(stencil, i, block, column)
        for a in range(k):
            low = stencil[BEFORE, i, a]
            if i == 0:
                for c in range(k):
                    held[a, c] = 0.0
                held[a, a] = low
                for c in range(k, n):
                    held[a, c] = fields[0, a, c]
            else:
                for b in range(k):
                    block[a, b] -= low * blocks[i - 1, a, b] * stencil[BEHIND, i - 1, b]
                for c in range(k):
                    held[a, c] = -low * fields[i - 1, a, c]
                for c in range(k, n):
                    held[a, c] = fields[i, a, c] - low * fields[i - 1, a, c]
        _invert(block, column)
        _product(block, held, fields[i], column, row)
    block = blocks[last]
    _fill(stencil, last, block, column)
    closes = False
    for a in range(k):
        low = stencil[BEFORE, last, a]
        closes = closes or stencil[BEHIND, last, a] != 0.0
        for b in range(k):
            fields[last - 1, a, b] += blocks[last - 1, a, b] * stencil[BEHIND, last - 1, b]
            block[a, b] -= low * fields[last - 1, a, b]
        for c in range(k, n):
            fields[last, a, c] -= low * fields[last - 1, a, c]
    if closes:  # where the last column is cavitated, it does not feel the first
        for i in range(last - 2, -1, -1):
            _subtract_product(blocks[i], stencil[BEHIND, i], fields[i + 1], fields[i], column, row)
        for a in range(k):
            high = stencil[BEHIND, last, a]
            for b in range(k):
                block[a, b] -= high * fields[0, a, b]
            for c in range(k, n):
                fields[last, a, c] -= high * fields[0, a, c]
    _invert(block, column)
    _product(block, fields[last], held, column, row)
    for a in range(k):
        for c in range(k, n):
            fields[last, a, c] = held[a, c]
    for i in range(last - 1, -1, -1):
        for a in range(k):
            for c in range(k, n):
                total = fields[i, a, c]
                for b in range(k):
                    total -= fields[i, a, b] * fields[last, b, c]
                    if not closes and i < last - 1:
                        total -= blocks[i, a, b] * stencil[BEHIND, i, b] * fields[i + 1, b, c]
                held[a, c] = total
        for a in range(k):
            for c in range(k, n):
                fields[i, a, c] = held[a, c]


@compiled(fastmath={"contract", "reassoc"})
def _begin_column(stencil: Array, fields: Array, i: int, rows: Array, column: Any, sides: Any) -> None:
    """rows (k, w) <- the equations of column i by its own unknowns, without a border, and their right-hand sides."""
    k, r = len(column), len(sides)
    _fill(stencil, i, rows, column)
    for a in range(k):
        for c in range(k, row_length(k, r)):
            rows[a, c] = 0.0
        for side in range(r):
            rows[a, 2 * k + side] = fields[i, a, k + side]


@compiled()
def unfelt(stencil: Array, i: int) -> bool:
    """Whether no other column feels the unknowns of column i: a cavity at p_cav that turns with the oil."""
    m, k = stencil.shape[1], stencil.shape[2]
    if stencil[CENTRE, i, 0] == UNASKED:
        return True
    before, behind = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
    a = 0
    while a < k and stencil[BEHIND, before, a] == 0.0 and stencil[BEFORE, behind, a] == 0.0:
        a += 1
    return bool(a == k)


@compiled(fastmath={"contract", "reassoc"}, makes_arrays=True)
def _solve_parted(stencil: Array, fields: Array, cut: int, column: Any, sides: Any) -> None:
    """solve_known of a ring that columns part which are unfelt, column `cut` among them: what stands between two of
    them is solved by itself, without a border; they themselves follow."""
    m, k, r, sizes = stencil.shape[1], len(column), len(sides), (column, sides)
    rows, first, n = np.empty((m, k, row_length(k, r))), 0, 1
    while n < m:
        first = (cut + n) % m
        n += 1
        if unfelt(stencil, first):
            continue
        _begin_column(stencil, fields, first, rows[first], column, sides)
        eliminate_column(rows[first], sizes)
        i, behind = first, (first + 1) % m
        while not unfelt(stencil, behind):
            next_column(
                stencil[CENTRE, behind], stencil[BELOW, behind], stencil[ABOVE, behind], stencil[BEFORE, behind],
                stencil[BEHIND, i], fields[behind], rows[i], rows[behind], sizes,
            )  # fmt: skip
            i, behind, n = behind, (behind + 1) % m, n + 1
        while True:
            for a in range(k):
                for side in range(r):
                    fields[i, a, k + side] = rows[i, a, 2 * k + side]
            if i == first:
                break
            before = i - 1 if i > 0 else m - 1
            take_in_next(stencil[BEHIND, before], rows[i], rows[before], sizes)
            i = before
    for i in range(m):
        if stencil[CENTRE, i, 0] != UNASKED and unfelt(stencil, i):
            _follow_neighbours(stencil, fields, i, rows[i], column, sides)


@compiled(fastmath={"contract", "reassoc"})
def _follow_neighbours(stencil: Array, fields: Array, i: int, rows: Array, column: Any, sides: Any) -> None:
    """The solution in column i, which is unfelt, from its neighbour columns by Thomas' algorithm."""
    m, k, r = stencil.shape[1], len(column), len(sides)
    before, behind, above = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0, rows[0]
    for a in range(k):
        pivot, low, from_before, from_behind = (
            stencil[CENTRE, i, a], stencil[BELOW, i, a], stencil[BEFORE, i, a], stencil[BEHIND, i, a]
        )  # fmt: skip
        if a > 0:
            pivot -= low * above[a - 1]
        above[a] = stencil[ABOVE, i, a] / pivot
        for side in range(k, k + r):
            right = fields[i, a, side]
            if from_before != 0.0 or from_behind != 0.0:  # of a column that is not asked there may be anything
                right = right - from_before * fields[before, a, side] - from_behind * fields[behind, a, side]
            if a > 0:
                right -= low * fields[i, a - 1, side]
            fields[i, a, side] = right / pivot
    for a in range(k - 2, -1, -1):
        for side in range(k, k + r):
            fields[i, a, side] -= above[a] * fields[i, a + 1, side]


@compiled(fastmath={"contract", "reassoc"}, makes_arrays=True)
def solve_known(stencil: Array, fields: Array, column: Any, sides: Any) -> None:
    """Solve the equations of solve_blocks for columns of a length and right-hand sides of a number known to the
    compiler, see vectors.py.

    A column is coupled to the next as x_i = right_i - inverse_i behind_i x_i+1 - border_i x_last. The rows hold
    inverse, border and right of each, the two latter first without and then with what the columns behind it bring.
    """
    m, k, r, sizes = stencil.shape[1], len(column), len(sides), (column, sides)
    for i in range(m):
        if unfelt(stencil, i):
            _solve_parted(stencil, fields, i, column, sides)
            return
    last, rows = m - 1, np.empty((m, k, row_length(k, r)))
    for i in range(0, m, last):
        _begin_column(stencil, fields, i, rows[i], column, sides)
    for a in range(k):
        rows[0, a, k + a] = stencil[BEFORE, 0, a]
    eliminate_column(rows[0], sizes)
    for i in range(1, last):
        next_column(
            stencil[CENTRE, i], stencil[BELOW, i], stencil[ABOVE, i], stencil[BEFORE, i], stencil[BEHIND, i - 1],
            fields[i], rows[i - 1], rows[i], sizes,
        )  # fmt: skip
    for a in range(k):
        for b in range(k):
            rows[last - 1, a, k + b] += rows[last - 1, a, b] * stencil[BEHIND, last - 1, b]
    for i in range(last - 2, -1, -1):
        take_in_next(stencil[BEHIND, i], rows[i + 1], rows[i], sizes)
    for a in range(k):
        low, high = stencil[BEFORE, last, a], stencil[BEHIND, last, a]
        for b in range(k):
            rows[last, a, b] -= low * rows[last - 1, a, k + b] + high * rows[0, a, k + b]
        for side in range(2 * k, 2 * k + r):
            rows[last, a, side] -= low * rows[last - 1, a, side] + high * rows[0, a, side]
    eliminate_column(rows[last], sizes)
    for i in range(last):
        take_in_border(rows[last], rows[i], fields[i], sizes)
    for a in range(k):
        for side in range(r):
            fields[last, a, k + side] = rows[last, a, 2 * k + side]


UNKNOWN_SIDES = 0
TILTED = 5  # right-hand sides of a film whose journal tilts
# Cells along that have code of their own, by the number of right-hand sides.
WRITTEN_OUT = {len(USUAL): (3, 4, 5, 6, 8, 10), TILTED: (4, 5, 6, 8, 10, 12, 14, 16)}
# Placeholders in `_known` for one size: cells along and right-hand sides, as tuples of that length, and their numbers.
COLUMN: tuple[int, ...] = ()
SIDES: tuple[int, ...] = ()
CELLS, LAYERS = 0, 0
_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(*[types.intp] * 3, *[_POINTER] * 3)


def ring_solver(k: int, sides: int = len(USUAL)) -> int:
    """Address of an elimination for columns of k cells with a number of right-hand sides, by default as for a film that
    shares no oil with others."""
    return _address(k, sides) if k in WRITTEN_OUT.get(sides, ()) else _address()


@cache
def _address(k: int = 0, sides: int = 0) -> int:
    """Address of the solver for blocks of one size; without it that of the generic one."""
    made: Any = _any
    if k:
        own = {"COLUMN": (0,) * k, "SIDES": (0,) * sides, "CELLS": k, "LAYERS": k + sides}
        made = FunctionType(_known.__code__, {**globals(), **own})
        made.__qualname__ = f"_known_{k}_{sides}"  # by which numba keeps it
    return address_of(c_function(made, _SIGNATURE, Path(__file__)))


def _any(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    entries, right = carray(stencil, (ENTRIES, m, k)), carray(fields, (m, k, n))
    answer_all(entries, right)
    solve_blocks(entries, carray(blocks, (m, k, k)), right, entries[0, 0], right[0, 0])


def _known(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, CELLS)), carray(fields, (m, CELLS, LAYERS)), COLUMN, SIDES)


def _call_solver(typingctx, address, m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    """An elimination at an address, with arrays in one piece."""
    return types.void(*[types.intp] * 4, stencil, blocks, fields), call_of(3)


_call: Any = intrinsic(_call_solver)


@compiled()
def solve_ring_at(address: int, stencil: Array, blocks: Array, fields: Array) -> None:
    """Call an elimination by the address from ring_solver."""
    m, k, n = fields.shape
    _call(address, m, k, n, stencil, blocks, fields)
