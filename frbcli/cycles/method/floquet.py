"""Stability of a cycle: the multipliers by which disturbances grow over its period (Floquet).

The equations linearised about the cycle are integrated over a period by Radau's collocation with three nodes (order 5,
L-stable), with all states of the rotor and the rings. Between the films the rotor is linear and the same in every
interval: what its states and the loads at the nodes do is computed once. Of the films, c loads at each node are left.
One multiplier is 1, of a shift in time; its deviation shows the error of the integration and of the harmonics.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import loads_along, unpacked
from frbcli.cycles.method.machine import Machine, film_loads
from frbcli.cycles.method.states import StateSpace
from frbcli.rotor.loads import largest_first

NODES = np.array([(4.0 - 6.0**0.5) / 10.0, (4.0 + 6.0**0.5) / 10.0, 1.0])
FEWEST_INTERVALS, INTERVALS_PER_HARMONIC, MOST_INTERVALS = 48, 4, 768
TRIVIAL = 1e-6  # error of the trivial multiplier from which on intervals are halved
HELPS, ALIKE = 0.5, 2.0  # shares of an error: below which finer ones have helped, up to which it equals a nearby one
FAR = 5.0  # times the error aimed at, above which a nearby one is used without another try
NEUTRAL = 1e-7  # beyond 1: a multiplier that grows
DOUBLE = 0.01  # distance of a second multiplier from 1 below which the motion decides which of them is trivial


@dataclass(frozen=True)
class Multipliers:
    """values: (N,) by falling size, the trivial one first; defect: how far that is from 1; intervals: of the period
    that suffice for them; floor: the defect that finer ones have not lowered here or close by, 0 if none is known."""

    values: Complex
    defect: float
    intervals: int = FEWEST_INTERVALS
    floor: float = 0.0

    @property
    def others(self) -> Complex:
        """All but the trivial one."""
        return self.values[1:]

    @property
    def relaxed(self) -> Multipliers:
        """These multipliers as a start for a cycle near by, which tries double intervals first."""
        return replace(self, intervals=self.intervals // 2)

    @property
    def unstable(self) -> int:
        """How many disturbances grow."""
        return int(np.count_nonzero(np.abs(self.others) > 1.0 + max(NEUTRAL, self.defect)))

    def growth(self, number: int) -> float:
        """How far the multiplier number 0, 1, ... by falling size lies outside of the unit circle."""
        sizes = np.abs(self.others)
        return float(sizes[number]) - 1.0 if number < len(sizes) else -1.0

    @property
    def stable(self) -> bool:
        """Whether all decay."""
        return self.unstable == 0


def multipliers(
    machine: Machine, space: StateSpace, y: Array, near: Multipliers | None = None, enough: float = TRIVIAL
) -> Multipliers:
    """Multipliers of a cycle y, see balance.py; intervals are halved until the trivial multiplier is right.

    near: multipliers of a cycle close by, or of the same with fewer harmonics, whose intervals are tried first; enough:
    error with which no finer ones are tried. """
    harmonics = (len(y) - 2) // machine.size // 2
    count = max(FEWEST_INTERVALS, INTERVALS_PER_HARMONIC * harmonics)
    floor = 0.0
    if near is not None:
        count = max(count, near.intervals)
        floor = near.floor

    def at(intervals: int) -> Multipliers:
        matrix = monodromy(machine, space, y, intervals)
        return replace(_parted(_sorted(matrix), matrix, machine, space, y), intervals=intervals, floor=floor)

    result = at(count)
    known = FAR * TRIVIAL < floor < ALIKE * result.defect and result.defect < ALIKE * floor
    while not known and result.defect > enough and 2 * count <= MOST_INTERVALS:
        count *= 2
        finer = at(count)
        if finer.defect > HELPS * result.defect:  # not of the integration, but of the harmonics
            return replace(finer, intervals=result.intervals, floor=finer.defect)
        result = finer
    return result


def monodromy(machine: Machine, space: StateSpace, y: Array, count: int) -> Array:
    """(N, N): what one period makes of a disturbance, with `count` equal intervals."""
    nu, omega = float(y[-2] * machine.pace), float(y[-1] * machine.pace)
    phases = 2.0 * np.pi * (np.arange(count)[:, None] + NODES).ravel() / count
    u, rate = _at(unpacked(y[:-2], machine.size), phases)
    return _through_all(_transitions(machine, space, u, nu * rate, omega, 2.0 * np.pi / (nu * count)))


def _transitions(machine: Machine, space: StateSpace, u: Array, v: Array, omega: float, h: float) -> Array:
    """(count, N, N): what each interval of the length h in s makes of a disturbance. u, v: (3 count, c) the motion and
    its rate in 1/s at the nodes; omega: rad/s."""
    c, s = machine.size, len(NODES)
    count = len(u) // s
    loads = film_loads(machine, u, v, omega)
    by_start, by_loads = _interval(space, omega, h)
    by_u, by_v = (slope.reshape(count, s, c, c) for slope in (loads.by_u, loads.by_v))
    columns = np.concatenate([by_loads, by_start], axis=2)
    felt = (by_u @ (space.read @ columns) + by_v @ (space.read_rate @ columns)).reshape(count, s * c, -1)
    answer = np.linalg.solve(np.eye(s * c) - felt[:, :, : s * c], felt[:, :, s * c :])
    return np.asarray(by_start[-1] + by_loads[-1] @ answer)


def _through_all(steps: Array) -> Array:
    """(N, N): the product of steps (count, N, N), the first one on the right."""
    while len(steps) > 1:
        if len(steps) % 2:
            steps = np.concatenate([steps[:-2], (steps[-1] @ steps[-2])[None]])
        else:
            steps = steps[1::2] @ steps[::2]
    return np.asarray(steps[0])


def _interval(space: StateSpace, omega: float, h: float) -> tuple[Array, Array]:
    """The states at the nodes of an interval of the length h by those at its start (3, N, N) and by the loads at its
    nodes (3, N, 3 c), of x_j = x_0 + h sum of a_jl (A_0 x_l + B g_l): parted by the eigenvectors of a_jl."""
    shares, vectors = np.linalg.eig(_weights())
    back = np.linalg.inv(vectors)
    kept = np.flatnonzero(shares.imag >= 0.0)
    shares, vectors, back = shares[kept], vectors[:, kept] * np.where(shares[kept].imag > 0.0, 2.0, 1.0), back[kept]
    size = len(space.still)
    linear = space.still + omega * space.by_speed
    inverse = np.linalg.inv(np.eye(size) - h * shares[:, None, None] * linear)
    by_start = np.tensordot(vectors * back.sum(axis=1), inverse, axes=1).real
    loaded = np.einsum("jm,m,ml,mnc->jnlc", vectors, h * shares, back, inverse @ space.given).real
    return by_start, loaded.reshape(len(NODES), size, -1)


def _sorted(matrix: Array) -> Multipliers:
    values = np.linalg.eigvals(matrix).astype(complex)
    trivial = int(np.argmin(np.abs(values - 1.0)))
    others = np.delete(values, trivial)
    others = others[largest_first(others)]
    return Multipliers(np.concatenate([values[trivial : trivial + 1], others]), float(abs(values[trivial] - 1.0)))


def _parted(fast: Multipliers, matrix: Array, machine: Machine, space: StateSpace, y: Array) -> Multipliers:
    """The multipliers, with a pair near 1 computed from its sum and from the image of the motion along the cycle.

    At a fold two multipliers are 1, with one disturbance for both: an error of the matrix then enters each with its
    root, and their sum as it is.
    """
    if len(fast.others) == 0:
        return fast
    near = int(np.argmin(np.abs(fast.others - 1.0)))
    if abs(fast.others[near] - 1.0) > DOUBLE:
        return fast
    along = _along(machine, space, y)
    trivial = float(along @ (matrix @ along))
    other = fast.values[0] + fast.others[near] - trivial
    if abs(other.imag) > TRIVIAL:
        return fast
    others = np.concatenate([np.delete(fast.others, near), [other.real]])
    others = others[largest_first(others)]
    return Multipliers(np.concatenate([[trivial + 0.0j], others]), float(np.linalg.norm(matrix @ along - along)))


def _along(machine: Machine, space: StateSpace, y: Array) -> Array:
    """(N,) unit direction in which all states move at the start of a cycle."""
    motion, nu, omega = unpacked(y[:-2], machine.size), float(y[-2] * machine.pace), float(y[-1] * machine.pace)
    loads, _ = loads_along(machine, motion, nu, omega)
    harmonics = np.fft.rfft(loads.values, axis=0)[1 : len(motion)] @ space.given.T
    rates = 1j * nu * np.arange(1, len(motion))
    linear = space.still + omega * space.by_speed
    states = np.linalg.solve(rates[:, None, None] * np.eye(len(linear)) - linear, harmonics[:, :, None])[:, :, 0]
    along = (rates[:, None] * states).sum(axis=0).real
    return np.asarray(along / np.linalg.norm(along))


def _at(motion: Complex, tau: Array) -> tuple[Array, Array]:
    """(n, c) the motion and its derivative by tau at given moments."""
    k = np.arange(len(motion))
    turn = np.exp(1j * np.outer(tau, k))
    turn[:, 1:] *= 2.0
    return (turn @ motion).real, (turn @ (1j * k[:, None] * motion)).real


def _weights() -> Array:
    """(3, 3): a_jl, exact for parabolas between the nodes."""
    powers = np.arange(1, len(NODES) + 1)
    return np.asarray((NODES[:, None] ** powers / powers) @ np.linalg.inv(NODES[:, None] ** (powers - 1)))
