"""The synchronous response with unbalance, nonlinear: motions of the rotor's own period, stable or not; and motions of
two of its periods, see locked.py.

The equations of a cycle (balance.py) apply with nu = Omega, or 2 nu = Omega, instead of the phase condition, and with
the unbalance in the first or second harmonic, Omega^2 times the motion that it makes behind the films. A force of the
order k acts in k times that harmonic. """

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.branch import Branch, follow_branch
from frbcli.cycles.method.balance import Balance, packed, unpacked
from frbcli.cycles.method.continuation import Equations, Place, corrected, oriented, unit_vector
from frbcli.cycles.method.courses import EquationsOf, MachineCourse
from frbcli.cycles.method.cycle import FIRST_HARMONICS
from frbcli.cycles.method.equilibria import Equilibrium
from frbcli.cycles.method.floquet import FEWEST_INTERVALS, INTERVALS_PER_HARMONIC, Multipliers, monodromy
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.parts.machine import Machine, driven_motions
from frbcli.rotor.loads import largest_first

DIFFERENCE = 1e-6  # of the pace
WHIRLS = 1e-3  # of the clearance: harmonic of the whirl in a motion that is not the synchronous one


class Synchronous(Follower):
    """Follows motions of some periods of the rotor with a share of the unbalance; of one period and with all of it they
    are the synchronous response."""

    free = False

    def __init__(
        self, course: MachineCourse, lowest: float, highest: float = 1.0, periods: int = 1, share: float = 1.0
    ) -> None:
        super().__init__(course, lowest, highest)
        self._motion = partial(synchronous_equations, periods=periods, share=share)

    def motion(self, place: Place) -> EquationsOf:
        """See Follower. The motion itself is the reference: the unbalance holds its phase."""
        return partial(self._motion, reference=unpacked(place.y[:-2], self.machine.size))

    def fast_multipliers(self, machine: Machine, y: Array, _near: Multipliers | None, _enough: float) -> Multipliers:
        """The multipliers of a motion y; none is trivial, since the unbalance holds it in time; the first one is set to
        1."""
        harmonics = (len(y) - 2) // machine.size // 2
        count = max(FEWEST_INTERVALS, INTERVALS_PER_HARMONIC * harmonics)
        values = np.linalg.eigvals(monodromy(machine, self.course.seen_states(machine), y, count)).astype(complex)
        return Multipliers(np.concatenate([[1.0 + 0.0j], values[largest_first(values)]]), 0.0)


def synchronous_equations(machine: Machine, reference: Complex, periods: int = 1, share: float = 1.0) -> Equations:
    """Equations of motions of some periods of the rotor with a share of the unbalance: residual (n,), n = c (2 H + 1) +
    1, the last of periods nu = Omega."""
    balance = Balance(machine, reference)

    def driven(speed: float) -> Array:
        return share * driven_motion(machine, balance.harmonics, periods, speed)

    def at(y: Array) -> tuple[Array, Array]:
        residual, slope = balance(y)
        residual[:-1] -= driven(float(y[-1]))
        ahead, behind = (driven(float(y[-1]) + side * DIFFERENCE) for side in (1.0, -1.0))
        slope[:-1, -1] -= (ahead - behind) / (2.0 * DIFFERENCE)
        residual[-1], slope[-1] = periods * y[-2] - y[-1], 0.0
        slope[-1, -2:] = periods, -1.0
        return residual, slope

    return at


def synchronous_response(follower: Synchronous, resting: Equilibrium) -> Branch | None:
    """The response from the speed of a static equilibrium down to the slowest one that a follower of such motions has;
    None if it does not begin."""
    machine = follower.machine
    motion = np.zeros((first_harmonics(machine, 1) + 1, machine.size), dtype=complex)
    motion[0] = resting.u
    share = resting.omega / machine.pace
    guess = np.concatenate([packed(motion), [share, share]])
    along = -unit_vector(len(guess))
    start = corrected(follower.equations(Place(guess, along)), guess, along)
    if start is None:
        return None
    place = follower.refitted(oriented(start, along))
    if place is None:
        return None
    branch = follow_branch(follower, place)
    return replace(branch, cycles=(follower.cycle(place), *branch.cycles))


def driven_motion(machine: Machine, harmonics: int, periods: int, share: float, theta: float = 0.0) -> Array:
    """The packed motion that unbalance and forces make at a speed over the pace, with the rotor ahead by theta."""
    motion = np.zeros((harmonics + 1, machine.size), dtype=complex)
    for order, driven in driven_motions(machine, share * machine.pace):
        if periods * order <= harmonics:
            motion[periods * order] += np.exp(1j * order * theta) * driven
    return packed(motion)


def first_harmonics(machine: Machine, periods: int) -> int:
    """Harmonics that the motion of some periods of the rotor begins with: enough for all that drives it."""
    return max(FIRST_HARMONICS, periods * max(machine.orders))
