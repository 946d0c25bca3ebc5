"""Limit cycles of a case over its speed, or over another number at one speed, such as a clearance or a viscosity:
static equilibria, Hopf points, and the branches of cycles from them; which cases have them, and the machines of a case
by one of its numbers.

Over another number the last unknown of branches is that number over its largest value. A machine is made for each
value, see method/equilibria.py.

What limit cycles say of other results: what causes the onset and the end of a whirl in a run, and whether the whirl
at a threshold begins softly or hard, and from which speed on a disturbance is enough for it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frbcli.case.reading.listing import machine_fault
from frbcli.case.schema import Case
from frbcli.compiled import working_time
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.columns import SUBCRITICAL, SUPERCRITICAL, LimitCycles, SpecialPoint, hertz
from frbcli.cycles.diagram import Observer, Walk, diagram, with_hopf_errors, with_response
from frbcli.cycles.heat import warm_courses
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.equilibria import (
    MOST_UNKNOWNS,
    Changing,
    MachineCourse,
    Resting,
    at_rest,
    hopf_points,
    lyapunov_coefficient,
    resting_along,
    resting_curve,
    settled,
)
from frbcli.cycles.method.follower import (
    FOLD,
    HOPF,
    Cycle,
    FoldFollower,
    Follower,
    OtherMesh,
    other_films,
    why_no_error,
)
from frbcli.cycles.method.machine import Machine, make_machine
from frbcli.cycles.shooting.diagram import limit_cycles_by_shooting
from frbcli.cycles.unbalance import Synchronous, of_no_whirl, synchronous_response, whirls_with_unbalance
from frbcli.equilibrium.resting import RestingPosition, resting_position
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import Fault, FrbError, InputError, NotConverged, input_error
from frbcli.linear.stability_point import threshold_at
from frbcli.scene.course import default_speeds
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import CYCLES, SPEED_CYCLES, WHIRLS
from frbcli.scene.gate.static import by_shooting
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.supply import advised
from frbcli.units import SpeedUnit

LONGEST_SHOWN = 40  # characters of a value in a fault
REMEDY = 'Write e.g. "40 um".'
NUMBER = re.compile(r"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)(.*)", re.DOTALL)
POINTS = 41  # static equilibria of the diagram


class Family(Changing):
    """The machines of a case at a speed in rad/s, by the value of a key over its largest one, `high` in `unit`;
    settings: of other keys, KEY=VALUE; mesh: number of another mesh of their films, see other_films."""

    most_at_fold = MOST_UNKNOWNS  # each of its equations takes three machines

    def __init__(
        self, case: Case, key: str, high: float, unit: str, omega: float, settings: tuple[str, ...] = (),
        mesh: int | None = None,
    ) -> None:  # fmt: skip
        super().__init__(self._made, omega)
        self.case, self.high, self.speed, self.settings, self.mesh = case, high, omega, settings, mesh
        self.over, self.unit = key, unit

    @property
    def scale(self) -> float:
        """See MachineCourse."""
        return self.high

    def setting(self, share: float) -> str:
        """KEY=VALUE of a share of the largest value."""
        return f"{self.over}={share * self.high!r} {self.unit}".strip()

    def with_setting(self, setting: str) -> Family:
        """The machines with another setting of another key."""
        return Family(self.case, self.over, self.high, self.unit, self.speed, (setting,))

    def on_mesh(self, mesh: int) -> Family:
        """The same machines with films on another mesh."""
        return Family(self.case, self.over, self.high, self.unit, self.speed, self.settings, mesh)

    def case_at(self, share: float) -> Case:
        """The case at a share of the largest value. Raises InputError if it cannot have it."""
        case = self.case.with_settings(*self.settings, self.setting(share))
        check(case)
        return case

    def system(self, share: float) -> System:
        """The system at a share of the largest value. Raises InputError if the case cannot have it."""
        case = self.case_at(share)
        plan = make_plan(case)
        return make_system(case, plan) if self.mesh is None else other_films(plan)[self.mesh].system(case)

    def _made(self, share: float) -> Machine:
        """The machine at a share. Raises Unreachable where the number is not above zero."""
        if not share > 0.0:
            raise Unreachable
        return make_machine(self.system(share), self.speed)


def value_range(case: Case, key: str, low: str, high: str) -> tuple[float, float, str]:
    """The ends of a range of a number of the machine, text with one unit, and that unit. Raises InputError."""
    if fault := machine_fault(key, "--parameter or --and"):
        raise InputError(case.name or "case", (fault,))
    (first, unit), (last, other) = _number(key, low), _number(key, high)
    if unit != other or not first < last:
        problem, remedy = "is no range of one unit.", f"Write e.g. {key}='40..90 um', not {low}..{high}."
        raise input_error(case.name or "case", key, f"{low} to {high}", problem, remedy)
    return first, last, unit


def positive_range(case: Case, key: str, low: str, high: str) -> tuple[float, float, str]:
    """value_range of a key that is followed, whose values are above zero. Raises InputError."""
    first, last, unit = value_range(case, key, low, high)
    if first <= 0.0:
        raise input_error(case.name or "case", key, low, "must be above 0 here.", "Begin above it.")
    return first, last, unit


def _number(key: str, text: str) -> tuple[float, str]:
    """A number and its unit."""
    match = NUMBER.fullmatch(text.strip())
    if match is None or not math.isfinite(float(match[1])):
        raise input_error(key, key, text[:LONGEST_SHOWN], "is no number with a unit.", REMEDY)
    return float(match[1]), match[2].strip()


def check(case: Case, shooting: bool = False, with_unbalance: bool = False) -> tuple[float, float]:
    """The range of speeds of a case in rad/s, the slowest above zero. shooting: whether cycles may be found by shooting
    on the time loop; with_unbalance: whether the whirls with it are asked for as well. Raises InputError."""
    require(case, WHIRLS if with_unbalance else SPEED_CYCLES if shooting else CYCLES)
    speeds = default_speeds(case)
    return 2.0 * math.pi * speeds[0], 2.0 * math.pi * speeds[-1]


def limit_cycles_over(
    case: Case, key: str, low: str, high: str, speed_Hz: float, observe: Observer | None = None
) -> LimitCycles:
    """Compute a diagram as `limit_cycles` does, over a key of the case at one rotor speed.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    key : str
        A number of the machine, such as "bearing.clearance".
    low, high : str
        Values between which it varies, with units, both above zero.
    speed_Hz : float
        Rotor speed in Hz.
    observe : callable, optional
        As of `limit_cycles`, with the value of the key.

    Returns
    -------
    LimitCycles
        The diagram.

    Raises
    ------
    InputError
        As `limit_cycles`, and for a key that is no number of the machine.
    NotConverged
        As `limit_cycles`.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.limit_cycles_over(case, "oil.viscosity", "8 mPa*s", "14 mPa*s", 200.0)  # doctest: +SKIP
    """
    begun = working_time().cpu_s
    check(case)
    first, last, unit = positive_range(case, key, low, high)
    family = Family(case, key, last, unit, 2.0 * math.pi * speed_Hz)
    try:
        resting = resting_over(family, first / last)
    except Unreachable:
        raise NotConverged(f"The static equilibria could not be followed over {key}.") from None
    plan, lowest = make_plan(family.case_at(1.0)), first / last
    meshes = tuple(
        OtherMesh(Follower(family.on_mesh(number), lowest), other.share)
        for number, other in enumerate(other_films(plan))
    )
    walk = Walk(resting, Follower(family, lowest), meshes, why_no_error(plan))
    computed = with_hopf_errors(diagram(case, walk, observe, lambda: working_time().cpu_s - begun), walk)
    return replace(computed, cost=replace(computed.cost, cpu_s=working_time().cpu_s - begun))


def resting_over(family: Family, lowest: float) -> Resting:
    """Static equilibria over the key, ascending, sought from the largest value on. Raises Unreachable, NotConverged."""
    with advised(family.case):
        near = at_rest(family.top, resting_position(family.system(1.0), family.speed))
    points = []
    for share in np.linspace(1.0, lowest, POINTS):
        points.append(settled(family, near, float(share)))
        near = points[-1].u
    points.reverse()
    return Resting(tuple(points), hopf_points(family, points), "")


def limit_cycles(
    case: Case,
    speeds_Hz: Sequence[float] = (),
    observe: Observer | None = None,
    with_unbalance: bool = False,
) -> LimitCycles:
    """Compute static equilibria, Hopf points and branches of limit cycles over the speed range of a case.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speeds_Hz : sequence of float
        Speeds in Hz at which cycles are computed exactly, of the kind "asked", for their orbits.
    observe : callable, optional
        Called with the number of cycles so far, and the speed in Hz and the largest eccentricity of the latest one.
    with_unbalance : bool
        Whether the whirls that lock in with the unbalance are computed as well.

    Returns
    -------
    LimitCycles
        The diagram, with stability and folds.

    Raises
    ------
    InputError
        If openings turn in a mass-conserving film, without a speed range, for a speed outside of it, or
        with_unbalance for a case without unbalance.
    NotConverged
        Without a static equilibrium at the highest speed.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.limit_cycles(case)  # doctest: +SKIP
    """
    begun = working_time().cpu_s
    slowest, fastest = check(case, True, with_unbalance)
    asked = [2.0 * math.pi * speed for speed in speeds_Hz]
    _check_asked(case, asked, slowest, fastest)
    if by_shooting(case):
        computed = limit_cycles_by_shooting(case, slowest, fastest, asked, observe, with_unbalance)
        return _with_missing(of_no_whirl(computed) if with_unbalance else computed, speeds_Hz)
    system = make_system(case, make_plan(case))
    try:
        with advised(case):
            walk = _walk(case, system, slowest / fastest, fastest, [speed / fastest for speed in asked])
    except Unreachable:
        raise NotConverged(f"The static equilibria could not be followed down from {hertz(fastest):.4g} Hz.") from None
    computed = _with_missing(diagram(case, walk, observe, lambda: working_time().cpu_s - begun), speeds_Hz)
    if case.heat is not None:
        computed = with_hopf_errors(computed, walk)
    elif computed.of(HOPF):
        computed = replace(computed, special=_with_errors(case, fastest, computed.special))
    if with_unbalance:
        computed = whirls_with_unbalance(computed, walk.course, observe)
    rotor = system.rotor
    if rotor.over_speed is None and (rotor.loads or rotor.unbalance_cos.any() or rotor.unbalance_sin.any()):
        response = synchronous_response(Synchronous(walk.course, slowest / fastest), walk.resting.points[-1])
        computed = with_response(computed, walk, response)
    computed = replace(computed, cost=replace(computed.cost, cpu_s=working_time().cpu_s - begun))
    return of_no_whirl(computed) if with_unbalance else computed


def _check_asked(case: Case, asked: Sequence[float], slowest: float, fastest: float) -> None:
    """Raises InputError for speeds in rad/s outside of the range of the diagram."""
    if outside := [speed for speed in asked if not slowest <= speed <= fastest]:
        problem = f"lies outside of the range, {hertz(slowest):.4g} to {hertz(fastest):.4g} Hz."
        remedy = "Ask for a speed within it, or set speed.from and speed.to."
        faults = tuple(Fault("speed", f"{hertz(speed):g} Hz", None, problem, remedy) for speed in outside)
        raise InputError(case.name or "case", faults)


def _walk(case: Case, system: System, lowest: float, fastest: float, asked: Sequence[float]) -> Walk:
    """Static equilibria and cycles up to a speed in rad/s; lowest, asked: speeds over it. Raises NotConverged without a
    static equilibrium there, and Unreachable."""
    plan = make_plan(case)
    course, position = _courses(case, plan, system, fastest)
    own = course(system)
    resting = resting_along(own, at_rest(own.top, position), lowest)
    meshes = tuple(OtherMesh(Follower(course(other.system(case)), lowest), other.share) for other in other_films(plan))
    return Walk(resting, Follower(own, lowest, asked=asked), meshes, why_no_error(plan))


def _courses(
    case: Case, plan: Plan, system: System, fastest: float
) -> tuple[Callable[[System], MachineCourse], RestingPosition]:
    """What makes the course over the speed of a system, the machine itself or that on films of another mesh, and the
    static equilibrium at the fastest speed in rad/s. Raises NotConverged without one."""
    if case.heat is not None:
        return warm_courses(case, plan, system, fastest)
    if system.rotor.over_speed is None:
        return lambda its: MachineCourse(make_machine(its, fastest)), resting_position(system, fastest)

    def at(its: System, share: float) -> System:
        return replace(its, rotor=its.rotor.at(share * fastest))

    def changing(its: System) -> MachineCourse:
        return Changing(lambda share: make_machine(at(its, share), fastest))

    return changing, resting_position(at(system, 1.0), fastest)


def _with_errors(case: Case, fastest: float, special: Sequence[SpecialPoint]) -> tuple[SpecialPoint, ...]:
    """Special points without heat, the Hopf points with their errors by the mesh of the films. fastest: rad/s."""
    machines = StaticMachines(case, None, hertz(fastest))
    return tuple(_with_error(machines, point) if point.kind == HOPF else point for point in special)


def _with_error(machines: StaticMachines, point: SpecialPoint) -> SpecialPoint:
    try:
        threshold = threshold_at(machines, point.speed_Hz, point.frequency_Hz)
    except NotConverged:
        return point
    return replace(
        point,
        value_uncertainty=threshold.speed_uncertainty_Hz,
        frequency_uncertainty_Hz=threshold.frequency_uncertainty_Hz,
    )


def _with_missing(computed: LimitCycles, speeds_Hz: Sequence[float]) -> LimitCycles:
    """With a note on each speed at which no cycle was found."""
    met = {round(point.speed_Hz, 6) for branch in computed.branches for point in branch.points}
    left = (speed for speed in speeds_Hz if round(speed, 6) not in met)
    missing = [f"No cycle of those that were followed is at {speed:g} Hz." for speed in left]
    return replace(computed, notes=(*computed.notes, *missing))


FREQUENCY_WEIGHT = 3.0  # of the frequency against the speed, where it is asked which point an event belongs to
AHEAD = 1.02  # an onset may be seen so much below its cause, by the resolution of events


def explanations(diagram: LimitCycles, events: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """A sentence for each onset and offset of a run's events that a point of the diagram explains."""
    sentences, unit = [], diagram.case.speed_unit
    for event in events:
        if event["kind"] not in ("onset", "offset"):
            continue
        seen = f"{event['kind'].capitalize()} at {unit.words(event['speed_Hz'], 1)}"
        starts = event["kind"] == "onset"
        causes = [point for point in diagram.special if point.kind in (HOPF, FOLD) and not point.synchronous]
        if starts:
            causes = [point for point in causes if point.speed_Hz <= AHEAD * event["speed_Hz"]]
        if not causes:
            sentences.append(f"{seen}: no Hopf point and no fold of the diagram without unbalance causes it.")
            continue
        cause = min(causes, key=lambda point: _distance(point, event))
        sentences.append(f"{seen}: {_sentence(cause, starts, event['speed_Hz'], unit)}")
    return tuple(sentences)


def _distance(point: SpecialPoint, event: Mapping[str, Any]) -> float:
    """How little a point fits to an event: logarithms of the ratios of their speeds and frequencies."""
    frequency = event["frequency_Hz"]
    off = abs(math.log(point.frequency_Hz / frequency)) if frequency else 0.0
    return FREQUENCY_WEIGHT * off + abs(math.log(point.speed_Hz / event["speed_Hz"]))


def _sentence(cause: SpecialPoint, starts: bool, speed_Hz: float, unit: SpeedUnit) -> str:
    where = f"{unit.words(cause.speed_Hz, 1)} ({cause.frequency_Hz:.1f} Hz)"
    off = unit.words(abs(speed_Hz - cause.speed_Hz), 1)
    if starts and cause.kind == HOPF:
        soft = {"supercritical": "soft ", "subcritical": "hard "}.get(cause.criticality or "", "")
        return f"a whirl grows at rest from the {soft}Hopf point at {where} on; it is seen {off} later."
    if starts:
        return f"stable cycles begin in the fold at {where}; a disturbance led there {off} above it."
    if cause.kind == HOPF:
        return f"the cycles shrink to rest in the Hopf point at {where}, {off} away."
    return f"the cycles end in the fold at {where}, {off} away."


SEARCH_RANGE = 0.03  # relative: range about the threshold in which its Hopf point is looked for


@dataclass(frozen=True)
class ThresholdKind:
    """criticality: "supercritical": a soft threshold, the whirl grows with the speed; "subcritical": a hard one, it
    jumps; fold_Hz: then from this speed on, below the threshold, there is a stable whirl that a disturbance leads to;
    None of a soft threshold, or if no fold was found."""

    criticality: str
    fold_Hz: float | None


def threshold_kind(case: Case, threshold_Hz: float) -> ThresholdKind | None:
    """What begins at the threshold in Hz of a case that is stable at rest below it; None where this is not known: for
    films whose force does not follow from the motion alone, or next to the change from one kind to the other."""
    try:
        slowest, fastest = check(case)
        system = make_system(case, make_plan(case))
        machine = make_machine(system, fastest)
        omega = 2.0 * math.pi * threshold_Hz
        near = resting_curve(system, machine, (1.0 - SEARCH_RANGE) * omega, (1.0 + SEARCH_RANGE) * omega)
    except (FrbError, Unreachable):
        return None
    if not near.hopf:
        return None
    hopf = min(near.hopf, key=lambda point: abs(point.equilibrium.omega - omega))
    sign = lyapunov_coefficient(hopf).sign
    if sign == 0:
        return None
    if sign < 0:
        return ThresholdKind(SUPERCRITICAL, None)
    folds: list[float] = []

    def watch(cycle: Cycle) -> bool:
        if cycle.kind == FOLD:
            folds.append(hertz(cycle.y[-1] * machine.pace))
        return bool(folds)

    follow_branch(FoldFollower(MachineCourse(machine), slowest / fastest), first_place(hopf), until=watch)
    return ThresholdKind(SUBCRITICAL, folds[0] if folds and folds[0] < threshold_Hz else None)
