"""A rectangular pocket."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from frbcli.case.quantities import Angle, Length, OpeningAngle
from frbcli.case.supplies.supply import LargestFlow, Outline, PressureSupply, Ramp, SupplyPressure


class Pocket(PressureSupply):
    """A pocket in the shell, in the middle of the width."""

    kind: Literal["pocket"] = Field(description="one rectangular pocket in the shell")
    position: Angle = Field(description="phi of its middle")
    opening_angle: OpeningAngle = Field(description="of the pocket")
    width: Length = Field(description="axial")
    pressure: SupplyPressure
    ramp: Ramp = 0.0
    flow: LargestFlow = None

    def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
        return (Outline(self.position, 0.5 * width, 0.5 * self.opening_angle, 0.5 * self.width),)
