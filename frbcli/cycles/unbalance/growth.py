"""Whether a motion of two frequencies is stable: how disturbances grow along it (Lyapunov exponents).

One of them neither grows nor decays, a shift of the phase a of the whirl. Two disturbances, kept perpendicular to each
other (Benettin and others 1980), are followed until the first one is seen to grow, or the second one to decay.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.floquet import moments_within, multipliers, through_all, transitions
from frbcli.cycles.parts.linearised import StateSpace
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.unbalance.two_frequencies import Torus

PERIODS = 100  # of the whirl, and at least one of the beat between it and half of the rotor's, before an answer
MOST_INTERVALS = 1_000_000
AT_ONCE = 25  # periods
SEEN = 3.0  # natural logarithm of a growth beyond what a motion that comes and goes makes of a disturbance
DRIFT = 0.3  # logarithm of what the integration may make of the disturbance that neither grows nor decays


def is_stable(
    machine: Machine, space: StateSpace, torus: Torus, cycle: Array, most: int = MOST_INTERVALS
) -> bool | None:
    """Whether all disturbances of a motion decay; None where that is not seen in the most intervals. cycle: y of the
    cycle that the motion is next to, see balance.py, whose multipliers tell how short the intervals have to be."""
    beat = abs(2.0 * torus.nu - torus.omega)
    fewest = PERIODS if beat == 0.0 else max(PERIODS, math.ceil(torus.nu / beat))
    count = multipliers(machine, space, cycle, enough=DRIFT / fewest).intervals
    within, h = moments_within(count), 2.0 * math.pi / (torus.nu * count)
    motion, rate = _along(torus, within / torus.nu)
    vectors = np.linalg.qr(np.random.default_rng(0).standard_normal((len(space.still), 2)))[0]
    grown, asked = np.zeros(2), AT_ONCE + fewest
    for first in range(0, most // count, AT_ONCE):
        if first == AT_ONCE:  # whatever disturbance one begins with turns into those that last
            grown[:] = 0.0
        turned = np.exp(2j * np.pi * np.outer(np.arange(first, first + AT_ONCE), torus.frequencies / torus.nu))
        u, v = (np.tensordot(turned, each, axes=1).real.reshape(-1, machine.size) for each in (motion, rate))
        steps = transitions(machine, space, u, v, torus.omega, h)
        for period in steps.reshape(AT_ONCE, count, *steps.shape[1:]):
            vectors, sizes = np.linalg.qr(through_all(period) @ vectors)
            grown += np.log(np.abs(np.diag(sizes)))
        if first + AT_ONCE >= asked:
            asked += fewest
            if grown[0] > SEEN:
                return False
            if grown[1] < -SEEN:
                return True
    return None


def _along(torus: Torus, t: Array) -> tuple[Complex, Complex]:
    """(m, n, c) what each harmonic adds to a motion and to its rate in 1/s at the times t of the first period."""
    turn = np.exp(1j * np.outer(t, torus.frequencies))
    turn[:, 1:] *= 2.0
    found = turn[:, :, None] * torus.motion
    found = found.transpose(1, 0, 2)
    return found, 1j * torus.frequencies[:, None, None] * found
