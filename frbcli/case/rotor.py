"""The rotors of a case: rigid (2.3), Jeffcott (2.4) and turbocharger.

A symmetric rotor lies in two equal bearings, of which a case describes one; another one has a shaft of sections.
`frbcli/scene/machine/` makes bodies of them.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from frbcli.case.model import (
    ONE_OR_MANY,
    Acceleration,
    Angle,
    Count,
    Damping,
    DampingRate,
    DampingTime,
    Density,
    Fraction,
    Hold,
    Identifier,
    Inertia,
    InnerDiameter,
    JournalMass,
    Label,
    Length,
    Mass,
    Model,
    Modulus,
    Offset,
    Position,
    Ratio,
    RotorInertia,
    Speed,
    Stiffness,
    Unbalance,
    repeated,
)
from frbcli.case.over_time import MachineTable
from frbcli.case.reading.tables import Breach, Path
from frbcli.units import display

if TYPE_CHECKING:
    from frbcli.case.schema import Case

GRAVITY = 9.81


class Loss(Model):
    """A lost blade or weight: an unbalance that is added during a run."""

    time: Hold = Field(description="from the start of the run")
    unbalance: Unbalance = Field(description="added mass times radius")
    phase: Angle = Field(default=0.0, description="angle on the rotor")


Losses = Annotated[tuple[Loss, ...], repeated(1), ONE_OR_MANY]


def with_losses(unbalance: float, phase: float, losses: Losses) -> tuple[float, float]:
    """Size in kg m and angle on the rotor in rad of an unbalance with what losses add to it from the beginning."""
    added = sum(cmath.rect(loss.unbalance, loss.phase) for loss in losses if loss.time == 0.0)
    return cmath.polar(cmath.rect(unbalance, phase) + added) if added else (unbalance, phase)


def unbalance_sizes(part: RigidRotor | JeffcottRotor | Disk) -> float:
    """The unbalance of a rotor or a disk plus its losses, in phase, kg m."""
    return part.unbalance + sum(loss.unbalance for loss in part.losses)


class RigidRotor(Model):
    """A rigid rotor without tilt in two equal bearings."""

    symmetric: ClassVar[bool] = True

    kind: Literal["rigid"] = Field(description="one mass, no tilting (2.3)")
    mass: Mass = Field(description="of the rotor")
    unbalance: Unbalance = Field(default=0.0, description="mass times radius")
    losses: Losses = Field(default=(), alias="loss", description="unbalances that join later")
    external_damping: Damping = Field(default=0.0, description="of rotor or disk to ground")
    polar_inertia: RotorInertia | None = Field(default=None, description="about the axis, for [drive]")
    gravity: Acceleration = Field(default=GRAVITY, description="along -y; 0: off")


class JeffcottRotor(Model):
    """A disk on a massless elastic shaft with a journal at each end, in two equal bearings."""

    symmetric: ClassVar[bool] = True

    kind: Literal["jeffcott"] = Field(description="a disk on an elastic shaft (2.4)")
    mass: Mass = Field(description="of the disk")
    journal_mass: JournalMass = Field(description="of both journals together")
    shaft_stiffness: Stiffness = Field(description="between disk and journals")
    unbalance: Unbalance = Field(default=0.0, description="mass times radius")
    losses: Losses = Field(default=(), alias="loss", description="unbalances that join later")
    bow: Offset = Field(default=0.0, description="of the unloaded disk off the line of the journals")
    bow_phase: Angle = Field(default=0.0, description="angle on the rotor; the unbalance is at 0")
    external_damping: Damping = Field(default=0.0, description="of rotor or disk to ground")
    shaft_damping: Damping = Field(default=0.0, description="between disk and journals, does not turn")
    internal_damping: Damping = Field(
        default=0.0, description="between disk and journals, turns with the shaft"
    )
    polar_inertia: RotorInertia | None = Field(default=None, description="about the axis, for [drive]")
    gravity: Acceleration = Field(default=GRAVITY, description="along -y; 0: off")


class TurbochargerRotor(Model):
    """A beam of [[shaft]] sections with [[disk]] entries, reduced to its lowest modes."""

    symmetric: ClassVar[bool] = False
    polar_inertia: ClassVar[None] = None  # follows from its sections and disks

    kind: Literal["turbocharger"] = Field(description="a shaft of [[shaft]] sections with [[disk]] entries")
    file: Label = Field(default="", description="rotor file of ROSS; replaces [[shaft]]")
    modes: Annotated[int, Count(2, 200, 6)] | None = Field(
        default=None,
        description="modes of the free rotor in each plane; default: by `accuracy.target`",
    )
    cutoff: Speed | None = Field(default=None, description="replaces `modes`: highest modal frequency")
    modal_damping: Fraction = Field(default=0.0, description="ratio of every elastic mode; does not turn")
    internal_damping: DampingTime = Field(
        default=0.0, description="damping over stiffness; turns with the shaft"
    )
    external_damping: Damping = Field(default=0.0, description="of each disk to ground")
    gravity: Acceleration = Field(default=GRAVITY, description="along -y; 0: off")


Rotor = Annotated[RigidRotor | JeffcottRotor | TurbochargerRotor, Field(discriminator="kind")]
SYMMETRIC, OF_SECTIONS = ("rigid", "jeffcott"), ("turbocharger",)  # kinds


class ShaftSection(Model):
    """A cylindrical section; the sections follow each other along z."""

    length: Length = Field(description="of the section")
    diameter: Length = Field(description="of the section")
    inner_diameter: InnerDiameter = Field(default=0.0, description="of the section")
    density: Density = Field(default=7850.0, description="of the section")
    youngs_modulus: Modulus = Field(default=210e9, description="of the section")
    poisson_ratio: Ratio = Field(default=0.3, description="of the section")
    internal_damping: DampingTime | None = Field(
        default=None,
        description="damping over stiffness, turns; replaces the rotor's",
    )
    mass_damping: DampingRate = Field(default=0.0, description="damping over mass; does not turn")
    stiffness_damping: DampingTime = Field(default=0.0, description="damping over stiffness; does not turn")

    @property
    def polar_inertia(self) -> float:
        """About the axis of rotation [kg m^2]."""
        fourth = self.diameter**4 - self.inner_diameter**4
        return math.pi / 32.0 * self.density * self.length * fourth


class Bow(MachineTable):
    """A point of an unloaded bent shaft."""

    position: Position = Field(description="from the start of the shaft")
    offset: Offset = Field(description="off the line through the outermost bearings")
    phase: Angle = Field(default=0.0, description="angle on the rotor")

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        length = sum(section.length for section in case.shaft)
        if case.rotor.symmetric:
            remedy = 'Write rotor.bow = "10 um".' if case.rotor.kind == "jeffcott" else "Remove it: it cannot bend."
            yield Breach(path, f"does not go with a {case.rotor.kind} rotor.", remedy)
        elif not 0.0 <= self.position <= length * (1.0 + 1e-9):
            problem = f"is {display(self.position, 'm')}, not on the shaft of {display(length, 'm')}."
            yield Breach((*path, "position"), problem, "Positions count from the start of the first section.")
        elif any(other is not self and abs(other.position - self.position) < APART * length for other in case.bows):
            problem = "coincides, within a thousandth of the shaft, with another one, between which no shaft bends so."
            yield Breach((*path, "position"), problem, "Keep one of the two.")
        elif self is case.bows[0] and len(bow_places(case)) < LEAST_PLACES:
            problem = "is at a bearing, and a straight line runs through this and the other outermost bearing."
            yield Breach((*path, "position"), problem, "Add a [[bow]] at another place.")


APART, LEAST_PLACES = 1e-3, 3  # of the shaft's length: places that count as one; a bow has


def bow_places(case: Case) -> tuple[tuple[float, complex], ...]:
    """Positions in m of the bow of a shaft, each with its offset in m times exp(i its angle on the rotor): 0 in the
    outermost bearings where none is given. Empty for a straight shaft."""
    if not any(bow.offset for bow in case.bows):
        return ()
    given = tuple((bow.position, cmath.rect(bow.offset, bow.phase)) for bow in case.bows)
    held, near = [each.position or 0.0 for each in case.placed_bearings], APART * sum(s.length for s in case.shaft)
    ends = (end for end in (min(held), max(held)) if all(abs(end - place) >= near for place, _ in given))
    return *((end, 0j) for end in ends), *given


class Disk(Model):
    """A wheel, nut or thrust disk on a turbocharger's shaft."""

    name: Identifier = Field(default="", description="in results; numbered by default")
    position: Position = Field(description="from the start of the shaft")
    mass: Mass = Field(description="of the disk")
    polar_inertia: Inertia = Field(default=0.0, description="of the disk")
    diametral_inertia: Inertia = Field(default=0.0, description="of the disk")
    unbalance: Unbalance = Field(default=0.0, description="mass times radius")
    phase: Angle = Field(default=0.0, description="angle on the rotor")
    losses: Losses = Field(default=(), alias="loss", description="unbalances that join later")
