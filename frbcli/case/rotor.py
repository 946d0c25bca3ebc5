"""The rotors of a case: rigid (2.3), Jeffcott (2.4) and turbocharger.

A symmetric rotor lies in two equal bearings, of which a case describes one; another one has a shaft of sections.
`frbcli/scene/shafts/` makes bodies of them.
"""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import (
    Acceleration,
    Angle,
    Count,
    Damping,
    DampingRate,
    DampingTime,
    Density,
    Fraction,
    Identifier,
    Inertia,
    InnerDiameter,
    JournalMass,
    Label,
    Length,
    Mass,
    Modulus,
    Position,
    Ratio,
    RotorInertia,
    Speed,
    Stiffness,
    Unbalance,
)

GRAVITY = 9.81


class RigidRotor(Model):
    """A rigid rotor that does not tilt, carried by two equal bearings."""

    symmetric: ClassVar[bool] = True

    kind: Literal["rigid"] = Field(description="one mass, no tilting (2.3)")
    mass: Mass = Field(description="mass of the whole rotor")
    unbalance: Unbalance = Field(default=0.0, description="mass times radius")
    external_damping: Damping = Field(default=0.0, description="damping of the rotor against the ground")
    polar_inertia: RotorInertia | None = Field(default=None, description="about the axis of rotation, for [drive]")
    gravity: Acceleration = Field(default=GRAVITY, description="acts along -y; 0 switches it off")


class JeffcottRotor(Model):
    """A disk on a massless elastic shaft with a journal at each end, carried by two equal bearings."""

    symmetric: ClassVar[bool] = True

    kind: Literal["jeffcott"] = Field(description="a disk on an elastic shaft (2.4)")
    mass: Mass = Field(description="mass of the disk")
    journal_mass: JournalMass = Field(description="mass of both journals together")
    shaft_stiffness: Stiffness = Field(description="stiffness between disk and journals")
    unbalance: Unbalance = Field(default=0.0, description="mass times radius, at the disk")
    external_damping: Damping = Field(default=0.0, description="damping of the disk against the ground")
    shaft_damping: Damping = Field(default=0.0, description="damping between disk and journals that does not turn")
    internal_damping: Damping = Field(
        default=0.0, description="damping between disk and journals that turns with the shaft"
    )
    polar_inertia: RotorInertia | None = Field(default=None, description="about the axis of rotation, for [drive]")
    gravity: Acceleration = Field(default=GRAVITY, description="acts along -y; 0 switches it off")


class TurbochargerRotor(Model):
    """A beam of [[shaft]] sections with [[disk]] entries, reduced to its lowest modes."""

    symmetric: ClassVar[bool] = False
    polar_inertia: ClassVar[None] = None  # that of its sections and disks

    kind: Literal["turbocharger"] = Field(description="a shaft of [[shaft]] sections with [[disk]] entries")
    file: Label = Field(default="", description="rotor file of ROSS; replaces [[shaft]]")
    modes: Annotated[int, Count(2, 200, 6)] | None = Field(
        default=None,
        description="modes of the free rotor kept in each plane; by default as many as `accuracy.target` needs",
    )
    cutoff: Speed | None = Field(default=None, description="replaces `modes`: keep the modes up to this frequency")
    modal_damping: Fraction = Field(default=0.0, description="damping ratio of every elastic mode; does not turn")
    internal_damping: DampingTime = Field(
        default=0.0, description="damping of the shaft over its stiffness; turns with the shaft"
    )
    external_damping: Damping = Field(default=0.0, description="damping of each disk against the ground")
    gravity: Acceleration = Field(default=GRAVITY, description="acts along -y; 0 switches it off")


Rotor = Annotated[RigidRotor | JeffcottRotor | TurbochargerRotor, Field(discriminator="kind")]
SYMMETRIC, OF_SECTIONS = ("rigid", "jeffcott"), ("turbocharger",)  # kinds


class ShaftSection(Model):
    """One cylindrical section of a turbocharger's shaft; the sections follow each other along z."""

    length: Length = Field(description="along the axis")
    diameter: Length = Field(description="outer diameter")
    inner_diameter: InnerDiameter = Field(default=0.0, description="of a hollow shaft")
    density: Density = Field(default=7850.0, description="of the material")
    youngs_modulus: Modulus = Field(default=210e9, description="of the material; steel")
    poisson_ratio: Ratio = Field(default=0.3, description="of the material, for its shear")
    internal_damping: DampingTime | None = Field(
        default=None,
        description="of the section over its stiffness, instead of the damping of the rotor; turns with it",
    )
    mass_damping: DampingRate = Field(default=0.0, description="of the section over its mass; does not turn")
    stiffness_damping: DampingTime = Field(default=0.0, description="of the section over its stiffness; does not turn")

    @property
    def polar_inertia(self) -> float:
        """About the axis of rotation [kg m^2]."""
        fourth = self.diameter**4 - self.inner_diameter**4
        return math.pi / 32.0 * self.density * self.length * fourth


class Disk(Model):
    """A wheel, a nut or a thrust disk on a turbocharger's shaft."""

    name: Identifier = Field(default="", description="of the disk in results; numbered if not given")
    position: Position = Field(description="along the shaft, from the start of its first section")
    mass: Mass = Field(description="of the disk")
    polar_inertia: Inertia = Field(default=0.0, description="about the axis of rotation")
    diametral_inertia: Inertia = Field(default=0.0, description="about a diameter")
    unbalance: Unbalance = Field(default=0.0, description="mass times radius")
    phase: Angle = Field(default=0.0, description="angle of the unbalance on the rotor")
