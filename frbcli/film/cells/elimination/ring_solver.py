"""The elimination of block_cyclic.py, called by its address.

Its code is written out for some lengths of columns. A kernel that called it as a function would hold all of that, and
so would each kernel above it: they would take twice as long to compile. Only the length that a film has is compiled.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

from numba import types
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from frbcli.arrays import Array
from frbcli.compiled import address_of, c_function, call_of, compiled
from frbcli.film.cells.elimination.block_cyclic import ENTRIES, USUAL, answer_all, solve_blocks, solve_known

UNKNOWN_SIDES = 0
TILTED = 5  # right-hand sides of a film whose journal tilts
# Cells along that have code of their own, by the number of right-hand sides.
WRITTEN_OUT = {len(USUAL): (3, 4, 5, 6, 8, 10), TILTED: (4, 5, 6, 8, 10, 12, 14, 16)}
# Stand in `_known` for those of one size: cells along and right-hand sides, as tuples of as many, and their numbers.
COLUMN: tuple[int, ...] = ()
SIDES: tuple[int, ...] = ()
CELLS, LAYERS = 0, 0
_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(*[types.intp] * 3, *[_POINTER] * 3)


def ring_solver(k: int, sides: int = len(USUAL)) -> int:
    """Address of an elimination for columns of k cells with a number of right-hand sides, by default those of a film
    that shares no oil with others."""
    return _address(k, sides) if k in WRITTEN_OUT.get(sides, ()) else _address()


@cache
def _address(k: int = 0, sides: int = 0) -> int:
    """Of one size, or by default of all that have no code of their own."""
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
