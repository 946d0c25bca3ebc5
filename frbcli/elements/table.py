"""All kinds of elements that are no films: what the rest of the program asks, it asks here."""

from __future__ import annotations

from frbcli.case.elements import Element
from frbcli.elements import coefficients
from frbcli.elements.kind import ElementKind

KINDS: tuple[ElementKind, ...] = (coefficients.KIND,)


def kind_of(element: Element) -> ElementKind:
    """The row of an element. Raises KeyError for a table that none has."""
    for kind in KINDS:
        if isinstance(element, kind.model):
            return kind
    raise KeyError(type(element).__name__)
