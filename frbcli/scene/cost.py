"""What a run will cost, told from its plan before it starts: time steps, film solves, CPU time.

    CPU time = steps x stages x iterations x films x time of a film solve

Steps follow from the revolutions of the run. Iterations and times of a film solve, the rotor's share included, were
measured on the shipped cases on one machine and stand in one table here; docs/accuracy.md says which, and holds
predicted beside real cost. No machine is timed before a run: on a busy one such a probe is wrong by more than the
machines of today differ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.film.rectangles.table import Mesh
from frbcli.rotor.excitation import SpeedProfile
from frbcli.scene.coupling import APART, SEMI
from frbcli.scene.film_choice import CELLS, CHAINS, CLIPPED, CLOSED_FORM, FIELDS, TABLE
from frbcli.scene.films import film_places, turning_rings
from frbcli.scene.plan import Plan
from frbcli.scene.published import PUBLISHED
from frbcli.scene.tabulated import SOLUTIONS

STAGES = {"trbdf2": 2, "esdirk3": 3, "esdirk4": 5}  # implicit ones of a step
# By form of the film. SOLVE_us: of a solve; ITERATIONS: solves of a stage; CROWDED: steps over the fewest allowed, as a
# film whose whirl is hard takes more.
SOLVE_us = {CLOSED_FORM: 0.5, CLIPPED: 14.0, TABLE: 0.5, FIELDS: 14.0, CHAINS: 20.0, CELLS: 36.0, SOLUTIONS: 0.8,
            PUBLISHED: 1300.0}  # fmt: skip
ITERATIONS = {CLOSED_FORM: 1.6, CLIPPED: 2.4, TABLE: 1.6, FIELDS: 2.4, CHAINS: 2.2, CELLS: 2.6, SOLUTIONS: 1.3,
              PUBLISHED: 4.0}  # fmt: skip
RING_ITERATIONS = 3.6  # of a film with cells between a ring and something else
CROWDED = {CLOSED_FORM: 1.05, CLIPPED: 1.1, TABLE: 1.05, FIELDS: 1.1, CHAINS: 1.15, CELLS: 2.0, SOLUTIONS: 1.05,
           PUBLISHED: 1.5}  # fmt: skip
# Steps of a run whose journal may go on in an elastic shell: some whirl there for long, and pass element after element
# of a gap that is all but closed (1.3 to 3.4 times the steps), some never get there.
ELASTIC = 1.7
FIELD_ELEMENTS = 64  # around
CHAIN_ELEMENTS, CHAIN_SHARE = 144, 0.55  # 3 x 48; share of a solve that grows with the elements
CELL_COUNT, CELL_POWER = 288, 1.4  # 48 x 6
LONGEST_STEP_s = 1e-3  # of a run: a slow rotor still falls, and its shaft still vibrates
MOST_SAMPLES = 1000  # that a step may pass: what a run holds in memory before it writes them
MICRO_STEPS = 2.0  # of a film in a macro step of a co-simulation
TABLE_POINTS = 400  # of the speed profile


@dataclass(frozen=True)
class ExpectedCost:
    """steps, film_solves: of the whole run; cpu_s: of its time loop, on the reference machine."""

    steps: int
    film_solves: int
    cpu_s: float


def expected_cost(case: Case, plan: Plan, profile: SpeedProfile) -> ExpectedCost:
    """What a run along a speed profile will cost."""
    steps = _steps(case, plan, profile)
    if case.contact.policy == "elastic":
        steps *= ELASTIC
    films = len(film_places(case))
    iterations = RING_ITERATIONS if turning_rings(case) else ITERATIONS[plan.form]
    if plan.coupling == SEMI:
        iterations = 1.0
    solves = steps * STAGES[plan.method] * iterations * films
    if plan.coupling == APART:
        solves *= MICRO_STEPS
    return ExpectedCost(round(steps), round(solves), 1e-6 * solves * solve_us(plan))


def longest_step(case: Case, plan: Plan) -> float:
    """Of a run, s: also no more than some samples, which are held in memory until they are written."""
    longest = LONGEST_STEP_s if plan.macro_step is None else min(LONGEST_STEP_s, plan.macro_step)
    return min(longest, MOST_SAMPLES * case.output.step)


def solve_us(plan: Plan) -> float:
    """Time of one film solve on the reference machine, us."""
    us = SOLVE_us[plan.form]
    if plan.form == FIELDS:  # beside films that are cheap
        us = float(np.mean([_fields_us(mesh) if form == FIELDS else SOLVE_us[form] for form, mesh in plan.films]))
    if plan.form == CHAINS:
        elements = plan.mesh.axial * plan.mesh.circumferential
        us *= 1.0 - CHAIN_SHARE + CHAIN_SHARE * elements / CHAIN_ELEMENTS
    if plan.cells is not None:
        count = plan.cells[0] * plan.cells[1]
        us *= law_named(plan.cavitation).cost * (count / CELL_COUNT) ** CELL_POWER
    return us


def _fields_us(mesh: Mesh) -> float:
    return SOLVE_us[FIELDS] * mesh.circumferential / FIELD_ELEMENTS


def _steps(case: Case, plan: Plan, profile: SpeedProfile) -> float:
    """Steps of a run: some per revolution, and some per second where the rotor is slow."""
    longest = longest_step(case, plan)
    times = np.linspace(profile.times[0], profile.end, TABLE_POINTS)
    turns = np.abs(profile.speed(times)) / (2.0 * np.pi)
    rate = np.maximum(1.0 / longest, CROWDED[plan.form] * plan.steps_per_revolution * turns)
    return float(np.trapezoid(rate, times))
