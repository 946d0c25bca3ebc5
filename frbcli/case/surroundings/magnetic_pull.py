"""The magnetic pull of an electrical machine on its rotor."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Identifier, Quantity

Pull = Annotated[float, Quantity("N/m", "1e5 N/m", above=0)]


class MagneticPull(Model):
    """The unbalanced magnetic pull on a rotor out of the middle of its stator: in proportion to its displacement and
    along it, a spring of negative stiffness."""

    at: Identifier = Field(description="place of the rotor, as of a [[force]]")
    pull: Pull = Field(description="force over displacement; of a symmetric rotor at each of both journals")
    stator: Identifier = Field(
        default="", description="place that the stator is fixed to, such as `housing`; the ground if not given"
    )
