"""The contract of a shaft: what bodies, plans, costs, findings and pictures ask of it, whatever kind it is.

Symmetric rotors on two equal bearings: rigid (2.3) and Jeffcott (2.4).
"""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.case.rotor import JeffcottRotor, RigidRotor, unbalance_sizes, with_losses
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.rotor.assembly import Body, LinearRotor, assembled, jeffcott_rotor, point_mass
from frbcli.units import ANGLE, display

if TYPE_CHECKING:
    from frbcli.rotor.reduction import FreeModes, Reduction
    from frbcli.scene.machine.turbocharger import FreeShaft


@dataclass(frozen=True)
class Stations:
    """Places along a shaft. positions: (s,) in m, or over its length where a case gives none; maps: (s, 2, n) of the
    displacements there; to_scale: whether positions are in m; marks: names and positions of bearings and disks."""

    positions: Array
    maps: Array
    to_scale: bool
    marks: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class BalancingPlane:
    """A place of a shaft that has an unbalance and where masses can be added. node: of its machine; position: along
    the shaft in m, None where a case gives none; unbalance: in kg m, with its angle on the rotor."""

    name: str
    node: str
    position: float | None
    unbalance: complex


@dataclass(frozen=True)
class Shaft(ABC):
    """The shaft of a case with its disks."""

    case: Case

    equal_bearings: ClassVar[int] = 2  # represented by one bearing of the case
    gyroscopic: ClassVar[bool] = False  # whether its matrices depend on the speed
    tilts: ClassVar[bool] = False  # whether its journals do
    elastic: ClassVar[bool] = False  # whether its disk moves against its journals
    fronts: ClassVar[float]  # steps per revolution times the root of the tolerance, where fronts of oil cross cells
    bearings_modelled: ClassVar[tuple[str, str]] = (
        "1 of 2", "symmetric rotor and bearings: both journals have the same motion, forces count twice"
    )  # fmt: skip

    @abstractmethod
    def body(self) -> Body:
        """Its body. Raises InputError if it has no modes."""

    @abstractmethod
    def undamped_body(self) -> Body:
        """Its body with all its modes, without damping, unbalance and weight. Raises InputError if it has none."""

    @property
    @abstractmethod
    def mass(self) -> float:
        """Mass of shaft, disks and journals in kg."""

    @property
    @abstractmethod
    def disk_count(self) -> int:
        """Disks that a run records."""

    @property
    @abstractmethod
    def freedoms(self) -> int:
        """Degrees of freedom of its body, as expected before it is made."""

    @abstractmethod
    def stations(self, machine: LinearRotor) -> Stations:
        """The places along the shaft at which mode shapes are drawn. machine: with this shaft as its first body."""

    @property
    def beam_freedoms(self) -> int:
        """Degrees of freedom of a plane before the reduction to modes, 0 of a shaft that is not reduced."""
        return 0

    @property
    def reduction(self) -> Reduction | None:
        """What it is reduced to, None of a shaft that is not. Raises InputError if it has no modes."""
        return None

    @property
    @abstractmethod
    def eccentricity(self) -> float:
        """Distance of the centre of mass from the axis by the unbalance, all disks and losses in phase, m."""

    @property
    def bow(self) -> float:
        """Largest offset that it has without any load, m."""
        return 0.0

    @property
    def bow_words(self) -> tuple[str, str]:
        """Its bow for a plan, and where it is; of no meaning where it is straight."""
        return "", ""

    @property
    @abstractmethod
    def planes(self) -> tuple[BalancingPlane, ...]:
        """Its planes for balancing, with their unbalances."""

    @property
    def centre_of_mass(self) -> float | None:
        """Along the shaft in m, None where its bearings have no positions."""
        return None

    @property
    def disk_mass(self) -> float:
        """Mass in the middle of a symmetric rotor, kg."""
        return self.mass

    @property
    def internally_damped(self) -> bool:
        """Whether it has damping that turns with it."""
        return False

    @property
    @abstractmethod
    def dampings(self) -> tuple[tuple[str, float, str, str], ...]:
        """Its dampings for a plan, each with its value, the unit of that and what it acts on; 0 where it has none."""

    @property
    def compliance(self) -> float:
        """Mass over stiffness in rigid bearings, the inverse square of the natural frequency in rad/s; 0 of a shaft
        that does not bend or whose modes are not known before they are computed."""
        return 0.0

    @property
    def natural_frequencies(self) -> tuple[tuple[float, ...], str]:
        """The slowest ones in Hz, ascending, and how the shaft is supported then; ((), "") without any."""
        return (), ""

    def journal(self, name: str) -> str:
        """The node of the bearing with a name."""
        return "journal"

    def free_modes(self) -> FreeModes:
        """All its modes without bearings, of one plane. Raises InputError if it has none."""
        from frbcli.rotor.reduction import modes_of_plane

        machine = assembled([self.undamped_body()])
        n, places = machine.size // 2, self.stations(machine)
        return modes_of_plane(machine.mass[:n, :n], machine.stiffness[:n, :n], places.positions, places.maps[:, 0, :n])

    @property
    def held(self) -> Array:
        """(b, n) displacements of free_modes at the springs of all bearings, then their slopes at collars."""
        end = self.free_modes().shapes[0]
        return np.tile(math.sqrt(self.equal_bearings) * end, (len(self.case.placed_bearings), 1))

    def free(self) -> FreeShaft:
        """The shaft without bearings in its free modes. Raises InputError for one without sections."""
        kind = self.case.rotor.kind
        fault = Fault("rotor.kind", kind, None, "has no shaft of sections.", 'Take kind = "turbocharger".')
        raise self.case.refused(fault)


STANDS, TURNS = (
    "does not turn with the shaft, so that it damps every whirl",
    "turns with the shaft: it drives forward whirls that are slower than the rotor",
)


def symmetric_stations(positions: Array, maps: Array) -> Stations:
    """The stations of a symmetric rotor, with a disk in the middle where there are more places than its journals."""
    disk = (("disk", 0.5),) if len(positions) > 2 else ()
    return Stations(positions, np.asarray(maps), False, (("bearing", 0.0), *disk, ("bearing", 1.0)))


BENT = 21  # places along a shaft that bends


def _unbalance_of(rotor: RigidRotor | JeffcottRotor) -> complex:
    """In kg m, as a vector on the rotor, with a loss from the beginning."""
    return cmath.rect(*with_losses(rotor.unbalance, 0.0, rotor.losses))


@dataclass(frozen=True)
class RigidShaft(Shaft):
    """One mass that does not tilt."""

    rotor: RigidRotor

    fronts: ClassVar[float] = 0.2
    disk_count: ClassVar[int] = 0
    freedoms: ClassVar[int] = 2

    def body(self) -> Body:
        rotor = self.rotor
        unbalance, phase = with_losses(rotor.unbalance, 0.0, rotor.losses)
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
        return (BalancingPlane("journal", "journal", None, _unbalance_of(self.rotor)),)

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
        unbalance, phase = with_losses(rotor.unbalance, 0.0, rotor.losses)
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
        return (BalancingPlane("disk", "disk", None, _unbalance_of(self.rotor)),)

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
