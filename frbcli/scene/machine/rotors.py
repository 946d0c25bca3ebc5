"""The rotor of a case as one linear system."""

from __future__ import annotations

from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.rotor import JeffcottRotor, RigidRotor
from frbcli.case.schema import Case
from frbcli.rotor.jeffcott import jeffcott_rotor
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.rigid import rigid_rotor
from frbcli.rotor.ring import with_rings
from frbcli.scene.films import rings
from frbcli.scene.machine.elements import with_elements, without_journals
from frbcli.scene.machine.turbocharger import make_turbocharger


def make_rotor(case: Case) -> LinearRotor:
    """The linear system of a case's rotor, with the masses of floating rings and its elements."""
    rotor = case.rotor
    if isinstance(rotor, RigidRotor):
        made = rigid_rotor(rotor.mass, rotor.unbalance, rotor.external_damping, rotor.gravity)
    elif isinstance(rotor, JeffcottRotor):
        made = jeffcott_rotor(
            rotor.mass,
            rotor.journal_mass,
            rotor.shaft_stiffness,
            rotor.unbalance,
            rotor.external_damping,
            rotor.shaft_damping,
            rotor.gravity,
        )
    else:
        return with_elements(case, make_turbocharger(case))
    if not case.bearings:
        made = without_journals(made)
    if rings(case):
        masses = [None if isinstance(item, SingleFilmBearing) else item.ring.mass for item in case.bearings]
        made = with_rings(made, masses, rotor.gravity, [bearing.name for bearing in case.bearings])
    return with_elements(case, made)
