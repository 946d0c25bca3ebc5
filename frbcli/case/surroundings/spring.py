"""Springs, dampers and stops between two places of a machine."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from frbcli.case.quantities import Damping, Identifier, Length, Quantity, Stiffness
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.machine_table import MachineTable
from frbcli.case.surroundings.places import no_place, node_at
from frbcli.units import NUMBER

if TYPE_CHECKING:
    from frbcli.case.schema import Case

Cubic = Annotated[float, Quantity("N/m^3", "1e15 N/m^3", least=0, most=1e30)]
Gap = Annotated[float, Quantity("m", "20 um", least=0)]
Friction = Annotated[float, Quantity(NUMBER, "0.1", least=0)]


class Spring(MachineTable):
    """A spring with damper, or a stop, to ground or between two places."""

    at: Identifier = Field(default="", description="place, as of a [[force]]")
    between: tuple[Identifier, Identifier] | None = Field(
        default=None, description="replaces `at`: two places, such as `compressor` and `housing`"
    )
    stiffness: Stiffness | None = Field(default=None, description="in all directions; of a stop, beyond its gap")
    cubic: Cubic = Field(default=0.0, description="force over displacement cubed")
    gap: Gap = Field(default=0.0, description="radial gap of a stop; its damping acts radially")
    damping: Damping = Field(default=0.0, description="of a stop, in contact only, without pull")
    friction: Friction = Field(default=0.0, description="of a stop, against sliding of the first place")
    radius: Length | None = Field(
        default=None,
        description="where a turning shaft rubs: sliding by rotation and centre motion; without it by the sense of "
        "rotation",
    )

    @property
    def linear(self) -> bool:
        """Whether its force is proportional to the motion."""
        return not (self.gap or self.cubic or self.friction)

    @property
    def ends(self) -> tuple[str, str]:
        """Both places; "" is the ground."""
        return self.between or (self.at, "")

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if bool(self.at) == (self.between is not None):
            problem = "are both given." if self.at else "is missing, and so is at."
            yield Breach((*path, "between"), problem, "Give at, a place, or between, two of them.")
            return
        for place in self.between or (self.at,):
            if not node_at(case, place):
                yield Breach((*path, "between" if self.between else "at"), *no_place(case, place))
        if self.between is not None and len({node_at(case, each) for each in self.between}) == 1:
            yield Breach((*path, "between"), "names one place twice.", "Name two places, or give at.")
        if not (self.stiffness or self.cubic or (self.damping and self.linear)):
            yield Breach((*path, "stiffness"), "is missing.", "Give a stiffness, cubic or, without a gap, a damping.")
        if self.friction and not self.gap:
            yield Breach(
                (*path, "friction"), "needs a gap: without one nothing slides.", "Give one, or remove it."
            )
        if self.radius is not None and not self.friction:
            yield Breach((*path, "radius"), "has no effect without friction.", "Give a friction, or remove it.")
