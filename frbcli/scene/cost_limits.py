"""Runs that are too expensive are refused before anything is computed, with the responsible key and the cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from frbcli.case.model import altered
from frbcli.case.run import MACRO_STEP, STEPS_PER_REVOLUTION
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.changes import step_times
from frbcli.scene.cost import DAY_s, ExpectedCost, before_s, clock, rotor_size
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import make_plan

LONGEST_RUN_s = 30.0 * DAY_s  # CPU time
LONGEST_PREPARATION_s = 3_600.0
LONGEST_WAIT_s = 2.0  # of one step, during which there is no progress and Ctrl-C has no effect
MOST_MEMORY_B = 1e9
SMALLEST_TOLERANCE = 1e-13  # round-off of displacements


def require_affordable(case: Case, plan: Plan, cost: ExpectedCost) -> None:
    """Raises InputError naming what makes a run of this cost too long or too large."""
    faults = tuple(cost_faults(case, plan, cost))
    if faults:
        raise case.refused(*faults)


def cost_faults(case: Case, plan: Plan, cost: ExpectedCost) -> Iterator[Fault]:
    """The limit that the plan exceeds: at most one fault, since all have the same remedy."""
    if plan.tolerance < SMALLEST_TOLERANCE:
        key = "accuracy.target" if case.accuracy.tolerance is None else "accuracy.tolerance"
        value = case.accuracy.target if case.accuracy.tolerance is None else case.accuracy.tolerance
        problem = f"asks for a tolerance of {plan.tolerance:.1g} of the clearance, which is below round-off."
        yield Fault(key, f"{value:g}", None, problem, "Take a larger one, e.g. a target of 1e-3.")
        return
    for words, amount, most, written in (
        ("needs {} of memory", cost.memory_B, MOST_MEMORY_B, memory),
        ("takes {} before the first step", cost.before_s, LONGEST_PREPARATION_s, clock),
        ("takes {} for one time step", cost.step_s, LONGEST_WAIT_s, clock),
        ("takes {} of CPU time", cost.total_s, LONGEST_RUN_s, clock),
    ):
        if not amount <= most:
            limited = (*_by_accuracy(case, plan), *_by_machine(case), *_by_speed(case))
            asked = max(limited, key=lambda each: each.times)
            problem = f"{words.format(written(amount))}; {written(most)} is the limit."
            yield Fault(asked.key, asked.value, None, problem, asked.remedy)
            return


def memory(number: float) -> str:
    """An amount of memory in words, to two digits."""
    return f"{number / 1e9:.2g} GB" if number >= 1e9 else f"{round(number / 1e7) * 10} MB"


@dataclass(frozen=True)
class _Limited:
    """The demand of a key. times: over the demand of usual cases."""

    times: float
    key: str
    value: str
    remedy: str


def _by_accuracy(case: Case, plan: Plan) -> Iterator[_Limited]:
    given = case.accuracy
    coarser = altered(case, {"accuracy": altered(given, {"mesh": None})})
    usual = make_plan(coarser)
    solves = plan.form.solve_us(case, plan) / usual.form.solve_us(coarser, usual)
    tables = (1.0 + before_s(case, plan)) / (1.0 + before_s(coarser, usual))
    yield _Limited(max(solves, tables), "accuracy.mesh", f"{list(given.mesh or ())}", "Take fewer elements.")
    steps = given.steps_per_revolution
    yield _Limited(steps / STEPS_PER_REVOLUTION, "accuracy.steps_per_revolution", f"{steps}", "Take fewer.")
    if given.tolerance is None:
        yield _Limited(1e-4 / given.target, "accuracy.target", f"{given.target:g}", "Take a larger one.")
    else:
        yield _Limited(1e-7 / given.tolerance, "accuracy.tolerance", f"{given.tolerance:g}", "Take a larger one.")
    if plan.macro_step is not None:
        yield _Limited(MACRO_STEP / plan.macro_step, "accuracy.macro_step", f"{plan.macro_step:g} s", "Lengthen it.")
    yield _Limited(1e-7 / case.output.step, "output.step", f"{case.output.step:g} s", "Lengthen it.")


def _by_machine(case: Case) -> Iterator[_Limited]:
    freedoms, steps = rotor_size(case), len(step_times(case))
    yield _Limited(freedoms / 30.0, "rotor", f"{freedoms} degrees of freedom", "Keep fewer modes, or a lower cut-off.")
    yield _Limited(len(case.shaft) / 1e3, "shaft", f"{len(case.shaft)} sections", "Join neighbours that are alike.")
    yield _Limited(len(case.disks) / 100.0, "disk", f"{len(case.disks)} disks", "Join neighbours.")
    yield _Limited(len(case.placed_bearings) / 4.0, "bearing", f"{len(case.placed_bearings)} bearings", "Take fewer.")
    yield _Limited(steps / 10.0, "bearing.clearance_steps", f"{steps} steps", "Take fewer: each has its own films.")


def _by_speed(case: Case) -> Iterator[_Limited]:
    speed = case.speed
    yield _Limited(speed.duration / 100.0, "speed.duration", f"{speed.duration:g} s", "Shorten the run.")
    yield _Limited(speed.top / 1e4, "speed.to", f"{speed.top:g} Hz", "Lower the speed, or shorten the run.")
