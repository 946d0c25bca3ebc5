"""Harmonic balance of a periodic motion, with the loads of the films taken at moments of a period (alternating
frequency and time).

A motion u(tau) = u_0 + sum over k = 1 ... H of u_k exp(i k tau) + its conjugate, tau = nu t, is held as the real vector

    y = (u_0, Re u_1, Im u_1, ..., Re u_H, Im u_H, nu / pace, Omega / pace)

and obeys u_k - T_k (g_k + kappa_k u_k) = 0 for k = 0 ... H, g_k being the harmonics of the loads (machine.py), and the
phase condition that it is not shifted in time against a reference.

A machine with its states, for what is linear: eigenvalues at rest and multipliers of a cycle.

x = (q, q', s) with the displacements q of the rotor and the speeds s of the rings over the pace obeys

    x' = A_0(Omega) x + B g,      u = R x,      u' = S x (journals)

with the loads g of the films, so that films linearised at some moment make A_0 + B (dg/du R + dg/du' S) of it.

Stability of a cycle: the multipliers by which disturbances grow over its period (Floquet).

The equations linearised about the cycle are integrated over a period by Radau's collocation with three nodes (order 5,
L-stable), with all states of the rotor and the rings. Between the films the rotor is linear and the same in every
interval: what its states and the loads at the nodes do is computed once. Of the films, c loads at each node are left.
One multiplier is 1, of a shift in time; its deviation shows the error of the integration and of the harmonics.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.machine import Loads, Machine, film_loads, transfer
from frbcli.equilibrium.linearised import first_order
from frbcli.rotor.loads import largest_first

SAMPLES_PER_HARMONIC, FEWEST_SAMPLES = 6, 64


@dataclass(frozen=True)
class Balance:
    """The equations of a motion with H harmonics; reference: (H + 1, c) the motion that the phase is compared with."""

    machine: Machine
    reference: Complex

    @property
    def harmonics(self) -> int:
        """H."""
        return len(self.reference) - 1

    def __call__(self, y: Array) -> tuple[Array, Array]:
        """The residual (n,) and its derivative (n, n + 1), n = c (2 H + 1) + 1. Raises OutOfGap."""
        machine, h = self.machine, self.harmonics
        c = machine.size
        motion, nu, omega = unpacked(y[:-2], c), float(y[-2] * machine.pace), float(y[-1] * machine.pace)
        orders = np.arange(h + 1.0)[:, None]
        passing = transfer(machine, nu * orders[:, 0], omega)
        kappa = passing.kappa
        loads, rate = loads_along(machine, motion, nu, omega)
        values, slope = harmonics_of(loads.values, h), _derivative(loads, h, nu)
        inner = values + kappa * motion
        out = motion - through(passing.values, inner)
        out[0] -= machine.rest
        slope[np.arange(h + 1), :, h + np.arange(h + 1), :] += kappa[:, :, None] * np.eye(c)
        by_motion = -np.einsum("kij,kjlm->kilm", passing.values, slope)
        by_motion[np.arange(h + 1), :, h + np.arange(h + 1), :] += np.eye(c)
        with_nu = harmonics_of(np.einsum("nij,nj->ni", loads.by_v, rate), h)
        with_nu += orders * passing.kappa_by_frequency * motion
        by_nu = -orders * through(passing.by_frequency, inner) - through(passing.values, with_nu)
        by_omega = -through(passing.by_speed, inner) - through(passing.values, harmonics_of(loads.by_speed, h))
        n = c * (2 * h + 1)
        residual, jacobian = np.empty(n + 1), np.zeros((n + 1, n + 2))
        residual[:n], jacobian[:n, :n] = packed(out), as_real(by_motion)
        jacobian[:n, n], jacobian[:n, n + 1] = machine.pace * packed(by_nu), machine.pace * packed(by_omega)
        row = phase_row(self.reference)
        residual[n], jacobian[n, :n] = row @ y[:n], row
        return residual, jacobian


def unpacked(y: Array, c: int) -> Complex:
    """(H + 1, c) harmonics of the real vector y (c (2 H + 1),)."""
    h = (len(y) // c - 1) // 2
    motion = np.zeros((h + 1, c), dtype=complex)
    motion[0] = y[:c]
    parts = y[c:].reshape(h, 2, c)
    motion[1:] = parts[:, 0] + 1j * parts[:, 1]
    return motion


def packed(motion: Complex) -> Array:
    """The real vector of harmonics (H + 1, c)."""
    parts = np.stack([motion[1:].real, motion[1:].imag], axis=1)
    return np.concatenate([motion[0].real, parts.ravel()])


def phase_row(reference: Complex) -> Array:
    """(c (2 H + 1),): how a motion is shifted in time against a reference, the mean of u . du_ref/dtau."""
    k = np.arange(len(reference))[:, None]
    shifted = 1j * k * reference
    row = packed(shifted)
    size = float(np.linalg.norm(row))
    return row / size if size > 0.0 else row


def moments(harmonics: int) -> int:
    """At how many moments of a period the films are asked."""
    wanted = max(FEWEST_SAMPLES, SAMPLES_PER_HARMONIC * harmonics)
    return 1 << (wanted - 1).bit_length()


def motion_along(motion: Complex, count: int) -> tuple[Array, Array]:
    """(count, c) a motion at equal moments of its period, and its derivative by tau."""
    h = len(motion) - 1
    spectrum = np.zeros((count // 2 + 1, motion.shape[1]), dtype=complex)
    spectrum[: h + 1] = count * motion
    rate = 1j * np.arange(count // 2 + 1)[:, None] * spectrum
    return np.fft.irfft(spectrum, count, axis=0), np.fft.irfft(rate, count, axis=0)


def loads_along(machine: Machine, motion: Complex, nu: float, omega: float) -> tuple[Loads, Array]:
    """The loads at moments of a period, and du/dtau there (n, c). Raises OutOfGap."""
    u, rate = motion_along(motion, moments(len(motion) - 1))
    return film_loads(machine, u, nu * rate, omega), rate


def left_out(machine: Machine, y: Array) -> float:
    """Largest amplitude that the loads give to one of the four harmonics after the last one of y."""
    c, h = machine.size, (len(y) - 2) // machine.size // 2
    nu, omega = float(y[-2] * machine.pace), float(y[-1] * machine.pace)
    motion = unpacked(y[:-2], c)
    loads, _ = loads_along(machine, motion, nu, omega)
    beyond = transfer(machine, nu * np.arange(h + 1.0, h + 5.0), omega).values
    return float(np.abs(through(beyond, harmonics_of(loads.values, h + 4)[h + 1 :])).max())


def harmonics_of(samples: Array, h: int) -> Complex:
    """(h + 1, ...) of samples (n, ...) over a period."""
    return np.asarray(np.fft.rfft(samples, axis=0)[: h + 1] / len(samples))


def through(passing: Complex, harmonics: Complex) -> Complex:
    """(m, c) motions that loads with harmonics (m, c) make, each through its own matrix of passing (m, c, c)."""
    return np.asarray(np.einsum("kij,kj->ki", passing, harmonics))


def _derivative(loads: Loads, h: int, nu: float) -> Complex:
    """(h + 1, c, 2 h + 1, c): the harmonic k of the loads by u_l, l = -h ... h."""
    by_u, by_v = _both_signs(loads.by_u, 2 * h), _both_signs(loads.by_v, 2 * h)
    k, order = np.arange(h + 1)[:, None], np.arange(-h, h + 1)[None, :]
    place = k - order + 2 * h
    tensor = by_u[place] + (1j * nu * order)[..., None, None] * by_v[place]
    return np.ascontiguousarray(tensor.transpose(0, 2, 1, 3))


def _both_signs(samples: Array, h: int) -> Complex:
    """(2 h + 1, ...): the harmonics -h ... h."""
    one = harmonics_of(samples, h)
    return np.concatenate([np.conj(one[:0:-1]), one])


def as_real(slope: Complex) -> Array:
    """The derivative (k, i, l, j) of harmonics k by u_l, l = -h ... h, as a real matrix of packed vectors."""
    h, c = len(slope) - 1, slope.shape[1]
    ahead, behind = slope[:, :, h + 1 :], slope[:, :, h - 1 :: -1] if h > 0 else slope[:, :, :0]
    by_real, by_imaginary = ahead + behind, 1j * (ahead - behind)
    columns = np.empty((h + 1, c, 1 + 2 * h, c), dtype=complex)
    columns[:, :, 0] = slope[:, :, h]
    columns[:, :, 1::2], columns[:, :, 2::2] = by_real, by_imaginary
    flat = columns.reshape(h + 1, c, -1)
    rows = np.empty((1 + 2 * h, c, flat.shape[2]))
    rows[0] = flat[0].real
    rows[1::2], rows[2::2] = flat[1:].real, flat[1:].imag
    return rows.reshape((1 + 2 * h) * c, -1)


@dataclass(frozen=True)
class StateSpace:
    """still, by_speed: (N, N), A_0 = still + Omega by_speed; given: (N, c) B; read, read_rate: (c, N) R and S."""

    still: Array
    by_speed: Array
    given: Array
    read: Array
    read_rate: Array

    def matrix(self, omega: float, by_u: Array, by_v: Array) -> Array:
        """(N, N) with films linearised: by_u, by_v (c, c)."""
        return self.still + omega * self.by_speed + self.given @ (by_u @ self.read + by_v @ self.read_rate)


def state_space(machine: Machine) -> StateSpace:
    """The states of a machine."""
    rotor, films, c = machine.rotor, 2 * machine.film_count, machine.size
    n, rings = rotor.size, machine.ring_count
    size = 2 * n + rings
    still, by_speed = np.zeros((size, size)), np.zeros((size, size))
    still[: 2 * n, : 2 * n] = first_order(rotor.mass, rotor.damping, rotor.stiffness)
    solved = np.linalg.solve(rotor.mass, np.hstack([rotor.gyroscopic, machine.pulls]))
    by_speed[n : 2 * n, n : 2 * n] = -solved[:, :n]
    given, read, read_rate = np.zeros((size, c)), np.zeros((c, size)), np.zeros((c, size))
    given[n : 2 * n, :films] = solved[:, n:]
    read[:films, :n] = read_rate[:films, n : 2 * n] = machine.places
    given[2 * n :, films:] = np.diag(1.0 / machine.inertia)
    read[films:, 2 * n :] = np.eye(rings)
    return StateSpace(still, by_speed, given, read, read_rate)


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
