"""Rules of squeeze film dampers, whose films carry by squeezing alone: at rest they carry nothing."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.case.surroundings.support import Damper
from frbcli.elements.damper import DamperElement
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named


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
