"""Motions of two frequencies by harmonic balance: a whirl of the frequency nu beside the unbalance, which turns with
Omega.

With the phases a = nu t and b = Omega t a motion is u(a, b) = sum over (j, k) of u_jk exp(i (j a + k b)); of (j, k) and
(-j, -k), whose harmonics are conjugate, one is held, with k >= 0. The loads of the films are taken at a grid of both
phases, and the rotor behind them is linear at each frequency j nu + k Omega (machine.py):

    u_jk = T (g_jk + kappa u_jk) + rest (0, 0) + the motion that the unbalance makes (0, 1), and
a force of the order k (0, k).

The phase a is that of a reference. Newton's steps are solved by GMRES; films whose derivatives are their mean over b
part the equations by k, and are their preconditioner: of k = 0 it is the balance of a cycle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import as_real, packed, through, unpacked
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.parts.machine import Loads, Machine, Transfer, driven_motions, film_loads, transfer
from frbcli.cycles.unbalance.synchronous import WHIRLS

Orders = NDArray[np.int64]

UNKNOWN = "the equations do not lead to one"
TAIL = 1e-6  # of the clearance: what a harmonic that is left out may have
MARGIN = np.array([4, 2])  # by how many orders beyond the largest ones harmonics are looked for
MOST = 600  # harmonics
REFITS = 12
SMALLEST = 1.0 / 8.0  # step by which the unbalance is raised
SAMPLES_PER_ORDER, FEWEST = np.array([5, 5]), np.array([32, 16])
CLOSE = 1e-9  # residual over the clearance that ends Newton's method
ITERATIONS = 10
DENSE = 3000  # equations up to which Newton's steps are solved directly
INEXACT, KRYLOV = 1e-5, 60  # of GMRES: relative tolerance, vectors


@dataclass(frozen=True)
class Torus:
    """A motion of two frequencies. orders: (m, 2) j and k of its harmonics, (0, 0) first; motion: (m, c) u_jk; nu,
    omega: rad/s."""

    orders: Orders
    motion: Complex
    nu: float
    omega: float

    @property
    def frequencies(self) -> Array:
        """(m,) j nu + k Omega in rad/s."""
        return np.asarray(self.orders @ np.array([self.nu, self.omega]))


def of_cycle(motion: Complex, nu: float, omega: float, driven: Sequence[int] = (1,)) -> Torus:
    """A cycle with harmonics (H + 1, c) as a motion of two frequencies, with room for as many beside k = 1: small ones
    count there, since the motions at nu and Omega - nu, close to each other, act on each other through them."""
    kept = max(2, 1 + int(np.flatnonzero(np.abs(motion).max(axis=1) > TAIL)[-1]))
    orders = [(j, 0) for j in range(kept)] + [(j, 1) for j in range(-kept, kept + 1)]
    orders += [(0, k) for k in sorted(set(driven)) if k > 1]
    found = np.zeros((len(orders), motion.shape[1]), dtype=complex)
    found[:kept] = motion[:kept]
    return Torus(np.array(orders), found, nu, omega)


def solved(machine: Machine, guess: Torus, share: float = 1.0) -> Torus:
    """The motion next to a guess, with its harmonics. share: of the unbalance. Raises Unreachable."""
    torus, driven = guess, [(order, share * moved) for order, moved in driven_motions(machine, guess.omega)]
    for _ in range(ITERATIONS):
        balance = Linearised(machine, torus, guess.motion)
        residual = balance.residual(driven)
        size = float(np.abs(residual).max())
        if size < CLOSE:
            return torus
        if not np.isfinite(size):
            break
        step = balance.newton_step(residual)
        motion = torus.motion + unpacked(step[:-1], machine.size)
        torus = replace(torus, motion=motion, nu=torus.nu + float(step[-1] * machine.pace))
    raise Unreachable("Newton's method does not find one")


def fitted(machine: Machine, guess: Torus, share: float = 1.0) -> Torus:
    """The motion next to a guess, with as many harmonics as it needs. Raises Unreachable, also where the whirl ends."""
    torus = guess
    for _ in range(REFITS):
        torus = solved(machine, torus, share)
        whirl = torus.motion[(torus.orders == [1, 0]).all(axis=1), : 2 * machine.film_count]
        if np.abs(whirl).max() < WHIRLS:
            raise Unreachable("the whirl ends in the synchronous motion")
        wanted = left_out(machine, torus)
        if not len(wanted):
            return torus
        orders = np.concatenate([torus.orders, wanted])
        if len(orders) > MOST:
            raise Unreachable(f"it needs more than {MOST} lines, as next to speeds at which a whirl locks in")
        added = np.zeros((len(wanted), machine.size))
        torus = replace(torus, orders=orders, motion=np.concatenate([torus.motion, added]))
    raise Unreachable("it needs ever more lines")


def with_unbalance(machine: Machine, guess: Torus) -> Torus:
    """The motion with the whole unbalance that goes on from a cycle as the unbalance is raised. Raises Unreachable."""
    torus, share, step = guess, 0.0, 1.0
    while share < 1.0:
        higher = min(1.0, share + step)
        try:
            torus, share, step = fitted(machine, torus, higher), higher, 2.0 * step
        except Unreachable as why:
            step *= 0.5
            if step < SMALLEST:
                raise Unreachable(f"{str(why) or UNKNOWN} with more than {share:.0%} of the unbalance") from None
    return torus


def samples(orders: Orders, motion: Complex, counts: tuple[int, int]) -> Array:
    """(n_a, n_b, c): a motion on a grid of both phases."""
    (a, b), (j, k) = counts, orders.T
    spectrum = np.zeros((a, b // 2 + 1, motion.shape[1]), dtype=complex)
    spectrum[j, k] = motion
    mirrored = (k == 0) & (j > 0)
    spectrum[-j[mirrored], 0] = np.conj(motion[mirrored])
    return np.asarray(np.fft.irfft2(spectrum, counts, axes=(0, 1), norm="forward"))


def harmonics(values: Array, orders: Orders) -> Complex:
    """(m, ...) harmonics of samples (n_a, n_b, ...)."""
    return np.asarray(np.fft.rfft2(values, axes=(0, 1), norm="forward")[orders[:, 0], orders[:, 1]])


def grid_of(orders: Orders) -> tuple[int, int]:
    """At how many phases a and b the films are asked."""
    from scipy.fft import next_fast_len

    wanted = np.maximum(FEWEST, SAMPLES_PER_ORDER * np.abs(orders).max(axis=0))
    return next_fast_len(int(wanted[0])), 2 * next_fast_len(int(wanted[1]) // 2)


def moments_of(torus: Torus) -> tuple[Array, Array]:
    """(n, c) a motion at a grid of both phases, and its rate in 1/s."""
    counts, c = grid_of(torus.orders), torus.motion.shape[1]
    u = samples(torus.orders, torus.motion, counts)
    v = samples(torus.orders, 1j * torus.frequencies[:, None] * torus.motion, counts)
    return u.reshape(-1, c), v.reshape(-1, c)


@dataclass(frozen=True)
class Linearised:
    """The equations about a motion; reference: (m, c) whose phase it has. Its methods raise OutOfGap."""

    machine: Machine
    torus: Torus
    reference: Complex

    @cached_property
    def counts(self) -> tuple[int, int]:
        """(n_a, n_b): at how many phases the films are asked."""
        return grid_of(self.torus.orders)

    @cached_property
    def passing(self) -> Transfer:
        """Its motions by forces at the frequencies of the motion."""
        return transfer(self.machine, self.torus.frequencies, self.torus.omega)

    @cached_property
    def loads(self) -> Loads:
        """The forces of the films at all phases, with their derivatives."""
        return film_loads(self.machine, *moments_of(self.torus), self.torus.omega)

    @cached_property
    def inner(self) -> Complex:
        """(m, c) g_jk + kappa u_jk."""
        return self.analysed(self.loads.values) + self.passing.kappa * self.torus.motion

    @cached_property
    def by_nu(self) -> Complex:
        """(m, c) derivative of the residual by nu."""
        torus, passing, j = self.torus, self.passing, self.torus.orders[:, :1]
        rate = self.sampled(1j * j * torus.motion).reshape(-1, self.machine.size)
        felt = self.analysed(np.einsum("nij,nj->ni", self.loads.by_v, rate))
        felt += j * passing.kappa_by_frequency * torus.motion
        return -j * through(passing.by_frequency, self.inner) - through(passing.values, felt)

    @cached_property
    def row(self) -> Array:
        """The row of the phase condition, one for the harmonics with k = 0, see phase_row of balance.py."""
        j, k = self.torus.orders.T
        row = packed(1j * np.where(k == 0, j, 0)[:, None] * self.reference)
        return np.asarray(row / np.linalg.norm(row))

    def sampled(self, motion: Complex) -> Array:
        """(n_a, n_b, c): a motion (m, c) at all phases."""
        return samples(self.torus.orders, motion, self.counts)

    def analysed(self, values: Array) -> Complex:
        """(m, ...) harmonics of values (n_a n_b, ...) at all phases."""
        return harmonics(values.reshape(*self.counts, -1), self.torus.orders)

    def residual(self, driven: Sequence[tuple[int, Complex]]) -> Array:
        """(n,), the phase last. driven: see driven_motions."""
        torus = self.torus
        out = torus.motion - through(self.passing.values, self.inner)
        out[0] -= self.machine.rest
        for order, moved in driven:
            out[(torus.orders == [0, order]).all(axis=1)] -= moved
        return np.append(packed(out), self.row @ packed(torus.motion - self.reference))

    def moved(self, step: Array) -> Array:
        """What a step of the harmonics and of nu / pace changes in the residual."""
        torus, passing, c = self.torus, self.passing, self.machine.size
        du = unpacked(step[:-1], c)
        u = self.sampled(du).reshape(-1, c)
        v = self.sampled(1j * torus.frequencies[:, None] * du).reshape(-1, c)
        felt = np.einsum("nij,nj->ni", self.loads.by_u, u) + np.einsum("nij,nj->ni", self.loads.by_v, v)
        out = du - through(passing.values, self.analysed(felt) + passing.kappa * du)
        out += step[-1] * self.machine.pace * self.by_nu
        return np.append(packed(out), self.row @ step[:-1])

    def newton_step(self, residual: Array) -> Array:
        """The step (n,) that removes a residual."""
        if len(residual) <= DENSE:
            return np.asarray(np.linalg.solve(self.matrix(), -residual))
        from scipy.sparse.linalg import LinearOperator, gmres

        n, nearly = len(residual), _ByMean(self)
        step, _ = gmres(
            LinearOperator((n, n), self.moved),
            -residual,
            rtol=INEXACT,
            restart=KRYLOV,
            maxiter=1,
            M=LinearOperator((n, n), nearly.solved),
        )
        return np.asarray(step)

    def matrix(self) -> Array:
        """(n, n): of `moved`."""
        torus, passing, (m, c) = self.torus, self.passing, self.torus.motion.shape
        by_u, by_v = (
            np.fft.fft2(slope.reshape(*self.counts, c, c), axes=(0, 1), norm="forward")
            for slope in (self.loads.by_u, self.loads.by_v)
        )
        by = np.concatenate([-torus.orders[:0:-1], torus.orders])
        apart = torus.orders[:, None] - by[None, :]
        place = apart[..., 0], apart[..., 1]
        rates = 1j * np.concatenate([-torus.frequencies[:0:-1], torus.frequencies])
        slope = (by_u[place] + rates[:, None, None] * by_v[place]).transpose(0, 2, 1, 3)
        same = np.arange(m)
        slope[same, :, m - 1 + same, :] += passing.kappa[:, :, None] * np.eye(c)
        felt = -np.einsum("kij,kjlm->kilm", passing.values, slope)
        felt[same, :, m - 1 + same, :] += np.eye(c)
        by_nu = self.machine.pace * packed(self.by_nu)
        return np.block([[as_real(felt), by_nu[:, None]], [self.row, np.zeros(1)]])


class _ByMean:
    """Linearised with the derivatives of the films replaced by their mean over b, which decouples harmonics of
    different k."""

    def __init__(self, balance: Linearised) -> None:
        from scipy.linalg import lu_factor

        self.balance, (j, k), c = balance, balance.torus.orders.T, balance.machine.size
        by_u, by_v = (
            np.fft.fft(slope.reshape(*balance.counts, c, c).mean(axis=1), axis=0, norm="forward")
            for slope in (balance.loads.by_u, balance.loads.by_v)
        )
        self.places = [np.flatnonzero(k == each) for each in np.unique(k)]
        self.factors = []
        for number, own in enumerate(self.places):
            orders = j[own]
            rates, passing = 1j * balance.torus.frequencies[own], balance.passing.values[own]
            kappa = balance.passing.kappa[own]
            if number == 0:  # with the conjugate ones
                orders, rates = _with_conjugate(orders, -1.0), _with_conjugate(rates)
                passing, kappa = _with_conjugate(passing), _with_conjugate(kappa)
            apart = orders[:, None] - orders[None, :]
            slope = by_u[apart] + rates[None, :, None, None] * by_v[apart]
            same = np.arange(len(orders))
            slope[same, same] += kappa[:, :, None] * np.eye(c)
            matrix = -np.einsum("jab,jlbd->jald", passing, slope).reshape(len(orders) * c, -1)
            matrix[np.arange(len(matrix)), np.arange(len(matrix))] += 1.0
            self.factors.append(lu_factor(self.bordered(matrix, own) if number == 0 else matrix, check_finite=False))

    def bordered(self, matrix: Complex, own: NDArray[np.int64]) -> Complex:
        """The equations of k = 0 with nu / pace and the phase."""
        by_nu = self.balance.machine.pace * _with_conjugate(self.balance.by_nu[own]).ravel()
        row = unpacked(self.balance.row, self.balance.machine.size)[own]
        return np.block([[matrix, by_nu[:, None]], [0.5 * _with_conjugate(np.conj(row)).ravel(), np.zeros(1)]])

    def solved(self, residual: Array) -> Array:
        """The step (n,) that makes a residual there."""
        from scipy.linalg import lu_solve

        c = self.balance.machine.size
        right = unpacked(residual[:-1], c)
        step, along = np.zeros_like(right), 0.0
        for number, own in enumerate(self.places):
            if number == 0:
                wanted = np.append(_with_conjugate(right[own]).ravel(), residual[-1])
                found = lu_solve(self.factors[0], wanted, check_finite=False)
                along = float(found[-1].real)
                step[own] = found[: len(own) * c].reshape(-1, c)
                continue
            wanted = right[own] - along * self.balance.machine.pace * self.balance.by_nu[own]
            step[own] = lu_solve(self.factors[number], wanted.ravel(), check_finite=False).reshape(-1, c)
        return np.append(packed(step), along)


def _with_conjugate(values: NDArray[Any], sign: float | None = None) -> NDArray[Any]:
    """Values of the orders 0, j > 0 with those of -j behind them: conjugate, or times a sign."""
    behind = np.conj(values[1:]) if sign is None else (sign * values[1:]).astype(values.dtype)
    return np.concatenate([values, behind])


def left_out(machine: Machine, torus: Torus) -> Orders:
    """(l, 2): the orders beyond those of a motion that would have more than TAIL."""
    known = {tuple(order) for order in torus.orders.tolist()}
    far = np.abs(torus.orders).max(axis=0) + MARGIN
    box = np.array([(j, k) for k in range(far[1] + 1) for j in range(-far[0], far[0] + 1) if k > 0 or j > 0])
    beyond = np.array([order for order in box.tolist() if tuple(order) not in known])
    balance = Linearised(machine, torus, torus.motion)
    loads = harmonics(balance.loads.values.reshape(*balance.counts, -1), beyond)
    passing = transfer(machine, beyond @ np.array([torus.nu, torus.omega]), torus.omega)
    return np.asarray(beyond[np.abs(through(passing.values, loads)).max(axis=1) > TAIL])
