"""Inputs over time of a case and its drive in a plan: their times, faults and lines."""

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
        if each.key == AXIAL_LOAD:  # shown in the line of the thrust bearing
            continue
        x, time = each.values.x, each.values.time
        value = f"{each.key}: {display(min(x), each.unit)} to {display(max(x), each.unit)}"
        span = f"{each.values.origin}, {time[0]:g} to {time[-1]:g} s"
        yield "input", value, f"{span}; runs follow it, all other analyses have the largest value"


def drive_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """What the plan says of a speed that is free: choice, value, reason."""
    drive, words = case.drive, case.speed_unit.words
    if drive is None:
        return
    reaction = "with" if drive.reaction else "without"
    turns = f"J = {1e6 * case.polar_inertia:.4g} kg*mm^2, from {words(drive.start)} on"
    yield "speed", "free", f"{turns}; {reaction} the reaction of the unbalance"
    if drive.points is not None:
        low, high = (display(limit(drive.points.torque), "N*m") for limit in (min, max))
        yield "drive", f"{low} to {high}", f"{len(drive.points.at)} points over the {drive.points.over}"
    else:
        value = display(drive.torque, "N*m") if drive.torque else "no torque"
        yield "drive", value, f"for {display(drive.duration, 's')}" if drive.torque else "the rotor runs down"
    powers = {"N*m": drive.load.constant, "N*m*s": drive.load.linear, "N*m*s^2": drive.load.square}
    load = " + ".join(display(size, unit) for unit, size in powers.items() if size)
    if load:
        yield "load", load, "brakes the rotor; times powers of its speed in rad/s"
    if drive.end is not None:
        yield "governor", words(drive.end), "takes the torque away below this speed"
    reason = "the most that is expected, without friction of films"
    yield "top speed", words(max(case.speed.start, case.speed.end)), reason
