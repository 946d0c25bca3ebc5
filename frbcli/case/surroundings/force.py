"""A force on a place of the machine beside unbalance and weight."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Angle, Identifier, Quantity, SignedSpeed
from frbcli.units import NUMBER

ForceEntry = Annotated[float, Quantity("N", "10 N")]
Order = Annotated[float, Quantity(NUMBER, "2")]


class AppliedForce(Model):
    """A force on a disk, a journal, a ring or a support: constant, or harmonic with an order of the rotor speed or a
    frequency of its own, in a direction or rotating."""

    at: Identifier = Field(
        description="place: a disk or a bearing by its name, or a point of a run such as `disk`, `journal_left`, "
        "`support`; of a symmetric rotor at each of both journals, rings or supports"
    )
    force: tuple[ForceEntry, ForceEntry] = Field(description="[x, y]; of a harmonic force its amplitude")
    order: Order | None = Field(
        default=None, description="times the angle of the rotor; below 0 a rotating force turns the other way"
    )
    frequency: SignedSpeed | None = Field(default=None, description="in place of `order`, whatever the rotor does")
    rotating: bool = Field(
        default=False, description="whether its direction turns, counter-clockwise; with the rotor where neither order "
        "nor frequency is given",
    )
    phase: Angle = Field(default=0.0, description="of a harmonic force at angle and time zero")

    @property
    def turns(self) -> tuple[float, float]:
        """Order, and frequency in Hz; both 0 of a constant force."""
        if self.order is None and self.frequency is None:
            return (1.0 if self.rotating else 0.0), 0.0
        return self.order or 0.0, self.frequency or 0.0

    @property
    def constant(self) -> bool:
        """Whether it depends neither on the angle of the rotor nor on time."""
        return self.turns == (0.0, 0.0)

    @property
    def turning(self) -> str:
        """Its order or its frequency in words; "" of a constant force."""
        order, frequency = self.turns
        return f"order {order:g}" if order else f"{frequency:g} Hz" if frequency else ""
