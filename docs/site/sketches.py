"""Draw the sketches of terms.md and rotors.md: `python docs/site/sketches.py [FOLDER]`, by default docs/images.

The clearances are far too large, so that the film is visible. Angles, signs and frames are those of
docs/conventions.md.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle, Wedge

from frbcli.plot.style import BLUE, GREEN, GREY, ORANGE, SKY, VERMILION, styled

IMAGES = Path(__file__).resolve().parents[1] / "images"
STEEL, OIL, SHELL, RING = "#E6E6E6", "#CFE3F5", "#BDBDBD", "#F3DFC1"
ARROW = {"arrowstyle": "-|>", "color": "black", "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
LEADER = {"arrowstyle": "-", "color": GREY, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
DIMENSION = {"arrowstyle": "<|-|>", "color": "black", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 8}


def main(folder: Path) -> None:
    """Draw all sketches into `folder`."""
    with styled():
        for name, draw in SKETCHES.items():
            figure = Figure(figsize=(8.6, 4.3))
            draw(figure)
            figure.savefig(folder / f"terms-{name}.png", dpi=150, metadata={"Software": None})


def panel(axes: Axes, title: str, width: tuple[float, float], height: tuple[float, float]) -> Axes:
    """Axes of equal scale without frame, for a drawing."""
    axes.set_title(title)
    axes.set_aspect("equal")
    axes.set_xlim(*width)
    axes.set_ylim(*height)
    axes.axis("off")
    return axes


def arc(axes: Axes, centre: tuple[float, float], radius: float, degrees: tuple[float, float], colour: str) -> None:
    """An arrow along a circle, from one angle to another, counted from the x-axis."""
    angles = np.radians(np.linspace(*degrees, 60))
    x, y = centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)
    axes.plot(x, y, color=colour, linewidth=1.2)
    axes.annotate("", (x[-1], y[-1]), (x[-3], y[-3]), arrowprops={**ARROW, "color": colour})


def pointed(axes: Axes, words: str, at: tuple[float, float], text: tuple[float, float], side: str = "left") -> None:
    """Words beside the drawing with a line to the place that they name."""
    axes.annotate(words, at, text, ha=side, va="center", arrowprops=LEADER)


def bearing(figure: Figure) -> None:
    """Cross-section and section along the axis of a plain bearing."""
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    cross_section(panel(left, "cross-section, seen against z", (-1.9, 2.2), (-1.75, 1.6)))
    along_axis(panel(right, "section along the axis", (-1.75, 1.9), (-1.5, 1.5)))


def cross_section(axes: Axes) -> None:
    """Journal, shell, eccentricity and attitude angle."""
    shell, journal = 1.0, 0.74
    attitude = 50.0  # from the load to the line of centres, counter-clockwise
    direction = np.radians(-90.0 + attitude)
    e = 0.55 * (shell - journal)
    x, y = e * np.cos(direction), e * np.sin(direction)
    axes.add_patch(Wedge((0, 0), 1.25, 0, 360, width=1.25 - shell, facecolor=SHELL, edgecolor="black"))
    axes.add_patch(Circle((0, 0), shell, facecolor=OIL, edgecolor="none"))
    axes.add_patch(Circle((x, y), journal, facecolor=STEEL, edgecolor="black"))
    axes.plot([0, 0], [1.35, -1.1], color=GREY, linewidth=0.7, linestyle="-.")
    far = 1.42
    reach = np.array([-0.35, far])
    axes.plot(reach * np.cos(direction), reach * np.sin(direction), color=BLUE, linewidth=1.0, linestyle="-.")
    axes.plot([0, x], [0, y], color=VERMILION, linewidth=2.2, marker="o", markersize=3.5)
    axes.annotate("", (0, -1.7), (0, -1.3), arrowprops=ARROW)
    axes.text(0.06, -1.55, "load", va="center")
    arc(axes, (0, 0), 0.55, (-90.0, -90.0 + attitude), BLUE)
    axes.annotate("attitude\nangle", (0.1, -0.54), (-1.85, -0.5), va="center", color=BLUE, arrowprops=LEADER)
    arc(axes, (x, y), 0.52, (110.0, 200.0), "black")
    axes.text(x - 0.3, y + 0.24, "ω", fontsize=12)
    arc(axes, (0, 0), 1.36, (90.0, 128.0), GREY)
    axes.text(-0.62, 1.38, "φ", color=GREY, fontsize=12)
    pointed(axes, "shell", (0.9, 0.72), (1.4, 1.25))
    pointed(axes, "journal", (x + 0.5, y + 0.3), (1.4, 0.85))
    pointed(axes, "film, gap h", (-0.88, 0.1), (-1.85, 0.62))
    pointed(axes, "eccentricity:\ne, or ε = e / C", (x / 2, y / 2), (1.4, 0.3))
    pointed(axes, "line of\ncentres", (far * np.cos(direction), far * np.sin(direction)), (1.4, -0.9))
    narrow = (shell + e + journal) / 2.0
    pointed(axes, "smallest\nfilm thickness", (narrow * np.cos(direction), narrow * np.sin(direction)), (1.4, -0.33))
    axes.annotate("", (-1.7, -1.0), (-1.7, -1.5), arrowprops=ARROW)
    axes.annotate("", (-1.2, -1.5), (-1.7, -1.5), arrowprops=ARROW)
    axes.text(-1.15, -1.5, "x", va="center")
    axes.text(-1.7, -0.95, "y", ha="center", va="bottom")


def along_axis(axes: Axes) -> None:
    """Lands, groove, feed hole, clearance and width."""
    journal, shell, outside, end, groove = 0.55, 0.68, 1.05, 1.0, 0.16
    for sign in (1.0, -1.0):
        low, high = sorted((sign * shell, sign * outside))
        axes.add_patch(Rectangle((-end, low), 2 * end, high - low, facecolor=SHELL, edgecolor="black"))
        bottom, top = sorted((sign * journal, sign * shell))
        axes.add_patch(Rectangle((-end, bottom), 2 * end, top - bottom, facecolor=OIL, edgecolor="none"))
        bottom, top = sorted((sign * shell, sign * (shell + 0.14)))
        axes.add_patch(Rectangle((-groove, bottom), 2 * groove, top - bottom, facecolor=OIL, edgecolor="black"))
    axes.add_patch(Rectangle((-0.05, shell + 0.14), 0.1, outside - shell - 0.14, facecolor=OIL, edgecolor="black"))
    axes.add_patch(Rectangle((-1.45, -journal), 2.9, 2 * journal, facecolor=STEEL, edgecolor="black"))
    axes.plot([-1.6, 1.6], [0, 0], color=GREY, linewidth=0.7, linestyle="-.")
    axes.text(1.64, 0, "z", va="center")
    axes.annotate("", (0, outside + 0.02), (0, outside + 0.3), arrowprops={**ARROW, "color": BLUE})
    axes.text(0.06, outside + 0.24, "supply pressure", color=BLUE, va="center")
    axes.text(0, 0.2, "journal, diameter D", ha="center", va="center")
    axes.text(-0.6, 0.87, "shell", ha="center", va="center")
    for x in (-(end + groove) / 2, (end + groove) / 2):
        axes.annotate("", (x - (end - groove) / 2, -1.17), (x + (end - groove) / 2, -1.17), arrowprops=DIMENSION)
        axes.text(x, -1.27, "land", ha="center", va="center")
    axes.annotate("", (-end, -1.38), (end, -1.38), arrowprops=DIMENSION)
    axes.text(0, -1.47, "width B", ha="center", va="center")
    axes.annotate("", (-0.45, journal), (-0.45, shell), arrowprops={**DIMENSION, "mutation_scale": 5})
    pointed(axes, "clearance C", (-0.45, (journal + shell) / 2), (-1.72, 1.25))
    pointed(axes, "circumferential\ngroove", (groove, shell + 0.07), (1.12, 1.3))
    pointed(axes, "feed hole", (0.05, 0.95), (1.12, 0.95))
    pointed(axes, "end", (end, 0.615), (1.2, 0.66))


def ring(figure: Figure) -> None:
    """A floating ring in cross-section and along the axis."""
    left, right = figure.subplots(1, 2, width_ratios=(1.05, 1.0))
    panel(left, "cross-section", (-1.6, 2.2), (-1.5, 1.5))
    panel(right, "section along the axis", (-1.6, 2.0), (-1.5, 1.5))
    radii = {"shell": 1.15, "outer": 1.0, "ring": 0.86, "inner": 0.58, "journal": 0.5}
    left.add_patch(Circle((0, 0), 1.32, facecolor=SHELL, edgecolor="black"))
    left.add_patch(Circle((0, 0), radii["shell"], facecolor=OIL, edgecolor="black"))
    at = (0.06, -0.07)
    left.add_patch(Circle(at, radii["outer"], facecolor=RING, edgecolor="black"))
    left.add_patch(Circle(at, radii["inner"], facecolor=OIL, edgecolor="black"))
    for angle in np.radians(np.arange(30.0, 390.0, 60.0)):
        across = 0.05 * np.array([-np.sin(angle), np.cos(angle)])
        along = np.array([np.cos(angle), np.sin(angle)])
        ends = [radii["inner"] * along, (radii["outer"] - 0.002) * along]
        corners = [ends[0] + across, ends[1] + across, ends[1] - across, ends[0] - across]
        left.add_patch(Polygon([corner + at for corner in corners], facecolor=OIL, edgecolor="black", linewidth=0.6))
    left.add_patch(Circle((0.1, -0.11), radii["journal"], facecolor=STEEL, edgecolor="black"))
    arc(left, (0.1, -0.11), 0.3, (20.0, 150.0), "black")
    left.text(0.04, -0.05, r"$\omega_R$", fontsize=12)
    arc(left, at, 0.79, (100.0, 138.0), VERMILION)
    left.text(-0.24, 0.54, r"$\omega_F$", fontsize=12, color=VERMILION, ha="center", va="center")
    pointed(left, "shell (housing)", (1.05, 0.68), (1.42, 1.2))
    pointed(left, "outer film", (1.04, 0.26), (1.42, 0.8))
    pointed(left, "floating ring", (0.82, 0.05), (1.42, 0.4))
    pointed(left, "journal", (0.45, -0.1), (1.42, 0.0))
    pointed(left, "inner film", (0.605, -0.25), (1.42, -0.4))
    pointed(left, "channel between\nthe feed holes", (0.72, -0.45), (1.42, -0.85))
    for sign in (1.0, -1.0):
        for low, high, half in ((1.0, 1.15, 0.9), (0.5, 0.6, 0.7)):
            right.add_patch(Rectangle((-half, min(sign * low, sign * high)), 2 * half, high - low, facecolor=OIL))
        right.add_patch(
            Rectangle((-1.1, min(sign * 1.15, sign * 1.4)), 2.2, 0.25, facecolor=SHELL, edgecolor="black")
        )
        half = [(0.9, 1.0), (0.9, 0.74), (0.7, 0.74), (0.7, 0.6)]
        corners = [*half, *((-x, y) for x, y in reversed(half))]
        right.add_patch(Polygon([(x, sign * y) for x, y in corners], facecolor=RING, edgecolor="black"))
        right.add_patch(
            Rectangle((-0.05, min(sign * 0.6, sign * 1.0)), 0.1, 0.4, facecolor=OIL, edgecolor="black", linewidth=0.6)
        )
    right.add_patch(Rectangle((-0.05, 1.15), 0.1, 0.25, facecolor=OIL, edgecolor="black"))
    right.add_patch(Rectangle((-1.35, -0.5), 2.7, 1.0, facecolor=STEEL, edgecolor="black"))
    right.plot([-1.5, 1.5], [0, 0], color=GREY, linewidth=0.7, linestyle="-.")
    right.text(0, 0.2, "journal", ha="center", va="center")
    pointed(right, "supply", (0.0, 1.3), (1.3, 1.32))
    pointed(right, "outer film", (0.8, 1.08), (1.3, 1.0))
    pointed(right, "floating ring", (0.8, 0.85), (1.3, 0.75))
    pointed(right, "inner film", (0.6, -0.55), (1.3, -0.8))
    pointed(right, "channel", (0.0, -0.8), (1.3, -1.15))


def cavitation(figure: Figure) -> None:
    """Pressure around a short bearing, with and without cavitation, and where oil and gas lie."""
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.4, 1.0))
    angle = np.linspace(0.0, 2.0 * np.pi, 721)
    gap = 1.0 + 0.5 * np.cos(angle)
    pressure = np.sin(angle) / gap**3  # of a short bearing, to scale
    degrees = np.degrees(angle)
    above.plot(degrees, pressure, color=GREY, linestyle="--", label="without cavitation (Sommerfeld)")
    above.plot(degrees, np.maximum(pressure, 0.0), color=BLUE, label="with cavitation (half-Sommerfeld)")
    above.axhline(0.0, color="black", linewidth=0.8)
    above.text(4, 0.25, "$p_{cav}$")
    above.set_ylabel("pressure")
    above.legend(loc="lower left")
    above.set_yticks([])
    below.fill_between(degrees, 0.0, gap, color=OIL)
    cavity = angle >= np.pi
    below.fill_between(degrees[cavity], 0.0, gap[cavity], color="white")
    count = 7
    for streamer in range(count):  # the oil of the narrowest gap goes on as streamers, whose sum is constant
        middle = gap[cavity] * (streamer + 0.5) / count
        half = 0.5 * 0.5 / count * np.ones_like(middle)
        below.fill_between(degrees[cavity], middle - half, middle + half, color=OIL, linewidth=0)
    below.plot(degrees, gap, color="black")
    below.axhline(0.0, color="black", linewidth=1.5)
    below.set_ylim(0.0, 1.7)
    below.text(90, 0.4, "full film", ha="center")
    below.text(243, 1.38, "cavity: streamers of oil, gas between them", ha="center")
    below.axvline(180.0, color=VERMILION, linewidth=1.0)
    below.annotate("narrowest gap", (180.0, 0.62), (196.0, 0.2), va="center", arrowprops=LEADER, color=VERMILION)
    below.annotate("", (60.0, 1.6), (20.0, 1.6), arrowprops=ARROW)
    below.text(64.0, 1.6, "the surfaces move", va="center")
    below.set_ylabel("gap")
    below.set_yticks([])
    below.set_xticks(range(0, 361, 90))
    below.set_xlim(0.0, 360.0)
    below.set_xlabel("angle Θ from the widest gap in °")
    for axes in (above, below):
        axes.grid(False)


def whirl(figure: Figure) -> None:
    """Orbits of the journal, and the frequencies of whirl and whip over the rotor speed."""
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.35))
    panel(left, "orbits of the journal in the clearance circle", (-1.35, 1.35), (-1.55, 1.35))
    left.add_patch(Circle((0, 0), 1.0, facecolor=OIL, edgecolor="black"))
    left.text(0.0, 1.1, "ε = 1: contact", ha="center")
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    left.plot(0.3 + 0.07 * np.cos(turn), -0.35 + 0.06 * np.sin(turn), color=GREEN, linewidth=1.5)
    left.plot(0.1 + 0.62 * np.cos(turn), -0.1 + 0.6 * np.sin(turn), color=VERMILION, linewidth=1.5)
    arc(left, (0.1, -0.1), 0.61, (60.0, 120.0), VERMILION)
    left.annotate("synchronous:\nonce per revolution", (0.3, -0.41), (-0.1, -1.33), ha="center", va="center",
                  arrowprops=LEADER, color=GREEN)  # fmt: skip
    words = "whirl: once in about\ntwo revolutions"
    left.text(0.1, 0.16, words, color=VERMILION, ha="center", va="center", fontsize=7.5)
    natural, onset, end = 1.0, 1.35, 3.2
    lock = 2.0 * natural
    right.set_title("frequencies over the rotor speed")
    speed = np.array([0.0, end])
    right.plot(speed, speed, color=GREEN, linewidth=2.0)
    right.plot(speed, 0.5 * speed, color=GREY, linestyle="--")
    right.axhline(natural, color=SKY, linestyle=":", linewidth=1.6)
    right.plot([onset, lock], [0.49 * onset, 0.49 * lock], color=VERMILION, linewidth=3.0)
    right.plot([lock, end], [0.98, 0.98], color=ORANGE, linewidth=3.0)
    right.plot([natural], [natural], color="black", marker="o")
    right.annotate("critical speed", (natural, natural), (0.2, 1.5), va="center", arrowprops=LEADER)
    right.annotate("onset of whirl", (onset, 0.49 * onset), (1.3, 0.3), va="center", arrowprops=LEADER)
    right.annotate("lock-in", (lock, 0.97), (2.0, 0.6), va="center", arrowprops=LEADER)
    right.text(2.1, 2.28, "1X, unbalance", color=GREEN, ha="right")
    right.text(1.68, 0.76, "whirl", color=VERMILION, va="top", weight="bold")
    right.text(2.62, 0.9, "whip", color=ORANGE, va="top", ha="center", weight="bold")
    right.text(2.95, 1.55, "0.5X", color=GREY, ha="right", va="bottom")
    right.text(0.05, 1.03, "natural frequency", color=BLUE, va="bottom", fontsize=8)
    right.set_xlim(0.0, end)
    right.set_ylim(0.0, 2.4)
    right.set_xticks([])
    right.set_yticks([])
    right.set_xlabel("rotor speed")
    right.set_ylabel("frequency of the motion")
    right.grid(False)


def parts(figure: Figure) -> None:
    """Supplies and parts of a machine, each with the key of a case that describes it."""
    drawn = (
        ("axial-grooves", _grooves), ("bores", _bores), ("pocket", _pocket), ("[bearing.pin]", _pin),
        ('kind = "cartridge"', _cartridge), ("[bearing.damper]", _damper), ("[bearing.support], [housing]", _support),
        ("[[thrust_bearing]]", _pad),
    )  # fmt: skip
    for axes, (title, draw) in zip(figure.subplots(2, 4).flat, drawn, strict=True):
        draw(panel(axes, title, (-1.6, 1.6), (-1.45, 1.4)))
        axes.title.set_fontsize(8.5)


def _section(axes: Axes, ring: float = 0.0) -> None:
    """Shell, film and journal across the axis, with a ring in the film up to a radius."""
    for radius, colour in ((1.25, SHELL), (1.0, OIL), *([(ring, RING), (0.72, OIL)] if ring else []), (0.6, STEEL)):
        axes.add_patch(Circle((0, 0), radius, facecolor=colour, edgecolor="black", linewidth=0.8))


def _opening(axes: Axes, at: float, half: float, depth: float) -> None:
    """An opening of the shell about an angle in degrees from the top, so deep."""
    axes.add_patch(Wedge((0, 0), 1.0 + depth, 90 + at - half, 90 + at + half, width=depth + 0.02, facecolor=OIL,
                         edgecolor="black", linewidth=0.8))  # fmt: skip


def _note(axes: Axes, words: str) -> None:
    axes.text(0, -1.4, words, ha="center", va="center", fontsize=7.5)


def _grooves(axes: Axes) -> None:
    _section(axes)
    for at in (60, -120):
        _opening(axes, at, 12, 0.12)
    arc(axes, (0, 0), 0.8, (90, 138), BLUE)
    _note(axes, "count, position, opening_angle")


def _bores(axes: Axes) -> None:
    _section(axes)
    for at in range(0, 360, 60):
        _opening(axes, at, 4, 0.25)
    _note(axes, "count, diameter, on")


def _pocket(axes: Axes) -> None:
    _section(axes)
    _opening(axes, 0, 35, 0.1)
    _note(axes, "position, opening_angle, width")


def _pin(axes: Axes) -> None:
    _section(axes, 0.9)
    axes.add_patch(Rectangle((-0.14, 0.72), 0.28, 0.24, facecolor=OIL, edgecolor="none"))
    axes.add_patch(Rectangle((-0.07, 0.78), 0.14, 0.5, facecolor=SHELL, edgecolor="black", linewidth=0.8))
    _note(axes, "radius, play, stiffness")


def _shaft(axes: Axes, radius: float = 0.3) -> None:
    axes.add_patch(Rectangle((-1.5, -radius), 3.0, 2 * radius, facecolor=STEEL, edgecolor="black", linewidth=0.8))
    axes.plot([-1.6, 1.6], [0, 0], color=GREY, linewidth=0.7, linestyle="-.")


def _boxes(axes: Axes, colour: str, low: float, high: float, *spans: tuple[float, float]) -> None:
    """Rings along the axis between two radii, above and below it."""
    edge = "none" if colour == OIL else "black"
    for begin, end in spans:
        for bottom in (low, -high):
            axes.add_patch(Rectangle((begin, bottom), end - begin, high - low, facecolor=colour, edgecolor=edge,
                                     linewidth=0.8))  # fmt: skip


def _cartridge(axes: Axes) -> None:
    _shaft(axes)
    _boxes(axes, OIL, 0.3, 0.42, (-1.1, -0.5), (0.5, 1.1))
    _boxes(axes, RING, 0.42, 0.68, (-1.1, 1.1))
    _boxes(axes, OIL, 0.68, 0.82, (-1.1, -0.4), (0.4, 1.1))
    _boxes(axes, SHELL, 0.82, 1.1, (-1.3, 1.3))
    _note(axes, "positions, ring, inner, outer")


def _spring(axes: Axes, x: float, low: float, high: float) -> None:
    """A zigzag from one height to another."""
    y = np.linspace(low, high, 9)
    axes.plot(x + 0.1 * np.array([0, 0, 1, -1, 1, -1, 1, 0, 0]), y, color="black", linewidth=0.9)


def _damper(axes: Axes) -> None:
    _shaft(axes)
    _boxes(axes, OIL, 0.3, 0.4, (-0.6, 0.6))
    _boxes(axes, RING, 0.4, 0.62, (-0.7, 1.1))
    _boxes(axes, OIL, 0.62, 0.8, (-0.7, 0.7))
    _boxes(axes, SHELL, 0.8, 1.1, (-1.2, 1.2))
    for low, high in ((0.62, 0.8), (-0.8, -0.62)):
        _spring(axes, 0.9, low, high)
    _note(axes, "film around the shell, spring")


def _support(axes: Axes) -> None:
    _shaft(axes, 0.25)
    for x in (-0.8, 0.8):
        _boxes(axes, OIL, 0.25, 0.35, (x - 0.35, x + 0.35))
        _boxes(axes, RING, 0.35, 0.55, (x - 0.4, x + 0.4))
        _spring(axes, x, -0.85, -0.55)
    axes.add_patch(Rectangle((-1.3, -1.0), 2.6, 0.15, facecolor=SHELL, edgecolor="black", linewidth=0.8))
    for x in (-1.1, 1.1):
        _spring(axes, x, -1.22, -1.0)
    axes.plot([-1.4, 1.4], [-1.22, -1.22], color="black", linewidth=1.2)
    axes.text(0.0, -0.72, "support", ha="center", va="center", fontsize=7.5)
    axes.text(0.0, 0.9, "ring: mass of the support;\nplate: housing on mounts", ha="center", fontsize=7.5)


def _pad(axes: Axes) -> None:
    axes.add_patch(Rectangle((-1.3, 0.25), 2.6, 0.35, facecolor=STEEL, edgecolor="black", linewidth=0.8))
    axes.add_patch(Polygon([(-1.2, -0.35), (0.2, 0.05), (1.1, 0.05), (1.1, -0.7), (-1.2, -0.7)], facecolor=SHELL,
                           edgecolor="black", linewidth=0.8))  # fmt: skip
    axes.add_patch(Polygon([(-1.2, -0.35), (0.2, 0.05), (1.1, 0.05), (1.1, 0.25), (-1.2, 0.25)], facecolor=OIL))
    axes.annotate("", (0.5, 0.42), (-0.5, 0.42), arrowprops=ARROW)
    axes.annotate("", (1.25, 0.05), (1.25, 0.25), arrowprops={**DIMENSION, "mutation_scale": 5})
    axes.text(1.3, 0.15, "gap", va="center", fontsize=7.5)
    axes.annotate("", (-1.3, -0.35), (-1.3, 0.05), arrowprops={**DIMENSION, "mutation_scale": 5})
    axes.text(-1.35, -0.15, "taper", va="center", ha="right", fontsize=7.5, rotation=90)
    for begin, end, words in ((-1.2, 0.2, "taper_angle"), (0.2, 1.1, "land")):
        axes.annotate("", (begin, -0.85), (end, -0.85), arrowprops=DIMENSION)
        axes.text((begin + end) / 2, -1.02, words, ha="center", va="center", fontsize=7.5)
    _note(axes, "pads, pad_angle, end_play")


SKETCHES: dict[str, Callable[[Figure], None]] = {
    "bearing": bearing,
    "cavitation": cavitation,
    "whirl": whirl,
    "ring": ring,
    "parts": parts,
}

if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES)
