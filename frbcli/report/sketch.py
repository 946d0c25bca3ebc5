"""Sketches of a machine as SVG: the rotor in its bearings along the axis, and every film around it.

Along the axis every dimension of the case is to scale. A disk has no dimensions in a case: it is drawn as the solid
cylinder of its mass and inertias. Around the axis clearances are magnified; angles are to scale.

The few elements of SVG that sketches are made of, as text; and symbols of what has no dimensions in the sketch of a
machine along its axis: elements without a film, their dampers and supports.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

import numpy as np

from frbcli.case.bearing import FilmBearing, GivenBearing
from frbcli.case.elements import Element
from frbcli.case.film import FilmGeometry
from frbcli.case.schema import Case
from frbcli.elements.supports import DamperElement, SupportElement
from frbcli.elements.table import elements_of, symbols_at
from frbcli.errors import printable
from frbcli.scene.films import HOUSING as STILL
from frbcli.scene.films import film_places
from frbcli.scene.machine.turbocharger import shaft_of

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
                yield line(x - 2.0 * WIDE, end, x + 2.0 * WIDE, end, "ground")
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


SYMBOLS: dict[str, Callable[[float, float, float], Iterator[str]]] = {"spring": _spring, "damper": _dashpot}


WIDTH, MARGIN = 720.0, 46.0  # of the drawing along the axis
HIGHEST = 135.0  # half of it, at most
RECESS = 0.25  # depth of a groove, pocket or slot over the thickness of the body around the film
HOUSING = 0.45  # thickness of a shell over the radius of its film
SPAN, DISK = 5.0, 2.2  # of a rotor without a shaft: distance of its bearings over their width, disk over their journal
ROUND, SHOWN = 200.0, 0.16  # size of a film around the axis; clearance there over the radius
AROUND = 181  # points of a circle
PIN = 4.0  # width of a pin, and how far it stands out of a shell, in the drawing's units
NAMES = 24.0  # room for a line of names above a disk, in the drawing's units
FORCE = 30.0  # length of the arrow of a force, in the drawing's units
GROUND = 32.0  # room for the ground, where it moves
NO_WIDTH, NO_RADIUS = 0.02, 0.0125  # of journals that have no dimensions, m
DENSITY = 7850.0  # kg/m^3 of steel, for the thickness of a disk without inertias


@dataclass(frozen=True)
class _SketchScale:
    """From m along and across the axis to the drawing."""

    per_m: float
    left: float
    middle: float

    def box(self, start: float, end: float, inner: float, outer: float, kind: str) -> str:
        """A body of revolution between two radii, cut along the axis: above and below it."""
        x, width, height = self.left + self.per_m * start, self.per_m * (end - start), self.per_m * (outer - inner)
        above = box(x, self.middle - self.per_m * outer, width, height, kind)
        if inner == 0.0:
            return box(x, self.middle - self.per_m * outer, width, 2.0 * height, kind)
        return above + box(x, self.middle + self.per_m * inner, width, height, kind)


def rotor_sketch(case: Case) -> tuple[str, str]:
    """(drawing along the axis, a sentence about what is not to scale, and one about arrows)."""
    if case.shaft:
        scales = "Shaft and bearings to scale; disks as solid cylinders of their mass and inertias."
        return _of_sections(case), scales + _arrow_note(case)
    if not case.rotor.symmetric:
        return "", "The shaft of this rotor is in a file of its own and is not drawn."
    scales = "Bearings to scale; shaft and disk have no dimensions in this model."
    if not case.bearings:
        scales = "Nothing is to scale: shaft, disk and bearings have no dimensions in this model."
    return _symmetric(case), scales + _arrow_note(case)


def _arrow_note(case: Case) -> str:
    """A sentence about the arrows of elements, "" without any."""
    arrows = ", ".join(dict.fromkeys(" ".join(each.arrow) for each in elements_of(case) if each.arrow))
    return f" Arrows show places, not directions: {arrows}, numbered as in the case." if arrows else ""


def film_sketches(case: Case) -> tuple[tuple[str, str], ...]:
    """(name, drawing around the axis) of every film; clearances are magnified."""
    films = film_places(case)
    return tuple(
        (place.name or "the film", _around(place.geometry, place.name or "film", place.inside != STILL))
        for place in films
    )


@dataclass(frozen=True)
class _Bearing:
    """A bearing: its films from the journal outwards, including its damper's film, none for given coefficients; symbols
    of what connects it to the ground."""

    name: str
    position: float
    films: tuple[FilmGeometry, ...]
    symbols: tuple[str, ...]

    @property
    def shell_radius(self) -> float:
        """Outer radius of what is around its films, m; 0 without films."""
        return (1.0 + HOUSING) * (0.5 * self.films[-1].diameter + self.films[-1].clearance) if self.films else 0.0


def _joined(case: Case) -> Iterator[tuple[FilmBearing | Element, FilmBearing | Element]]:
    """Neighbours whose rings are one body, which is a tube from one to the other."""
    for bearing in case.given_bearings:
        parts: tuple[FilmBearing | Element, ...] = bearing.parts
        yield from pairwise(parts)


def _bearings(case: Case) -> Iterator[_Bearing]:
    for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
        films, symbols = bearing.films, symbols_at(case, key)
        if films and bearing.damper is not None:  # which has the dimensions of a film around others
            films, symbols = (*films, bearing.damper), tuple(each for each in symbols if each != DamperElement.symbol)
        yield _Bearing(bearing.name, bearing.position or 0.0, films, symbols)


def _pin(bearing: GivenBearing, at: float, scale: _SketchScale) -> Iterator[str]:
    """The pin of a ring at z = at, in m, from outside of its shell to where it touches."""
    if bearing.pin is not None:
        film = bearing.films[-1]
        outer = (1.0 + HOUSING) * (0.5 * film.diameter + film.clearance)
        top, tip = scale.middle - scale.per_m * outer - PIN, scale.middle - scale.per_m * bearing.pin.radius
        yield box(scale.left + scale.per_m * at - 0.5 * PIN, top, PIN, tip - top, "shaft")


def _film_parts(films: tuple[FilmGeometry, ...], at: float, scale: _SketchScale) -> Iterator[str]:
    """The rings and the shell around films with their middle at z = at, in m; shells are as thick as they look."""
    for inner, outer in pairwise(films):
        half = 0.5 * max(inner.width, outer.width)
        yield scale.box(at - half, at + half, 0.5 * inner.diameter, 0.5 * outer.diameter, "ring")
        yield from _supply(inner, at, 0.5 * outer.diameter, scale)
    for film in films[-1:]:
        yield from _shell(film, at, scale)


def _shell(film: FilmGeometry, at: float, scale: _SketchScale) -> Iterator[str]:
    inner, half = 0.5 * film.diameter + film.clearance, 0.5 * film.width
    outer = (1.0 + HOUSING) * inner
    yield scale.box(at - half, at + half, inner, outer, "shell")
    yield from _supply(film, at, outer, scale)


def _supply(film: FilmGeometry, at: float, outer: float, scale: _SketchScale) -> Iterator[str]:
    """Where oil enters: through the body outside of the film, or out of a recess in it."""
    start, inner = at - 0.5 * film.width, 0.5 * film.diameter
    outlines = {(each.axial, each.half_width, each.through): None for each in film.supply.outlines(inner, film.width)}
    for axial, half, through in outlines:
        low, high = max(start + axial - half, start), min(start + axial + half, start + film.width)
        yield scale.box(low, high, inner, outer if through else inner + RECESS * (outer - inner), "oil")


def _largest_radius(case: Case) -> float:
    return max((bearing.shell_radius for bearing in _bearings(case)), default=0.0)


def _heights(case: Case, half: float, per_m: float, shaft: float) -> tuple[float, float]:
    """Distance of a housing from the axis, and half the height of a drawing that has room for it and for supports.
    half: of the rotor alone; shaft: largest radius of the elements, m."""
    inner = max(half + (0.0 if case.housing is None else NAMES), *(
        per_m * (bearing.shell_radius or shaft) + height(bearing.symbols)
        for bearing in _bearings(case) if len(bearing.symbols) > (0 if bearing.films else 1)
    ), 0.0)  # fmt: skip
    return inner, inner if case.housing is None else inner + FLAT + HIGH


def _held(case: Case, bearings: list[float]) -> list[float]:
    """Where springs to the ground hold a housing, m; one that is given by its modes, in its middle."""
    if case.housing is None:
        return []
    mounts = [mount.position for mount in case.housing.mounts if mount.position is not None]
    return mounts or (bearings if case.housing.mounts else [0.5 * (min(bearings) + max(bearings))])


def _housing(case: Case, scale: _SketchScale, inner: float, bearings: list[float]) -> Iterator[str]:
    """The housing as a bar above and below the axis, `inner` from it, with what holds it; nothing without one.
    bearings: their positions in m."""
    held = _held(case, bearings)
    ends = [scale.left + scale.per_m * place for place in (min(bearings + held), max(bearings + held))]
    for sign in (-1.0, 1.0) if held else ():
        top = scale.middle + sign * inner - (FLAT if sign < 0.0 else 0.0)
        yield box(ends[0], top, ends[1] - ends[0], FLAT, "shell")
    for place in held:
        yield from stack((SupportElement.symbol,), scale.left + scale.per_m * place, scale.middle, inner + FLAT)


def _of_sections(case: Case) -> str:
    length = sum(section.length for section in case.shaft)
    disks = [(disk, *_cylinder(disk.mass, disk.polar_inertia, disk.diametral_inertia)) for disk in case.disks]
    reach = max([_largest_radius(case), *(radius for _, radius, _ in disks), *(0.5 * s.diameter for s in case.shaft)])
    bearings = [bearing.position or 0.0 for bearing in case.placed_bearings]
    held = _held(case, bearings)
    left = min([0.0, *held, *(disk.position - 0.5 * width for disk, _, width in disks)])
    right = max([length, *held, *(disk.position + 0.5 * width for disk, _, width in disks)])
    per_m = min((WIDTH - 2.0 * MARGIN) / (right - left), HIGHEST / reach)
    thickest = max(0.5 * section.diameter for section in case.shaft)
    inner, half = _heights(case, per_m * reach, per_m, thickest)
    scale = _SketchScale(per_m, 0.5 * (WIDTH - per_m * (right + left)), half + 30.0)
    parts, z = [*_housing(case, scale, inner, bearings)], 0.0
    for disk, radius, width in disks:
        parts.append(scale.box(disk.position - 0.5 * width, disk.position + 0.5 * width, 0.0, radius, "disk"))
    for section in case.shaft:
        bore = 0.5 * section.inner_diameter
        parts.append(scale.box(z, z + section.length, bore, 0.5 * section.diameter, "shaft"))
        z += section.length
    for one, other in _joined(case):
        ends, films = (one.position or 0.0, other.position or 0.0), one.films
        parts.append(scale.box(*ends, 0.5 * films[0].diameter, 0.5 * films[-1].diameter, "ring"))
    for bearing in _bearings(case):
        at = bearing.position
        radius = bearing.shell_radius or _radius_at(case, at)
        parts += stack(bearing.symbols, scale.left + per_m * at, scale.middle, per_m * radius, inner if held else None)
        parts += _film_parts(bearing.films, at, scale)
        parts.append(_named(bearing.name, at, scale, half + 16.0))
    for each in case.given_bearings:
        parts += _pin(each, sum(part.position or 0.0 for part in each.parts) / len(each.parts), scale)
    places = {f"disk_{disk.name or number}": disk.position for number, disk in enumerate(case.disks, start=1)}
    for given in case.placed_bearings:
        at = given.position or 0.0
        places |= {f"{body}_{given.name}": at for body in ("journal", "ring", "shell", "support", "housing")}
    places["housing"] = (case.housing and case.housing.position) or 0.0
    parts += _forces(case, scale, inner, lambda node: (places[node],))
    for disk, radius, _ in disks:
        parts.append(_named(f"{disk.name} {1e3 * disk.mass:.3g} g", disk.position, scale, -per_m * radius - 6.0))
    return _finish(parts, scale, half, len(case.bases), length)


def _symmetric(case: Case) -> str:
    width, journal = _journal(case)
    span = SPAN * width
    disk = max(DISK * journal, 1.1 * _largest_radius(case))
    bearings = list(_bearings(case))
    half_width = 0.5 * max(width, *(bearing.films[-1].width for bearing in bearings if bearing.films), 0.0)
    elements = [bearing for bearing in bearings if not bearing.films]
    per_m = min((WIDTH - 2.0 * MARGIN) / (span + 2.0 * half_width), HIGHEST / disk)
    inner, half = _heights(case, per_m * disk, per_m, journal)
    scale = _SketchScale(per_m, 0.5 * (WIDTH - per_m * span), half + 30.0)
    thin = 0.45 * journal if shaft_of(case).elastic else journal
    parts = [scale.box(0.0, span, 0.0, thin, "vague")]
    parts.append(scale.box(0.5 * span - 0.3 * width, 0.5 * span + 0.3 * width, 0.0, disk, "vague"))
    parts += _housing(case, scale, inner, [0.0, span])
    for at in (0.0, span):
        parts.append(scale.box(at - half_width, at + half_width, 0.0, journal, "shaft"))
        for bearing in bearings:
            place, radius = at, bearing.shell_radius or journal
            if not bearing.films:
                place += half_width * _place(case, elements.index(bearing)) * (1.0 if at else -1.0)
            carried = None if case.housing is None else inner
            parts += stack(bearing.symbols, scale.left + per_m * place, scale.middle, per_m * radius, carried)
            parts += _film_parts(bearing.films, at, scale)
        for given in case.given_bearings:
            parts += _pin(given, at, scale)
        parts.append(_named("bearing", at, scale, half + 16.0))
    one = {"disk": (0.5 * span,), "housing": (0.25 * span,)}
    parts += _forces(case, scale, inner, lambda node: one.get(node, (0.0, span)))
    parts.append(_named(f"{shaft_of(case).disk_mass:.4g} kg", 0.5 * span, scale, -per_m * disk - 6.0))
    return _finish(parts, scale, half, len(case.bases), None, bool(case.bearings))


def _forces(
    case: Case, scale: _SketchScale, housing: float, places: Callable[[str], tuple[float, ...]]
) -> Iterator[str]:
    """An arrow with its letter and number for each element that acts on a node of the machine, at the places of that in
    m; it shows no direction. housing: its distance from the axis, in the drawing's units."""
    drawn: Counter[str] = Counter()
    for each in elements_of(case):
        node = each.acts_on
        if each.arrow is None or not node:
            continue
        letter, _ = each.arrow
        drawn[letter] += 1
        y = scale.middle - (housing + FLAT if node.startswith("housing") else 0.0)
        for at in places(node):
            x = scale.left + scale.per_m * at
            yield from _arrow([(x, y - FORCE), (x, y)])
            yield text(x + 6.0, y - 0.6 * FORCE, f"{letter}{drawn[letter]}", anchor="start")


def _place(case: Case, number: int) -> float:
    """The place of an element of a symmetric rotor, from the middle of a journal outwards over half its width: next to
    the film, or spread over the journal."""
    if case.bearings:
        return 1.25 + 0.5 * number
    return 2.0 * (number + 0.5) / len(case.elements) - 1.0


def _journal(case: Case) -> tuple[float, float]:
    """Width and radius of a journal in m; of a machine without films, which has no dimensions, of any."""
    if not case.bearings:
        return NO_WIDTH, NO_RADIUS
    film = case.bearings[0].films[0]
    return film.width, 0.5 * film.diameter


def _radius_at(case: Case, position: float) -> float:
    """Outer radius of a shaft in m at a position."""
    end = 0.0
    for section in case.shaft:
        end += section.length
        if position <= end:
            return 0.5 * section.diameter
    return 0.5 * case.shaft[-1].diameter


def _named(words: str, at: float, scale: _SketchScale, y: float) -> str:
    return text(scale.left + scale.per_m * at, scale.middle + y, words)


def _moving_ground(motions: int, y: float) -> Iterator[str]:
    """The ground at y with a double arrow and a number B for each of its motions; it shows no direction."""
    if motions:
        x, under = 0.5 * WIDTH, y + 10.0
        yield line(MARGIN, y, WIDTH - MARGIN, y, "ground")
        yield from _arrow([(x, under), (x - FORCE, under)])
        yield from _arrow([(x, under), (x + FORCE, under)])
        yield text(x + FORCE + 8.0, under + 4.0, ", ".join(f"B{i + 1}" for i in range(motions)), anchor="start")


def _finish(
    parts: list[str], scale: _SketchScale, half: float, motions: int, length: float | None, to_scale: bool = True
) -> str:
    """With the motions of the ground, the axis and a bar for the scale, where there is one."""
    height = 2.0 * half + 86.0 + (GROUND if motions else 0.0)
    parts += _moving_ground(motions, scale.middle + half + 30.0)
    bar = _round_length((WIDTH - 2.0 * MARGIN) / scale.per_m / 6.0)
    y, x = height - 14.0, MARGIN
    parts.append(line(8.0, scale.middle, WIDTH - 8.0, scale.middle, "axis"))
    if to_scale:
        parts.append(line(x, y, x + scale.per_m * bar, y, "bar"))
        parts.append(text(x + scale.per_m * bar + 8.0, y + 4.0, f"{1e3 * bar:g} mm", anchor="start"))
    if length is not None:
        parts.append(text(WIDTH - MARGIN, y + 4.0, f"shaft of {1e3 * length:g} mm", anchor="end"))
    return drawing(WIDTH, height, parts, "rotor and bearings, cut along the axis")


def _round_length(about: float) -> float:
    """1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(about))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= about)


def _cylinder(mass: float, polar: float, diametral: float) -> tuple[float, float]:
    """(radius, width) in m of the solid cylinder with these inertias; of steel where they are not given."""
    if polar <= 0.0:
        radius = (mass / (DENSITY * math.pi)) ** (1.0 / 3.0)
        return radius, radius
    radius = math.sqrt(2.0 * polar / mass)
    square = 12.0 * diametral / mass - 3.0 * radius**2
    return radius, max(math.sqrt(max(square, 0.0)), 0.08 * radius)


def _around(film: FilmGeometry, name: str, turns: bool) -> str:
    """Shell, journal in the middle, openings; phi = 0 at the top, counter-clockwise. turns: whether its journal does,
    which has an arrow then."""
    middle, radius = 0.5 * ROUND + 8.0, 0.34 * ROUND
    size = 2.0 * middle

    def place(phi: float, r: float) -> tuple[float, float]:
        return middle - r * math.sin(phi), middle - r * math.cos(phi)

    turn = [2.0 * math.pi * i / (AROUND - 1) for i in range(AROUND)]
    outer = [place(phi, 1.4 * radius) for phi in turn]
    inner = [place(phi, radius * (1.0 + SHOWN * _gap(film, phi))) for phi in turn]
    parts = [curve(outer, "shell", closed=True), curve(inner, "film", closed=True)]
    for opening in film.supply.outlines(0.5 * film.diameter, film.width):
        start, end = opening.position - opening.half_angle, opening.position + opening.half_angle
        if opening.half_angle >= math.pi:  # all around: no bore wall is left to draw
            continue
        arc = [start + (end - start) * i / 40.0 for i in range(41)]
        rim = [place(phi, radius * (1.0 + SHOWN * _gap(film, phi))) for phi in arc]
        back = [place(phi, 1.27 * radius) for phi in reversed(arc)]
        parts.append(curve(rim + back, "oil", closed=True))
    journal = radius
    parts.append(element("circle", cx=middle, cy=middle, r=journal, kind="shaft"))
    if turns:
        parts += _arrow([place(-0.5 + 1.0 * i / 20.0, 0.55 * radius) for i in range(21)])
    parts.append(text(middle, middle + 6.0, f"⌀ {1e3 * film.diameter:g} mm"))
    parts.append(text(middle, middle + 22.0, f"C {1e6 * film.clearance:.3g} µm"))
    return drawing(size, size, parts, f"{name}, cut across the axis")


def _arrow(shaft: list[tuple[float, float]]) -> list[str]:
    """An arrow along points."""
    (x_1, y_1), (x_2, y_2) = shaft[-2:]
    ahead = math.atan2(y_2 - y_1, x_2 - x_1)
    left, right = ((x_2 - 8.0 * math.cos(ahead + side), y_2 - 8.0 * math.sin(ahead + side)) for side in (-0.45, 0.45))
    return [curve(shaft, "arrow"), curve([left, shaft[-1], right], "arrow")]


def _gap(film: FilmGeometry, phi: float) -> float:
    """The gap of the centred journal over the clearance, as far as it can be drawn."""
    return 1.0 if film.shell is None else min(1.0 + float(film.shell.depth(np.array([phi]))[0]), 2.4)
