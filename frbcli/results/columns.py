"""The columns of a run file: its events and its signals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from frbcli.columns import Column, Shown, uncertain_speed
from frbcli.units import with_uncertainty

# by the kind of an event: what a ring does with its pin, what the asperities of a film do, and what happens to a stop
TOUCHING = {
    "touch": ("touches its pin", "asperities touch", "is touched"),
    "lift-off": ("leaves its pin", "asperities part", "is left"),
}


def touching_name(event: Mapping[str, Any]) -> str:
    """What touches or leaves what, "" of an event at which nothing does, and of a contact of journal and shell, whose
    kind and film say it."""
    film, point = (str(event.get(key) or "").replace("_", " ") for key in ("film", "point"))
    body = point.split(" ")[0]
    if body == "collar" and event["kind"] == "contact":
        return "collar touches pads"
    if event["kind"] not in TOUCHING:
        return ""
    of_pin, of_asperities, of_stop = TOUCHING[event["kind"]]
    if body in ("ring", "stop"):
        return f"{point} {of_pin if body == 'ring' else of_stop}"
    return ", ".join(word for word in (of_asperities, film) if word)


def event_name(event: Mapping[str, Any]) -> str:
    """The kind of an event for people, its whirl where it has been named ("whirl", as Sub 1), and where it was found:
    its film, or else the point whose motion shows it; files of earlier versions have neither. Where something touches,
    who touches what."""
    if touching := touching_name(event):
        return touching
    place = str(event["film"] or event.get("point") or "").replace("_", " ")
    return " ".join(word for word in (event["kind"], event.get("whirl", ""), place) if word)


def uncertain_pair(event: Mapping[str, Any]) -> tuple[float, float | None]:
    """The rotor speed of an event and its uncertainty, Hz."""
    return event["speed_Hz"], event.get("speed_uncertainty_Hz")


def frequency_text(event: Mapping[str, Any]) -> str:
    """The frequency of an event with its uncertainty in brackets, Hz."""
    return with_uncertainty(event.get("frequency_Hz"), event.get("frequency_uncertainty_Hz"), 1)


def amplitude_text(event: Mapping[str, Any]) -> str:
    """The amplitude of an event over the clearance with its uncertainty in brackets."""
    return with_uncertainty(event.get("amplitude"), event.get("amplitude_uncertainty"), 3)


# Of an event of a run, a dict
EVENTS = (
    Column("event", "", "", event_name, shown=(Shown("event"),),
           key="", flat=False),
    Column("kind", "", "`critical-speed`, `onset`, `offset`, `lock-in`, `self-excited`, `contact`, `touch`, "
           "`lift-off`, `clearance-step`, `loss`, `forced`, `top-speed`, `standstill`",
           more="`forced`: a measured line of constant frequency; `touch`, `lift-off`: of "
                "asperities, a stop, or a ring (`point`) and its pin"),
    Column("film", "", "of several films"),
    Column("t", "s", "time", shown=(Shown("time, s", ".3f"),)),
    Column("speed", "Hz", "rotor speed"),
    Column("speed", "", "", uncertain_pair, shown=(uncertain_speed(),), key="", flat=False),
    Column("frequency", "Hz", "of the motion"),
    Column("frequency", "", "", frequency_text, shown=(Shown("frequency, Hz"),), key="", flat=False),
    Column("frequency_ratio", "", "frequency over the rotor speed", shown=(Shown("ratio", ".3f"),)),
    Column("point", "", "point whose motion shows it"),
    Column("amplitude", "", "amplitude over the clearance",
           more="largest one of an onset or a self-excited vibration, synchronous one of a critical speed"),
    Column("amplitude", "", "", amplitude_text, shown=(Shown("ampl."),), key="", flat=False),
    Column("speed_uncertainty", "Hz", "uncertainty, with a second run"),
    Column("frequency_uncertainty", "Hz", "uncertainty, with a second run"),
    Column("amplitude_uncertainty", "", "uncertainty, with a second run"),
    Column("certain", "", "the second run has the event, too"),
    Column("reason", "", "why it is not certain"),
)  # fmt: skip


# Signals of a run, by the quantities of their names
AXIAL_SIGNALS = (
    Column("axial_position", "m", "axial position of the collar",
           more="from the middle of the end play, or from the pads of the only side"),
    Column("thrust_film_thickness", "m", "smallest film thickness at the collar",
           more="gap over the lands less the tilt at the rim"),
    Column("thrust_loss", "W", "power into these films"),
)  # fmt: skip


DRIVE_SIGNALS = (
    Column("drive_torque", "N m", "torque of the drive"),
    Column("drive_power", "W", "its power"),
)  # fmt: skip


FRICTION_SIGNAL = Column("friction_torque", "N m", "braking torque of films, contacts, stops and ball bearings")


MACHINE_SIGNALS = (
    Column("time", "s", "time"), Column("speed", "Hz", "rotor speed"), *AXIAL_SIGNALS, *DRIVE_SIGNALS, FRICTION_SIGNAL
)  # fmt: skip


# For one of several films, bearings or disks the name follows the quantity: eccentricity_inner, disk_left_x_m
PART_SIGNALS = (
    Column("eccentricity", "", "of a journal"),
    Column("end_eccentricity", "", "larger one of both ends of a tilting film"),
    Column("tilt", "rad", "tilt of a journal in its shell", shape=(2,)),
    Column("oil_fraction", "", "mean of a film"),
    Column("journal", "m", "displacement of this part", shape=(2,)),
    Column("disk", "m", "displacement of this part", shape=(2,)),
    Column("collar", "m", "displacement of this part", shape=(2,)),
    Column("shell", "m", "displacement of this part", shape=(2,)),
    Column("support", "m", "displacement of this part", shape=(2,)),
    Column("housing", "m", "displacement at its centre of mass or at a bearing", shape=(2,)),
    Column("ring", "m", "displacement of this part", shape=(2,)),
    Column("ring_speed", "Hz", "speed of a ring"),
    Column("pin_angle", "rad", "rotation of a ring from the middle of its play"),
    Column("pin_torque", "N m", "torque on the ring"),
    Column("spring_force", "N", "force on the first place of a nonlinear spring or stop", shape=(2,)),
    Column("stop_force", "N", "force on the first place of a nonlinear spring or stop", shape=(2,)),
    Column("ball_force", "N", "force on the shaft", shape=(2,)),
    Column("ball_inner_load", "N", "largest load of a ball on this ring"),
    Column("ball_outer_load", "N", "largest load of a ball on this ring"),
    Column("ball_contact_angle", "rad", "largest one at the inner ring"),
    Column("ball_pressure", "Pa", "largest Hertz pressure of a ball"),
    Column("balls_apart", "", "balls of a row without contact at the inner ring"),
    Column("temperature", "K", "of film, ring or wall"),
    Column("viscosity", "Pa*s", "of a film"),
    Column("clearance", "m", "of a film"),
    Column("supply_pressure", "Pa", "absolute, if it changes over time"),
    Column("supply_temperature", "K", "if it changes over time"),
    Column("flow", "m^3/s", "outflow of a warm film at its open ends"),
    Column("film_force", "N", "force on the journal", shape=(2,)),
    Column("film_thickness", "m", "smallest film thickness"),
    Column("asperity_share", "", "share of asperities in the film force"),
    Column("contact_power", "W", "friction power of asperities"),
    Column("power", "W", "power into a film"),
    Column("torque", "N m", "torque on a journal"),
    Column("oil_flow", "m^3/s", "outflow of a film at its open ends"),
)
