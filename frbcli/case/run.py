"""How a case is run: speed of the rotor, motion of a tested journal, start, accuracy and output.

The drive of a rotor whose speed is free: its torque, what brakes it, and how fast the rotor can become by them.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, GetJsonSchemaHandler
from pydantic_core import CoreSchema

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
    Reader,
    SignedSpeed,
    Speed,
    Tilt,
    TiltRate,
    TopSpeed,
    Velocity,
    with_default,
)
from frbcli.case.over_time import Entry, MachineTable, over_time_problem
from frbcli.case.reading.settings import TomlFault, parse
from frbcli.case.reading.tables import Breach, Path, as_number, pairs, table
from frbcli.units import NUMBER, SPEED, SpeedUnit, ValueFault, display, is_per_minute, quantity

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.results.store import Run


DEFAULT_HOLD = 0.5

PointTime = Annotated[float, Quantity("s", "1 s", least=0)]


class SpeedRamp(Model):
    """Rotor speed: linear from `from` to `to`, or through points; a run-down goes back."""

    start: FirstSpeed = Field(alias="from", description="at the start; negative: reversed rotation")
    end: Speed = Field(alias="to", description="at the end of the run-up")
    duration: Duration = Field(description="of the run-up")
    hold: Hold = Field(default=DEFAULT_HOLD, description="at the end speed, before a run-down")
    down_duration: Duration = Field(default=math.nan, description="of a run-down; default: the duration")
    points: tuple[tuple[PointTime, Speed], ...] = Field(
        default=(), description="replaces from, to and duration: times from 0 on with speeds"
    )
    file: Label = Field(
        default="", description="replaces points: CSV, WAV, MAT or UFF with columns time and speed",
    )  # fmt: skip
    tacho: Label = Field(default="", description="column of `file` with pulses, for the speed")
    pulses: Annotated[int, Count(1, 10_000, 1)] = Field(default=1, description="of `tacho` per revolution")
    times: tuple[PointTime, ...] = Field(default=(), description="contents of points or `file`, written by runs")
    speeds: tuple[Speed, ...] = Field(default=(), description="contents of points or `file`, written by runs")

    @property
    def top(self) -> float:
        """The highest of start and end, in Hz, without its sign."""
        return max(abs(self.start), abs(self.end))

    @property
    def course(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times in s of the run-up with speeds in Hz, linear between them."""
        return (self.times, self.speeds) if self.times else ((0.0, self.duration), (self.start, self.end))

    @classmethod
    def completed(cls, table: dict[str, Any]) -> dict[str, Any]:
        return with_default(table, "down_duration", "duration")


def given_speed_unit(text: str) -> SpeedUnit:
    """The unit in which people read the rotor speeds of a case file with this text: rpm where it gives one so; Hz of a
    text that is none of a case."""
    try:
        tables = parse(text)
    except TomlFault:
        return SpeedUnit()
    return SpeedUnit(_any_per_minute([tables.get("speed"), tables.get("drive"), table(tables, "motion").get("speed")]))


def speed_unit_of(run: Run) -> SpeedUnit:
    """The unit in which people read the rotor speeds of a run: of its case, or of the column of a measurement."""
    return SpeedUnit(rpm=True) if run.per_minute else given_speed_unit(run.case_text)


def _any_per_minute(given: object) -> bool:
    match given:
        case dict():
            return any(map(_any_per_minute, given.values()))
        case list():
            return any(map(_any_per_minute, given))
    return is_per_minute(given)


class KinematicMotion(Model):
    """Given motion of the journal in a kinematic test."""

    film: Label = Field(
        default="",
        description="tested film, required with several; all else is fixed",
    )
    eccentricity: Eccentricity | None = Field(default=None, description="displacement over clearance")
    angle: Angle = Field(default=0.0, description="of the displacement, from the x-axis")
    load: Force | None = Field(default=None, description="replaces the displacement: static equilibrium")
    speed: SignedSpeed | None = Field(default=None, description="of the journal; the shell is fixed")
    eccentricity_rate: Rate = Field(default=0.0, description="of a rotation")
    whirl_speed: SignedSpeed = Field(default=0.0, description="of a rotation")
    velocity: tuple[Velocity, Velocity] | None = Field(
        default=None, description="of a rotation, along x, y; replaces the two before"
    )
    tilt: tuple[Tilt, Tilt] | None = Field(
        default=None, description="of the journal about x, y, at the middle of the bearing"
    )
    tilt_rate: tuple[TiltRate, TiltRate] | None = Field(
        default=None, description="of a rotation, about x, y"
    )
    frequency: Speed | None = Field(default=None, description="of squeeze or whirl")
    periods: Annotated[float, Quantity(NUMBER, "3", above=0, most=1000)] = Field(
        default=3.0, description="of squeeze or whirl"
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
        default="centre", description="middle of the bearings, or static equilibrium at the first speed"
    )
    displacement: tuple[Displacement, Displacement] | None = Field(default=None, description="x, y over clearance")


class Accuracy(Model):
    """One target, or mesh and tolerance."""

    target: Annotated[float, Quantity(NUMBER, "1e-3", above=0, most=0.1)] = Field(
        default=1e-3, description="error of the eccentricities"
    )
    budget: Annotated[float, Quantity("s", "60 s", above=0)] | None = Field(
        default=None, description="CPU time of a run-up, if the target needs more: the most exact plan within it"
    )
    mesh: tuple[Annotated[int, Count(1, 400, 10)], Annotated[int, Count(4, 2000, 20)]] | None = Field(
        default=None, description="elements along the axis and, at least, around the circumference"
    )
    tolerance: Annotated[float, Quantity(NUMBER, "1e-6", above=0, most=0.1)] | None = Field(
        default=None, description="of the time integration, over clearance"
    )
    steps_per_revolution: Annotated[int, Count(1, 100_000, 40)] = Field(
        default=STEPS_PER_REVOLUTION, description="at least; finite-volume films take fewer by default"
    )
    macro_step: Annotated[float, Quantity("s", "1e-6 s", above=0)] = Field(
        default=MACRO_STEP, description="longest, of a co-simulation"
    )


class FilmFrames(Model):
    """Recorded oil fractions and free gas of all cells, for pictures."""

    begin: Hold = Field(alias="from", description="first and last time")
    end: Duration = Field(alias="to", description="first and last time")
    frames: Annotated[int, Count(2, MOST_FRAMES, 80)] = Field(default=80, description="number, at even times")


class Output(Model):
    """Output of a run."""

    step: Annotated[float, Quantity("s", "5e-5 s", above=0)] = Field(
        default=OUTPUT_STEP, description="between samples"
    )
    signals: tuple[FilmSignal, ...] = Field(
        default=(),
        description="further signals of each film",
    )
    films: FilmFrames | None = Field(default=None, description="record oil and gas of mass-conserving films")


TORQUE = Quantity("N*m", "0.05 N*m")
Torque = Annotated[float, TORQUE]
CONSTANT = Quantity("N*m", "0.01 N*m", least=0)
LINEAR = Quantity("N*m*s", "1e-4 N*m*s", least=0)
SQUARE = Quantity("N*m*s^2", "1e-7 N*m*s^2", least=0)
POWERS = {"constant": CONSTANT, "linear": LINEAR, "square": SQUARE}  # of the speed in rad/s
GOVERNED = 0.02  # share of the highest speed over which a governor takes the torque away
STEPS, POINTS = 2000, 32  # of the course that is expected
FLAT = 1e-9  # exponent below which a step counts as linear
TURN = 2.0 * math.pi


class TorquePoints(Model):
    """A torque over the speed of the rotor or over time: linear between its points, constant beyond them."""

    over: Literal["speed", "time"] = Field(description="independent variable")
    at: tuple[Entry, ...] = Field(description="speeds in Hz, or times in s, ascending")
    torque: tuple[Torque, ...] = Field(description="at each of them")

    def value(self, place: float) -> tuple[float, float]:
        """The torque in N m at a speed in Hz or a time in s, and its slope there."""
        if not self.at[0] <= place < self.at[-1]:
            return self.torque[0 if place < self.at[0] else -1], 0.0
        row = bisect_right(self.at, place) - 1
        slope = (self.torque[row + 1] - self.torque[row]) / (self.at[row + 1] - self.at[row])
        return self.torque[row] + slope * (place - self.at[row]), slope


class BrakingLoad(Model):
    """A torque against the rotation: the sum of three powers of the speed."""

    constant: Annotated[float, CONSTANT] = Field(default=0.0, description="at any speed above 0")
    linear: Annotated[float, LINEAR] = Field(default=0.0, description="times the speed in rad/s")
    square: Annotated[float, SQUARE] = Field(default=0.0, description="times its square")


@dataclass(frozen=True)
class _Points(Reader):
    """Reads a list of speeds or times with torques."""

    remedy = 'Write e.g. [["0 Hz", "0.1 N*m"], ["500 Hz", "0 N*m"]], or times instead of the speeds.'

    def read(self, given: object) -> TorquePoints:
        """Raises ValueFault."""
        match given, pairs(given):
            case TorquePoints(), _:
                return given
            case {"over": "speed" | "time" as over, "at": list(places), "torque": list(torques), **more}, _ if not more:
                pass
            case _, (places, torques):
                over = "time" if self._are(places, "s") else "speed"
            case _:
                raise ValueFault("is no list of speeds or times with torques.", self.remedy)
        try:
            unit = {"speed": SPEED, "time": "s"}[over]
            at, torque = tuple(quantity(each, unit) for each in places), tuple(TORQUE.read(each) for each in torques)
        except ValueFault as fault:
            raise ValueFault(f"has a value that {fault.problem}", self.remedy) from None
        if problem := over_time_problem(at, torque, over=over, unit=unit):
            raise ValueFault(problem, self.remedy)
        return TorquePoints(over=over, at=at, torque=torque)

    def _are(self, places: list[object], unit: str) -> bool:
        """Whether all places that have a unit can be read in this one. Raises ValueFault where none has a unit."""
        named = [each for each in places if isinstance(each, str)]
        if places and not named:
            raise ValueFault("has places without a unit: they can be speeds or times.", self.remedy)
        try:
            return all(math.isfinite(quantity(each, unit)) for each in named)
        except ValueFault:
            return False

    def __get_pydantic_json_schema__(self, _schema: CoreSchema, _handler: GetJsonSchemaHandler) -> dict[str, Any]:
        pair = {"type": "array", "minItems": 2, "maxItems": 2}
        description = "speeds or times with torques"
        return {"type": "array", "items": pair, "minItems": 2, "description": description,
                "examples": [[["0 Hz", "0.1 N*m"], ["500 Hz", "0 N*m"]]]}  # fmt: skip


@dataclass(frozen=True)
class _Loads(Reader):
    """Reads a load: one quantity, whose unit gives the power of the speed, or a table of several."""

    remedy = 'Write e.g. "0.01 N*m", "1e-4 N*m*s", "1e-7 N*m*s^2", or { constant = "0.01 N*m", square = ... }.'

    def read(self, given: object) -> BrakingLoad:
        """Raises ValueFault."""
        match given:
            case BrakingLoad():
                return given
            case dict() if given.keys() <= POWERS.keys():
                return BrakingLoad(**{key: self._one(POWERS[key], value, f"{key} ") for key, value in given.items()})
            case str():
                for key, power in POWERS.items():
                    if as_number(given, power.unit) is not None:
                        return BrakingLoad(**{key: self._one(power, given)})
        raise ValueFault("is no torque over a power of the speed.", self.remedy)

    def _one(self, power: Quantity, given: object, key: str = "") -> float:
        try:
            return power.read(given)
        except ValueFault as fault:
            raise ValueFault(f"{key}{fault.problem}", self.remedy) from None

    def __get_pydantic_json_schema__(self, _schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        text = {"type": "string", "examples": [power.example for power in POWERS.values()]}
        powers = {key: power.__get_pydantic_json_schema__({}, handler) for key, power in POWERS.items()}
        table = {"type": "object", "properties": powers, "additionalProperties": False}
        return {"description": "a torque in N*m, N*m*s or N*m*s^2", "anyOf": [text, table]}


class Drive(MachineTable):
    """Free speed: J omega' = torque - load - film friction."""

    torque: Torque = Field(default=0.0, description="of the drive; below 0 it brakes")
    points: Annotated[TorquePoints, _Points()] | None = Field(
        default=None, description="replaces torque: over speed or time, linear, constant beyond"
    )
    load: Annotated[BrakingLoad, _Loads()] = Field(
        default=BrakingLoad(),
        description="brakes: constant, linear or quadratic in the speed, by the unit; or a table",
    )
    start: Speed = Field(default=0.0, description="speed at the start")
    end: TopSpeed | None = Field(
        default=None,
        alias="to",
        description="highest speed, by a governor; default: torque equals load without film friction",
    )
    duration: Duration = Field(description="of the torque, and of a run-up")
    down_duration: Duration = Field(
        default=math.nan, description="of a run-down without torque; default: the duration"
    )
    reaction: bool = Field(default=False, description="unbalance whirl acts on the rotation")

    @classmethod
    def completed(cls, table: dict[str, Any]) -> dict[str, Any]:
        """A run-down as long as the run-up, and a torque as a list as points."""
        table = with_default(table, "down_duration", "duration")
        if isinstance(table.get("torque"), list | tuple) and "points" not in table:
            return {**{key: value for key, value in table.items() if key != "torque"}, "points": table["torque"]}
        return table

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if not case.polar_inertia:
            remedy = 'Add e.g. polar_inertia = "2e-4 kg*m^2" to [rotor].'
            yield Breach(("rotor", "polar_inertia"), "is missing; [drive] turns it.", remedy)
            return
        if self.points is not None and "torque" in self.model_fields_set:
            yield Breach((*path, "torque"), "is given with points.", "Keep one of the two.")
        if self.end is not None and self.end <= self.start:
            problem = f"is {display(self.end, SPEED)}, not above the start at {display(self.start, SPEED)}."
            yield Breach((*path, "to"), problem, "Raise it, or leave it out.")
        if self.start == 0.0 and not self._begins_to_turn:
            held = f"does not turn a rotor from rest against a load of {display(self.load.constant, 'N*m')}."
            key = "torque" if self.points is None else "points"
            yield Breach((*path, key), held, 'Give a larger torque at the start, or e.g. start = "100 Hz".')

    @property
    def _begins_to_turn(self) -> bool:
        """Whether a rotor at rest turns; without a load a torque over time may still be to come."""
        net = self.net(0.0, 0.0)[0]
        later = self.points is not None and self.points.over == "time" and self.load.constant == 0.0
        return net > 0.0 or (later and net == 0.0)

    def net(self, time: float, omega: float) -> tuple[float, float]:
        """Torque less load in N m at a time in s and a speed in rad/s, and by how much it rises with the speed."""
        given, slope = self._driving(time, omega) if time < self.duration else (0.0, 0.0)
        load = self.load
        against = load.constant + (load.linear + load.square * omega) * omega
        return given - against, slope - load.linear - 2.0 * load.square * omega

    def _driving(self, time: float, omega: float) -> tuple[float, float]:
        """The torque of the drive in N m, and by how much it rises with the speed: governed below its highest one."""
        torque, slope = self.torque, 0.0
        if self.points is not None:
            of_speed = self.points.over == "speed"
            torque, slope = self.points.value(omega / TURN if of_speed else time)
            slope = slope / TURN if of_speed else 0.0
        if self.end is None or torque <= 0.0:
            return torque, slope
        width = GOVERNED * TURN * self.end
        share = (TURN * self.end - omega) / width
        if share >= 1.0:
            return torque, slope
        return max(share, 0.0) * torque, max(share, 0.0) * slope - (torque / width if share > 0.0 else 0.0)

    @property
    def stops(self) -> tuple[float, ...]:
        """Times in s at which the torque has a kink."""
        over_time = self.points is not None and self.points.over == "time"
        return (*(self.points.at if over_time and self.points is not None else ()), self.duration)

    def expected(self, inertia: float) -> SpeedRamp:
        """The speeds of a run-up without friction of films, which no run exceeds, as far as a governor lets them;
        inertia in kg m^2. Of a rotor that only slows down they end at 0."""
        times, speeds = self.course(inertia, self.duration)
        top = max(speeds)
        ramp = {"from": self.start, "to": top if top > self.start else 0.0, "duration": self.duration}
        down = {"hold": 0.0, "down_duration": self.down_duration}
        return SpeedRamp.model_validate({**ramp, **down, "times": times, "speeds": speeds})

    def course(self, inertia: float, end: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times in s up to `end` with the speeds in Hz of `expected`."""
        return _course(self, inertia, end)


@lru_cache(maxsize=64)
def _course(drive: Drive, inertia: float, end: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """By exponential steps, exact where the torque is linear in the speed, between the kinks of the torque."""
    kinks = sorted({0.0, end, *(t for t in drive.stops if 0.0 < t < end)})
    times, speeds, omega = [0.0], [drive.start], TURN * drive.start
    for begin, stop in itertools.pairwise(kinks):
        share = (stop - begin) / end
        points = max(1, math.ceil(POINTS * share))
        inner = max(1, math.ceil(STEPS * share / points))
        step = (stop - begin) / (points * inner)
        for point in range(1, points + 1):
            for each in range(inner):
                time = begin + ((point - 1) * inner + each + 0.5) * step  # the middle: also between two kinks
                torque, slope = drive.net(time, omega)
                rate = slope / inertia * step
                grown = math.expm1(rate) / rate if abs(rate) > FLAT else 1.0
                omega = max(omega + step * grown * torque / inertia, 0.0)
            times.append(stop if point == points else begin + point * inner * step)
            speeds.append(omega / TURN)
    return tuple(times), tuple(speeds)
