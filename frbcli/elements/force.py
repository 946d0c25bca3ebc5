"""Constant forces on places of a machine."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

from frbcli.case.schema import Case
from frbcli.case.surroundings.force import AppliedForce
from frbcli.case.surroundings.places import node_at
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.rotor.assembly import NodeForce
from frbcli.units import display


@dataclass(frozen=True)
class ForceElement(MachineElement):
    """A force on a node. At equal bearings there are as many of it, since each has a node of its own."""

    node: str
    given: AppliedForce

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        """See MachineElement."""
        for number, force in enumerate(case.forces):
            yield cls(f"force.{number}", node_at(case, force.at), force)

    def count(self, site: Site) -> float:
        """Equal forces in the machine."""
        return 1.0 if self.node.startswith("disk") else site.count

    def parts(self, site: Site) -> Parts:
        """See MachineElement."""
        x, y = self.given.force
        count = self.count(site)
        return Parts(forces=(NodeForce(self.node, (count * x, count * y)),))

    def told(self, site: Site) -> Line:
        """See MachineElement."""
        x, y = (display(each, "N") for each in self.given.force)
        where = "at each of both equal bearings" if self.count(site) > 1.0 else "at one place"
        value = f"{self.node.replace('_', ' ')}: {x} in x, {y} in y"
        return "force", value, f"constant, {where}; beside unbalance and weight"
