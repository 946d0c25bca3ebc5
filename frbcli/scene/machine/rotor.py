"""The machine of a case without its films: shaft, rings and elements as one linear system."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from frbcli.arrays import Array
from frbcli.case.bearing import CartridgeBearing, FloatingRingBearing, GivenBearing
from frbcli.case.schema import Case
from frbcli.elements.collar.thrust import COLLAR
from frbcli.elements.damper import DamperElement
from frbcli.elements.element import Parts
from frbcli.rotor.assembly import Link, assembled, preset
from frbcli.rotor.body import PLANE, Body, point_mass, spin, tilting_mass, tilting_ring
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.films import turning_rings
from frbcli.scene.machine.elements import element_parts, site_of
from frbcli.scene.shafts.table import shaft_of


def make_rotor(case: Case, sees: tuple[str, ...] = PLANE, free_speed: bool = False) -> LinearRotor:
    """The machine of a case, with its films in the order of film_places and the angles of its turning rings last. sees:
    the coordinates of their journals that films act on; free_speed: with the angle of the rotor before them.

    Raises InputError if its shaft has no modes.
    """
    bodies, films, elements, centred = _bodies_and_links(case, sees, free_speed)
    rotor = preset(_assembled(bodies, films, elements), centred)
    return replace(rotor, cones=tuple(_cones(case, bodies)))


def _assembled(bodies: Sequence[Body], films: Sequence[Link], elements: Parts) -> LinearRotor:
    return assembled(bodies, films, elements.links, elements.forces, elements.loads, elements.ports)


def collar_tilt(case: Case) -> Array | None:
    """(2, n) tilts about x and y of the collar of a case against its pads, None where it does not act in tilt."""
    bodies, _, elements, _ = _bodies_and_links(case, PLANE)
    links = [link for link, _ in elements.links if link.inside == COLLAR]
    return assembled(bodies, links).journals[0] if links else None


def _bodies_and_links(
    case: Case, sees: tuple[str, ...], free_speed: bool = False
) -> tuple[list[Body], list[Link], Parts, list[int]]:
    """Bodies of the machine, links of its films, parts of its elements, and which of the films are centred dampers."""
    site, count = site_of(case), float(shaft_of(case).equal_bearings)
    bodies, films = [shaft_of(case).body()], []
    for given in case.given_bearings:
        bodies += _rings(given, count, case)
    for bearing in case.bearings:
        journal, shell = site.journal(bearing.name), site.shell(bearing.name)
        if isinstance(bearing, FloatingRingBearing):
            ring = _ring_node(bearing)
            films += [Link(journal, ring, count, sees), Link(ring, shell, count, sees)]
        else:
            films.append(Link(journal, shell, count, sees))
    dampers = list(DamperElement.of(case))
    centred = [len(films) + number for number, damper in enumerate(dampers) if damper.given.centred]
    films += [replace(damper.link(site), sees=sees) for damper in dampers]
    elements = element_parts(case)
    spins = [spin(sum(bearing.ring_inertia for bearing in around)) for around in turning_rings(case)]
    rotation = [spin(case.polar_inertia)] if free_speed else []
    return [*bodies, *elements.bodies, *rotation, *spins], films, elements, centred


def _ring_node(bearing: FloatingRingBearing) -> str:
    """The node of a ring: of a cartridge, the node of one end."""
    return f"ring_{bearing.name}".rstrip("_")


def _rings(bearing: GivenBearing, count: float, case: Case) -> Iterator[Body]:
    """The bodies of the ring of a bearing: the rings of equal bearings move as one, with the mass of all. A ring of its
    own tilts where its films follow that."""
    gravity = case.rotor.gravity
    if isinstance(bearing, CartridgeBearing):
        (mass, _, tilt_inertia), (left, right), (start, end) = bearing.body, bearing.parts, bearing.positions
        yield tilting_mass((_ring_node(left), _ring_node(right)), mass, tilt_inertia, end - start, gravity)
    if isinstance(bearing, FloatingRingBearing):
        node, mass = _ring_node(bearing), count * bearing.ring_mass
        tilts, inertia = case.film.tilt == "follows", count * bearing.ring_tilt_inertia
        yield tilting_ring(node, mass, inertia, gravity) if tilts else point_mass(node, mass, gravity)


def _cones(case: Case, bodies: Sequence[Body]) -> Iterator[tuple[int, Array]]:
    """See LinearRotor: the slopes of the rings that turn and tilt."""
    around = turning_rings(case)
    if not around:
        return
    slopes = assembled(bodies, [Link(_ring_node(ends[0]), sees=("tilt_y", "tilt_x")) for ends in around]).journals
    for number, (ends, slope) in enumerate(zip(around, slopes, strict=True), start=slopes.shape[2] - len(around)):
        if slope.any():  # in y it is that about x against it
            inertia = sum(end.ring_inertia for end in ends)
            yield number, math.sqrt(inertia) * slope * [[1.0], [-1.0]]
