"""The machine linearised at rest: its matrices on films of eight coefficients each, and its state matrix.

The speeds of rings follow small motions, as the torques of films and summits have them: friction falls steeply with
them where a ring sticks. Around films that keep oil, which is linearised for one speed, they stand. A ring with a pin
leans on it, so that small motions see a spring and a damper, without play.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from frbcli.elements.pin import DAMPING, STIFFNESS
from frbcli.equilibrium.coefficients import FilmsAtRest
from frbcli.equilibrium.ring_speed import SUM, by_total, ring_torques, rubbed_rings, torque_by_rates
from frbcli.rotor.linear import LinearRotor, without_spins
from frbcli.scene.machine.system import System

Array = NDArray[np.float64]


def rotor_at_rest(system: System, omega: float, ring_speeds: Array, at_rest: FilmsAtRest) -> LinearRotor:
    """The machine at omega rad/s without its films. The angles of its rings are degrees of freedom and see the torques
    of their films and summits; of rings with a pin its spring and its damper, too. Around films that keep oil rings
    without a pin turn with ring_speeds (rings,) in rad/s."""
    follow = np.full(system.ring_count, not system.remembers) | system.pinned
    rotor = without_spins(system.rotor, ring_speeds, follow)
    rings = np.flatnonzero(follow)
    if not len(rings):
        return rotor
    places, bodies = at_rest.position.journals, np.append(omega, at_rest.position.ring_speeds)
    rubbed = rubbed_rings(system, bodies, places, at_rest.forces)
    _, by_speeds, by_places = ring_torques(system, bodies, places, rubbed.films)
    by_speeds, by_places = by_speeds + rubbed.torques_by_speed, by_places + rubbed.torques
    by_rates = torque_by_rates(system, places, rubbed.films) + rubbed.torques_by_rate
    journals = rotor.journals.reshape(-1, rotor.size)
    angles = np.arange(rotor.size - len(rings), rotor.size)
    stiffness, damping = rotor.stiffness.copy(), rotor.damping.copy()
    stiffness[angles] -= by_places[rings] @ journals
    damping[angles] -= by_rates[rings] @ journals
    damping[np.ix_(angles, angles)] -= by_speeds[np.ix_(rings, rings)]
    held = np.flatnonzero(system.pinned[rings])
    if len(held):
        pins = system.pins[rings[held]]
        stiffness[angles[held], angles[held]] += pins[:, STIFFNESS]
        damping[angles[held], angles[held]] += pins[:, DAMPING]
    for i, (many, force) in enumerate(zip(rotor.multiplicity, rubbed.films, strict=True)):
        turned = np.outer(by_total(force, places[i]), system.turning[i, SUM, 1 + rings])
        damping[:, angles] -= many * rotor.journals[i].T @ (turned + rubbed.forces_by_speed[i][:, rings])
    turning = tuple(angles[~system.pinned[rings]].tolist())
    return replace(rotor, stiffness=stiffness, damping=damping, turning=turning)


def linearised(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> tuple[Array, Array, Array]:
    """(n, n) mass, damping and stiffness at omega rad/s, the damping with the gyroscopic term, on films of stiffness
    and damping (films, c, c), SI units, by the c coordinates that the films see."""
    here = rotor.at(omega)
    bearings = here.multiplicity[:, None, None] * np.swapaxes(here.journals, 1, 2)
    k = here.stiffness + (bearings @ stiffness @ here.journals).sum(axis=0)
    d = here.damping + omega * here.gyroscopic + (bearings @ damping @ here.journals).sum(axis=0)
    return here.mass, d, k


def state_matrix(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Array:
    """(2 n, 2 n) of the states (q, q'), as `linearised`, q without the angles of rings on which nothing depends."""
    whole = first_order(*linearised(rotor, omega, stiffness, damping))
    kept = np.delete(np.arange(len(whole)), rotor.turning)
    return whole[np.ix_(kept, kept)]


def first_order(mass: Array, damping: Array, stiffness: Array) -> Array:
    """(2 n, 2 n) A of x' = A x, x = (q, q'), for M q'' + D q' + K q = 0 with matrices (n, n)."""
    n = len(mass)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, np.hstack([stiffness, damping]))]])
