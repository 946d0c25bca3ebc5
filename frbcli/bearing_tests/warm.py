"""A film that is warm in a kinematic test: the steady heat of a single film, at rest or as its journal is moved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.history import mean_heat
from frbcli.bearing_tests.steady_film import film_moment
from frbcli.case.schema import Case
from frbcli.film.cells.motion import Motion, Path
from frbcli.scene.machine.heat import heat_of, warm_case
from frbcli.scene.planning.kinematic_plan import KinematicPlan, kinematic_plan
from frbcli.scene.tilt import tilt_rate_of
from frbcli.thermal.steady import FilmHeat, SteadyHeat, steady_heat

Placed = Callable[[Case, KinematicPlan], Motion]
Dissipated = Callable[[Case, KinematicPlan], tuple[float, float]]  # power in W and side flow in m^3/s

COARSER = 8  # steps of a test for each one of the course of which means are taken, or with which they are begun


@dataclass(frozen=True)
class WarmFilm:
    """The case and its plan with the viscosity and clearance at which the heat of its film balances; steady: that."""

    case: Case
    plan: KinematicPlan
    steady: SteadyHeat


def warm_resting_film(case: Case, plan: KinematicPlan, omega: float, place: Placed) -> WarmFilm:
    """The film of a case with heat in a motion that lasts, at omega rad/s; place: that motion, of the case at one
    viscosity. Raises NotConverged."""

    def dissipated(alike: Case, its_plan: KinematicPlan) -> tuple[float, float]:
        motion = place(alike, its_plan)
        moment = film_moment(alike, its_plan, motion, its_plan.cells, flow=True)
        push = float(np.dot(moment.loads.force, motion.v)) * its_plan.section.clearance
        push += float(np.dot(moment.loads.moment, tilt_rate_of(alike))) if motion.tilts else 0.0
        return -moment.loads.torque.journal * omega - push, moment.side_flow

    return _warm_film(case, plan, omega, dissipated, heat_of(case).start)


def warm_moved_film(case: Case, plan: KinematicPlan, omega: float, path: Path, times: Array) -> WarmFilm:
    """The film of a case with heat whose journal is moved along a path at the times (n,) in s and turns at omega rad/s.
    Its temperature is steady: what it dissipates and lets out is averaged over the last period. Raises NotConverged."""

    def means(at: Array) -> Dissipated:
        return lambda alike, its_plan: mean_heat(alike, its_plan, path, at)

    few = np.linspace(times[0], times[-1], 1 + (len(times) - 1) // COARSER)
    begun = _warm_film(case, plan, omega, means(few), heat_of(case).start)
    if not plan.remembers:  # its moments have no error of the steps, and their mean hardly one
        return begun
    return _warm_film(case, plan, omega, means(times), begun.steady.temperatures)


def _warm_film(case: Case, plan: KinematicPlan, omega: float, dissipated: Dissipated, start: Array) -> WarmFilm:
    """start: (n,) K, to begin from. Raises NotConverged."""
    heat = heat_of(case)

    def at(viscosities: Array, clearances: Array) -> tuple[Case, KinematicPlan]:
        alike = warm_case(case, viscosities, clearances)
        return alike, kinematic_plan(alike, plan.cavitation, plan.test)

    def solve(viscosities: Array, clearances: Array) -> FilmHeat:
        power, flow = dissipated(*at(viscosities, clearances))
        if case.heat is not None and case.heat.side_flow == "concentric":
            flow = float(heat.concentric[0] * clearances[0] ** 3 / viscosities[0])
        return FilmHeat(np.array([power]), np.array([flow]), np.array([omega]))

    steady = steady_heat(heat.model, ("",), solve, start, np.array([omega]))
    return WarmFilm(*at(steady.viscosities, steady.clearances), steady)
