"""All kinds of elements that are no journal films: what the rest of the program asks, it asks here."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.elements.ball import BallBearingElement
from frbcli.elements.coefficients import GivenCoefficients
from frbcli.elements.element import MachineElement
from frbcli.elements.forces import BaseElement, ForceElement, MagneticPullElement
from frbcli.elements.pin import PinElement
from frbcli.elements.spring import SpringElement
from frbcli.elements.supports import DamperElement, HousingElement, SupportElement
from frbcli.elements.thrust import ThrustElement

ELEMENTS: tuple[type[MachineElement], ...] = (
    GivenCoefficients, BallBearingElement, PinElement, DamperElement, SupportElement, HousingElement, ThrustElement,
    ForceElement, MagneticPullElement, SpringElement, BaseElement,
)  # fmt: skip


def elements_of(case: Case) -> Iterator[MachineElement]:
    """All elements of a case, by kind."""
    return (element for kind in ELEMENTS for element in kind.of(case))


def symbols_at(case: Case, key: str) -> tuple[str, ...]:
    """The symbols of the elements of a bearing by its key, from the shaft to the ground: they stand so in ELEMENTS."""
    own = (each for each in elements_of(case) if f"{each.key}.".startswith(f"{key}."))
    return tuple(each.symbol for each in own if each.symbol)
