"""Films on quadratic elements with the two-phase model in its published form (4.31): its cost, and which cases can
have it in run-ups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.scene.coupling import MONOLITHIC, chosen_coupling
from frbcli.scene.forms.cells import cells_of
from frbcli.scene.forms.form import FilmForm, SolveCounts, cells_B
from frbcli.scene.planning.cell_choice import given_cells

if TYPE_CHECKING:
    from frbcli.scene.planning.film_choice import FilmChoice
    from frbcli.scene.planning.planned import Plan

PUBLISHED_ERROR = 2e-2  # of the force, on the published elements: its change on half of them, over 3
ELEMENTS = (20, 10)  # of a section, around and along, figure 6.2
FEWEST = (8, 2)
REMEDY = 'Write form = "conservative".'
DIFFUSIONS = {
    "consistent": "artificial, around and along as published (4.42): transports oil in from the edges",
    "streamline": "artificial (4.42), around only",
    "none": "no artificial diffusion: a steep step may prevent convergence",
}


STATE_s = 3.0  # to settle
COMPARED = 6  # states of a run
COUNT, POWER = 288, 1.4  # elements of the measured time of a solve, and the power of their number that it grows with


@dataclass(frozen=True)
class PublishedForm(FilmForm):
    """Quadratic elements, as many as published."""

    by_cells: ClassVar[bool] = True
    fine_when_static: ClassVar[bool] = True
    creates_oil: ClassVar[bool] = True

    def solve_us(self, plan: Plan) -> float:
        """See FilmForm."""
        around, along = cells_of(plan)
        return self.us * float((around * along / COUNT) ** POWER)

    def first_state_s(self, plan: Plan, films: int, resting: bool) -> float:
        """See FilmForm."""
        return STATE_s

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        """See FilmForm."""
        return COMPARED * STATE_s

    def memory_B(self, plan: Plan, films: int) -> float:
        """See FilmForm."""
        return cells_B(cells_of(plan), films)

    def about_oil(self, law: type[Law]) -> str:
        """See FilmForm."""
        return "the oil is part of the state, and some is created"

    def decisions(self, case: Case, films: FilmChoice) -> tuple[tuple[str, str, str], ...]:
        """See FilmForm."""
        assert films.cells is not None
        around, along = films.cells
        reason = "two-phase in its published form (4.31): creates oil where it cavitates; the run states how much"
        return (
            ("film", f"{around} x {along} elements", f"quadratic, around x along of a section; {films.mesh_why}"),
            ("form", "published", reason),
            diffusion_decision(case),
        )

    def mesh_of(self, plan: Plan) -> tuple[int, int]:
        """See FilmForm."""
        around, along = cells_of(plan)
        return along, around

    def mesh_told(self, plan: Plan) -> str:
        """See FilmForm."""
        return "{} x {} cells".format(*cells_of(plan))


PUBLISHED = PublishedForm(
    "quadratic elements, two-phase model as published", SolveCounts(1.5, 4.0, 4.0, (1.0, 1.0)), 1300.0
)


def is_published(case: Case) -> bool:
    """Whether the films of a case are in the published form."""
    return TwoPhase.name in case.cavitations and case.film.two_phase.form == "published"


def published_faults(case: Case) -> list[Fault]:
    """The faults of a case in the published form; none for other forms."""
    if not is_published(case):
        return []
    found: list[tuple[str, str, str, str]] = []
    if not case.rotor.symmetric:
        found.append(("rotor.kind", case.rotor.kind, "has two bearings; the published form is for one film", REMEDY))
    elif any(isinstance(bearing, FloatingRingBearing) for bearing in case.bearings):
        found.append(("bearing.kind", "floating-ring", "has two films; the published form is for one", REMEDY))
    if case.film.grid == "half-speed":
        found.append(("film.grid", case.film.grid, "is for cells; the published form has elements", 'Write "auto".'))
    if case.film.two_phase.whirl_steepness is not None:
        value = f"{case.film.two_phase.whirl_steepness:g}"
        found.append(("film.two-phase.whirl_steepness", value, "is for the conservative form", REMEDY))
    coupling = chosen_coupling(case.film.coupling, TwoPhase.name)
    if coupling != MONOLITHIC:
        problem = "solves the film apart from the rotor, whose elements settle only with it in one step"
        found.append(("film.coupling", coupling, problem, f"Choose {MONOLITHIC} or auto."))
    return [Fault(key, value, None, f"{problem}.", remedy) for key, value, problem, remedy in found]


def diffusion_decision(case: Case) -> tuple[str, str, str]:
    """The decision about the artificial diffusion: choice, value, reason."""
    kind = case.film.two_phase.diffusion
    return "diffusion", kind, DIFFUSIONS[kind]


def published_elements(case: Case) -> tuple[tuple[int, int], str]:
    """Elements (around, along) of a section, and why."""
    if case.accuracy.mesh is None:
        return ELEMENTS, "as published"
    return given_cells(case.accuracy.mesh, FEWEST)
