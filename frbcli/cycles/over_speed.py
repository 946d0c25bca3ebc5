"""Limit cycles of a rotor whose coefficients depend on its speed: a machine for each speed, see method/changing.py."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.cycles.diagram import Walk, over_speed
from frbcli.cycles.method.changing import ChangingFollower, by_difference, kept
from frbcli.cycles.method.continuation import Place
from frbcli.cycles.method.equilibria import (
    Equilibrium,
    at_rest,
    equations,
    equilibrium,
    place_between,
    resting_along,
)
from frbcli.cycles.method.mesh_error import OtherMesh
from frbcli.cycles.parts.linearised import state_space
from frbcli.cycles.parts.machine import Machine, make_machine
from frbcli.cycles.parts.other_meshes import other_films, why_no_error
from frbcli.equilibrium.resting import resting_position
from frbcli.scene.machine.system import System
from frbcli.scene.planning.planned import Plan


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
