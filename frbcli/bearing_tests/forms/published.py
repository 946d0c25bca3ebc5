"""Kinematic tests of a film in the published two-phase form: a moment, where a journal rests, a course."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.history import (
    PROBE,
    PROBE_WIDTH,
    Course,
    MovedFilm,
    collected,
    course_of,
    every_second,
    peak_error,
)
from frbcli.bearing_tests.steady_film import FilmField, FilmMoment, pressure_at
from frbcli.case.schema import Case
from frbcli.equilibrium.newton import ForceBalance, Search, search_rest
from frbcli.errors import NotConverged
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.loads import estimate
from frbcli.film.cells.motion import Motion, Path, path_seen_from, turned
from frbcli.film.gap import gap_height
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.loads import published_loads
from frbcli.film.published.solution import NodeState, PublishedSolution
from frbcli.film.roughness.rubbing import Rubbing
from frbcli.scene.machine.machine_films import published_film
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan

SETTLED = 1e-5  # force left over, relative to the load
TOLERATED = 1e-2  # the same where no position is better: with a steep step the force itself is not smoother
PATIENCE = 5  # positions that are not better
DERIVATIVES = 1e-2  # a solution that is unsettled by more of its force has none to trust
GENTLE = 0.9  # x_1 of a step less steep, with which the position is sought first
STARTS = (0.6, 0.3, 0.85, 0.15)
ATTITUDE = math.radians(40.0)


@dataclass(frozen=True)
class _NodeMoment(MovedFilm):
    solution: PublishedSolution


def published_moment(case: Case, plan: KinematicPlan, motion: Motion, start: NodeState | None) -> FilmMoment:
    """The film for a motion that lasts, its error estimated from half as many elements each way.

    start: of nearly the same motion. Raises NotConverged.
    """
    film = published_film(case, plan.section, plan.cells)
    solution = film.steady(motion, start)
    error = math.nan
    try:
        coarse = film.coarser().steady(motion)
        error = max(estimate(_pair(solution), _pair(coarse)), solution.unsettled)
    except NotConverged:
        pass
    unknowns = int(np.count_nonzero(~film.elements.fixed))
    loads = published_loads(film, solution, factor=case.film.cavitation_factor)
    return FilmMoment(_field(film, solution), loads, error, unknowns, solution.iterations)


def resting_in_published(case: Case, plan: KinematicPlan, load: float, omega: float) -> tuple[Array, NodeState]:
    """(2,) displacement over the clearance where the film carries a load in N along -y, and the film there.

    omega: in rad/s. Raises NotConverged if no start leads to one.
    """
    film, side, problem = published_film(case, plan.section, plan.cells), math.copysign(1.0, omega), ""
    rubbing = rubbing_of(case)
    gentle = PublishedFilm(plan.section, TwoPhase(GENTLE), case.film.two_phase.diffusion, *plan.cells)
    for e in STARTS:
        start = e * np.array([side * math.sin(ATTITUDE), -math.cos(ATTITUDE)])
        try:
            near = _rest(gentle, rubbing, load, omega, start)[0] if film.law.steepness > GENTLE else start
            return _rest(film, rubbing, load, omega, near)
        except NotConverged as failure:
            problem = str(failure)
    raise NotConverged(
        f"no resting position under {load:g} N from {len(STARTS)} starts; the last one: {problem.rstrip('.')}. "
        'Give a higher speed or more viscosity, width or supply, a less steep model, or form = "conservative".'
    )


def published_course(
    case: Case, plan: KinematicPlan, path: Path, times: Array, observe: Callable[[int], None] | None = None
) -> Course:
    """The film along a path from a full one at times[0], see film_course; its error from half as many elements each way
    in half the steps. Raises NotConverged if it does not converge at once."""
    film, path = published_film(case, plan.section, plan.cells), path_seen_from(path, plan.turning)
    moments, problem = collected(_march(case, plan, film, path, times), observe)
    worst = max(moments, key=lambda moment: moment.size)
    passed, error, spent = times[: len(moments) + 1], math.nan, 0
    try:
        coarse, unsolved = collected(_march(case, plan, film.coarser(), path, every_second(passed)))
        spent = sum(moment.iterations for moment in coarse)
        error = math.nan if unsolved else peak_error(case, passed, moments, coarse)
    except NotConverged:
        pass
    field = _field(film, worst.solution)
    field = replace(field, phi=field.phi + plan.turning * worst.time)
    return course_of(moments, worst, field, error, film.elements.fixed, spent, problem)


def _march(case: Case, plan: KinematicPlan, film: PublishedFilm, path: Path, times: Array) -> Iterator[_NodeMoment]:
    """The film at the times (n,) after the first, from a full one. Raises NotConverged."""
    state = film.full()
    for begin, time in itertools.pairwise(times.tolist()):
        solution = film.step(path, state, begin, time - begin)
        state = solution.state
        yield _moment(case, plan, film, time, solution)


def _moment(
    case: Case, plan: KinematicPlan, film: PublishedFilm, time: float, solution: PublishedSolution
) -> _NodeMoment:
    """As seen in the lab."""
    motion, angle = solution.motion, plan.turning * time
    found = published_loads(film, solution, motion.omega + 2.0 * plan.turning, case.film.cavitation_factor)
    found = rubbing_of(case).loads(found, motion, plan.turning)
    found = replace(found, force=turned(found.force, angle))
    place = PROBE_WIDTH * plan.section.bearing_width / plan.section.width
    probe = pressure_at(_field(film, solution), PROBE - angle, place)
    gap = float(gap_height(plan.section, motion.d, np.array([PROBE - angle]))[0])
    return _NodeMoment(time, turned(motion.d, angle), found, probe, gap, solution.iterations, solution)


def _rest(
    film: PublishedFilm, rubbing: Rubbing, load: float, omega: float, start: Array
) -> tuple[Array, NodeState]:
    """Where a film carries a load, sought from a displacement (2,) over the clearance, and the film there."""
    c = film.section.clearance

    def balance(position: Array, before: ForceBalance[PublishedSolution] | None) -> ForceBalance[PublishedSolution]:
        x, y = (position[0] / c).tolist()
        trusted = before is not None and before.films.unsettled < DERIVATIVES
        state = before.films.state if before is not None and trusted else None
        solution = film.steady(Motion((x, y), (0.0, 0.0), omega), state)
        summits = rubbing.force(position[0], np.zeros(2), omega)
        slope = solution.response.by_d / c + summits.by_displacement
        if before is not None and solution.unsettled >= DERIVATIVES:
            slope = before.slope
        return ForceBalance(solution.response.force + summits.force - [0.0, load], slope, solution)

    search = Search(step=0.0, force=SETTLED * load, share=1.0, patience=PATIENCE)
    found = search_rest(balance, c * start[None], lambda at: at / c, search)
    place: Array = found.position[0] / c
    if found.balance.left < TOLERATED * load:
        return place, found.balance.films.state
    raise NotConverged(f"{found.balance.left / load:.1e} of the load is left over at {np.round(place, 3)}")


def _pair(solution: PublishedSolution) -> tuple[float, float]:
    return float(solution.response.force[0]), float(solution.response.force[1])


def _field(film: PublishedFilm, solution: PublishedSolution) -> FilmField:
    """At the nodes; those that a bore has moved are drawn where they came from."""
    mesh, section, pressure = film.mesh, film.section, solution.state.pressure
    phi, z = mesh.phi[:, 0], mesh.z[0]
    absolute = section.ambient_pressure + section.pressure_scale * pressure
    fraction = film.law.fraction(film.over_cavitation(pressure))[0]
    return FilmField(phi, z, gap_height(section, solution.motion.d, phi), absolute, fraction)
