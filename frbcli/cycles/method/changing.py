"""Cycles of machines that are another one at each value of the last unknown: of the speed of the rotor, or of a number
of the case. How the equations change with the machine is a central difference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.method.balance import Balance
from frbcli.cycles.method.continuation import Equations, Place
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine

MachineAt = Callable[[float], Machine]  # by the last unknown

DIFFERENCE = 1e-5  # of the last unknown, which is of the order of 1
NEAR = 1e-3  # of it: between the three machines that stand for all next to a value
KEPT = 64  # machines


def kept(made: MachineAt) -> MachineAt:
    """The machines that a function makes, the latest of which are kept."""
    return lru_cache(KEPT)(made)


def by_difference(machine: MachineAt, of: Callable[[Machine], Equations], y: Array) -> tuple[Array, Array]:
    """Residual and derivative at y. of: the equations of a machine, whose derivative by the last unknown is that while
    the machine stays."""
    last = float(y[-1])
    residual, slope = of(machine(last))(y)
    ahead, behind = (of(machine(last + sign * DIFFERENCE))(y)[0] for sign in (1.0, -1.0))
    slope[:, -1] += (ahead - behind) / (2.0 * DIFFERENCE)
    return residual, slope


class ChangingFollower(Follower):
    """Follows branches of such machines. omega: a speed of the rotor in rad/s that is kept while the last unknown is
    another number."""

    def __init__(
        self, machine: MachineAt, slowest: float, fastest: float, asked: Sequence[float] = (),
        omega: float | None = None,
    ) -> None:  # fmt: skip
        super().__init__(machine(1.0), slowest, fastest, asked, omega)
        self._machine = machine

    def machine_at(self, y: Array) -> Machine:
        """The machine at the value in which y ends."""
        return self._machine(float(y[-1]))

    def space_at(self, y: Array) -> StateSpace:
        """All states of the machine at the value in which y ends."""
        return state_space(self.machine_at(y))

    def equations(self, place: Place) -> Equations:
        """Equations of the cycles about a place."""
        reference = self.reference(place)

        def of(machine: Machine) -> Equations:
            return lambda y: self._staying(Balance(machine, reference), y)

        return lambda y: by_difference(self._machine, of, y)

    def equations_at(self, place: Place) -> Equations:
        """See Follower: those of one machine."""
        balance = Balance(self.machine_at(place.y), self.reference(place))
        return lambda y: self._staying(balance, y)

    def equations_near(self, place: Place) -> Equations:
        """See Follower: parabolas through those of three machines, at the value of the place and on both sides."""
        reference, last = self.reference(place), float(place.y[-1])
        balances = [Balance(self._machine(last + off), reference) for off in (-NEAR, 0.0, NEAR)]

        def at(y: Array) -> tuple[Array, Array]:
            off = (float(y[-1]) - last) / NEAR
            weights = np.array([0.5 * off * (off - 1.0), 1.0 - off**2, 0.5 * off * (off + 1.0)])
            changes = np.array([off - 0.5, -2.0 * off, off + 0.5]) / NEAR
            residuals, slopes = map(np.array, zip(*(self._staying(each, y) for each in balances), strict=True))
            slope = np.tensordot(weights, slopes, 1)
            slope[:, -1] += changes @ residuals
            return weights @ residuals, slope

        return at

    def _staying(self, balance: Balance, y: Array) -> tuple[Array, Array]:
        """Residual and derivative at y while the machine stays."""
        residual, slope = balance(self.as_cycle(y))
        if self.omega is not None:
            slope[:, -1] = 0.0
        return residual, slope
