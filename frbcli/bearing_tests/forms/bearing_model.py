"""Kinematic tests of a bearing model: it has a force, but neither pressures nor oil."""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.history import Course, History
from frbcli.bearing_tests.steady_film import FilmMoment
from frbcli.case.schema import Case
from frbcli.film.cells.loads import FilmLoads, OilBalance, Torque
from frbcli.film.cells.motion import Motion, Path
from frbcli.film.rectangles.film import FilmForce, evaluate
from frbcli.scene.machine.machine_films import bearing_film
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan

UNKNOWN = math.nan


def model_moment(case: Case, plan: KinematicPlan, motion: Motion) -> FilmMoment:
    """The force for a motion; what a model does not tell is NaN, and there is no field."""
    x, y = model_forces(case, plan, [motion])[0].force
    return FilmMoment(None, _loads(float(x), float(y)), UNKNOWN, 0, 0)


def model_course(case: Case, plan: KinematicPlan, path: Path, times: Array) -> Course:
    """The forces along a path at the times after the first; times: (n,) s."""
    motions = [path(float(time)) for time in times[1:]]
    force = np.array([moment.force for moment in model_forces(case, plan, motions)])
    displacement = np.array([motion.d for motion in motions])
    x, y = force[np.argmax(np.hypot(*force.T))]
    history = History(
        time_s=times[1:],
        displacement=displacement,
        force=force,
        probe_pressure=np.full(len(motions), UNKNOWN),
        gap_ratio=1.0 + displacement[:, 1],  # at phi = pi, where the normal points up
        moment=np.full((len(motions), 2), UNKNOWN),
    )
    return Course(history, None, _loads(float(x), float(y)), UNKNOWN, 0, 0, "")


def model_force(
    case: Case, plan: KinematicPlan, _: tuple[int, int], motion: Motion, __: FilmForce | None
) -> FilmForce:
    """The force in a motion, as film_force of steady_film.py."""
    return model_forces(case, plan, [motion])[0]


def model_forces(case: Case, plan: KinematicPlan, motions: list[Motion]) -> list[FilmForce]:
    """Forces on the journal by the whole bearing, and by its summits."""
    assert plan.rectangle is not None
    film, c, rubbing = bearing_film(case, plan.rectangle), plan.section.clearance, rubbing_of(case)

    def force(motion: Motion) -> FilmForce:
        place, rate = c * np.array(motion.d), c * np.array(motion.v)
        return rubbing.with_summits(evaluate(film, c, place, rate, motion.omega), place, rate, motion.omega)

    return [force(motion) for motion in motions]


def _loads(x: float, y: float) -> FilmLoads:
    return FilmLoads((x, y), Torque(UNKNOWN, UNKNOWN), UNKNOWN, UNKNOWN, UNKNOWN, OilBalance(*[UNKNOWN] * 5))
