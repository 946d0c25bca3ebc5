"""The machine of a run: a system for each stretch of time in which its clearances stay as they are."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.case.schema import Case
from frbcli.scene.clearance_steps import case_at, step_times
from frbcli.scene.plan import Plan
from frbcli.scene.system import System, make_system


@dataclass(frozen=True)
class Stretch:
    """A machine from the time `start` in s on. case: with the clearances that it has then."""

    start: float
    case: Case
    system: System


def make_stretches(case: Case, plan: Plan) -> tuple[Stretch, ...]:
    """The machine of a case in all stretches of a run, the first from its beginning; films are tabulated here."""
    found = []
    for start in (0.0, *step_times(case)):
        then = case_at(case, start)
        found.append(Stretch(start, then, make_system(then, plan)))
    return tuple(found)
