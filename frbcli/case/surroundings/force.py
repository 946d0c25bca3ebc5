"""A force on a place of the machine beside unbalance and weight."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Angle, Identifier, Label, Quantity, SignedSpeed
from frbcli.case.surroundings.over_time import OverTime
from frbcli.units import NUMBER

ForceEntry = Annotated[float, Quantity("N", "10 N")]
Order = Annotated[float, Quantity(NUMBER, "2")]


class AppliedForce(Model):
    """A force on a disk, a journal, a ring or a support: constant; harmonic with an order of the rotor speed or a
    frequency of its own, in a direction or rotating; or a table over time."""

    at: Identifier = Field(
        description="place: a disk or a bearing by its name, or a point of a run such as `disk`, `journal_left`, "
        "`support`; of a symmetric rotor at each of both journals, rings or supports"
    )
    force: tuple[ForceEntry, ForceEntry] | None = Field(
        default=None, description="[x, y]; of a harmonic force its amplitude; with `file` it multiplies the columns, "
        "1 N if not given",
    )  # fmt: skip
    order: Order | None = Field(
        default=None, description="times the angle of the rotor; below 0 a rotating force turns the other way"
    )
    frequency: SignedSpeed | None = Field(default=None, description="in place of `order`, whatever the rotor does")
    rotating: bool = Field(
        default=False, description="whether its direction turns, counter-clockwise; with the rotor where neither order "
        "nor frequency is given",
    )
    phase: Angle = Field(default=0.0, description="of a harmonic force at angle and time zero")
    file: Label = Field(
        default="", description="in place of the four: CSV, WAV, MAT or UFF with the columns time, x and y, or one "
        "beside the time for both; from the case's folder",
    )  # fmt: skip
    over_time: OverTime | None = Field(
        default=None, description="what `file` holds: the case that a run keeps has it in place of that key"
    )

    @property
    def amplitude(self) -> tuple[float, float]:
        """Amplitude along x and y in N, the factors of a table over time."""
        return self.force or (1.0, 1.0)

    @property
    def turns(self) -> tuple[float, float]:
        """Order, and frequency in Hz; both 0 of a constant force."""
        if self.order is None and self.frequency is None:
            return (1.0 if self.rotating else 0.0), 0.0
        return self.order or 0.0, self.frequency or 0.0

    @property
    def constant(self) -> bool:
        """Whether it depends neither on the angle of the rotor nor on time."""
        return self.turns == (0.0, 0.0) and self.over_time is None

    @property
    def turning(self) -> str:
        """Its order, its frequency or its table in words; "" of a constant force."""
        if self.over_time is not None:
            return self.over_time.told
        order, frequency = self.turns
        return f"order {order:g}" if order else f"{frequency:g} Hz" if frequency else ""
