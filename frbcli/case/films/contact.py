"""Contact of journal and shell: smooth surfaces, or rough ones whose summits touch."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import (
    BoundaryFriction,
    Length,
    Modulus,
    Quantity,
    Roughness,
    Stiffness,
    SummitDensity,
    SummitHeight,
    WearCoefficient,
)
from frbcli.units import NUMBER, display

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
