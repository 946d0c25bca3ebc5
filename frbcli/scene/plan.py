"""The plan of a case: what has to be modelled for it, what is left out, and why.

Everything that a run decides on its own is decided here, in the open; what the case fixes by hand is respected.
"""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.case.bearing import CircumferentialGroove, FilmGeometry, FloatingRingBearing
from frbcli.case.rotor import TurbochargerRotor
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.gap import ends_at_ambient
from frbcli.film.section_faults import section_faults, starves
from frbcli.film.table import Mesh
from frbcli.scene.coupling import REMEMBERING, coupling_fault, plan_coupling
from frbcli.scene.films import film_places, is_plain, turning_rings
from frbcli.scene.section import film_section

THEORIES = ("short", "finite")
CLOSED = ("sommerfeld", "half-sommerfeld")  # models whose force in a rectangular gap can be tabulated
MIDDLE = 0.5  # axial position of a circumferential groove that parts two equal films
TABULATED = ("none", "circumferential-groove", "axial-grooves")  # supplies of gaps that are rectangles

# A target of 1e-3 is met by the default mesh with a wide margin (docs/validation.md); a factor of ten less doubles it.
DEFAULT_MESH = Mesh(axial=6, circumferential=96)
FINE_MESH = Mesh(axial=10, circumferential=192)
FINE_TARGET = 2e-4
# Cells around and along; over the axis parabolas are exact, so that few are enough.
COARSE_CELLS, DEFAULT_CELLS, FINE_CELLS = (40, 5), (48, 6), (96, 10)
FEWEST_CELLS = (12, 3)
CELL_STEPS = 12.0  # per revolution at least, of films with cells
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
    tolerance: local error of a displacement over the clearance; mesh: of films without cells; cells: (around, along) of
    films with cells, None for the others; steps_per_revolution: at least; coupling: one of COUPLINGS;
    macro_step: longest one in s of a co-simulation, else None."""

    theory: str
    cavitation: str
    mesh: Mesh
    cells: tuple[int, int] | None
    method: str
    tolerance: float
    steps_per_revolution: float
    coupling: str
    macro_step: float | None
    decisions: tuple[Decision, ...]


def make_plan(case: Case) -> Plan:
    """Plan a case. Raises InputError naming every part of it that cannot be modelled."""
    _refuse_what_is_not_modelled(case)
    decisions: list[Decision] = []

    def decide(choice: str, value: object, reason: str) -> None:
        decisions.append(Decision(choice, str(value), reason))

    places = film_places(case)
    first = places[0].geometry
    if isinstance(case.rotor, TurbochargerRotor):
        decide("bearings", f"{len(case.bearings)} of {len(case.bearings)}", "the rotor is not symmetric")
    else:
        decide("bearings", "1 of 2", "rotor and bearings are symmetric: both journals move alike, forces count twice")
    if any(isinstance(bearing, FloatingRingBearing) for bearing in case.bearings):
        decide("films", str(len(places)), "each ring lies between an inner and an outer film, and moves and turns")
    if len(places) == 1:
        decide("gap", *_gap(first))

    theory, cavitation = case.film.theory, case.film.cavitation
    with_cells = needs_cells(case)
    if theory == "auto":
        theory = "finite"
        reason = "tabulated before the run, it costs as little as the short bearing, without its error"
        decide("theory", theory, "the film has cells" if with_cells else reason)
    else:
        decide("theory", theory, "set in the case")
    if cavitation in REMEMBERING:
        decide("cavitation", cavitation, "set in the case; the film conserves oil and keeps it from step to step")
    else:
        decide("cavitation", cavitation, "set in the case; the film has no state of its own, oil is not balanced")
    coupling, reason = plan_coupling(case)
    decide("coupling", coupling, reason)
    macro_step = case.accuracy.macro_step if coupling == "co-simulation" else None
    cells = None
    if with_cells:
        cells = _cells(case)
        why = (
            "set in the case" if case.accuracy.mesh is not None else "parabolas over the width need few along the axis"
        )
        decide("film", f"{cells[0]} x {cells[1]} cells", f"finite volumes, around x along; {why}")
        if case.film.grid != "fixed":
            decide("grid", case.film.grid, "set in the case; the cells go with the oil between journal and shell")
        for place in places:
            section = film_section(case, place.geometry)
            if cavitation in ("elrod", "two-phase") and starves(section):
                reason = (
                    "no oil comes in: the ends are free to air and p_sup is not above p_cav; the film loses its load"
                )
                decide("supply", f"{place.name} starves".strip(), reason)
    else:
        form = _film_form(case, first, theory)
        reason = "rectangular gap: forces depend on the line of centres only"
        if form == CHAINS:
            reason = "the grooves stand still while the line of centres turns: nothing to tabulate"
        decide("film", form, reason)
    mesh = DEFAULT_MESH
    if cells is None:
        form = _film_form(case, first, theory)
        mesh = MESHES.get(form, DEFAULT_MESH) if case.accuracy.target > FINE_TARGET else FINE_MESH
        reason = f"holds the target {case.accuracy.target:g} up to an eccentricity of 0.95"
        if case.accuracy.mesh is not None:
            mesh, reason = Mesh(*case.accuracy.mesh), "set in the case"
        if theory == "finite":
            decide("mesh", f"{mesh.axial} x {mesh.circumferential}", f"quadratic elements, axial x around; {reason}")

    if cells is not None and case.accuracy.target > FINE_TARGET:
        reason = "third order, L-stable: fronts that cross cells leave no more to gain"
        method, share = "esdirk3", LOOSE_SHARE
    elif case.accuracy.target > LOOSE_TARGET:
        method, share, reason = "esdirk3", LOOSE_SHARE, "third order, L-stable: enough for a loose target"
    else:
        method, share, reason = "esdirk4", TIGHT_SHARE, "fourth order, L-stable: its error is far below the target"
    decide("integrator", method, reason)
    tolerance, reason = share * case.accuracy.target, f"{share:g} of the target, per step"
    if case.accuracy.tolerance is not None:
        tolerance, reason = case.accuracy.tolerance, "set in the case"
    decide("tolerance", f"{tolerance:g}", reason)
    steps, reason = float(case.accuracy.steps_per_revolution), "set in the case"
    if "steps_per_revolution" not in case.accuracy.model_fields_set:
        steps, reason = (
            (CELL_STEPS, "at least; a step costs more than it is worth") if cells is not None else (steps, "at least")
        )
    decide("steps", f"{steps:g} per revolution", reason)
    if not turning_rings(case):
        decide("torque", "left out", "the rotor speed is given and no ring turns")
    else:
        decide(
            "torque",
            case.film.torque,
            "turns the rings; set in the case" if case.film.torque != "all" else "turns the rings",
        )
    return Plan(theory, cavitation, mesh, cells, method, tolerance, steps, coupling, macro_step, tuple(decisions))


def needs_cells(case: Case) -> bool:
    """Whether the films of a case are solved on volumes in a run."""
    if case.film.cavitation not in CLOSED:
        return True
    places = film_places(case)
    return any(not _rectangular(place.geometry, len(places) > 1) for place in places)


def _rectangular(film: FilmGeometry, several: bool) -> bool:
    """Whether the gap is made of rectangles whose pressure is known along their edges."""
    supply = film.supply
    if supply.kind not in TABULATED or film.lobes is not None or (several and supply.kind == "axial-grooves"):
        return False
    return getattr(supply, "axial_position", MIDDLE) in (0.0, MIDDLE, 1.0)


def _cells(case: Case) -> tuple[int, int]:
    if case.accuracy.mesh is not None:
        along, around = case.accuracy.mesh
        return max(around, FEWEST_CELLS[0]), max(along, FEWEST_CELLS[1])
    if case.accuracy.target > LOOSE_TARGET:
        return COARSE_CELLS
    return DEFAULT_CELLS if case.accuracy.target > FINE_TARGET else FINE_CELLS


def _gap(film: FilmGeometry) -> tuple[str, str]:
    supply = film.supply
    if supply.kind == "axial-grooves":
        return f"{supply.count} rectangles", "axial grooves part the turn; odd axial modes vanish"
    if isinstance(supply, CircumferentialGroove):
        if supply.axial_position == MIDDLE:
            return "2 equal rectangles", "a central circumferential groove splits the width; one section is solved"
        return "1 rectangle", "a circumferential groove at one end: one section of the whole width"
    if supply.kind == "none":
        return "1 rectangle", "plain bearing: the pressure is symmetric about the middle, its odd modes vanish"
    return "developed gap", f"{supply.kind} are cut out of it"


def _film_form(case: Case, film: FilmGeometry, theory: str) -> str:
    """How a film without cells will be evaluated, in words."""
    if film.supply.kind == "axial-grooves":
        return CHAINS
    supply = getattr(film.supply, "pressure", case.oil.ambient_pressure)
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

    if case.film.theory == "short" and needs_cells(case):
        remedy = "finite or auto for this cavitation model and supply; short knows half-sommerfeld between rectangles"
        missing("film.theory", "short", (remedy,))
    elif case.film.theory == "short" and any(p.geometry.supply.kind == "axial-grooves" for p in film_places(case)):
        missing("film.theory", "short", ("finite or auto for a bearing with axial grooves",))
    fault = coupling_fault(case, needs_cells(case))
    if fault is not None:
        faults.append(fault)
    if case.film.cavitation == "two-phase" and case.film.two_phase.form == "published":
        missing("film.two-phase.form", "published", ("conservative in run-ups",))
    if case.film.grid != "fixed" and not (needs_cells(case) and all(is_plain(p.geometry) for p in film_places(case))):
        missing("film.grid", case.film.grid, ("fixed where a film has openings or lobes, or no cells",))
    for place in film_places(case):
        supply = place.geometry.supply
        if isinstance(supply, CircumferentialGroove) and supply.axial_position not in (0.0, MIDDLE, 1.0):
            missing("bearing.supply.axial_position", f"{supply.axial_position:g}", ("0.5, 0 and 1",))
            continue
        section = film_section(case, place.geometry)
        if case.film.cavitation not in REMEMBERING:  # a film that makes its oil cannot run dry
            section = ends_at_ambient(section)
        for found in section_faults(section):
            faults.append(Fault("bearing", place.name, None, f"cannot be solved: {found.problem}.", found.remedy))
    if not faults and len(case.bearings) != 1 and not isinstance(case.rotor, TurbochargerRotor):
        both = "one [bearing], which stands for both of a symmetric rotor"
        missing("bearing", f"{len(case.bearings)} bearings", (both,))
    if faults:
        raise InputError(case.name or "case", tuple(faults))
