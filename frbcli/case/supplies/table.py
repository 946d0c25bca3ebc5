"""The table of the supplies: one row each. All else about a supply is in its own file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Union, get_args

from pydantic import Field

from frbcli.case.supplies.axial_grooves import AxialGrooves
from frbcli.case.supplies.axial_slots import AxialSlots
from frbcli.case.supplies.bores import Bores
from frbcli.case.supplies.circumferential_groove import CircumferentialGroove
from frbcli.case.supplies.none import NoSupply
from frbcli.case.supplies.pocket import Pocket
from frbcli.case.supplies.supply import OilSupply

SUPPLIES: tuple[type[OilSupply], ...] = (
    NoSupply,
    CircumferentialGroove,
    AxialGrooves,
    Bores,
    Pocket,
    AxialSlots,
)

if TYPE_CHECKING:
    Supply = OilSupply  # others ask a supply by its base alone
else:
    Supply = Annotated[Union[SUPPLIES], Field(discriminator="kind")]  # noqa: UP007


def kind_of(supply: type[OilSupply]) -> str:
    """The word of the key `kind` of a supply."""
    return str(get_args(supply.model_fields["kind"].annotation)[0])


def supply_named(kind: object) -> type[OilSupply]:
    """The class of a kind of supply, their base for a word that is none."""
    return next((supply for supply in SUPPLIES if kind_of(supply) == kind), OilSupply)
