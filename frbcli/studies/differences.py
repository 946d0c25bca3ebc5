"""Differences of two runs of the same machine at each time, until a whirl grows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.results.store import Run
from frbcli.runs.errors.error_budget import quiet_until


@dataclass(frozen=True)
class Difference:
    """largest, rms: of the eccentricities of all films; signals: largest of each signal: displacements over the
    clearance, ring speeds over the largest speed of the rotor, oil fractions; until_s: end of the comparison, where a
    whirl begins to grow in either run or one of them ends. NaN if that is at the very beginning."""

    largest: float
    rms: float
    until_s: float
    signals: dict[str, float]


def difference(run: Run, reference: Run) -> Difference:
    """The difference of two runs with the same speeds and output times."""
    until = min(quiet_until(one.events, one.t_end_s) for one in (run, reference))
    count = min(int(np.searchsorted(run["time_s"], until, side="right")), len(run), len(reference))
    if count < 2:
        return Difference(np.nan, np.nan, until, {})
    lengths = reference.references
    room = lengths["clearance_m"] if "clearance_m" in lengths else lengths["length_m"]
    top = float(np.max(np.abs(reference["speed_Hz"][:count])))
    apart: dict[str, Array] = {}
    for name in reference.signals:
        if name in ("time_s", "speed_Hz") or name not in run:
            continue
        scale = room if name.endswith("_m") else max(top, 1e-300) if name.endswith("_Hz") else 1.0
        apart[name] = np.abs(run[name][:count] - reference[name][:count]) / scale
    counted = "eccentricity" if "clearance_m" in lengths else ("journal", "disk")  # without films all displacements
    eccentricities = np.array([values for name, values in apart.items() if name.startswith(counted)])
    return Difference(
        float(eccentricities.max()),
        float(np.sqrt(np.mean(eccentricities**2))),
        until,
        {name: float(values.max()) for name, values in apart.items()},
    )


def onset_speed(run: Run) -> float:
    """Rotor speed in Hz at which the first whirl begins, NaN without one."""
    speeds = [float(event["speed_Hz"]) for event in run.events if event["kind"] == "onset"]
    return speeds[0] if speeds else np.nan
