"""The support of a bearing: its shell is a body on springs and dampers, M u'' + C u' + K u = weight + what acts on it.

Film or coefficients act between the shaft, or the ring, and that body. Equal bearings of a symmetric rotor move alike:
one body represents both, with twice their mass, stiffness and damping. """

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frbcli.case.schema import Case
from frbcli.case.surroundings.support import Support
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.rotor.assembly import Link
from frbcli.rotor.body import point_mass
from frbcli.rotor.loads import LinearPart
from frbcli.units import display


@dataclass(frozen=True)
class SupportElement(MachineElement):
    """The shell of a bearing as a body. bearing: its name."""

    bearing: str
    given: Support

    symbol: ClassVar[str] = "spring"
    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
            if bearing.support is not None:
                yield cls(f"{key}.support", bearing.name, bearing.support)

    @property
    def node(self) -> str:
        """Name of the node of the shell."""
        return f"support_{self.bearing}".rstrip("_")

    def parts(self, site: Site) -> Parts:
        mount = LinearPart.of(np.diag(self.given.stiffness), np.diag(self.given.damping))
        link = Link(self.node, site.ground(self.bearing), site.count)
        return Parts((point_mass(self.node, site.count * self.given.mass, site.gravity),), ((link, mount),))

    def plan_line(self, site: Site) -> Line:
        springs = directions(self.given.stiffness, "N/m")
        damping = f", {directions(self.given.damping, 'N*s/m')}" if any(self.given.damping) else ", undamped"
        value = f"{self.bearing}: {display(self.given.mass, 'kg')} on springs".removeprefix(": ")
        why = "the shell is a body with its weight; what acts in the bearing acts between shaft and shell"
        return "support", value, f"{springs}{damping}; {why}"


def directions(both: tuple[float, float], unit: str) -> str:
    """Quantities of x and y in words."""
    x, y = (display(each, unit) for each in both)
    return x if x == y else f"{x} in x and {y} in y"
