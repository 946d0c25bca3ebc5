"""Given coefficients: the force on the shaft is -K d - C d' - M d'' with the displacement d (2,) of the shaft.

K, C and M may depend on the speed of the rotor; for the motion at each moment the speed at that moment counts. """

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.case.elements import AXES, EMPTY_MATRIX, CoefficientsBearing
from frbcli.case.schema import Case
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.errors import Fault
from frbcli.rotor.assembly import Link
from frbcli.rotor.loads import LinearPart


@dataclass(frozen=True)
class GivenCoefficients(MachineElement):
    """A bearing of given coefficients between shaft and shell."""

    given: CoefficientsBearing

    symbol: ClassVar[str] = "spring"

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
            if bearing.kind == "coefficients":
                yield cls(key, bearing)

    def parts(self, site: Site) -> Parts:
        name = self.given.name
        return Parts(links=((Link(site.journal(name), site.shell(name), site.count), self.linear),))

    @property
    def linear(self) -> LinearPart:
        """The coefficients in SI: constant, or over the speed."""
        table = self.given.over_speed
        if table is None:
            given = (self.given.stiffness, self.given.damping, self.given.mass)
            return LinearPart.of(*(np.array(EMPTY_MATRIX if each is None else each) for each in given))

        def matrices(letter: str) -> Array:
            columns = [getattr(table, f"{letter}{axes}") or (0.0,) * len(table.speed) for axes in AXES]
            return np.array(columns).T.reshape(-1, 2, 2)

        return LinearPart(2.0 * math.pi * np.array(table.speed), *(matrices(letter) for letter in "kcm"))

    def faults(self) -> list[Fault]:
        """A file that has not been read."""
        if not self.given.file:
            return []
        problem = "has not been read: the folder of the case is not known."
        remedy = "Load the case with load_case or case_from_dict."
        return [Fault(f"{self.key}.file", self.given.file, None, problem, remedy)]

    def plan_line(self, site: Site) -> Line:
        value, reason = self._values()
        return "bearings", f"{self.given.name}: {value}".removeprefix(": "), reason

    def _values(self) -> tuple[str, str]:
        table = self.given.over_speed
        if table is None:
            named = [name for name in ("stiffness", "damping", "mass") if getattr(self.given, name) is not None]
            return "given coefficients", f"constant {', '.join(named)}; linear, part of the rotor's matrices"
        source = f" from {table.source}" if table.source else ""
        low, high = table.speed[0], table.speed[-1]
        speeds = f"{len(table.speed)} speeds, {low:.4g} to {high:.4g} Hz"
        many = speeds if len(table.speed) > 1 else "one speed: constant"
        return f"given coefficients, over speed{source}", f"{many}; linear between them, constant beyond"
