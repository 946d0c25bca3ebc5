"""Columns of the sheet of a thrust bearing."""

from __future__ import annotations

from operator import attrgetter

from frbcli.columns import ENTRIES, Column, Shown

FILMS, TILT_STIFFNESS, TILT_DAMPING = "films", "tilt stiffness", "tilt damping"
EVERY = (FILMS, TILT_STIFFNESS, TILT_DAMPING)

# Of a ThrustState
THRUST = (
    Column("bearing", "", "name of the thrust bearing, empty of one alone"),
    Column("speed", "Hz", "rotor speed", shown=tuple(Shown("Hz", ".4g", table=table) for table in EVERY)),
    Column("gap", "m", "smallest gap of the runner without tilt",
           shown=tuple(Shown("gap", ".3g", "um", table) for table in EVERY),
           more="over the lands; with pads on both sides on the side that `load` presses on"),
    Column("load", "N", "load that the film carries", shown=(Shown("load", ".4g", table=FILMS),),
           more="with pads on both sides the difference of the two"),
    Column("torque", "N m", "torque that resists the rotation"),
    Column("power", "W", "power loss", shown=(Shown("loss", ".4g", table=FILMS),), more="torque times speed"),
    Column("flow_inner", "m^3/s", "oil that leaves at the inner radius",
           shown=(Shown("inner", ".3g", "mm^3/s", FILMS),)),
    Column("flow_outer", "m^3/s", "oil that leaves at the outer radius",
           shown=(Shown("outer", ".3g", "mm^3/s", FILMS),)),
    Column("flow_leading", "m^3/s", "oil that enters at the leading edges of the pads"),
    Column("p_max", "Pa", "largest absolute pressure", shown=(Shown("p", ".3g", "bar", FILMS),)),
    Column("stiffness", "N/m", "axial stiffness `-dW/dz`", shown=(Shown("k", ".4g", "N/um", FILMS),)),
    Column("damping", "N s/m", "axial damping `-dW/dz'`", shown=(Shown("c", ".3g", "N s/mm", FILMS),)),
    Column("tilt_stiffness", "N m", "stiffness in tilt `-dM/dtilt`, per rad", shape=(2, 2),
           shown=(Shown(ENTRIES, ".4g", table=TILT_STIFFNESS),)),
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
