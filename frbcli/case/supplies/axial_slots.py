"""Rectangular slots along the axis over a part of the width."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from frbcli.case.quantities import Angle, Count, Length, OpeningAngle
from frbcli.case.supplies.supply import LargestFlow, Outline, Ramp, SpacedSupply, SupplyPressure


class AxialSlots(SpacedSupply):
    """Axial slots in the middle of the shell, evenly spaced, closed at their ends."""

    kind: Literal["axial-slots"] = Field(description="slots along the axis over a part of the width, in the shell")
    count: Annotated[int, Count(1, 24, 2)] = Field(default=1, description="of slots")
    position: Angle = Field(default=0.0, description="phi of the middle of the first")
    opening_angle: OpeningAngle = Field(description="of one slot")
    length: Length = Field(description="axial")
    pressure: SupplyPressure
    ramp: Ramp = 0.0
    flow: LargestFlow = None

    openings_word: ClassVar[str] = "slots"
    sizes: ClassVar[tuple[str, ...]] = ("length",)

    def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
        half_angle, half_length = 0.5 * self.opening_angle, 0.5 * self.length
        return tuple(Outline(at, 0.5 * width, half_angle, half_length) for at in self.positions)
