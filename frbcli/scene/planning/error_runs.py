"""Runs that show the error of another one: a second, coarser run, and two short ones before it begins.

The difference of a run to a coarser one shows how uncertain its results are.

On the same cells the error differs by a factor of 10 to 20 between machines with rings (docs/accuracy.md). Two short
runs from the beginning, on the cells of the plan and on more of them, show it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.case.schema import Case
from frbcli.film.grid import Mesh
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.cost import ExpectedCost, expected_cost, memory_B
from frbcli.scene.course import ERROR_ORDERS
from frbcli.scene.films import rings
from frbcli.scene.planning.planned import Plan

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
