"""The elimination of block_cyclic.py, called by its address.

Its code is written out for some lengths of columns. A kernel that called it as a function would hold all of that, and
so would each kernel above it: they would take twice as long to compile. Only the length that a film has is compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from numba import types
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from frbcli.compiled import Array, address_of, c_function, call_of, compiled
from frbcli.film.cells.elimination.block_cyclic import ENTRIES, USUAL, solve_blocks, solve_known

ANY = 0  # a length that has no code of its own
THREE, FOUR, FIVE, SIX, EIGHT, TEN = (0,) * 3, (0,) * 4, (0,) * 5, (0,) * 6, (0,) * 8, (0,) * 10
_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(*[types.intp] * 3, *[_POINTER] * 3)


def ring_solver(k: int, usual: bool = True) -> int:
    """Address of an elimination for columns of k cells.

    usual: with the right-hand sides of a film that shares no oil with others."""
    return _address(k if usual and k in _LENGTHS else ANY)


@cache
def _address(length: int) -> int:
    return address_of(c_function(_LENGTHS.get(length, _any), _SIGNATURE, Path(__file__)))


def _any(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    entries, right = carray(stencil, (ENTRIES, m, k)), carray(fields, (m, k, n))
    solve_blocks(entries, carray(blocks, (m, k, k)), right, entries[0, 0], right[0, 0])


def _three(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 3)), carray(fields, (m, 3, 6)), THREE, USUAL)


def _four(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 4)), carray(fields, (m, 4, 7)), FOUR, USUAL)


def _five(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 5)), carray(fields, (m, 5, 8)), FIVE, USUAL)


def _six(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 6)), carray(fields, (m, 6, 9)), SIX, USUAL)


def _eight(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 8)), carray(fields, (m, 8, 11)), EIGHT, USUAL)


def _ten(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 10)), carray(fields, (m, 10, 13)), TEN, USUAL)


_LENGTHS: dict[int, Callable[..., None]] = {
    len(THREE): _three,
    len(FOUR): _four,
    len(FIVE): _five,
    len(SIX): _six,
    len(EIGHT): _eight,
    len(TEN): _ten,
}


def _call_solver(typingctx, address, m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    """An elimination at an address, with arrays in one piece."""
    return types.void(*[types.intp] * 4, stencil, blocks, fields), call_of(3)


_call: Any = intrinsic(_call_solver)


@compiled()
def solve_ring_at(address: int, stencil: Array, blocks: Array, fields: Array) -> None:
    """Call an elimination by the address from ring_solver."""
    m, k, n = fields.shape
    _call(address, m, k, n, stencil, blocks, fields)
