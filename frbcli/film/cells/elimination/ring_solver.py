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
from frbcli.film.cells.elimination.block_cyclic import ENTRIES, USUAL, answer_all, solve_blocks, solve_known

UNKNOWN_SIDES = 0
ANY = 0, UNKNOWN_SIDES  # sizes that have no code of their own
THREE, FOUR, FIVE, SIX, EIGHT, TEN = (0,) * 3, (0,) * 4, (0,) * 5, (0,) * 6, (0,) * 8, (0,) * 10
TWELVE, FOURTEEN, SIXTEEN = (0,) * 12, (0,) * 14, (0,) * 16
TILTED = FIVE  # right-hand sides of a film whose journal tilts
_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(*[types.intp] * 3, *[_POINTER] * 3)


def ring_solver(k: int, sides: int = len(USUAL)) -> int:
    """Address of an elimination for columns of k cells with a number of right-hand sides, by default those of a film
    that shares no oil with others."""
    return _address((k, sides) if (k, sides) in _LENGTHS else ANY)


@cache
def _address(size: tuple[int, int]) -> int:
    return address_of(c_function(_LENGTHS.get(size, _any), _SIGNATURE, Path(__file__)))


def _any(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    entries, right = carray(stencil, (ENTRIES, m, k)), carray(fields, (m, k, n))
    answer_all(entries, right)
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


def _four_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 4)), carray(fields, (m, 4, 9)), FOUR, TILTED)


def _five_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 5)), carray(fields, (m, 5, 10)), FIVE, TILTED)


def _six_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 6)), carray(fields, (m, 6, 11)), SIX, TILTED)


def _eight_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 8)), carray(fields, (m, 8, 13)), EIGHT, TILTED)


def _ten_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 10)), carray(fields, (m, 10, 15)), TEN, TILTED)


def _twelve_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 12)), carray(fields, (m, 12, 17)), TWELVE, TILTED)


def _fourteen_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 14)), carray(fields, (m, 14, 19)), FOURTEEN, TILTED)


def _sixteen_tilted(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_known(carray(stencil, (ENTRIES, m, 16)), carray(fields, (m, 16, 21)), SIXTEEN, TILTED)


_LENGTHS: dict[tuple[int, int], Callable[..., None]] = {
    (len(THREE), len(USUAL)): _three,
    (len(FOUR), len(USUAL)): _four,
    (len(FIVE), len(USUAL)): _five,
    (len(SIX), len(USUAL)): _six,
    (len(EIGHT), len(USUAL)): _eight,
    (len(TEN), len(USUAL)): _ten,
    (len(FOUR), len(TILTED)): _four_tilted,
    (len(FIVE), len(TILTED)): _five_tilted,
    (len(SIX), len(TILTED)): _six_tilted,
    (len(EIGHT), len(TILTED)): _eight_tilted,
    (len(TEN), len(TILTED)): _ten_tilted,
    (len(TWELVE), len(TILTED)): _twelve_tilted,
    (len(FOURTEEN), len(TILTED)): _fourteen_tilted,
    (len(SIXTEEN), len(TILTED)): _sixteen_tilted,
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
