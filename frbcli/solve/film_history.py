"""A film while its journal is moved: squeeze (4.47) and whirl (4.48), (4.49)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.loads import Loads, loads
from frbcli.film.transient import march
from frbcli.film.volumes import Motion, VolumeFilm, VolumeSolution, fitted_grid, reference_pressure
from frbcli.scene.kinematic import KinematicPlan, make_law
from frbcli.solve.steady_film import COARSE_MODAL_MESH, FilmField, film_field, modal_force, pressure_at

Array = NDArray[np.float64]
Path = Callable[[float], Motion]

RISE_TIME = 0.01  # s, t_1 of (4.49)
PROBE = math.pi  # phi of the probe and of the gap that is told: the bottom of the bearing
PROBE_WIDTH = 0.25  # of the bearing's width from the end z = 0


@dataclass(frozen=True)
class History:
    """A film over time, n moments. displacement: (n, 2) over the clearance; force: (n, 2) N on the journal;
    probe_pressure: (n,) Pa absolute at the probe; gap_ratio: (n,) H there."""

    time_s: Array
    displacement: Array
    force: Array
    probe_pressure: Array
    gap_ratio: Array


@dataclass(frozen=True)
class Course:
    """What a moved film went through: its history, the field and loads at the moment of the largest force, cost, and
    why it ended early, or nothing."""

    history: History
    field: FilmField
    loads: Loads
    unknowns: int
    iterations: int
    problem: str


@dataclass(frozen=True)
class _Moment:
    time: float
    motion: Motion
    solution: VolumeSolution
    loads: Loads
    probe: float


def squeeze_path(eccentricity: float, frequency: float, omega: float) -> Path:
    """D_y = -C eps sin(2 pi f t) (4.47)."""
    rate = 2.0 * math.pi * frequency

    def path(t: float) -> Motion:
        y, v = -eccentricity * math.sin(rate * t), -eccentricity * rate * math.cos(rate * t)
        return Motion((0.0, y), (0.0, v), omega)

    return path


def whirl_path(eccentricity: float, frequency: float, omega: float) -> Path:
    """A circle (4.48) that is reached within some t_1 (4.49)."""
    rate = 2.0 * math.pi * frequency

    def path(t: float) -> Motion:
        fading = math.exp(-t / RISE_TIME)
        e, growth = eccentricity * (1.0 - fading), eccentricity * fading / RISE_TIME
        c, s = math.cos(rate * t), math.sin(rate * t)
        return Motion((e * c, e * s), (growth * c - e * rate * s, growth * s + e * rate * c), omega)

    return path


def film_course(case: Case, plan: KinematicPlan, path: Path, times: Array) -> Course:
    """The film along a path from a full one at times[0]. times: (n,) s, n at least 2.

    A film that does not converge ends the course with a problem; NotConverged is raised if that is at once.
    """
    film = _film(case, plan, path, times)
    moments, problem = [], ""
    try:
        for time, motion, solution in _solutions(case, plan, film, path, times):
            moments.append(_moment(case, plan, film, time, motion, solution))
    except NotConverged as failure:
        if not moments:
            raise
        problem = f"stopped at {moments[-1].time:.4g} s: {failure}"
    worst = max(moments, key=lambda moment: math.hypot(*moment.loads.force))
    return Course(
        history=_history(moments),
        field=film_field(film, worst.motion, worst.solution),
        loads=worst.loads,
        unknowns=int(np.count_nonzero(~film.grid.fixed)),
        iterations=sum(moment.solution.iterations for moment in moments),
        problem=problem,
    )


def _solutions(
    case: Case, plan: KinematicPlan, film: VolumeFilm, path: Path, times: Array
) -> Iterator[tuple[float, Motion, VolumeSolution]]:
    """Of each time after the first; in the middle of its step where the film has a state of its own."""
    if plan.remembers:
        yield from ((moment.time, moment.motion, moment.solution) for moment in march(film, path, times))
        return
    w = film.full()
    for time in times[1:]:
        motion = path(time)
        solution = _lawful(case, plan, film, motion).steady(motion, w)
        w = solution.w
        yield float(time), motion, solution


def _film(case: Case, plan: KinematicPlan, path: Path, times: Array) -> VolumeFilm:
    """Cells that serve every moment: equal ones around; half of them along where the section is half the film."""
    around, along = plan.cells
    along = along // 2 if plan.section.far == "symmetry" else along
    fastest = max((path(t) for t in times), key=lambda motion: motion.rate)
    grid = fitted_grid(plan.section, (0.0, 0.0), around, along)
    return VolumeFilm(plan.section, grid, make_law(case, plan, 0.0), reference_pressure(plan.section, fastest))


def _lawful(case: Case, plan: KinematicPlan, film: VolumeFilm, motion: Motion) -> VolumeFilm:
    """The film with the law of this moment: the penalty model's depends on the eccentricity."""
    if plan.cavitation != "penalty":
        return film
    return VolumeFilm(film.section, film.grid, make_law(case, plan, math.hypot(*motion.d)), film.scales.reference)


def _moment(
    case: Case, plan: KinematicPlan, film: VolumeFilm, time: float, motion: Motion, solution: VolumeSolution
) -> _Moment:
    found = loads(film, motion, solution, factor=case.film.cavitation_factor)
    if plan.modal:
        found = replace(found, force=modal_force(plan, motion, COARSE_MODAL_MESH))
    place = PROBE_WIDTH * plan.section.bearing_width / plan.section.width
    return _Moment(time, motion, solution, found, pressure_at(film_field(film, motion, solution), PROBE, place))


def _history(moments: list[_Moment]) -> History:
    motions = [moment.motion for moment in moments]
    return History(
        time_s=np.array([moment.time for moment in moments]),
        displacement=np.array([motion.d for motion in motions]),
        force=np.array([moment.loads.force for moment in moments]),
        probe_pressure=np.array([moment.probe for moment in moments]),
        gap_ratio=np.array([1.0 + motion.d[1] for motion in motions]),  # H (4.4) at phi = pi
    )
