"""Forces at ports compiled: each law by itself, called by its address, so that no loop is compiled anew for a law."""

from __future__ import annotations

import ctypes
import inspect
from collections import namedtuple
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic
from numba.np.numpy_support import carray
from numba.np.unsafe import ndarray

from frbcli.arrays import Array
from frbcli.compiled import address_of, c_function, call_of, compiled, jitted
from frbcli.rotor.port import ANSWER, F_X, F_Y, MOTION, TORQUE, ForceLaw, by_differences, keys_of

_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(types.intp, types.intp, *[_POINTER] * 4)
_DOUBLES = ctypes.POINTER(ctypes.c_double)
_SHIPPED = "frbcli."
_first: Any = ndarray.to_fixed_tuple  # the first numbers of an array as a tuple
# In the templates below the function of one law, its fields and their number.
force: Any = ForceLaw.force
Fields: Any = None
COUNT = 0


@cache
def compiled_force(law: type[ForceLaw]) -> Any:
    """The C function of a law: of a shipped one kept on disk until its file changes."""
    shipped = law.__module__.startswith(_SHIPPED)
    file = inspect.getfile(law) if shipped else __file__
    template, body = (_force, law.force) if law.has_derivatives() else (_pushed, law.push)
    code = template.__code__.replace(co_filename=file)
    shared = {"force": jitted(body)}
    if not law.has_derivatives():
        names = tuple(keys_of(law))
        shared |= {"by_differences": jitted(by_differences), "Fields": namedtuple("Fields", names), "COUNT": len(names)}
    function = FunctionType(code, {**globals(), **shared})
    function.__module__ = law.__module__ if shipped else __name__
    function.__qualname__ = f"{law.__qualname__}.{template.__name__}"
    return c_function(function, _SIGNATURE, *((Path(file), Path(__file__)) if shipped else ()))


def evaluate(law: ForceLaw, motion: Array) -> Array:
    """(ANSWER,) the force of a law at a motion (MOTION,), see port.py."""
    answer, numbers, memory = np.zeros(ANSWER), law.parameters, law.memory.copy()
    arrays = (each.ctypes.data_as(_DOUBLES) for each in (numbers, memory, np.ascontiguousarray(motion), answer))
    compiled_force(type(law)).ctypes(len(numbers), len(memory), *arrays)
    return answer


def evaluate_along(law: ForceLaw, motions: Array) -> tuple[Array, Array]:
    """(k, 3) force in N and torque in N m of a law at motions (k, MOTION) that follow each other, and (k, w) what it
    has left."""
    address, memory = address_of(compiled_force(type(law))), law.memory.copy()
    forces, left = np.empty((len(motions), 3)), np.empty((len(motions), len(memory)))
    _forces(address, law.parameters, memory, np.ascontiguousarray(motions), np.zeros(ANSWER), forces, left)
    return forces, left


def _call_force(typingctx, address, parameters, kept, numbers, memory, motion, answer):  # type: ignore[no-untyped-def]
    """The C function of a law at an address, with arrays in one piece of so many parameters and numbers that it
    keeps."""
    given = (types.intp, types.intp, types.intp, numbers, memory, motion, answer)
    return types.void(*given), call_of(2)


call_force: Any = intrinsic(_call_force)


@compiled()
def _forces(
    address: int, numbers: Array, memory: Array, motions: Array, answer: Array, forces: Array, left: Array
) -> None:
    for k in range(len(motions)):
        # what a law leaves lies an iteration behind its force: again, so that it does not depend on where it began
        for _ in range(2 if len(memory) > 0 else 1):
            call_force(address, len(numbers), len(memory), numbers, memory, motions[k], answer)
        forces[k, 0], forces[k, 1], forces[k, 2] = answer[F_X], answer[F_Y], answer[TORQUE]
        for i in range(len(memory)):
            left[k, i] = memory[i]


def _force(parameters, kept, numbers, memory, motion, answer):  # type: ignore[no-untyped-def]
    """A law, whose function replaces force."""
    force(carray(numbers, (parameters,)), carray(memory, (kept,)), carray(motion, (MOTION,)), carray(answer, (ANSWER,)))


def _pushed(parameters, kept, numbers, memory, motion, answer):  # type: ignore[no-untyped-def]
    """A law without derivatives, whose function stands for force: its fields, and behind them its length."""
    given = carray(numbers, (COUNT + 1,))
    law = Fields(*_first(given, COUNT))
    by_differences(force, law, given[COUNT], carray(motion, (MOTION,)), carray(answer, (ANSWER,)))
