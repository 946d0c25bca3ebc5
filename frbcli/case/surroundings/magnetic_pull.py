"""The magnetic pull of an electrical machine on its rotor."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from frbcli.case.quantities import Identifier, Quantity
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.machine_table import MachineTable
from frbcli.case.surroundings.places import no_place, node_at

if TYPE_CHECKING:
    from frbcli.case.schema import Case

Pull = Annotated[float, Quantity("N/m", "1e5 N/m", above=0)]


class MagneticPull(MachineTable):
    """Unbalanced magnetic pull of an electrical machine: a negative spring."""

    at: Identifier = Field(description="place of the rotor, as of a [[force]]")
    pull: Pull = Field(description="force over displacement; of a symmetric rotor at each journal")
    stator: Identifier = Field(
        default="", description="place of the stator, such as `housing`; default: the ground"
    )

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        for key, place in (("at", self.at), ("stator", self.stator)):
            if (place or key == "at") and not node_at(case, place):
                yield Breach((*path, key), *no_place(case, place))
        if self.stator and node_at(case, self.stator) == node_at(case, self.at):
            yield Breach((*path, "stator"), "is the place of the rotor.", "Name what carries the stator, or remove it.")
