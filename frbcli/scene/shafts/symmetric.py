"""Symmetric rotors on two equal bearings: rigid (2.3) and Jeffcott (2.4)."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from frbcli.case.rotor import JeffcottRotor, RigidRotor, unbalance_sizes, with_loss
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.body import Body, jeffcott_rotor, point_mass
from frbcli.scene.shafts.shaft import STANDS, TURNS, BalancingPlane, Shaft, Stations, symmetric_stations
from frbcli.units import ANGLE, display

BENT = 21  # places along a shaft that bends


@dataclass(frozen=True)
class RigidShaft(Shaft):
    """One mass that does not tilt."""

    rotor: RigidRotor

    fronts: ClassVar[float] = 0.2
    disk_count: ClassVar[int] = 0
    freedoms: ClassVar[int] = 2

    def body(self) -> Body:
        rotor = self.rotor
        unbalance, phase = with_loss(rotor.unbalance, 0.0, rotor.loss)
        return point_mass("journal", rotor.mass, rotor.gravity, unbalance, rotor.external_damping, phase)

    def undamped_body(self) -> Body:
        return point_mass("journal", self.rotor.mass, 0.0)

    @property
    def mass(self) -> float:
        return self.rotor.mass

    @property
    def eccentricity(self) -> float:
        return unbalance_sizes(self.rotor) / self.rotor.mass

    @property
    def planes(self) -> tuple[BalancingPlane, ...]:
        return (BalancingPlane("journal", "journal", None, complex(self.rotor.unbalance)),)

    @property
    def dampings(self) -> tuple[tuple[str, float, str, str], ...]:
        return (("external damping", self.rotor.external_damping, "N*s/m", "of the rotor against the ground"),)

    def stations(self, machine: LinearRotor) -> Stations:
        journal = dict(machine.points)["journal"]
        return symmetric_stations(np.array([0.0, 1.0]), np.stack([journal, journal]))


@dataclass(frozen=True)
class JeffcottShaft(Shaft):
    """A disk on a massless elastic shaft."""

    rotor: JeffcottRotor

    elastic: ClassVar[bool] = True
    fronts: ClassVar[float] = 0.55
    disk_count: ClassVar[int] = 1
    freedoms: ClassVar[int] = 4

    def body(self) -> Body:
        rotor = self.rotor
        unbalance, phase = with_loss(rotor.unbalance, 0.0, rotor.loss)
        return jeffcott_rotor(
            rotor.mass, rotor.journal_mass, rotor.shaft_stiffness, unbalance, rotor.external_damping,
            rotor.shaft_damping, rotor.gravity, rotor.internal_damping, phase, cmath.rect(rotor.bow, rotor.bow_phase),
        )  # fmt: skip

    def undamped_body(self) -> Body:
        rotor = self.rotor
        return jeffcott_rotor(rotor.mass, rotor.journal_mass, rotor.shaft_stiffness, 0.0, 0.0, 0.0, 0.0)

    @property
    def mass(self) -> float:
        return self.rotor.mass + self.rotor.journal_mass

    @property
    def disk_mass(self) -> float:
        return self.rotor.mass

    @property
    def eccentricity(self) -> float:
        return unbalance_sizes(self.rotor) / self.rotor.mass

    @property
    def bow(self) -> float:
        return self.rotor.bow

    @property
    def bow_words(self) -> tuple[str, str]:
        where = f"{display(self.rotor.bow, 'm')} at {display(self.rotor.bow_phase, ANGLE)}"
        return where, "of the disk off the line of the journals"

    @property
    def planes(self) -> tuple[BalancingPlane, ...]:
        return (BalancingPlane("disk", "disk", None, complex(self.rotor.unbalance)),)

    @property
    def dampings(self) -> tuple[tuple[str, float, str, str], ...]:
        rotor = self.rotor
        return (
            ("external damping", rotor.external_damping, "N*s/m", "of the disk against the ground"),
            ("shaft damping", rotor.shaft_damping, "N*s/m", f"between disk and journals; {STANDS}"),
            ("internal damping", rotor.internal_damping, "N*s/m", f"between disk and journals; {TURNS}"),
        )

    @property
    def internally_damped(self) -> bool:
        return self.rotor.internal_damping > 0.0

    @property
    def compliance(self) -> float:
        return self.rotor.mass / self.rotor.shaft_stiffness

    @property
    def natural_frequencies(self) -> tuple[tuple[float, ...], str]:
        frequency = math.sqrt(self.rotor.shaft_stiffness / self.rotor.mass) / (2.0 * math.pi)
        return (frequency,), "in rigid bearings"

    def stations(self, machine: LinearRotor) -> Stations:
        """See Shaft: the massless shaft bends to both sides of its disk as a beam that is loaded there."""
        nodes = dict(machine.points)
        positions = np.linspace(0.0, 1.0, BENT)
        half = np.minimum(positions, 1.0 - positions)
        share = (3.0 * half - 4.0 * half**3)[:, None, None]
        return symmetric_stations(positions, (1.0 - share) * nodes["journal"] + share * nodes["disk"])
