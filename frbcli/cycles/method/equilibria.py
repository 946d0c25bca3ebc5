"""Static equilibria over a number as a curve, the eigenvalues there, and the Hopf points where a whirl is born; whether
the whirl that is born there is stable (supercritical), by the first Lyapunov coefficient.

As in frbcli/linear, but with the rings' speeds as unknowns of their own, and as states that the whirl moves.

On the centre manifold the amplitude z of the critical mode q, x = z q + conj(z q) + ..., obeys

    z' = (sigma + i nu) z + c_1 z |z|^2 + ...,      l_1 = Re c_1 / nu,
    2 c_1 = p . (C(q, q, conj q) + 2 B(q, h_11) + B(conj q, h_20)),
    h_11 = -A^-1 B(q, conj q),      h_20 = (2 i nu - A)^-1 B(q, q),

with the second and third derivatives B and C of the films' loads and the left eigenvector p, p . q = 1 (Kuznetsov,
Elements of Applied Bifurcation Theory, (3.20)). All of them are harmonics of the loads along an ellipse of the mode:
the motion is put into the films with a small radius r, and what is left of higher order in r removed by extrapolation.

What rest and cycles of a machine are followed over: the speed of its rotor, or another number of the case.

The unknowns of rest are y = (u, share), of a cycle y = (motion, nu / pace, share); the share is the number over its
largest value. Equations hold for one machine; a course turns them into equations over its number, along which the
machine may change.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.columns import SPEED, hertz
from frbcli.cycles.method.balance import Multipliers, StateSpace, state_space, unpacked
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Strides,
    Unreachable,
    at_value,
    follow,
    oriented,
    reached,
    unit_vector,
)
from frbcli.cycles.method.machine import Machine, film_loads, transfer
from frbcli.equilibrium import hopf
from frbcli.equilibrium.resting import RestingPosition, resting_position
from frbcli.film.kinds.contract import have_closed_forms
from frbcli.rotor.loads import first_largest
from frbcli.scene.machine.system import System

EquationsOf = Callable[[Machine], Equations]  # of one machine, y ending with the speed of its rotor over the pace
MachineAt = Callable[[float], Machine]  # by the share
AtItsHeat = Callable[[Array, Array, float], Machine]

# Unknowns of a cycle up to which harmonics are added for the trivial multiplier alone, of one film and of several; the
# same at a fold, next to which a film may be nearly at rest for a moment.
MOST_UNKNOWNS, MOST_AT_FOLD = (1100, 450), (2400, 450)
DIFFERENCE = 1e-5  # of the share, which is of the order of 1
NEAR = 1e-3  # of it: between the three machines that represent all near a value
KEPT = 64  # machines


class MachineCourse:
    """The speed of a rotor, over which the machine stays the same. over, unit: name and unit of the number; machine_at:
    the machine at a share, as far as the number alone determines it; at_its_heat: gives the machine at the temperatures
    that moments of a motion balance, u and its rate (n, c), at a speed in rad/s, None without heat; most_at_fold: see
    MOST_AT_FOLD."""

    over, unit = SPEED, "Hz"
    at_its_heat: AtItsHeat | None = None
    most_at_fold = MOST_AT_FOLD

    def __init__(self, only: Machine) -> None:
        self.machine_at: MachineAt = lambda _: only

    @cached_property
    def top(self) -> Machine:
        """The machine at the largest value, whose sizes and pace the others have."""
        return self.machine_at(1.0)

    @property
    def scale(self) -> float:
        """The largest value, in the unit."""
        return hertz(self.top.pace)

    def machine(self, y: Array) -> Machine:
        """The machine of unknowns."""
        return self.machine_at(float(y[-1]))

    def with_speed(self, y: Array) -> Array:
        """Unknowns with the speed of the rotor over the pace at their end."""
        return y

    def harmonics(self, y: Array) -> tuple[Complex, float, float]:
        """(H + 1, c) harmonics of a cycle or of rest, its frequency, 0 at rest, and the speed of the rotor in rad/s."""
        y, c, pace = self.with_speed(y), self.top.size, self.top.pace
        if len(y) == c + 1:
            return unpacked(y[:-1], c), 0.0, float(y[-1] * pace)
        return unpacked(y[:-2], c), float(y[-2] * pace), float(y[-1] * pace)

    def equations(self, of: EquationsOf, _near: Array | None = None) -> Equations:
        """The equations over the number. near: unknowns close by."""
        return of(self.top)

    def equations_at(self, of: EquationsOf, near: Array) -> Equations:
        """The equations at the number of unknowns close by; by the number alone they may change in another way."""
        return self.equations(of, near)

    def equations_near(self, of: EquationsOf, near: Array) -> Equations:
        """The equations next to the number of unknowns close by."""
        return self.equations(of, near)

    def states(self, _machine: Machine) -> StateSpace:
        """The states of a machine of the course."""
        return self._states

    def multipliers(self, fast: Multipliers, _y: Array, _slope: Callable[[Machine], Array]) -> Multipliers:
        """The multipliers of a cycle y, with the ones of states that follow its mean, such as temperatures. slope:
        gives the derivative (n, n) of a machine's equations by the motion."""
        return fast

    @cached_property
    def _states(self) -> StateSpace:
        return state_space(self.top)


class Changing(MachineCourse):
    """The speed of a rotor, or another number, along which the machine is another one at each value. How the equations
    change with it is a central difference. omega: a speed of the rotor in rad/s that is kept while the number is
    another one."""

    def __init__(self, made: MachineAt, omega: float | None = None) -> None:
        self.machine_at = lru_cache(KEPT)(made)
        self.omega = omega

    def with_speed(self, y: Array) -> Array:
        """See MachineCourse."""
        return y if self.omega is None else np.append(y[:-1], self.omega / self.top.pace)

    def equations(self, of: EquationsOf, _near: Array | None = None) -> Equations:
        """See MachineCourse."""

        def at(y: Array) -> tuple[Array, Array]:
            last = float(y[-1])
            residual, slope = self.staying(of, last)(y)
            ahead, behind = (self.staying(of, last + sign * DIFFERENCE)(y)[0] for sign in (1.0, -1.0))
            slope[:, -1] += (ahead - behind) / (2.0 * DIFFERENCE)
            return residual, slope

        return at

    def equations_at(self, of: EquationsOf, near: Array) -> Equations:
        """Equations of one machine, see MachineCourse."""
        return self.staying(of, float(near[-1]))

    def equations_near(self, of: EquationsOf, near: Array) -> Equations:
        """Parabolas through the equations of three machines, at the value and on both sides, see MachineCourse."""
        last = float(near[-1])
        staying = [self.staying(of, last + off) for off in (-NEAR, 0.0, NEAR)]

        def at(y: Array) -> tuple[Array, Array]:
            off = (float(y[-1]) - last) / NEAR
            weights = np.array([0.5 * off * (off - 1.0), 1.0 - off**2, 0.5 * off * (off + 1.0)])
            changes = np.array([off - 0.5, -2.0 * off, off + 0.5]) / NEAR
            residuals, slopes = map(np.array, zip(*(each(y) for each in staying), strict=True))
            slope = np.tensordot(weights, slopes, 1)
            slope[:, -1] += changes @ residuals
            return weights @ residuals, slope

        return at

    def states(self, machine: Machine) -> StateSpace:
        """See MachineCourse."""
        return state_space(machine)

    def staying(self, of: EquationsOf, share: float) -> Equations:
        """The equations of the machine at a fixed share."""
        asked = of(self.machine_at(share))

        def at(y: Array) -> tuple[Array, Array]:
            residual, slope = asked(self.with_speed(y))
            if self.omega is not None:
                slope[:, -1] = 0.0
            return residual, slope

        return at


STRIDES = Strides(first=0.01, shortest=1e-7, longest=0.04, points=2000)
SHARP = 1e-12  # relative tolerance of the number at a Hopf point
States = Mapping[int, NDArray[Any]]

ANGLES = 32
SMOOTH = 0.02  # radius over the gap in closed forms
LEVELS = 4  # radii, each half of the one before, of a closed form
# Radii in tables, whose third derivatives jump between cells: an ellipse has to pass over some.
TABULATED = (0.1, 0.15, 0.2)


@dataclass(frozen=True)
class Equilibrium:
    """A static equilibrium. machine: which rests; u: (c,) see machine.py; omega: speed of the rotor, rad/s;
    eigenvalues: (N,) 1/s; value: of the number that the curve goes over, over its largest one."""

    machine: Machine
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
    displacement of a journal being 1; rising: whether it grows above this value; state: (N,) the right eigenvector of
    this size."""

    equilibrium: Equilibrium
    nu: float
    mode: Complex
    rising: bool
    state: Complex


@dataclass(frozen=True)
class Resting:
    """The curve of static equilibria, ascending in the number; its Hopf points; why it ends before the lowest value."""

    points: tuple[Equilibrium, ...]
    hopf: tuple[HopfPoint, ...]
    note: str


def equations(machine: Machine) -> Equations:
    """Equations of a static equilibrium y = (u, Omega / pace), see continuation.py."""
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
    """Static equilibria between two speeds in rad/s, from the fastest on downwards. Raises NotConverged without one."""
    near = at_rest(machine, resting_position(system, fastest))
    return resting_along(MachineCourse(machine), near, slowest / machine.pace, fastest / machine.pace)


def resting_along(course: MachineCourse, near: Array, lowest: float, highest: float = 1.0) -> Resting:
    """Static equilibria along a course, between two shares; near: (c,) u near to the one at the highest. Raises
    Unreachable."""
    asked = course.equations(equations)
    down = -unit_vector(len(near) + 1)
    places = [oriented(reached(asked, np.append(near, highest), down), down)]
    for place, _ in follow(asked, places[0], STRIDES):
        places.append(place)
        if not lowest < place.y[-1] < 1.000001 * highest:
            break
    note = ""
    if places[-1].y[-1] <= lowest < places[-2].y[-1]:
        end = at_value(asked, places[-2], lowest)
        if end is None:
            raise Unreachable
        places[-1] = end
    else:
        lost = f"{places[-1].y[-1] * course.scale:.4g} {course.unit}".rstrip()
        note = f"The static equilibria could not be followed below {lost}."
    points = tuple(equilibrium(course, place) for place in reversed(places))
    return Resting(points, hopf_points(course, points), note)


def at_rest(machine: Machine, position: RestingPosition) -> Array:
    """(c,) u of a static equilibrium, see machine.py."""
    places = machine.places @ position.displacements[: machine.rotor.size]
    return np.concatenate([places, position.ring_speeds / machine.pace])


def equilibrium(course: MachineCourse, place: Place) -> Equilibrium:
    """The static equilibrium at a place of its curve."""
    machine, y = course.machine(place.y), course.with_speed(place.y)
    u, omega = y[:-1], float(y[-1] * machine.pace)
    loads = film_loads(machine, u[None], np.zeros((1, len(u))), omega)
    matrix = course.states(machine).matrix(omega, loads.by_u[0], loads.by_v[0])
    return Equilibrium(machine, u, omega, np.linalg.eigvals(matrix).astype(complex), float(place.y[-1]))


def settled(course: MachineCourse, near: Array, value: float) -> Equilibrium:
    """The static equilibrium at a value near to u (c,). Raises Unreachable."""
    guess = np.append(near, value)
    return equilibrium(course, reached(course.equations_at(equations, guess), guess, unit_vector(len(guess))))


def hopf_points(course: MachineCourse, points: Sequence[Equilibrium]) -> tuple[HopfPoint, ...]:
    """The Hopf points between static equilibria in the order of their course. Raises Unreachable."""
    crossings = hopf.hopf_points(partial(_between, course), points, SHARP)
    return tuple(hopf_at(each.here, each.rising) for each in crossings)


def _between(course: MachineCourse, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
    """The static equilibrium at a value between two."""
    share = (value - low.value) / (high.value - low.value)
    return settled(course, low.u + share * (high.u - low.u), value)


def hopf_at(here: Equilibrium, rising: bool, nu: float | None = None) -> HopfPoint:
    """The Hopf point of an equilibrium. nu: about its frequency in rad/s, else the pair is taken that is nearest to the
    imaginary axis."""
    machine = here.machine
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


@dataclass(frozen=True)
class Lyapunov:
    """value: c_1 in 1/s for an amplitude z over the clearance; uncertainty: of its real part: what the last
    extrapolation changes, of tables the range between radii."""

    value: complex
    uncertainty: float

    @property
    def sign(self) -> int:
        """1: subcritical, -1: supercritical, 0: uncertain."""
        real = self.value.real
        return 0 if abs(real) <= self.uncertainty else 1 if real > 0.0 else -1


def lyapunov_coefficient(hopf: HopfPoint) -> Lyapunov:
    """The first Lyapunov coefficient of a Hopf point, with its uncertainty: extrapolated to no radius in closed forms
    of the films, else the middle one of several radii, and their spread."""
    machine = hopf.equilibrium.machine
    smooth = have_closed_forms(machine.films)
    d = hopf.equilibrium.u[: 2 * machine.film_count].reshape(-1, 2)
    gap = 1.0 - float(np.max(np.hypot(d[:, 0], d[:, 1])))
    if not smooth:
        values = [_at_radius(hopf, radius * gap) for radius in TABULATED]
        real = [value.real for value in values]
        return Lyapunov(values[len(values) // 2], max(real) - min(real))
    rows = [_at_radius(hopf, SMOOTH * gap * 0.5**level) for level in range(LEVELS)]
    changed = 0.0
    while len(rows) > 1:  # errors go with r^2, r^4, ...
        power = 4.0 ** (LEVELS - len(rows) + 1)
        changed = abs((rows[-1] - rows[-2]).real) / (power - 1.0)
        rows = [(power * fine - coarse) / (power - 1.0) for coarse, fine in itertools.pairwise(rows)]
    return Lyapunov(rows[0], changed)


def _at_radius(hopf: HopfPoint, radius: float) -> complex:
    here, machine = hopf.equilibrium, hopf.equilibrium.machine
    space = state_space(machine)
    loads = film_loads(machine, here.u[None], np.zeros((1, machine.size)), here.omega)
    matrix = space.matrix(here.omega, loads.by_u[0], loads.by_v[0])
    left = _left_vector(matrix, hopf)
    q = hopf.state
    eye = np.eye(len(matrix))

    def beyond(states: States) -> Complex:
        """(3, N) harmonics 0, 1, 2 of what the loads add beyond their linear part for x = sum of states e^(i k a)."""
        turn = np.exp(1j * 2.0 * np.pi * np.arange(ANGLES) / ANGLES)
        x = sum((np.outer(turn**k, state) for k, state in states.items()), np.zeros((ANGLES, len(q)), dtype=complex))
        moved = (x + np.conj(x)).real
        u, v = moved @ space.read.T, moved @ space.read_rate.T
        there = film_loads(machine, here.u + u, v, here.omega)
        rest = there.values - loads.values - u @ loads.by_u[0].T - v @ loads.by_v[0].T
        return np.asarray(np.fft.rfft(rest, axis=0)[:3] / ANGLES @ space.given.T)

    second = beyond({1: radius * q})
    mean = -np.linalg.solve(matrix, second[0].real)
    double = np.linalg.solve(2j * hopf.nu * eye - matrix, second[2])
    third = beyond({1: radius * q, 0: 0.5 * mean, 2: double})
    return complex(left @ third[1]) / radius**3


def _left_vector(matrix: Array, hopf: HopfPoint) -> Complex:
    """(N,) p with p . q = 1 (no conjugate)."""
    values, vectors = np.linalg.eig(matrix.T)
    own = vectors[:, np.argmin(np.abs(values - 1j * hopf.nu))]
    return np.asarray(own / (own @ hopf.state))
