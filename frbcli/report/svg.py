"""The few elements of SVG that sketches are made of, as text; and symbols of what has no dimensions in the sketch of a
machine along its axis: elements without a film, their dampers and supports."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from html import escape

from frbcli.errors import printable

WIDE, TURNS, END = 7.0, 4, 4.0  # half the width of a spring, its turns, and its straight ends, in the drawing's units
HIGH = 34.0  # of a symbol
SHELL, FLAT = 22.0, 5.0  # width and height of a shell without dimensions


def element(tag: str, content: str = "", **attributes: object) -> str:
    """One element; underscores in attribute names become hyphens, `kind` becomes class; numbers are rounded."""
    written = "".join(f' {_name(name)}="{escape(_text(value))}"' for name, value in attributes.items())
    return f"<{tag}{written}>{content}</{tag}>" if content else f"<{tag}{written}/>"


def text(x: float, y: float, words: str, kind: str = "label", anchor: str = "middle") -> str:
    """A line of text; anchor: "start" | "middle" | "end"."""
    return element("text", escape(printable(words)), x=x, y=y, kind=kind, text_anchor=anchor)


def line(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    """A straight line between two points in units of the drawing; kind: class of the style sheet."""
    return element("line", x1=x1, y1=y1, x2=x2, y2=y2, kind=kind)


def box(x: float, y: float, width: float, height: float, kind: str) -> str:
    """A rectangle by its upper left corner, as line."""
    return element("rect", x=x, y=y, width=width, height=height, kind=kind)


def curve(points: Sequence[tuple[float, float]], kind: str, closed: bool = False) -> str:
    """A line through points, as line; closed: back to the first one."""
    return element("path", d="M" + "L".join(f"{x:.2f},{y:.2f}" for x, y in points) + "Z" * closed, kind=kind)


def drawing(width: float, height: float, parts: Sequence[str], name: str) -> str:
    """The whole drawing, as wide as its place; name: for readers who do not see it."""
    return element(
        "svg", "\n".join(parts), xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {width:.0f} {height:.0f}",
        role="img", aria_label=printable(name),
    )  # fmt: skip


def _name(name: str) -> str:
    return "class" if name == "kind" else name.replace("_", "-")


def _text(value: object) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)


def height(symbols: Sequence[str]) -> float:
    """Height of a stack of symbols with the bodies between them."""
    return len(symbols) * (HIGH + FLAT) - FLAT * bool(symbols)


def stack(
    symbols: Sequence[str], x: float, middle: float, radius: float, housing: float | None = None
) -> Iterator[str]:
    """Symbols at x, above and below the axis at `middle`, from a radius outwards to the ground, with the bodies between
    them; housing: distance from the axis of the body that they are fixed to, if not to the ground."""
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
