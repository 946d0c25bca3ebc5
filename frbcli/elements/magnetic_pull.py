"""Magnetic pull: the force on the rotor is k d with its displacement d (2,) out of the middle of the stator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frbcli.case.schema import Case
from frbcli.case.surroundings.magnetic_pull import MagneticPull
from frbcli.case.surroundings.places import node_at
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.force import equal_places
from frbcli.rotor.assembly import GROUND, Link
from frbcli.rotor.loads import LinearPart
from frbcli.units import display


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
