"""The oil of a case: its viscosity, given or over temperature, its density and its heat.

Heat in a case: the model, and what shaft and housing are to the films.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from frbcli.case.model import (
    PLAIN,
    Conductance,
    HeatCapacity,
    KinematicViscosity,
    Model,
    OilDensity,
    Quantity,
    SpecificHeat,
    Temperature,
    TemperatureDifference,
    ThermalConductivity,
    Viscosity,
    VogelOffset,
    form_of,
    with_default,
)
from frbcli.case.over_time import InputTemperature, is_over_time
from frbcli.case.reading.tables import number
from frbcli.materials import (
    OILS,
    SOLIDS,
    VogelLaw,
    conductivity,
    density,
    heat_capacity,
    through_three,
    walther,
)
from frbcli.units import KINEMATIC, NUMBER, ValueFault, is_kinematic, quantity

ATMOSPHERE = 1e5
USUAL_TEMPERATURE = 353.15  # K: 80 degC, of the density of a grade where no temperature is given
USUAL_DENSITY = 850.0
THIRD = 5.0 / 6.0  # of the distance of two temperatures: from 40 and 100 degC on to 150 degC

GradeName: Any = Literal[tuple(OILS)]


def _plain(name: str) -> str:
    """A grade without what its spellings differ in: "VG32" and "ISO VG 32", "0W20" and "SAE 0W-20" are one."""
    plain = re.sub(r"[\s-]", "", name).upper().removeprefix("ISO")
    return f"SAE{plain}" if re.fullmatch(r"\d+W\d+", plain) else plain


SPELLED = {_plain(name): name for name in OILS}


def _grade_in(oil: Mapping[str, Any]) -> str:
    """The grade of the viscosity, by itself or in a table, as it is written; other text where there is none."""
    given = oil.get("viscosity", "")
    return str(given.get("grade", "") if isinstance(given, dict) else getattr(given, "grade", given))


def with_grade(oil: Mapping[str, Any]) -> dict[str, Any]:
    """The table [oil] with the grade of its viscosity in a table, by the name that the library has."""
    name = _grade_in(oil)
    is_grade = _plain(name).startswith(("VG", "SAE"))
    return {**oil, "viscosity": {"grade": SPELLED.get(_plain(name), name)}} if is_grade else dict(oil)


@dataclass(frozen=True)
class _Constant(Quantity):
    """A quantity that a table over time cannot give."""

    def read(self, given: object) -> float:
        if is_over_time(given):
            problem = "changes over time, and the pressures of all films count from one that stays."
            raise ValueFault(problem, "Give one pressure; only the pressure of a supply may change over time.")
        return super().read(given)


ReferencePressure = Annotated[float, _Constant("Pa", "1 bar", above=0)]


class Vogel(Model):
    """Vogel's law (3.12): eta_0 exp(A / (T + C)), T in kelvin."""

    eta_0: Viscosity = Field(description="of (3.12)")
    A: TemperatureDifference = Field(description="of (3.12)")
    C: VogelOffset = Field(description="about -180 K; for a fit in Celsius, its C less 273.15 K")

    def law(self, _: float = USUAL_DENSITY) -> VogelLaw:
        """The viscosity over the temperature in K, Pa s."""
        return VogelLaw(self.eta_0, self.A, self.C)


class Grade(Model):
    """An oil of the library."""

    grade: GradeName = Field(description="SAE or ISO VG, see [heat](heat.md#oils-and-materials)")

    def law(self, _: float = USUAL_DENSITY) -> VogelLaw:
        """Vogel's law of the library."""
        return OILS[self.grade].law


class ViscosityPoints(Model):
    """Kinematic viscosity at two temperatures, elsewhere by Walther's rule (ASTM D341)."""

    points: tuple[tuple[Temperature, KinematicViscosity], tuple[Temperature, KinematicViscosity]] = Field(
        description='of a data sheet: [["40 degC", "46 cSt"], ["100 degC", "6.8 cSt"]], with oil.density'
    )

    def law(self, density_15: float) -> VogelLaw:
        """Vogel's law through both viscosities and a third one by Walther's rule; density in kg/m^3 at 15 degC."""
        first, second = sorted(self.points)
        third = second[0] + THIRD * (second[0] - first[0])
        beyond = walther(third, *((kelvin, 1e6 * nu) for kelvin, nu in (first, second)))
        known = (first, second, (third, 1e-6 * beyond))
        return through_three([t for t, _ in known], [nu * density(density_15, t) for t, nu in known])


AnyViscosity = Annotated[
    Annotated[Viscosity, Tag(PLAIN)]
    | Annotated[Grade, Tag("(Grade)")]
    | Annotated[ViscosityPoints, Tag("(ViscosityPoints)")],
    Discriminator(lambda given: form_of(given, ViscosityPoints, Grade)),
]


class Oil(Model):
    """The lubricant."""

    given_viscosity: AnyViscosity | None = Field(
        default=None,
        alias="viscosity",
        description='dynamic, or kinematic (`"12 cSt"`) with `density`; or `{ grade = "SAE '
        '10W-40" }` or `{ points = ... }`',
    )
    vogel: Vogel | None = Field(default=None, description="viscosity over temperature; replaces `viscosity`")
    temperature: Temperature | None = Field(default=None, description="of the films, for Vogel's law or a grade")
    shear_factor: Annotated[float, Quantity(NUMBER, "0.8", above=0, most=1)] = Field(
        default=1.0,
        description="viscosity at 1e6 to 1e7 1/s over low shear rates",
    )
    density: OilDensity = Field(
        default=USUAL_DENSITY,
        description="default: of the grade at `temperature`, or at 80 degC",
    )
    heat_capacity: SpecificHeat | None = Field(
        default=None, description="default: of petroleum oil of this density"
    )
    conductivity: ThermalConductivity | None = Field(
        default=None, description="default: of petroleum oil of this density"
    )
    ambient_pressure: ReferencePressure = Field(default=ATMOSPHERE, description="at the ends of the bearings, absolute")
    cavitation_pressure: ReferencePressure = Field(default=ATMOSPHERE, description="default: the ambient pressure")

    @classmethod
    def completed(cls, table: dict[str, Any]) -> dict[str, Any]:
        """With the dynamic viscosity where it gives a kinematic one and a density that can be read; with the density of
        its grade, and with the ambient pressure as that of cavitation, where it gives none."""
        rho = number(table, "density", "kg/m^3")
        if rho is not None and is_kinematic(table.get("viscosity")):
            table = {**table, "viscosity": quantity(table["viscosity"], KINEMATIC) * rho}
        table = with_grade(table)
        grade = OILS.get(_grade_in(table))
        if grade is not None and "density" not in table:
            temperature = number(table, "temperature", "K", USUAL_TEMPERATURE) or USUAL_TEMPERATURE
            table["density"] = density(grade.density_15, temperature)
        return with_default(table, "cavitation_pressure", "ambient_pressure")

    @property
    def law(self) -> VogelLaw | None:
        """Viscosity over temperature, with the factor for shear; None for a given viscosity."""
        given = self.vogel if self.given_viscosity is None else self.given_viscosity
        if given is None or isinstance(given, float):
            return None
        return given.law(self._density_15).times(self.shear_factor)

    @property
    def viscosity(self) -> float:
        """The dynamic viscosity [Pa s], given or by the law at the temperature."""
        law = self.law
        if law is not None and self.temperature is not None:
            return law.at(self.temperature)
        # the checks of a case file let no law without a temperature pass
        return self.given_viscosity if isinstance(self.given_viscosity, float) else math.nan

    def heat_capacity_at(self, temperature: float) -> float:
        """The specific heat capacity [J/(kg K)] at a temperature in K: given, or of a petroleum oil."""
        return self.heat_capacity or heat_capacity(self._density_15, temperature)

    @property
    def thermal_conductivity(self) -> float:
        """The thermal conductivity [W/(m K)]: given, or of a petroleum oil at 80 degC."""
        return self.conductivity or conductivity(self._density_15, USUAL_TEMPERATURE)

    @property
    def _density_15(self) -> float:
        """The density [kg/m^3] at 15 degC, the given one being that at the temperature of the films."""
        return self.density**2 / density(self.density, self.temperature or USUAL_TEMPERATURE)


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
    if given == "adiabatic":
        return "(adiabatic)"
    return PLAIN if is_over_time(given) else form_of(given, WallNode)


AnyWall = Annotated[
    Annotated[Literal["adiabatic"], Tag("(adiabatic)")]
    | Annotated[InputTemperature, Tag(PLAIN)]
    | Annotated[WallNode, Tag("(WallNode)")],
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
