"""Inputs over time of a case in a plan: their times, faults and lines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from frbcli.case.course.time_tables import inputs_of
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.machine.elements import span_faults
from frbcli.units import display

AXIAL_LOAD = "axial.load"


def input_times(case: Case) -> Sequence[float]:
    """The times in s of all rows of the inputs of a case."""
    return sorted({time for each in inputs_of(case) for time in each.values.time})


def input_faults(case: Case, begin: float, end: float) -> Iterator[Fault]:
    """The faults of inputs over time that do not last from begin to end of a run, in s."""
    for each in inputs_of(case):
        yield from span_faults(each.key, each.values.source, each.values.time, begin, end)


def input_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """What the plan says of inputs over time: choice, value, reason."""
    for each in inputs_of(case):
        if each.key == AXIAL_LOAD:  # the line of the thrust bearing tells it
            continue
        x, time = each.values.x, each.values.time
        value = f"{each.key}: {display(min(x), each.unit)} to {display(max(x), each.unit)}"
        span = f"{each.values.told}, {time[0]:g} to {time[-1]:g} s"
        yield "input", value, f"{span}; runs follow it, all other analyses have the largest value"
