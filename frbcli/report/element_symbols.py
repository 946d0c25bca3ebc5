"""Symbols of elements without a film, which have no dimensions, in the sketch of a machine along its axis."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from frbcli.case.elements import Element
from frbcli.elements.table import kind_of
from frbcli.report.svg import curve, line

WIDE, TURNS, END = 7.0, 4, 4.0  # half the width of a spring, its turns, and its straight ends, in the drawing's units
HIGH = 34.0  # of a symbol


def symbol(element: Element, x: float, middle: float, radius: float) -> Iterator[str]:
    """An element at x, above and below the axis at `middle`, from the surface of the shaft outwards; radius: of the
    shaft there in the drawing."""
    draw = SYMBOLS[kind_of(element).symbol]
    for sign in (-1.0, 1.0):
        yield from draw(x, middle + sign * radius, sign)


def _spring(x: float, start: float, sign: float) -> Iterator[str]:
    """A zigzag to the ground."""
    step = (HIGH - 2.0 * END) / (2 * TURNS)
    points = [(x, start), (x, start + sign * END)]
    points += [(x + (WIDE if i % 2 else -WIDE), start + sign * (END + (i + 0.5) * step)) for i in range(2 * TURNS)]
    points += [(x, start + sign * (HIGH - END)), (x, start + sign * HIGH)]
    yield curve(points, "spring")
    ground = start + sign * HIGH
    yield line(x - 2.0 * WIDE, ground, x + 2.0 * WIDE, ground, "ground")


SYMBOLS: dict[str, Callable[[float, float, float], Iterator[str]]] = {"spring": _spring}
