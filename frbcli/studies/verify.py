"""Check of the stated error of a run by a run with shorter steps, and one with rotor and films solved together."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from frbcli.case.schema import Case
from frbcli.results.store import Run
from frbcli.runs.march import Progress
from frbcli.runs.run import rundown, runup
from frbcli.scene.coupling import chosen_coupling, coupling_named
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.differences import difference, onset_speed

INTERRUPTED = "interrupted"
COMMANDS = {"runup": runup, "rundown": rundown}


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
