"""A long shaft as its films see it, for the multipliers of cycles: fewer states, the same transfer to the journals.

Modes far above the whirl follow the films at once, and what they add to the displacements of the journals is nearly
always the same. The motions that films and unbalance make behind them, at frequencies of both signs and at several
speeds, depend on each other but for little; their principal components (proper orthogonal decomposition) replace the
modes, as many as the transfer T_k of machine.py needs. Both planes have the same ones. Motions of whirls and of their
first harmonics weigh most: of the higher ones a disturbance has little.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.parts.rotor_parts import Part

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
