"""The contract of a film in kinematic tests, however it is computed: where it rests, one moment, a course."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

from frbcli.bearing_tests.bearing_model import model_course, model_force, model_moment
from frbcli.bearing_tests.history import Course, film_course
from frbcli.bearing_tests.march import Path
from frbcli.bearing_tests.published import published_course, published_moment, resting_in_published
from frbcli.bearing_tests.resting import resting_displacement
from frbcli.bearing_tests.short import short_course, short_force, short_moment
from frbcli.bearing_tests.steady_film import Array, FilmMoment, film_moment
from frbcli.case.schema import Case
from frbcli.film.cells.motion import Motion
from frbcli.film.published.solution import NodeState
from frbcli.scene.forms.form import FilmForm
from frbcli.scene.forms.models import GIVEN
from frbcli.scene.forms.published import PUBLISHED
from frbcli.scene.forms.tables import SHORT
from frbcli.scene.planning.kinematic_plan import KinematicPlan

Tell = Callable[[int], None]


@dataclass(frozen=True)
class TestedFilm(ABC):
    """The film of a planned test. All functions raise NotConverged."""

    __test__ = False  # no test case, whatever its name begins with

    case: Case
    plan: KinematicPlan

    @abstractmethod
    def rest(self, load: float, omega: float) -> tuple[Array, NodeState | None]:
        """(2,) displacement over the clearance in which the film carries a load in N along -y at omega rad/s, and the
        state from which it is solved again there, if that is needed."""

    @abstractmethod
    def moment(self, motion: Motion, start: NodeState | None) -> FilmMoment:
        """The film for a motion that lasts; start: see rest."""

    @abstractmethod
    def course(self, path: Path, times: Array, tell: Tell | None) -> Course:
        """The film along a path at the times (n,) in s, see film_course; tell: called with the number of each
        moment."""


class SolvedFilm(TestedFilm):
    """On finite volumes, or the modal film of a rectangular gap."""

    def rest(self, load: float, omega: float) -> tuple[Array, NodeState | None]:
        """See TestedFilm."""
        return resting_displacement(self.case, self.plan, load, omega), None

    def moment(self, motion: Motion, _: NodeState | None) -> FilmMoment:
        """See TestedFilm."""
        return film_moment(self.case, self.plan, motion, self.plan.cells)

    def course(self, path: Path, times: Array, tell: Tell | None) -> Course:
        """See TestedFilm."""
        return film_course(self.case, self.plan, path, times, tell)


class PublishedTest(TestedFilm):
    """On quadratic elements, in the published two-phase form."""

    def rest(self, load: float, omega: float) -> tuple[Array, NodeState | None]:
        """See TestedFilm."""
        return resting_in_published(self.case, self.plan, load, omega)

    def moment(self, motion: Motion, start: NodeState | None) -> FilmMoment:
        """See TestedFilm."""
        return published_moment(self.case, self.plan, motion, start)

    def course(self, path: Path, times: Array, tell: Tell | None) -> Course:
        """See TestedFilm."""
        return published_course(self.case, self.plan, path, times, tell)


class ShortTest(TestedFilm):
    """By the closed forms of the short bearing."""

    def rest(self, load: float, omega: float) -> tuple[Array, NodeState | None]:
        """See TestedFilm."""
        return resting_displacement(self.case, self.plan, load, omega, short_force), None

    def moment(self, motion: Motion, _: NodeState | None) -> FilmMoment:
        """See TestedFilm."""
        return short_moment(self.plan, motion)

    def course(self, path: Path, times: Array, _: Tell | None) -> Course:
        """See TestedFilm."""
        return short_course(self.plan, path, times)


class ModelFilm(TestedFilm):
    """By a bearing model."""

    def rest(self, load: float, omega: float) -> tuple[Array, NodeState | None]:
        """See TestedFilm."""
        return resting_displacement(self.case, self.plan, load, omega, model_force), None

    def moment(self, motion: Motion, _: NodeState | None) -> FilmMoment:
        """See TestedFilm."""
        return model_moment(self.case, self.plan, motion)

    def course(self, path: Path, times: Array, _: Tell | None) -> Course:
        """See TestedFilm."""
        return model_course(self.case, self.plan, path, times)


def tested_film(case: Case, plan: KinematicPlan) -> TestedFilm:
    """The film of a planned test: here, and nowhere else, a form becomes a film."""
    kinds: dict[FilmForm, Callable[[Case, KinematicPlan], TestedFilm]]
    kinds = {GIVEN: ModelFilm, PUBLISHED: PublishedTest, SHORT: ShortTest}
    return kinds.get(plan.form, SolvedFilm)(case, plan)
