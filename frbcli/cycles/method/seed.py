"""A cycle to begin with where the speed range has no Hopf point: the rotor whirls at all of its speeds.

The springs and dashpots kappa beside the films (machine.py) are left there in the share a. With enough of them the
rotor rests; as a falls a whirl is born at a Hopf point in a, and its cycles are followed to a = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.branch import STRIDES
from frbcli.cycles.method.continuation import Place, Strides, corrected, follow, halved_until, next_length, unit_vector
from frbcli.cycles.method.cycle import largest, place_at_rest, resized_like
from frbcli.cycles.method.equilibria import Equilibrium
from frbcli.cycles.method.follower import Follower, at_speed
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine, film_loads, transfer
from frbcli.equilibrium.hopf import whirls
from frbcli.rotor.order import first_largest

RISE = Strides(first=0.02, shortest=1e-6, longest=0.2, points=400)
MOST = 50.0  # share up to which springs and dashpots are added
HALVINGS = 40


def seed_cycle(machine: Machine, resting: Equilibrium) -> Array | None:
    """A cycle, see balance.py, at the speed of an unstable resting position; None if none was found."""
    hopf = _stabilised(machine, resting)
    if hopf is None:
        return None
    follower, place, length = Follower(machine, 0.0, 0.0, omega=resting.omega), hopf, STRIDES.first
    for _ in range(STRIDES.points):
        found, length = halved_until(partial(follower.stepped, place), length, STRIDES.shortest)
        if found is None or largest(machine, found.y) > 1.0:
            return None
        if found.y[-1] <= 0.0:
            there = at_speed(follower, place, found, 0.0)
            return None if there is None else follower.as_cycle(there.y)
        length = next_length(length, STRIDES, resized_like(place, found, machine.size), found)
        place = found
    return None


def _stabilised(machine: Machine, resting: Equilibrium) -> Place | None:
    """The Hopf point in a, as the place of a cycle of no size that is followed down in a."""
    space, ask = state_space(machine), _equations(machine, resting.omega)
    along = unit_vector(machine.size + 1)
    low = corrected(ask, np.append(resting.u, 0.0), along)
    if low is None:
        return None
    for high, _ in follow(ask, low, RISE):
        if high.y[-1] > MOST:
            return None
        if _critical(machine, space, high.y, resting.omega)[0].real < 0.0:
            break
        low = high
    else:
        return None
    ends = [low.y, high.y]
    for _ in range(HALVINGS):
        found = corrected(ask, 0.5 * (ends[0] + ends[1]), along)
        if found is None:
            return None
        ends[_critical(machine, space, found.y, resting.omega)[0].real < 0.0] = found.y
    value, mode = _critical(machine, space, ends[0], resting.omega)
    return place_at_rest(ends[0][:-1], mode, value.imag / machine.pace, float(ends[0][-1]))


def _equations(machine: Machine, omega: float) -> Callable[[Array], tuple[Array, Array]]:
    """Equations of a resting position y = (u, a) at a speed, see equilibria.py."""
    passing = transfer(machine, np.zeros(1), omega)
    through, kappa = passing.values[0].real, passing.kappa[0].real
    on_films = np.arange(machine.size) < 2 * machine.film_count

    def at(y: Array) -> tuple[Array, Array]:
        u, left = y[:-1], np.where(on_films, 1.0 - y[-1], 1.0)
        loads = film_loads(machine, u[None], np.zeros((1, len(u))), omega)
        residual = u - through @ (loads.values[0] + left * kappa * u) - machine.rest
        slope = np.eye(len(u)) - through @ (loads.by_u[0] + np.diag(left * kappa))
        return residual, np.column_stack([slope, through @ (on_films * kappa * u)])

    return at


def _critical(machine: Machine, space: StateSpace, y: Array, omega: float) -> tuple[complex, Complex]:
    """The oscillating eigenvalue with the largest real part at a resting position (u, a), and its mode (c,)."""
    loads = film_loads(machine, y[None, :-1], np.zeros((1, machine.size)), omega)
    spring, dashpot = np.zeros(machine.size), np.zeros(machine.size)
    spring[: 2 * machine.film_count] = np.repeat(machine.spring, 2)
    dashpot[: 2 * machine.film_count] = np.repeat(machine.dashpot, 2)
    by_u, by_v = loads.by_u[0] - y[-1] * np.diag(spring), loads.by_v[0] - y[-1] * np.diag(dashpot)
    values, vectors = np.linalg.eig(space.matrix(omega, by_u, by_v))
    found = whirls(values)
    if not len(found):
        return complex(-1.0, 0.0), np.zeros(machine.size, dtype=complex)
    own = found[0]
    mode = space.read @ vectors[:, own]
    return complex(values[own]), np.asarray(mode / mode[first_largest(mode[: 2 * machine.film_count])])
