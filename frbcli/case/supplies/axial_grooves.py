"""Grooves along the axis over the whole width."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from frbcli.case.quantities import Angle, Count, OpeningAngle
from frbcli.case.supplies.supply import LargestFlow, Openings, Outline, Ramp, SpacedSupply, SupplyPressure
from frbcli.film.gap import AxialGroove, Edge


class AxialGrooves(SpacedSupply):
    """Axial grooves in the shell, evenly spaced."""

    kind: Literal["axial-grooves"] = Field(description="grooves along the axis, in the shell")
    count: Annotated[int, Count(1, 24, 1)] = Field(default=1, description="of grooves")
    position: Angle = Field(default=0.0, description="phi of the middle of the first")
    opening_angle: OpeningAngle = Field(description="of one groove")
    pressure: SupplyPressure
    ramp: Ramp = 0.0
    flow: LargestFlow = None

    divides: ClassVar[bool] = True
    rectangular: ClassVar[bool] = True

    def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
        return tuple(Outline(at, 0.5 * width, 0.5 * self.opening_angle, 0.5 * width) for at in self.positions)

    def openings(self, radius: float, width: float, ends: Edge, ambient: float) -> Openings:
        gauge = self.gauge(ambient)
        return Openings(grooves=tuple(AxialGroove(at, self.opening_angle, gauge) for at in self.positions))

    @property
    def gap(self) -> tuple[str, str]:
        why = "axial grooves divide the circumference; the film is symmetric about its middle"
        return f"{self.count} rectangles", why
