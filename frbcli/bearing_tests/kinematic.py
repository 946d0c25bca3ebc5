"""Kinematic bearing tests (section 4.2.2): the journal is moved as the case says, and the film answers.

A rotation under a load has its Stribeck curve: coefficient of friction of film and summits over the speed, from
boundary friction to the film alone. With heat the film is warm: the steady heat of a single film, at rest or as its
journal is moved.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.columns import moment_columns, result_columns
from frbcli.bearing_tests.history import History, mean_heat, squeeze_path, whirl_path
from frbcli.bearing_tests.steady_film import COARSE_CELLS, FilmField, film_moment
from frbcli.bearing_tests.tested_film import tested_film
from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, table_of
from frbcli.compiled import working_time
from frbcli.errors import NotConverged
from frbcli.film.cells.film import Motion, Path
from frbcli.film.cells.loads import FilmLoads
from frbcli.film.gap import friction_coefficient, sommerfeld_number
from frbcli.scene.films import displacement_of, slope_of, states_moment, tilt_of, tilt_rate_of
from frbcli.scene.gate.kinematic import tested_case
from frbcli.scene.machine.heat import heat_of, warm_case
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan, kinematic_plan, with_model
from frbcli.scene.supply import advised, film_advice
from frbcli.thermal.model import FilmHeat, SteadyHeat, steady_heat

RATIO, MOST = 10.0**0.2, 24  # of two speeds of a curve, and points on either side of the speed of the test
BOUNDARY = 0.9  # share of the summits in the load, from which on they carry it
FILM_ALONE = 10.0  # times the largest speed at which summits touch: the right end
Placed = Callable[[Case, KinematicPlan], Motion]
Dissipated = Callable[[Case, KinematicPlan], tuple[float, float]]  # power in W and side flow in m^3/s

COARSER = 8  # steps of a test for each one of the course of which means are taken, or with which they are begun
Observer = Callable[[int, int], None]

OK, NOT_CONVERGED = "ok", "not-converged"
FEWEST_TIMES = 8


@dataclass(frozen=True)
class StribeckCurve:
    """Numbers (n,) over the speed: speed in Hz, rising; friction_coefficient: |T| / (R F) of the torque on the journal;
    asperity_share: of the load that the summits carry."""

    speed: Array
    friction_coefficient: Array
    asperity_share: Array

    @property
    def least(self) -> tuple[float, float]:
        """The least coefficient of friction, and its speed in Hz."""
        k = int(np.argmin(self.friction_coefficient))
        return float(self.friction_coefficient[k]), float(self.speed[k])


class _Point(NamedTuple):
    speed: float
    friction: float
    share: float


def stribeck_curve(case: Case, plan: KinematicPlan) -> StribeckCurve | None:
    """The curve of a planned rotation; None without a load, a speed, rough surfaces or a known torque.

    Finite-volume films have COARSE_CELLS. It ends where a journal has no static equilibrium. Raises NotConverged if it
    has none at the speed of the test.
    """
    motion = case.motion
    if motion is None or motion.load is None or not motion.speed or not case.contact.rough:
        return None
    fast = replace(plan, cells=COARSE_CELLS) if plan.on_cells else plan
    point = partial(_point, case, fast, motion.load)
    down = _walk(point, [point(motion.speed)], 1.0 / RATIO, lambda points: points[-1].share > BOUNDARY)
    whole = _walk(point, down[::-1], RATIO, _film_alone)
    speed, friction, share = np.array(whole).T
    return StribeckCurve(np.abs(speed), friction, share)


def _film_alone(points: Sequence[_Point]) -> bool:
    """Whether the last speed is far above the speeds at which summits touch."""
    touching = [abs(each.speed) for each in points if each.share > 0.0] or [abs(points[0].speed)]
    return abs(points[-1].speed) > FILM_ALONE * max(touching)


def _walk(
    point: Callable[[float], _Point], begun: list[_Point], ratio: float, ends: Callable[[Sequence[_Point]], bool]
) -> list[_Point]:
    """Given points and further ones, at speeds that grow by a ratio, up to one that ends them."""
    points = list(begun)
    while len(points) < len(begun) + MOST and not ends(points):
        try:
            points.append(point(points[-1].speed * ratio))
        except NotConverged:
            break
    return points


def _point(case: Case, plan: KinematicPlan, load: float, speed: float) -> _Point:
    """The film under a load in N at a speed in Hz. Raises NotConverged."""
    film, omega, section = tested_film(plan), 2.0 * math.pi * speed, plan.section
    place = film.rest(case, plan, load, omega)
    x, y = place.tolist()
    torque = film.moment(case, plan, Motion((x, y), (0.0, 0.0), omega)).loads.torque.journal
    own = rubbing_of(case).force(section.clearance * place, np.zeros(2), omega).force
    return _Point(speed, friction_coefficient(torque, load, section.radius), 0.0 + float(own[1]) / load)


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
        leaving = heat.side_flow(np.array([flow]), viscosities, clearances)
        return FilmHeat(np.array([power]), leaving, np.array([omega]))

    steady = steady_heat(heat.model, ("",), solve, start, np.array([omega]))
    return WarmFilm(*at(steady.viscosities, steady.clearances), steady)


@dataclass(frozen=True)
class KinematicResult:
    """Result of one cavitation model.

    status: "ok" | "not-converged", then problem says why. displacement: (2,) over the clearance; loads, field: None if
    there is no solution; force_error,
    moment_error: estimated, relative to force and moment, NaN if not known, the latter of a rotation; history: None for
    a rotation. Of a squeeze or a whirl, displacement, loads, field and error are at the moment of the largest force;
    with a mass-conserving law the error is the worst of the largest forces of the periods. heat: of a case with heat,
    in a squeeze or whirl the mean over the last period; all else is at its viscosity and clearance, as in `plan`.
    stribeck: of a rotation under a load between rough surfaces.
    """

    cavitation: str
    status: str
    displacement: tuple[float, float]
    loads: FilmLoads | None
    sommerfeld_number: float
    force_error: float
    field: FilmField | None
    history: History | None
    cpu_s: float
    unknowns: int
    newton_iterations: int
    plan: KinematicPlan
    problem: str = ""
    heat: SteadyHeat | None = None
    moment_error: float = math.nan
    stribeck: StribeckCurve | None = None

    @property
    def theory(self) -> str:
        """ "finite" or "short"."""
        return self.plan.theory


@dataclass(frozen=True, repr=False)
class KinematicTest(Tabular):
    """A test, "rotation", "squeeze" or "whirl", with one result per cavitation model, in their order; complete: not
    interrupted before the last of them."""

    case: Case
    test: str
    results: tuple[KinematicResult, ...]
    complete: bool = True

    @property
    def carries_gas(self) -> bool:
        """Whether the oil of a model carries gas."""
        return any(result.loads is not None and result.loads.gas is not None for result in self.results)

    def table(self) -> Table:
        """One row per model for a rotation; for a squeeze or a whirl one per model and moment."""
        if self.test == "rotation":
            return table_of(result_columns(states_moment(self.case), self.carries_gas), self.results)
        moments = ((each, 1 if each.history is None else len(each.history.time_s)) for each in self.results)
        rows = ((result, moment) for result, count in moments for moment in range(count))
        return table_of(moment_columns(states_moment(self.case)), rows)


def rotation(
    case: Case, cavitations: Sequence[str] = (), observe: Observer | None = None
) -> KinematicTest:
    """Turn a journal at a displacement, or let it rest under a load.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`, with [motion].
    cavitations : sequence of str
        Cavitation models; an empty one means the model of the case.
    observe : callable, optional
        Called with the number of each moment of each model, and how many there are.

    Returns
    -------
    KinematicTest
        Forces in N and pressures in Pa by each model. A model that does not converge is a result with that status.
        Ctrl-C ends it with the models that are done, or is raised on if there are none.

    Raises
    ------
    InputError
        If the case does not fit.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.rotation(frbcli.load_case("bearing"))  # doctest: +SKIP
    """
    return _test(case, cavitations, "rotation", _rotation, observe)


def squeeze(
    case: Case, cavitations: Sequence[str] = (), observe: Observer | None = None
) -> KinematicTest:
    """Move a journal up and down (4.47) for the periods of the case.

    Parameters
    ----------
    case, cavitations, observe : as of `rotation`

    Returns
    -------
    KinematicTest
        Force in N over time by each model; otherwise as of `rotation`.

    Raises
    ------
    InputError
        As `rotation`.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.squeeze(frbcli.load_case("squeeze"))  # doctest: +SKIP
    """
    return _test(case, cavitations, "squeeze", _course, observe)


def whirl(
    case: Case, cavitations: Sequence[str] = (), observe: Observer | None = None
) -> KinematicTest:
    """Move a journal on a circle (4.48), (4.49) for the periods of the case.

    Parameters
    ----------
    case, cavitations, observe : as of `rotation`

    Returns
    -------
    KinematicTest
        Pressure in Pa over time by each model; otherwise as of `rotation`.

    Raises
    ------
    InputError
        As `rotation`.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.whirl(frbcli.load_case("whirl"))  # doctest: +SKIP
    """
    return _test(case, cavitations, "whirl", _course, observe)


Report = Callable[[int], None]


def _test(
    case: Case, cavitations: Sequence[str], test: str,
    solve: Callable[[Case, KinematicPlan, Report | None], KinematicResult], observe: Observer | None,
) -> KinematicTest:  # fmt: skip
    plans = [kinematic_plan(case, name, test) for name in dict.fromkeys(cavitations or (None,))]
    case = tested_case(case)
    results: list[KinematicResult] = []
    try:
        for number, plan in enumerate(plans):
            results.append(solve(case, plan, None if observe is None else _reporter(observe, number, plans, case)))
    except KeyboardInterrupt:
        if not results:
            raise
    return KinematicTest(case, test, tuple(results), len(results) == len(plans))


def _reporter(observe: Observer, done: int, plans: Sequence[KinematicPlan], case: Case) -> Report:
    """A function that observes the moments of one model, numbered on from the models before it."""
    counts = [_moment_count(case, plan) for plan in plans]
    before, whole = sum(counts[:done]), sum(counts)
    return lambda number: observe(before + number, whole)


def _moment_count(case: Case, plan: KinematicPlan) -> int:
    """Results of one model."""
    assert case.motion is not None
    return 1 if plan.test == "rotation" else max(round(case.motion.periods * plan.steps), FEWEST_TIMES)


def _rotation(case: Case, plan: KinematicPlan, report: Report | None) -> KinematicResult:
    assert case.motion is not None
    begun, displacement, warm = working_time().cpu_s, (math.nan, math.nan), None
    omega = 2.0 * math.pi * (case.motion.speed or 0.0)
    try:
        with advised(with_model(case, plan.cavitation)):
            if case.heat is not None:
                warm = warm_resting_film(case, plan, omega, lambda alike, its_plan: _lasting(alike, its_plan))
                case, plan = warm.case, warm.plan
        lasting = _lasting(case, plan)
        displacement = lasting.d
        with advised(with_model(case, plan.cavitation)):
            moment = tested_film(plan).moment(case, plan, lasting)
            stribeck = stribeck_curve(case, plan)
    except NotConverged as problem:
        return _failed(plan, displacement, begun, str(problem))
    if report is not None:
        report(1)
    return KinematicResult(
        cavitation=plan.cavitation,
        status=OK,
        displacement=displacement,
        loads=moment.loads,
        sommerfeld_number=_sommerfeld_number(plan, moment.loads, omega),
        force_error=moment.force_error,
        field=moment.field,
        history=None,
        cpu_s=working_time().cpu_s - begun,
        unknowns=moment.unknowns,
        newton_iterations=moment.iterations,
        plan=plan,
        heat=None if warm is None else warm.steady,
        moment_error=moment.moment_error,
        stribeck=stribeck,
    )


def _lasting(case: Case, plan: KinematicPlan) -> Motion:
    """The motion of a rotation, which lasts. Raises NotConverged."""
    motion = case.motion
    assert motion is not None
    omega = 2.0 * math.pi * (motion.speed or 0.0)
    if motion.load is not None:
        place = tested_film(plan).rest(case, plan, motion.load, omega)
        return Motion((float(place[0]), float(place[1])), (0.0, 0.0), omega)
    e, angle, section = motion.eccentricity or 0.0, motion.angle, plan.section
    along, across = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
    turn = e * 2.0 * math.pi * motion.whirl_speed
    rates = [motion.eccentricity_rate * a + turn * b for a, b in zip(along, across, strict=True)]
    if motion.velocity is not None:
        rates = [each / section.clearance for each in motion.velocity]
    slope, slope_rate = slope_of(tilt_of(case), section), slope_of(tilt_rate_of(case), section)
    return Motion(displacement_of(case), (rates[0], rates[1]), omega, slope, slope_rate)


def _course(case: Case, plan: KinematicPlan, report: Report | None) -> KinematicResult:
    assert case.motion is not None
    motion, begun, warm = case.motion, working_time().cpu_s, None
    assert motion.eccentricity is not None
    assert motion.frequency is not None
    omega = 2.0 * math.pi * (motion.speed or 0.0)
    make = squeeze_path if plan.test == "squeeze" else whirl_path
    path = make(motion.eccentricity, motion.frequency, omega)
    count = _moment_count(case, plan)
    times = np.linspace(0.0, motion.periods / motion.frequency, count + 1)
    try:
        with advised(with_model(case, plan.cavitation)):
            if case.heat is not None:
                warm = warm_moved_film(case, plan, omega, path, times)
                case, plan = warm.case, warm.plan
            course = tested_film(plan).course(case, plan, path, times, report)
    except NotConverged as problem:
        return _failed(plan, (math.nan, math.nan), begun, str(problem))
    worst = int(np.argmax(np.hypot(*course.history.force.T)))
    x, y = course.history.displacement[worst]
    return KinematicResult(
        cavitation=plan.cavitation,
        status=NOT_CONVERGED if course.problem else OK,
        displacement=(float(x), float(y)),
        loads=course.loads,
        sommerfeld_number=_sommerfeld_number(plan, course.loads, omega),
        force_error=course.force_error,
        field=course.field,
        history=course.history,
        cpu_s=working_time().cpu_s - begun,
        unknowns=course.unknowns,
        newton_iterations=course.iterations,
        plan=plan,
        problem=f"{course.problem}. {film_advice(with_model(case, plan.cavitation))}" if course.problem else "",
        heat=None if warm is None else warm.steady,
    )


def _failed(plan: KinematicPlan, displacement: tuple[float, float], begun: float, problem: str) -> KinematicResult:
    spent = working_time().cpu_s - begun
    nan = math.nan
    return KinematicResult(
        plan.cavitation, NOT_CONVERGED, displacement, None, nan, nan, None, None, spent, 0, 0, plan, problem
    )


def _sommerfeld_number(plan: KinematicPlan, loads: FilmLoads, omega: float) -> float:
    section = plan.section
    force, width = math.hypot(*loads.force), section.bearing_width
    return sommerfeld_number(force, width, section.radius, section.clearance, section.viscosity, omega)
