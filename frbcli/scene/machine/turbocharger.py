"""The turbocharger of a case: beam, wheels, reduction, bearings and rings as one linear rotor."""

from __future__ import annotations

import math

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.rotor import TurbochargerRotor
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.rotor.beam import BeamSection
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.reduction import RIGID, FreeModes, free_modes
from frbcli.rotor.ring import with_rings
from frbcli.rotor.turbocharger import Journal, Wheel, turbocharger_rotor, wheels_on_shaft
from frbcli.scene.films import rings
from frbcli.scene.machine.elements import element_places


def make_turbocharger(case: Case) -> LinearRotor:
    """The reduced rotor of a case with its rings, without its elements; films in the order of the bearings, inner
    before outer ones.

    Raises InputError if the case has another rotor.
    """
    rotor = turbocharger_of(case)
    modes = all_modes(case)
    reduced = turbocharger_rotor(
        modes.lowest(kept_modes(rotor, modes)),
        wheels(case),
        journals(case),
        rotor.modal_damping,
        rotor.external_damping,
        rotor.gravity,
        element_places(case),
    )
    if not rings(case):
        return reduced
    masses = [bearing.ring.mass if isinstance(bearing, FloatingRingBearing) else None for bearing in case.bearings]
    return with_rings(reduced, masses, rotor.gravity, [bearing.name for bearing in case.bearings])


def turbocharger_of(case: Case) -> TurbochargerRotor:
    """The rotor of a case. Raises InputError if it is no turbocharger's."""
    if isinstance(case.rotor, TurbochargerRotor):
        return case.rotor
    fault = Fault("rotor.kind", case.rotor.kind, None, "has no shaft of sections.", 'Take kind = "turbocharger".')
    raise InputError(case.name or "case", (fault,))


def all_modes(case: Case) -> FreeModes:
    """The modes of the free rotor of a case, before any reduction, see free_modes. Raises InputError if its masses and
    stiffnesses differ by too many powers of ten for them."""
    sections = [
        BeamSection(
            part.length,
            part.diameter,
            part.inner_diameter,
            part.density,
            part.youngs_modulus,
            part.poisson_ratio,
        )
        for part in case.shaft
    ]
    try:
        return free_modes(wheels_on_shaft(sections, wheels(case), (*journals(case), *element_places(case))))
    except NotConverged as error:
        problem = f"is no shaft whose motion can be computed. {error}"
        remedy = "Check the orders of magnitude of its sections and of the masses of [[disk]]."
        fault = Fault("shaft", f"{len(sections)} sections", None, problem, remedy)
        raise InputError(case.name or "case", (fault,)) from None


def kept_modes(rotor: TurbochargerRotor, modes: FreeModes) -> int:
    """How many modes of each plane the rotor keeps: up to its cut-off frequency, or as many as it says."""
    count = rotor.modes if rotor.cutoff is None else modes.below(2 * math.pi * rotor.cutoff)
    return min(max(count, RIGID), len(modes.frequencies))


def wheels(case: Case) -> tuple[Wheel, ...]:
    """The disks of a case; those without a name are numbered."""
    return tuple(
        Wheel(
            disk.name or str(number),
            disk.position,
            disk.mass,
            disk.polar_inertia,
            disk.diametral_inertia,
            disk.unbalance,
            disk.phase,
        )
        for number, disk in enumerate(case.disks, start=1)
    )


def journals(case: Case) -> tuple[Journal, ...]:
    """The journals of a case, one per bearing with a film."""
    return tuple(Journal(bearing.name, bearing.position or 0.0) for bearing in case.bearings)
