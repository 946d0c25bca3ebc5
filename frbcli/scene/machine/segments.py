"""The machine of a run: a system for each segment of time in which its clearances and its unbalance stay as they
are."""

from __future__ import annotations

from dataclasses import dataclass, replace

from frbcli.case.schema import Case
from frbcli.rotor.body import COORDINATES
from frbcli.scene.changes import case_at, change_times, step_times
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.planned import Plan


@dataclass(frozen=True)
class Segment:
    """A machine from the time `start` in s on. case: with the clearances and the unbalance that it has then; of
    segments that differ in the unbalance alone the systems have the same films."""

    start: float
    case: Case
    system: System


def make_segments(case: Case, plan: Plan) -> tuple[Segment, ...]:
    """The machine of a case in all segments of a run, the first from its beginning; films are tabulated here."""
    segments, steps = list[Segment](), step_times(case)
    for start in (0.0, *change_times(case)):
        then = case_at(case, start)
        free = case.drive is not None
        if segments and start not in steps:
            before = segments[-1].system
            rotor = make_rotor(then, COORDINATES[: before.films.coordinates], free_speed=free)
            system = replace(before, rotor=rotor)
        else:
            system = make_system(then, plan, free_speed=free)
        segments.append(Segment(start, then, system))
    return tuple(segments)
