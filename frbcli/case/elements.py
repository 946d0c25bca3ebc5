"""Elements of a machine that are no journal films, among its bearings, and thrust bearings: what they are given by.

`frbcli/elements/` holds what they do. A new kind of element has its model here and joins `Element`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag

from frbcli.case.film import FilmGeometry
from frbcli.case.model import (
    PLAIN,
    AlsoAs,
    Clearance,
    ContactAngle,
    Count,
    Damping,
    Density,
    Force,
    FrictionFactor,
    GrooveCurvature,
    Identifier,
    KinematicViscosity,
    Label,
    Length,
    Model,
    Modulus,
    OpeningAngle,
    Play,
    PoissonRatio,
    Position,
    PreloadForce,
    Quantity,
    SignedSpeed,
    TopSpeed,
    form_of,
    named,
)
from frbcli.case.over_time import Input, OverTime, is_over_time
from frbcli.case.surroundings import Damper, Support
from frbcli.materials import ROLLING, Elastic
from frbcli.units import is_number

Entry = Annotated[float, Quantity("N/m", "1e6 N/m")]
DampingEntry = Annotated[float, Quantity("N*s/m", "1e3 N*s/m")]
MassEntry = Annotated[float, Quantity("kg", "0.1 kg")]
AXES = ("xx", "xy", "yx", "yy")
AXIAL = Quantity("N", "40 N")
AxialForce = Annotated[float, AXIAL]


def _both_directions(given: object) -> object:
    """One quantity, used for both directions, without cross-coupling."""
    if is_number(given) or isinstance(given, str):
        return [[given, 0.0], [0.0, given]]
    return given


_Matrix = (
    BeforeValidator(_both_directions),
    AlsoAs(lambda matrix: [matrix["prefixItems"][0]["prefixItems"][0], matrix]),
)
StiffnessMatrix = Annotated[tuple[tuple[Entry, Entry], tuple[Entry, Entry]], *_Matrix]
DampingMatrix = Annotated[tuple[tuple[DampingEntry, DampingEntry], tuple[DampingEntry, DampingEntry]], *_Matrix]
MassMatrix = Annotated[tuple[tuple[MassEntry, MassEntry], tuple[MassEntry, MassEntry]], *_Matrix]


class CoefficientsOverSpeed(Model):
    """Values over speed: linear in between, constant beyond."""

    source: Label = Field(default="", description="file they were read from")
    speed: tuple[SignedSpeed, ...] = Field(description="ascending")
    kxx: tuple[Entry, ...] = Field(description="stiffness")
    kxy: tuple[Entry, ...] = Field(description="stiffness")
    kyx: tuple[Entry, ...] = Field(description="stiffness")
    kyy: tuple[Entry, ...] = Field(description="stiffness")
    cxx: tuple[DampingEntry, ...] = Field(description="damping")
    cxy: tuple[DampingEntry, ...] = Field(description="damping")
    cyx: tuple[DampingEntry, ...] = Field(description="damping")
    cyy: tuple[DampingEntry, ...] = Field(description="damping")
    mxx: tuple[MassEntry, ...] = Field(default=(), description="mass; 0 by default")
    mxy: tuple[MassEntry, ...] = Field(default=(), description="mass; 0 by default")
    myx: tuple[MassEntry, ...] = Field(default=(), description="mass; 0 by default")
    myy: tuple[MassEntry, ...] = Field(default=(), description="mass; 0 by default")


class BearingWithoutFilm(Model):
    """A bearing that has no film of its own."""

    pin: ClassVar[None] = None

    @property
    def films(self) -> tuple[FilmGeometry, ...]:
        """None; a damper's film does not count."""
        return ()

    @property
    def film_keys(self) -> tuple[str, ...]:
        """Keys of its films in its table."""
        return ()

    def with_films(self, films: Sequence[FilmGeometry]) -> Self:
        """The bearing itself."""
        assert not films
        return self

    @property
    def parts(self) -> tuple[Self, ...]:
        """The bearing at each of its places along the shaft: itself."""
        return (self,)


class CoefficientsBearing(BearingWithoutFilm):
    """Coefficients between shaft and ground or support: force -K d - C d' - M d'' on the shaft."""

    kind: Literal["coefficients"] = Field(description="given stiffness, damping and mass, without a film")
    name: Identifier = Field(default="", description="in results; numbered by default")
    position: Position | None = Field(default=None, description="along a turbocharger's shaft")
    stiffness: StiffnessMatrix | None = Field(
        default=None, description="one value, or [[xx, xy], [yx, yy]]; 0 by default"
    )
    damping: DampingMatrix | None = Field(
        default=None, description="as stiffness"
    )
    mass: MassMatrix | None = Field(
        default=None, description="as stiffness"
    )
    file: Label = Field(
        default="",
        description="replaces the three: .toml of ROSS or of `--ross`, or .csv with speed_Hz, kxx to kyy, cxx to cyy, "
        "optionally mxx to myy",
    )
    over_speed: CoefficientsOverSpeed | None = Field(default=None, description="contents of `file`, written by runs")
    damper: Damper | None = Field(default=None, description="squeeze film damper around shell or outer ring")
    support: Support | None = Field(default=None, description="shell as a body; fixed by default")


class RollingMaterial(Model):
    """A material of balls or rings."""

    modulus: Modulus = Field(description="of the material")
    poisson: PoissonRatio = Field(description="of the material")
    density: Density = Field(description="of the material")

    @property
    def solid(self) -> Elastic:
        """The material."""
        return Elastic(self.modulus, self.poisson, self.density)


OPPOSED = ("face-to-face", "back-to-back")  # arrangements of two rows that lean against each other


class BallFriction(Model):
    """Palmgren's friction, by the numbers of a catalogue: it brakes a rotor of free speed."""

    f1: FrictionFactor = Field(default=0.0, description="torque over pitch diameter and sum of ball loads")
    f0: FrictionFactor = Field(default=0.0, description="of the lubricant")
    viscosity: KinematicViscosity | None = Field(default=None, description="kinematic, with f0")


class AxialOffset(Model):
    """Preload by axially held rings."""

    offset: Play = Field(description="axial displacement of each inner ring from first contact")


_RollingName: Any = Literal[tuple(ROLLING)]
AnyRollingMaterial = Annotated[
    Annotated[_RollingName, Tag(PLAIN)] | Annotated[RollingMaterial, Tag("(RollingMaterial)")],
    Discriminator(lambda given: form_of(given, RollingMaterial)),
]
AnyPreload = Annotated[
    Annotated[PreloadForce, Tag(PLAIN)] | Annotated[AxialOffset, Tag("(AxialOffset)")],
    Discriminator(lambda given: form_of(given, AxialOffset)),
]


class BallBearingKeys(BearingWithoutFilm):
    """One or two rows of balls: angular contact, or deep groove."""

    kind: Literal["ball"] = Field(description="balls between two rings")
    name: Identifier = Field(default="", description="in results; numbered by default")
    position: Position | None = Field(default=None, description="along a turbocharger's shaft")
    balls: Annotated[int, Count(3, 100, 8)] = Field(description="in a row")
    ball_diameter: Length = Field(description="of the balls")
    pitch_diameter: Length = Field(description="circle of their centres")
    contact_angle: ContactAngle | None = Field(default=None, description="without load")
    radial_clearance: Play | None = Field(
        default=None, description="replaces the contact angle, of a deep groove: radial travel from side to side"
    )
    inner_curvature: GrooveCurvature = Field(default=0.52, description="groove radius over ball diameter")
    outer_curvature: GrooveCurvature = Field(default=0.53, description="groove radius over ball diameter")
    ball_material: AnyRollingMaterial = Field(
        default="steel", description="a name, or `{modulus, poisson, density}`"
    )
    ring_material: AnyRollingMaterial = Field(default="steel", description="a name, or `{modulus, poisson, density}`")
    arrangement: Literal["single", "face-to-face", "back-to-back", "tandem"] = Field(
        default="single", description="one row, or two"
    )
    row_distance: Length | None = Field(
        default=None, description="of an opposed pair, which then holds the shaft in tilt"
    )
    preload: AnyPreload = Field(
        default=0.0, description="axial, on each row: constant, by a spring, or `{offset}` of held rings"
    )
    locating: Literal["left", "right", "both"] | None = Field(
        default=None,
        description="carries the load of [axial] next to its preload: side towards which its fixed outer ring holds "
        "the shaft, or both, of an opposed pair with `{offset}`",
    )
    damping: Damping = Field(
        default=0.0, description="radial, between the rings; usual: 0.25e-5 to 2.5e-5 s times the stiffness"
    )
    cage: Literal["turning", "mean"] = Field(
        default="turning",
        description="balls pass in runs (in equilibrium one is below the shaft), or are spread evenly",
    )
    friction: BallFriction | None = Field(default=None, description="brakes a free speed")
    dynamic_rating: Force | None = Field(
        default=None, description="catalogue load rating C, for the life"
    )
    damper: Damper | None = Field(default=None, description="squeeze film damper around shell or outer ring")
    support: Support | None = Field(default=None, description="shell as a body; fixed by default")


Element = CoefficientsBearing | BallBearingKeys
WITHOUT_FILM = ("coefficients", "ball")  # kinds of bearings
EMPTY_MATRIX = ((0.0, 0.0), (0.0, 0.0))


class ThrustBearing(Model):
    """Equal fixed pads on one or both sides of a collar, with grooves at ambient pressure between them."""

    name: Identifier = Field(default="", description="in results; numbered by default")
    position: Position | None = Field(default=None, description="of the collar on a turbocharger's shaft")
    side: Literal["both", "left", "right"] = Field(
        default="both", description="side of the collar with pads; left: smaller positions"
    )
    inner_radius: Length = Field(description="of the pads")
    outer_radius: Length = Field(description="of the pads")
    pads: Annotated[int, Count(1, 60, 6)] = Field(description="on each side")
    pad_angle: OpeningAngle = Field(description="of a pad")
    taper_angle: OpeningAngle = Field(description="from leading edge to land; at most the pad angle")
    taper: Clearance = Field(description="depth of the leading edge below the land")
    profile: Literal["taper", "step"] = Field(
        default="taper", description="depth falls linearly to 0, or is constant up to the land"
    )
    end_play: Clearance | None = Field(
        default=None, description="sum of both gaps over the lands; required with pads on both sides"
    )


def _numbered(given: object) -> object:
    """Several tables with their numbers as names, where they have none, for results carry the names."""
    if isinstance(given, list | tuple) and len(given) > 1:
        return [named(part, str(number)) for number, part in enumerate(given, start=1)]
    return given


ThrustBearings = Annotated[tuple[ThrustBearing, ...], BeforeValidator(_numbered)]


class LoadAtSpeed(Model):
    """An axial load that grows with the speed squared."""

    at: TopSpeed = Field(description="speed with this load")
    load: AxialForce = Field(description="towards larger positions")

    def over(self, speed: float) -> float:
        """The load in N at a speed in Hz."""
        return self.load * (speed / self.at) ** 2


AnyLoad = Annotated[
    Annotated[float | OverTime, AXIAL, Input(AXIAL), Tag(PLAIN)] | Annotated[LoadAtSpeed, Tag("(LoadAtSpeed)")],
    Discriminator(lambda given: PLAIN if is_over_time(given) else form_of(given, LoadAtSpeed)),
]


class Axial(Model):
    """The axial load, with which thrust bearings act on the machine."""

    load: AnyLoad = Field(
        description="on the rotor, towards larger positions; or `{at, load}`"
    )

    @property
    def changes(self) -> bool:
        """Whether it is given over time."""
        return isinstance(self.load, OverTime)
