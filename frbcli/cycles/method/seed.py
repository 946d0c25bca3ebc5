"""A cycle to begin with where a course has no Hopf point: the rotor whirls at all of its values.

Springs and dashpots act parallel to its films (machine.py) in the share a. With enough of them the rotor rests; as a
falls a whirl is born at a Hopf point in a, and its cycles are followed to a = 0. """

from __future__ import annotations

from dataclasses import replace

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.method.balance import packed, through
from frbcli.cycles.method.continuation import Equations, Place, Strides, Unreachable, follow, reached, unit_vector
from frbcli.cycles.method.courses import Changing, EquationsOf
from frbcli.cycles.method.equilibria import Equilibrium, HopfPoint, equations, equilibrium, hopf_points
from frbcli.cycles.method.follower import FoldFollower, Follower
from frbcli.cycles.parts.machine import Machine, transfer

RISE = Strides(first=0.02, shortest=1e-6, longest=0.2, points=400)
MOST = 50.0  # share up to which springs and dashpots are added


class _WithoutMultipliers(FoldFollower):
    """Follows cycles as closely as for a diagram, but without multipliers and past folds."""

    tail = Follower.tail

    def fold(self, _place: Place, _length: float) -> Place | None:
        """None: folds on the way are not located."""
        return None


class _Stiffening(Changing):
    """The share of springs and dashpots parallel to the films of a machine, at a speed of its rotor in rad/s."""

    def __init__(self, machine: Machine, omega: float) -> None:
        super().__init__(lambda share: replace(machine, stiffened=share), omega)

    def equations(self, of: EquationsOf, _near: Array | None = None) -> Equations:
        """See MachineCourse: equations that are linear in the share."""

        def at(y: Array) -> tuple[Array, Array]:
            residual, slope = self.staying(of, float(y[-1]))(y)
            motion, nu, omega = self.harmonics(y)
            passing = transfer(self.top, nu * np.arange(float(len(motion))), omega)
            held = np.arange(self.top.size) < 2 * self.top.film_count
            added = packed(through(passing.values, held * passing.kappa * motion))
            slope[: len(added), -1] = added
            return residual, slope

        return at


def seed_cycle(resting: Equilibrium) -> Array | None:
    """A cycle, see balance.py, at the speed of an unstable static equilibrium; None if none was found."""
    course = _Stiffening(resting.machine, resting.omega)
    try:
        hopf = _stabilised(course, resting)
    except Unreachable:
        return None
    if hopf is None:
        return None
    cycles = follow_branch(_WithoutMultipliers(course, 0.0, MOST), first_place(hopf)).cycles
    return cycles[-1].y if cycles and abs(cycles[-1].place.y[-1]) < 1e-12 else None


def _stabilised(course: _Stiffening, resting: Equilibrium) -> HopfPoint | None:
    """The Hopf point in a above which nothing grows. Raises Unreachable."""
    asked, along = course.equations(equations), unit_vector(len(resting.u) + 1)
    start = reached(asked, np.append(resting.u, 0.0), along)
    low = equilibrium(course, start)
    for place, _ in follow(asked, start, RISE):
        high = equilibrium(course, place)
        if high.growth_of(0) < 0.0:
            crossings = hopf_points(course, (low, high))
            return crossings[-1] if crossings else None
        if high.value > MOST:
            return None
        low = high
    return None
