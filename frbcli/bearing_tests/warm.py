"""A journal that turns at a displacement or under a load when its film is warm: the steady heat of a single film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.bearing_tests.steady_film import film_moment
from frbcli.case.schema import Case
from frbcli.film.cells.motion import Motion
from frbcli.film.grid import Array
from frbcli.scene.machine.heat import heat_of
from frbcli.scene.machine.warm import warm_case
from frbcli.scene.planning.kinematic_plan import KinematicPlan, kinematic_plan
from frbcli.thermal.steady import FilmHeat, SteadyHeat, steady_heat

Placed = Callable[[Case, KinematicPlan], Motion]


@dataclass(frozen=True)
class WarmFilm:
    """The case and its plan with the viscosity and clearance at which the heat of its film balances; steady: that."""

    case: Case
    plan: KinematicPlan
    steady: SteadyHeat


def warm_film(case: Case, plan: KinematicPlan, omega: float, place: Placed) -> WarmFilm:
    """The film of a case with heat at omega rad/s; place: its motion, of the case at one viscosity. Raises
    NotConverged."""
    heat = heat_of(case)

    def at(viscosities: Array, clearances: Array) -> tuple[Case, KinematicPlan]:
        alike = warm_case(case, viscosities, clearances)
        return alike, kinematic_plan(alike, plan.cavitation, plan.test)

    def solve(viscosities: Array, clearances: Array) -> FilmHeat:
        alike, its_plan = at(viscosities, clearances)
        motion = place(alike, its_plan)
        found = film_moment(alike, its_plan, motion, its_plan.cells, flow=True)
        push = float(np.dot(found.loads.force, motion.v)) * its_plan.section.clearance
        power, flow = -found.loads.torque.journal * omega - push, found.side_flow
        if case.heat is not None and case.heat.side_flow == "concentric":
            flow = float(heat.concentric[0] * clearances[0] ** 3 / viscosities[0])
        return FilmHeat(np.array([power]), np.array([flow]), np.array([omega]))

    steady = steady_heat(heat.model, ("",), solve, heat.start, np.array([omega]))
    return WarmFilm(*at(steady.viscosities, steady.clearances), steady)
