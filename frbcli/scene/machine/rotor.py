"""The machine of a case without its films: shaft, rings and elements as one linear system."""

from __future__ import annotations

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.elements.damper import DamperElement
from frbcli.rotor.assembly import Link, assembled
from frbcli.rotor.body import point_mass, spin
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.films import turning_rings
from frbcli.scene.machine.elements import element_parts, site_of
from frbcli.scene.shafts.table import shaft_of


def make_rotor(case: Case) -> LinearRotor:
    """The machine of a case, with its films in the order of film_places and the angles of its turning rings last.

    Raises InputError if its shaft has no modes.
    """
    site, count = site_of(case), float(shaft_of(case).equal_bearings)
    bodies, films = [shaft_of(case).body()], []
    for bearing in case.bearings:
        journal, shell = site.journal(bearing.name), site.shell(bearing.name)
        if isinstance(bearing, FloatingRingBearing):  # the rings of equal bearings move as one, with the mass of all
            ring = f"ring_{bearing.name}".rstrip("_")
            bodies.append(point_mass(ring, count * bearing.ring_mass, case.rotor.gravity))
            films += [Link(journal, ring, count=count), Link(ring, shell, count=count)]
        else:
            films.append(Link(journal, shell, count=count))
    films += [damper.link(site) for damper in DamperElement.of(case)]
    elements, spins = element_parts(case), [spin(bearing.ring_inertia) for bearing in turning_rings(case)]
    return assembled([*bodies, *elements.bodies, *spins], films, elements.links, elements.forces, elements.loads)
