"""What a kind of element says of itself: the row of `table.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from frbcli.errors import Fault
from frbcli.rotor.over_speed import LinearPart


@dataclass(frozen=True)
class ElementKind:
    """One kind of element.

    model: its table in a case file, of frbcli/case/elements.py; sees: those of the COORDINATES of a node of the shaft
    that it acts on; linear: its linear part on these, which joins the matrices of the rotor; faults: what is wrong with
    one beyond the rules of its keys, by the key of its table; told: value and reason of its line in the plan; symbol:
    how the sketch of a report draws it.
    """

    model: type[Any]
    sees: str
    linear: Callable[[Any], LinearPart]
    faults: Callable[[str, Any], list[Fault]]
    told: Callable[[Any], tuple[str, str]]
    symbol: str
