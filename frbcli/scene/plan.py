"""The plan of a case: what has to be modelled for it, what is left out, and why.

Everything that a run decides on its own is decided here, in the open; what the case fixes by hand is respected.
"""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.case.bearing import CircumferentialGroove, SingleFilmBearing
from frbcli.case.rotor import JeffcottRotor, RigidRotor
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.table import Mesh

THEORIES = ("short", "finite")
CAVITATIONS = ("sommerfeld", "half-sommerfeld")
MIDDLE = 0.5  # axial position of a circumferential groove that parts two equal films
SECTIONS = {"none": 1, "circumferential-groove": 2, "axial-grooves": 1}

# A target of 1e-3 is met by the default mesh with a wide margin (docs/validation.md); a factor of ten less doubles it.
DEFAULT_MESH = Mesh(axial=6, circumferential=96)
FINE_MESH = Mesh(axial=10, circumferential=192)
FINE_TARGET = 2e-4
# Local errors of a step that keep the sum of some revolutions below the target, by method.
LOOSE_TARGET, LOOSE_SHARE, TIGHT_SHARE = 2e-3, 0.02, 0.01


TABULATED_FIELDS = "tabulated fields, clipped at every call"
CHAINS = "solved between the grooves at every call"
# Where elements are summed or solved at every call, each of them costs.
MESHES = {TABULATED_FIELDS: Mesh(axial=6, circumferential=80), CHAINS: Mesh(axial=6, circumferential=48)}


@dataclass(frozen=True)
class Decision:
    """One choice of the plan: what was chosen, and why."""

    choice: str
    value: str
    reason: str


@dataclass(frozen=True)
class Plan:
    """What will be modelled. theory: "short" | "finite"; method: name of a time integration method;
    tolerance: local error of a displacement over the clearance; sections: rectangles of the developed gap."""

    theory: str
    cavitation: str
    mesh: Mesh
    sections: int
    method: str
    tolerance: float
    decisions: tuple[Decision, ...]


def make_plan(case: Case) -> Plan:
    """Plan a case. Raises InputError naming every part of it that this version cannot model yet."""
    _refuse_what_is_not_modelled(case)
    bearing = case.bearings[0]
    assert isinstance(bearing, SingleFilmBearing)
    decisions: list[Decision] = []

    def decide(choice: str, value: object, reason: str) -> None:
        decisions.append(Decision(choice, str(value), reason))

    sections = SECTIONS[bearing.supply.kind]
    if isinstance(bearing.supply, CircumferentialGroove) and bearing.supply.axial_position != MIDDLE:
        sections = 1
    decide("bearings", "1 of 2", "rotor and bearings are symmetric: both journals move alike, forces count twice")
    if bearing.supply.kind == "axial-grooves":
        decide("gap", f"{bearing.supply.count} rectangles", "axial grooves part the turn; odd axial modes vanish")
    elif sections == 2:
        decide("gap", "2 equal rectangles", "a central circumferential groove splits the width; one section is solved")
    elif isinstance(bearing.supply, CircumferentialGroove):
        decide("gap", "1 rectangle", "a circumferential groove at one end: one section of the whole width")
    else:
        decide("gap", "1 rectangle", "plain bearing: the pressure is symmetric about the middle, its odd modes vanish")

    theory, cavitation = case.film.theory, case.film.cavitation
    if theory == "auto":
        theory = "finite"
        decide("theory", theory, "tabulated before the run, it costs as little as the short bearing, without its error")
    else:
        decide("theory", theory, "set in the case")
    decide("cavitation", cavitation, "set in the case; the film has no state of its own, oil is not balanced")
    form = _film_form(case, bearing, theory)
    reason = "rectangular gap: forces depend on the line of centres only"
    if form == CHAINS:
        reason = "the grooves stand still while the line of centres turns: nothing to tabulate"
    decide("film", form, reason)

    mesh = MESHES.get(form, DEFAULT_MESH) if case.accuracy.target > FINE_TARGET else FINE_MESH
    reason = f"holds the target {case.accuracy.target:g} up to an eccentricity of 0.95"
    if case.accuracy.mesh is not None:
        mesh, reason = Mesh(*case.accuracy.mesh), "set in the case"
    if theory == "finite":
        decide("mesh", f"{mesh.axial} x {mesh.circumferential}", f"quadratic elements, axial x around; {reason}")

    if case.accuracy.target > LOOSE_TARGET:
        method, share, reason = "esdirk3", LOOSE_SHARE, "third order, L-stable: enough for a loose target"
    else:
        method, share, reason = "esdirk4", TIGHT_SHARE, "fourth order, L-stable: its error is far below the target"
    decide("integrator", method, reason)
    tolerance, reason = share * case.accuracy.target, f"{share:g} of the target, per step"
    if case.accuracy.tolerance is not None:
        tolerance, reason = case.accuracy.tolerance, "set in the case"
    decide("tolerance", f"{tolerance:g}", reason)
    decide("torque", "left out", "the rotor speed is given and no ring floats")
    return Plan(theory, cavitation, mesh, sections, method, tolerance, tuple(decisions))


def _film_form(case: Case, bearing: SingleFilmBearing, theory: str) -> str:
    """How the film will be evaluated, in words."""
    if bearing.supply.kind == "axial-grooves":
        return CHAINS
    supply = getattr(bearing.supply, "pressure", case.oil.ambient_pressure)
    equal = supply == case.oil.ambient_pressure == case.oil.cavitation_pressure
    if theory == "short":
        return "closed form" if equal else "clipped exactly along z, 96 points around"
    if equal or case.film.cavitation == "sommerfeld":
        return "table over eccentricity and direction"
    return TABULATED_FIELDS


def _refuse_what_is_not_modelled(case: Case) -> None:
    faults = []

    def missing(key: str, value: str, known: tuple[str, ...]) -> None:
        faults.append(Fault(key, value, None, "is not modelled in this version.", f"Modelled are: {', '.join(known)}."))

    if not isinstance(case.rotor, RigidRotor | JeffcottRotor):
        missing("rotor.kind", case.rotor.kind, ("rigid", "jeffcott"))
    for bearing in case.bearings:
        if not isinstance(bearing, SingleFilmBearing):
            missing("bearing.kind", bearing.kind, ("single-film",))
        elif bearing.supply.kind not in SECTIONS:
            missing("bearing.supply.kind", bearing.supply.kind, tuple(SECTIONS))
        elif getattr(bearing.supply, "axial_position", MIDDLE) not in (0.0, MIDDLE, 1.0):
            missing("bearing.supply.axial_position", "", ("0.5, 0 and 1",))
        elif bearing.supply.kind == "axial-grooves" and case.film.theory == "short":
            missing("film.theory", "short", ("finite or auto for a bearing with axial grooves",))
    if case.film.cavitation not in CAVITATIONS:
        missing("film.cavitation", case.film.cavitation, CAVITATIONS)
    if not faults and len(case.bearings) != 1:
        both = "one [bearing], which stands for both of a symmetric rotor"
        missing("bearing", f"{len(case.bearings)} bearings", (both,))
    if faults:
        raise InputError(case.name or "case", tuple(faults))
