"""Limit cycles over a number of the case other than the speed, which is kept: a clearance, a viscosity.

The last unknown of branches is the number over its largest value. A machine is made for each value, see
method/courses.py.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from frbcli.case.schema import Case
from frbcli.compilation import working_time
from frbcli.cycles.diagram import Observer, Walk, diagram, with_hopf_errors
from frbcli.cycles.family import Family, check, positive_range
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.equilibria import Resting, at_rest, hopf_points, settled
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.method.mesh_error import OtherMesh, other_films, why_no_error
from frbcli.cycles.result import LimitCycles
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import NotConverged
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.remedies import advised

POINTS = 41  # static equilibria of the diagram


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
    begun = working_time().cpu_s
    check(case)
    first, last, unit = positive_range(case, key, low, high)
    family = Family(case, key, last, unit, 2.0 * math.pi * speed_Hz)
    try:
        resting = resting_over(family, first / last)
    except Unreachable:
        raise NotConverged(f"The static equilibria could not be followed over {key}.") from None
    plan, lowest = make_plan(family.case_at(1.0)), first / last
    meshes = tuple(
        OtherMesh(Follower(family.on_mesh(number), lowest), other.share)
        for number, other in enumerate(other_films(plan))
    )
    walk = Walk(resting, Follower(family, lowest), meshes, why_no_error(plan))
    computed = with_hopf_errors(diagram(case, walk, observe, lambda: working_time().cpu_s - begun), walk)
    return replace(computed, cost=replace(computed.cost, cpu_s=working_time().cpu_s - begun))


def resting_over(family: Family, lowest: float) -> Resting:
    """Static equilibria over the key, ascending, sought from the largest value on. Raises Unreachable, NotConverged."""
    with advised(family.case):
        near = at_rest(family.top, resting_position(family.system(1.0), family.speed))
    points = []
    for share in np.linspace(1.0, lowest, POINTS):
        points.append(settled(family, near, float(share)))
        near = points[-1].u
    points.reverse()
    return Resting(tuple(points), hopf_points(family, points), "")
