"""How oil enters a film: the contract of all supplies, a class for each kind, and their table, a row each.

Angles are phi of the developed gap, z counts from the end of the bearing in m. The pressure of a supply is absolute in
the case file; everything that is made of it takes the gauge pressure, over the ambient one, 0 where nothing supplies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Union, get_args

from pydantic import Field

from frbcli.case.model import Angle, Count, Flow, Fraction, Length, Model, OpeningAngle, RiseTime
from frbcli.case.over_time import InputPressure, OverTime, largest, values_of
from frbcli.case.reading.tables import Breach, Path, number
from frbcli.errors import Fault
from frbcli.film.gap import AxialGroove, Edge, Hole
from frbcli.units import NUMBER, display

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

    def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
        """Its openings in the developed gap of a whole bearing, radius and width in m, without their pressure."""
        return ()

    def openings(self, radius: float, width: float, ends: Edge, ambient: float) -> Openings:
        """How it opens into a film; radius, width of the bearing in m, its ends, the ambient pressure in Pa. Half of
        the width is solved if all openings lie in its middle."""
        holes = self.holes(radius, width, ambient)
        if all(hole.axial == MIDDLE * width for hole in holes):
            return Openings(holes=holes)
        return Openings(1, ends, holes=holes)

    def holes(self, radius: float, width: float, ambient: float) -> tuple[Hole, ...]:
        """Its outlines with its pressure."""
        return tuple(replace(outline, pressure=self.gauge(ambient)) for outline in self.outlines(radius, width))

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


class NoSupply(OilSupply):
    """No supply: oil enters at the ends only."""

    kind: Literal["none"] = Field(default="none", description="no groove, feed hole or pocket")

    plain: ClassVar[bool] = True
    feeds: ClassVar[bool] = False
    rectangular: ClassVar[bool] = True

    @property
    def gap(self) -> tuple[str, str]:
        return "1 rectangle", "plain bearing: the film is symmetric about its middle"


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

    def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
        """See OilSupply; all around, and as wide as a sketch shows it."""
        return (Hole(0.0, self.axial_position * width, math.pi, SHOWN * width, through=True),)

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

    def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
        return tuple(Hole(at, 0.5 * width, 0.5 * self.opening_angle, 0.5 * width) for at in self.positions)

    def openings(self, radius: float, width: float, ends: Edge, ambient: float) -> Openings:
        gauge = self.gauge(ambient)
        return Openings(grooves=tuple(AxialGroove(at, self.opening_angle, gauge) for at in self.positions))

    @property
    def gap(self) -> tuple[str, str]:
        why = "axial grooves divide the circumference; the film is symmetric about its middle"
        return f"{self.count} rectangles", why


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

    def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
        axial, size = self.axial_position * width, 0.5 * self.diameter
        return tuple(Hole(at, axial, size / radius, size, round=True, through=True) for at in self.positions)

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


class Pocket(PressureSupply):
    """A pocket in the shell, in the middle of the width."""

    kind: Literal["pocket"] = Field(description="one rectangular pocket in the shell")
    position: Angle = Field(description="phi of its middle")
    opening_angle: OpeningAngle = Field(description="of the pocket")
    width: Length = Field(description="axial")
    pressure: SupplyPressure
    ramp: Ramp = 0.0
    flow: LargestFlow = None

    def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
        return (Hole(self.position, 0.5 * width, 0.5 * self.opening_angle, 0.5 * self.width),)


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

    def outlines(self, radius: float, width: float) -> tuple[Hole, ...]:
        half_angle, half_length = 0.5 * self.opening_angle, 0.5 * self.length
        return tuple(Hole(at, 0.5 * width, half_angle, half_length) for at in self.positions)


SUPPLIES: tuple[type[OilSupply], ...] = (
    NoSupply,
    CircumferentialGroove,
    AxialGrooves,
    Bores,
    Pocket,
    AxialSlots,
)

if TYPE_CHECKING:
    Supply = OilSupply  # others ask a supply by its base alone
else:
    Supply = Annotated[Union[SUPPLIES], Field(discriminator="kind")]  # noqa: UP007


def kind_of(supply: type[OilSupply]) -> str:
    """The word of the key `kind` of a supply."""
    return str(get_args(supply.model_fields["kind"].annotation)[0])


def supply_named(kind: object) -> type[OilSupply]:
    """The class of a kind of supply, their base for a word that is none."""
    return next((supply for supply in SUPPLIES if kind_of(supply) == kind), OilSupply)
