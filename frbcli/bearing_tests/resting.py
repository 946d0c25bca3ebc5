"""Where a journal that turns rests in its film under a load."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from frbcli.bearing_tests.bearing_model import model_forces
from frbcli.bearing_tests.plan import KinematicPlan, law_at
from frbcli.bearing_tests.steady_film import film_force as solved_force
from frbcli.bearing_tests.steady_film import settled
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cells.motion import Motion
from frbcli.film.gap import Section
from frbcli.film.grid import Mesh
from frbcli.film.parabola import share_within
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.film.section_faults import no_inflow

Array = NDArray[np.float64]

BAR = 1e5
ITERATIONS = 40
SETTLED = 1e-5  # force left over, relative to the load
NUDGE = 1e-3  # share of the gap by which the position is moved for a derivative
GAP_KEPT = 0.3  # a step may shrink the narrowest gap to this share of it
COARSE_CELLS = (80, 20)
TABLE_MESH = Mesh(4, 64)  # of the film that tells where to begin
SMALLEST_SHARE = 0.05  # of a step that is tried
STARTS = (0.6, 0.85, 0.3, 0.95)
ATTITUDE = math.radians(20.0)


def resting_displacement(case: Case, plan: KinematicPlan, load: float, omega: float) -> Array:
    """(2,) displacement over the clearance at which the film carries a load in N along -y, omega in rad/s.

    Sought with few cells first, then with those of the plan. Raises NotConverged if no start leads to one, or
    if the film cannot carry anything.
    """
    if plan.model is None and plan.law.empties and no_inflow(plan.section):
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
    if plan.model is None and plan.rectangle is not None and not plan.modal:
        starts = [*_in_a_table(plan.rectangle, target, omega, starts), *starts]
    problems = []
    for start in starts:
        try:
            coarse = start
            if not plan.modal and plan.model is None:
                coarse = _newton(_missing(case, plan, target, omega, COARSE_CELLS), target, start)
            return _newton(_missing(case, plan, target, omega, plan.cells), target, coarse)
        except NotConverged as problem:
            problems.append(str(problem))
    raise NotConverged(
        f"no resting position under {load:g} N from {len(starts)} starts; the last one: "
        f"{problems[-1].rstrip('.')}. {_capacity(case, plan, omega)} "
        "Give a higher speed or more viscosity, width or supply, or a smaller clearance."
    )


def _capacity(case: Case, plan: KinematicPlan, omega: float) -> str:
    """What the film carries on the way to contact, in words."""
    side = math.copysign(1.0, omega)
    forces: dict[float, float] = {}
    for e in sorted(STARTS):
        place = (side * e * math.sin(ATTITUDE), -e * math.cos(ATTITUDE))
        with suppress(NotConverged):
            force = film_force(case, plan, Motion(place, (0.0, 0.0), omega), COARSE_CELLS)
            forces[e] = float(np.linalg.norm(force))
    if not forces:
        return f"There is no steady film at the eccentricities {', '.join(f'{e:g}' for e in sorted(STARTS))}."
    highest = max(forces, key=forces.__getitem__)
    return f"The largest film force found is {forces[highest]:.3g} N, at an eccentricity of {highest:g}."


def film_force(case: Case, plan: KinematicPlan, motion: Motion, cells: tuple[int, int]) -> Array:
    """(2,) force in N on the journal, told by a bearing model or solved on cells (around, along)."""
    if plan.model is not None:
        return np.asarray(model_forces(case, plan, [motion])[0])
    return solved_force(case, plan, motion, cells)


def _in_a_table(bearing: Section, target: Array, omega: float, starts: list[Array]) -> list[Array]:
    """The resting position in the tabulated half-Sommerfeld film, to begin from, if there is one."""
    film, c, still = make_film(bearing, "finite", "half-sommerfeld", TABLE_MESH), bearing.clearance, np.zeros(2)
    for start in starts:
        with suppress(NotConverged):
            return [_newton(lambda d: evaluate(film, c, c * d, still, omega).force - target, target, start)]
    return []


def _missing(
    case: Case, plan: KinematicPlan, target: Array, omega: float, cells: tuple[int, int]
) -> Callable[[Array], Array]:
    """Force (2,) in N that a displacement over the clearance leaves over; cells begin with their last state."""
    before: Array | None = None

    def missing(d: Array) -> Array:
        nonlocal before
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), omega)
        if plan.model is not None or plan.modal:
            return film_force(case, plan, motion, cells) - target
        law = law_at(case, plan, math.hypot(*motion.d))
        try:
            force, before = settled(plan.section, law, motion, cells, before)
        except NotConverged:
            force, before = settled(plan.section, law, motion, cells, None)
        return force - target

    return missing


def _newton(missing: Callable[[Array], Array], target: Array, start: Array) -> Array:
    """Newton's method with derivatives by differences, kept up to date by Broyden's formula while that works."""
    size = float(np.linalg.norm(target))
    position, fresh = start, True
    residual = missing(position)
    slope = _differences(missing, position, residual)
    for _ in range(ITERATIONS):
        left = float(np.linalg.norm(residual))
        if left < SETTLED * size:
            return position
        step = _limited(position, -np.linalg.solve(slope, residual))
        share = 1.0
        while True:
            following = position + share * step
            new = missing(following)
            if np.linalg.norm(new) < left or share < SMALLEST_SHARE:
                break
            share *= 0.4
        if np.linalg.norm(new) >= left and fresh:
            break
        moved = following - position
        poor = np.linalg.norm(new) > 0.3 * left
        position, change, residual = following, new - residual, new
        fresh = bool(poor)
        slope = (
            _differences(missing, position, residual)
            if poor
            else slope + np.outer(change - slope @ moved, moved) / (moved @ moved)
        )
    raise NotConverged(f"{np.linalg.norm(residual) / size:.1e} of the load is left over at {np.round(position, 3)}.")


def _differences(missing: Callable[[Array], Array], position: Array, residual: Array) -> Array:
    nudge = NUDGE * (1.0 - float(np.linalg.norm(position)))
    return np.column_stack([(missing(position + nudge * unit) - residual) / nudge for unit in np.eye(2)])


def _limited(position: Array, step: NDArray[np.floating]) -> Array:
    """A step that leaves the narrowest gap a share of what it was."""
    limit = 1.0 - GAP_KEPT * (1.0 - float(np.linalg.norm(position)))
    return np.asarray(share_within(position, np.asarray(step), limit) * step, dtype=np.float64)
