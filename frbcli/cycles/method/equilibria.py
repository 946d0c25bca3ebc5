"""Resting positions over the speed as a curve, the eigenvalues there, and the Hopf points where a whirl is born.

As in frbcli/linear, but with the rings' speeds as unknowns of their own, and as states that the whirl moves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Strides,
    follow,
    oriented,
    reached,
    unit_vector,
)
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine, film_loads, transfer
from frbcli.equilibrium import hopf
from frbcli.equilibrium.resting import RestingPosition, resting_position
from frbcli.rotor.order import first_largest
from frbcli.scene.machine.system import System

STRIDES = Strides(first=0.01, shortest=1e-7, longest=0.04, points=2000)
SHARP = 1e-12  # relative tolerance of the speed at a Hopf point


@dataclass(frozen=True)
class Equilibrium:
    """A resting position. u: (c,) see machine.py; omega: speed of the rotor, rad/s; eigenvalues: (N,) 1/s; value: of
    the number that the curve goes over, omega itself or another one."""

    u: Array
    omega: float
    eigenvalues: Complex
    value: float

    @property
    def stable(self) -> bool:
        """Whether every motion decays."""
        return bool(np.all(self.eigenvalues.real < 0.0))

    def growth_of(self, number: int) -> float:
        """Growth in 1/s of the whirl number 0, 1, ... by falling growth, -inf if there are not as many."""
        return hopf.growth_of(self.eigenvalues, number)


@dataclass(frozen=True)
class HopfPoint:
    """Where an oscillating pair crosses: the equilibrium; nu: frequency, rad/s; mode: (c,) its u, the largest
    displacement of a journal being 1; rising: whether it grows above this speed; state: (N,) the right eigenvector of
    this size."""

    equilibrium: Equilibrium
    nu: float
    mode: Complex
    rising: bool
    state: Complex


class EquilibriumCourse(Protocol):
    """What resting positions are followed over."""

    def machine(self, value: float) -> Machine:
        """The machine at a value of the number."""

    def solved(self, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
        """The resting position at a value between two. Raises Unreachable."""


class SpeedCourse(EquilibriumCourse, Protocol):
    """What resting positions are followed over, if it is the speed of the rotor in rad/s."""

    @property
    def pace(self) -> float:
        """The unit of speeds of its machines, rad/s."""

    def equations(self, y: Array) -> tuple[Array, Array]:
        """Those of a resting position y = (u, Omega / pace), see continuation.py."""

    def equilibrium(self, place: Place) -> Equilibrium:
        """The resting position at a place of their curve."""


@dataclass(frozen=True)
class OverSpeed:
    """The course of one machine over the speed of the rotor in rad/s."""

    only: Machine

    @property
    def pace(self) -> float:
        """As SpeedCourse says."""
        return self.only.pace

    @cached_property
    def _space(self) -> StateSpace:
        return state_space(self.only)

    @cached_property
    def equations(self) -> Equations:
        """As SpeedCourse says."""
        return equations(self.only)

    def equilibrium(self, place: Place) -> Equilibrium:
        """As SpeedCourse says."""
        return equilibrium(self.only, self._space, place)

    def machine(self, _value: float) -> Machine:
        """The machine, which is the same at each speed."""
        return self.only

    def solved(self, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
        """As EquilibriumCourse says."""
        return settled(self.only, between(low, high, value), value, value)


@dataclass(frozen=True)
class Resting:
    """The curve of resting positions, ascending in speed; its Hopf points; why it ends before the slowest speed."""

    points: tuple[Equilibrium, ...]
    hopf: tuple[HopfPoint, ...]
    note: str


def equations(machine: Machine) -> Equations:
    """Equations of a resting position y = (u, Omega / pace), see continuation.py."""
    passing = transfer(machine, np.zeros(1), machine.pace)  # at rest nothing depends on the speed but the films
    through, kappa = passing.values[0].real, passing.kappa[0].real

    def at(y: Array) -> tuple[Array, Array]:
        u = y[:-1]
        loads = film_loads(machine, u[None], np.zeros((1, len(u))), float(y[-1] * machine.pace))
        residual = u - through @ (loads.values[0] + kappa * u) - machine.rest
        slope = np.eye(len(u)) - through @ (loads.by_u[0] + np.diag(kappa))
        return residual, np.column_stack([slope, -machine.pace * through @ loads.by_speed[0]])

    return at


def resting_curve(system: System, machine: Machine, slowest: float, fastest: float) -> Resting:
    """Resting positions between two speeds in rad/s, from the fastest on downwards. Raises NotConverged without one."""
    return resting_along(OverSpeed(machine), at_rest(machine, resting_position(system, fastest)), slowest, fastest)


def resting_along(course: SpeedCourse, near: Array, slowest: float, fastest: float) -> Resting:
    """Resting positions along a course of the speed; near: (c,) u near to the one at the fastest speed. Raises
    Unreachable."""
    places = [first_place(course.equations, near, fastest / course.pace)]
    for place, _ in follow(course.equations, places[0], STRIDES):
        places.append(place)
        if not slowest < place.y[-1] * course.pace < 1.000001 * fastest:
            break
    note = ""
    if places[-1].y[-1] * course.pace <= slowest < places[-2].y[-1] * course.pace:
        places[-1] = at_speed(course.equations, places[-2], slowest / course.pace)
    else:
        lost = places[-1].y[-1] * course.pace / (2.0 * math.pi)
        note = f"The resting positions could not be followed below {lost:.4g} Hz."
    points = tuple(course.equilibrium(place) for place in reversed(places))
    return Resting(points, hopf_points(course, points), note)


def first_place(ask: Equations, near: Array, speed: float) -> Place:
    """The resting position near to u (c,) at a speed over the pace, as a place of the curve that goes down in speed.
    Raises Unreachable."""
    guess = np.append(near, speed)
    along = -unit_vector(len(guess))
    return oriented(reached(ask, guess, along), along)


def at_rest(machine: Machine, position: RestingPosition) -> Array:
    """(c,) u of a resting position, see machine.py."""
    places = machine.places @ position.displacements[: machine.rotor.size]
    return np.concatenate([places, position.ring_speeds / machine.pace])


def between(low: Equilibrium, high: Equilibrium, value: float) -> Array:
    """(c,) u on the straight line between two resting positions."""
    share = (value - low.value) / (high.value - low.value)
    return np.asarray(low.u + share * (high.u - low.u))


def place_between(course: SpeedCourse, low: Equilibrium, high: Equilibrium, value: float) -> Place:
    """The place of the resting position at a speed in rad/s between two. Raises Unreachable."""
    guess = np.append(between(low, high, value), value / course.pace)
    return reached(course.equations, guess, unit_vector(len(guess)))


def at_speed(ask: Equations, near: Place, speed: float) -> Place:
    """The place at a speed over the pace. Raises Unreachable."""
    guess = near.y + (speed - near.y[-1]) / near.tangent[-1] * near.tangent
    guess[-1] = speed
    return oriented(reached(ask, guess, unit_vector(len(guess))), near.tangent)


def equilibrium(machine: Machine, space: StateSpace, place: Place) -> Equilibrium:
    """The resting position of a machine at a place of its curve. space: its states."""
    u, omega = place.y[:-1], float(place.y[-1] * machine.pace)
    loads = film_loads(machine, u[None], np.zeros((1, len(u))), omega)
    values = np.linalg.eigvals(space.matrix(omega, loads.by_u[0], loads.by_v[0])).astype(complex)
    return Equilibrium(u, omega, values, omega)


def hopf_points(course: EquilibriumCourse, points: Sequence[Equilibrium]) -> tuple[HopfPoint, ...]:
    """The Hopf points between resting positions in the order of their course."""
    found = hopf.hopf_points(course.solved, points, SHARP)
    return tuple(hopf_at(course.machine(each.here.value), each.here, each.rising) for each in found)


def settled(machine: Machine, near: Array, omega: float, value: float) -> Equilibrium:
    """The resting position of a machine at a speed in rad/s near to u. Raises Unreachable."""
    guess = np.append(near, omega / machine.pace)
    found = reached(equations(machine), guess, unit_vector(len(guess)))
    return replace(equilibrium(machine, state_space(machine), found), value=value)


def hopf_at(machine: Machine, here: Equilibrium, rising: bool, nu: float | None = None) -> HopfPoint:
    """The Hopf point of an equilibrium. nu: about its frequency in rad/s, else the pair is taken that is nearest to the
    imaginary axis."""
    space = state_space(machine)
    loads = film_loads(machine, here.u[None], np.zeros((1, len(here.u))), here.omega)
    values, vectors = np.linalg.eig(space.matrix(here.omega, loads.by_u[0], loads.by_v[0]))
    oscillating = np.flatnonzero(hopf.oscillating(values))
    off = values[oscillating].real if nu is None else values[oscillating] - 1j * nu
    own = oscillating[np.argmin(np.abs(off))]
    state = vectors[:, own].astype(complex)
    mode = space.read @ state
    unit = mode[first_largest(mode[: 2 * machine.film_count])]
    return HopfPoint(here, float(values[own].imag), mode / unit, rising, state / unit)
