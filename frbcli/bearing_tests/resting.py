"""Where a journal that turns rests in its film under a load."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.steady_film import film_force
from frbcli.case.schema import Case
from frbcli.equilibrium.newton import ForceBalance, Search, search_rest
from frbcli.errors import NotConverged
from frbcli.film.cells.motion import Motion
from frbcli.film.gap import Section
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.film import FilmForce, evaluate, make_film
from frbcli.film.section_faults import no_inflow
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan

Near = Callable[[Motion, FilmForce | None], FilmForce]  # on the journal in a motion, sought from one near by
ForceOf = Callable[[Case, KinematicPlan, tuple[int, int], Motion, FilmForce | None], FilmForce]  # the same on cells

BAR = 1e5
COARSE_CELLS = (80, 20)
TABLE_MESH = Mesh(4, 64)  # of the film from which the search begins
STARTS = (0.6, 0.85, 0.3, 0.95)
ATTITUDE = math.radians(20.0)
SETTLED = 1e-5  # force left over, relative to the load
SMALLEST_SHARE = 0.05  # of a step that is tried


def resting_displacement(
    case: Case, plan: KinematicPlan, load: float, omega: float, force: ForceOf = film_force
) -> Array:
    """(2,) displacement over the clearance at which the film carries a load in N along -y, omega in rad/s.

    Sought with few cells first, then with the plan's. force: of the film for a motion, on cells. Raises
    NotConverged if no start leads to one, or if the film cannot carry anything.
    """
    if plan.remembers and plan.law.empties and no_inflow(plan.section):
        cavity = plan.section.cavitation_pressure / BAR
        raise NotConverged(
            f"no static equilibrium under {load:g} N: in the long run {plan.law.label}'s film carries 0 N, at any "
            "eccentricity. Where its pressure is above the cavitation pressure it loses oil at its edges, and none "
            f"comes in: neither supply nor oil bath is above the cavitation pressure, {cavity:g} bar. "
            "Raise the supply pressure, or supply it through axial grooves or feed holes."
        )
    target = np.array([0.0, load])
    side = math.copysign(1.0, omega)  # the journal gives way in the sense of rotation
    starts = [e * np.array([side * math.sin(ATTITUDE), -math.cos(ATTITUDE)]) for e in STARTS]
    if (standing := rubbing_of(case).standing(load)) > 0.0:
        starts.append(np.array([0.0, -standing / plan.section.clearance]))
    if plan.on_cells and plan.rectangle is not None:
        starts = [*_in_a_table(plan.rectangle, target, omega, starts), *starts]
    problems = []
    for start in starts:
        try:
            coarse = start
            if plan.on_cells:
                coarse = _carried(partial(force, case, plan, COARSE_CELLS), plan.section, target, omega, start)
            return _carried(partial(force, case, plan, plan.cells), plan.section, target, omega, coarse)
        except NotConverged as problem:
            problems.append(str(problem))
    raise NotConverged(
        f"no static equilibrium under {load:g} N from {len(starts)} starts; the last one: "
        f"{problems[-1].rstrip('.')}. {_capacity(case, plan, omega, force)} "
        "Give a higher speed or more viscosity, width or supply, or a smaller clearance."
    )


def _capacity(case: Case, plan: KinematicPlan, omega: float, force_of: ForceOf) -> str:
    """A sentence on the force that the film carries on the way to contact."""
    side = math.copysign(1.0, omega)
    forces: dict[float, float] = {}
    for e in sorted(STARTS):
        place = (side * e * math.sin(ATTITUDE), -e * math.cos(ATTITUDE))
        with suppress(NotConverged):
            loads = force_of(case, plan, COARSE_CELLS, Motion(place, (0.0, 0.0), omega), None)
            forces[e] = float(np.linalg.norm(loads.force))
    if not forces:
        return f"There is no steady film at the eccentricities {', '.join(f'{e:g}' for e in sorted(STARTS))}."
    highest = max(forces, key=forces.__getitem__)
    return f"The largest film force found is {forces[highest]:.3g} N, at an eccentricity of {highest:g}."


def _in_a_table(bearing: Section, load: Array, omega: float, starts: list[Array]) -> list[Array]:
    """The static equilibrium in the tabulated half-Sommerfeld film, to begin from, if there is one."""
    film, c, still = make_film(bearing, "finite", "half-sommerfeld", TABLE_MESH), bearing.clearance, np.zeros(2)
    for start in starts:
        with suppress(NotConverged):
            return [_carried(lambda motion, _: evaluate(film, c, c * np.array(motion.d), still, omega), bearing, load,
                             omega, start)]  # fmt: skip
    return []


def _carried(force: Near, section: Section, load: Array, omega: float, start: Array) -> Array:
    """(2,) displacement over the clearance at which a film carries the load (2,). Raises NotConverged."""

    def balance(position: Array, before: ForceBalance[FilmForce] | None) -> ForceBalance[FilmForce]:
        x, y = (position[0] / section.clearance).tolist()
        rest = force(Motion((x, y), (0.0, 0.0), omega), before.films if before else None)
        return ForceBalance(rest.force - load, rest.by_displacement, rest)

    size, c = float(np.linalg.norm(load)), section.clearance
    rest = search_rest(balance, c * start[None], lambda at: at / c, Search(0.0, SETTLED * size, SMALLEST_SHARE))
    place: Array = rest.position[0] / c
    if not rest.settled:
        raise NotConverged(f"{rest.balance.left / size:.1e} of the load is left over at {np.round(place, 3)}.")
    return place
