"""The contract of all supplies of oil: what differs between the kinds is in their own files.

Angles are phi of the developed gap, z counts from the end of the bearing in m. The pressure of a supply is absolute in
the case file; everything that is made of it takes the gauge pressure, over the ambient one, 0 where nothing supplies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Flow, RiseTime
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number
from frbcli.case.surroundings.over_time import InputPressure, OverTime, largest, values_of
from frbcli.errors import Fault
from frbcli.film.gap import AxialGroove, Edge, Hole
from frbcli.units import NUMBER, display

if TYPE_CHECKING:
    from frbcli.case.supplies.bores import Bores

MIDDLE = 0.5  # of the width
TURNED = 1.0 - 1e-9  # share of a turn that counts as all of it: angles in degrees have round-off
SupplyPressure = Annotated[InputPressure, Field(description="absolute")]
Ramp = Annotated[
    RiseTime, Field(description="t_1 of (4.11), rise time in squeeze and whirl")
]

LargestFlow = Annotated[
    Flow | None,
    Field(description="flow limit of the whole bearing, at which the pressure falls"),
]


class Outline(NamedTuple):
    """An opening in the developed gap of the whole bearing: phi of its middle, z of its middle, half extents in rad and
    m. round: an ellipse, else a rectangle; through: it goes through the body around the film, else it is a recess."""

    position: float
    axial: float
    half_angle: float
    half_width: float
    round: bool = False
    through: bool = False


@dataclass(frozen=True)
class Openings:
    """How a supply opens into a film. copies: equal parts of the width, of which one is solved; far: the edge of this
    in the middle or at z = 1; far_pressure: gauge pressure in a groove there in Pa; grooves, holes: see film/gap.py."""

    copies: int = 2
    far: Edge = "symmetry"
    far_pressure: float = 0.0
    grooves: tuple[AxialGroove, ...] = ()
    holes: tuple[Hole, ...] = ()


class OilSupply(Model):
    """The base of all supplies, and what those answer that say nothing else."""

    kind: str

    plain: ClassVar[bool] = False  # the gap looks the same from every angle
    divides: ClassVar[bool] = False  # into a chain of lands between grooves along the axis
    feeds: ClassVar[bool] = True  # oil comes in, other than at the ends
    side_flow_factor: ClassVar[float] = 0.6  # beta of the flow of a concentric film: less than of a groove; own choice
    openings_word: ClassVar[str] = "grooves"  # what several of its openings are called
    sizes: ClassVar[tuple[str, ...]] = ("width", "diameter")  # keys that are no larger than the width of the bearing

    def absolute(self, ambient: float) -> float:
        """The absolute pressure of the supply in Pa, the largest one where it changes over time; of the air where
        nothing supplies."""
        return ambient

    @property
    def over_time(self) -> OverTime | None:
        """Its pressure over time, None where that does not change."""
        return None

    @property
    def largest_flow(self) -> float:
        """The most oil in m^3/s that it gives to the whole bearing, infinite where its pressure stays."""
        return math.inf

    def gauge(self, ambient: float) -> float:
        """The pressure of the supply over the ambient one, Pa; 0 where nothing supplies."""
        return self.absolute(ambient) - ambient

    @property
    def rise_time(self) -> float:
        """t_1 of (4.11) in s, 0 if the pressure is there at once."""
        return 0.0

    @property
    def surface(self) -> Literal["journal", "shell", "housing"]:
        """The body with which its openings turn: the journal, the body around the film, or none."""
        return "housing"

    @property
    def turns(self) -> bool:
        """Whether its openings are in a body that may turn."""
        return self.surface != "housing"

    @property
    def rectangular(self) -> bool:
        """Whether the gap is made of rectangles whose pressure is known along their edges."""
        return False

    @property
    def splits(self) -> bool:
        """Whether it divides the width into two equal films."""
        return False

    @property
    def mirrored(self) -> bool:
        """Whether its section is solved with z = 0 at the other end of the bearing."""
        return False

    @property
    def land_share(self) -> float:
        """Flow of a concentric film over the flow of two lands of half the width."""
        return 1.0

    @property
    def channels(self) -> Bores | None:
        """The feed holes that are channels where they are in a ring."""
        return None

    def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
        """Its openings in the gap of a bearing, radius and width in m."""
        return ()

    def openings(self, radius: float, width: float, ends: Edge, ambient: float) -> Openings:
        """How it opens into a film; radius, width of the bearing in m, its ends, the ambient pressure in Pa. Half of
        the width is solved if all openings lie in its middle."""
        holes = self.holes(radius, width, ambient)
        if all(hole.axial == MIDDLE * width for hole in holes):
            return Openings(holes=holes)
        return Openings(1, ends, holes=holes)

    def holes(self, radius: float, width: float, ambient: float) -> tuple[Hole, ...]:
        """Its outlines as holes with its pressure."""
        gauge = self.gauge(ambient)
        return tuple(
            Hole(outline.position, outline.axial, outline.half_angle, outline.half_width, gauge, outline.round)
            for outline in self.outlines(radius, width)
        )

    @property
    def words(self) -> str:
        """Its name and its pressure, for tables."""
        return self.kind.replace("-", " ")

    @property
    def gap(self) -> tuple[str, str]:
        """The line of the plan on the gap of a film without lobes: its shape, and the reason."""
        return "developed gap", f"with openings: {self.kind}"

    def faults(self, key: str) -> list[Fault]:
        """Faults of which no film can be made; key: of the supply."""
        return []

    @classmethod
    def breaches(
        cls, path: Path, given: Mapping[str, Any], diameter: float | None, width: float | None, ambient: float | None
    ) -> Iterator[Breach]:
        """Rules that its table, as given, breaks; diameter and width of the bearing in m, ambient pressure in Pa, None
        where they cannot be read."""
        pressure = min(values_of(given.get("pressure"), "Pa"), default=None)
        if pressure and ambient and pressure < ambient:
            problem = f"is {display(pressure, 'Pa')}, below the ambient pressure of {display(ambient, 'Pa')}."
            yield Breach((*path, "pressure"), problem, "Pressures are absolute: ambient plus gauge pressure.")
        count, angle = number(given, "count", NUMBER, 1.0), number(given, "opening_angle", "rad")
        if count and angle and count * angle >= TURNED * 2 * math.pi:
            problem = f"leaves no land between {count:.0f} {cls.openings_word}."
            yield Breach((*path, "opening_angle"), problem, "Make it smaller.")
        for key in cls.sizes:
            size = number(given, key, "m")
            if size and width and size > width:
                adjective, comparative = ("longer", "shorter") if key == "length" else ("wider", "narrower")
                problem = f"is {adjective} than the bearing ({display(width, 'm')})."
                yield Breach((*path, key), problem, f"Make it {comparative}.")


class PressureSupply(OilSupply):
    """A supply with a pressure of its own. Its class declares the keys `pressure` and `ramp` after its other ones."""

    if TYPE_CHECKING:
        pressure: float | OverTime
        ramp: float
        flow: float | None

    def absolute(self, ambient: float) -> float:
        return largest(self.pressure)

    @property
    def over_time(self) -> OverTime | None:
        return self.pressure if isinstance(self.pressure, OverTime) else None

    @property
    def rise_time(self) -> float:
        return self.ramp

    @property
    def largest_flow(self) -> float:
        return math.inf if self.flow is None else self.flow

    @property
    def words(self) -> str:
        up_to = "" if self.over_time is None else "up to "
        text = f"{super().words}, {up_to}{1e-5 * largest(self.pressure):.4g} bar"
        return text if self.flow is None else f"{text}, at most {display(self.flow, 'm^3/s')}"


class SpacedSupply(PressureSupply):
    """A supply with equal openings, evenly spaced around the bearing: `count` of them, the first at `position`."""

    if TYPE_CHECKING:
        count: int
        position: float

    @property
    def positions(self) -> tuple[float, ...]:
        """phi of the middles of its openings, rad."""
        return tuple(self.position + i * 2.0 * math.pi / self.count for i in range(self.count))

    @property
    def words(self) -> str:
        return f"{self.count} {super().words}" if self.count > 1 else super().words
