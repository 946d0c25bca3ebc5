"""What a kind of element says of itself: the row of `table.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from frbcli.errors import Fault
from frbcli.rotor.over_speed import LinearPart

XY = "xy"  # displacements of the shaft at the element along x and y


@dataclass(frozen=True)
class ElementKind:
    """One kind of element.

    model: its table in a case file, of frbcli/case/elements.py; sees: the coordinates of the shaft that it acts on,
    "xy" being the two displacements at its place; linear: its linear part on these, which joins the matrices of the
    rotor; faults: what is wrong with one beyond the rules of its keys, by the key of its table; told: value and reason
    of its line in the plan; point: what a run's signals call the shaft at its place, with the element's name behind;
    symbol: how the sketch of a report draws it.
    """

    model: type[Any]
    sees: str
    linear: Callable[[Any], LinearPart]
    faults: Callable[[str, Any], list[Fault]]
    told: Callable[[Any], tuple[str, str]]
    point: str
    symbol: str
