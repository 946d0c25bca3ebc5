"""The contract of a film in kinematic tests, however it is computed: where it rests, one moment, a course."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.forms.short import short_course, short_force, short_moment
from frbcli.bearing_tests.history import Course, film_course
from frbcli.bearing_tests.resting import ForceOf, resting_displacement
from frbcli.bearing_tests.steady_film import FilmMoment, film_force, film_moment
from frbcli.case.schema import Case
from frbcli.film.cells.motion import Motion, Path
from frbcli.film.rectangles.film import FilmForce
from frbcli.scene.forms.form import FilmForm
from frbcli.scene.forms.tables import SHORT
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan

Report = Callable[[int], None]


@dataclass(frozen=True)
class TestedFilm:
    """The film of a planned test of a case, as functions that raise NotConverged.

    rest(case, plan, load, omega): (2,) displacement over the clearance in which it carries a load in N along -y at
    omega rad/s. moment(case, plan, motion): the film for a motion that lasts. course(case, plan, path, times, report):
    the film along a path at the times (n,) in s, see film_course; report: called with the number of each moment.
    """

    __test__ = False  # no test case, whatever its name begins with

    rest: Callable[[Case, KinematicPlan, float, float], Array]
    moment: Callable[[Case, KinematicPlan, Motion], FilmMoment]
    course: Callable[[Case, KinematicPlan, Path, Array, Report | None], Course]


def _rest(force: ForceOf, case: Case, plan: KinematicPlan, load: float, omega: float) -> Array:
    return resting_displacement(case, plan, load, omega, force)


def _rubbing(force: ForceOf) -> ForceOf:
    """The force of a film including its summits."""

    def whole(
        case: Case, plan: KinematicPlan, cells: tuple[int, int], motion: Motion, near: FilmForce | None
    ) -> FilmForce:
        film, c = force(case, plan, cells, motion, near), plan.section.clearance
        return rubbing_of(case).with_summits(film, c * np.array(motion.d), c * np.array(motion.v), motion.omega)

    return whole


def _on_summits(case: Case, motion: Motion, film: FilmMoment) -> FilmMoment:
    """A film including its summits."""
    rubbing = rubbing_of(case)
    whole = rubbing.loads(film.loads, motion)
    return replace(film, loads=whole, force_error=film.force_error * rubbing.share_of_error(film.loads, whole))


SOLVED = TestedFilm(  # on finite volumes, or the modal film of a rectangular gap
    partial(_rest, _rubbing(film_force)),
    lambda case, plan, motion: _on_summits(case, motion, film_moment(case, plan, motion, plan.cells)),
    film_course,
)
FILMS: dict[FilmForm, TestedFilm] = {
    SHORT: TestedFilm(
        partial(_rest, _rubbing(short_force)),
        lambda case, plan, motion: _on_summits(case, motion, short_moment(plan, motion)),
        lambda case, plan, path, times, _: short_course(plan, rubbing_of(case), path, times),
    ),
}


def tested_film(plan: KinematicPlan) -> TestedFilm:
    """The film of a planned test: here, and nowhere else, a form becomes a film."""
    return FILMS.get(plan.form, SOLVED)
