"""A force on a place of the machine beside unbalance and weight."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Identifier, Quantity

ForceEntry = Annotated[float, Quantity("N", "10 N")]


class AppliedForce(Model):
    """A constant force on a disk, a journal, a ring or a support."""

    at: Identifier = Field(
        description="place: a disk or a bearing by its name, or a point of a run such as `disk`, `journal_left`, "
        "`support`; of a symmetric rotor at each of both journals, rings or supports"
    )
    force: tuple[ForceEntry, ForceEntry] = Field(description="[x, y]")
