"""The plan of a case: what has to be modelled for it, what is left out, and why.

All choices that the program makes for a run are made here, with their reasons; settings of the case take precedence.
The expected error comes with the plan; a run states its own. Cases of thrust bearings alone have a plan of their own.

The plan of a second, coarser run is here, too: the difference shows how uncertain the results of a run are. On the same
cells the error differs by a factor of 10 to 20 between machines with rings (docs/accuracy.md), which two short runs
from the beginning show, on the cells of the plan and on more of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from frbcli.case.bearing import CartridgeBearing, FloatingRingBearing
from frbcli.case.film import FilmGeometry
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import Mesh
from frbcli.film.pad_geometry import COARSE, MESH
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.changes import clearance_decisions, drive_decisions, input_decisions, loss_decisions
from frbcli.scene.cost import ExpectedCost, clock, expected_cost, memory_B
from frbcli.scene.coupling import FULL, coupling_named, plan_coupling
from frbcli.scene.course import ERROR_ORDERS, reference_length, resolution_decisions
from frbcli.scene.films import (
    coupled,
    film_places,
    opens_to_groove,
    resistance,
    rings,
    turning_rings,
    turns_with_oil,
)
from frbcli.scene.forms import SOLVED_EACH_CALL
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import RUN
from frbcli.scene.machine.rotor import element_decisions
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.cell_choice import KNEE, heavily_loaded, run_up_profile
from frbcli.scene.planning.film_choice import (
    FINE_TARGET,
    LOOSE_TARGET,
    Decision,
    FilmChoice,
    Plan,
    about_oil,
    choose_films,
    form_of,
)
from frbcli.scene.supply import unfed_films
from frbcli.units import display

LOOSER = 3.0  # tolerance of a step over the run's
COARSER = 0.75  # elements in each direction over the run's
FEWEST_ELEMENTS = 2, 24  # axial, around
SHARE = 1.0 / 3.0  # of the CPU time of a run that a second one may take unasked


def coarser_plan(case: Case, plan: Plan) -> Plan:
    """The plan with fewer cells or elements, a larger tolerance and longer steps; cells: the cells of the stated error
    of a run. Where the steps of a revolution are as few as a run may take, the tolerance decides nothing; their number
    is then reduced so that the error of a step grows by the same factor as the tolerance."""
    films = tuple((form, _coarser(mesh)) for form, mesh in plan.films)
    cells = plan.form.fewer_cells(case, plan) or plan.cells
    steps = plan.steps_per_revolution / LOOSER ** (1.0 / ERROR_ORDERS[plan.method])
    coarser = replace(plan, films=films, mesh=_coarser(plan.mesh), cells=cells)
    return replace(coarser, tolerance=LOOSER * plan.tolerance, steps_per_revolution=steps)


def cost_of_run(case: Case, plan: Plan, profile: SpeedProfile, asked: bool = False) -> ExpectedCost:
    """Expected cost of a run with a second one, if that is asked for or made unasked."""
    cost, second_s = expected_cost(case, plan, profile), second_run_s(case, plan, profile)
    if not (asked or is_cheap(second_s, cost)):
        return cost
    both_B = memory_B(case, plan, profile.end / case.output.step, coarser_plan(case, plan))
    return replace(cost, second_s=second_s, memory_B=both_B)


def second_run_s(case: Case, plan: Plan, profile: SpeedProfile) -> float:
    """Expected CPU time in s of the second run."""
    cost = expected_cost(case, coarser_plan(case, plan), profile)
    return cost.before_s + cost.cpu_s


def is_cheap(second_s: float, cost: ExpectedCost) -> bool:
    """Whether a second run of so many s of CPU time is made unasked, after a run of that cost."""
    return second_s <= SHARE * cost.run_s


def _coarser(mesh: Mesh) -> Mesh:
    axial, around = (
        max(min(least, elements), round(COARSER * elements))
        for elements, least in zip((mesh.axial, mesh.circumferential), FEWEST_ELEMENTS, strict=True)
    )
    return replace(mesh, axial=axial, circumferential=around)


REVOLUTIONS = 10.0  # of the rotor that are tried: a journal falls, and rings take up their speed
MOMENTS = 2000  # at which they are counted
# Of the finer run, over the plan's: cells around, cells along, tolerance of a step.
AROUND, ALONG, TOLERANCE = 1.5, 1.3, 0.125
STEP_AROUND = 8
# Openings often come in threes and sixes. Where all of them have the same place between the cells, their errors do not
# cancel: on 120 x 10 cells floating-ring has twice the error of 128 x 10.
ALIKE = 3
TRIED_SHARE, LONGEST_s = 0.05, 1.0  # of the CPU time of the run, and at most, that both short runs may take
BEGINNING = 0.45  # time that they take with rings, over the time with whirling journals: measured 0.25 to 0.6


@dataclass(frozen=True)
class Trial:
    """plan, finer: of the two short runs; profile: their speeds."""

    plan: Plan
    finer: Plan
    profile: SpeedProfile


def planned_trial(case: Case, plan: Plan, profile: SpeedProfile) -> Trial | None:
    """The trial of a run along a speed profile; None where the films have no cells that were chosen by a target, or
    where it would take long compared with the run."""
    if not plan.form.by_cells or plan.cells is None:
        return None
    end = end_of_trial(profile)
    trial = Trial(plan, _finer(plan), profile.with_stops([end]).until(end))
    costs = [expected_cost(case, each, trial.profile) for each in (trial.plan, trial.finer)]
    share = BEGINNING if rings(case) else 1.0
    spent_s = sum(cost.before_s + share * cost.cpu_s for cost in costs)
    return trial if spent_s <= min(TRIED_SHARE * cost_of_run(case, plan, profile).total_s, LONGEST_s) else None


def end_of_trial(profile: SpeedProfile) -> float:
    """Time in s at which the rotor has turned REVOLUTIONS times, or the end of the profile."""
    times = np.linspace(profile.times[0], profile.end, MOMENTS)
    turns = np.abs(profile.speed(times)) / (2.0 * math.pi)
    passed = np.concatenate([[0.0], np.cumsum(0.5 * (turns[1:] + turns[:-1]) * np.diff(times))])
    return float(times[-1]) if passed[-1] <= REVOLUTIONS else float(np.interp(REVOLUTIONS, passed, times))


def _finer(plan: Plan) -> Plan:
    assert plan.cells is not None
    around, along = plan.cells
    more = STEP_AROUND * math.ceil(AROUND * around / STEP_AROUND)
    more += STEP_AROUND * (more % ALIKE == 0)
    longer = [length for length in plan.form.lengths if length >= ALONG * along]
    lengths = min(longer, default=max(along, *plan.form.lengths))
    return replace(plan, cells=(more, lengths), tolerance=TOLERANCE * plan.tolerance)


SUMMED = 10.0  # number of local errors that add up: 1 to 13 as measured (docs/accuracy.md)
REACH = 0.5  # usual eccentricity of a static equilibrium, the factor of an error of the force; cells have their own


@dataclass(frozen=True)
class ExpectedError:
    """eccentricity: of the eccentricities until a whirl grows; film_force: relative, None where it is not known:
    without films, and for cells, whose eccentricities have the known error."""

    eccentricity: float
    film_force: float | None


def expected_error(plan: Plan) -> ExpectedError:
    """From the tolerance of a step and the known error of the films of a plan."""
    form = plan.form
    reach = 1.0 if form.by_cells else REACH
    force = None if form.by_cells or not form.solved else plan.film_error
    return ExpectedError(SUMMED * plan.tolerance + reach * plan.film_error, force)


THEORIES = ("short", "finite")
# Least steps per revolution of finite-volume films, and of films that are solved at every film call. More steps would
# raise the cost more than they reduce the error.
CELL_STEPS, SOLVED_STEPS = 12.0, 20.0
# Local error of a step over the target, by method: the errors of some revolutions then add up to less than the target.
LOOSE_SHARE, TIGHT_SHARE = 0.02, 0.01
# The same of finite-volume films, over the error of the cells where that is above the target: the steps then add up to
# 0.3 of the target, for rotors on rings to 0.01 to 0.4 of it. Set on jeffcott-two-phase, axial-groove-two-phase and
# floating-ring, without the turbochargers and the hard cases.
CELL_SHARE = 0.025
# Of it, for laws and loads where errors of steps grow. Of 9 two-phase films under a mean pressure of 56 to 123 bar,
# with targets of 1e-2 and 3e-3, 11 of 18 held them with the usual steps, the others had up to 6 times their targets.
# With these 14 hold them, the others have 1.4 to 3.2 times theirs. The time loop takes 1.4 to 3 times as long.
HEAVY_SHARE = 1.0 / 16.0
LOOSER_TARGET, LOOSEST = math.sqrt(2.0), 0.1  # targets that a budget is tried with
REACHED = 1.2  # expected error over the target that counts as met

Decide = Callable[[str, object, str], None]


def make_plan(case: Case, analysis: str = RUN) -> Plan:
    """Plan a case: the cheapest models that hold its target, or the most exact within its budget.

    Parameters
    ----------
    case : Case
        The machine. Mesh and tolerance that it sets are kept.
    analysis : str
        What it is planned for, "run" or "plan of films at rest": not all films that can be at rest can move.

    Returns
    -------
    Plan
        What will be modelled, and why.

    Raises
    ------
    InputError
        Naming every part of it that cannot be modelled.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> frbcli.make_plan(case).theory
    'short'
    """
    require(case, analysis)
    target, budget = case.accuracy.target, case.accuracy.budget
    plan = _plan(case, target)
    while budget is not None and _total_s(case, plan) > budget and target < LOOSEST:
        target = min(LOOSER_TARGET * target, LOOSEST)
        plan = _plan(case, target)
    plan = replace(plan, decisions=(*plan.decisions, *resolution_decisions(case, plan)))
    if not plan.form.by_cells and budget is None:
        return plan
    return replace(plan, decisions=(*plan.decisions, _about_target(case, plan)))


def _about_target(case: Case, plan: Plan) -> Decision:
    """What the target needs, and why the plan has something else."""
    accuracy = case.accuracy
    by_itself = altered(accuracy, {"mesh": None, "tolerance": None})
    asked = _plan(altered(case, {"accuracy": by_itself}), accuracy.target)
    error, needed = expected_error(plan).eccentricity, expected_error(asked).eccentricity
    which = "error of such cells" if plan.form.by_cells else "expected error"
    own = f"{which} {error:.1g}, {clock(_total_s(case, plan))}"
    by_hand = accuracy.mesh is not None or accuracy.tolerance is not None
    value, needs, knee = f"{accuracy.target:g}", "needs", ""
    if needed > REACHED * accuracy.target:
        value, needs = f"{value} is out of reach", "nearest to it"
        if asked.form.by_cells:
            knee = f"; the cheapest cells within {KNEE:g} times the least error that can be had"
    elif heavily_loaded(case) and asked.form.by_cells:
        value, knee = f"{value} is not certain", "; errors of steps grow in such a film under such a load"
    if (plan.cells, plan.mesh, plan.tolerance) == (asked.cells, asked.mesh, asked.tolerance):
        return Decision("target", value, own + knee)
    reasons = ["set in the case"] if by_hand else []
    if accuracy.budget is not None and _total_s(case, asked) > accuracy.budget:
        reasons.append(f"budget of {accuracy.budget:g} s")
    why = ", ".join(reasons)
    cost = f"{needed:.1g}, {clock(_total_s(case, asked))}{knee}"
    mesh = f"{asked.mesh.axial} x {asked.mesh.circumferential} elements"
    mesh = mesh if asked.cells is None else "{} x {} cells".format(*asked.cells)
    needs += f" {mesh} and tolerance {asked.tolerance:.2g}: {cost}"
    return Decision("target", value, f"{needs}; chosen: {own}; {why}")


def _total_s(case: Case, plan: Plan) -> float:
    """Expected CPU time of a run-up."""
    return cost_of_run(case, plan, run_up_profile(case)).total_s


def _plan(case: Case, target: float) -> Plan:
    """The cheapest plan that holds a target."""
    decisions: list[Decision] = []

    def decide(choice: str, value: object, reason: str) -> None:
        decisions.append(Decision(choice, str(value), reason))

    _decide_scene(case, decide)
    for decided in drive_decisions(case):
        decide(*decided)
    films, coupling, length = choose_films(case, target), FULL.name, 0.0
    if case.films:
        coupling = _decide_films(case, films, decide)
    else:  # the bearings are all given by coefficients
        length, reason = reference_length(case)
        decide("length", display(length, "m"), f"what errors are relative to: {reason}")
    method, tolerance, steps = _time_integration(case, films, target, decide)
    if turning_rings(case):
        reason = "turns the rings" if case.drive is None else "turns the rings and brakes the rotor"
        reason = reason if case.film.torque == "all" else f"{reason}; set in the case"
        decide("torque", case.film.torque, reason)
    elif case.films and case.drive is None:
        decide("torque", "left out", "the rotor speed is given and no ring turns")
    elif case.films:
        decide("torque", "of the films", "brakes the rotor, whose speed is free")
    return Plan(
        theory=films.theory,
        cavitation=case.film.cavitation,
        form=films.form,
        mesh=films.mesh,
        films=films.films,
        cells=films.cells,
        film_error=films.error,
        method=method,
        tolerance=tolerance,
        steps_per_revolution=steps,
        coupling=coupling,
        macro_step=case.accuracy.macro_step if coupling_named(coupling).in_turn else None,
        decisions=tuple(decisions),
        length=length,
        eccentricity=films.eccentricity,
    )


def _decide_films(case: Case, films: FilmChoice, decide: Decide) -> str:
    """The films: their models, supply and form, and the coupling of rotor and films, which is returned."""
    _decide_models(case, films, decide)
    for film in unfed_films(case):
        decide("supply", f"{film.name} {'starves' if film.keeps else 'missing'}".strip(), film.reason)
    coupling, reason = plan_coupling(case)
    decide("coupling", coupling, reason)
    _decide_form(case, films, decide)
    return coupling


def _decide_models(case: Case, films: FilmChoice, decide: Decide) -> None:
    """Theory and cavitation."""
    decide("theory", films.theory, films.theory_why)
    for name, cavitation, is_set in _cavitations(case):
        reason = about_oil(case, law_named(cavitation))
        decide("cavitation", name, f"{'set in the case' if is_set else 'the default'}; {reason}")


def _decide_scene(case: Case, decide: Decide) -> None:
    """Bearings, films and gap."""
    places = film_places(case)
    shaft = shaft_of(case)
    decide("bearings", *shaft.bearings_modelled)
    for choice, size, unit, acts in shaft.dampings:
        if size > 0.0:
            decide(choice, display(size, unit), acts)
    if shaft.bow > 0.0:
        offset, where = shaft.bow_words
        decide("bow", offset, f"{where}; turns with the shaft, also slowly")
    for decided in element_decisions(case):
        decide(*decided)
    if rings(case):
        moves = "moves, tilts and turns" if case.film.tilt == "follows" else "moves and turns"
        decide("films", len(places), f"each ring lies between an inner and an outer film, and {moves}")
    for given in case.given_bearings:
        if given.kind == "cartridge":
            decide(f"cartridge {given.name}".strip(), *_body(given, case.film.tilt == "follows"))
    for bearing in rings(case):
        alone = bearing in case.given_bearings  # and not an end of a cartridge
        if computed := _computed(bearing, alone and case.film.tilt == "follows"):
            decide(f"ring {bearing.name}".strip(), *computed)
        if coupled(bearing):
            decide("channels", f"{bearing.name} coupled".strip(), _coupling_of_films(case, bearing))
    if len(places) == 1 and form_of(case).solved:
        decide("gap", *_gap(places[0].geometry))
    for place in places:
        if (sealing := place.geometry.sealing) and form_of(case).solved:
            decide(f"{place.name} ends".strip().replace("_", " "), *sealing)
    if summits := case.contact.about_summits:
        decide("contact", *summits)
    for decided in (*clearance_decisions(case), *loss_decisions(case), *input_decisions(case)):
        decide(*decided)
    if case.heat is not None:
        gap = "follows the temperatures" if case.heat.clearance == "follows" else "does not follow it"
        decide("heat", "lumped", f"set in the case; viscosity follows the temperature of each film, the gap {gap}")


def _body(bearing: CartridgeBearing, follows: bool) -> tuple[str, str]:
    """The body of a cartridge, and how it moves."""
    (mass, _, tilt_inertia), (start, end) = bearing.body, bearing.positions
    value = f"{1e3 * mass:.4g} g, tilt {1e6 * tilt_inertia:.4g} kg*mm^2"
    spins = "turns" if bearing.ring.spin == "free" else "is kept from turning by a pin"
    why = f"one rigid body from {display(start, 'm')} to {display(end, 'm')}, which moves, tilts and {spins}"
    return value, f"{why}; the gap of each film {'follows its tilt' if follows else 'is even along its width'}"


def _computed(bearing: FloatingRingBearing, tilts: bool) -> tuple[str, str] | None:
    """Mass and inertias of a ring that the case does not give, with what they follow from; None where it gives all."""
    ring, numbers, reasons = bearing.ring, [], []
    if ring.given_mass is None:
        numbers.append(f"mass {1e3 * bearing.ring_mass:.4g} g")
        width = display(bearing.ring_width, "m")
        reasons.append(f"a cylinder of {ring.material}, {width} wide, between both diameters; feed holes are left in")
    if ring.given_inertia is None:
        numbers.append(f"inertia {1e6 * bearing.ring_inertia:.4g} kg*mm^2")
        reasons.append("of a hollow cylinder of its mass, m (D_i^2 + D_o^2) / 8")
    if tilts and ring.tilt_inertia is None:
        numbers.append(f"tilt {1e6 * bearing.ring_tilt_inertia:.4g} kg*mm^2")
        width = display(bearing.ring_width, "m")
        reasons.append(f"about a diameter, of a hollow cylinder {width} wide: I / 2 + m B^2 / 12")
    return (", ".join(numbers), "; ".join(reasons)) if numbers else None


def _cavitations(case: Case) -> tuple[tuple[str, str, bool], ...]:
    """Texts for the cavitation models of the films, the models, and whether the case sets them: one for all films, or
    one each."""
    common = "cavitation" in case.film.model_fields_set
    places = film_places(case)
    are_set = [common or getattr(place.geometry, "cavitation", None) is not None for place in places]
    if len(set(case.cavitations)) == len(set(are_set)) == 1:
        return ((case.cavitations[0], case.cavitations[0], are_set[0]),)
    names = (place.name for place in places)
    return tuple(
        (f"{name}: {model}", model, is_set)
        for name, model, is_set in zip(names, case.cavitations, are_set, strict=True)
    )


def _coupling_of_films(case: Case, bearing: FloatingRingBearing) -> str:
    end = "a groove of given pressure in the outer film" if opens_to_groove(bearing) else "the outer film"
    return f"oil flows between the inner film and {end}; resistance {resistance(case, bearing):.3g} Pa s/m^3 each"


def _decide_form(case: Case, films: FilmChoice, decide: Decide) -> None:
    """Form and mesh, with the error of the force."""
    for decided in films.form.decisions(case, films):
        decide(*decided)
    with_oil = [place.name for place in film_places(case) if turns_with_oil(case, place)]
    if with_oil and films.form.by_cells:
        reason = "set in the case" if case.film.grid != "auto" else "no openings, and the film is mass-conserving"
        several = len(with_oil) < len(film_places(case))
        which = f"{', '.join(with_oil)}: half-speed" if several else "half-speed"
        decide("grid", which, f"{reason}; the cells turn as the oil does, so that it does not diffuse")


def _time_integration(case: Case, films: FilmChoice, target: float, decide: Decide) -> tuple[str, float, float]:
    """Method, tolerance and steps per revolution."""
    by_cells = films.form.by_cells
    if by_cells and target > FINE_TARGET:
        reason = "third order, L-stable: cavity fronts that cross cells limit the order"
        method, share = "esdirk3", LOOSE_SHARE
    elif target > LOOSE_TARGET:
        method, share, reason = "esdirk3", LOOSE_SHARE, "third order, L-stable: sufficient for a large target"
    else:
        method, share, reason = "esdirk4", TIGHT_SHARE, "fourth order, L-stable: its error is far below the target"
    decide("integrator", method, reason)
    whole = "the target" if target == case.accuracy.target else f"{target:.2g}, the target that the budget pays for"
    tolerance, reason = share * target, f"{share:g} of {whole}, for each step"
    if films.form.by_cells:
        share = CELL_SHARE * (HEAVY_SHARE if heavily_loaded(case) else 1.0)
        tolerance, reason = share * target, f"{share:.2g} of {whole}, for each step"
        if films.error > target:
            tolerance = share * films.error
            reason = f"{share:.2g} of the error of the cells, for each step: less would cost more and gain nothing"
        if heavily_loaded(case):
            reason += "; short ones, since their errors grow under such a load"
    if case.accuracy.tolerance is not None:
        tolerance, reason = case.accuracy.tolerance, "set in the case"
    decide("tolerance", f"{tolerance:g}", reason)
    steps, reason = float(case.accuracy.steps_per_revolution), "set in the case"
    if "steps_per_revolution" not in case.accuracy.model_fields_set:
        reason = "at least; more steps raise the cost more than they reduce the error"
        if by_cells:
            steps = CELL_STEPS
        elif films.form in SOLVED_EACH_CALL and target > FINE_TARGET:
            steps = SOLVED_STEPS
        else:
            reason = "at least"
    decide("steps", f"{steps:g} per revolution", reason)
    return method, tolerance, steps


def _gap(film: FilmGeometry) -> tuple[str, str]:
    supply = film.supply
    if film.shell is not None:
        return "developed gap", f"with {film.shell.words}, supply {supply.kind}"
    return supply.gap


def thrust_plan(case: Case) -> tuple[Decision, ...]:
    """What `frb thrust` models of a case, and why."""
    radial, angular = MESH
    choices = []
    for bearing in case.thrust_bearings:
        land = "no land" if bearing.taper_angle >= bearing.pad_angle else "a land behind it"
        depth = f"{bearing.profile} of {display(bearing.taper, 'm')}, {land}; grooves at ambient pressure"
        choices.append(Decision("thrust bearing", f"{bearing.name} {bearing.pads} pads, {bearing.side}".strip(), depth))
    return (
        *choices,
        Decision("cavitation", case.film.cavitation, "only where the pressure falls below the cavitation pressure"),
        _viscosity(case),
        Decision("mesh", f"{radial} x {angular}", "quadratic elements of a pad, radius by angle"),
        Decision("error", f"from {COARSE[0]} x {COARSE[1]}", "stated with each state by `frb thrust`"),
    )


def _viscosity(case: Case) -> Decision:
    if case.heat is not None:
        return Decision("heat", "lumped", "each side has the viscosity of the temperature at which its heat balances")
    return Decision("viscosity", f"{1e3 * case.oil_viscosity:.4g} mPa*s", "of [oil], in the whole film")
