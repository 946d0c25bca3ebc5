"""A groove around the bearing."""

from __future__ import annotations

import math
from typing import ClassVar, Literal

from pydantic import Field

from frbcli.case.quantities import Fraction
from frbcli.case.supplies.supply import MIDDLE, LargestFlow, Openings, Outline, PressureSupply, Ramp, SupplyPressure
from frbcli.errors import Fault
from frbcli.film.gap import Edge

SHOWN = 0.06  # half of its width over the bearing's in a sketch: not given in a case
ONE_LAND = 0.25  # flow of one land of the whole width over the flow of two lands of half of it


class CircumferentialGroove(PressureSupply):
    """A groove around the bearing, in the middle or at one end."""

    kind: Literal["circumferential-groove"] = Field(description="a groove around the bearing")
    axial_position: Fraction = Field(default=0.5, description="0.5: middle; 0 or 1: ends")
    pressure: SupplyPressure
    ramp: Ramp = 0.0
    flow: LargestFlow = None

    plain: ClassVar[bool] = True
    side_flow_factor: ClassVar[float] = 1.0

    @property
    def rectangular(self) -> bool:
        return self.axial_position in (0.0, MIDDLE, 1.0)

    @property
    def splits(self) -> bool:
        return self.axial_position == MIDDLE

    @property
    def mirrored(self) -> bool:
        """The groove of a section lies at z = 1."""
        return self.axial_position < MIDDLE

    @property
    def land_share(self) -> float:
        return 1.0 if self.splits else ONE_LAND

    def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
        """See OilSupply; all around, and as wide as a sketch shows it."""
        return (Outline(0.0, self.axial_position * width, math.pi, SHOWN * width, through=True),)

    def openings(self, radius: float, width: float, ends: Edge, ambient: float) -> Openings:
        return Openings(2 if self.splits else 1, "groove", self.gauge(ambient))

    @property
    def gap(self) -> tuple[str, str]:
        if self.splits:
            return "2 equal rectangles", "a central circumferential groove splits the width; one section is solved"
        return "1 rectangle", "a circumferential groove at one end: one section of the whole width"

    def faults(self, key: str) -> list[Fault]:
        if self.rectangular:
            return []
        problem = "is neither in the middle nor at an end: the two films would differ."
        return [Fault(f"{key}.axial_position", f"{self.axial_position:g}", None, problem, "Write 0.5, 0 or 1.")]
