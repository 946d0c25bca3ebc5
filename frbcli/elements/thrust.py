"""Thrust bearings, which have sheets of their own and are left out of the lateral motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

from frbcli.case.elements import ThrustBearing
from frbcli.case.schema import Case
from frbcli.elements.element import Line, MachineElement, Site


@dataclass(frozen=True)
class ThrustElement(MachineElement):
    """Pads beside a collar."""

    given: ThrustBearing

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        """See MachineElement."""
        return (cls(f"thrust_bearing.{number}", each) for number, each in enumerate(case.thrust_bearings))

    def told(self, site: Site) -> Line:
        """See MachineElement."""
        reason = "left out of the motion, which is lateral: neither their load nor the tilt of the collar; `frb thrust`"
        return "thrust bearing", f"{self.given.name}: left out".removeprefix(": "), reason
