"""Limit cycles over a number of the case other than the speed, which is kept: a clearance, a viscosity.

The last unknown of branches is the number over its largest value. A machine is made for each value; how the equations
change with it is a central difference.
"""

from __future__ import annotations

import math
import time

import numpy as np
from numpy.typing import NDArray

from frbcli.case.schema import Case
from frbcli.cycles.branch import MOST_UNKNOWNS, Follower
from frbcli.cycles.diagram import Observer, Walk, diagram
from frbcli.cycles.family import Family, positive_range
from frbcli.cycles.faults import check
from frbcli.cycles.method.balance import Balance, unpacked
from frbcli.cycles.method.continuation import Equations, Place, Unreachable
from frbcli.cycles.method.equilibria import Resting, at_rest, hopf_points, settled
from frbcli.cycles.parts.linearised import StateSpace, state_space
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.result import LimitCycles
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import NotConverged
from frbcli.scene.remedies import advised

Array = NDArray[np.float64]

POINTS = 41  # resting positions of the diagram
DIFFERENCE = 1e-5  # of the largest value


class KeyFollower(Follower):
    """Follows branches over the key."""

    most_at_fold = MOST_UNKNOWNS  # each of its equations takes three machines

    def __init__(self, family: Family, lowest: float) -> None:
        machine = family.machine(1.0)
        super().__init__(machine, lowest * machine.pace, machine.pace, omega=family.omega)
        self.family = family

    def machine_at(self, y: Array) -> Machine:
        """The machine at the value of the key in which y ends, over its largest one."""
        return self.family.machine(float(y[-1]))

    def space_at(self, y: Array) -> StateSpace:
        """All states of that machine."""
        return state_space(self.machine_at(y))

    def told(self, y: Array) -> str:
        """The value of the key at y with its unit."""
        return f"{y[-1] * self.family.high:.4g} {self.family.unit}".rstrip()

    def equations(self, place: Place) -> Equations:
        """Those of the cycles about a place at the speed of the family; derivatives by the key are differences."""
        moving = place.y if self.moves(place.y) else place.tangent
        reference = unpacked(moving[:-2], self.machine.size)

        def at(y: Array) -> tuple[Array, Array]:
            if not y[-1] > DIFFERENCE:
                raise Unreachable
            cycle, share = self.as_cycle(y), float(y[-1])
            residual, slope = Balance(self.family.machine(share), reference)(cycle)
            ahead, _ = Balance(self.family.machine(share + DIFFERENCE), reference)(cycle)
            behind, _ = Balance(self.family.machine(share - DIFFERENCE), reference)(cycle)
            slope[:, -1] = (ahead - behind) / (2.0 * DIFFERENCE)
            return residual, slope

        return at


def limit_cycles_over(
    case: Case, key: str, low: str, high: str, speed_Hz: float, observe: Observer | None = None
) -> LimitCycles:
    """Compute a diagram as `limit_cycles` does, over a key of the case at one rotor speed.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    key : str
        A number of the machine, such as "bearing.clearance".
    low, high : str
        Values between which it varies, with units, both above zero.
    speed_Hz : float
        Rotor speed in Hz.
    observe : callable, optional
        As of `limit_cycles`, with the value of the key.

    Returns
    -------
    LimitCycles
        The diagram.

    Raises
    ------
    InputError
        As `limit_cycles`, and for a key that is no number of the machine.
    NotConverged
        As `limit_cycles`.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.limit_cycles_over(case, "oil.viscosity", "8 mPa*s", "14 mPa*s", 200.0)  # doctest: +SKIP
    """
    begun = time.process_time()
    check(case)
    first, last, unit = positive_range(case, key, low, high)
    family = Family(case, key, last, unit, 2.0 * math.pi * speed_Hz)
    try:
        resting = resting_over(family, first / last)
    except Unreachable:
        raise NotConverged(f"The resting positions could not be followed over {key}.") from None
    walk = Walk(
        over=key,
        unit=unit,
        films=family.machine(1.0).names,
        course=family,
        resting=resting,
        scale=last,
        follower=KeyFollower(family, first / last),
        branch_scale=last,
    )
    return diagram(case, walk, observe, lambda: time.process_time() - begun)


def resting_over(family: Family, lowest: float) -> Resting:
    """Resting positions over the key, ascending, sought from the largest value on. Raises Unreachable,
    NotConverged."""
    with advised(family.case):
        near = at_rest(family.machine(1.0), resting_position(family.system(1.0), family.omega))
    points = []
    for share in np.linspace(1.0, lowest, POINTS):
        points.append(settled(family.machine(float(share)), near, family.omega, float(share)))
        near = points[-1].u
    points.reverse()
    return Resting(tuple(points), hopf_points(family, points), "")
