"""The machine linearised at rest: its matrices on films of eight coefficients each, and its state matrix.

A ring with a pin leans on it, so that small motions see a spring and a damper, without play.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from frbcli.elements.pin import DAMPING, STIFFNESS
from frbcli.equilibrium.coefficients import FilmsAtRest
from frbcli.equilibrium.ring_speed import SUM, by_total, ring_torques, torque_by_rates
from frbcli.rotor.linear import LinearRotor, without_spins
from frbcli.scene.machine.system import System

Array = NDArray[np.float64]


def rotor_at_rest(system: System, omega: float, ring_speeds: Array, at_rest: FilmsAtRest) -> LinearRotor:
    """The machine at omega rad/s without its films. Its rings turn with ring_speeds (rings,) in rad/s, but those with a
    pin: their angles stay, on the spring and the damper of the pin, and see the torques of the films."""
    rotor = without_spins(system.rotor, ring_speeds, system.pinned)
    rings = np.flatnonzero(system.pinned)
    if not len(rings):
        return rotor
    places, films = at_rest.position.journals, at_rest.forces
    _, by_speeds, by_places = ring_torques(system, np.append(omega, ring_speeds), places, films)
    journals = rotor.journals.reshape(-1, rotor.size)
    angles = np.arange(rotor.size - len(rings), rotor.size)
    stiffness, damping = rotor.stiffness.copy(), rotor.damping.copy()
    stiffness[angles] -= by_places[rings] @ journals
    damping[angles] -= torque_by_rates(system, places, films)[rings] @ journals
    stiffness[angles, angles] += system.pins[rings, STIFFNESS]
    damping[angles, angles] += system.pins[rings, DAMPING]
    damping[np.ix_(angles, angles)] -= by_speeds[np.ix_(rings, rings)]
    for i, (many, force) in enumerate(zip(rotor.multiplicity, films, strict=True)):
        turned = np.outer(by_total(force, places[i]), system.turning[i, SUM, 1 + rings])
        damping[:, angles] -= many * rotor.journals[i].T @ turned
    return replace(rotor, stiffness=stiffness, damping=damping)


def linearised(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> tuple[Array, Array, Array]:
    """(n, n) mass, damping and stiffness at omega rad/s, the damping with the gyroscopic term, on films of stiffness
    and damping (films, c, c), SI units, by the c coordinates that the films see."""
    here = rotor.at(omega)
    bearings = here.multiplicity[:, None, None] * np.swapaxes(here.journals, 1, 2)
    k = here.stiffness + (bearings @ stiffness @ here.journals).sum(axis=0)
    d = here.damping + omega * here.gyroscopic + (bearings @ damping @ here.journals).sum(axis=0)
    return here.mass, d, k


def state_matrix(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Array:
    """(2 n, 2 n) of the states (q, q'), as `linearised`."""
    return first_order(*linearised(rotor, omega, stiffness, damping))


def first_order(mass: Array, damping: Array, stiffness: Array) -> Array:
    """(2 n, 2 n) A of x' = A x, x = (q, q'), for M q'' + D q' + K q = 0 with matrices (n, n)."""
    n = len(mass)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, np.hstack([stiffness, damping]))]])
