"""Columns of a warm machine: its films, its rings and its balance of heat."""

from __future__ import annotations

from operator import attrgetter

from frbcli.columns import Column, Shown

# Of a FilmTemperature, all of one bearing
WARM_FILMS = (
    Column("film", "", "name of the film", shown=(Shown("film", lambda name: name.replace("_", " ")),)),
    Column("temperature", "K", "temperature of the film", shown=(Shown("degC", ".1f", "degC"),)),
    Column("viscosity", "Pa s", "viscosity of its oil", shown=(Shown("mPa*s", ".4g", "mPa s"),)),
    Column("clearance", "m", "clearance", shown=(Shown("gap, um", ".4g", "um"),)),
    Column("power", "W", "power that journal and shell put into the film", shown=(Shown("loss, W", ".4g"),)),
    Column("flow", "m^3/s", "oil that leaves at the open ends", shown=(Shown("flow, ml/s", ".3g", "ml/s"),)),
)

# Of a RingTemperature
WARM_RINGS = (
    Column("ring", "", "name of the ring", shown=(Shown("ring"),)),
    Column("inner", "K", "of its inner surface", shown=(Shown("inner, degC", ".1f", "degC"),)),
    Column("outer", "K", "of its outer surface", shown=(Shown("outer, degC", ".1f", "degC"),)),
    Column("speed_ratio", "", "speed of the ring over the rotor speed", shown=(Shown("speed over rotor's", ".4f"),)),
)

# Of a SteadyHeat
HEAT_BALANCE = (
    Column("carried_by_oil", "W", "heat that leaves with the oil", attrgetter("carried")),
    Column("into_walls", "W", "heat into shaft and housing", attrgetter("given")),
    Column("balance_relative", "", "unaccounted power over the power", attrgetter("balance")),
)
