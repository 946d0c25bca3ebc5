"""The speed of the rotor in a run: a ramp, or through points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, model_validator

from frbcli.case.model import Model, with_default
from frbcli.case.quantities import Count, Duration, FirstSpeed, Hold, Label, Quantity, Speed
from frbcli.case.reading.toml import TomlFault, parse
from frbcli.results.records import PER_MINUTE
from frbcli.units import SpeedUnit, is_per_minute

if TYPE_CHECKING:
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


def speed_unit_of(run: Run) -> SpeedUnit:
    """The unit in which people read the rotor speeds of a run: of its case, or of the column of a measurement."""
    return SpeedUnit(rpm=True) if PER_MINUTE in run.references else given_speed_unit(run.case_text)


def _any_per_minute(given: object) -> bool:
    if isinstance(given, Mapping):
        return _any_per_minute(list(given.values()))
    if isinstance(given, list):
        return any(map(_any_per_minute, given))
    return is_per_minute(given)
