"""Motion of the ground that a machine stands on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import BeforeValidator, Field

from frbcli.case.bearing import ONE_OR_MANY
from frbcli.case.quantities import Angle, Label, Quantity, Speed
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.force import Order
from frbcli.case.surroundings.machine_table import MachineTable
from frbcli.case.surroundings.over_time import OverTime
from frbcli.case.surroundings.places import table_breaches

if TYPE_CHECKING:
    from frbcli.case.schema import Case

AccelerationEntry = Annotated[float, Quantity("m/s^2", "2 m/s^2")]


class Base(MachineTable):
    """Motion of the ground, harmonic or tabulated. Displacements are relative to it."""

    acceleration: tuple[AccelerationEntry, AccelerationEntry] | None = Field(
        default=None,
        description="[x, y] amplitude; factor of the columns of `file`, default: 1 m/s^2",
    )
    order: Order | None = Field(default=None, description="times the angle of the source; default: 1")
    speed: Speed | None = Field(default=None, description="of the source, such as an engine; default: of the rotor")
    phase: Angle = Field(default=0.0, description="at angle and time zero")
    file: Label = Field(
        default="",
        description="replaces order, speed and phase: as of a [[force]]",
    )
    over_time: OverTime | None = Field(default=None, description="contents of `file`, written by runs")

    alone: ClassVar[bool] = True

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
            return self.over_time.origin
        of = "" if self.speed is None else f" of {self.speed:g} Hz"
        return f"order {1.0 if self.order is None else self.order:g}{of}"

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if case.housing is not None and case.housing.modes and not case.housing.masses:
            problem = "acts on masses, and the masses of the housing are unknown: its modes do not contain them."
            yield Breach(path, problem, "Give housing.masses, or a rigid housing.")
        if self.over_time is not None:
            yield from table_breaches(path, self, self.over_time, ("order", "speed", "phase"))
            return
        if self.acceleration is None:
            yield Breach((*path, "acceleration"), "is missing.", 'Write e.g. ["2 m/s^2", "0 m/s^2"], or a file.')
        elif self.order is None and self.speed is None:
            problem = "would not change: a ground that is only accelerated moves away."
            yield Breach((*path, "acceleration"), problem, "Give an order, the speed of what shakes, or a file.")
        for key in ("order", "speed"):
            if getattr(self, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Give the order or the speed of what shakes the ground.")


def _as_list(given: object) -> object:
    return [given] if isinstance(given, dict | Base) else given


Bases = Annotated[tuple[Base, ...], BeforeValidator(_as_list), ONE_OR_MANY]
