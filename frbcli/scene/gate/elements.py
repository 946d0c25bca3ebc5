"""Rules of squeeze film dampers and magnetic pulls.

The films of dampers carry by squeezing alone: at rest they carry nothing. Pulls are limited by what holds the rotor.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from frbcli.arrays import Array
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.case.surroundings.supports import Damper
from frbcli.elements.forces import MagneticPullElement
from frbcli.elements.supports import DamperElement
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.rotor.assembly import LinearRotor
from frbcli.scene.machine.rotor import make_rotor
from frbcli.units import display


def sheet_faults(case: Case) -> Iterator[Fault]:
    """A sheet has the films between surfaces that turn against each other."""
    if not case.bearings:
        for each in DamperElement.of(case):
            problem = "has the only films of the case, which do not turn: a film of a damper carries nothing at rest."
            yield Fault(each.key, "", None, problem, "Add a bearing with a film.")


def loaded_faults(case: Case) -> Iterator[Fault]:
    """A given load acts on one film."""
    for each in DamperElement.of(case):
        problem = "adds a film to the bearing's, and a given load is the load of a single film."
        yield Fault(each.key, "", None, problem, "Leave the damper out: the sheet is of the film in its shell.")


def rest_faults(case: Case) -> Iterator[Fault]:
    """Where nothing but a film that does not turn holds a shell, a load sinks it."""
    for each in DamperElement.of(case):
        if not all(each.given.spring) and _loaded(case):
            problem = "is missing: the film does not turn and carries no static load, and the shell sinks."
            yield Fault(f"{each.key}.spring", "", None, problem, 'Write e.g. spring = "5e6 N/m", or take a run.')


def linear_faults(case: Case) -> Iterator[Fault]:
    """Films that cavitate as soon as their shell moves have no damping, but in the centre."""
    if not _loaded(case):
        return
    for each in DamperElement.of(case):
        if all(each.given.spring) and not each.given.centred and cavitates_at_once(case, each.given):
            problem = (
                "cavitates as soon as its shell moves: off the centre, to which a static load brings it, the forces of "
                "opposite velocities are not opposite, and no damping describes both."
            )
            remedy = (
                "Take a run; or write centred = true; or raise oil.ambient_pressure, and a supply, above "
                "oil.cavitation_pressure, take "
                "sommerfeld, or leave the weight out, for the damper in its centre."
            )
            yield Fault(f"{each.key}.cavitation", case.cavitation(each.given), None, problem, remedy)


def cavitates_at_once(case: Case, damper: Damper) -> bool:
    """Whether some part of a film at rest has the pressure at which it cavitates."""
    oil, supply = case.oil, damper.supply
    pressures = [oil.ambient_pressure, *([supply.absolute(oil.ambient_pressure)] if supply.feeds else [])]
    return law_named(case.cavitation(damper)).cavitates and min(pressures) <= oil.cavitation_pressure


def _loaded(case: Case) -> bool:
    pushed = any(force.constant for force in case.forces)
    return case.given_rotor is not None and (case.rotor.gravity > 0.0 or pushed)


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
