"""One film at one moment: pressure, oil fraction, loads and oil balance of a planned kinematic test; and where a
journal that turns rests in it under a load."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.equilibrium.resting import ForceBalance, Search, search_rest
from frbcli.errors import NotConverged
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.balance.ends import outflow
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, fitted_grid, reference_pressure
from frbcli.film.cells.linearised import settled_force
from frbcli.film.cells.loads import CavitationFactor, FilmLoads, estimate, loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.tilted_film import Land, lands, summed
from frbcli.film.gap import Section
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.film import FilmForce, direct_force, evaluate, largest_pressure, make_film
from frbcli.film.section_faults import no_inflow
from frbcli.scene.films import gaps_at_ends
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan, law_at

MODAL_MESH, COARSE_MODAL_MESH = Mesh(10, 192), Mesh(5, 96)
NUDGE = 1e-3  # share of the gap by which the journal is moved for a derivative
Near = Callable[[Motion, FilmForce | None], FilmForce]  # on the journal in a motion, sought from one near by
ForceOf = Callable[[Case, KinematicPlan, tuple[int, int], Motion, FilmForce | None], FilmForce]  # the same on cells

BAR = 1e5
COARSE_CELLS = (80, 20)
TABLE_MESH = Mesh(4, 64)  # of the film from which the search begins
STARTS = (0.6, 0.85, 0.3, 0.95)
ATTITUDE = math.radians(20.0)
SETTLED = 1e-5  # force left over, relative to the load
SMALLEST_SHARE = 0.05  # of a step that is tried


@dataclass(frozen=True)
class FilmField:
    """A section on its cells. phi: (m,) rad, z: (k,) over the section's width, their middles; gap: (m,) H; pressure:
    (m, k) Pa absolute; fraction: (m, k) of oil."""

    phi: Array
    z: Array
    gap: Array
    pressure: Array
    fraction: Array


@dataclass(frozen=True)
class FilmMoment:
    """A film at one moment: its field, the loads on the whole bearing, the estimated relative
    errors of force and moment, and what it took; side_flow: m^3/s that leave through the open ends, where it was asked
    for. The field of a bearing whose lands differ is the one of the land at z < 0."""

    field: FilmField
    loads: FilmLoads
    force_error: float
    unknowns: int
    iterations: int
    side_flow: float = math.nan
    moment_error: float = math.nan


def steady_film(
    section: Section, law: Law, motion: Motion, cells: tuple[int, int], factor: CavitationFactor = "none",
    flow: bool = False,
) -> FilmMoment:  # fmt: skip
    """The film for a motion that lasts, solved on half the cells each way, and from there on all.

    cells: around and along the whole film; half of them along for a film cut at its plane of symmetry; factor: of the
    torque, for a shell at rest. Raises NotConverged.
    """
    coarse, film = _films(section, law, motion, cells)
    first = FilmSolver(coarse).steady(motion)
    solution = FilmSolver(film).steady(motion, film.from_coarser(coarse, first.w))
    fine, rough = loads(film, motion, solution, factor=factor), loads(coarse, motion, first)
    return FilmMoment(
        film_field(film, motion, solution),
        fine,
        estimate(fine.force, rough.force, law.order),
        int(np.count_nonzero(~film.grid.fixed)),
        first.iterations + solution.iterations,
        leaving(film, motion, solution) if flow else math.nan,
        estimate(fine.moment, rough.moment, law.order),
    )


def leaving(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> float:
    """Outflow of a solution in m^3/s through the open ends of the whole bearing, of a land where the lands differ."""
    return outflow(film, motion, film.pressure(solution.state))


def settled(
    section: Section, law: Law, motion: Motion, cells: tuple[int, int], start: Array | None
) -> FilmForce:
    """Force of the whole bearing on the journal, and the unknown of the cells, from which to start a motion that is
    nearly the same: it is sought from `start`, or from half the cells. Raises NotConverged."""
    coarse, film = _films(section, law, motion, cells)
    if start is None or start.shape != film.grid.shape:  # the edges of openings cut other cells
        start = film.from_coarser(coarse, FilmSolver(coarse).steady(motion).w)
    solver = FilmSolver(film)
    return settled_force(solver, motion, solver.steady(motion, start))


def _films(
    section: Section, law: Law, motion: Motion, cells: tuple[int, int]
) -> tuple[VolumeFilm, VolumeFilm]:
    """The film on half the cells each way, and on all; see steady_film."""
    around, along = cells[0], cells[1] // 2 if section.far == "symmetry" else cells[1]
    reference = reference_pressure(section, motion)
    coarse, fine = (fitted_grid(section, motion.d, around // n, along // n, motion.tilts) for n in (2, 1))
    return VolumeFilm(section, coarse, law, reference), VolumeFilm(section, fine, law, reference)


def film_moment(
    case: Case, plan: KinematicPlan, motion: Motion, cells: tuple[int, int], flow: bool = False
) -> FilmMoment:
    """The film for a motion that lasts, by the modal film where that is known; flow: see steady_film. Raises
    NotConverged."""
    law = law_at(case, plan, math.hypot(*motion.d))
    require_gap(plan.section, motion)
    parts = lands(plan.section, motion, case.bearings[0].films[0].supply.mirrored)
    factor = case.film.cavitation_factor
    moment = _whole([(land, steady_film(land.section, law, land.motion, cells, factor, flow)) for land in parts])
    if plan.rectangle is None or not plan.modal:
        return moment
    place, velocity = _si(plan, motion)
    force, coarse = modal_force(plan, motion), modal_force(plan, motion, COARSE_MODAL_MESH)
    top = largest_pressure(plan.rectangle, MODAL_MESH, place, velocity, motion.omega)
    film_loads = replace(moment.loads, force=force, p_max=top)
    return replace(moment, loads=film_loads, force_error=estimate(force, coarse))


def require_gap(section: Section, motion: Motion) -> None:
    """Raises NotConverged if a journal that tilts touches an end of its shell, as one that is warm may."""
    least = min(gaps_at_ends(section, motion.d, motion.slope))
    if motion.tilts and least <= 0.0:
        size = 1e6 * section.clearance
        raise NotConverged(f"the journal touches its shell at an end: the gap closes there at {size:.3g} um clearance.")


def _whole(parts: Sequence[tuple[Land, FilmMoment]]) -> FilmMoment:
    """The film of a bearing from its lands, whose errors add up at the worst."""
    whole = summed([(land, each.loads) for land, each in parts])
    if len(parts) == 1:
        return replace(parts[0][1], loads=whole)
    force_errors = [each.force_error * math.hypot(*each.loads.force) for _, each in parts]
    moment_error = sum(
        each.moment_error * math.hypot(*each.loads.moment) + abs(land.centre) * error
        for (land, each), error in zip(parts, force_errors, strict=True)
    )
    force, moment = math.hypot(*whole.force), math.hypot(*whole.moment)
    films = [each for _, each in parts]
    return FilmMoment(
        films[0].field,
        whole,
        sum(force_errors) / force if force > 0.0 else 0.0,
        sum(each.unknowns for each in films),
        sum(each.iterations for each in films),
        sum(each.side_flow for each in films),
        moment_error / moment if moment > 0.0 else 0.0,
    )


def film_force(
    case: Case, plan: KinematicPlan, cells: tuple[int, int], motion: Motion, near: FilmForce | None
) -> FilmForce:
    """Force of the whole bearing on a journal that stays where it is; near: in a motion near by, from which it is
    sought. Raises NotConverged."""
    if plan.modal:
        return _modal_differences(plan, motion)
    law = law_at(case, plan, math.hypot(*motion.d))
    try:
        return settled(plan.section, law, motion, cells, None if near is None else near.field)
    except NotConverged:
        return settled(plan.section, law, motion, cells, None)


def _modal_differences(plan: KinematicPlan, motion: Motion) -> FilmForce:
    """The force of the modal film, with its derivative by the displacement."""
    force, nudge = np.array(modal_force(plan, motion)), NUDGE * (1.0 - math.hypot(*motion.d))
    x, y = motion.d
    moved = (replace(motion, d=place) for place in ((x + nudge, y), (x, y + nudge)))
    changes = [np.array(modal_force(plan, each)) - force for each in moved]
    return FilmForce(force, np.column_stack(changes) / (nudge * plan.section.clearance), np.full((2, 2), math.nan))


def modal_force(plan: KinematicPlan, motion: Motion, mesh: Mesh = MODAL_MESH) -> tuple[float, float]:
    """(2,) force in N on the journal by the whole bearing with a rectangular gap and no state, by the accurate modal
    film."""
    assert plan.rectangle is not None
    place, velocity = _si(plan, motion)
    force = direct_force(plan.rectangle, plan.cavitation, mesh, place, velocity, motion.omega)
    return float(force[0]), float(force[1])


def film_field(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> FilmField:
    """Absolute pressures, as the loads are taken from them, and oil fractions of a solution."""
    grid, section = film.grid, film.section
    pressure = section.ambient_pressure + section.pressure_scale * film.pressure(solution.state)
    return FilmField(grid.centre, grid.height, film.gap(motion.d, grid.centre), pressure, solution.state.fraction)


def pressure_at(field: FilmField, phi: float, z: float) -> float:
    """Pressure in Pa at an angle and an axial position over the section's width, linear between the cells' middles."""
    angles = np.append(field.phi, field.phi[0] + 2.0 * math.pi)
    turned = field.phi[0] + (phi - field.phi[0]) % (2.0 * math.pi)
    i = min(int(np.searchsorted(angles, turned, side="right")) - 1, len(field.phi) - 1)
    share = (turned - angles[i]) / (angles[i + 1] - angles[i])
    line = (1.0 - share) * field.pressure[i] + share * field.pressure[(i + 1) % len(field.phi)]
    return float(np.interp(z, field.z, line))


def _si(plan: KinematicPlan, motion: Motion) -> tuple[Array, Array]:
    clearance = plan.section.clearance
    return clearance * np.array(motion.d), clearance * np.array(motion.v)


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
