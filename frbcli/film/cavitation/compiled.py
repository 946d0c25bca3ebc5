"""The laws compiled, each by itself, and how a compiled film calls one that it does not know.

A film holds the addresses of two functions of its law, which numba makes from `cell`, `follow` and `empty` (law.py). So
the kernels of films are compiled once for all laws, also for those that a user adds, and compiled code of a law exists
in its own functions only. Numba keeps these next to the file of a shipped law, until that file changes; a user's law is
compiled anew in every process, since it may call code of other files. """

from __future__ import annotations

import ctypes
import inspect
from dataclasses import fields
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import intrinsic
from numba.np.numpy_support import carray
from numba.np.unsafe import ndarray

from frbcli.arrays import Array
from frbcli.compiled import address_of, c_function, call_of, compiled, jitted
from frbcli.film.cavitation import penalty
from frbcli.film.cavitation.law import CellState, Law, Scales
from frbcli.film.cavitation.table import LARGEST_PARAMETERS, SHIPPED

# What a film keeps of its law while its journal moves: the parameters, and w below which a cell is empty.
EMPTY = LARGEST_PARAMETERS
LAW_NUMBERS = LARGEST_PARAMETERS + 1
ECCENTRICITY, SPEED, WHIRL, MOTION = range(4)  # what a law may follow
STATES = 6  # of a cell, see Law.cell
# Behind them stand the two parameters of a cell whose oil carries gas, and two more results, see Law.cell.
CARRIED_GAS, TURNOVER, FREE_GAS, PASSED_ON, LAYERS = 6, 7, 8, 9, 10

_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_FOLLOW = types.void(_POINTER, _POINTER, _POINTER, _POINTER)
_CELLS = types.void(types.intp, _POINTER, _POINTER, _POINTER, _POINTER)
_DOUBLES = ctypes.POINTER(ctypes.c_double)
_first: Any = ndarray.to_fixed_tuple  # the first numbers of an array as a tuple
# Placeholders in the templates below for the functions of one law.
cell: Any = Law.cell
follow, empty, COUNT, GAS = Law.follow, Law.empty, 1, False


class CompiledLaw(NamedTuple):
    """C functions of a law. follow(given, motion, scales, law) fills law (LAW_NUMBERS,) from the parameters of the
    centred journal; cells(n, law, scales, w, states) fills the first six of
    states (LAYERS, n) of the unknowns w (n,), and FREE_GAS and PASSED_ON of a law that carries gas."""

    follow: Any
    cells: Any


@cache
def compiled_law(law: Any) -> CompiledLaw:
    """The functions of a law, compiled in this process or found where numba keeps them."""
    shared = {"COUNT": max(len(fields(law)), 1), "GAS": law.carries_gas, "cell": compiled_cell(law)}
    shared |= {name: jitted(getattr(law, name)) for name in ("follow", "empty")}
    return CompiledLaw(_for_law(law, _follow, _FOLLOW, shared), _for_law(law, _cells, _CELLS, shared))


def compiled_cell(law: type[Law]) -> Any:
    """`cell` of a law for kernels that are made for this law alone."""
    return jitted(law.cell, force_inline=True)


def addresses(law: Law) -> tuple[int, int]:
    """Addresses of follow and cells of a law."""
    kind: Any = type(law)
    follow, cells = (address_of(function) for function in compiled_law(kind))
    return follow, cells


def given_parameters(law: Law) -> np.ndarray[Any, np.dtype[np.float64]]:
    """(LARGEST_PARAMETERS,) parameters of a law, filled up with zeros."""
    parameters = np.zeros(LARGEST_PARAMETERS)
    parameters[: len(law.parameters)] = law.parameters
    return parameters


def compiled_cells(law: Law, w: Array, scales: Scales, carried: Array | float, turnover: Array | float) -> CellState:
    """See Law.cells."""
    unknowns = np.ascontiguousarray(w, dtype=np.float64)
    numbers, pressures, states = given_parameters(law), np.array(scales), np.zeros((LAYERS, *unknowns.shape))
    states[CARRIED_GAS], states[TURNOVER] = carried, turnover
    arrays = (array.ctypes.data_as(_DOUBLES) for array in (numbers, pressures, unknowns, states))
    kind: Any = type(law)
    compiled_law(kind).cells.ctypes(unknowns.size, *arrays)
    return CellState(*states[:STATES])


def _call_follow(typingctx, address, given, motion, scales, law):  # type: ignore[no-untyped-def]
    """CompiledLaw.follow at an address, with arrays in one piece."""
    return types.void(types.intp, given, motion, scales, law), call_of(0)


def _call_cells(typingctx, address, n, law, scales, w, states):  # type: ignore[no-untyped-def]
    """CompiledLaw.cells at an address, with arrays in one piece."""
    return types.void(types.intp, types.intp, law, scales, w, states), call_of(1)


call_follow: Any = intrinsic(_call_follow)
call_cells: Any = intrinsic(_call_cells)


def _follow(given, motion, scales, law):  # type: ignore[no-untyped-def]
    """CompiledLaw.follow of the law whose functions replace follow and empty."""
    at, pressures, out = carray(motion, (MOTION,)), carray(scales, (3,)), carray(law, (LAW_NUMBERS,))
    parameters = follow(_first(carray(given, (COUNT,)), COUNT), at[ECCENTRICITY], at[SPEED], at[WHIRL])
    for i in range(COUNT):
        out[i] = parameters[i]
    out[EMPTY] = empty(parameters, Scales(pressures[0], pressures[1], pressures[2]))


def _cells(n, law, scales, w, states):  # type: ignore[no-untyped-def]
    """CompiledLaw.cells of the law whose function replaces cell."""
    parameters, pressures = _first(carray(law, (COUNT,)), COUNT), carray(scales, (3,))
    at = Scales(pressures[0], pressures[1], pressures[2])
    unknowns, out = carray(w, (n,)), carray(states, (LAYERS, n))
    for i in range(n):
        if GAS:
            own = (*parameters, out[CARRIED_GAS, i], out[TURNOVER, i])
            out[0, i], out[1, i], out[2, i], out[3, i], out[4, i], out[5, i], free, passed = cell(unknowns[i], own, at)
            out[FREE_GAS, i], out[PASSED_ON, i] = free, passed
        else:
            out[0, i], out[1, i], out[2, i], out[3, i], out[4, i], out[5, i] = cell(unknowns[i], parameters, at)


def _for_law(law: type[Law], template: Any, signature: Any, shared: dict[str, Any]) -> Any:
    """A template compiled with the functions of a law, as if it stood in the file of the law."""
    shipped = law in SHIPPED
    file = inspect.getfile(law) if shipped else __file__
    code = template.__code__.replace(co_filename=file)
    function = FunctionType(code, {**globals(), **shared})
    function.__module__ = law.__module__ if shipped else __name__
    function.__qualname__ = f"{law.__qualname__}.{template.__name__}"
    return c_function(function, signature, *((Path(file), Path(__file__)) if shipped else ()))


wright_omega = compiled(inline=True)(penalty.wright_omega)
