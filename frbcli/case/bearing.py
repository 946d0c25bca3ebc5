"""The bearings of a case: one film, a floating ring between two films, a cartridge, or given coefficients."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field

from frbcli.case.elements import WITHOUT_FILM, BallBearingKeys, CoefficientsBearing
from frbcli.case.film import FilmGeometry, RingFilm
from frbcli.case.model import (
    ONE_OR_MANY,
    AlsoAs,
    Damping,
    Expansion,
    Identifier,
    Length,
    Model,
    Play,
    Position,
    RingInertia,
    RingMass,
    SpecificHeat,
    Stiffness,
    ThermalConductivity,
    Tilt,
    altered,
    named,
    repeated,
)
from frbcli.case.oil import AnyWall, Material
from frbcli.case.over_time import InputTemperature
from frbcli.case.surroundings import Damper, Support
from frbcli.materials import SOLIDS, Solid


class BearingWalls(Model):
    """Keys of a bearing that override the keys of [thermal]."""

    shaft: AnyWall | None = Field(default=None, description="replaces thermal.shaft")
    housing: AnyWall | None = Field(default=None, description="replaces thermal.housing")
    supply_temperature: InputTemperature | None = Field(
        default=None, description="replaces thermal.supply_temperature"
    )


Misalignment = Annotated[
    tuple[Tilt, Tilt] | None,
    Field(description="shell tilt about x, y; around a ring requires film.tilt = follows"),
]


class SingleFilmBearing(FilmGeometry, BearingWalls):
    """A journal in a shell with one film."""

    kind: Literal["single-film"] = Field(description="one film between journal and shell")
    name: Identifier = Field(default="", description="in results; numbered by default")
    position: Position | None = Field(default=None, description="along a turbocharger's shaft")
    damper: Damper | None = Field(default=None, description="squeeze film damper around shell or outer ring")
    support: Support | None = Field(default=None, description="shell as a body; fixed by default")
    misalignment: Misalignment = None
    pin: ClassVar[None] = None

    @property
    def films(self) -> tuple[FilmGeometry, ...]:
        """Its films, except a damper's."""
        return (self,)

    @property
    def film_keys(self) -> tuple[str, ...]:
        """Keys of its films in its table, in their order."""
        return ("",)

    def with_films(self, films: Sequence[FilmGeometry]) -> Self:
        """The bearing with other films."""
        (film,) = films
        assert isinstance(film, type(self))
        return film

    @property
    def parts(self) -> tuple[Self, ...]:
        """The bearing at each of its places along the shaft: itself."""
        return (self,)


class Ring(Model):
    """The floating ring, or the body of a cartridge."""

    given_mass: RingMass | None = Field(
        default=None,
        alias="mass",
        description="of one ring; default: from material, width and diameters",
    )
    given_inertia: RingInertia | None = Field(
        default=None,
        alias="inertia",
        description="about the axis; default: m (D_i^2 + D_o^2) / 8",
    )
    tilt_inertia: RingInertia | None = Field(
        default=None,
        description="about a diameter, for film.tilt = follows; default: half of inertia and m B^2/12; required "
        "for a cartridge",
    )
    width: Length | None = Field(
        default=None, description="for the default mass; default: of the wider film"
    )
    spin: Literal["free", "blocked"] = Field(
        default="free", description="turned by the films, or not turning"
    )
    material: Material = Field(default="brass", description="for conduction, heat and growth")
    conductivity: ThermalConductivity | None = Field(default=None, description="default: of the material")
    heat_capacity: SpecificHeat | None = Field(default=None, description="default: of the material")
    expansion: Expansion | None = Field(
        default=None, description="linear thermal, default: of the material"
    )

    @property
    def solid(self) -> Solid:
        """Its material, with its own figures."""
        own = {name: getattr(self, name) for name in ("conductivity", "heat_capacity", "expansion")}
        return replace(SOLIDS[self.material], **{name: value for name, value in own.items() if value is not None})


class Pin(Model):
    """A pin of the housing in a hole of the ring, which turns within its play and then pushes against it. It acts on
    the ring's rotation only."""

    radius: Length = Field(description="of the contact, from the axis")
    play: Play = Field(description="to either side, at this radius")
    stiffness: Stiffness = Field(description="of pin and hole, across the radius")
    damping: Damping = Field(default=0.0, description="in contact, without pull")


GivenPin = Annotated[
    Pin | None, Field(description="semi-floating ring; not in limit cycles")
]
CentrifugalPressure = Annotated[
    bool, Field(description="ring spin changes the pressure in its channels, (4.27) to (4.29)")
]
Channels = Annotated[
    Literal["pressure", "coupled"],
    Field(description="feed holes of the inner film: given pressure, or coupled to the outer film"),
]


class FloatingRingBearing(BearingWalls):
    """A ring between an inner and an outer film."""

    kind: Literal["floating-ring"] = Field(description="a ring between two films")
    name: Identifier = Field(default="", description="in results; numbered by default")
    position: Position | None = Field(default=None, description="along a turbocharger's shaft")
    ring: Ring = Field(description="mass and inertia, or what they follow from")
    inner: RingFilm = Field(description="between journal and ring")
    outer: RingFilm = Field(description="between ring and shell; its diameter: outer diameter of the ring")
    centrifugal_pressure: CentrifugalPressure = True
    channels: Channels = "pressure"
    pin: GivenPin = None
    damper: Damper | None = Field(default=None, description="squeeze film damper around shell or outer ring")
    support: Support | None = Field(default=None, description="shell as a body; fixed by default")
    misalignment: Misalignment = None

    @property
    def films(self) -> tuple[FilmGeometry, ...]:
        """Its films from the journal outwards, except a damper's."""
        return (self.inner, self.outer)

    @property
    def film_keys(self) -> tuple[str, ...]:
        """Keys of its films in its table, in their order."""
        return ("inner", "outer")

    def with_films(self, films: Sequence[FilmGeometry]) -> Self:
        """The bearing with other films."""
        inner, outer = films
        return altered(self, {"inner": inner, "outer": outer})

    @property
    def parts(self) -> tuple[FloatingRingBearing, ...]:
        """The bearing at each of its places along the shaft: itself."""
        return (self,)

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
    def ring_tilt_inertia(self) -> float:
        """Inertia of the ring about a diameter in kg m^2: as given, or I / 2 + m B^2 / 12 of a hollow cylinder."""
        if self.ring.tilt_inertia is not None:
            return self.ring.tilt_inertia
        return 0.5 * self.ring_inertia + self.ring_mass * self.ring_width**2 / 12.0

    @property
    def ring_width(self) -> float:
        """Axial width of the ring in m: as given, or the wider film's."""
        return max(self.inner.width, self.outer.width) if self.ring.width is None else self.ring.width


_Films = Annotated[tuple[RingFilm, RingFilm], repeated(2), AlsoAs(lambda both: [both["prefixItems"][0], both])]
SIDES = ("left", "right")  # of a cartridge; left is towards smaller positions


class CartridgeBearing(BearingWalls):
    """One rigid ring over two journals, which moves and tilts, between two inner and two outer films."""

    kind: Literal["cartridge"] = Field(description="one ring over two inner and two outer films")
    name: Identifier = Field(default="", description="in results, with left or right")
    positions: tuple[Position, Position] = Field(description="of both journals along the shaft, ascending")
    ring: Ring = Field(description="requires mass, inertia and tilt_inertia")
    inner: _Films = Field(description="films between journals and ring: one table for both ends, or two")
    outer: _Films = Field(description="films between ring and shells, as inner; diameter: outer diameter of the ring")
    centrifugal_pressure: CentrifugalPressure = True
    channels: Channels = "pressure"
    pin: GivenPin = None
    damper: ClassVar[None] = None
    support: ClassVar[None] = None

    @property
    def films(self) -> tuple[FilmGeometry, ...]:
        """Its films: inner and outer one of the left end, then of the right one."""
        return tuple(film for pair in zip(self.inner, self.outer, strict=True) for film in pair)

    @property
    def film_keys(self) -> tuple[str, ...]:
        """Keys of its films in its table, in their order."""
        places = (("inner", self.inner), ("outer", self.outer))
        return tuple(key if one == other else f"{key}.{end}" for end in range(2) for key, (one, other) in places)

    def with_films(self, films: Sequence[FilmGeometry]) -> Self:
        """The bearing with other films."""
        return altered(self, {"inner": tuple(films[0::2]), "outer": tuple(films[1::2])})

    @property
    def body(self) -> tuple[float, float, float]:
        """Mass in kg, and inertias about the axis and about a diameter in kg m^2; the rules of a case ask for them."""
        ring = self.ring
        mass, inertia, tilt_inertia = ring.given_mass or 0.0, ring.given_inertia or 0.0, ring.tilt_inertia or 0.0
        return mass, inertia, tilt_inertia

    @property
    def parts(self) -> tuple[FloatingRingBearing, ...]:
        """Its two ends, each a floating ring with half of the mass and of the inertia: what joins them is theirs as one
        body, and so is its pin."""
        mass, inertia, _ = self.body
        half = {"given_mass": 0.5 * mass, "given_inertia": 0.5 * inertia}
        ring = altered(self.ring, {**half, "tilt_inertia": None})
        walls = {name: getattr(self, name) for name in BearingWalls.model_fields}
        return tuple(
            FloatingRingBearing(
                kind="floating-ring", name="_".join(word for word in (self.name, side) if word), position=position,
                ring=ring, inner=inner, outer=outer, centrifugal_pressure=self.centrifugal_pressure,
                channels=self.channels, pin=self.pin, **walls,
            )
            for side, position, inner, outer in zip(SIDES, self.positions, self.inner, self.outer, strict=True)
        )  # fmt: skip


FilmBearing = SingleFilmBearing | FloatingRingBearing
GivenBearing = SingleFilmBearing | FloatingRingBearing | CartridgeBearing | CoefficientsBearing | BallBearingKeys
Bearing = Annotated[GivenBearing, Field(discriminator="kind")]


def _numbered(given: object) -> object:
    """Several bearings without names are numbered, for results carry the names."""
    if not isinstance(given, list | tuple) or len(given) < 2:
        return given
    in_film = [bearing for bearing in given if _key(bearing, "kind") not in WITHOUT_FILM]
    # The one film of a symmetric rotor keeps the plain names of its signals next to elements.
    plain = in_film if len(in_film) == 1 and _key(in_film[0], "position") is None else []
    return [
        bearing if any(bearing is one for one in plain) else named(bearing, str(number))
        for number, bearing in enumerate(given, start=1)
    ]


def _key(bearing: object, key: str) -> object:
    return bearing.get(key) if isinstance(bearing, dict) else getattr(bearing, key, None)


Bearings = Annotated[tuple[Bearing, ...], BeforeValidator(_numbered), repeated(1), ONE_OR_MANY]
