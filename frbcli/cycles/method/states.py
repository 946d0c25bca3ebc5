"""A machine with its states, for what is linear: eigenvalues at rest and multipliers of a cycle.

x = (q, q', s) with the displacements q of the rotor and the speeds s of the rings over the pace obeys

    x' = A_0(Omega) x + B g,      u = R x,      u' = S x (journals)

with the loads g of the films, so that films linearised at some moment make A_0 + B (dg/du R + dg/du' S) of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.method.machine import Machine
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
