"""The film of a bearing model in the time loop: a call of the model's compiled function by its address."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from frbcli.compiled import compiled
from frbcli.film.gap import LARGEST_ECCENTRICITY

NUMBERS = 10  # force (x, y), its derivatives by displacement and by velocity (xx, xy, yx, yy each)
MOTION = 5  # displacement and velocity (x, y), speed
CLEARANCE, VISCOSITY = 2, 3  # where the parameters have them: the order of BearingDimensions
NO_FLOW = 0  # address of the flow of a model that does not tell it


class BearingModelFilm(NamedTuple):
    """A bearing model with the numbers of one bearing. address: of its compiled function, see compiled.py; flow: of
    that of its flow, or NO_FLOW; central: whether derivatives that the model does not tell are central differences (1)
    or one-sided (0), which take half the time and are good enough for Newton's method; parameters: (n,) the fields of
    the record that it takes."""

    address: int
    flow: int
    central: int
    parameters: NDArray[np.float64]

    @property
    def clearance(self) -> float:
        """In m."""
        return float(self.parameters[CLEARANCE])


def _call_model(typingctx, address, central, d_x, d_y, v_x, v_y, omega, parameters):  # type: ignore[no-untyped-def]
    """The ten numbers of a bearing model at an address, in SI; parameters: an array in one piece."""
    taken = (types.intp, types.intp, *[types.float64] * MOTION, parameters)
    signature = types.UniTuple(types.float64, NUMBERS)(*taken)  # type: ignore[no-untyped-call]

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        number = ir.DoubleType()
        answer = cgutils.alloca_once(builder, ir.ArrayType(number, NUMBERS))  # type: ignore[no-untyped-call]
        given = context.make_array(signature.args[-1])(context, builder, arguments[-1]).data
        into = builder.bitcast(answer, number.as_pointer())
        takes = [arguments[1].type, *[number] * MOTION, *[number.as_pointer()] * 2]
        kind = ir.FunctionType(ir.VoidType(), takes)
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        builder.call(function, [*arguments[1:-1], given, into])
        return builder.load(answer)  # an array of numbers is how numba keeps a tuple of numbers of one type

    return signature, generate


call_model: Any = intrinsic(_call_model)


@compiled()
def model_force(
    film: BearingModelFilm, d_x: float, d_y: float, v_x: float, v_y: float, omega: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """film_force of a bearing model: d over the clearance, v in 1/s, as everywhere in the loop."""
    c = film.parameters[CLEARANCE]
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if eccentricity > LARGEST_ECCENTRICITY:  # a model is asked within its clearance only, see film_force
        d_x, d_y = d_x * LARGEST_ECCENTRICITY / eccentricity, d_y * LARGEST_ECCENTRICITY / eccentricity
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = call_model(
        film.address, film.central, c * d_x, c * d_y, c * v_x, c * v_y, omega, film.parameters
    )
    return f_x, f_y, c * k_xx, c * k_xy, c * k_yx, c * k_yy, c * d_xx, c * d_xy, c * d_yx, c * d_yy


@compiled()
def model_flow(film: BearingModelFilm, d_x: float, d_y: float, v_x: float, v_y: float, omega: float) -> float:
    """The oil in m^3/s that leaves the ends of a bearing whose model tells it; the motion as in model_force."""
    c = film.parameters[CLEARANCE]
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if eccentricity > LARGEST_ECCENTRICITY:
        d_x, d_y = d_x * LARGEST_ECCENTRICITY / eccentricity, d_y * LARGEST_ECCENTRICITY / eccentricity
    found = call_model(film.flow, 0, c * d_x, c * d_y, c * v_x, c * v_y, omega, film.parameters)
    return float(found[0])
