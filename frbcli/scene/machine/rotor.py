"""The machine of a case without its films: shaft, rings, supports and elements as one linear system."""

from __future__ import annotations

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.case.surroundings.force import AppliedForce
from frbcli.case.surroundings.places import node_at
from frbcli.elements import force, support
from frbcli.elements.table import kind_of
from frbcli.rotor.assembly import Link, assembled
from frbcli.rotor.body import Body, point_mass, spin
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.over_speed import LinearPart
from frbcli.scene.films import turning_rings
from frbcli.scene.shafts.table import shaft_of


def make_rotor(case: Case) -> LinearRotor:
    """The machine of a case, with its films in the order of film_places and the angles of its turning rings last.

    Raises InputError if its shaft has no modes.
    """
    shaft = shaft_of(case)
    count = float(shaft.equal_bearings)  # the rings of equal bearings move as one, with the mass of all of them
    bodies, films = [shaft.body()], []
    for bearing in case.bearings:
        journal, shell = shaft.journal(bearing.name), support.shell_of(bearing.name, bearing.support)
        if isinstance(bearing, FloatingRingBearing):
            ring = f"ring_{bearing.name}".rstrip("_")
            bodies.append(point_mass(ring, count * bearing.ring_mass, case.rotor.gravity))
            films += [Link(journal, ring, count=count), Link(ring, shell, count=count)]
        else:
            films.append(Link(journal, shell, count=count))
    parts = []
    for element in case.elements:
        kind = kind_of(element)
        shell = support.shell_of(element.name, element.support)
        parts.append((Link(shaft.journal(element.name), shell, count, kind.sees), kind.linear(element)))
    shells, mounts = _supports(case, count)
    bodies += [*shells, *(spin(bearing.ring_inertia) for bearing in turning_rings(case))]
    return assembled(bodies, films, [*parts, *mounts], [force.node_force(*each) for each in placed_forces(case)])


def placed_forces(case: Case) -> list[tuple[AppliedForce, str, float]]:
    """Force, node and count of each force of a case: at equal bearings there are as many of it."""
    bearings = float(shaft_of(case).equal_bearings)
    nodes = [node_at(case, each.at) for each in case.forces]
    counts = [1.0 if node.startswith("disk") else bearings for node in nodes]
    return list(zip(case.forces, nodes, counts, strict=True))


def _supports(case: Case, count: float) -> tuple[list[Body], list[tuple[Link, LinearPart]]]:
    """The bodies of the shells that move, and what holds them."""
    given = [(bearing.name, bearing.support) for bearing in case.given_bearings if bearing.support is not None]
    bodies = [support.body(name, each, count, case.rotor.gravity) for name, each in given]
    return bodies, [support.mount(name, each, count) for name, each in given]
