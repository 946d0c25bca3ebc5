"""Limit cycles of a case over its speed: static equilibria, Hopf points, and the branches of cycles from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from frbcli.case.schema import Case
from frbcli.compilation import working_time
from frbcli.cycles.diagram import Observer, Walk, diagram, with_hopf_errors, with_response
from frbcli.cycles.family import check
from frbcli.cycles.heat import warm_courses
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import Changing, MachineCourse
from frbcli.cycles.method.cycle import HOPF
from frbcli.cycles.method.equilibria import at_rest, resting_along
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.method.mesh_error import OtherMesh, other_films, why_no_error
from frbcli.cycles.parts.machine import make_machine
from frbcli.cycles.result import LimitCycles, SpecialPoint, hertz
from frbcli.cycles.shooting.diagram import limit_cycles_by_shooting
from frbcli.cycles.unbalance.synchronous import Synchronous, synchronous_response
from frbcli.cycles.unbalance.whirls import of_no_whirl, whirls_with_unbalance
from frbcli.equilibrium.resting import RestingPosition, resting_position
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.linear.threshold import threshold_at
from frbcli.scene.gate.cycles import by_shooting
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.planning.planned import Plan
from frbcli.scene.remedies import advised


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
    """With a note on each speed at which there is no cycle."""
    met = {round(point.speed_Hz, 6) for branch in computed.branches for point in branch.points}
    missing = [f"No limit cycle at {speed:g} Hz." for speed in speeds_Hz if round(speed, 6) not in met]
    return replace(computed, notes=(*computed.notes, *missing))
