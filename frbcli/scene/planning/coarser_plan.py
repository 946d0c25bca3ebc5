"""The plan of a second, coarser run, whose difference to the run shows how uncertain its results are."""

from __future__ import annotations

from dataclasses import replace

from frbcli.case.schema import Case
from frbcli.film.grid import Mesh
from frbcli.rotor.loads import SpeedProfile
from frbcli.scene.costs.cost import ExpectedCost, expected_cost
from frbcli.scene.costs.course import ERROR_ORDERS
from frbcli.scene.costs.preparation import memory_B
from frbcli.scene.planning.planned import Plan

LOOSER = 3.0  # tolerance of a step over the run's
COARSER = 0.75  # elements in each direction over the run's
FEWEST_ELEMENTS = 2, 24  # axial, around
SHARE = 1.0 / 3.0  # of the CPU time of a run that a second one may take unasked


def coarser_plan(case: Case, plan: Plan) -> Plan:
    """The plan with fewer cells or elements, a larger tolerance and longer steps; cells: the cells of the stated error
    of a run. Where the steps of a revolution are as few as a run may take, the tolerance decides nothing; their number
    is then reduced so that the error of a step grows by the same factor as the tolerance."""
    films = tuple((form, _coarser(mesh)) for form, mesh in plan.films)
    cells = plan.form.fewer_cells(case, plan) or plan.cells
    steps = plan.steps_per_revolution / LOOSER ** (1.0 / ERROR_ORDERS[plan.method])
    coarser = replace(plan, films=films, mesh=_coarser(plan.mesh), cells=cells)
    return replace(coarser, tolerance=LOOSER * plan.tolerance, steps_per_revolution=steps)


def cost_of_run(case: Case, plan: Plan, profile: SpeedProfile, asked: bool = False) -> ExpectedCost:
    """Expected cost of a run with a second one, if that is asked for or made unasked."""
    cost, second_s = expected_cost(case, plan, profile), second_run_s(case, plan, profile)
    if not (asked or is_cheap(second_s, cost)):
        return cost
    both_B = memory_B(case, plan, profile.end / case.output.step, coarser_plan(case, plan))
    return replace(cost, second_s=second_s, memory_B=both_B)


def second_run_s(case: Case, plan: Plan, profile: SpeedProfile) -> float:
    """Expected CPU time in s of the second run."""
    cost = expected_cost(case, coarser_plan(case, plan), profile)
    return cost.before_s + cost.cpu_s


def is_cheap(second_s: float, cost: ExpectedCost) -> bool:
    """Whether a second run of so many s of CPU time is made unasked, after a run of that cost."""
    return second_s <= SHARE * cost.run_s


def _coarser(mesh: Mesh) -> Mesh:
    axial, around = (
        max(min(least, elements), round(COARSER * elements))
        for elements, least in zip((mesh.axial, mesh.circumferential), FEWEST_ELEMENTS, strict=True)
    )
    return replace(mesh, axial=axial, circumferential=around)
