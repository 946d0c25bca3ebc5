"""A case: one machine and one run as the user describes them, frozen, in SI.

Keys of the file that are no Python words have other attribute names: `from` and `to` of [speed] are `start` and `end`,
`two-phase` of [film] is `two_phase`, [bearing] or [[bearing]] are `given_bearings`, [[disk]] is `disks`. `clearance`
and `viscosity` may be given as a law: the attributes of these names are its value. Of `given_bearings`, all tables
[[bearing]], `bearings` are those with a film and `elements` the others.
Rules that tie several keys together are in `checks.py`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, PrivateAttr, model_validator

from frbcli.case.bearing import Bearings, FilmBearing, FloatingRingBearing, SingleFilmBearing
from frbcli.case.elements import Axial, CoefficientsBearing, Element, ThrustBearings
from frbcli.case.film_geometry import FilmGeometry, RingFilm
from frbcli.case.laws import Cavitation, adopt, attribute
from frbcli.case.model import Model, altered, with_default
from frbcli.case.oil import Oil
from frbcli.case.quantities import (
    Angle,
    BoundaryFriction,
    Count,
    Displacement,
    Duration,
    Eccentricity,
    FirstSpeed,
    Force,
    Hold,
    Label,
    Length,
    Modulus,
    Quantity,
    Rate,
    Roughness,
    SignedSpeed,
    Speed,
    Stiffness,
    SummitDensity,
    Tilt,
    TiltRate,
    Velocity,
    WearCoefficient,
)
from frbcli.case.reading.text import as_text
from frbcli.case.rotor import Disk, Rotor, ShaftSection
from frbcli.case.surroundings.base import Bases
from frbcli.case.surroundings.damper import Damper
from frbcli.case.surroundings.force import AppliedForce
from frbcli.case.surroundings.housing import Housing
from frbcli.case.surroundings.magnetic_pull import MagneticPull
from frbcli.case.surroundings.over_time import largest
from frbcli.case.theories import SHIPPED as THEORIES
from frbcli.case.theories import Theory, adopt_models, check_model
from frbcli.case.thermal import Thermal
from frbcli.errors import Fault, InputError
from frbcli.film.bearing_model import table as bearing_models
from frbcli.film.bearing_model.model import BearingModel
from frbcli.film.cavitation import table
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named
from frbcli.html import html_table
from frbcli.units import NUMBER, display

DEFAULT_HOLD = 0.5
OUTPUT_STEP = 5e-5  # resolves 10 kHz
COMPOSITE_MODULUS, BOUNDARY_FRICTION = 115e9, 0.1  # steel on steel, with a boundary layer of oil
FEW_TOUCH = 3.0  # roughnesses between two surfaces, beyond which few of their summits touch
CONTACT_BEGINS = 0.9999  # a gap of a ten-thousandth of the clearance; limit of the films
STEPS_PER_REVOLUTION = 40
MACRO_STEP = 1e-6  # table 6.2

Confirmation = Literal["surface-speed", "gap-growth", "clearance"]
FilmSignal = Literal["force", "film-thickness", "power", "torque", "oil-flow"]
Coupling = Literal["auto", "monolithic", "dynamic-static", "dynamic-static-semi-implicit", "co-simulation"]


class FilmModel(Model):
    """How the films are computed."""

    theory: Theory = Field(
        default="auto", description="of the Reynolds equation; or the name of a bearing model added from Python"
    )
    cavitation: Cavitation = Field(default="half-sommerfeld", description="model of cavitation, for all films")
    cavitation_factor: Literal["global", "local", "none"] = Field(
        default="global",
        description="torque of missing oil: reduced by the mean oil fraction (4.46), the local one, or not",
    )
    torque: Literal["all", "couette", "simple"] = Field(
        default="all", description="on floating rings: both terms of (3.17), the first term, or formula (4.6)"
    )
    coupling: Coupling = Field(default="auto", description="coupling of rotor and films in the time integration")
    grid: Literal["auto", "fixed", "half-speed"] = Field(
        default="auto",
        description="cells at rest, or turning with the mean speed of journal and shell (plain gaps); auto: turning "
        "for plain gaps that keep their oil",
    )
    solution: Literal["auto", "table", "cells"] = Field(
        default="auto", description="in runs: tabulated before the run where possible, or solved on cells"
    )
    tilt: Literal["none", "follows"] = Field(
        default="none",
        description="the gap is even along the axis, or follows the tilt of the shaft in it; in runs, stability, "
        "damped modes and response",
    )

    if TYPE_CHECKING:  # the tables of the laws, which these declare

        def __getattr__(self, name: str) -> Any: ...

    @property
    def bearing_model(self) -> str:
        """The name of the bearing model in `theory`, "" for a theory of the program."""
        return "" if self.theory in THEORIES else self.theory

    def given(self, cavitation: str) -> Any:
        """The values of the table [film.NAME] of a cavitation law by attribute, None if the law has no keys."""
        law = law_named(cavitation)
        return getattr(self, attribute(law)) if law.keys else None


adopt(FilmModel)


PointTime = Annotated[float, Quantity("s", "1 s", least=0)]


class SpeedRamp(Model):
    """Rotor speed [Hz]: linear from `start` to `end` in `duration`; a run-down holds it and goes back. Or through given
    points, from which these three follow."""

    start: FirstSpeed = Field(alias="from", description="at the start of a run; negative: it turns the other way round")
    end: Speed = Field(alias="to", description="at the end of the run-up")
    duration: Duration = Field(description="of the run-up")
    hold: Hold = Field(default=DEFAULT_HOLD, description="at the end speed, before a run-down")
    down_duration: Duration = Field(default=math.nan, description="of a run-down; the duration if not given")
    points: tuple[tuple[PointTime, Speed], ...] = Field(
        default=(), description="in place of from, to and duration: times, from 0 on, with speeds, linear between them"
    )
    file: Label = Field(
        default="", description="in place of points: CSV, WAV, MAT or UFF with the columns time and speed; from the "
        "case's folder",
    )  # fmt: skip
    tacho: Label = Field(default="", description="column of `file` with pulses, from which the speed follows")
    pulses: Annotated[int, Count(1, 10_000, 1)] = Field(default=1, description="of `tacho` in a revolution")
    times: tuple[PointTime, ...] = Field(
        default=(), description="what points or `file` hold: the case that a run keeps has them in place of these keys"
    )
    speeds: tuple[Speed, ...] = Field(default=(), description="at these times")

    @property
    def course(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times in s of the run-up with speeds in Hz, linear between them."""
        return (self.times, self.speeds) if self.times else ((0.0, self.duration), (self.start, self.end))

    @model_validator(mode="before")
    @classmethod
    def _down_as_fast_as_up(cls, data: object) -> object:
        return with_default(data, "down_duration", "duration")


class KinematicMotion(Model):
    """A kinematic test of a bearing: the motion of the journal is given."""

    film: Label = Field(
        default="",
        description="the film that is tested, by its name in results; must be given where there are several. What is "
        "outside of it is at rest",
    )
    eccentricity: Eccentricity | None = Field(default=None, description="displacement over the clearance")
    angle: Angle = Field(default=0.0, description="of the displacement, from the x-axis")
    load: Force | None = Field(default=None, description="in place of the displacement: a resting position")
    speed: SignedSpeed | None = Field(default=None, description="of the journal; the shell is at rest")
    eccentricity_rate: Rate = Field(default=0.0, description="of a rotation: rate of the eccentricity")
    whirl_speed: SignedSpeed = Field(default=0.0, description="of a rotation: whirl speed of the displacement")
    velocity: tuple[Velocity, Velocity] | None = Field(
        default=None, description="of a rotation: of the journal along x, y, in place of the two before"
    )
    tilt: tuple[Tilt, Tilt] | None = Field(
        default=None, description="of a rotation: of the journal about x, y through the middle of the bearing"
    )
    tilt_rate: tuple[TiltRate, TiltRate] | None = Field(
        default=None, description="of a rotation: how fast the journal tilts about x, y"
    )
    frequency: Speed | None = Field(default=None, description="of squeeze or whirl")
    periods: Annotated[float, Quantity(NUMBER, "3", above=0, most=1000)] = Field(
        default=3.0, description="of squeeze or whirl, that are computed"
    )

    @property
    def states_moment(self) -> bool:
        """Whether a rotation states the moment of the film force, too."""
        return any(given is not None for given in (self.velocity, self.tilt, self.tilt_rate))


class Start(Model):
    """Position of the journal at the start of a run."""

    position: Literal["centre", "resting"] = Field(
        default="centre", description="in the middle of the bearings, or where the rotor rests at the first speed"
    )
    displacement: tuple[Displacement, Displacement] | None = Field(default=None, description="x, y over clearance")


class Contact(Model):
    """Contact of journal and shell: smooth surfaces on an elastic shell, or rough ones, whose summits touch."""

    model: Literal["spring", "asperities"] = Field(
        default="spring", description="smooth surfaces, or mixed friction of rough ones, in all films"
    )
    policy: Literal["stop", "elastic"] = Field(
        default="stop", description="of a spring: a run ends where the surfaces touch, or an elastic shell pushes back"
    )
    eccentricity: Annotated[float, Quantity(NUMBER, "0.999", above=0.5, most=CONTACT_BEGINS)] = Field(
        default=CONTACT_BEGINS, description="at which smooth surfaces touch; films keep a gap beyond it"
    )
    stiffness: Stiffness | None = Field(default=None, description="of the surfaces, for the elastic policy")
    roughness: Roughness | None = Field(
        default=None, description="of both surfaces of asperities, the root of the sum of their squares"
    )
    summit_radius: Length | None = Field(default=None, description="of asperities, mean one of curvature")
    summit_density: SummitDensity | None = Field(default=None, description="of asperities, number over the area")
    modulus: Modulus = Field(
        default=COMPOSITE_MODULUS,
        description="of asperities, composite: 1/E = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2; steel on steel",
    )
    hardness: Modulus | None = Field(
        default=None, description="of the softer asperities, which yield there; elastic if not given"
    )
    wear: WearCoefficient | None = Field(
        default=None,
        description="Archard's coefficient of asperities, volume times hardness over force and path: runs then "
        "estimate the depth",
    )
    flow_factors: bool = Field(default=False, description="of asperities, on the flow of the film: not modelled yet")
    friction: BoundaryFriction = Field(default=BOUNDARY_FRICTION, description="coefficient between asperities")

    @property
    def rough(self) -> bool:
        """Whether summits of rough surfaces touch."""
        return self.model == "asperities"

    @property
    def about_summits(self) -> tuple[str, str] | None:
        """The line of the plan on rough surfaces: their roughness, and what they do; None between smooth ones."""
        if self.roughness is None:
            return None
        close = display(FEW_TOUCH * self.roughness, "m")
        reason = f"asperities carry beside the film in gaps below some {close}, with friction {self.friction:g}"
        return f"rough, {display(self.roughness, 'm')}", reason

    @property
    def wear_rate(self) -> float | None:
        """Volume that asperities lose over force and path, m^2/N; None where it is not asked for."""
        return None if self.wear is None or self.hardness is None else self.wear / self.hardness

    @property
    def gives_way(self) -> bool:
        """Whether a run goes on through contact."""
        return self.rough or self.policy == "elastic"


class Accuracy(Model):
    """Accuracy of the result: one target, or mesh and tolerance."""

    target: Annotated[float, Quantity(NUMBER, "1e-3", above=0, most=0.1)] = Field(
        default=1e-3, description="error of the eccentricities that is aimed at"
    )
    budget: Annotated[float, Quantity("s", "60 s", above=0)] | None = Field(
        default=None, description="CPU time of a run-up: the most exact within it, if the target needs more"
    )
    mesh: tuple[Annotated[int, Count(1, 400, 10)], Annotated[int, Count(4, 2000, 20)]] | None = Field(
        default=None, description="elements along the axis and around the circumference"
    )
    tolerance: Annotated[float, Quantity(NUMBER, "1e-6", above=0, most=0.1)] | None = Field(
        default=None, description="of the time integration, relative to the clearance"
    )
    steps_per_revolution: Annotated[int, Count(1, 100_000, 40)] = Field(
        default=STEPS_PER_REVOLUTION, description="at least; films on cells take fewer if not given"
    )
    macro_step: Annotated[float, Quantity("s", "1e-6 s", above=0)] = Field(
        default=MACRO_STEP, description="longest one of a co-simulation"
    )


class Output(Model):
    """Output of a run."""

    step: Annotated[float, Quantity("s", "5e-5 s", above=0)] = Field(
        default=OUTPUT_STEP, description="between the samples of a run file"
    )
    signals: tuple[FilmSignal, ...] = Field(
        default=(),
        description="what a run records of each film beside its eccentricity: the force on the journal, the smallest "
        "film thickness, the power that goes into the film, its torque on the journal, the oil that leaves "
        "it through its open ends",
    )


_UNCOMPUTED = {"name": "", "title": "", "confirm": ()}


class Case(Model):
    """One machine and one run, as the user describes them."""

    name: Label = Field(default="", description="short name for results; the file's name if not given")
    title: Label = Field(default="", description="of tables and pictures")
    confirm: tuple[Confirmation, ...] = Field(
        default=(),
        description="values outside the usual range that are intended; refused if not confirmed: a surface speed of a "
        "journal above 500 m/s, a clearance that changes by more than half by centrifugal growth, one below 1 um "
        "or above a tenth of the radius",
    )
    given_rotor: Rotor | None = Field(
        default=None, alias="rotor", description="must be given, but for a case with [motion]"
    )
    shaft: tuple[ShaftSection, ...] = Field(default=(), description="sections of the shaft of a turbocharger, in order")
    disks: tuple[Disk, ...] = Field(default=(), alias="disk", description="disks on the shaft of a turbocharger")
    forces: tuple[AppliedForce, ...] = Field(
        default=(), alias="force", description="forces on places of the machine beside unbalance and weight"
    )
    magnetic_pulls: tuple[MagneticPull, ...] = Field(
        default=(), alias="magnetic_pull", description="of electrical machines on places of the rotor"
    )
    bases: Bases = Field(default=(), alias="base", description="motion of the ground that the machine stands on")
    given_bearings: Bearings = Field(
        default=(), alias="bearing", description="one [bearing] for both of a symmetric rotor, or [[bearing]] for each"
    )
    thrust_bearings: ThrustBearings = Field(
        default=(), alias="thrust_bearing", description="pads beside a collar; must be given without a bearing"
    )
    axial: Axial | None = Field(
        default=None, description="load along the axis; without it thrust bearings are left out of the motion"
    )
    housing: Housing | None = Field(
        default=None, description="what all bearings stand in; they are fixed to the ground if not given"
    )
    given_oil: Oil | None = Field(
        default=None, alias="oil", description="the lubricant; must be given where a bearing has a film"
    )
    film: FilmModel = Field(default=FilmModel(), description="how the films are computed")
    thermal: Thermal | None = Field(default=None, description="heat; without it every film keeps its temperature")
    given_speed: SpeedRamp | None = Field(
        default=None, alias="speed", description="must be given, but for a case with [motion]"
    )
    motion: KinematicMotion | None = Field(default=None, description="motion of the journal in a kinematic test")
    start: Start = Field(default=Start(), description="where the rotor begins a run")
    contact: Contact = Field(default=Contact(), description="what happens where journal and shell touch")
    accuracy: Accuracy = Field(default=Accuracy(), description="target, or mesh and tolerance")
    output: Output = Field(default=Output(), description="what a run file holds")
    _read: tuple[str, dict[str, Any]] | None = PrivateAttr(None)  # a text, and the values that were read from it

    @property
    def heading(self) -> str:
        """The title, or the name of a case without one."""
        return self.title or self.name

    @property
    def source_text(self) -> str:
        """The case as TOML text, all overrides included; loading it gives this case again.

        It is the text that the case was read from; a case made or changed in Python has a text made from its values.
        """
        if self._read is not None and self._read[1] == self.__dict__:
            return self._read[0]
        return as_text(self, self.name, [bearing.name for bearing in self.given_bearings])

    def with_source_text(self, text: str) -> Case:
        """This case, which was read from `text`."""
        case = self.model_copy()
        case._read = (text, dict(case.__dict__))
        return case

    def __eq__(self, other: object) -> bool:
        """Whether all values are equal."""
        return isinstance(other, Case) and self.__dict__ == other.__dict__

    def __repr__(self) -> str:
        """Name, rotor and bearings: two lines."""
        rotor = "no rotor" if self.given_rotor is None else f"{self.given_rotor.kind} rotor"
        bearings = ", ".join(" ".join(word for word in (each.name, each.kind) if word) for each in self.given_bearings)
        return f"Case {self.name}: {self.title}\n{rotor}; bearings: {bearings}"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """In a notebook: its values in SI and as they are written."""
        from frbcli.case.reading.listing import values  # it is made of cases

        told = [(each.key, each.value, each.unit, each.shown if each.unit else "") for each in values(self)]
        return html_table(self.heading, ("key", "SI", "", "reads"), told, len(told))

    def with_settings(self, *settings: str | Mapping[str, object]) -> Case:
        """This case with other values of some keys, checked as a case file is; this case itself stays.

        settings: as `--set` takes them, "oil.viscosity = 50 mPa*s", or dicts of them by key, {"oil.viscosity": "50
        mPa*s"}, whose values are quantities with a unit, numbers in SI, or tables; None leaves a key out. Later ones
        take precedence. Raises InputError with every fault of the settings and of the case that they make.
        """
        from frbcli.case.reading.load import with_settings  # it reads cases

        return with_settings(self, settings)

    def same_run(self, other: Case) -> bool:
        """Whether `other` is the same machine and run; labels may differ."""
        return altered(self, _UNCOMPUTED) == altered(other, _UNCOMPUTED)

    @property
    def bearing_keys(self) -> tuple[str, ...]:
        """The keys of all bearings, with or without a film: "bearing", or "bearing.0" and on for several."""
        count = len(self.given_bearings)
        return ("bearing",) if count == 1 else tuple(f"bearing.{place}" for place in range(count))

    @property
    def bearings(self) -> tuple[FilmBearing, ...]:
        """The bearings that have a film, or two around a ring."""
        return tuple(bearing for bearing in self.given_bearings if not isinstance(bearing, Element))

    @property
    def elements(self) -> tuple[Element, ...]:
        """The bearings without a film."""
        return tuple(bearing for bearing in self.given_bearings if isinstance(bearing, Element))

    @property
    def films(self) -> tuple[FilmGeometry, ...]:
        """All films: of the bearings in their order, from the journal outwards, and behind them those of dampers."""
        own = (film for bearing in self.bearings for film in bearing.films)
        return (*own, *(bearing.damper for bearing in self.given_bearings if bearing.damper is not None))

    def with_films(self, films: Sequence[FilmGeometry]) -> Case:
        """This case with other films, in the order of `films`; values that the program has computed, as in
        `altered`."""
        left = iter(films)
        bearings = [bearing.with_films([next(left) for _ in bearing.films]) for bearing in self.given_bearings]
        damped = (b if b.damper is None else altered(b, {"damper": next(left)}) for b in bearings)
        return altered(self, {"given_bearings": tuple(damped)})

    @property
    def oil(self) -> Oil:
        """The lubricant. Raises InputError for a case without a film that has none."""
        if self.given_oil is None:
            fault = Fault("oil", "", None, "is missing: the case has no film.", "Add the table [oil].")
            raise InputError(self.name or "case", (fault,))
        return self.given_oil

    @property
    def rotor(self) -> Rotor:
        """The rotor. Raises InputError for a case of kinematic tests, which has none."""
        if self.given_rotor is None:
            raise self._without("rotor")
        return self.given_rotor

    @property
    def speed(self) -> SpeedRamp:
        """The speeds of a run. Raises InputError for a case of kinematic tests, which has none."""
        if self.given_speed is None:
            raise self._without("speed")
        return self.given_speed

    def _without(self, key: str) -> InputError:
        problem = "is missing: the case is for kinematic tests, with [motion]."
        remedy = f"Add the table [{key}], or call `frb rotation`, `frb squeeze` or `frb whirl`."
        if not self.given_bearings:
            problem = "is missing: the case is of thrust bearings alone."
            remedy = "Call `frb thrust`, or add [rotor], [speed] and [bearing]."
        return InputError(self.name or "case", (Fault(key, "", None, problem, remedy),))

    @property
    def heat(self) -> Thermal | None:
        """The model of heat, None without one."""
        return self.thermal if self.thermal is not None and self.thermal.model == "lumped" else None

    @property
    def oil_viscosity(self) -> float:
        """The dynamic viscosity [Pa s] of the oil: given, or at its temperature, or at that of the supply."""
        law = self.oil.law
        if law is not None and self.oil.temperature is None and self.thermal is not None:
            return law.at(largest(self.thermal.supply_temperature))
        return self.oil.viscosity

    def viscosity(self, film: FilmGeometry) -> float:
        """The dynamic viscosity [Pa s] in `film`, without heat: its own, by its own temperature, or that of the oil."""
        if film.viscosity is not None:
            return film.viscosity
        law = self.oil.law
        if film.temperature is not None and law is not None:
            return law.at(film.temperature)
        return self.oil_viscosity

    def cavitation(self, film: FilmGeometry) -> Cavitation:
        """The cavitation model of `film`: its own, or that of all films."""
        own = film.cavitation if isinstance(film, RingFilm) else None
        return self.film.cavitation if own is None else own

    @property
    def cavitations(self) -> tuple[Cavitation, ...]:
        """The cavitation models of all films, in the order of `films`."""
        return tuple(self.cavitation(film) for film in self.films)


def add_law(law: type[Law]) -> None:
    """Let film.cavitation take a law of one's own in this process, and [film.NAME] its keys.

    Parameters
    ----------
    law : type[CavitationLaw]
        The law. One of the same name that was added before is replaced.

    Raises
    ------
    ValueError
        If it is no law, or has the name of a shipped law or of a bearing model.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.add_law(MyLaw)  # doctest: +SKIP
    """
    if any(model.name == getattr(law, "name", None) for model in bearing_models.models()):
        raise ValueError(f"{law.__name__} has the name of a bearing model, {law.name}; choose another one")
    table.add(law)
    _adopt_laws()


def remove_law(name: str) -> None:
    """Take a law away that add_law has added.

    Parameters
    ----------
    name : str
        Name of the law.

    Raises
    ------
    KeyError
        For any other law.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.remove_law("mine")  # doctest: +SKIP
    """
    table.remove(name)
    _adopt_laws()


def _adopt_laws() -> None:
    adopt(FilmModel, (RingFilm, Damper))
    for holder in (SingleFilmBearing, FloatingRingBearing, CoefficientsBearing, Case):
        holder.model_rebuild(force=True)


def add_bearing(model: BearingModel) -> None:
    """Let film.theory take a bearing model of one's own in this process, and [film.NAME] its keys.

    Parameters
    ----------
    model : BearingModel
        The model, whose functions are compiled here. One of the same name that was added before is replaced.

    Raises
    ------
    InputError
        If it is no model, or numba cannot compile it.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.add_bearing(model)  # doctest: +SKIP
    """
    check_model(model, FilmModel)
    bearing_models.add(model)
    _adopt_bearings()


def remove_bearing(name: str) -> None:
    """Take a bearing model away that add_bearing has added.

    Parameters
    ----------
    name : str
        Name of the model.

    Raises
    ------
    KeyError
        For any other model.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.remove_bearing("damper")  # doctest: +SKIP
    """
    bearing_models.remove(name)
    _adopt_bearings()


def _adopt_bearings() -> None:
    adopt_models(FilmModel)
    Case.model_rebuild(force=True)


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a case file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Case.model_json_schema(by_alias=True)}
