"""The bearings of a case: one film, a floating ring between two films, or given coefficients; their ends.

Angles are phi of the developed gap: 0 at the top, counter-clockwise. Pressures are absolute. Widths are those of the
whole bearing, both symmetric halves.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, Tag
from pydantic_core import CoreSchema

from frbcli.case.elements import CoefficientsBearing
from frbcli.case.laws import Cavitation
from frbcli.case.model import Model, altered
from frbcli.case.quantities import (
    Angle,
    Clearance,
    Count,
    Duration,
    Expansion,
    Fraction,
    Identifier,
    Length,
    Mass,
    Position,
    Preload,
    Ratio,
    RingInertia,
    SpecificHeat,
    Temperature,
    ThermalConductivity,
    Viscosity,
)
from frbcli.case.supplies.none import NoSupply
from frbcli.case.supplies.table import Supply
from frbcli.case.surroundings.support import Support
from frbcli.case.thermal import ROOM_TEMPERATURE, AnyWall, Material
from frbcli.materials.solids import SOLIDS, Solid


class ColdClearance(Model):
    """A clearance at the reference temperature and its change by thermal expansion, equation (4.24)."""

    cold: Clearance = Field(description="radial clearance at the reference temperature")
    reference_temperature: Temperature = Field(default=ROOM_TEMPERATURE, description="temperature of `cold`")
    shell_temperature: Temperature = Field(description="in operation")
    journal_temperature: Temperature = Field(description="in operation")
    shell_expansion: Expansion = Field(description="coefficient of linear thermal expansion")
    journal_expansion: Expansion = Field(description="coefficient of linear thermal expansion")

    def warm(self, diameter: float) -> float:
        """The warm radial clearance [m] of a bearing of `diameter` [m]."""
        growth = self.shell_expansion * (self.shell_temperature - self.reference_temperature)
        growth -= self.journal_expansion * (self.journal_temperature - self.reference_temperature)
        return self.cold + 0.5 * diameter * growth


class ClearanceStep(Model):
    """A clearance from a given time of a run on: the gap changes suddenly, and the oil in it stays."""

    time: Duration = Field(description="from the start of the run")
    clearance: Clearance = Field(description="radial, warm, from this time on")


def _clearance_form(given: object) -> str:
    return "(cold)" if isinstance(given, dict | ColdClearance) else "(warm)"


AnyClearance = Annotated[
    Annotated[Clearance, Tag("(warm)")] | Annotated[ColdClearance, Tag("(cold)")], Discriminator(_clearance_form)
]


class Lobes(Model):
    """Equal lobes of the shell, machined with a larger radius than the assembled clearance (preload)."""

    count: Annotated[int, Count(2, 12, 3)] = Field(description="number of lobes")
    preload: Preload = Field(
        description="1 - c_b / c_p: `clearance` is c_b, the assembled clearance at the narrowest place of a lobe; "
        "c_p is the machined clearance of a lobe"
    )
    position: Angle = Field(default=0.0, description="phi of the middle of the first lobe")
    offset: Fraction = Field(
        default=0.5, description="narrowest place of a lobe, as a share of its arc from its start, counter-clockwise"
    )


class FilmGeometry(Model):
    """The geometry of one film, its supply and its ends."""

    width: Length = Field(description="axial width of the whole bearing")
    diameter: Length = Field(description="of the journal")
    given_clearance: AnyClearance = Field(alias="clearance", description="radial; warm, or a table with `cold`")
    clearance_steps: tuple[ClearanceStep, ...] = Field(default=(), description="sudden changes, in order of time")
    ends: Literal["free-to-air", "oil-bath"] = Field(
        default="free-to-air", description="no oil comes in at the ends (4.36), or they lie in oil at ambient pressure"
    )
    supply: Supply = Field(default=NoSupply(), description="where the oil comes from, see below")
    lobes: Lobes | None = Field(default=None, description="of the shell; a plain cylinder if not given")
    viscosity: Viscosity | None = Field(default=None, description="of this film, if not that of [oil]")
    temperature: Temperature | None = Field(default=None, description="of this film, for the viscosity by Vogel's law")
    side_flow_factor: Ratio | None = Field(
        default=None,
        description="beta of the flow of a concentric film, for thermal.side_flow; 1 for a groove around, else 0.6",
    )

    @property
    def clearance(self) -> float:
        """The warm radial clearance [m]."""
        given = self.given_clearance
        return given.warm(self.diameter) if isinstance(given, ColdClearance) else given


class BearingWalls(Model):
    """Keys of a bearing that take the place of those of [thermal]."""

    shaft: AnyWall | None = Field(default=None, description="of this bearing, if not thermal.shaft")
    housing: AnyWall | None = Field(default=None, description="of this bearing, if not thermal.housing")
    supply_temperature: Temperature | None = Field(
        default=None, description="of this bearing, if not that of [thermal]"
    )


class SingleFilmBearing(FilmGeometry, BearingWalls):
    """A journal in a shell with one film between them."""

    kind: Literal["single-film"] = Field(description="one film between journal and shell")
    name: Identifier = Field(default="", description="of the bearing in results; several are numbered if not given")
    position: Position | None = Field(default=None, description="along the shaft of a turbocharger")
    support: Support | None = Field(default=None, description="its shell as a body; fixed to the ground if not given")


class RingFilm(FilmGeometry):
    """A film inside or outside of a floating ring."""

    cavitation: Cavitation | None = Field(default=None, description="of this film, if not film.cavitation")


class Ring(Model):
    """The floating ring itself."""

    given_mass: Mass | None = Field(
        default=None, alias="mass",
        description="of one ring; from its material, which is then given, width and diameters if not given",
    )
    given_inertia: RingInertia | None = Field(
        default=None, alias="inertia",
        description="about the axis of rotation; m (D_i^2 + D_o^2) / 8 of its mass and diameters if not given",
    )
    width: Length | None = Field(
        default=None, description="axial, for a mass that is not given; that of the wider film if not given"
    )
    spin: Literal["free", "blocked"] = Field(
        default="free", description="whether the films turn the ring; a blocked one floats without turning"
    )
    material: Material = Field(default="brass", description="for conduction, heat and growth of the ring")
    conductivity: ThermalConductivity | None = Field(default=None, description="thermal, if not that of its material")
    heat_capacity: SpecificHeat | None = Field(default=None, description="specific, if not that of its material")
    expansion: Expansion | None = Field(
        default=None, description="coefficient of linear thermal expansion, if not that of its material"
    )

    @property
    def solid(self) -> Solid:
        """Its material, with its own figures."""
        own = {name: getattr(self, name) for name in ("conductivity", "heat_capacity", "expansion")}
        return replace(SOLIDS[self.material], **{name: value for name, value in own.items() if value is not None})


class FloatingRingBearing(BearingWalls):
    """A ring that floats between an inner film around the journal and an outer film in the shell."""

    kind: Literal["floating-ring"] = Field(description="a ring between two films")
    name: Identifier = Field(default="", description="of the bearing in results; several are numbered if not given")
    position: Position | None = Field(default=None, description="along the shaft of a turbocharger")
    ring: Ring = Field(description="mass and inertia of the ring, or what they follow from")
    inner: RingFilm = Field(description="film between journal and ring")
    outer: RingFilm = Field(description="film between ring and shell; its diameter is the outer one of the ring")
    centrifugal_pressure: bool = Field(
        default=True, description="whether the spin of the ring changes the pressure in its channels, (4.27) to (4.29)"
    )
    channels: Literal["pressure", "coupled"] = Field(
        default="pressure",
        description="feed holes of the inner film in the ring: at given pressure, or coupled to the outer film: "
        "oil that leaves one film enters the other",
    )
    support: Support | None = Field(default=None, description="its shell as a body; fixed to the ground if not given")

    @property
    def ring_mass(self) -> float:
        """Mass of the ring in kg: as given, or rho pi/4 (D_o^2 - D_i^2) B of a cylinder without feed holes."""
        if self.ring.given_mass is not None:
            return self.ring.given_mass
        area = 0.25 * math.pi * (self.outer.diameter**2 - self.inner.diameter**2)
        return self.ring.solid.density * area * self.ring_width

    @property
    def ring_inertia(self) -> float:
        """Inertia of the ring about its axis in kg m^2: as given, or m (D_i^2 + D_o^2) / 8 of a hollow cylinder."""
        if self.ring.given_inertia is not None:
            return self.ring.given_inertia
        return 0.125 * self.ring_mass * (self.inner.diameter**2 + self.outer.diameter**2)

    @property
    def ring_width(self) -> float:
        """Axial width of the ring in m: as given, or that of the wider film."""
        return max(self.inner.width, self.outer.width) if self.ring.width is None else self.ring.width


FilmBearing = SingleFilmBearing | FloatingRingBearing
Bearing = Annotated[SingleFilmBearing | FloatingRingBearing | CoefficientsBearing, Field(discriminator="kind")]


class _OneOrMany:
    """The schema of [bearing] or [[bearing]], for editors."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return handler(source)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        many = handler(schema)
        return {"anyOf": [many["items"], many]}


def _as_list(given: object) -> object:
    """One table as a list of one; several without names are numbered, for results carry the names."""
    if isinstance(given, dict | Model):
        return [given]
    if isinstance(given, list | tuple) and len(given) > 1:
        in_film = [bearing for bearing in given if not _without_film(bearing)]
        # The one film of a symmetric rotor keeps the plain names of its signals beside elements.
        plain = in_film if len(in_film) == 1 and _position(in_film[0]) is None else []
        return [
            bearing if any(bearing is one for one in plain) else _named(bearing, str(number))
            for number, bearing in enumerate(given, start=1)
        ]
    return given


def _position(bearing: object) -> object:
    return bearing.get("position") if isinstance(bearing, dict) else getattr(bearing, "position", None)


def _without_film(bearing: object) -> bool:
    if isinstance(bearing, dict):
        return bearing.get("kind") == "coefficients"
    return isinstance(bearing, CoefficientsBearing)


def _named(bearing: object, name: str) -> object:
    if isinstance(bearing, dict):
        return {"name": name, **bearing}
    if isinstance(bearing, SingleFilmBearing | FloatingRingBearing | CoefficientsBearing) and not bearing.name:
        return altered(bearing, {"name": name})
    return bearing


Bearings = Annotated[tuple[Bearing, ...], BeforeValidator(_as_list), _OneOrMany()]
