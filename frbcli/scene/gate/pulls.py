"""Magnetic pulls against what holds the rotor."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from frbcli.arrays import Array
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.elements.forces import MagneticPullElement
from frbcli.errors import Fault
from frbcli.rotor.assembly import LinearRotor
from frbcli.scene.machine.rotor import make_rotor
from frbcli.units import display

NEARLY = 0.99  # of the pull at which the rotor has no stiffness: what the remedy says


def pull_faults(case: Case) -> Iterator[Fault]:
    """Pulls that the shaft and what else holds the rotor do not resist, also if the films were rigid."""
    if not case.magnetic_pulls or case.given_rotor is None:
        return
    pulled = make_rotor(case)
    free = make_rotor(altered(case, {"magnetic_pulls": ()}))
    share = _share(free, free.stiffness - pulled.stiffness)
    if share >= 1.0:
        for each in MagneticPullElement.of(case):
            films = ", with films that do not give way" if case.films else ""
            problem = f"is {share:.3g} times what shaft and bearings hold{films}: the rotor is statically unstable."
            remedy = f"Give at most {display(NEARLY * each.given.pull / share, 'N/m')}, or a stiffer rotor."
            yield Fault(f"{each.key}.pull", display(each.given.pull, "N/m"), None, problem, remedy)


def _share(rotor: LinearRotor, pulls: Array) -> float:
    """All pulls (n, n) over those at which the rotor at rest has a motion without stiffness, 0 where they have none."""
    k = rotor.at(0.0).stiffness
    moving = k.any(axis=1) | pulls.any(axis=1)  # without the angles of rings
    held = rotor.journals.reshape(-1, rotor.size)[:, moving]
    _, sizes, right = np.linalg.svd(held) if len(held) else (None, np.zeros(0), np.eye(int(moving.sum())))
    free = right[int(np.sum(sizes > 1e-9 * sizes.max(initial=0.0))) :].T
    if not free.size:
        return 0.0
    k, pulls = (free.T @ each[np.ix_(moving, moving)] @ free for each in (k, pulls))
    shares = np.linalg.eigvals(np.linalg.lstsq(k, pulls, rcond=None)[0])
    return float(max((each.real for each in shares if abs(each.imag) < 1e-9), default=0.0))
