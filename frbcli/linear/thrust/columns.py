"""Columns of the sheet of a thrust bearing, and of a collar at rest under an axial load."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

from frbcli.columns import ENTRIES, Column, Shown, named, speed_shown

FILMS, TILT_STIFFNESS, TILT_DAMPING = "films", "tilt stiffness", "tilt damping"
STABILITY = "stability"
EVERY = (FILMS, TILT_STIFFNESS, TILT_DAMPING)


def _in_um(gap: float) -> str:
    return f"{1e6 * gap:.3g} um"


def _direct_and_cross(matrix: Any) -> str:
    return f"{matrix[0, 0]:.3g} N m/rad, across {matrix[1, 0]:.3g} N m/rad"


# Of a ThrustState
THRUST = (
    Column("bearing", "", "name of the thrust bearing, empty of one alone"),
    Column("speed", "Hz", "rotor speed", shown=tuple(speed_shown(table=table) for table in EVERY)),
    Column("gap", "m", "smallest gap of the runner without tilt",
           shown=(*(Shown("gap", ".3g", "um", table) for table in EVERY), Shown("gap", _in_um, table=STABILITY)),
           more="over the lands; with pads on both sides on the side that `load` presses on"),
    Column("load", "N", "load that the film carries", shown=(Shown("load", ".4g", table=FILMS),),
           more="with pads on both sides the difference of the two"),
    Column("torque", "N m", "torque that resists the rotation"),
    Column("power", "W", "power loss", more="torque times speed",
           shown=(Shown("loss", ".4g", table=FILMS), Shown("loss", "{:.4g} W".format, table=STABILITY))),
    Column("flow_inner", "m^3/s", "oil that leaves at the inner radius",
           shown=(Shown("inner", ".3g", "mm^3/s", FILMS),)),
    Column("flow_outer", "m^3/s", "oil that leaves at the outer radius",
           shown=(Shown("outer", ".3g", "mm^3/s", FILMS),)),
    Column("flow_leading", "m^3/s", "oil that enters at the leading edges of the pads"),
    Column("p_max", "Pa", "largest absolute pressure", shown=(Shown("p", ".3g", "bar", FILMS),)),
    Column("stiffness", "N/m", "axial stiffness `-dW/dz`", shown=(Shown("k", ".4g", "N/um", FILMS),)),
    Column("damping", "N s/m", "axial damping `-dW/dz'`", shown=(Shown("c", ".3g", "N s/mm", FILMS),)),
    Column("tilt_stiffness", "N m", "stiffness in tilt `-dM/dtilt`, per rad", shape=(2, 2),
           shown=(Shown(ENTRIES, ".4g", table=TILT_STIFFNESS),
                  Shown("stiffness in tilt", _direct_and_cross, table=STABILITY))),
    Column("tilt_damping", "N m s", "damping in tilt `-dM/dtilt'`, per rad", shape=(2, 2),
           shown=(Shown(ENTRIES, ".4g", table=TILT_DAMPING),)),
    Column("viscosity", "Pa s", "viscosity of the oil", more="on the loaded side"),
    Column("temperature", "K", "temperature of the oil, where the case gives one, or with heat",
           more="on the loaded side"),
    Column("load_error_relative", "", "relative error of the load, from another mesh", attrgetter("load_error"),
           shown=(Shown("err.", ".0e", table=FILMS),), key="error.load_relative"),
    Column("coefficient_error", "", "relative error of stiffness and damping, axial and in tilt",
           attrgetter("coefficient_error"), key="error.coefficients_relative",
           more="over the largest entry of each",
           shown=tuple(Shown("err.", ".0e", table=table) for table in (TILT_STIFFNESS, TILT_DAMPING))),
)  # fmt: skip

# Of an AxialState
AXIAL = (
    Column("axial_load", "N", "load on the rotor along its axis", more="towards larger positions",
           shown=(Shown("load", "{:.4g} N".format, table=STABILITY),)),
    Column("axial_position", "m", "axial position of the collar", attrgetter("position"),
           more="from the middle of the end play, or from the pads of the only side"),
    Column("axial_frequency", "Hz", "frequency of the motion along the axis", attrgetter("frequency"),
           more="0 where it does not oscillate"),
    Column("axial_growth", "1/s", "growth", attrgetter("eigenvalue.real"), more="below 0 it decays"),
    *named([column for column in THRUST if column.quantity not in ("bearing", "speed")], "", attrgetter("films")),
)  # fmt: skip
