"""A case: one machine and one run as the user describes them, frozen, in SI.

Keys of the file that are no Python words have other attribute names: `from` and `to` of [speed] are `start` and `end`,
`two-phase` of [film] is `two_phase`, [speed] is `speed_ramp`, [bearing] or [[bearing]] are `given_bearings`,
[[disk]] is `disks`. `clearance` and `viscosity` may be given as a law: the attributes of these names are its value.
`given_bearings` are all tables [[bearing]], `placed_bearings` the same with a cartridge as its two ends; of these
`bearings` are those with a film and `elements` the others.
Rules that tie several keys together are in `checks.py`.

Cavitation laws that were added from Python: cases take them in this process, with the keys of their tables.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from pydantic import Field, PrivateAttr

from frbcli.case.bearing import Bearings, CartridgeBearing, FilmBearing, FloatingRingBearing, SingleFilmBearing
from frbcli.case.elements import Axial, BallBearingKeys, CoefficientsBearing, Element, ThrustBearings
from frbcli.case.film import Cavitation, Contact, FilmGeometry, FilmModel, RingFilm, adopt
from frbcli.case.model import Label, Model, altered
from frbcli.case.oil import AnyThermal, Oil, Thermal
from frbcli.case.over_time import largest
from frbcli.case.reading.settings import as_text
from frbcli.case.rotor import Bow, Disk, Rotor, ShaftSection
from frbcli.case.run import Accuracy, Drive, KinematicMotion, Output, SpeedRamp, Start, given_speed_unit
from frbcli.case.surroundings import AppliedForce, Bases, Damper, Housing, MagneticPull, Spring
from frbcli.columns import html_table
from frbcli.errors import Fault, InputError
from frbcli.film.cavitation import table
from frbcli.film.cavitation.law import Law
from frbcli.units import SpeedUnit

Confirmation = Literal["surface-speed", "gap-growth", "clearance"]

_UNCOMPUTED = {"name": "", "title": "", "confirm": ()}


class Case(Model):
    """One machine and one run."""

    name: Label = Field(default="", description="for results; default: the file's name")
    title: Label = Field(default="", description="of tables and pictures")
    confirm: tuple[Confirmation, ...] = Field(
        default=(),
        description="accepted values outside the usual range: surface speed above 500 m/s, centrifugal growth above "
        "half the clearance, clearance below 1 um or above R/10",
    )
    given_rotor: Rotor | None = Field(
        default=None, alias="rotor", description="required unless there is [motion]"
    )
    shaft: tuple[ShaftSection, ...] = Field(default=(), description="shaft sections of a turbocharger, in order")
    disks: tuple[Disk, ...] = Field(default=(), alias="disk", description="on a turbocharger's shaft")
    bows: tuple[Bow, ...] = Field(default=(), alias="bow", description="of a turbocharger's shaft")
    forces: tuple[AppliedForce, ...] = Field(
        default=(), alias="force", description="besides unbalance and weight"
    )
    magnetic_pulls: tuple[MagneticPull, ...] = Field(
        default=(), alias="magnetic_pull", description="of electrical machines"
    )
    springs: tuple[Spring, ...] = Field(
        default=(), alias="spring", description="springs, dampers and stops"
    )
    bases: Bases = Field(default=(), alias="base", description="motion of the ground")
    given_bearings: Bearings = Field(
        default=(), alias="bearing", description="one for both of a symmetric rotor, or [[bearing]]"
    )
    thrust_bearings: ThrustBearings = Field(
        default=(), alias="thrust_bearing", description="pads at a collar; required without a bearing"
    )
    axial: Axial | None = Field(
        default=None, description="axial load; without it thrust bearings do not act on the motion"
    )
    housing: Housing | None = Field(
        default=None, description="carries all bearings; default: fixed to ground"
    )
    given_oil: Oil | None = Field(
        default=None, alias="oil", description="required for films"
    )
    film: FilmModel = Field(default=FilmModel(), description="film models")
    thermal: AnyThermal = Field(default=None, description="heat; without it temperatures are constant")
    speed_ramp: SpeedRamp | None = Field(
        default=None, alias="speed", description="required unless there is [motion] or [drive]"
    )
    drive: Drive | None = Field(default=None, description="speed by a torque; replaces [speed]")
    motion: KinematicMotion | None = Field(default=None, description="of the journal in a kinematic test")
    start: Start = Field(default=Start(), description="of a run")
    contact: Contact = Field(default=Contact(), description="of journal and shell")
    accuracy: Accuracy = Field(default=Accuracy(), description="target, or mesh and tolerance")
    output: Output = Field(default=Output(), description="contents of a run file")
    _read: tuple[str, dict[str, Any]] | None = PrivateAttr(None)  # a text, and the values that were read from it
    _speed_unit: SpeedUnit | None = PrivateAttr(None)

    @property
    def speed_unit(self) -> SpeedUnit:
        """The unit in which people read its rotor speeds: that in which the case gives them, unless set otherwise."""
        if self._speed_unit is not None:
            return self._speed_unit
        return given_speed_unit(self.source_text)

    def with_speed_unit(self, unit: SpeedUnit) -> Case:
        """This case with its rotor speeds in another unit for people; its values stay."""
        case = self.model_copy()
        case._speed_unit = unit
        return case

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

        rows = [(each.key, each.value, each.unit, each.shown if each.unit else "") for each in values(self)]
        return html_table(self.heading, ("key", "SI", "", "reads"), rows, len(rows))

    def with_settings(self, *settings: str | Mapping[str, object]) -> Case:
        """This case with other values of some keys, checked as a case file is; this case itself stays.

        settings: as `--set` takes them, "oil.viscosity = 50 mPa*s", or dicts of them by key, {"oil.viscosity": "50
        mPa*s"}, whose values are quantities with a unit, numbers in SI, or tables; None leaves a key out. Later ones
        take precedence. Raises InputError with every fault of the settings and of the case that they make.
        """
        from frbcli.case.reading.load import with_settings  # it reads cases

        return with_settings(self, settings)

    def refused(self, *faults: Fault) -> InputError:
        """The error of what cannot be done with this case."""
        return InputError(self.name or "case", faults)

    def same_run(self, other: Case) -> bool:
        """Whether `other` is the same machine and run; labels may differ."""
        return altered(self, _UNCOMPUTED) == altered(other, _UNCOMPUTED)

    @property
    def placed_bearings(self) -> tuple[FilmBearing | Element, ...]:
        """All bearings, with or without a film, at one place along the shaft each: a cartridge as its two ends."""
        return tuple(part for bearing in self.given_bearings for part in bearing.parts)

    @property
    def given_keys(self) -> tuple[str, ...]:
        """The keys of all tables [[bearing]]: "bearing", or "bearing.0" and on for several."""
        count = len(self.given_bearings)
        return ("bearing",) if count == 1 else tuple(f"bearing.{place}" for place in range(count))

    @property
    def bearing_keys(self) -> tuple[str, ...]:
        """The keys of all placed bearings."""
        keyed = zip(self.given_keys, self.given_bearings, strict=True)
        return tuple(key for key, bearing in keyed for _ in bearing.parts)

    @property
    def bearings(self) -> tuple[FilmBearing, ...]:
        """The placed bearings that have a film, or two around a ring."""
        return tuple(bearing for bearing in self.placed_bearings if not isinstance(bearing, Element))

    @property
    def elements(self) -> tuple[Element, ...]:
        """The bearings without a film."""
        return tuple(bearing for bearing in self.given_bearings if isinstance(bearing, Element))

    @property
    def films(self) -> tuple[FilmGeometry, ...]:
        """All films: of the bearings in their order, from the journal outwards, and behind them the films of
        dampers."""
        own = (film for bearing in self.given_bearings for film in bearing.films)
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
            raise self.refused(Fault("oil", "", None, "is missing: the case has no film.", "Add the table [oil]."))
        return self.given_oil

    @property
    def rotor(self) -> Rotor:
        """The rotor. Raises InputError for a case of kinematic tests, which has none."""
        if self.given_rotor is None:
            raise self._without("rotor")
        return self.given_rotor

    @property
    def polar_inertia(self) -> float:
        """Of the rotor with its disks about the axis of rotation [kg m^2], 0 where it is not known."""
        own = None if self.given_rotor is None else self.given_rotor.polar_inertia
        sections = sum(section.polar_inertia for section in self.shaft)
        return (own or 0.0) + sections + sum(disk.polar_inertia for disk in self.disks)

    @property
    def loads_a_collar(self) -> bool:
        """Whether thrust bearings bear the axial load."""
        return self.axial is not None and bool(self.thrust_bearings)

    @property
    def given_speed(self) -> SpeedRamp | None:
        """The speeds of a run, those that its drive is expected to reach at most; None of a case without any."""
        if self.drive is None or not self.polar_inertia:
            return self.speed_ramp
        return self.drive.expected(self.polar_inertia)

    @property
    def speed(self) -> SpeedRamp:
        """The speeds of a run, see given_speed. Raises InputError for a case of kinematic tests, which has none."""
        if self.given_speed is None:
            raise self._without("speed")
        return self.given_speed

    def _without(self, key: str) -> InputError:
        problem = "is missing: the case is for kinematic tests, with [motion]."
        remedy = f"Add the table [{key}], or call `frb rotation`, `frb squeeze` or `frb whirl`."
        if not self.given_bearings:
            problem = "is missing: the case is of thrust bearings alone."
            remedy = "Call `frb thrust`, or add [rotor], [speed] and [bearing]."
        elif not self.bearings:
            problem = "is missing: the case is of ball bearings alone."
            remedy = "Call `frb bearing` with --load and --speed, or add [rotor] and [speed]."
        return self.refused(Fault(key, "", None, problem, remedy))

    @property
    def heat(self) -> Thermal | None:
        """The model of heat, None without one."""
        return self.thermal if self.thermal is not None and self.thermal.model == "lumped" else None

    @property
    def oil_viscosity(self) -> float:
        """The dynamic viscosity [Pa s] of the oil: given, or at its temperature, or at the supply temperature."""
        law = self.oil.law
        if law is not None and self.oil.temperature is None and self.thermal is not None:
            return law.at(largest(self.thermal.supply_temperature))
        return self.oil.viscosity

    def viscosity(self, film: FilmGeometry) -> float:
        """The dynamic viscosity [Pa s] in `film`, without heat: its own, by its own temperature, or the viscosity of
        the oil."""
        if film.viscosity is not None:
            return film.viscosity
        law = self.oil.law
        if film.temperature is not None and law is not None:
            return law.at(film.temperature)
        return self.oil_viscosity

    def cavitation(self, film: FilmGeometry) -> Cavitation:
        """The cavitation model of `film`: its own, or the one of all films."""
        own = film.cavitation if isinstance(film, RingFilm) else None
        return self.film.cavitation if own is None else own

    @property
    def cavitations(self) -> tuple[Cavitation, ...]:
        """The cavitation models of all films, in the order of `films`."""
        return tuple(self.cavitation(film) for film in self.films)


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a case file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Case.model_json_schema(by_alias=True)}


def add_law(law: type[Law]) -> None:
    """Let film.cavitation take a user-defined law in this process, and [film.NAME] its keys.

    Parameters
    ----------
    law : type[CavitationLaw]
        The law. One of the same name that was added before is replaced.

    Raises
    ------
    ValueError
        If it is no law, or has the name of a shipped law.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.add_law(MyLaw)  # doctest: +SKIP
    """
    table.add(law)
    _adopt()


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
    _adopt()


def _adopt() -> None:
    adopt(FilmModel, (RingFilm, Damper))
    bearings = (SingleFilmBearing, FloatingRingBearing, CartridgeBearing, CoefficientsBearing, BallBearingKeys)
    for holder in (*bearings, Case):
        holder.model_rebuild(force=True)
