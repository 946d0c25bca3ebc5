"""Plain functions compiled by numba: those that cavitation laws and bearing models are made of."""

from __future__ import annotations

from types import FunctionType
from typing import Any

from numba import njit


def jitted(function: Any, force_inline: bool = False) -> Any:
    """A plain function as numba takes it, with every plain function of its module that it calls; others as they are.

    force_inline: put into the machine code of its callers, so that a loop over it can run on the vector units.
    """
    if not _is_plain(function):
        return function
    known = function.__globals__
    called = {
        name: jitted(known[name], force_inline)
        for name in function.__code__.co_names
        if _is_plain(known.get(name)) and known[name] is not function
    }
    names = {**known, **called}
    made = FunctionType(function.__code__, names, function.__name__, function.__defaults__, function.__closure__)
    return njit(error_model="numpy", forceinline=force_inline)(made)


def _is_plain(value: Any) -> bool:
    return isinstance(value, FunctionType)
