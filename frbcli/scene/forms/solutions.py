"""Films that are not mass-conserving, tabulated from solutions on cells before a run: their cost, and why others are
solved on cells during it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import SAMPLES, Mesh
from frbcli.scene.films import film_places, is_plain
from frbcli.scene.forms.form import BLOCKS, FilmForm, SolveCounts
from frbcli.scene.gate.rule import RUN, Rule, oil_flow_signal, refusal

if TYPE_CHECKING:
    from frbcli.scene.planning.film_choice import Plan

SOLUTION_MESH = Mesh(axial=6, circumferential=48)  # cells
# 90 % of the forces up to an eccentricity of 0.95 have a smaller error, from interpolation and cells together.
SOLUTION_ERROR = 6e-3
TABLE_TARGET = 5e-4  # the smallest target for which splines through some thousand solutions are sufficient
TABULATING_s = 0.65  # of a table, on SOLUTION_MESH
ONE_STATE = 1e-3  # one state instead of a table of thousands
TURNING = "openings or lobes do not turn with the line of centres"


@dataclass(frozen=True)
class SolutionForm(FilmForm):
    """Tables of solutions on cells."""

    fine_when_static: ClassVar[bool] = True
    table_of_solutions: ClassVar[bool] = True
    why: ClassVar[str] = "rectangular gap, no state: the force depends on the motion alone; solved on cells before"
    elements: ClassVar[str] = "cells"
    compiling: ClassVar[tuple[float, float]] = 29.0, 4.2e8
    rules: ClassVar[tuple[Rule, ...]] = (
        refusal(
            (RUN,), "output.signals", oil_flow_signal,
            "is not known from the tables of the penalty model", 'Write film.solution = "cells".',
        ),
    )  # fmt: skip

    def table_s(self, plan: Plan) -> float:
        size = plan.mesh.circumferential / SOLUTION_MESH.circumferential
        return TABULATING_s * size * _along_factor(plan.mesh) / _along_factor(SOLUTION_MESH)

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        return SAMPLES * films * ONE_STATE * self.table_s(plan)

    def memory_B(self, plan: Plan, films: int) -> float:
        return 8.0 * BLOCKS * plan.mesh.circumferential * plan.mesh.axial**2


def _along_factor(mesh: Mesh) -> float:
    """Factor of the time of a solve by the cells along half of the axis, which are eliminated as full blocks."""
    along = max(2, (mesh.axial + 1) // 2)
    return 0.37 + 0.03 * along + 0.01065 * along**2 + 3.09e-4 * float(along) ** 3


SOLUTIONS = SolutionForm("table over eccentricity, direction and speed", SolveCounts(1.0, 1.0, 1.5, (1.0, 1.0)), 0.6)


def table_obstacle(case: Case) -> str:
    """Why films that are not all clipped cannot be tabulated; empty if they can."""
    film, oil = case.film, case.oil
    if case.contact.flow_factors:
        return "flow factors change with the gap"
    for cavitation in case.cavitations:
        if law_named(cavitation).keeps_oil:
            return f"{cavitation} is mass-conserving: the force does not depend on the motion alone"
        if not law_named(cavitation).tabulated:
            return f"{cavitation} has no such table"
    if case.heat is not None:
        return "heat needs the flow out of the films, which is not in the table"
    if film.grid == "half-speed":
        return "a half-speed grid needs cells"
    for place in film_places(case):
        if place.feed_holes is not None or not is_plain(place.geometry):
            return TURNING
        if place.geometry.ends == "free-to-air":
            return "the flow out of free ends is not in the table"
        if place.geometry.supply.over_time is not None:
            return "the pressure of the supply changes over time, and a table has one"
        gauge = place.geometry.supply.gauge(oil.ambient_pressure)
        equal = gauge == 0.0 and oil.ambient_pressure == oil.cavitation_pressure
        if film.penalty.pressure == "dimensionless" and not equal:
            return "with the dimensionless pressure, a supply or cavitation pressure would be a fourth axis"
    if film.solution == "auto" and case.accuracy.target < TABLE_TARGET:
        return f"a table is too coarse for a target below {TABLE_TARGET:g}"
    return ""


def solution_fault(case: Case, clipped: bool, tabulated: bool) -> Fault | None:
    """The fault of film.solution. clipped: whether all films are clipped; tabulated: whether clipped films can be
    tabulated."""
    if case.film.solution != "table":
        return None
    obstacle = table_obstacle(case)
    if clipped and not case.contact.flow_factors:
        obstacle = "" if tabulated else TURNING
    if not obstacle:
        return None
    return Fault("film.solution", "table", None, f"is not possible: {obstacle}.", "Choose auto or cells.")
