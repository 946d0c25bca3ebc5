"""Resting positions over the speed as a curve, the eigenvalues there, and the Hopf points where a whirl is born.

As in frbcli/linear, but with the rings' speeds as unknowns of their own, and as states that the whirl moves.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from frbcli.cycles.method.continuation import Place, Strides, Unreachable, corrected, follow, oriented, unit_vector
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine, film_loads, transfer
from frbcli.equilibrium.resting import resting_position, ring_speeds
from frbcli.rotor.held import held_rotor
from frbcli.rotor.order import first_largest
from frbcli.scene.machine.system import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

OSCILLATING = 1e-9  # imaginary part over absolute value from which an eigenvalue oscillates
STRIDES = Strides(first=0.01, shortest=1e-7, longest=0.04, points=2000)
SHARP = 1e-12  # relative tolerance of the speed at a Hopf point
HALVINGS = 30  # of an interval of speeds with several Hopf points


@dataclass(frozen=True)
class Equilibrium:
    """A resting position. u: (c,) see machine.py; omega: speed of the rotor, rad/s; eigenvalues: (N,) 1/s; value: of
    the number that the curve goes over, omega itself or another one."""

    u: Array
    omega: float
    eigenvalues: Complex
    value: float

    @property
    def unstable(self) -> int:
        """Number of oscillating pairs that grow."""
        return int(np.count_nonzero((self.eigenvalues.real > 0.0) & self._oscillating))

    @property
    def stable(self) -> bool:
        """Whether every motion decays."""
        return bool(np.all(self.eigenvalues.real < 0.0))

    def growth(self, number: int) -> float:
        """Real part of the oscillating eigenvalue number 0, 1, ... in falling order of the real parts."""
        real = np.sort(self.eigenvalues.real[self._oscillating])[::-1]
        return float(real[number]) if number < len(real) else -math.inf

    @property
    def _oscillating(self) -> NDArray[np.bool_]:
        return np.asarray(self.eigenvalues.imag > OSCILLATING * np.abs(self.eigenvalues))


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


@dataclass(frozen=True)
class OverSpeed:
    """The course over the speed of the rotor in rad/s."""

    only: Machine

    def machine(self, _value: float) -> Machine:
        """The same at each speed."""
        return self.only

    def solved(self, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
        """As Course says."""
        share = (value - low.value) / (high.value - low.value)
        return settled(self.only, low.u + share * (high.u - low.u), value, value)


@dataclass(frozen=True)
class Resting:
    """The curve of resting positions, ascending in speed; its Hopf points; why it ends before the slowest speed."""

    points: tuple[Equilibrium, ...]
    hopf: tuple[HopfPoint, ...]
    note: str


def equations(machine: Machine) -> Callable[[Array], tuple[Array, Array]]:
    """Those of a resting position y = (u, Omega / pace), see continuation.py."""
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
    ask = equations(machine)
    start = first_place(system, machine, ask, fastest)
    places = [start]
    for place, _ in follow(ask, start, STRIDES):
        places.append(place)
        if not slowest < place.y[-1] * machine.pace < 1.000001 * fastest:
            break
    note = ""
    if places[-1].y[-1] * machine.pace <= slowest < places[-2].y[-1] * machine.pace:
        places[-1] = at_speed(ask, places[-2], slowest / machine.pace)
    else:
        lost = places[-1].y[-1] * machine.pace / (2.0 * math.pi)
        note = f"The resting positions could not be followed below {lost:.4g} Hz."
    space = state_space(machine)
    points = tuple(_equilibrium(machine, space, place) for place in reversed(places))
    return Resting(points, hopf_points(OverSpeed(machine), points), note)


def first_place(system: System, machine: Machine, ask: Callable[[Array], tuple[Array, Array]], omega: float) -> Place:
    """The resting position at omega rad/s as a place of the curve that goes down in speed."""
    resting = resting_position(system, omega)
    journals = system.rotor.journals @ resting
    turning = ring_speeds(system, held_rotor(system.rotor, omega), omega, journals)
    places = machine.places @ resting[: machine.rotor.size]
    guess = np.concatenate([places, turning / machine.pace, [omega / machine.pace]])
    along = -unit_vector(len(guess))
    found = corrected(ask, guess, along)
    if found is None:
        raise Unreachable
    return oriented(found, along)


def at_speed(ask: Callable[[Array], tuple[Array, Array]], near: Place, speed: float) -> Place:
    """The place at a speed over the pace. Raises Unreachable."""
    guess = near.y + (speed - near.y[-1]) / near.tangent[-1] * near.tangent
    guess[-1] = speed
    found = corrected(ask, guess, unit_vector(len(guess)))
    if found is None:
        raise Unreachable
    return oriented(found, near.tangent)


def _equilibrium(machine: Machine, space: StateSpace, place: Place) -> Equilibrium:
    u, omega = place.y[:-1], float(place.y[-1] * machine.pace)
    loads = film_loads(machine, u[None], np.zeros((1, len(u))), omega)
    values = np.linalg.eigvals(space.matrix(omega, loads.by_u[0], loads.by_v[0])).astype(complex)
    return Equilibrium(u, omega, values, omega)


def hopf_points(course: EquilibriumCourse, points: Sequence[Equilibrium]) -> tuple[HopfPoint, ...]:
    """The Hopf points between resting positions in the order of their course."""
    found = []
    for low, high in itertools.pairwise(points):
        found += _between(course, low, high, HALVINGS)
    return tuple(found)


def _between(course: EquilibriumCourse, low: Equilibrium, high: Equilibrium, halvings: int) -> list[HopfPoint]:
    """The Hopf points between two equilibria."""
    crossing = _crossing(low, high)
    if crossing == 0 or halvings == 0:
        return []
    if crossing == 1:
        return [_located(course, low, high)]
    middle = course.solved(low, high, 0.5 * (low.value + high.value))
    return _between(course, low, middle, halvings - 1) + _between(course, middle, high, halvings - 1)


def _crossing(low: Equilibrium, high: Equilibrium) -> int:
    """How many oscillating pairs cross the imaginary axis between two equilibria, one way or the other: eigenvalues are
    the same motion where they are nearest to each other."""
    from scipy.optimize import linear_sum_assignment

    before, after = (at.eigenvalues[at.eigenvalues.imag >= 0.0] for at in (low, high))
    mine, others = linear_sum_assignment(np.abs(before[:, None] - after[None, :]))
    turned = (before[mine].real > 0.0) != (after[others].real > 0.0)
    oscillating = np.abs(before[mine].imag) + np.abs(after[others].imag) > OSCILLATING * np.abs(before[mine])
    return max(int(np.count_nonzero(turned & oscillating)), abs(high.unstable - low.unstable))


def settled(machine: Machine, near: Array, omega: float, value: float) -> Equilibrium:
    """The resting position of a machine at a speed in rad/s near to u. Raises Unreachable."""
    guess = np.append(near, omega / machine.pace)
    found = corrected(equations(machine), guess, unit_vector(len(guess)))
    if found is None:
        raise Unreachable
    return replace(_equilibrium(machine, state_space(machine), found), value=value)


def _located(course: EquilibriumCourse, low: Equilibrium, high: Equilibrium) -> HopfPoint:
    from scipy.optimize import brentq

    number = max(low.unstable, high.unstable) - 1

    def growth(value: float) -> float:
        if value in (low.value, high.value):
            return (low if value == low.value else high).growth(number)
        return course.solved(low, high, value).growth(number)

    value = float(brentq(growth, low.value, high.value, xtol=SHARP * high.value, rtol=SHARP))
    here = course.solved(low, high, value)
    return hopf_at(course.machine(value), here, high.unstable > low.unstable)


def hopf_at(machine: Machine, here: Equilibrium, rising: bool, nu: float | None = None) -> HopfPoint:
    """The Hopf point of an equilibrium. nu: about its frequency in rad/s, else the pair is taken that is nearest to the
    imaginary axis."""
    space = state_space(machine)
    loads = film_loads(machine, here.u[None], np.zeros((1, len(here.u))), here.omega)
    values, vectors = np.linalg.eig(space.matrix(here.omega, loads.by_u[0], loads.by_v[0]))
    oscillating = np.flatnonzero(values.imag > OSCILLATING * np.abs(values))
    off = values[oscillating].real if nu is None else values[oscillating] - 1j * nu
    own = oscillating[np.argmin(np.abs(off))]
    state = vectors[:, own].astype(complex)
    mode = space.read @ state
    unit = mode[first_largest(mode[: 2 * machine.film_count])]
    return HopfPoint(here, float(values[own].imag), mode / unit, rising, state / unit)
