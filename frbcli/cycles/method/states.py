"""A machine with its states, for what is linear: eigenvalues at rest and multipliers of a cycle.

x = (q, q', s) with the displacements q of the rotor and the speeds s of the rings over the pace obeys

    x' = A_0(Omega) x + B g,      u = R x,      u' = S x (journals)

with the loads g of the films, so that films linearised at some moment make A_0 + B (dg/du R + dg/du' S) of it.

A long shaft as its films see it has fewer states and the same transfer to the journals, for the multipliers of cycles.
Modes far above the whirl follow the films at once, and what they add to the displacements of the journals is nearly
always the same. The motions that films and unbalance make behind them, at frequencies of both signs and at several
speeds, depend on each other but for little; their principal components (proper orthogonal decomposition) replace the
modes, as many as the transfer T_k of machine.py needs. Both planes have the same ones. Motions of whirls and of their
first harmonics weigh most: of the higher ones a disturbance has little."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.machine import Machine, Part
from frbcli.equilibrium.linearised import first_order


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


SLOW, SEEN = 1.0, 4.0  # frequencies over the largest speed up to which half of them lie, and the others
FREQUENCIES, SPEEDS = 48, (0.0, 0.5, 1.0)  # how many, and at which speeds over the largest one
WEIGHTY = 0.125  # frequency over the largest speed from which on motions weigh less, with its fourth power
TOLERANCE = 1e-6  # of T_k kappa_k, whose size is 1, with that weight
WORTH = 0.75  # share of the modes above which all are kept


def reduced_space(machine: Machine) -> StateSpace:
    """The states of a machine with fewer modes of its rotor; all of them if the planes differ or only few could go."""
    part, rotor = machine.parts[0], machine.rotor
    if part.planes is None:
        return state_space(machine)
    components, error, n = _components(machine, part), _errors(machine, part), len(part.basis)
    for count in range(part.basis.shape[1], int(WORTH * n) + 1):
        if error(components[:, :count]) < TOLERANCE:
            break
    else:
        return state_space(machine)
    basis = np.zeros((rotor.size, 2 * count))
    for plane, own in zip(part.planes, (slice(0, count), slice(count, None)), strict=True):
        basis[plane, own] = components[:, :count]
    across = basis.T
    less = replace(
        rotor,
        mass=across @ rotor.mass @ basis,
        damping=across @ rotor.damping @ basis,
        gyroscopic=across @ rotor.gyroscopic @ basis,
        stiffness=across @ rotor.stiffness @ basis,
        journals=rotor.journals @ basis,
    )
    return state_space(replace(machine, rotor=less))


def _components(machine: Machine, part: Part) -> Array:
    """(n, n) principal components of the motions in a plane, orthogonal with the mass, in falling order."""
    s, omega = _asked(machine, 0.0)
    moved = _moved(part, s, omega)
    sizes = np.linalg.norm(moved, axis=1).max(axis=0)
    moved *= _weight(machine, s) / np.where(sizes > 0.0, sizes, 1.0)  # a rotor may have no unbalance
    columns = np.hstack([*moved.real, *moved.imag])
    root = np.linalg.cholesky(part.matrices[0].real)
    left, _, _ = np.linalg.svd(root.T @ columns, full_matrices=False)
    return np.asarray(np.linalg.solve(root.T, left))


def _errors(machine: Machine, part: Part) -> Callable[[Array], float]:
    """The largest weighted difference that components make in T_k kappa_k, between the frequencies of the motions."""
    s, omega = _asked(machine, 0.5)
    films = 2 * machine.film_count
    kappa = np.repeat(machine.spring + np.outer(s, machine.dashpot), 2, axis=1)[:, None] * _weight(machine, s)

    def passed(one: Part) -> Complex:
        return np.asarray(one.seen @ (one.basis.T @ _moved(one, s, omega)[:, :, :films]) * kappa)

    exact = passed(part)

    def error(kept: Array) -> float:
        across = kept.T
        less = replace(
            part, matrices=across @ part.matrices @ kept, basis=across @ part.basis, others=across @ part.others
        )
        return float(np.abs(passed(less) - exact).max())

    return error


def _asked(machine: Machine, shift: float) -> tuple[Complex, Array]:
    """Frequencies i nu and speeds in rad/s. shift: of the frequencies, over the distance between them."""
    steps = (np.arange(FREQUENCIES // 2) + shift) / (FREQUENCIES // 2)
    sizes = np.concatenate([SLOW * steps, SLOW + (SEEN - SLOW) * steps])
    s, speeds = np.meshgrid(1j * machine.pace * np.concatenate([sizes, -sizes]), machine.pace * np.array(SPEEDS))
    return s.ravel(), speeds.ravel()


def _weight(machine: Machine, s: Complex) -> Array:
    """(m, 1, 1)."""
    return np.asarray(1.0 / (1.0 + (np.abs(s) / (WEIGHTY * machine.pace)) ** 4))[:, None, None]


def _moved(part: Part, s: Complex, omega: Array) -> Complex:
    """(m, n, 2 F + l) the motions that the loads make."""
    given = np.hstack([part.basis @ part.given, part.others])
    return np.asarray(np.linalg.solve(part.dynamic(s, omega), np.broadcast_to(given, (len(s), *given.shape))))
