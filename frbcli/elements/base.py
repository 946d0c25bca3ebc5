"""Motion of the ground: all masses feel its acceleration a as the load -M r a, with the displacement r of the whole
machine, and all displacements are those against the ground."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frbcli.case.schema import Case
from frbcli.case.surroundings.base import Base
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.force import changing_load
from frbcli.rotor.assembly import GROUND
from frbcli.units import display


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
