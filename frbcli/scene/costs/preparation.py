"""Expected cost of a run outside its time loop, and its memory.

Before the loop films are tabulated, the shaft is reduced to its modes, and critical speeds and the first state are
computed; after it the error of the forces is computed on a finer mesh, and runs with finite-volume films are repeated
on fewer cells. All numbers are CPU seconds of the reference machine of cost.py.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.rotor.reduction import DENSE, MOST
from frbcli.scene.changes import step_times
from frbcli.scene.films import film_places, full_films, rings, turning_rings
from frbcli.scene.forms.form import FilmForm
from frbcli.scene.forms.tables import TABLE
from frbcli.scene.machine.elements import element_parts
from frbcli.scene.planning.film_choice import form_of
from frbcli.scene.planning.planned import Plan
from frbcli.scene.shafts.table import shaft_of

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
    alone = sum(isinstance(given, FloatingRingBearing) for given in case.given_bearings)
    tilts = 2 * alone if case.film.tilt == "follows" else 0
    return shaft_of(case).freedoms + 2 * len(rings(case)) + tilts + elements + len(turning_rings(case))


def _reduction_s(case: Case) -> float:
    freedoms = shaft_of(case).beam_freedoms
    return SPARSE_s * freedoms if freedoms > DENSE else DENSE_s * (freedoms / DENSE) ** 3
