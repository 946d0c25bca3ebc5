"""Limit cycles of a rotor whose coefficients depend on its speed: a machine for each speed.

How the equations change with the coefficients is a central difference, as over a key (over_key.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from frbcli.cycles.branch import Follower
from frbcli.cycles.diagram import Walk
from frbcli.cycles.method.balance import Balance, unpacked
from frbcli.cycles.method.continuation import Equations, Place
from frbcli.cycles.method.equilibria import (
    Equilibrium,
    at_rest,
    equations,
    equilibrium,
    first_place,
    place_between,
    resting_along,
)
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine, make_machine
from frbcli.cycles.result import SPEED
from frbcli.equilibrium.resting import resting_position
from frbcli.scene.machine.system import System

Array = NDArray[np.float64]

DIFFERENCE = 1e-5  # of the speed over the pace
KEPT = 64  # machines


class ChangingRotor:
    """The machines of a system by the speed of the rotor over the pace, which is the fastest one in rad/s."""

    def __init__(self, system: System, fastest: float) -> None:
        self.pace = fastest
        self._system = system
        self._made: dict[float, Machine] = {}

    def machine(self, speed: float) -> Machine:
        """The machine with the coefficients of a speed over the pace."""
        if speed not in self._made:
            if len(self._made) >= KEPT:
                self._made.pop(next(iter(self._made)))
            here = replace(self._system, rotor=self._system.rotor.at(speed * self.pace))
            self._made[speed] = make_machine(here, self.pace)
        return self._made[speed]

    def asked(self, of: Callable[[Machine], Equations], y: Array) -> tuple[Array, Array]:
        """Residual and derivative at y, which ends in the speed over the pace. of: the equations of a machine, whose
        derivative by the speed is that with constant coefficients."""
        speed = float(y[-1])
        residual, slope = of(self.machine(speed))(y)
        ahead, behind = (of(self.machine(speed + sign * DIFFERENCE))(y)[0] for sign in (1.0, -1.0))
        slope[:, -1] += (ahead - behind) / (2.0 * DIFFERENCE)
        return residual, slope


class ChangingSpeed:
    """The course of such a machine over the speed of its rotor in rad/s, see SpeedCourse."""

    def __init__(self, rotor: ChangingRotor) -> None:
        self._rotor = rotor

    @property
    def pace(self) -> float:
        """As SpeedCourse says."""
        return self._rotor.pace

    def machine(self, value: float) -> Machine:
        """As EquilibriumCourse says."""
        return self._rotor.machine(value / self.pace)

    def equations(self, y: Array) -> tuple[Array, Array]:
        """As SpeedCourse says."""
        return self._rotor.asked(equations, y)

    def equilibrium(self, place: Place) -> Equilibrium:
        """As SpeedCourse says."""
        machine = self._rotor.machine(float(place.y[-1]))
        return equilibrium(machine, state_space(machine), place)

    def solved(self, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
        """As EquilibriumCourse says."""
        return replace(self.equilibrium(place_between(self, low, high, value)), omega=value, value=value)


class ChangingFollower(Follower):
    """Follows branches of such a machine over the speed."""

    def __init__(self, rotor: ChangingRotor, slowest: float, fastest: float, asked: Sequence[float] = ()) -> None:
        super().__init__(rotor.machine(1.0), slowest, fastest, asked)
        self._rotor = rotor

    def machine_at(self, y: Array) -> Machine:
        """The machine at the speed in which y ends."""
        return self._rotor.machine(float(y[-1]))

    def space_at(self, y: Array) -> StateSpace:
        """All states of that machine."""
        return state_space(self.machine_at(y))

    def equations(self, place: Place) -> Equations:
        """Those of the cycles about a place."""
        moving = place.y if self.moves(place.y) else place.tangent
        reference = unpacked(moving[:-2], self.machine.size)
        return lambda y: self._rotor.asked(lambda machine: Balance(machine, reference), y)


def changing_walk(system: System, slowest: float, fastest: float, asked: Sequence[float] = ()) -> Walk:
    """What the diagram of a rotor with such coefficients goes over, between two speeds in rad/s. Raises NotConverged
    without a resting position at the fastest one, and Unreachable."""
    rotor = ChangingRotor(system, fastest)
    course = ChangingSpeed(rotor)
    here = replace(system, rotor=system.rotor.at(fastest))
    start = first_place(course.equations, at_rest(rotor.machine(1.0), resting_position(here, fastest)), 1.0)
    return Walk(
        over=SPEED,
        unit="Hz",
        films=system.names,
        course=course,
        resting=resting_along(course, start, slowest, fastest),
        scale=0.5 / math.pi,
        follower=ChangingFollower(rotor, slowest, fastest, asked),
        branch_scale=rotor.pace / (2.0 * math.pi),
    )
