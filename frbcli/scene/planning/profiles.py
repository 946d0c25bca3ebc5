"""The speed of the rotor over time: run-up and run-down."""

from __future__ import annotations

import math

from frbcli.case.schema import Case
from frbcli.case.surroundings.over_time import OverTime
from frbcli.errors import Fault, InputError
from frbcli.rotor.speed_profile import SpeedProfile, speed_profile
from frbcli.scene.inputs import input_faults, input_times
from frbcli.scene.machine.elements import table_faults, table_times


def run_up_profile(case: Case) -> SpeedProfile:
    """From the first to the last speed of the case, or through its points. Raises InputError for a table over time that
    ends before."""
    times, speeds = case.speed.course
    return _with_tables(case, list(times), list(speeds))


def run_down_profile(case: Case) -> SpeedProfile:
    """Up, hold, and back down (section 7.2.2). Raises InputError for a speed through points, which tell the way down
    themselves, for an axial load over time, and for a table over time that ends before."""
    speed = case.speed
    if speed.times:
        problem = "say how the speed goes down, too."
        fault = Fault("speed.points", f"{len(speed.times)} points", None, problem, "Call `frb runup`.")
        raise InputError(case.name or "case", (fault,))
    if case.axial is not None and isinstance(case.axial.load, OverTime):
        problem = "changes over time, and a run-down has each speed twice: a speed has more than one load."
        fault = Fault("axial.load", "over time", None, problem, "Give one load, or one with the square of the speed.")
        raise InputError(case.name or "case", (fault,))
    times, speeds = [0.0, speed.duration], [speed.start, speed.end]
    if speed.hold > 0.0:
        times.append(times[-1] + speed.hold)
        speeds.append(speed.end)
    times.append(times[-1] + speed.down_duration)
    speeds.append(speed.start)
    return _with_tables(case, times, speeds)


def _with_tables(case: Case, times: list[float], speeds: list[float]) -> SpeedProfile:
    """The profile through speeds in Hz at times in s, with kinks of no angle at the rows of tables over time."""
    faults = (*table_faults(case, times[0], times[-1]), *input_faults(case, times[0], times[-1]))
    if faults:
        raise InputError(case.name or "case", faults)
    stops = (*table_times(case).tolist(), *input_times(case))
    return speed_profile(times, [2 * math.pi * value for value in speeds]).with_stops(stops)
