"""Symbols of elements without a film and of supports, which have no dimensions, in the sketch of a machine along its
axis."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from frbcli.case.elements import Element
from frbcli.elements.coefficients import GivenCoefficients
from frbcli.report.svg import box, curve, line

WIDE, TURNS, END = 7.0, 4, 4.0  # half the width of a spring, its turns, and its straight ends, in the drawing's units
HIGH = 34.0  # of a symbol
SHELL, FLAT = 22.0, 5.0  # width and height of a shell without dimensions


def height(element: Element) -> float:
    """Of the symbol of an element, with its support."""
    return HIGH if element.support is None else 2.0 * HIGH + FLAT


def support_symbol(x: float, middle: float, radius: float) -> Iterator[str]:
    """What carries a shell at x, above and below the axis at `middle`, from its radius outwards to the ground."""
    for sign in (-1.0, 1.0):
        yield from _spring(x, middle + sign * radius, sign)
        yield _ground(x, middle + sign * (radius + HIGH))


def symbol(element: Element, x: float, middle: float, radius: float) -> Iterator[str]:
    """An element at x, above and below the axis at `middle`, from the surface of the shaft outwards; radius: of the
    shaft there in the drawing."""
    draw = SYMBOLS[GivenCoefficients.symbol]
    for sign in (-1.0, 1.0):
        yield from draw(x, middle + sign * radius, sign)
        end = middle + sign * (radius + HIGH)
        yield _ground(x, end) if element.support is None else box(
            x - 0.5 * SHELL, min(end, end + sign * FLAT), SHELL, FLAT, "shell"
        )
    if element.support is not None:
        yield from support_symbol(x, middle, radius + HIGH + FLAT)


def _spring(x: float, start: float, sign: float) -> Iterator[str]:
    """A zigzag outwards."""
    step = (HIGH - 2.0 * END) / (2 * TURNS)
    points = [(x, start), (x, start + sign * END)]
    points += [(x + (WIDE if i % 2 else -WIDE), start + sign * (END + (i + 0.5) * step)) for i in range(2 * TURNS)]
    points += [(x, start + sign * (HIGH - END)), (x, start + sign * HIGH)]
    yield curve(points, "spring")


def _ground(x: float, at: float) -> str:
    return line(x - 2.0 * WIDE, at, x + 2.0 * WIDE, at, "ground")


SYMBOLS: dict[str, Callable[[float, float, float], Iterator[str]]] = {"spring": _spring}
