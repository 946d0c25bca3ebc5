"""Forces on places of a machine: given ones, motion of the ground, magnetic pull.

Given ones are constant, tables over time, or harmonic, as their cosine and sine parts,
F = Re(A exp(i (theta + phase))) with A = f in a direction and A = (f_x + i f_y, f_y - i f_x) rotating.

Motion of the ground: all masses feel its acceleration a as the load -M r a, with the displacement r of the whole
machine, and all displacements are those against the ground.

Magnetic pull: the force on the rotor is k d with its displacement d (2,) out of the middle of the stator.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from frbcli.case.over_time import node_at
from frbcli.case.schema import Case
from frbcli.case.surroundings import AppliedForce, Base, MagneticPull
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.rotor.assembly import GROUND, Link, NodeForce
from frbcli.rotor.loads import Harmonic, LinearPart, Load, linear_table
from frbcli.units import display

Array = NDArray[np.float64] | NDArray[np.complex128]


@dataclass(frozen=True)
class ForceElement(MachineElement):
    """A force on a node. At equal bearings there are as many of it, since each has a node of its own. name: of a load
    that changes, by the number of the force."""

    name: str
    node: str
    given: AppliedForce

    arrow: ClassVar[tuple[str, str] | None] = ("F", "a force")

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for number, force in enumerate(case.forces):
            yield cls(f"force.{number}", f"force {number + 1}", node_at(case, force.at), force)

    @property
    def acts_on(self) -> str:
        return self.node

    def parts(self, site: Site) -> Parts:
        given = self.given
        x, y = np.multiply(equal_places(self.node, site), given.amplitude).tolist()
        if given.constant:
            return Parts(forces=(NodeForce(self.node, (x, y)),))
        amplitude = np.array([x + 1j * y, y - 1j * x] if given.rotating else [x, y])
        return Parts(loads=((self.node, changing_load(self.name, amplitude, given)),))

    def plan_line(self, site: Site) -> Line:
        x, y = (display(each, "N") for each in self.given.amplitude)
        turning = f"{self.given.turning}, {'rotating, ' if self.given.rotating else ''}"
        where = "at each of both equal bearings" if equal_places(self.node, site) > 1.0 else "at one place"
        value = f"{self.node.replace('_', ' ')}: {x} in x, {y} in y"
        reason = f"{'constant, ' if self.given.constant else turning}{where}; besides unbalance and weight"
        return "force", value, reason


def changing_load(name: str, amplitude: Array, given: AppliedForce | Base) -> Load:
    """The load of an amplitude (2,) along x and y, complex if it rotates: a table over time, or harmonic."""
    if given.over_time is not None:
        return linear_table(name, np.diag(amplitude.real), given.over_time.time, *given.over_time.both)
    order, frequency = given.turns
    turned = amplitude * np.exp(1j * given.phase)
    columns = np.array([turned.real, -turned.imag])  # Re(A exp(i theta)) = Re A cos(theta) - Im A sin(theta)
    return Harmonic(name, columns, order, 2.0 * math.pi * frequency)


def equal_places(node: str, site: Site) -> float:
    """Number of places of the machine that a node represents."""
    return 1.0 if node.startswith(("disk", "housing")) else site.count


@dataclass(frozen=True)
class BaseElement(MachineElement):
    """The ground under the machine. name: of the load."""

    name: str
    given: Base

    arrow: ClassVar[tuple[str, str] | None] = ("B", "a motion of the ground")

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        single = len(case.bases) == 1
        for number, base in enumerate(case.bases):
            yield cls("base" if single else f"base.{number}", "base" if single else f"base {number + 1}", base)

    def parts(self, site: Site) -> Parts:
        load = changing_load(self.name, np.array(self.given.amplitude), self.given)
        return Parts(loads=((GROUND, load),))

    def plan_line(self, site: Site) -> Line:
        x, y = (display(each, "m/s^2") for each in self.given.amplitude)
        return "ground", f"{x} in x, {y} in y", f"{self.given.turning}; displacements are those against the ground"


@dataclass(frozen=True)
class MagneticPullElement(MachineElement):
    """A spring of negative stiffness between two nodes. node, stator: of the rotor, and of what the stator is fixed
    to."""

    node: str
    stator: str
    given: MagneticPull

    arrow: ClassVar[tuple[str, str] | None] = ("M", "a magnetic pull")
    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for number, pull in enumerate(case.magnetic_pulls):
            stator = node_at(case, pull.stator) if pull.stator else GROUND
            yield cls(f"magnetic_pull.{number}", node_at(case, pull.at), stator, pull)

    @property
    def acts_on(self) -> str:
        return self.node

    def parts(self, site: Site) -> Parts:
        pull = LinearPart.of(-self.given.pull * np.eye(2))
        return Parts(links=((Link(self.node, self.stator, equal_places(self.node, site)), pull),))

    def plan_line(self, site: Site) -> Line:
        value = f"{self.node.replace('_', ' ')}: {display(self.given.pull, 'N/m')}"
        stator = self.stator.replace("_", " ") or "the ground"
        return "magnetic pull", value, f"out of the middle of its stator, on {stator}; a spring of negative stiffness"
