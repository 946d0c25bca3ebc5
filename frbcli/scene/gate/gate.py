"""The gate: one table of rules, each with the analyses that it holds for. Every analysis asks it before a film is made.

A rule is a function of a case that yields the faults: key, value, problem, remedy. What a form of films or a coupling
is not made for is in its own row, see `rules` in scene/forms.py and scene/coupling.py. `docs/matrix.md` is made by
asking this gate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.coupling import coupling_of
from frbcli.scene.films import channel_faults, tilts
from frbcli.scene.gate import films, kinematic, runs, static
from frbcli.scene.gate.kinematic import choice_faults, key_in, tested_case
from frbcli.scene.gate.rule import (
    ALL,
    BEARING,
    CHART,
    COMPARISON,
    CYCLES,
    EVERY_CYCLE,
    FILMS,
    HEAT,
    KINEMATIC,
    LADDER,
    LOADED,
    RANGE,
    RUN,
    SHEETS,
    SPEED_CYCLES,
    STABILITY,
    STILL,
    WHIRLS,
    Faults,
    Rule,
    refusal,
)
from frbcli.scene.machine.rotor import (
    element_faults,
    speed_dependent,
    stray_load_faults,
    without_bearing,
    without_film,
)
from frbcli.scene.planning.film_choice import form_of
from frbcli.scene.tilted import AT_REST, RUNS


def _of_films(of: Callable[[Case], Faults]) -> Callable[[Case], Faults]:
    """A rule of films alone, which a machine without any does not break."""
    return lambda case: of(case) if case.films else ()


def _without_film(what: str) -> Callable[[Case], Faults]:
    return lambda case: without_film(case, what)


RULES = (
    Rule(element_faults, ALL),
    Rule(channel_faults, ALL),
    Rule(films.pull_faults, ALL),
    Rule(films.supply_faults, ALL),
    Rule(films.limited_supply_faults, ALL),
    Rule(films.bath_faults, ALL),
    Rule(films.sealed_faults, ALL),
    Rule(films.published_faults, ALL),
    Rule(lambda case: films.published_tilt_faults(case, bool(case.bearings) and tilts(case)), KINEMATIC),
    Rule(
        lambda case: films.published_tilt_faults(case, form_of(case).inclines),
        tuple(each for each in ALL if each not in KINEMATIC),
    ),
    Rule(films.mesh_faults, ALL),
    Rule(films.rough_faults, ALL),
    Rule(films.rough_tilt_faults, KINEMATIC),
    Rule(films.rough_coupling_faults, (RUN,)),
    refusal(
        (*KINEMATIC, *EVERY_CYCLE), "contact.model",
        lambda case: "asperities" if case.contact.rough and case.heat else None,
        "makes heat by friction, and in cycles and tests the films alone make heat",
        f'{films.SMOOTH}, or thermal.model = "none".',
    ),
    Rule(films.saturation_faults, ALL),
    Rule(films.sound_faults, ALL),
    Rule(films.moved_gas_faults, (RUN, *EVERY_CYCLE), moving=True),
    Rule(films.enclosed_faults, KINEMATIC),
    *(Rule(partial(kinematic.motion_faults, test=test), (test,)) for test in KINEMATIC),
    Rule(kinematic.no_film_faults, KINEMATIC),
    Rule(_without_film("a bearing sheet describes films; ball bearings have `ball_bearing_sheet`"), SHEETS),
    Rule(_without_film("a comparison is one of models of films"), (COMPARISON,)),
    Rule(_without_film("the ladder compares theories and meshes of films"), (LADDER,)),
    Rule(static.linear_faults, EVERY_CYCLE),
    *(Rule(partial(kinematic.turning_faults, test=test), (test,)) for test in KINEMATIC),
    Rule(kinematic.theory_faults, KINEMATIC),
    *(Rule(partial(kinematic.tilt_faults, test=test), (test,)) for test in KINEMATIC),
    Rule(kinematic.misalignment_faults, tuple(each for each in ALL if each not in (*KINEMATIC, *AT_REST, *RUNS))),
    Rule(lambda case: () if form_of(case).inclines else kinematic.misalignment_faults(case), (*AT_REST, *RUNS)),
    Rule(static.tilted_sheet_faults, SHEETS),
    Rule(_of_films(runs.theory_faults), (RUN, *KINEMATIC)),
    Rule(_of_films(runs.form_faults), (RUN,)),
    Rule(_of_films(runs.changing_supply_faults), (RUN,)),
    Rule(static.sheet_faults, SHEETS),
    Rule(films.sheet_faults, SHEETS),
    Rule(films.loaded_faults, (LOADED,)),
    refusal(
        (LOADED,), "thermal.model", static.lumped, "needs the load of a [rotor], and takes no other",
        'Leave --load out and add [rotor] and [speed], or write thermal.model = "none".',
    ),
    refusal(
        (CHART,), "thermal.model", static.lumped,
        "is not modelled over eccentricity: the temperatures belong to the load of the rotor",
        'Choose --over speed, or write thermal.model = "none": films then have oil.temperature.',
    ),
    refusal((HEAT,), "thermal", lambda case: None if case.heat else "", "is missing",
            'Add the table [thermal] with model = "lumped".'),
    Rule(static.held_ring_faults, (BEARING, LOADED, STABILITY)),
    Rule(static.held_film_faults, (BEARING, LOADED, STABILITY)),
    Rule(static.held_cycle_faults, EVERY_CYCLE),
    Rule(static.pin_cycle_faults, EVERY_CYCLE),
    Rule(static.port_coupling_faults, (RUN,)),
    Rule(films.rest_faults, (BEARING, STABILITY, *EVERY_CYCLE)),
    Rule(films.linear_faults, (STABILITY, *EVERY_CYCLE)),
    Rule(static.coefficient_faults, (STABILITY,)),
    Rule(static.range_faults, (RANGE,)),
    Rule(static.given_coefficient_faults, (SPEED_CYCLES, WHIRLS)),
    Rule(static.cartridge_faults, EVERY_CYCLE),
    Rule(lambda case: speed_dependent(case, static.CONSTANT), (CYCLES,)),
    Rule(static.cycle_heat_faults, (SPEED_CYCLES, WHIRLS)),
    refusal((CYCLES,), "thermal.model", static.lumped, "balances the heat of limit cycles over the speed alone",
            static.HEAT_REMEDY),
    Rule(stray_load_faults, EVERY_CYCLE),
    Rule(static.smooth_faults, (CYCLES,)),
    Rule(static.speed_cycle_faults, (SPEED_CYCLES, WHIRLS)),
    Rule(static.unbalance_faults, (WHIRLS,)),
    Rule(static.speed_range_faults, EVERY_CYCLE, last=True),
    Rule(runs.kept_film_faults, (RUN,), moving=True),
    Rule(runs.axial_heat_faults, (RUN,), moving=True),
    Rule(runs.axial_faults, (RUN, *EVERY_CYCLE), moving=True, last=True),
    Rule(runs.drive_faults, (RUN,)),
    refusal(
        (*KINEMATIC, *EVERY_CYCLE, LADDER), "drive", lambda case: "" if case.drive else None,
        "leaves the speed free, and this analysis needs a given one", "Write [speed] instead of [drive].",
    ),
    Rule(runs.number_faults, (RUN,), last=True),
    Rule(runs.speed_faults, (RUN,), last=True),
    *(Rule(partial(kinematic.end_faults, test=test), (test,), last=True) for test in KINEMATIC),
)


def faults(case: Case, analysis: str = FILMS) -> list[Fault]:
    """Every reason why an analysis of a case is refused."""
    if alone := without_bearing(case):  # no other rule has a subject
        return alone
    reasons: list[Fault] = []
    whole = case
    if analysis in KINEMATIC:
        reasons += choice_faults(case, analysis)
        case = tested_case(case)
    for rule in sorted((*RULES, *form_of(case).rules, *coupling_of(case).rules), key=lambda rule: rule.last):
        asked = RUN if analysis == STILL and not rule.moving else analysis
        if asked in rule.analyses and not (rule.last and reasons):
            reasons += (replace(fault, key=key_in(whole, fault.key)) for fault in rule.of(case))
    return list(dict.fromkeys(reasons))  # both ends of a cartridge have the same


def require(case: Case, analysis: str = FILMS, more: Faults = ()) -> None:
    """Raises InputError with every reason why an analysis of a case is refused; more: found by its caller."""
    if reasons := [*more, *faults(case, analysis)]:
        raise case.refused(*reasons)
