"""The few elements of SVG that sketches are made of, as text."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from frbcli.errors import printable


def element(tag: str, content: str = "", **attributes: object) -> str:
    """One element; underscores in the names of attributes stand for hyphens, `kind` for class; numbers are rounded."""
    told = "".join(f' {_name(name)}="{escape(_text(value))}"' for name, value in attributes.items())
    return f"<{tag}{told}>{content}</{tag}>" if content else f"<{tag}{told}/>"


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
