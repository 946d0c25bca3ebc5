"""Symbols of elements without a film, of their dampers and of supports, which have no dimensions, in the sketch of a
machine along its axis."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from frbcli.case.elements import Element
from frbcli.elements.coefficients import GivenCoefficients
from frbcli.report.svg import box, curve, line

WIDE, TURNS, END = 7.0, 4, 4.0  # half the width of a spring, its turns, and its straight ends, in the drawing's units
HIGH = 34.0  # of a symbol
SHELL, FLAT = 22.0, 5.0  # width and height of a shell without dimensions


def height(element: Element) -> float:
    """Of the symbol of an element, with its damper and its support."""
    return len(_layers(element)) * (HIGH + FLAT) - FLAT


def support_symbol(x: float, middle: float, radius: float) -> Iterator[str]:
    """What carries a shell at x, above and below the axis at `middle`, from its radius outwards to the ground."""
    for sign in (-1.0, 1.0):
        yield from _spring(x, middle + sign * radius, sign)
        yield _ground(x, middle + sign * (radius + HIGH))


def symbol(element: Element, x: float, middle: float, radius: float) -> Iterator[str]:
    """An element at x, above and below the axis at `middle`, from the surface of the shaft outwards to the ground, with
    the bodies that carry it; radius: of the shaft there in the drawing."""
    layers = _layers(element)
    for sign in (-1.0, 1.0):
        for number, layer in enumerate(layers, start=1):
            start = middle + sign * (radius + (number - 1) * (HIGH + FLAT))
            end = start + sign * HIGH
            yield from SYMBOLS[layer](x, start, sign)
            body = box(x - 0.5 * SHELL, min(end, end + sign * FLAT), SHELL, FLAT, "shell")
            yield body if number < len(layers) else _ground(x, end)


def _layers(element: Element) -> list[str]:
    """The symbols from the shaft to the ground."""
    damper = [] if element.damper is None else ["damper"]
    return [GivenCoefficients.symbol, *damper, *([] if element.support is None else ["spring"])]


def _spring(x: float, start: float, sign: float) -> Iterator[str]:
    """A zigzag outwards."""
    step = (HIGH - 2.0 * END) / (2 * TURNS)
    points = [(x, start), (x, start + sign * END)]
    points += [(x + (WIDE if i % 2 else -WIDE), start + sign * (END + (i + 0.5) * step)) for i in range(2 * TURNS)]
    points += [(x, start + sign * (HIGH - END)), (x, start + sign * HIGH)]
    yield curve(points, "spring")


def _dashpot(x: float, start: float, sign: float) -> Iterator[str]:
    """A piston in a cylinder that is open inwards."""
    piston, rim, bottom = (start + sign * share * HIGH for share in (0.5, 0.3, 0.7))
    yield curve([(x, start), (x, piston)], "spring")
    yield curve([(x - 0.7 * WIDE, piston), (x + 0.7 * WIDE, piston)], "spring")
    yield curve([(x - WIDE, rim), (x - WIDE, bottom), (x + WIDE, bottom), (x + WIDE, rim)], "spring")
    yield curve([(x, bottom), (x, start + sign * HIGH)], "spring")


def _ground(x: float, at: float) -> str:
    return line(x - 2.0 * WIDE, at, x + 2.0 * WIDE, at, "ground")


SYMBOLS: dict[str, Callable[[float, float, float], Iterator[str]]] = {"spring": _spring, "damper": _dashpot}
