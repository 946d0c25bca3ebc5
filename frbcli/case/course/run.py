"""How a case is run: speed of the rotor, motion of a tested journal, start, accuracy and output."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field, model_validator

from frbcli.case.model import (
    Angle,
    Count,
    Displacement,
    Duration,
    Eccentricity,
    FirstSpeed,
    Force,
    Hold,
    Label,
    Model,
    Quantity,
    Rate,
    SignedSpeed,
    Speed,
    Tilt,
    TiltRate,
    Velocity,
    with_default,
)
from frbcli.case.reading.text import TomlFault, parse
from frbcli.units import NUMBER, SpeedUnit, is_per_minute

DEFAULT_HOLD = 0.5

PointTime = Annotated[float, Quantity("s", "1 s", least=0)]


class SpeedRamp(Model):
    """Rotor speed [Hz]: linear from `from` to `to` in `duration`, or through points; a run-down goes back."""

    start: FirstSpeed = Field(alias="from", description="at the start of a run; negative: it turns the other way round")
    end: Speed = Field(alias="to", description="at the end of the run-up")
    duration: Duration = Field(description="of the run-up")
    hold: Hold = Field(default=DEFAULT_HOLD, description="at the end speed, before a run-down")
    down_duration: Duration = Field(default=math.nan, description="of a run-down; the duration if not given")
    points: tuple[tuple[PointTime, Speed], ...] = Field(
        default=(), description="replaces from, to and duration: times from 0 on with speeds, linear between them"
    )
    file: Label = Field(
        default="", description="replaces points: CSV, WAV, MAT or UFF with the columns time and speed",
    )  # fmt: skip
    tacho: Label = Field(default="", description="column of `file` with pulses, from which the speed follows")
    pulses: Annotated[int, Count(1, 10_000, 1)] = Field(default=1, description="of `tacho` in a revolution")
    times: tuple[PointTime, ...] = Field(default=(), description="contents of points or `file`, written by runs")
    speeds: tuple[Speed, ...] = Field(default=(), description="at these times")

    @property
    def course(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times in s of the run-up with speeds in Hz, linear between them."""
        return (self.times, self.speeds) if self.times else ((0.0, self.duration), (self.start, self.end))

    @model_validator(mode="before")
    @classmethod
    def _down_as_fast_as_up(cls, data: object) -> object:
        return with_default(data, "down_duration", "duration")


def given_speed_unit(text: str) -> SpeedUnit:
    """The unit in which people read the rotor speeds of a case file with this text: rpm where it gives one so; Hz of a
    text that is none of a case."""
    try:
        tables = parse(text)
    except TomlFault:
        return SpeedUnit()
    motion = tables.get("motion")
    of_motion = motion.get("speed") if isinstance(motion, Mapping) else None
    return SpeedUnit(_any_per_minute([tables.get("speed"), tables.get("drive"), of_motion]))


def _any_per_minute(given: object) -> bool:
    if isinstance(given, Mapping):
        return _any_per_minute(list(given.values()))
    if isinstance(given, list):
        return any(map(_any_per_minute, given))
    return is_per_minute(given)


class KinematicMotion(Model):
    """A kinematic test of a bearing: the motion of the journal is given."""

    film: Label = Field(
        default="",
        description="name of the tested film, needed where there are several; all outside of it is fixed",
    )
    eccentricity: Eccentricity | None = Field(default=None, description="displacement over the clearance")
    angle: Angle = Field(default=0.0, description="of the displacement, from the x-axis")
    load: Force | None = Field(default=None, description="replaces the displacement: a static equilibrium")
    speed: SignedSpeed | None = Field(default=None, description="of the journal; the shell is fixed")
    eccentricity_rate: Rate = Field(default=0.0, description="of a rotation: rate of the eccentricity")
    whirl_speed: SignedSpeed = Field(default=0.0, description="of a rotation: whirl speed of the displacement")
    velocity: tuple[Velocity, Velocity] | None = Field(
        default=None, description="of a rotation: of the journal along x, y; replaces the two before"
    )
    tilt: tuple[Tilt, Tilt] | None = Field(
        default=None, description="of the journal about x, y through the middle of the bearing"
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
        """Whether a test states the moment of the film force, too."""
        return any(given is not None for given in (self.velocity, self.tilt, self.tilt_rate))


OUTPUT_STEP = 5e-5  # resolves 10 kHz
STEPS_PER_REVOLUTION = 40
MACRO_STEP = 1e-6  # table 6.2
MOST_FRAMES = 200  # of films that a run keeps

FilmSignal = Literal["force", "film-thickness", "power", "torque", "oil-flow"]


class Start(Model):
    """Position of the journal at the start of a run."""

    position: Literal["centre", "resting"] = Field(
        default="centre", description="in the middle of the bearings, or in static equilibrium at the first speed"
    )
    displacement: tuple[Displacement, Displacement] | None = Field(default=None, description="x, y over clearance")


class Accuracy(Model):
    """Accuracy of the result: one target, or mesh and tolerance."""

    target: Annotated[float, Quantity(NUMBER, "1e-3", above=0, most=0.1)] = Field(
        default=1e-3, description="error of the eccentricities that is aimed at"
    )
    budget: Annotated[float, Quantity("s", "60 s", above=0)] | None = Field(
        default=None, description="CPU time of a run-up, if the target needs more: the most exact plan within it"
    )
    mesh: tuple[Annotated[int, Count(1, 400, 10)], Annotated[int, Count(4, 2000, 20)]] | None = Field(
        default=None, description="elements along the axis, then around the circumference, where there are no fewer"
    )
    tolerance: Annotated[float, Quantity(NUMBER, "1e-6", above=0, most=0.1)] | None = Field(
        default=None, description="of the time integration, relative to the clearance"
    )
    steps_per_revolution: Annotated[int, Count(1, 100_000, 40)] = Field(
        default=STEPS_PER_REVOLUTION, description="at least; finite-volume films take fewer by default"
    )
    macro_step: Annotated[float, Quantity("s", "1e-6 s", above=0)] = Field(
        default=MACRO_STEP, description="longest macro step of a co-simulation"
    )


class FilmFrames(Model):
    """Oil fractions and free gas of all cells that a run keeps, for pictures of its films."""

    begin: Hold = Field(alias="from", description="time of the first ones")
    end: Duration = Field(alias="to", description="time of the last ones")
    frames: Annotated[int, Count(2, MOST_FRAMES, 80)] = Field(default=80, description="so many, at even times")


class Output(Model):
    """Output of a run."""

    step: Annotated[float, Quantity("s", "5e-5 s", above=0)] = Field(
        default=OUTPUT_STEP, description="between the samples of a run file"
    )
    signals: tuple[FilmSignal, ...] = Field(
        default=(),
        description="further signals of each film that a run records",
    )
    films: FilmFrames | None = Field(default=None, description="keep oil and gas of mass-conserving films")
