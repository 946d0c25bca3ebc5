"""A film while its journal is moved: squeeze (4.47) and whirl (4.48), (4.49), moment by moment."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from frbcli.arrays import Array, Truths
from frbcli.bearing_tests.steady_film import (
    COARSE_MODAL_MESH,
    FilmField,
    film_field,
    leaving,
    modal_force,
    pressure_at,
    require_gap,
)
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cells.balance.boundaries import ALL, RESPONSE, supply_line
from frbcli.film.cells.film import (
    Motion,
    Path,
    VolumeFilm,
    VolumeSolution,
    fitted_grid,
    gap_on,
    path_seen_from,
    reference_pressure,
    supplied,
    supply_share,
    turned,
)
from frbcli.film.cells.gas.balance import Carried, KeptGas
from frbcli.film.cells.loads import FilmLoads, estimate, loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.tilted_film import land_paths, lands, summed
from frbcli.scene.films import slope_of, tilt_of
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan, law_at

RISE_TIME = 0.01  # s, t_1 of (4.49)
FAST = 1e6  # 1/s: oil that is replaced so fast has no time for an exchange of gas
MOST_HALVINGS = 6  # of a step whose equations do not converge
FilmAt = Callable[[float, Motion], VolumeFilm]
PROBE = math.pi  # phi of the probe and of the stated gap: the bottom of the bearing
PROBE_WIDTH = 0.25  # of the bearing's width from the end z = 0


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


@dataclass(frozen=True)
class Moment:
    """A film at a time in s: its motion and its solution."""

    time: float
    motion: Motion
    solution: VolumeSolution


def march(
    film: VolumeFilm, path: Path, times: Array, start: Array | None = None, film_at: FilmAt | None = None
) -> Iterator[Moment]:
    """The film for each of the times (n,) after the first, in s and rising; a generator, so that it may be left early.

    start: (m, k) unknown at the first time, else a full film at the ambient pressure; film_at: the film with its supply
    and law as they are at a time and a motion, else it stays the same. A step that does not converge is taken in
    halves. Raises NotConverged.

    A mass-conserving law stores oil as implicit Euler steps do, but lets it flow through the gap of the middle of the
    step, which makes the pressure of a full film second order; moments are then at that time. Other films follow from
    the motion of the moment. Openings whose supply is flow-limited are full at first; their filling stays
    during a step, as in runs.
    """
    steps = _Steps(film, path, film.full() if start is None else start, times, film_at)
    for time in times[1:]:
        yield steps.to(float(time), MOST_HALVINGS)


class _Steps:
    """The past that the next step needs."""

    def __init__(self, film: VolumeFilm, path: Path, w: Array, times: Array, film_at: FilmAt | None) -> None:
        time = float(times[0])
        self._film_at, self._path, self._solver = film_at, path, FilmSolver(film)
        self._w, self._time, self._content = w, time, film.content(path(time), w)
        self._gas: KeptGas | None = None  # H theta c, and what was carried last
        if film.law.carries_gas:
            free = film.law.free_gas(film.cells(w), film.scales)
            self._gas = KeptGas(self._content * free, Carried(free, np.full(w.shape, FAST)))
        self._drift: Array | None = None  # how fast w changed in the step before, and the gas that cells were given
        self._gas_drift: Array | float = 0.0
        self._line, self._filling = supply_line(film, max(RESPONSE, float(np.diff(times).max(initial=0.0)))), ALL

    def to(self, time: float, halvings: int) -> Moment:
        """One step to the time, or two of half its size."""
        try:
            return self._step(time)
        except NotConverged:
            if halvings == 0:
                raise
        self.to(0.5 * (self._time + time), halvings - 1)
        return self.to(time, halvings - 1)

    def _step(self, time: float) -> Moment:
        dt, end = time - self._time, self._path(time)
        if not self._solver.film.law.keeps_oil:
            solution = self._at(time, end).steady(end, self._w)
            self._w, self._time = solution.w, time
            return Moment(time, end, solution)
        middle = 0.5 * (self._time + time)
        flowing = self._path(middle)
        begin = self._w if self._drift is None else self._w + dt * self._drift
        solver = self._at(middle, flowing)
        kept, gas = None, self._gas
        if gas is not None:
            carried, turnover = gas.guess
            kept = KeptGas(gas.past / dt, Carried(carried + dt * self._gas_drift, turnover))
        if self._line.given > 0.0:
            solver.fill(self._filling)
        solution, content = solver.keep(end, flowing, begin, 1.0 / dt, self._content / dt, kept)
        if self._line.given > 0.0:
            solution = replace(solution, filling=self._filling)
            self._filling = self._line.filled(self._filling, solution.flows.supply, dt)
        if gas is not None and solution.gas is not None:
            self._gas = KeptGas(content * solution.gas.free, solution.gas.carried)
            self._gas_drift = (solution.gas.carried.gas - gas.guess.gas) / dt
        self._drift = (solution.w - self._w) / dt
        self._w, self._time, self._content = solution.w, time, content
        return Moment(middle, flowing, solution)

    def _at(self, time: float, motion: Motion) -> FilmSolver:
        film = self._solver.film if self._film_at is None else self._film_at(time, motion)
        if film is not self._solver.film:
            self._solver = FilmSolver(film)
        return self._solver


@dataclass(frozen=True)
class History:
    """A film over time, n moments. displacement: (n, 2) over the clearance; force: (n, 2) N on the journal;
    probe_pressure: (n,) Pa absolute at the probe; gap_ratio: (n,) H there; moment: (n, 2) N m of the force about the
    middle of the bearing, NaN where it is not known."""

    time_s: Array
    displacement: Array
    force: Array
    probe_pressure: Array
    gap_ratio: Array
    moment: Array


@dataclass(frozen=True)
class Course:
    """Result of a moved film: its history; field and loads at the moment of the
    largest force, and the estimated relative error of that force; cost; why it ended early, or nothing."""

    history: History
    field: FilmField
    loads: FilmLoads
    force_error: float
    unknowns: int
    iterations: int
    problem: str


@dataclass(frozen=True)
class MovedFilm:
    """A moved film at a time in s: displacement over the clearance, loads, pressure in Pa and gap at the probe, all in
    the lab; iterations of the step."""

    time: float
    displacement: tuple[float, float]
    loads: FilmLoads
    probe: float
    gap: float
    iterations: int

    @property
    def size(self) -> float:
        """The amount of the force in N."""
        return math.hypot(*self.loads.force)


Moved = TypeVar("Moved", bound=MovedFilm)


@dataclass(frozen=True)
class _Land:
    """A land of a moved film: its plan, cells that serve every moment, and the motion that it sees."""

    plan: KinematicPlan
    film: VolumeFilm
    path: Path


@dataclass(frozen=True)
class _MovingFilm:
    """A film whose journal moves along a path, seen from the surface that the supply is in, as its lands. mirrored: see
    land_paths."""

    plan: KinematicPlan
    path: Path
    mirrored: bool
    lands: tuple[_Land, ...]


@dataclass(frozen=True)
class _Moment(MovedFilm):
    """on_lands: what each of the lands sees, and its solution."""

    on_lands: tuple[Moment, ...]


def film_course(
    case: Case, plan: KinematicPlan, path: Path, times: Array, observe: Callable[[int], None] | None = None
) -> Course:
    """The film along a path from a full one at times[0]. times: (n,) s, n at least 2; observe: called with the number
    of each moment, from 1 on.

    A film that does not converge ends the course with a problem; NotConverged is raised if that is at once.
    """
    film = _moving(case, plan, path, times)
    moments, problem = _moments(case, film, times, observe)
    worst = max(moments, key=lambda moment: moment.size)
    if plan.remembers:
        error, spent = _error_of_course(case, plan, path, times[: len(moments) + 1], moments)
    else:
        error, spent = _error_of_moment(case, plan, path, times, worst)
    fixed = np.concatenate([land.film.grid.fixed for land in film.lands])
    return course_of(moments, worst, _field(film, worst), error, fixed, spent, problem)


def course_of(
    moments: Sequence[MovedFilm], worst: MovedFilm, field: FilmField, error: float, fixed: Truths,
    spent: int, problem: str,
) -> Course:  # fmt: skip
    """The course of a film. worst: its moment of the largest force; fixed: where pressures are given; spent: iterations
    for the error."""
    return Course(
        history=history_of(moments),
        field=field,
        loads=worst.loads,
        force_error=error,
        unknowns=int(np.count_nonzero(~fixed)),
        iterations=spent + sum(moment.iterations for moment in moments),
        problem=problem,
    )


def _moments(
    case: Case, film: _MovingFilm, times: Array, observe: Callable[[int], None] | None = None
) -> tuple[list[_Moment], str]:  # fmt: skip
    return collected((_moment(case, film, moments) for moments in _marches(case, film, times)), observe)


def _marches(case: Case, film: _MovingFilm, times: Array) -> Iterator[tuple[Moment, ...]]:
    """The moments of all lands, time by time."""
    marches = [march(each.film, each.path, times, film_at=_film_at(case, each.plan, each.film)) for each in film.lands]
    return zip(*marches, strict=True)


def collected(course: Iterator[Moved], observe: Callable[[int], None] | None = None) -> tuple[list[Moved], str]:
    """The moments until the film does not converge, and why it does not. Raises NotConverged if there are none."""
    moments: list[Moved] = []
    try:
        for moment in course:
            moments.append(moment)
            if observe is not None:
                observe(len(moments))
    except NotConverged as failure:
        if not moments:
            raise
        return moments, f"stopped at {moments[-1].time:.4g} s: {failure}"
    return moments, ""


def mean_heat(case: Case, plan: KinematicPlan, path: Path, times: Array) -> tuple[float, float]:
    """Power in W that a film dissipates and flow in m^3/s out of its open ends, averaged over the last period.

    As film_course. The power is -M_J omega - F . v of the journal in the lab. Raises NotConverged.
    """
    assert case.motion is not None
    assert case.motion.frequency is not None
    period = 1.0 / case.motion.frequency
    begin = times[-1] - period * (1.0 + 1e-9)
    film = _moving(case, plan, path, times)
    passed = times if plan.remembers else times[times >= begin]
    powers, flows = [], []
    for moments in _marches(case, film, passed):
        if moments[0].time > begin:
            film_loads, motion = _moment(case, film, moments).loads, path(moments[0].time)
            push = plan.section.clearance * float(np.dot(film_loads.force, motion.v))
            powers.append(-film_loads.torque.journal * motion.omega - push)
            pairs = zip(film.lands, moments, strict=True)
            flows.append(sum(leaving(land.film, moment.motion, moment.solution) for land, moment in pairs))
    return float(np.mean(powers)), float(np.mean(flows))


def _error_of_course(
    case: Case, plan: KinematicPlan, path: Path, times: Array, moments: list[_Moment]
) -> tuple[float, int]:
    """The largest error of the periods' largest forces over the largest of all, from the same course on half the cells
    each way in half the steps, NaN if that does not converge; and the iterations that it took."""
    coarser = _coarser(plan)
    film = _moving(case, coarser, path, times)
    try:
        coarse, problem = _moments(case, film, np.append(times[:-1:2], times[-1]))
    except NotConverged:
        return math.nan, 0
    spent = sum(moment.iterations for moment in coarse)
    return math.nan if problem else peak_error(case, times, moments, coarse), spent


def peak_error(case: Case, times: Array, moments: Sequence[MovedFilm], coarse: Sequence[MovedFilm]) -> float:
    """The largest error of the periods' largest forces over the largest of all, from a course of half the resolution:
    of first order, as Euler's steps of the oil are."""
    fine_peaks, coarse_peaks = _peaks(case, times, moments), _peaks(case, times, coarse)
    largest = max(fine_peaks.values())
    worst = max(abs(peak - coarse_peaks[n]) for n, peak in fine_peaks.items() if n in coarse_peaks)
    return worst / largest if largest > 0.0 else math.nan


def _error_of_moment(case: Case, plan: KinematicPlan, path: Path, times: Array, worst: _Moment) -> tuple[float, int]:
    """Error of the largest force of a film without a state: from a mesh twice as coarse or, if modal, twice as fine."""
    force, at, rubbing = worst.loads.force, worst.on_lands[0].motion, rubbing_of(case)

    def with_summits(alone: tuple[float, float]) -> tuple[float, float]:
        return rubbing.loads(replace(worst.loads, force=alone), at, plan.turning).force

    if plan.modal:
        finer = with_summits(modal_force(plan, at))
        return (math.dist(finer, force) / math.hypot(*finer) if any(finer) else math.nan), 0
    coarse, iterations = np.zeros(2), 0
    try:
        for land, moment in zip(_moving(case, _coarser(plan), path, times).lands, worst.on_lands, strict=True):
            film = _film_at(case, land.plan, land.film)(worst.time, moment.motion)
            solution = FilmSolver(film).steady(moment.motion)
            coarse += loads(land.film, moment.motion, solution).force
            iterations += solution.iterations
    except NotConverged:
        return math.nan, 0
    coarser = turned(with_summits((float(coarse[0]), float(coarse[1]))), plan.turning * worst.time)
    return estimate(force, coarser, plan.law.order), iterations


def _coarser(plan: KinematicPlan) -> KinematicPlan:
    around, along = plan.cells
    return replace(plan, cells=(around // 2, max(along // 2, 2)))


def _peaks(case: Case, times: Array, moments: Sequence[MovedFilm]) -> dict[int, float]:
    """The largest force in N of each period."""
    assert case.motion is not None
    assert case.motion.frequency is not None
    peaks: dict[int, float] = {}
    for moment in moments:
        period = math.floor((moment.time - times[0]) * case.motion.frequency)
        peaks[period] = max(peaks.get(period, 0.0), moment.size)
    return peaks


def _moving(case: Case, plan: KinematicPlan, path: Path, times: Array) -> _MovingFilm:
    """The film of a journal that moves along a path of the lab. Raises NotConverged where it touches an end."""
    slope = slope_of(tilt_of(case), plan.section)

    def inclined(time: float) -> Motion:
        return replace(path(time), slope=slope)

    for time in times if inclined(0.0).tilts else ():
        require_gap(plan.section, inclined(time))
    seen, mirrored = path_seen_from(inclined, plan.turning), case.bearings[0].films[0].supply.mirrored
    parts = [(replace(plan, section=section), its) for section, its in land_paths(plan.section, seen, mirrored)]
    own = tuple(_Land(its_plan, _film(case, its_plan, its_path, times), its_path) for its_plan, its_path in parts)
    return _MovingFilm(plan, seen, mirrored, own)


def _film(case: Case, plan: KinematicPlan, path: Path, times: Array) -> VolumeFilm:
    """Cells that serve every moment: equal ones around; half of them along where the section is half the film."""
    around, along = plan.cells
    along = along // 2 if plan.section.far == "symmetry" else along
    fastest = max((path(t) for t in times), key=lambda motion: motion.rate)
    grid = fitted_grid(plan.section, (0.0, 0.0), around, along, fastest.tilts)
    return VolumeFilm(plan.section, grid, law_at(case, plan, 0.0), reference_pressure(plan.section, fastest))


def _film_at(case: Case, plan: KinematicPlan, film: VolumeFilm) -> FilmAt:
    """The film with supply and law of a moment: the law of the penalty model follows the eccentricity."""

    def film_at(time: float, motion: Motion) -> VolumeFilm:
        fed = supplied(film, supply_share(time, plan.ramp)) if plan.ramp else film
        law = film.law if plan.remembers else law_at(case, plan, math.hypot(*motion.d))
        return fed if law == film.law else VolumeFilm(fed.section, fed.grid, law, fed.scales.reference)

    return film_at


def _moment(case: Case, film: _MovingFilm, moments: tuple[Moment, ...]) -> _Moment:
    plan, first, time = film.plan, film.lands[0], moments[0].time
    motion, angle = film.path(time), plan.turning * time
    slip, factor = motion.omega + 2.0 * plan.turning, case.film.cavitation_factor
    parts = lands(plan.section, motion, film.mirrored)
    each = [
        loads(land.film, moment.motion, moment.solution, slip, factor)
        for land, moment in zip(film.lands, moments, strict=True)
    ]
    film_loads = summed(list(zip(parts, each, strict=True)))
    if plan.modal:  # then nothing turns
        film_loads = replace(film_loads, force=modal_force(plan, motion, COARSE_MODAL_MESH))
    film_loads = rubbing_of(case).loads(film_loads, motion, plan.turning)
    film_loads = replace(film_loads, force=turned(film_loads.force, angle), moment=turned(film_loads.moment, angle))
    place = PROBE_WIDTH * plan.section.bearing_width / plan.section.width
    probe = pressure_at(film_field(first.film, moments[0].motion, moments[0].solution), PROBE - angle, place)
    gap = float(gap_on(plan.section, moments[0].motion, np.array([PROBE - angle]), np.array([place]))[0, 0])
    iterations = sum(moment.solution.iterations for moment in moments)
    return _Moment(time, turned(motion.d, angle), film_loads, probe, gap, iterations, moments)


def _field(film: _MovingFilm, moment: _Moment) -> FilmField:
    """The field in the frame of the lab."""
    first = moment.on_lands[0]
    field = film_field(film.lands[0].film, first.motion, first.solution)
    return replace(field, phi=field.phi + film.plan.turning * moment.time)


def history_of(moments: Sequence[MovedFilm]) -> History:
    """The history of a moved film from its moments, as arrays along them."""
    return History(
        time_s=np.array([moment.time for moment in moments]),
        displacement=np.array([moment.displacement for moment in moments]),
        force=np.array([moment.loads.force for moment in moments]),
        probe_pressure=np.array([moment.probe for moment in moments]),
        gap_ratio=np.array([moment.gap for moment in moments]),
        moment=np.array([moment.loads.moment for moment in moments]),
    )
