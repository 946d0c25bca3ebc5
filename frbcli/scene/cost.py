"""Expected cost of a run, from its plan: time steps, film solves, CPU time, memory.

    CPU time of the loop = film solves x time of a film solve + steps x a large rotor's own share

The numbers of steps and film solves are in course.py. Times of a film solve, the share of a small rotor included, were
measured on the shipped cases on one machine and are in forms/; docs/accuracy.md compares predicted and real cost. No
measurement is made before a run: on a busy machine its error is larger than the difference between machines.

Before the loop films are tabulated, the shaft is reduced to its modes, and critical speeds and the first state are
computed; after it the error of the forces is computed on a finer mesh, and runs with finite-volume films are repeated
on fewer cells. All numbers are CPU seconds of the reference machine.

"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from frbcli.case.schema import Case
from frbcli.elements.ball import BallBearingElement
from frbcli.film.cavitation.table import law_named
from frbcli.rotor.loads import SpeedProfile
from frbcli.rotor.reduction import DENSE, MOST
from frbcli.scene.changes import step_times
from frbcli.scene.course import STAGES, RunCourse, expected_course, runs_nearly_dry, whirl_speed
from frbcli.scene.films import film_places, full_films, rings, turning_rings
from frbcli.scene.forms import TABLE, FilmForm
from frbcli.scene.machine.rotor import changes_with_speed, element_parts
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.film_choice import Plan, form_of

Kernels = Literal["loop", "rest", "both"]

DENSE_s, SPARSE_s = 0.5, 6e-4  # of the modes of a shaft: at DENSE degrees of freedom, and for each of more
CRITICAL_s = 0.5  # of the critical speeds of a machine on cells
PROGRAM_B = 2.3e8  # bytes of the program, its libraries and its compiled kernels
MATRICES = 6  # of a rotor, of the modes of a shaft
SAMPLE_s = 3.3e-7  # to write an output time and to look at it again
SAMPLES_HELD, COPIES = 16384, 3  # output times between two writes, and in how many forms
# How often all samples are in memory: in the run, and in the file that it is about to write; or in the run and in a
# second one, of which one signal at a time is joined.
KEPT, KEPT_OF_BOTH = 2.1, 2.2
RINGS, HEAT_s = 1.5, 12.0  # by what and by how much compiling takes longer where rings turn, and with heat
BALL_us = 0.7  # of a ball in a stage, with what an iteration more costs the films
AT_REST = 0.4  # of the kernels of a form, without rings and heat: what films at rest need
HEAT_SIGNALS, WALL_SIGNALS = 5, 2  # of a film; of shaft and housing, or of a ring


def compile_s(cases: Iterable[Case], kernels: Kernels = "loop") -> float:
    """CPU time of the compilation at the first start, for each kind of films that the cases have: short bearings have
    their own time loop, different from tabulated films. kernels: of a time loop, of films at rest, or both, each
    with its own machine code of what both call."""
    cases, spent = list(cases), 0.0
    if kernels != "loop":
        spent += AT_REST * sum({form: form.compiling[0] for form in map(form_of, cases)}.values())
    if kernels != "rest":
        spent += sum(each for *_, each in {(*_kind(case), _compilation(case)[0]) for case in cases})
    return spent


def _kind(case: Case) -> tuple[FilmForm, bool]:
    """What decides the types of the films in a time loop."""
    form = form_of(case)
    return form, form is TABLE and case.film.theory == "short"


def compile_B(case: Case) -> float:
    """Memory in bytes of a process that compiles the kernels for a case, at the first start."""
    return _compilation(case)[1]


def _compilation(case: Case) -> tuple[float, float]:
    """CPU time in s and memory in bytes."""
    spent, memory = form_of(case).compiling
    return (RINGS if rings(case) else 1.0) * spent + (0.0 if case.heat is None else HEAT_s), memory


def before_s(case: Case, plan: Plan) -> float:
    """CPU time before the first step."""
    machines, films, form = 1 + len(step_times(case)), len(film_places(case)), plan.form
    resting = case.start.position == "resting" and case.start.displacement is None
    spent_s = machines * (films * form.table_s(plan) + _reduction_s(case))
    if not rings(case) and form_of(full_films(case)).by_cells:
        spent_s += machines * CRITICAL_s
    return spent_s + form.first_state_s(plan, films, resting)


def after_s(case: Case, plan: Plan, loop_s: float, samples: float) -> float:
    """CPU time after a time loop of loop_s: events and stated error. samples: number that the run writes."""
    again = plan.form.again_share() * loop_s
    evaluated = SAMPLE_s * samples + (1 + len(step_times(case))) * _reduction_s(case)
    return evaluated + again + film_error_s(case, plan)


def film_error_s(case: Case, plan: Plan) -> float:
    """CPU time of the error of the film forces at sampled states."""
    return plan.form.error_s(plan, len(film_places(case)), 1 + len(step_times(case)))


def memory_B(case: Case, plan: Plan, samples: float, second: Plan | None = None) -> float:
    """Largest memory of the process in bytes. samples: number that the run writes; second: plan of a second run."""
    n, films = rotor_size(case), len(film_places(case))
    kept = KEPT if second is None else KEPT_OF_BOTH
    needed = PROGRAM_B + 8.0 * MATRICES * n**2 + 8.0 * MATRICES * MOST * shaft_of(case).beam_freedoms
    needed += 8.0 * signal_count(case) * (COPIES * SAMPLES_HELD + kept * samples)
    return needed + sum(each.form.memory_B(each, films) for each in (plan, second) if each is not None)


def signal_count(case: Case) -> int:
    """Signals that a run records; with heat at most."""
    places, floating = film_places(case), rings(case)
    disks = shaft_of(case).disk_count
    count = 2 + 2 * (len(case.placed_bearings) + len(floating) + disks) + len(turning_rings(case))
    count += sum(1 + law_named(case.cavitation(place.geometry)).keeps_oil for place in places)
    count += len(places) * sum(2 if kind == "force" else 1 for kind in case.output.signals)
    count += 3 * len(places) if case.contact.rough else 0
    if case.heat is not None:
        count += HEAT_SIGNALS * len(places) + WALL_SIGNALS * (1 + len(floating))
    return count


def rotor_size(case: Case) -> int:
    """Degrees of freedom of the rotor with its rings and elements, as reduced."""
    elements = sum(body.size for body in element_parts(case).bodies)
    alone = sum(given.kind == "floating-ring" for given in case.given_bearings)
    tilts = 2 * alone if case.film.tilt == "follows" else 0
    return shaft_of(case).freedoms + 2 * len(rings(case)) + tilts + elements + len(turning_rings(case))


def _reduction_s(case: Case) -> float:
    freedoms = shaft_of(case).beam_freedoms
    return SPARSE_s * freedoms if freedoms > DENSE else DENSE_s * (freedoms / DENSE) ** 3


DAY_s = 86_400.0
GROWING = 0.2  # share of a run with films that run nearly dry until their whirl has grown: 0.05 to 0.3 as measured
# Of a rotor with n degrees of freedom and m coordinates of its journals in excess of the shipped ones: ns per n^3 of a
# step, which needs a new inverse now and then, per n^2 of a stage, and per m^3 of an iteration.
SMALL_ROTOR, INVERSE_ns, PRODUCTS_ns, JOURNALS_ns = 30, 3.6, 3.0, 0.4


@dataclass(frozen=True)
class ExpectedCost:
    """steps, film_solves: of the whole run; cpu_s: of its time loop; before_s: of tables, reduction of the shaft and
    the first state; after_s: of the stated error; memory_B: bytes of the process; second_s: of a second run that is
    made unasked or asked for, see planning/plan.py. CPU times are for the reference machine."""

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
    loop_s += 1e-6 * BALL_us * steps * STAGES[plan.method] * _balls(case)
    samples = profile.end / case.output.step
    before, after = before_s(case, plan), after_s(case, plan, loop_s * _quiet_share(case, profile, course), samples)
    return ExpectedCost(round(steps), round(solves), loop_s, before, after, memory_B(case, plan, samples))


def _balls(case: Case) -> int:
    """Balls, or places around of the mean over the cage, at which a stage asks for the force of ball bearings."""
    return sum(row.points for element in BallBearingElement.of(case) for _, row in element.rows)


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
