"""Round feed holes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from frbcli.case.quantities import Angle, Count, Fraction, Length
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number
from frbcli.case.supplies.supply import LargestFlow, Outline, Ramp, SpacedSupply, SupplyPressure
from frbcli.units import NUMBER, display


class Bores(SpacedSupply):
    """Equal feed holes in shell or journal, evenly spaced."""

    kind: Literal["bores"] = Field(description="round feed holes")
    count: Annotated[int, Count(1, 100, 6)] = Field(description="of feed holes")
    diameter: Length = Field(description="of a hole")
    axial_position: Fraction = Field(default=0.5, description="0 and 1: ends")
    position: Angle = Field(default=0.0, description="phi of the first")
    on: Literal["shell", "journal"] = Field(default="shell", description="surface with the holes")
    pressure: SupplyPressure
    ramp: Ramp = 0.0
    flow: LargestFlow = None

    @property
    def surface(self) -> Literal["journal", "shell", "housing"]:
        return self.on

    @property
    def channels(self) -> Bores | None:
        return self

    def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
        axial, size = self.axial_position * width, 0.5 * self.diameter
        return tuple(Outline(at, axial, size / radius, size, round=True, through=True) for at in self.positions)

    @property
    def words(self) -> str:
        return super().words.replace("bores", "feed holes")

    @classmethod
    def breaches(
        cls, path: Path, given: Mapping[str, Any], diameter: float | None, width: float | None, ambient: float | None
    ) -> Iterator[Breach]:
        yield from super().breaches(path, given, diameter, width, ambient)
        count, bore = number(given, "count", NUMBER, 1.0), number(given, "diameter", "m")
        place = number(given, "axial_position", NUMBER, 0.5)
        if count and bore and diameter and count * bore >= math.pi * diameter:
            problem = f"makes {count:.0f} feed holes overlap on a circumference of {display(math.pi * diameter, 'm')}."
            yield Breach((*path, "diameter"), problem, "Make it smaller, or take fewer feed holes.")
        if bore and width and bore <= width and place is not None and 0 <= place <= 1:
            over = 0.5 * bore - width * min(place, 1.0 - place)
            if over > 0.0:
                problem = f"places the feed holes {display(over, 'm')} outside the film."
                least = 0.5 * bore / width
                remedy = f"Take a value from {least:.3g} to {1.0 - least:.3g}, or smaller feed holes."
                yield Breach((*path, "axial_position"), problem, remedy)
