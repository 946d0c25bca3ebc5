"""The films of a case: the geometry of one film, how films are computed, and the tables [film.NAME] of cavitation laws.

Angles are phi of the developed gap: 0 at the top, counter-clockwise. Pressures are absolute. Widths are of the whole
bearing, both symmetric halves.

Contact of journal and shell: smooth surfaces, or rough ones whose summits touch.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, create_model
from pydantic.fields import FieldInfo

from frbcli.case.model import (
    LONGEST,
    PLAIN,
    Angle,
    BoundaryFriction,
    Clearance,
    Count,
    Duration,
    Expansion,
    Fraction,
    Length,
    Model,
    Modulus,
    Position,
    Preload,
    Quantity,
    Ratio,
    Roughness,
    Stiffness,
    SummitDensity,
    SummitHeight,
    Temperature,
    Viscosity,
    WearCoefficient,
    form_of,
)
from frbcli.case.oil import ROOM_TEMPERATURE
from frbcli.case.supplies import NoSupply, Supply
from frbcli.film.cavitation.law import Key, Law
from frbcli.film.cavitation.table import law_named, laws, names
from frbcli.film.gap import NO_BATH, LobedShell, ShellProfile, TabledShell
from frbcli.units import NUMBER, display

THEORIES = ("auto", "short", "finite")
if TYPE_CHECKING:
    Cavitation = str
    Theory = str
else:
    Cavitation = Literal[names()]
    Theory = Literal[THEORIES]

CAVITATION = "cavitation"  # the key that takes the name of a law


class FilmTable(Model):
    """A table [film.NAME], made from the keys of a law."""


def attribute(of: type[Law]) -> str:
    """The attribute of a FilmModel that holds the table of a law."""
    return of.name.replace("-", "_")


def adopt(film: type[Model], others: Iterable[type[Model]] = ()) -> None:
    """Give the model of [film] the table of every law that has keys and of no other, and its `cavitation` and that
    in `others` the names of all laws. Models that hold one of these have to be rebuilt by the caller."""
    fields = film.model_fields
    for name in [name for name, field in fields.items() if isinstance(field.default, FilmTable)]:
        del fields[name]
    for of in _with_keys():
        alias = None if attribute(of) == of.name else of.name
        made = Field(default=_table(of)(), alias=alias, description="keys of this model")
        fields[attribute(of)] = FieldInfo.from_annotated_attribute(_table(of), made)
    for model in (film, *others):
        its = model.model_fields[CAVITATION]
        all_laws: Any = Literal[names()]
        its.annotation = all_laws if its.default is not None else all_laws | None
        model.model_rebuild(force=True)


def __getattr__(name: str) -> Any:
    """The model of the table of this name: where copies of a case find it."""
    for of in _with_keys():
        if _table(of).__name__ == name:
            return _table(of)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def _with_keys() -> Iterator[Any]:
    return (law for law in laws() if law.keys)


@cache
def _table(of: Any) -> type[FilmTable]:
    entries: dict[str, Any] = {key.name: _entry(key) for key in of.keys}
    return create_model(of.__name__, __base__=FilmTable, __doc__=of.meaning, __module__=__name__, **entries)


def _entry(key: Key) -> Any:
    """Type and default of a key, as a model takes them."""
    kind: Any = Literal[key.choices]
    if not key.choices:
        unit = key.unit or NUMBER
        kind = Annotated[float, Quantity(unit, key.example, key.above, key.least, key.below, key.most)]
    if key.default is None:
        kind = kind | None
    return kind, Field(default=key.default, description=key.meaning or None)


class ColdClearance(Model):
    """A clearance that changes by thermal expansion, (4.24)."""

    cold: Clearance = Field(description="radial, at the reference temperature")
    reference_temperature: Temperature = Field(default=ROOM_TEMPERATURE, description="of `cold`")
    shell_temperature: Temperature = Field(description="in operation")
    journal_temperature: Temperature = Field(description="in operation")
    shell_expansion: Expansion = Field(description="linear thermal")
    journal_expansion: Expansion = Field(description="linear thermal")

    def warm(self, diameter: float) -> float:
        """The warm radial clearance [m] of a bearing of `diameter` [m]."""
        growth = self.shell_expansion * (self.shell_temperature - self.reference_temperature)
        growth -= self.journal_expansion * (self.journal_temperature - self.reference_temperature)
        return self.cold + 0.5 * diameter * growth


class ClearanceStep(Model):
    """A sudden change of the gap in a run; its oil stays."""

    time: Duration = Field(description="from the start of the run")
    clearance: Clearance = Field(description="radial, warm, from then on")


AnyClearance = Annotated[
    Annotated[Clearance, Tag(PLAIN)] | Annotated[ColdClearance, Tag("(ColdClearance)")],
    Discriminator(lambda given: form_of(given, ColdClearance)),
]


class Lobes(Model):
    """Equal lobes, machined with a larger radius than the assembled clearance."""

    count: Annotated[int, Count(2, 12, 3)] = Field(description="of lobes")
    preload: Preload = Field(
        description="1 - c_b / c_p: assembled clearance c_b (`clearance`), machined clearance c_p"
    )
    position: Angle = Field(default=0.0, description="phi of the middle of the first lobe")
    offset: Fraction = Field(
        default=0.5, description="narrowest place, as a share of the arc from its start, counter-clockwise"
    )


Gap = Annotated[float, Quantity("m", "35 um", above=0)]
Profile = Annotated[tuple[tuple[Angle, Gap], ...], Field(min_length=2, max_length=3600)]


class SealedEnds(Model):
    """Ends with a seal, such as a piston ring, to the air."""

    sealed: Fraction = Field(
        description="share of the open side flow that leaves: 1 open, 0 tight"
    )
    bath_level: ClassVar[float] = -LONGEST  # air


class PartBath(Model):
    """Ends in oil up to a level, in air above."""

    bath_level: Position = Field(description="height y of the oil over the middle of the shell")
    sealed: ClassVar[float] = 1.0


ENDS_BY_NAME: dict[str, SealedEnds | PartBath] = {
    "free-to-air": SealedEnds(sealed=1.0),
    "oil-bath": PartBath(bath_level=LONGEST),
}


AnyEnds = Annotated[
    Annotated[Literal["free-to-air", "oil-bath"], Tag(PLAIN)]
    | Annotated[SealedEnds, Tag("(SealedEnds)")]
    | Annotated[PartBath, Tag("(PartBath)")],
    Discriminator(lambda given: form_of(given, PartBath, SealedEnds)),
]


class FilmGeometry(Model):
    """The geometry of one film, its supply and its ends."""

    width: Length = Field(description="axial, of the whole bearing")
    diameter: Length = Field(description="of the journal")
    given_clearance: AnyClearance = Field(alias="clearance", description="radial, warm; or `{cold}`")
    clearance_steps: tuple[ClearanceStep, ...] = Field(default=(), description="sudden changes, in order of time")
    given_ends: AnyEnds = Field(
        default="free-to-air",
        alias="ends",
        description="no oil enters (4.36), or ends in oil; or `{sealed}` or `{bath_level}`",
    )
    supply: Supply = Field(default=NoSupply(), description="see below")
    lobes: Lobes | None = Field(default=None, description="default: a plain cylinder")
    profile: Profile | None = Field(
        default=None,
        description="replaces `lobes`: `[[phi, gap], ...]` of the centred journal over one turn, linear in between; no "
        "gap below the clearance",
    )
    viscosity: Viscosity | None = Field(default=None, description="default: oil.viscosity")
    temperature: Temperature | None = Field(default=None, description="for the viscosity by Vogel's law")
    side_flow_factor: Ratio | None = Field(
        default=None,
        description="beta of thermal.side_flow = concentric; default: 1 with a groove around, else 0.6",
    )

    @property
    def ends(self) -> Literal["free-to-air", "oil-bath"]:
        """What lies at the ends, beyond seals."""
        return "free-to-air" if self._ends.bath_level < 0.5 * self.diameter else "oil-bath"

    @property
    def _ends(self) -> SealedEnds | PartBath:
        return ENDS_BY_NAME[self.given_ends] if isinstance(self.given_ends, str) else self.given_ends

    @property
    def bath(self) -> float:
        """Height of the oil at free ends over the middle of the shell, over its radius, -1 without any."""
        return NO_BATH if self.ends == "oil-bath" else max(self._ends.bath_level / (0.5 * self.diameter), NO_BATH)

    @property
    def sealed(self) -> float:
        """Share of the flow of an open end that the ends let out, 1 without seals."""
        return self._ends.sealed

    @property
    def sealing(self) -> tuple[str, str] | None:
        """The line of the plan on sealed ends: their share, and its meaning; None without seals."""
        if self.sealed == 1.0:
            return None
        reason = "let out that share of the flow of open ends where a constant gap is fed in the middle or by a groove"
        return f"sealed, {self.sealed:g}", f"{reason}; air beyond"

    @property
    def shell(self) -> ShellProfile | None:
        """The shape of the shell, None of a cylinder."""
        if self.profile is not None:
            angles, gaps = zip(*self.profile, strict=True)
            return TabledShell(angles, tuple(gap / self.clearance - 1.0 for gap in gaps))
        given = self.lobes
        return None if given is None else LobedShell(given.count, given.preload, given.position, given.offset)

    @property
    def clearance(self) -> float:
        """The warm radial clearance [m]."""
        given = self.given_clearance
        return given.warm(self.diameter) if isinstance(given, ColdClearance) else given


class RingFilm(FilmGeometry):
    """A film inside or outside of a floating ring."""

    cavitation: Cavitation | None = Field(default=None, description="default: film.cavitation")


Coupling = Literal["auto", "monolithic", "dynamic-static", "dynamic-static-semi-implicit", "co-simulation"]


class FilmModel(Model):
    """How the films are computed."""

    theory: Theory = Field(
        default="auto", description="of the Reynolds equation"
    )
    cavitation: Cavitation = Field(default="half-sommerfeld", description="model of all films")
    cavitation_factor: Literal["global", "local", "none"] = Field(
        default="global",
        description="torque reduced by the mean oil fraction (4.46), the local one, or not",
    )
    torque: Literal["all", "couette", "simple"] = Field(
        default="all", description="on floating rings: both terms of (3.17), the first, or formula (4.6)"
    )
    coupling: Coupling = Field(default="auto", description="of rotor and films in time")
    grid: Literal["auto", "fixed", "half-speed"] = Field(
        default="auto",
        description="fixed cells, or turning with the mean surface speed; auto: turning for mass-conserving plain gaps",
    )
    solution: Literal["auto", "table", "cells"] = Field(
        default="auto", description="in runs: tabulated where possible, or finite volumes"
    )
    tilt: Literal["none", "follows"] = Field(
        default="none",
        description="gap constant along the axis, or following the tilt of journals and rings",
    )

    if TYPE_CHECKING:  # the tables of the laws, which these declare

        def __getattr__(self, name: str) -> Any: ...

    def given(self, cavitation: str) -> Any:
        """The values of the table [film.NAME] of a cavitation law by attribute, None if the law has no keys."""
        law = law_named(cavitation)
        return getattr(self, attribute(law)) if law.keys else None


adopt(FilmModel)


COMPOSITE_MODULUS, BOUNDARY_FRICTION = 115e9, 0.1  # steel on steel, with a boundary layer of oil
FEW_TOUCH = 3.0  # roughnesses between two surfaces, beyond which few of their summits touch
CONTACT_BEGINS = 0.9999  # a gap of a ten-thousandth of the clearance; limit of the films


class Contact(Model):
    """Contact of journal and shell: smooth surfaces, or rough ones with asperities."""

    model: Literal["spring", "asperities"] = Field(
        default="spring", description="smooth surfaces, or mixed friction of rough ones, in all films"
    )
    policy: Literal["stop", "elastic"] = Field(
        default="stop", description="of a spring: contact ends the run, or an elastic shell pushes back"
    )
    eccentricity: Annotated[float, Quantity(NUMBER, "0.999", above=0.5, most=CONTACT_BEGINS)] = Field(
        default=CONTACT_BEGINS, description="at which smooth surfaces touch; films keep a gap beyond it"
    )
    stiffness: Stiffness | None = Field(default=None, description="for the elastic policy")
    roughness: Roughness | None = Field(
        default=None, description="of asperities, root of the sum of squares of both surfaces"
    )
    summit_radius: Length | None = Field(default=None, description="of asperities")
    summit_density: SummitDensity | None = Field(default=None, description="of asperities")
    mean_height: SummitHeight = Field(
        default=0.0, description="of asperities over the mean plane, sum of both surfaces"
    )
    modulus: Modulus = Field(
        default=COMPOSITE_MODULUS,
        description="composite, of asperities: 1/E = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2; default: steel on steel",
    )
    hardness: Modulus | None = Field(
        default=None, description="of the softer asperities, which yield there; elastic by default"
    )
    wear: WearCoefficient | None = Field(
        default=None,
        description="Archard's coefficient, volume times hardness over force and path: runs estimate the depth",
    )
    flow_factors: bool = Field(
        default=False, description="of asperities: finite-volume films with flow between rough surfaces"
    )
    journal_roughness: Roughness | None = Field(
        default=None, description="for flow factors; default: both surfaces are equal"
    )
    friction: BoundaryFriction = Field(default=BOUNDARY_FRICTION, description="coefficient of asperities")

    @property
    def rough(self) -> bool:
        """Whether summits of rough surfaces touch."""
        return self.model == "asperities"

    @property
    def about_summits(self) -> tuple[str, str] | None:
        """The line of the plan on rough surfaces: their roughness, and what they do; None between smooth ones."""
        if self.roughness is None:
            return None
        close = display(self.mean_height + FEW_TOUCH * self.roughness, "m")
        reason = f"asperities carry next to the film in gaps below some {close}, with friction {self.friction:g}"
        if self.flow_factors:
            reason += "; the film flows between them with flow factors"
        return f"rough, {display(self.roughness, 'm')}", reason

    @property
    def flow_roughness(self) -> float:
        """Roughness in m that the flow of the films follows, 0 where it is that between smooth surfaces."""
        return self.roughness if self.flow_factors and self.roughness is not None else 0.0

    @property
    def shear(self) -> float:
        """Share of the journal in the square of the roughness, less the shell's share."""
        if self.journal_roughness is None or self.flow_roughness == 0.0:
            return 0.0
        return 2.0 * (self.journal_roughness / self.flow_roughness) ** 2 - 1.0

    @property
    def wear_rate(self) -> float | None:
        """Volume that asperities lose over force and path, m^2/N; None where it is not asked for."""
        return None if self.wear is None or self.hardness is None else self.wear / self.hardness

    @property
    def gives_way(self) -> bool:
        """Whether a run goes on through contact."""
        return self.rough or self.policy == "elastic"
