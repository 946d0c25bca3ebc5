"""Heat in a case: the model, and what shaft and housing are to the films."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from frbcli.case.model import Model
from frbcli.case.quantities import Conductance, HeatCapacity, Quantity, Temperature
from frbcli.case.surroundings.over_time import InputTemperature, is_over_time
from frbcli.materials.solids import SOLIDS
from frbcli.units import NUMBER

ROOM_TEMPERATURE = 293.15
HOTTEST_FILM = 573.15  # K: 300 degC; engine oils burn there

QUASI_STEADY = "quasi-steady"

Material: Any = Literal[tuple(SOLIDS)]
Clearances = Literal["fixed", "follows"]


class WallNode(Model):
    """A body of one temperature at a film, which passes heat on."""

    capacity: HeatCapacity = Field(description="heat per K")
    conductance: Conductance = Field(description="heat flow per K")
    temperature: InputTemperature = Field(description="of the place it passes heat to")


def _wall_form(given: object) -> str:
    if isinstance(given, dict | WallNode) and not is_over_time(given):
        return "(node)"
    return "(adiabatic)" if given == "adiabatic" else "(temperature)"


AnyWall = Annotated[
    Annotated[Literal["adiabatic"], Tag("(adiabatic)")]
    | Annotated[InputTemperature, Tag("(temperature)")]
    | Annotated[WallNode, Tag("(node)")],
    Discriminator(_wall_form),
]


class Thermal(Model):
    """Films, rings, shaft and housing that warm up by dissipation; docs/heat.md."""

    model: Literal["lumped", "none"] = Field(
        default="lumped", description="one temperature per film, two per ring; none: constant temperatures"
    )
    supply_temperature: InputTemperature = Field(description="of the supplied oil")
    start_temperature: Temperature | None = Field(
        default=None,
        description="of films, rings and walls in a run; default: of the supply",
    )
    shaft: AnyWall = Field(
        default="adiabatic",
        description="`adiabatic`, a temperature, or `{capacity, conductance, temperature}`",
    )
    housing: AnyWall = Field(default="adiabatic", description="as shaft")
    clearance: Clearances = Field(
        default="fixed", description="follows the temperatures of journal, ring and shell (4.24)"
    )
    centrifugal_growth: Clearances = Field(
        default="fixed", description="clearances follow the growth of shafts and rings"
    )
    reference_temperature: Temperature = Field(
        default=ROOM_TEMPERATURE, description="of given clearances"
    )
    shaft_material: Material = Field(default="steel", description="for expansion and growth")
    housing_material: Material = Field(default="steel", description="for expansion and growth")
    mixing: Annotated[float, Quantity(NUMBER, "0.5", least=0.5, most=1)] = Field(
        default=0.5,
        description="m: film temperature: 0.5 mean of inlet and outlet, 1 outlet",
    )
    nusselt: Annotated[float, Quantity(NUMBER, "3.77", above=0, most=1000)] = Field(
        default=3.77, description="heat transfer to each wall, Nu k / C"
    )
    side_flow: Literal["film", "concentric"] = Field(
        default="film", description="of the solved film, or by formula for a concentric film"
    )
    films: Literal["states", "quasi-steady"] = Field(
        default="states", description="in runs films store heat, or are in balance at each instant"
    )
    hottest_film: Temperature = Field(
        default=HOTTEST_FILM, description="ends the run as `overheated`"
    )


def _without_heat(given: object) -> object:
    """None of a table that says no more than that there is no heat: it needs no temperature of the supply."""
    return None if given == {"model": "none"} else given


AnyThermal = Annotated[Thermal | None, BeforeValidator(_without_heat)]
