"""First Lyapunov coefficient of a Hopf point: whether the whirl that is born there is stable (supercritical).

On the centre manifold the amplitude z of the critical mode q, x = z q + conj(z q) + ..., obeys

    z' = (sigma + i nu) z + c_1 z |z|^2 + ...,      l_1 = Re c_1 / nu,
    2 c_1 = p . (C(q, q, conj q) + 2 B(q, h_11) + B(conj q, h_20)),
    h_11 = -A^-1 B(q, conj q),      h_20 = (2 i nu - A)^-1 B(q, q),

with the second and third derivatives B and C of the films' loads and the left eigenvector p, p . q = 1 (Kuznetsov,
Elements of Applied Bifurcation Theory, (3.20)). All of them are harmonics of the loads along an ellipse of the mode:
the motion is put into the films with a small radius r, and what is left of higher order in r removed by extrapolation.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.equilibria import HopfPoint
from frbcli.cycles.parts.machine import film_loads
from frbcli.cycles.parts.states import state_space
from frbcli.film.kinds.samples import have_closed_forms

States = Mapping[int, NDArray[Any]]

ANGLES = 32
SMOOTH = 0.02  # radius over the gap in closed forms
LEVELS = 4  # radii, each half of the one before, of a closed form
# Radii in tables, whose third derivatives jump between cells: an ellipse has to pass over some.
TABULATED = (0.1, 0.15, 0.2)


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
