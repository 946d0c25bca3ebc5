"""Whether a run is tried before it begins: what its cells and steps make of the error on this machine.

On the same cells the error differs by a factor of 10 to 20 between machines with rings (docs/accuracy.md). Two short
runs from the beginning, on the cells of the plan and on more of them, show it. """

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.case.schema import Case
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.costs.cost import expected_cost
from frbcli.scene.films import rings
from frbcli.scene.planning.coarser_plan import cost_of_run
from frbcli.scene.planning.planned import Plan

REVOLUTIONS = 10.0  # of the rotor that are tried: a journal falls, and rings take up their speed
MOMENTS = 2000  # at which they are counted
# Of the finer run, over the plan's: cells around, cells along, tolerance of a step.
AROUND, ALONG, TOLERANCE = 1.5, 1.3, 0.125
STEP_AROUND = 8
# Openings often come in threes and sixes. Where all of them have the same place between the cells, their errors do not
# cancel: on 120 x 10 cells floating-ring has twice the error of 128 x 10.
ALIKE = 3
SHARE, LONGEST_s = 0.05, 1.0  # of the CPU time of the run, and at most, that both short runs may take
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
    if not plan.form.chosen_by_target or plan.cells is None:
        return None
    end = end_of_trial(profile)
    trial = Trial(plan, _finer(plan), profile.with_stops([end]).until(end))
    costs = [expected_cost(case, each, trial.profile) for each in (trial.plan, trial.finer)]
    share = BEGINNING if rings(case) else 1.0
    spent_s = sum(cost.before_s + share * cost.cpu_s for cost in costs)
    return trial if spent_s <= min(SHARE * cost_of_run(case, plan, profile).total_s, LONGEST_s) else None


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
