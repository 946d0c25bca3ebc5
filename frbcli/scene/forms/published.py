"""Films on quadratic elements with the two-phase model in its published form (4.31): its cost, and what it is not made
for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from frbcli.case.schema import Case
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.scene.channels import coupled_rings
from frbcli.scene.films import film_places
from frbcli.scene.forms.cells import COMPILING, cells_of
from frbcli.scene.forms.form import FilmForm, SolveCounts, cells_B
from frbcli.scene.gate.analysis import ALL, KINEMATIC, RUN, SHEETS, SPEED_CYCLES, STABILITY, WHIRLS
from frbcli.scene.gate.rule import Rule, refusal
from frbcli.scene.planning.cell_choice import given_cells
from frbcli.scene.tilt import tilt_refusal

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
FORM_KEY, FORM = "film.two-phase.form", "published"
GENTLE = 0.9  # x_1 of a step that is not steep
STATE_s = 3.0  # to settle
COMPARED = 6  # states of a run
COUNT, POWER = 288, 1.4  # elements of the measured time of a solve, and the power of their number that it grows with


def _ramp(case: Case) -> str | None:
    ramps = (place.geometry.supply.rise_time for place in film_places(case))
    return next((f"{ramp:g} s" for ramp in ramps if ramp > 0.0), None)


def _whirl_steepness(case: Case) -> str | None:
    steepness = case.film.two_phase.whirl_steepness
    return None if steepness is None else f"{steepness:g}"


RULES = (
    refusal(
        ALL, FORM_KEY, lambda case: None if case.heat is None else FORM,
        "creates oil, which would carry away heat that no film has received: [thermal] would not balance",
        REMEDY,
    ),
    refusal(
        (*SHEETS, STABILITY), FORM_KEY, lambda _: FORM,
        "has kinks in its force, for each point of its elements is full or cavitated: its stiffness over 1e-3 and over "
        "1e-2 of the clearance differs by up to a half, so that none is that of small motions", REMEDY,
    ),
    refusal(
        (SPEED_CYCLES, WHIRLS), FORM_KEY, lambda _: FORM,
        "has kinks in its force, for each point of its elements is full or cavitated: motions that begin 1e-6 of the "
        "clearance apart may end 5e-5 apart after two revolutions, and cycles are sought by such differences", REMEDY,
    ),
    refusal(
        KINEMATIC, "bearing.supply.ramp", _ramp,
        "is a ramp of the pressure, which the elements of the published form do not follow", "Write 0 s.",
    ),
    tilt_refusal(
        "changes the gap along the axis; the elements of the published form have one gap at each angle",
        'Write film.two-phase.form = "conservative", or leave the tilt out.',
    ),
    refusal(
        (RUN,), "film.cavitation", lambda case: next((law for law in case.cavitations if law != TwoPhase.name), None),
        "is the model of a film beside one in the published form, whose equation (4.31) is that of the two-phase model",
        'Write "two-phase" for all films, or film.two-phase.form = "conservative".',
    ),
    refusal(
        (RUN,), "bearing.channels", lambda case: next(("coupled" for _ in coupled_rings(case)), None),
        "lets oil pass from film to film, and in the published form neither balances what it holds",
        'Write channels = "pressure", as published (7.2.6); or film.two-phase.form = "conservative".',
    ),
    refusal(
        (RUN,), "film.grid", lambda case: case.film.grid if case.film.grid == "half-speed" else None,
        "turns the grid with the oil, where no oil passes it, and the artificial diffusion (4.42) that keeps the "
        "published form stable vanishes", 'Write "auto".',
    ),
    refusal(
        (RUN,), "film.two-phase.whirl_steepness", _whirl_steepness, "is for the conservative form", REMEDY
    ),
)  # fmt: skip


@dataclass(frozen=True)
class PublishedForm(FilmForm):
    """Quadratic elements, as many as published."""

    by_cells: ClassVar[bool] = True
    fine_when_static: ClassVar[bool] = True
    same_in_tests: ClassVar[bool] = True
    parts: ClassVar[tuple[str, str]] = "elements", "around x along of a section"
    creates_oil: ClassVar[bool] = True
    compiling: ClassVar[tuple[float, float]] = COMPILING
    follows_supply: ClassVar[bool] = False
    rules: ClassVar[tuple[Rule, ...]] = RULES

    def solve_us(self, case: Case, plan: Plan) -> float:
        around, along = cells_of(plan)
        return self.us * float((around * along / COUNT) ** POWER)

    def first_state_s(self, plan: Plan, films: int, resting: bool) -> float:
        return films * STATE_s

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        return films * COMPARED * STATE_s

    def memory_B(self, plan: Plan, films: int) -> float:
        return cells_B(cells_of(plan), films)

    def about_oil(self, law: type[Law]) -> str:
        return "the oil is part of the state, and some is created"

    def decisions(self, case: Case, films: FilmChoice) -> tuple[tuple[str, str, str], ...]:
        assert films.cells is not None
        around, along = films.cells
        reason = "two-phase in its published form (4.31): creates oil where it cavitates; the run states how much"
        return (
            ("film", f"{around} x {along} elements", f"quadratic, around x along of a section; {films.mesh_why}"),
            ("form", "published", reason),
            *filter(None, [self.transport(case)]),
        )

    def parts_in_tests(self, case: Case) -> tuple[tuple[int, int], str] | None:
        return published_elements(case)

    def transport(self, case: Case) -> tuple[str, str, str] | None:
        """See FilmForm: the artificial diffusion."""
        kind = case.film.two_phase.diffusion
        return "diffusion", kind, DIFFUSIONS[kind]

    def remedies(self, case: Case) -> tuple[str, ...]:
        two_phase, found = case.film.two_phase, ['film.two-phase.form = "conservative"']
        if two_phase.diffusion != "consistent":
            found.append('film.two-phase.diffusion = "consistent"')
        if two_phase.steepness > GENTLE:
            found.append(f"film.two-phase.steepness = {GENTLE:g} in place of {two_phase.steepness:g}")
        return tuple(found)

    def told_in_tests(self, law: type[Law]) -> tuple[str, str]:
        return "quadratic elements", "two-phase in its published form (4.31): creates oil where it cavitates"


PUBLISHED = PublishedForm(
    "quadratic elements, two-phase model as published", SolveCounts(1.5, 4.0, 4.0, (1.0, 1.0)), 1300.0
)


def published_elements(case: Case) -> tuple[tuple[int, int], str]:
    """Elements (around, along) of a section, and why."""
    if case.accuracy.mesh is None:
        return ELEMENTS, "as published"
    return given_cells(case.accuracy.mesh, FEWEST)
