"""The gate: one table of rules, each with the analyses that it holds for. Every analysis asks it before a film is made.

A rule is a function of a case that yields the faults: key, value, problem, remedy. `docs/matrix.md` is made by asking
this gate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.scene.channels import channel_faults
from frbcli.scene.clearance_steps import clearance_faults
from frbcli.scene.forms.published import published_faults
from frbcli.scene.gate import cycles, films, kinematic, runs, static
from frbcli.scene.gate.analysis import (
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
    WHIRLS,
)
from frbcli.scene.machine.elements import element_faults, speed_dependent, without_bearing, without_film

Faults = Iterable[Fault]


@dataclass(frozen=True)
class Rule:
    """A rule. of: the faults of a case; analyses: that it holds for; last: whether it is asked only of a case that has
    passed all rules before, since it needs their subjects to be whole."""

    of: Callable[[Case], Faults]
    analyses: tuple[str, ...]
    last: bool = False


def _of_films(of: Callable[[Case], Faults]) -> Callable[[Case], Faults]:
    """A rule of films alone, which a machine without any does not break."""
    return lambda case: of(case) if case.bearings else ()


def _without_film(what: str) -> Callable[[Case], Faults]:
    return lambda case: without_film(case, what)


def _run_omega(case: Case) -> float:
    return 2.0 * math.pi * max(abs(case.speed.start), abs(case.speed.end))


def motion_omega(case: Case) -> float:
    """Speed in rad/s that a kinematic test refers to: of the journal, else of its motion."""
    motion = case.motion
    return 2.0 * math.pi * abs((motion and (motion.speed or motion.frequency or motion.whirl_speed)) or 1.0)


CONSTANT = "limit cycles follow it with a rotor of constant coefficients"

RULES = (
    Rule(element_faults, ALL),
    Rule(films.heat_faults, ALL),
    Rule(channel_faults, ALL),
    Rule(films.supply_faults, ALL),
    *(Rule(partial(kinematic.motion_faults, test=test), (test,)) for test in KINEMATIC),
    Rule(_without_film("a kinematic test is of one"), KINEMATIC),
    Rule(_without_film("the sheet is of films"), SHEETS),
    Rule(_without_film("the comparison is of models of films"), (COMPARISON,)),
    Rule(_without_film("the ladder is of films"), (LADDER,)),
    Rule(_without_film("a linear machine has no limit cycle"), EVERY_CYCLE),
    *(Rule(partial(kinematic.bearing_faults, test=test), (test,)) for test in KINEMATIC),
    Rule(kinematic.theory_faults, KINEMATIC),
    Rule(_of_films(films.model_faults), (RUN, *KINEMATIC)),
    Rule(_of_films(runs.theory_faults), (RUN,)),
    Rule(_of_films(clearance_faults), (RUN,)),
    Rule(_of_films(runs.form_faults), (RUN,)),
    Rule(_of_films(published_faults), (RUN,)),
    Rule(_of_films(runs.signal_faults), (RUN,)),
    Rule(runs.ladder_faults, (LADDER,)),
    Rule(static.sheet_faults, SHEETS),
    Rule(static.loaded_heat_faults, (LOADED,)),
    Rule(static.chart_heat_faults, (CHART,)),
    Rule(static.missing_heat_faults, (HEAT,)),
    Rule(static.still_ring_faults, (BEARING, LOADED, STABILITY, *EVERY_CYCLE)),
    Rule(static.coefficient_faults, (STABILITY,)),
    Rule(static.range_faults, (RANGE,)),
    Rule(lambda case: speed_dependent(case, CONSTANT), EVERY_CYCLE),
    Rule(cycles.cycle_heat_faults, EVERY_CYCLE),
    Rule(cycles.smooth_faults, (CYCLES,)),
    Rule(cycles.speed_cycle_faults, (SPEED_CYCLES, WHIRLS)),
    Rule(cycles.unbalance_faults, (WHIRLS,)),
    Rule(cycles.speed_range_faults, EVERY_CYCLE, last=True),
    Rule(runs.number_faults, (RUN,), last=True),
    Rule(lambda case: films.force_faults(case, _run_omega(case)), (RUN,), last=True),
    Rule(lambda case: films.force_faults(case, motion_omega(case)), KINEMATIC, last=True),
)


def faults(case: Case, analysis: str = FILMS) -> list[Fault]:
    """Every reason why an analysis of a case is refused. Raises InputError if this process does not have the bearing
    model of the case."""
    if alone := without_bearing(case):  # no other rule has a subject
        return alone
    found: list[Fault] = []
    for rule in RULES:
        if analysis in rule.analyses and not (rule.last and found):
            found += rule.of(case)
    return found


def require(case: Case, analysis: str = FILMS, more: Faults = ()) -> None:
    """Raises InputError with every reason why an analysis of a case is refused; more: found by its caller."""
    if found := [*more, *faults(case, analysis)]:
        raise InputError(case.name or "case", tuple(found))
