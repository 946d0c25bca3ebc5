"""Thrust bearings: under an axial load their films hold the collar in tilt; without one they are left out of motions.

A tilt of the collar about x and y changes the gaps of both sides, whose moments on it are -K a - C a' with the 2 x 2
stiffness and damping of all pads where the collar rests along the axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from frbcli.case.elements import ThrustBearing
from frbcli.case.schema import Case
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.supports import NODE
from frbcli.errors import Fault, NotConverged
from frbcli.rotor.assembly import COORDINATES, GROUND, PLANE, Link
from frbcli.rotor.loads import LinearPart

if TYPE_CHECKING:
    from frbcli.elements.collar import Collar

COLLAR = "collar"  # the node of the shaft
TILTS = COORDINATES[len(PLANE) :]
LEFT_OUT = "left out of the motion, for the case has no axial.load; `frb thrust`"
ALONG = "and does nothing else: a {} rotor moves in translation and does not tilt its collar"


@dataclass(frozen=True)
class ThrustElement(MachineElement):
    """Pads next to a collar. stand: the node that the pads stand on; rotor: kind of the rotor, "" without one; collar:
    what it carries, None without an axial load."""

    given: ThrustBearing
    stand: str = GROUND
    rotor: str = ""
    tilts: bool = False
    collar: Collar | None = None

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        collar = None
        if case.axial is not None:
            from frbcli.elements.collar import collar_of

            collar = collar_of(case)
        stand = GROUND if case.housing is None or case.housing.modes else NODE
        kind, tilts = ("", False) if case.given_rotor is None else (case.rotor.kind, not case.rotor.symmetric)
        for number, each in enumerate(case.thrust_bearings):
            yield cls(f"thrust_bearing.{number}", each, stand, kind, tilts, collar)

    @property
    def linear(self) -> LinearPart | None:
        """Stiffness and damping in tilt over the speed, None of a collar that does not act in tilt."""
        if self.collar is None or not self.tilts:
            return None
        from frbcli.elements.collar import tilt_part

        return tilt_part(self.collar)

    def parts(self, site: Site) -> Parts:
        linear = self.linear
        return Parts() if linear is None else Parts(links=((Link(COLLAR, self.stand, sees=TILTS), linear),))

    def plan_line(self, site: Site) -> Line:
        if self.collar is None or not self.collar.top:
            return "thrust bearing", f"{self.given.name}: left out".removeprefix(": "), LEFT_OUT
        rest = self.collar.rest(self.collar.top)
        value = f"gap {1e6 * rest.gap:.3g} um, loss {rest.torque * rest.omega:.3g} W"
        carries = f"carries {abs(rest.load):.4g} N at {rest.omega / (2.0 * math.pi):.4g} Hz"
        if not self.tilts:
            return "thrust bearing", value, f"{carries} {ALONG.format(self.rotor)}"
        tilt = rest.tilt_stiffness[0, 0]
        return "thrust bearing", value, f"{carries}; holds its collar in tilt with {tilt:.3g} N m/rad"

    def faults(self) -> list[Fault]:
        """A load that no film carries at the top speed, and one over time that is no load over the speed."""
        if self.collar is None or not self.collar.top:
            return []
        if self.collar.is_ambiguous:
            problem = "changes over time, and the speed does not rise all the time: a speed has more than one load."
            remedy = "Give one load, or one with the square of the speed."
            return [Fault("axial.load", "over time", None, problem, remedy)]
        try:
            self.collar.rest(self.collar.top)
        except NotConverged as error:
            problem = f"is not carried. {error}"
            remedy = "Lower it, or give the pads more area, the oil more viscosity."
            return [Fault("axial.load", "", None, problem, remedy)]
        return []
