"""The machine of a case without its films: shaft, rings and elements as one linear system."""

from __future__ import annotations

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.elements.table import kind_of
from frbcli.rotor.assembly import Link, assembled
from frbcli.rotor.body import point_mass, spin
from frbcli.rotor.linear import LinearRotor
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
        journal = shaft.journal(bearing.name)
        if isinstance(bearing, FloatingRingBearing):
            ring = f"ring_{bearing.name}".rstrip("_")
            bodies.append(point_mass(ring, count * bearing.ring_mass, case.rotor.gravity))
            films += [Link(journal, ring, count=count), Link(ring, count=count)]
        else:
            films.append(Link(journal, count=count))
    bodies += [spin(bearing.ring_inertia) for bearing in turning_rings(case)]
    parts = []
    for element in case.elements:
        kind = kind_of(element)
        parts.append((Link(shaft.journal(element.name), count=count, sees=kind.sees), kind.linear(element)))
    return assembled(bodies, films, parts)
