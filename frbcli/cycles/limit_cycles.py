"""Limit cycles of a case over its speed: resting positions, Hopf points, and the branches of cycles from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.compilation import working_time
from frbcli.cycles.diagram import Observer, Walk, diagram, over_speed, with_hopf_errors, with_response
from frbcli.cycles.family import check
from frbcli.cycles.heat import WarmFollower, warm_walk
from frbcli.cycles.method.changing import ChangingFollower, by_difference, kept
from frbcli.cycles.method.continuation import Place, Unreachable
from frbcli.cycles.method.cycle import HOPF
from frbcli.cycles.method.equilibria import (
    Equilibrium,
    OverSpeed,
    at_rest,
    equations,
    equilibrium,
    place_between,
    resting_along,
    resting_curve,
)
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.method.mesh_error import OtherMesh
from frbcli.cycles.parts.linearised import state_space
from frbcli.cycles.parts.machine import Machine, make_machine
from frbcli.cycles.parts.other_meshes import other_films, why_no_error
from frbcli.cycles.result import LimitCycles, SpecialPoint, hertz
from frbcli.cycles.shooting.diagram import limit_cycles_by_shooting
from frbcli.cycles.unbalance.branches import whirls_with_unbalance
from frbcli.cycles.unbalance.synchronous import Synchronous, synchronous_response
from frbcli.equilibrium.resting import resting_position
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
    """Compute resting positions, Hopf points and branches of limit cycles over the speed range of a case.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speeds_Hz : sequence of float
        Speeds in Hz at which cycles are computed exactly, of the kind "asked", for their orbits.
    observe : callable, optional
        Called with the number of cycles so far, and the speed in Hz and the largest eccentricity of the latest one.
    with_unbalance : bool
        Whether the whirls with the unbalance are computed as well.

    Returns
    -------
    LimitCycles
        The diagram, with stability and folds.

    Raises
    ------
    InputError
        If openings turn beside oil that a film keeps, without a speed range, for a speed outside of it, or
        with_unbalance for a case without unbalance.
    NotConverged
        Without a resting position at the highest speed.

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
        found = limit_cycles_by_shooting(case, slowest, fastest, asked, observe, with_unbalance)
        return _with_missing(found, speeds_Hz)
    plan = make_plan(case)
    system = make_system(case, plan)
    machine = make_machine(system, fastest)
    try:
        with advised(case):
            walk = _walk(case, plan, system, machine, slowest, fastest, asked)
    except Unreachable:
        raise NotConverged(f"The resting positions could not be followed down from {hertz(fastest):.4g} Hz.") from None
    found = _with_missing(diagram(case, walk, observe, lambda: working_time().cpu_s - begun), speeds_Hz)
    if case.heat is not None:
        found = with_hopf_errors(found, walk)
    elif found.of(HOPF):
        found = replace(found, special=_with_errors(case, fastest, found.special))
    warm = walk.follower if isinstance(walk.follower, WarmFollower) else None
    if with_unbalance:
        course = walk.course if warm is None else OverSpeed(machine)
        found = whirls_with_unbalance(found, course, observe, None if warm is None else warm.at_its_heat)
    unbalance = machine.rotor.unbalance_cos.any() or machine.rotor.unbalance_sin.any()
    if system.rotor.over_speed is not None or not (unbalance or machine.rotor.loads):
        return replace(found, cost=replace(found.cost, cpu_s=working_time().cpu_s - begun))
    driven = Synchronous(machine, slowest, fastest) if warm is None else warm.driven(slowest, fastest)
    response = synchronous_response(driven, walk.resting.points[-1])
    return with_response(found, walk, response, working_time().cpu_s - begun)


def _check_asked(case: Case, asked: Sequence[float], slowest: float, fastest: float) -> None:
    """Raises InputError for speeds in rad/s outside of the range of the diagram."""
    if outside := [speed for speed in asked if not slowest <= speed <= fastest]:
        problem = f"lies outside of the range, {hertz(slowest):.4g} to {hertz(fastest):.4g} Hz."
        remedy = "Ask for a speed within it, or set speed.from and speed.to."
        faults = tuple(Fault("speed", f"{hertz(speed):g} Hz", None, problem, remedy) for speed in outside)
        raise InputError(case.name or "case", faults)


def _walk(
    case: Case, plan: Plan, system: System, machine: Machine, slowest: float, fastest: float,
    asked: Sequence[float],
) -> Walk:  # fmt: skip
    """Resting positions and cycles between two speeds in rad/s. Raises Unreachable."""
    if case.heat is not None:
        return warm_walk(case, plan, system, slowest, fastest, asked)
    if system.rotor.over_speed is not None:
        return changing_walk(case, plan, system, slowest, fastest, asked)
    resting = resting_curve(system, machine, slowest, fastest)
    others = [(make_machine(other.system(case), fastest), other.share) for other in other_films(plan)]
    meshes = tuple(OtherMesh(OverSpeed(its), Follower(its, slowest, fastest), share) for its, share in others)
    follower = Follower(machine, slowest, fastest, asked)
    return over_speed(OverSpeed(machine), resting, follower, meshes, why_no_error(plan))


def _with_errors(case: Case, fastest: float, special: Sequence[SpecialPoint]) -> tuple[SpecialPoint, ...]:
    """Special points without heat, the Hopf points with their errors by the mesh of the films. fastest: rad/s."""
    machines = StaticMachines(case, None, hertz(fastest))
    return tuple(_with_error(machines, point) if point.kind == HOPF else point for point in special)


def _with_error(machines: StaticMachines, point: SpecialPoint) -> SpecialPoint:
    try:
        found = threshold_at(machines, point.speed_Hz, point.frequency_Hz)
    except NotConverged:
        return point
    return replace(
        point,
        value_uncertainty=found.speed_uncertainty_Hz,
        frequency_uncertainty_Hz=found.frequency_uncertainty_Hz,
    )


def _with_missing(found: LimitCycles, speeds_Hz: Sequence[float]) -> LimitCycles:
    """With a note on each speed at which there is no cycle."""
    met = {round(point.speed_Hz, 6) for branch in found.branches for point in branch.points}
    missing = [f"No limit cycle at {speed:g} Hz." for speed in speeds_Hz if round(speed, 6) not in met]
    return replace(found, notes=(*found.notes, *missing))


class ChangingSpeed:
    """The course of such a machine over the speed of its rotor in rad/s, see SpeedCourse. pace: its fastest speed."""

    def __init__(self, system: System, fastest: float) -> None:
        self.pace, self.system = fastest, system
        self.machine_at = kept(self._machine_at)

    def _machine_at(self, share: float) -> Machine:
        """The machine with the coefficients of a speed over the pace."""
        return make_machine(self.system_at(share * self.pace), self.pace)

    def system_at(self, value: float) -> System:
        """The system with the coefficients of a speed."""
        return replace(self.system, rotor=self.system.rotor.at(value))

    def machine(self, value: float) -> Machine:
        """As EquilibriumCourse says."""
        return self.machine_at(value / self.pace)

    def equations(self, y: Array) -> tuple[Array, Array]:
        """As SpeedCourse says."""
        return by_difference(self.machine_at, equations, y)

    def equilibrium(self, place: Place) -> Equilibrium:
        """As SpeedCourse says."""
        machine = self.machine_at(float(place.y[-1]))
        return equilibrium(machine, state_space(machine), place)

    def solved(self, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
        """As EquilibriumCourse says."""
        return replace(self.equilibrium(place_between(self, low, high, value)), omega=value, value=value)


def changing_walk(
    case: Case, plan: Plan, system: System, slowest: float, fastest: float, asked: Sequence[float] = ()
) -> Walk:
    """What the diagram of a rotor with such coefficients goes over, between two speeds in rad/s. Raises NotConverged
    without a resting position at the fastest one, and Unreachable."""
    course = ChangingSpeed(system, fastest)
    near = at_rest(course.machine_at(1.0), resting_position(course.system_at(fastest), fastest))
    resting = resting_along(course, near, slowest, fastest)
    others = [(ChangingSpeed(other.system(case), fastest), other.share) for other in other_films(plan)]
    meshes = tuple(OtherMesh(its, ChangingFollower(its.machine_at, slowest, fastest), share) for its, share in others)
    follower = ChangingFollower(course.machine_at, slowest, fastest, asked)
    return over_speed(course, resting, follower, meshes, why_no_error(plan))
