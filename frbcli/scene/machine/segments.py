"""The machine of a run: a system for each segment of time in which its clearances stay as they are."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.case.schema import Case
from frbcli.scene.clearance_steps import case_at, step_times
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.planned import Plan


@dataclass(frozen=True)
class Segment:
    """A machine from the time `start` in s on. case: with the clearances that it has then."""

    start: float
    case: Case
    system: System


def make_segments(case: Case, plan: Plan) -> tuple[Segment, ...]:
    """The machine of a case in all segments of a run, the first from its beginning; films are tabulated here."""
    found = []
    for start in (0.0, *step_times(case)):
        then = case_at(case, start)
        found.append(Segment(start, then, make_system(then, plan, free_speed=case.drive is not None)))
    return tuple(found)
