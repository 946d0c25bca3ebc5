"""The elimination of block_cyclic.py, called by its address.

Its code is written out for many lengths of columns. A kernel that called it as a function would hold all of that, and
so would each kernel above it: they would take twice as long to compile.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from numba import types
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from frbcli.compiled import Array, address_of, c_function, call_of, compiled
from frbcli.film.cells.block_cyclic import ENTRIES, solve_ring

_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(*[types.intp] * 3, *[_POINTER] * 3)


@cache
def ring_solver() -> float:
    """The address of solve_ring, as a number of a film."""
    return address_of(c_function(_solve, _SIGNATURE, Path(__file__)))


def _solve(m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    solve_ring(carray(stencil, (ENTRIES, m, k)), carray(blocks, (m, k, k)), carray(fields, (m, k, n)))


def _call_solver(typingctx, address, m, k, n, stencil, blocks, fields):  # type: ignore[no-untyped-def]
    """solve_ring at an address, with arrays in one piece."""
    return types.void(*[types.intp] * 4, stencil, blocks, fields), call_of(3)


_call: Any = intrinsic(_call_solver)


@compiled()
def solve_ring_at(address: float, stencil: Array, blocks: Array, fields: Array) -> None:
    """solve_ring, of the address that ring_solver tells."""
    m, k, n = fields.shape
    _call(int(address), m, k, n, stencil, blocks, fields)
