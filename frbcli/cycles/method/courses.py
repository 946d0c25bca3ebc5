"""What rest and cycles of a machine are followed over: the speed of its rotor, or another number of the case.

The unknowns of rest are y = (u, share), of a cycle y = (motion, nu / pace, share); the share is the number over its
largest value. Equations hold for one machine; a course turns them into equations over its number, along which the
machine may change. """

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import unpacked
from frbcli.cycles.method.continuation import Equations
from frbcli.cycles.method.floquet import Multipliers
from frbcli.cycles.method.machine import Machine
from frbcli.cycles.method.states import StateSpace, state_space
from frbcli.cycles.result import SPEED, hertz

EquationsOf = Callable[[Machine], Equations]  # of one machine, y ending with the speed of its rotor over the pace
MachineAt = Callable[[float], Machine]  # by the share
AtItsHeat = Callable[[Array, Array, float], Machine]

# Unknowns of a cycle up to which harmonics are added for the trivial multiplier alone, of one film and of several; the
# same at a fold, next to which a film may be nearly at rest for a moment.
MOST_UNKNOWNS, MOST_AT_FOLD = (1100, 450), (2400, 450)
DIFFERENCE = 1e-5  # of the share, which is of the order of 1
NEAR = 1e-3  # of it: between the three machines that represent all near a value
KEPT = 64  # machines


class MachineCourse:
    """The speed of a rotor, over which the machine stays the same. over, unit: name and unit of the number; machine_at:
    the machine at a share, as far as the number alone determines it; at_its_heat: gives the machine at the temperatures
    that moments of a motion balance, u and its rate (n, c), at a speed in rad/s, None without heat; most_at_fold: see
    MOST_AT_FOLD."""

    over, unit = SPEED, "Hz"
    at_its_heat: AtItsHeat | None = None
    most_at_fold = MOST_AT_FOLD

    def __init__(self, only: Machine) -> None:
        self.machine_at: MachineAt = lambda _: only

    @cached_property
    def top(self) -> Machine:
        """The machine at the largest value, whose sizes and pace the others have."""
        return self.machine_at(1.0)

    @property
    def scale(self) -> float:
        """The largest value, in the unit."""
        return hertz(self.top.pace)

    def machine(self, y: Array) -> Machine:
        """The machine of unknowns."""
        return self.machine_at(float(y[-1]))

    def with_speed(self, y: Array) -> Array:
        """Unknowns with the speed of the rotor over the pace at their end."""
        return y

    def harmonics(self, y: Array) -> tuple[Complex, float, float]:
        """(H + 1, c) harmonics of a cycle or of rest, its frequency, 0 at rest, and the speed of the rotor in rad/s."""
        y, c, pace = self.with_speed(y), self.top.size, self.top.pace
        if len(y) == c + 1:
            return unpacked(y[:-1], c), 0.0, float(y[-1] * pace)
        return unpacked(y[:-2], c), float(y[-2] * pace), float(y[-1] * pace)

    def equations(self, of: EquationsOf, _near: Array | None = None) -> Equations:
        """The equations over the number. near: unknowns close by."""
        return of(self.top)

    def equations_at(self, of: EquationsOf, near: Array) -> Equations:
        """The equations at the number of unknowns close by; by the number alone they may change in another way."""
        return self.equations(of, near)

    def equations_near(self, of: EquationsOf, near: Array) -> Equations:
        """The equations next to the number of unknowns close by."""
        return self.equations(of, near)

    def states(self, _machine: Machine) -> StateSpace:
        """The states of a machine of the course."""
        return self._states

    def multipliers(self, fast: Multipliers, _y: Array, _slope: Callable[[Machine], Array]) -> Multipliers:
        """The multipliers of a cycle y, with the ones of states that follow its mean, such as temperatures. slope:
        gives the derivative (n, n) of a machine's equations by the motion."""
        return fast

    @cached_property
    def _states(self) -> StateSpace:
        return state_space(self.top)


class Changing(MachineCourse):
    """The speed of a rotor, or another number, along which the machine is another one at each value. How the equations
    change with it is a central difference. omega: a speed of the rotor in rad/s that is kept while the number is
    another one."""

    def __init__(self, made: MachineAt, omega: float | None = None) -> None:
        self.machine_at = lru_cache(KEPT)(made)
        self.omega = omega

    def with_speed(self, y: Array) -> Array:
        """See MachineCourse."""
        return y if self.omega is None else np.append(y[:-1], self.omega / self.top.pace)

    def equations(self, of: EquationsOf, _near: Array | None = None) -> Equations:
        """See MachineCourse."""

        def at(y: Array) -> tuple[Array, Array]:
            last = float(y[-1])
            residual, slope = self.staying(of, last)(y)
            ahead, behind = (self.staying(of, last + sign * DIFFERENCE)(y)[0] for sign in (1.0, -1.0))
            slope[:, -1] += (ahead - behind) / (2.0 * DIFFERENCE)
            return residual, slope

        return at

    def equations_at(self, of: EquationsOf, near: Array) -> Equations:
        """Equations of one machine, see MachineCourse."""
        return self.staying(of, float(near[-1]))

    def equations_near(self, of: EquationsOf, near: Array) -> Equations:
        """Parabolas through the equations of three machines, at the value and on both sides, see MachineCourse."""
        last = float(near[-1])
        staying = [self.staying(of, last + off) for off in (-NEAR, 0.0, NEAR)]

        def at(y: Array) -> tuple[Array, Array]:
            off = (float(y[-1]) - last) / NEAR
            weights = np.array([0.5 * off * (off - 1.0), 1.0 - off**2, 0.5 * off * (off + 1.0)])
            changes = np.array([off - 0.5, -2.0 * off, off + 0.5]) / NEAR
            residuals, slopes = map(np.array, zip(*(each(y) for each in staying), strict=True))
            slope = np.tensordot(weights, slopes, 1)
            slope[:, -1] += changes @ residuals
            return weights @ residuals, slope

        return at

    def states(self, machine: Machine) -> StateSpace:
        """See MachineCourse."""
        return state_space(machine)

    def staying(self, of: EquationsOf, share: float) -> Equations:
        """The equations of the machine at a fixed share."""
        asked = of(self.machine_at(share))

        def at(y: Array) -> tuple[Array, Array]:
            residual, slope = asked(self.with_speed(y))
            if self.omega is not None:
                slope[:, -1] = 0.0
            return residual, slope

        return at
