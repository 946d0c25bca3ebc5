"""The motion of the journal that a kinematic test gives."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import (
    Angle,
    Eccentricity,
    Force,
    Label,
    Quantity,
    Rate,
    SignedSpeed,
    Speed,
    Tilt,
    TiltRate,
    Velocity,
)
from frbcli.units import NUMBER


class KinematicMotion(Model):
    """Given motion of the journal in a kinematic test."""

    film: Label = Field(
        default="",
        description="tested film, required with several; all else is fixed",
    )
    eccentricity: Eccentricity | None = Field(default=None, description="displacement over clearance")
    angle: Angle = Field(default=0.0, description="of the displacement, from the x-axis")
    load: Force | None = Field(default=None, description="replaces the displacement: static equilibrium")
    speed: SignedSpeed | None = Field(default=None, description="of the journal; the shell is fixed")
    eccentricity_rate: Rate = Field(default=0.0, description="of a rotation")
    whirl_speed: SignedSpeed = Field(default=0.0, description="of a rotation")
    velocity: tuple[Velocity, Velocity] | None = Field(
        default=None, description="of a rotation, along x, y; replaces the two before"
    )
    tilt: tuple[Tilt, Tilt] | None = Field(
        default=None, description="of the journal about x, y, at the middle of the bearing"
    )
    tilt_rate: tuple[TiltRate, TiltRate] | None = Field(
        default=None, description="of a rotation, about x, y"
    )
    frequency: Speed | None = Field(default=None, description="of squeeze or whirl")
    periods: Annotated[float, Quantity(NUMBER, "3", above=0, most=1000)] = Field(
        default=3.0, description="of squeeze or whirl"
    )

    @property
    def states_moment(self) -> bool:
        """Whether a test states the moment of the film force, too."""
        return any(given is not None for given in (self.velocity, self.tilt, self.tilt_rate))
