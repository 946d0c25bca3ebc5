"""Differences of two runs of the same machine at each time, until a whirl grows; and the check of the stated error of a
run by one with shorter steps, and one with rotor and films solved together."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.results.store import Run
from frbcli.runs.errors.error_budget import quiet_until
from frbcli.runs.march import Progress
from frbcli.runs.run import rundown, runup
from frbcli.scene.coupling import chosen_coupling, coupling_named
from frbcli.scene.planning.plan import make_plan

INTERRUPTED = "interrupted"
COMMANDS = {"runup": runup, "rundown": rundown}


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


@dataclass(frozen=True)
class Verification:
    """How far a run is from a finer one. eccentricity: largest difference until until_s in s, where a whirl begins to
    grow in either; onset_Hz: difference of the rotor speeds at which the first whirl begins, NaN if either has none;
    coupling: largest difference of the eccentricities from a run in which rotor and films are solved together, None
    where they are; status: of the finer run; cpu_s: of all runs."""

    eccentricity: float
    until_s: float
    onset_Hz: float
    coupling: float | None
    status: str
    cpu_s: float


def verify(case: Case, run: Run, observe: Callable[[Progress], None] | None = None) -> Verification:
    """Run a case again with half the tolerance and steps of at most half the length, and compare `run` with that.

    The mesh stays: its error is the `mesh_relative` of every run. observe: called some times a second. Costs two or
    three times as much as the run. Ctrl-C ends it, with what there is so far.
    """
    plan = make_plan(case)
    steps = math.ceil(2.0 * plan.steps_per_revolution)
    again = COMMANDS[run.command]
    with TemporaryDirectory(prefix="frb-verify-") as folder:

        def other(*settings: str) -> Run:
            return again(case.with_settings(*settings), Path(folder) / "run.h5", observe=observe, force=True)

        finer = other(f"accuracy.tolerance={0.5 * plan.tolerance!r}", f"accuracy.steps_per_revolution={steps}")
        apart, cpu_s, coupling = difference(run, finer), float(finer.cost["cpu_s"]), None
        if not coupling_named(plan.coupling).iterates and finer.status != INTERRUPTED:
            together = other(f"film.coupling={chosen_coupling('auto', plan.cavitation)}")
            coupling, cpu_s = difference(run, together).largest, cpu_s + float(together.cost["cpu_s"])
    onset = onset_speed(run) - onset_speed(finer)
    return Verification(apart.largest, apart.until_s, onset, coupling, finer.status, cpu_s)
