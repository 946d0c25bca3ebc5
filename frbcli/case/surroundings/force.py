"""A force on a place of the machine besides unbalance and weight."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from frbcli.case.quantities import Angle, Identifier, Label, Quantity, SignedSpeed
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.machine_table import MachineTable
from frbcli.case.surroundings.over_time import OverTime
from frbcli.case.surroundings.places import no_place, node_at, table_breaches
from frbcli.units import NUMBER

if TYPE_CHECKING:
    from frbcli.case.schema import Case

ForceEntry = Annotated[float, Quantity("N", "10 N")]
Order = Annotated[float, Quantity(NUMBER, "2")]


class AppliedForce(MachineTable):
    """A constant, harmonic or tabulated force on a disk, journal, ring or support."""

    at: Identifier = Field(
        description="disk or bearing by name, or a point of a run such as `disk`, `journal_left`, `support`"
    )
    force: tuple[ForceEntry, ForceEntry] | None = Field(
        default=None,
        description="[x, y] or amplitude; factor of the columns of `file`, default: 1 N",
    )
    order: Order | None = Field(
        default=None, description="times the rotor angle; below 0 clockwise"
    )
    frequency: SignedSpeed | None = Field(default=None, description="fixed; replaces `order`")
    rotating: bool = Field(
        default=False,
        description="turns counter-clockwise, default: with the rotor",
    )
    phase: Angle = Field(default=0.0, description="at angle and time zero")
    file: Label = Field(
        default="",
        description="replaces the four: CSV, WAV, MAT or UFF with columns time, x and y, or one for both",
    )
    over_time: OverTime | None = Field(default=None, description="contents of `file`, written by runs")

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
            return self.over_time.origin
        order, frequency = self.turns
        return f"order {order:g}" if order else f"{frequency:g} Hz" if frequency else ""

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if not node_at(case, self.at):
            yield Breach((*path, "at"), *no_place(case, self.at))
        if self.order is not None and self.frequency is not None:
            yield Breach((*path, "frequency"), "is given with order.", "Keep one of the two.")
        for key in ("order", "frequency"):
            if getattr(self, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Leave it out: the force is then constant.")
        if self.over_time is not None:
            yield from table_breaches(path, self, self.over_time, ("order", "frequency", "rotating", "phase"))
        elif self.force is None:
            yield Breach((*path, "force"), "is missing.", 'Write e.g. ["10 N", "0 N"].')
        elif self.phase and self.constant:
            yield Breach((*path, "phase"), "has no effect: the force is constant.", "Remove it, or give an order.")
