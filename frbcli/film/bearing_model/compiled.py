"""A bearing model compiled: a C function that fills in force and derivatives, and one for its flow, called by address.

So the kernels of the time loop are compiled once for all models, as they are for cavitation laws, and a changed model
never meets an old compiled one: what is compiled here lives as long as the process.
"""

from __future__ import annotations

import math
from collections import namedtuple
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np
from numba import typeof, types
from numba.core.errors import NumbaError
from numba.np.numpy_support import carray
from numba.np.unsafe import ndarray

from frbcli.compiled import c_function, jitted
from frbcli.film.bearing_model.film import MOTION, NUMBERS
from frbcli.film.bearing_model.model import BearingModel, wrong

# Steps of differences. A one-sided one over h leaves h F'' / 2, a central one h^2 F''' / 6, and both lose round-off / h
# of F: the least is near the square and the cube root of the precision, 2.2e-16. Displacements count over the gap that
# is left, which is what forces of films change with, velocities over their size.
ONE_SIDED, CENTRAL = 1.5e-8, 6e-6
SLOWEST = 1.0  # rad/s: times the clearance, the least size of a velocity
FORCE, DERIVATIVES, FLOW = 2, 8, 1  # numbers that the functions return
MEANT = {FORCE: "(F_x, F_y) in N", DERIVATIVES: "the eight derivatives of (F_x, F_y)", FLOW: "one number, in m^3/s"}

_POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.void(types.intp, *[types.float64] * MOTION, _POINTER, _POINTER)
_first: Any = ndarray.to_fixed_tuple  # the first numbers of an array as a tuple
# Stand in the templates below for those of one model.
force: Any = None
derivatives: Any = None
flow: Any = None
Record: Any = None
COUNT = 1


@cache
def compiled_model(model: BearingModel) -> Any:
    """The C function of a model. Raises InputError if numba cannot compile it, or it returns something else."""
    record = _record(model)
    functions = {"force": _checked(model, "force", model.force, record, FORCE)}
    template: Any = _by_differences
    if model.derivatives is not None:
        functions["derivatives"] = _checked(model, "derivatives", model.derivatives, record, DERIVATIVES)
        template = _by_derivatives
    return _made(template, record, functions)


@cache
def compiled_flow(model: BearingModel) -> Any:
    """The C function of the flow of a model that tells it. Raises InputError as compiled_model."""
    record = _record(model)
    return _made(_flow_alone, record, {"flow": _checked(model, "flow", model.flow, record, FLOW)})


def _record(model: BearingModel) -> Any:
    """The type of the record that the functions of a model take."""
    return namedtuple("Bearing", model.parameters)


def _made(template: Any, record: Any, functions: dict[str, Any]) -> Any:
    """The C function of a template, in which the functions of a model stand."""
    shared = {"Record": record, "COUNT": len(record._fields), **functions}
    return c_function(FunctionType(template.__code__, {**globals(), **shared}, template.__name__), _SIGNATURE)


def _checked(model: BearingModel, name: str, function: Any, record: Any, count: int) -> Any:
    """A function of a model compiled by numba for what films give it. Raises InputError if that does not succeed."""
    takes = f"{name}(d_x, d_y, v_x, v_y, omega, bearing)"
    if not callable(function):
        raise wrong(model, name, "is no function.", f"Give {takes}, compiled by numba.njit.")
    compiled = function if hasattr(function, "py_func") else jitted(function)
    kind_of: Any = typeof
    given = (*[types.float64] * MOTION, kind_of(record(*[0.0] * len(record._fields))))
    try:
        compiled.compile(given)
        returned = compiled.overloads[given].signature.return_type
    except (NumbaError, RuntimeError, TypeError, NotImplementedError) as error:
        remedy = f"Write {takes} of numbers, with the functions of math; see what numba.njit takes."
        raise wrong(model, name, f"cannot be compiled by numba: {_reason(error)}.", remedy) from error
    base: Any = types.BaseTuple
    found: tuple[Any, ...] = tuple(returned) if isinstance(returned, base) else ()
    found = (returned,) if count == FLOW else found
    if len(found) != count or not all(isinstance(kind, types.Float | types.Integer) for kind in found):
        problem = f"returns {returned}, not {count} number{'s' * (count > 1)}."
        raise wrong(model, name, problem, f"Return {MEANT[count]}.")
    return compiled


def _reason(error: BaseException) -> str:
    """First line of numba's message that is about the function."""
    lines = [line.strip() for line in str(error).splitlines()]
    told = [line for line in lines if line and not line.startswith(("Failed in", ">>>"))]
    places = [line for line in told if line.startswith("File ")]
    first = next((line for line in told if not line.startswith("File ")), type(error).__name__)
    return " ".join([first, *places[-1:]]).rstrip(".:")


def _by_derivatives(central, d_x, d_y, v_x, v_y, omega, given, answer):  # type: ignore[no-untyped-def]
    """The ten numbers of a model with derivatives of its own."""
    out = carray(answer, (NUMBERS,))
    for i in range(NUMBERS):
        out[i] = np.nan  # what is left where a function raises an exception, which C does not know
    bearing = Record(*_first(carray(given, (COUNT,)), COUNT))
    values = derivatives(d_x, d_y, v_x, v_y, omega, bearing)
    out[0], out[1] = force(d_x, d_y, v_x, v_y, omega, bearing)
    for i in range(NUMBERS - 2):
        out[2 + i] = values[i]


def _flow_alone(central, d_x, d_y, v_x, v_y, omega, given, answer):  # type: ignore[no-untyped-def]
    """The flow of a model as the first of the numbers."""
    out = carray(answer, (NUMBERS,))
    out[0] = np.nan
    bearing = Record(*_first(carray(given, (COUNT,)), COUNT))
    out[0] = flow(d_x, d_y, v_x, v_y, omega, bearing)


def _by_differences(central, d_x, d_y, v_x, v_y, omega, given, answer):  # type: ignore[no-untyped-def]
    """The ten numbers of a model, the derivatives by differences, central ones or one-sided ones."""
    out = carray(answer, (NUMBERS,))
    for i in range(NUMBERS):
        out[i] = np.nan
    bearing = Record(*_first(carray(given, (COUNT,)), COUNT))
    clearance = bearing.clearance
    share = CENTRAL if central else ONE_SIDED
    near = share * (clearance - math.sqrt(d_x * d_x + d_y * d_y))
    fast = share * max(math.sqrt(v_x * v_x + v_y * v_y), clearance * max(abs(omega), SLOWEST))
    f_x, f_y = force(d_x, d_y, v_x, v_y, omega, bearing)
    b_x, b_y = f_x, f_y
    for i in range(4):
        by_x, by_y, to_x, to_y = near * (i == 0), near * (i == 1), fast * (i == 2), fast * (i == 3)
        width = near if i < 2 else fast
        a_x, a_y = force(d_x + by_x, d_y + by_y, v_x + to_x, v_y + to_y, omega, bearing)
        if central:
            b_x, b_y = force(d_x - by_x, d_y - by_y, v_x - to_x, v_y - to_y, omega, bearing)
            width *= 2.0
        column = 2 + i + 2 * (i // 2)
        out[column], out[column + 2] = (a_x - b_x) / width, (a_y - b_y) / width
    out[0], out[1] = f_x, f_y
