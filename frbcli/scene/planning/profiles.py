"""The speed of the rotor over time: run-up and run-down."""

from __future__ import annotations

import math

from frbcli.case.schema import Case
from frbcli.rotor.speed_profile import SpeedProfile, speed_profile


def run_up_profile(case: Case) -> SpeedProfile:
    """From the first to the last speed of the case."""
    speed = case.speed
    return speed_profile([0.0, speed.duration], [2 * math.pi * speed.start, 2 * math.pi * speed.end])


def run_down_profile(case: Case) -> SpeedProfile:
    """Up, hold, and back down (section 7.2.2)."""
    speed = case.speed
    times, speeds = [0.0, speed.duration], [speed.start, speed.end]
    if speed.hold > 0.0:
        times.append(times[-1] + speed.hold)
        speeds.append(speed.end)
    times.append(times[-1] + speed.down_duration)
    speeds.append(speed.start)
    return speed_profile(times, [2 * math.pi * value for value in speeds])
