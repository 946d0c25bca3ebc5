"""Where a journal that turns rests in its film under a load."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from frbcli.bearing_tests.steady_film import film_force, settled
from frbcli.case.schema import Case
from frbcli.equilibrium.under_load import position_under_load
from frbcli.errors import NotConverged
from frbcli.film.cells.motion import Motion
from frbcli.film.gap import Section
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.film.section_faults import no_inflow
from frbcli.scene.planning.kinematic_plan import KinematicPlan, law_at

Array = NDArray[np.float64]
ForceOf = Callable[[Case, KinematicPlan, Motion, tuple[int, int]], Array]  # (2,) N on the journal, on cells

BAR = 1e5
COARSE_CELLS = (80, 20)
TABLE_MESH = Mesh(4, 64)  # of the film that tells where to begin
STARTS = (0.6, 0.85, 0.3, 0.95)
ATTITUDE = math.radians(20.0)


def resting_displacement(
    case: Case, plan: KinematicPlan, load: float, omega: float, force: ForceOf = film_force
) -> Array:
    """(2,) displacement over the clearance at which the film carries a load in N along -y, omega in rad/s.

    Sought with few cells first, then with those of the plan. force: of the film for a motion, on cells. Raises
    NotConverged if no start leads to one, or if the film cannot carry anything.
    """
    if plan.remembers and plan.law.empties and no_inflow(plan.section):
        cavity = plan.section.cavitation_pressure / BAR
        raise NotConverged(
            f"no resting position under {load:g} N: in the long run {plan.law.label}'s film carries 0 N, at any "
            "eccentricity. Where its pressure is above the cavitation pressure it loses oil at its edges, and none "
            f"comes in: neither supply nor oil bath is above the cavitation pressure, {cavity:g} bar. "
            "Raise the supply pressure, or supply it through axial grooves or feed holes."
        )
    target = np.array([0.0, load])
    side = math.copysign(1.0, omega)  # the journal gives way in the sense of rotation
    starts = [e * np.array([side * math.sin(ATTITUDE), -math.cos(ATTITUDE)]) for e in STARTS]
    if plan.on_cells and plan.rectangle is not None:
        starts = [*_in_a_table(plan.rectangle, target, omega, starts), *starts]
    problems = []
    for start in starts:
        try:
            coarse = start
            if plan.on_cells:
                coarse = position_under_load(_missing(case, plan, target, omega, COARSE_CELLS, force), target, start)
            return position_under_load(_missing(case, plan, target, omega, plan.cells, force), target, coarse)
        except NotConverged as problem:
            problems.append(str(problem))
    raise NotConverged(
        f"no resting position under {load:g} N from {len(starts)} starts; the last one: "
        f"{problems[-1].rstrip('.')}. {_capacity(case, plan, omega, force)} "
        "Give a higher speed or more viscosity, width or supply, or a smaller clearance."
    )


def _capacity(case: Case, plan: KinematicPlan, omega: float, force_of: ForceOf) -> str:
    """What the film carries on the way to contact, in words."""
    side = math.copysign(1.0, omega)
    forces: dict[float, float] = {}
    for e in sorted(STARTS):
        place = (side * e * math.sin(ATTITUDE), -e * math.cos(ATTITUDE))
        with suppress(NotConverged):
            force = force_of(case, plan, Motion(place, (0.0, 0.0), omega), COARSE_CELLS)
            forces[e] = float(np.linalg.norm(force))
    if not forces:
        return f"There is no steady film at the eccentricities {', '.join(f'{e:g}' for e in sorted(STARTS))}."
    highest = max(forces, key=forces.__getitem__)
    return f"The largest film force found is {forces[highest]:.3g} N, at an eccentricity of {highest:g}."


def _in_a_table(bearing: Section, target: Array, omega: float, starts: list[Array]) -> list[Array]:
    """The resting position in the tabulated half-Sommerfeld film, to begin from, if there is one."""
    film, c, still = make_film(bearing, "finite", "half-sommerfeld", TABLE_MESH), bearing.clearance, np.zeros(2)
    for start in starts:
        with suppress(NotConverged):
            return [position_under_load(lambda d: evaluate(film, c, c * d, still, omega).force - target, target, start)]
    return []


def _missing(
    case: Case, plan: KinematicPlan, target: Array, omega: float, cells: tuple[int, int], force_of: ForceOf
) -> Callable[[Array], Array]:
    """Force (2,) in N that a displacement over the clearance leaves over; cells begin with their last state."""
    before: Array | None = None

    def missing(d: Array) -> Array:
        nonlocal before
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), omega)
        if not plan.on_cells:
            return force_of(case, plan, motion, cells) - target
        law = law_at(case, plan, math.hypot(*motion.d))
        try:
            force, before = settled(plan.section, law, motion, cells, before)
        except NotConverged:
            force, before = settled(plan.section, law, motion, cells, None)
        return force - target

    return missing
