"""Expected cost of a run, from its plan: time steps, film solves, CPU time, memory.

    CPU time of the loop = steps x (stages x iterations x films x time of a film solve + a large rotor's own share)

The number of steps follows from the revolutions of the run, or from the tolerance where that needs more. Iterations and
times of a film solve, the share of a small rotor included, were measured on the shipped cases on one machine and are
kept in one table here; docs/accuracy.md compares predicted and real cost. The cost before and after the loop is in
preparation.py. No measurement is made before a run: on a busy machine its error is larger than the difference between
machines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.case.rotor import JeffcottRotor, TurbochargerRotor
from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import CHAIN_MODES, Mesh
from frbcli.rotor.speed_profile import Array, SpeedProfile
from frbcli.scene.bearing_models import GIVEN
from frbcli.scene.cell_choice import USUAL, cells_time
from frbcli.scene.coupling import APART, SEMI
from frbcli.scene.film_choice import CELLS, CHAINS, CLIPPED, CLOSED_FORM, FIELDS, TABLE
from frbcli.scene.films import film_places, turning_rings
from frbcli.scene.planned import Plan
from frbcli.scene.preparation import after_s, before_s, memory_B, rotor_size, shaft_mass
from frbcli.scene.published import PUBLISHED
from frbcli.scene.tabulated import SOLUTIONS

STAGES = {"trbdf2": 2, "esdirk3": 3, "esdirk4": 5}  # implicit ones of a step
ERROR_ORDERS = {"trbdf2": 3, "esdirk3": 3, "esdirk4": 4}  # powers of the step size in the local error
# By form of the film. SOLVE_us: time of a solve; ITERATIONS: solves of a stage; CROWDED: steps over the least number
# of steps, which whirl increases.
SOLVE_us = {CLOSED_FORM: 0.3, CLIPPED: 14.0, TABLE: 0.3, FIELDS: 14.0, CHAINS: 20.0, CELLS: 20.0, SOLUTIONS: 0.5,
            PUBLISHED: 1300.0, GIVEN: 1.0}  # fmt: skip
ITERATIONS = {CLOSED_FORM: 1.6, CLIPPED: 2.4, TABLE: 1.6, FIELDS: 2.4, CHAINS: 2.2, CELLS: 1.8, SOLUTIONS: 1.3,
              PUBLISHED: 4.0, GIVEN: 1.6}  # fmt: skip
RING_ITERATIONS = 1.5  # of a finite-volume film at a ring
CROWDED = {CLOSED_FORM: 1.05, CLIPPED: 1.1, TABLE: 1.05, FIELDS: 1.1, CHAINS: 1.15, CELLS: 1.4, SOLUTIONS: 1.05,
           PUBLISHED: 1.5, GIVEN: 1.05}  # fmt: skip
# Steps of a run with an elastic shell over those without one: 1.3 to 3.4 where a whirl presses the journal into the
# shell, 1 where there is no contact.
ELASTIC = 1.7
FIELD_ELEMENTS = 64  # around
CHAIN_ELEMENTS, CHAIN_SHARE = 144, 0.55  # 3 x 48; share of a solve that grows with the elements
CELLS_FIXED = 0.1  # share of a solve on USUAL cells that does not depend on the cells
PUBLISHED_COUNT, PUBLISHED_POWER = 288, 1.4
LONGEST_STEP_s = 1e-3  # of a run: also at low speed the rotor falls and its shaft vibrates
MOST_SAMPLES = 1000  # that a step may pass: what a run holds in memory before it writes them
# Of a rotor with n degrees of freedom and m coordinates of its journals beyond those of the shipped ones: ns per n^3 of
# a step, which needs a new inverse now and then, per n^2 of a stage, and per m^3 of an iteration.
SMALL_ROTOR, INVERSE_ns, PRODUCTS_ns, JOURNALS_ns = 30, 3.6, 3.0, 0.4
SMOOTH = 7.0  # radians of a motion as large as the clearance that a step with a tolerance of 1 may pass
MICRO_STEPS = 2.0  # of a film in a macro step of a co-simulation
TABLE_POINTS = 400  # of the speed profile


@dataclass(frozen=True)
class ExpectedCost:
    """steps, film_solves: of the whole run; cpu_s: of its time loop; before_s: of tables, reduction of the shaft and
    the first state; after_s: of the stated error; memory_B: bytes of the process. CPU times
    are those of the reference machine."""

    steps: int
    film_solves: int
    cpu_s: float
    before_s: float
    after_s: float
    memory_B: float

    @property
    def total_s(self) -> float:
        """CPU time of the whole run."""
        return self.before_s + self.cpu_s + self.after_s

    @property
    def step_s(self) -> float:
        """CPU time of one step."""
        return self.cpu_s / max(self.steps, 1)


def expected_cost(case: Case, plan: Plan, profile: SpeedProfile) -> ExpectedCost:
    """Expected cost of a run along a speed profile."""
    steps = float(expected_course(case, plan, profile)[1][-1])
    films = len(film_places(case))
    iterations = RING_ITERATIONS if turning_rings(case) else ITERATIONS[plan.form]
    if plan.coupling == SEMI:
        iterations = 1.0
    solves = steps * STAGES[plan.method] * iterations * films
    if plan.coupling == APART:
        solves *= MICRO_STEPS
    loop_s = 1e-6 * solves * solve_us(plan) + 1e-9 * steps * _rotor_ns(case, plan, iterations)
    samples = profile.end / case.output.step
    before, after = before_s(case, plan), after_s(case, plan, loop_s, samples)
    return ExpectedCost(round(steps), round(solves), loop_s, before, after, memory_B(case, plan, samples))


def _rotor_ns(case: Case, plan: Plan, iterations: float) -> float:
    """Time of a step in the rotor, ns; 0 for a small rotor, whose time is part of that of a film solve."""
    n, m, stages = max(rotor_size(case), SMALL_ROTOR), 2 * len(film_places(case)), STAGES[plan.method]
    inverse, products = n**3 - SMALL_ROTOR**3, n**2 - SMALL_ROTOR**2
    journals = max(0, m**3 - SMALL_ROTOR**3)
    return INVERSE_ns * inverse + stages * (PRODUCTS_ns * products + iterations * JOURNALS_ns * journals)


def longest_step(case: Case, plan: Plan) -> float:
    """Longest step of a run, s; limited also by the samples that are held in memory until they are written."""
    longest = LONGEST_STEP_s if plan.macro_step is None else min(LONGEST_STEP_s, plan.macro_step)
    return min(longest, MOST_SAMPLES * case.output.step)


def solve_us(plan: Plan) -> float:
    """Time of one film solve on the reference machine, us."""
    us = SOLVE_us[plan.form]
    if plan.form == FIELDS:  # beside films that are cheap
        us = float(np.mean([_fields_us(mesh) if form == FIELDS else SOLVE_us[form] for form, mesh in plan.films]))
    if plan.form == CHAINS:
        elements = min(plan.mesh.axial, CHAIN_MODES) * plan.mesh.circumferential
        us *= 1.0 - CHAIN_SHARE + CHAIN_SHARE * elements / CHAIN_ELEMENTS
    if plan.form == PUBLISHED and plan.cells is not None:
        us *= (plan.cells[0] * plan.cells[1] / PUBLISHED_COUNT) ** PUBLISHED_POWER
    elif plan.cells is not None:
        around, along = plan.cells
        size = cells_time(around, along) / cells_time(*USUAL)
        us *= law_named(plan.cavitation).cost * (CELLS_FIXED + (1.0 - CELLS_FIXED) * size)
    return us


def _fields_us(mesh: Mesh) -> float:
    return SOLVE_us[FIELDS] * mesh.circumferential / FIELD_ELEMENTS


def expected_course(case: Case, plan: Plan, profile: SpeedProfile) -> tuple[Array, Array]:
    """Times (k,) in s of a run and the number of steps (k,) until then: a number per revolution, per second at low
    speed, or that which the tolerance needs."""
    longest = longest_step(case, plan)
    times = np.linspace(profile.times[0], profile.end, TABLE_POINTS)
    turns = np.abs(profile.speed(times)) / (2.0 * np.pi)
    rate = np.maximum(1.0 / longest, CROWDED[plan.form] * plan.steps_per_revolution * turns)
    rate = np.maximum(rate, _resolving(case, plan, 2.0 * np.pi * turns))
    if case.contact.policy == "elastic":
        rate *= ELASTIC
    passed = np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times))
    return times, np.concatenate([[0.0], passed])


def _resolving(case: Case, plan: Plan, omega: Array) -> Array:
    """(n,) steps per second that the tolerance needs at the rotor speeds omega (n,) in rad/s, for the amplitude of the
    rotor over the clearance.

    The local error of a motion A cos(w t) is A (w h / SMOOTH)^p of a method with an embedded solution of order p - 1.
    """
    rotor, order = case.rotor, ERROR_ORDERS[plan.method]
    allowed = plan.tolerance * film_places(case)[0].geometry.clearance
    if isinstance(rotor, TurbochargerRotor):
        eccentric = sum(disk.unbalance for disk in case.disks) / shaft_mass(case)
    else:
        eccentric = rotor.unbalance / rotor.mass

    def steps(w: Array | float, size: float) -> Array:
        return np.asarray(w / SMOOTH * (size / allowed) ** (1.0 / order), dtype=np.float64)

    rate = steps(omega, eccentric)
    if isinstance(rotor, JeffcottRotor):  # it starts in the centre and oscillates about its resting position
        square = rotor.shaft_stiffness / rotor.mass
        rate = np.maximum(rate, steps(float(np.sqrt(square)), rotor.gravity / square))
    return rate
