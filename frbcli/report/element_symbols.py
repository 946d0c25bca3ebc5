"""Symbols of elements without a film, of their dampers and of supports, which have no dimensions, in the sketch of a
machine along its axis."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from frbcli.report.svg import box, curve, line

WIDE, TURNS, END = 7.0, 4, 4.0  # half the width of a spring, its turns, and its straight ends, in the drawing's units
HIGH = 34.0  # of a symbol
SHELL, FLAT = 22.0, 5.0  # width and height of a shell without dimensions


def height(symbols: Sequence[str]) -> float:
    """Height of a stack of symbols with the bodies between them."""
    return len(symbols) * (HIGH + FLAT) - FLAT * bool(symbols)


def stack(
    symbols: Sequence[str], x: float, middle: float, radius: float, housing: float | None = None
) -> Iterator[str]:
    """Symbols at x, above and below the axis at `middle`, from a radius outwards to the ground, with the bodies between
    them; housing: distance from the axis of what they are fixed to in place of the ground."""
    for sign in (-1.0, 1.0):
        for number, symbol in enumerate(symbols, start=1):
            start = middle + sign * (radius + (number - 1) * (HIGH + FLAT))
            end = start + sign * HIGH
            yield from SYMBOLS[symbol](x, start, sign)
            body = box(x - 0.5 * SHELL, min(end, end + sign * FLAT), SHELL, FLAT, "shell")
            if number < len(symbols):
                yield body
            elif housing is None:
                yield _ground(x, end)
        if housing is not None:
            yield line(x, middle + sign * (radius + height(symbols)), x, middle + sign * housing, "spring")


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
