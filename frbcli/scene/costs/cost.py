"""Expected cost of a run, from its plan: time steps, film solves, CPU time, memory.

    CPU time of the loop = film solves x time of a film solve + steps x a large rotor's own share

The numbers of steps and film solves are in course.py. Times of a film solve, the share of a small rotor included, were
measured on the shipped cases on one machine and are in forms/; docs/accuracy.md compares predicted and real cost. The
cost before and after the loop is in preparation.py. No measurement is made before a run: on a busy machine its error is
larger than the difference between machines. """

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.case.schema import Case
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.costs.course import STAGES, RunCourse, expected_course, runs_nearly_dry, whirl_speed
from frbcli.scene.costs.preparation import after_s, before_s, memory_B, rotor_size
from frbcli.scene.films import film_places
from frbcli.scene.machine.elements import changes_with_speed
from frbcli.scene.planning.planned import Plan
from frbcli.scene.shafts.table import shaft_of

DAY_s = 86_400.0
GROWING = 0.2  # share of a run with films that run nearly dry until their whirl has grown: 0.05 to 0.3 as measured
# Of a rotor with n degrees of freedom and m coordinates of its journals in excess of the shipped ones: ns per n^3 of a
# step, which needs a new inverse now and then, per n^2 of a stage, and per m^3 of an iteration.
SMALL_ROTOR, INVERSE_ns, PRODUCTS_ns, JOURNALS_ns = 30, 3.6, 3.0, 0.4


@dataclass(frozen=True)
class ExpectedCost:
    """steps, film_solves: of the whole run; cpu_s: of its time loop; before_s: of tables, reduction of the shaft and
    the first state; after_s: of the stated error; memory_B: bytes of the process; second_s: of a second run that is
    made unasked or asked for, see coarser_plan.py. CPU times are for the reference machine."""

    steps: int
    film_solves: int
    cpu_s: float
    before_s: float
    after_s: float
    memory_B: float
    second_s: float = 0.0

    @property
    def run_s(self) -> float:
        """CPU time of the run itself."""
        return self.before_s + self.cpu_s + self.after_s

    @property
    def total_s(self) -> float:
        """CPU time of the whole run."""
        return self.run_s + self.second_s

    @property
    def step_s(self) -> float:
        """CPU time of one step."""
        return self.cpu_s / max(self.steps, 1)


def expected_cost(case: Case, plan: Plan, profile: SpeedProfile) -> ExpectedCost:
    """Expected cost of a run along a speed profile, without a second one."""
    course = expected_course(case, plan, profile)
    steps, solves = float(course.steps[-1]), float(course.solves[-1])
    films = len(film_places(case))
    iterations = solves / max(steps * STAGES[plan.method] * films, 1e-300) if films else 0.0
    asked = solves if films else steps * STAGES[plan.method]  # without films, the rest of the cost of a stage
    loop_s = 1e-6 * asked * plan.form.solve_us(case, plan) + 1e-9 * steps * _rotor_ns(case, plan, iterations)
    samples = profile.end / case.output.step
    before, after = before_s(case, plan), after_s(case, plan, loop_s * _quiet_share(case, profile, course), samples)
    return ExpectedCost(round(steps), round(solves), loop_s, before, after, memory_B(case, plan, samples))


def _quiet_share(case: Case, profile: SpeedProfile, course: RunCourse) -> float:
    """Share of the loop before a whirl, for which a run is repeated on fewer cells."""
    if runs_nearly_dry(case):
        return GROWING
    whirls = np.abs(profile.speed(course.times)) >= max(whirl_speed(case), 1e-300)
    return course.share(float(course.times[np.argmax(whirls)])) if whirls.any() else 1.0


def _rotor_ns(case: Case, plan: Plan, iterations: float) -> float:
    """Time of a step in the rotor, ns; 0 for a small rotor, whose time is part of a film solve's, unless an inverse is
    renewed in every stage."""
    n, m, stages = max(rotor_size(case), SMALL_ROTOR), 2 * len(film_places(case)), STAGES[plan.method]
    shaft = shaft_of(case)
    follows = changes_with_speed(case) or shaft.internally_damped or (not case.films and shaft.gyroscopic)
    renewed = stages * INVERSE_ns * rotor_size(case) ** 3 if follows else 0.0  # an inverse for each speed
    inverse, products = n**3 - SMALL_ROTOR**3, n**2 - SMALL_ROTOR**2
    journals = max(0, m**3 - SMALL_ROTOR**3)
    return renewed + INVERSE_ns * inverse + stages * (PRODUCTS_ns * products + iterations * JOURNALS_ns * journals)


def clock(seconds: float) -> str:
    """A duration in words, to two digits."""
    for unit, size in (("days", DAY_s), ("h", 3_600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{float(f'{seconds / size:.2g}'):g} {unit}"
    return f"{float(f'{seconds:.2g}'):g} s"
