"""The columns of a run file: its events and its signals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from frbcli.columns import Column, Shown


def event_place(event: Mapping[str, Any]) -> str:
    """Where an event was found: its film, or else the point whose motion shows it; "" of one that has neither, as in
    files of earlier versions."""
    return str(event["film"] or event.get("point") or "")


def event_name(event: Mapping[str, Any]) -> str:
    """The kind of an event, its whirl where it has been named ("whirl", as Sub 1), and its place."""
    return " ".join(word for word in (event["kind"], event.get("whirl", ""), event_place(event)) if word)


# Of an event of a run, a dict
EVENTS = (
    Column("event", "", "", event_name, shown=(Shown("event"),),
           key="", flat=False),
    Column("kind", "", "`critical-speed`, `onset`, `offset`, `lock-in`, `self-excited`, `contact`, `clearance-step`"),
    Column("film", "", "film, none where there is but one"),
    Column("t", "s", "time", shown=(Shown("time, s", ".3f"),)),
    Column("speed", "Hz", "rotor speed", shown=(Shown("speed, Hz", ".1f"),)),
    Column("frequency", "Hz", "frequency of the motion, if it has one", shown=(Shown("frequency, Hz", ".1f"),)),
    Column("frequency_ratio", "", "frequency over the rotor speed", shown=(Shown("ratio", ".3f"),)),
    Column("point", "", "point of the rotor whose motion shows it"),
)  # fmt: skip

# Signals of a run, by the quantities of their names
MACHINE_SIGNALS = (Column("time", "s", "time"), Column("speed", "Hz", "rotor speed"))
# Those of one of several films, bearings or disks have its name behind the quantity: eccentricity_inner, disk_left_x_m
PART_SIGNALS = (
    Column("eccentricity", "", "relative eccentricity of a journal"),
    Column("oil_fraction", "", "mean oil fraction of a film"),
    Column("journal", "m", "displacement of a journal", shape=(2,)),
    Column("disk", "m", "displacement of a disk", shape=(2,)),
    Column("support", "m", "displacement of the shell of a bearing on its support", shape=(2,)),
    Column("ring", "m", "displacement of a ring", shape=(2,)),
    Column("ring_speed", "Hz", "speed of a ring"),
    Column("temperature", "K", "temperature of a film, a ring or a wall"),
    Column("viscosity", "Pa*s", "viscosity of the oil of a film"),
    Column("clearance", "m", "clearance of a film"),
    Column("flow", "m^3/s", "oil that leaves a warm film at its open ends"),
    Column("film_force", "N", "force of a film on its journal", shape=(2,)),
    Column("film_thickness", "m", "smallest film thickness"),
    Column("power", "W", "power that journal and shell put into a film"),
    Column("torque", "N m", "torque on a journal"),
    Column("oil_flow", "m^3/s", "oil that leaves a film at its open ends"),
)
