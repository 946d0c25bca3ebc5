"""The geometry of one film: its gap, its ends and its supply.

Angles are phi of the developed gap: 0 at the top, counter-clockwise. Pressures are absolute. Widths are of the whole
bearing, both symmetric halves. """

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from frbcli.case.film_tables import Cavitation
from frbcli.case.model import Model
from frbcli.case.quantities import (
    Angle,
    Clearance,
    Count,
    Duration,
    Expansion,
    Fraction,
    Length,
    Position,
    Preload,
    Quantity,
    Ratio,
    Temperature,
    Viscosity,
)
from frbcli.case.supplies.none import NoSupply
from frbcli.case.supplies.table import Supply
from frbcli.case.thermal import ROOM_TEMPERATURE
from frbcli.film.gap import NO_BATH, LobedShell, ShellProfile, TabledShell


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
    Annotated[Clearance, Tag("(warm)")] | Annotated[ColdClearance, Tag("(cold)")],
    Discriminator(lambda given: "(cold)" if isinstance(given, dict | ColdClearance) else "(warm)"),
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


class PartBath(Model):
    """Ends in oil up to a level, in air above."""

    bath_level: Position = Field(description="height y of the oil over the middle of the shell")


def _ends_form(given: object) -> str:
    if isinstance(given, PartBath) or (isinstance(given, dict) and "bath_level" in given):
        return "(bath)"
    return "(sealed)" if isinstance(given, dict | SealedEnds) else "(open)"


AnyEnds = Annotated[
    Annotated[Literal["free-to-air", "oil-bath"], Tag("(open)")]
    | Annotated[SealedEnds, Tag("(sealed)")]
    | Annotated[PartBath, Tag("(bath)")],
    Discriminator(_ends_form),
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
        if isinstance(self.given_ends, PartBath):
            return "free-to-air" if self.given_ends.bath_level < 0.5 * self.diameter else "oil-bath"
        return "free-to-air" if isinstance(self.given_ends, SealedEnds) else self.given_ends

    @property
    def bath(self) -> float:
        """Height of the oil at free ends over the middle of the shell, over its radius, -1 without any."""
        if self.ends == "oil-bath" or not isinstance(self.given_ends, PartBath):
            return NO_BATH
        return max(self.given_ends.bath_level / (0.5 * self.diameter), NO_BATH)

    @property
    def sealed(self) -> float:
        """Share of the flow of an open end that the ends let out, 1 without seals."""
        return self.given_ends.sealed if isinstance(self.given_ends, SealedEnds) else 1.0

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
