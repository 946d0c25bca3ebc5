"""Motion of the ground that a machine stands on."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from frbcli.case.bearing import ONE_OR_MANY
from frbcli.case.model import Model
from frbcli.case.quantities import Angle, Label, Quantity, Speed
from frbcli.case.surroundings.force import Order
from frbcli.case.surroundings.over_time import OverTime

AccelerationEntry = Annotated[float, Quantity("m/s^2", "2 m/s^2")]


class Base(Model):
    """Motion of the ground that the machine stands on: harmonic, or a table over time. Displacements are those against
    the ground."""

    acceleration: tuple[AccelerationEntry, AccelerationEntry] | None = Field(
        default=None, description="[x, y], amplitude of the ground; with `file` it multiplies the columns, 1 m/s^2 if "
        "not given",
    )  # fmt: skip
    order: Order | None = Field(default=None, description="times the angle of what shakes; 1 if not given")
    speed: Speed | None = Field(
        default=None, description="of what shakes, such as an engine; that of the rotor if not given"
    )
    phase: Angle = Field(default=0.0, description="at angle and time zero")
    file: Label = Field(
        default="", description="in place of order, speed and phase: CSV, WAV, MAT or UFF with the columns time, x and "
        "y, or one beside the time for both; from the case's folder",
    )  # fmt: skip
    over_time: OverTime | None = Field(
        default=None, description="what `file` holds: the case that a run keeps has it in place of that key"
    )

    @property
    def amplitude(self) -> tuple[float, float]:
        """Amplitude along x and y in m/s^2, the factors of a table over time."""
        return self.acceleration or (1.0, 1.0)

    @property
    def turns(self) -> tuple[float, float]:
        """Order of the rotor speed, and frequency in Hz."""
        order = 1.0 if self.order is None else self.order
        return (order, 0.0) if self.speed is None else (0.0, order * self.speed)

    @property
    def turning(self) -> str:
        """What it changes with, in words."""
        if self.over_time is not None:
            return self.over_time.told
        of = "" if self.speed is None else f" of {self.speed:g} Hz"
        return f"order {1.0 if self.order is None else self.order:g}{of}"


def _as_list(given: object) -> object:
    return [given] if isinstance(given, dict | Base) else given


Bases = Annotated[tuple[Base, ...], BeforeValidator(_as_list), ONE_OR_MANY]
