"""Films on finite volumes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import FINER
from frbcli.scene.films import is_published
from frbcli.scene.forms.form import PUBLISHED, FilmForm, SolveCounts, cells_B
from frbcli.scene.planning.cell_choice import ALONG, USUAL, cells_time, coarser_cells, compared_states, worst_film

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.scene.planning.film_choice import FilmChoice
    from frbcli.scene.planning.planned import Plan

STEADY_s, STEADY_CELLS, STEADY_POWER = 0.012, 1152, 1.1  # of a steady film, a state of its own; its cells
RESTING = 3.0  # factor for a static equilibrium, found by Newton's method
COMPILING = 36.0, 5e8  # at the first start: CPU time in s, memory in bytes
AGAIN = 0.5  # of the loop: the run on fewer cells
FIXED = 0.1  # share of a solve on USUAL cells that does not depend on the cells
# Solves of a stage of a mass-conserving film, whose cells turn with it: at least, and for every cell that passes a
# front in a step.
KEEPING_SOLVES, FRONT_SOLVES = 2.2, 0.55
# Fronts that cross cells make the local error of second order; the steps fall with the size of the cells.
FRONT_ORDER, FRONT_CELLS = 2.0, 1.0 / 3.0
GENTLE = 0.9  # x_1 of a step of theta(p) that is not steep
EXPECTED = "largest one expected, of weight and unbalance in short bearings without openings; the cells are for it"


@dataclass(frozen=True)
class CellForm(FilmForm):
    """Finite volumes, their number chosen by the target."""

    by_cells: ClassVar[bool] = True
    fine_when_static: ClassVar[bool] = True
    lengths: ClassVar[tuple[int, ...]] = ALONG  # cells along to choose from
    compiling: ClassVar[tuple[float, float]] = COMPILING

    def solve_us(self, case: Case, plan: Plan) -> float:
        size = self.cells_solved(case, plan) / cells_time(*USUAL)
        law = float(np.mean([law_named(name).cost for name in case.cavitations]))
        return self.us * (law * (FIXED + (1.0 - FIXED) * size))

    def cells_solved(self, case: Case, plan: Plan) -> float:
        """The cells of a solve as cells_time counts them, mean of all films."""
        return cells_time(*cells_of(plan))

    def first_state_s(self, plan: Plan, films: int, resting: bool) -> float:
        return films * (RESTING if resting else 1.0) * _steady_s(cells_of(plan))

    def again_share(self) -> float:
        return AGAIN

    def error_s(self, plan: Plan, films: int, machines: int) -> float:
        cells = cells_of(plan)
        fine = cells[0] * FINER, cells[1] * FINER
        return compared_states(cells) * films * (_steady_s(cells) + _steady_s(fine))

    def memory_B(self, plan: Plan, films: int) -> float:
        return cells_B(cells_of(plan), films)

    def solves_of_a_stage(self, plan: Plan, per_turn: Array, turning: bool) -> Array | None:
        if not turning:
            return None
        passed = 0.5 * cells_of(plan)[0] / np.maximum(per_turn, 1.0)
        return np.asarray(KEEPING_SOLVES + FRONT_SOLVES * passed)

    def steps_at_fronts(self, plan: Plan, fronts: float) -> float:
        coarse = USUAL[0] / cells_of(plan)[0]
        return float(fronts * plan.tolerance ** (-1.0 / FRONT_ORDER) * coarse**FRONT_CELLS)

    def fewer_cells(self, case: Case, plan: Plan) -> tuple[int, int] | None:
        cells = coarser_cells(worst_film(case, plan.eccentricity), self.of_half(cells_of(plan)))
        return None if cells is None else self.of_whole(cells)

    def of_whole(self, cells: tuple[int, int]) -> tuple[int, int]:
        """Cells (around, along) of a plan, from the cells of a section."""
        return cells

    def decisions(self, case: Case, films: FilmChoice) -> tuple[tuple[str, str, str], ...]:
        assert films.cells is not None
        around, along = films.cells
        rows = [("film", f"{around} x {along} cells", f"finite volumes, around x along; {films.mesh_why}")]
        if films.eccentricity is not None:
            rows.append(("eccentricity", f"{films.eccentricity:.2f}", EXPECTED))
        if is_published(case) and (transport := self.transport(case)) is not None:
            rows += [("form", "published", PUBLISHED), transport]
        return tuple(rows)

    def remedies(self, case: Case) -> tuple[str, ...]:
        if not is_published(case):
            return ()
        two_phase, changes = case.film.two_phase, ['film.two-phase.form = "conservative"']
        if two_phase.diffusion != "consistent":
            changes.append('film.two-phase.diffusion = "consistent"')
        if two_phase.steepness > GENTLE:
            changes.append(f"film.two-phase.steepness = {GENTLE:g} instead of {two_phase.steepness:g}")
        return tuple(changes)


def cells_of(plan: Plan) -> tuple[int, int]:
    """(around, along) of a plan that has them."""
    assert plan.cells is not None
    return plan.cells


def _steady_s(cells: tuple[int, int]) -> float:
    return STEADY_s * math.pow(cells[0] * cells[1] / STEADY_CELLS, STEADY_POWER)


CELLS = CellForm("cells", SolveCounts(1.2, 1.5, 2.3, (2.0, 1.0)), 20.0)
