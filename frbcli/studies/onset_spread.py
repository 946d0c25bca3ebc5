"""How uncertain the onset of a whirl is: the same rotor run up faster and slower, computed otherwise, disturbed.

A whirl grows from the disturbance that there is when the resting position becomes unstable. So the rotor speed at which
it is seen depends not only on the linear threshold of stability, but also on the ramp and on that disturbance, which in
a computation is as small as the errors of its steps and of its mesh. A few runs tell how much.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, table_of
from frbcli.errors import Fault, FrbError, InputError
from frbcli.html import Tabular
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.march import Progress
from frbcli.runs.run import runup
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.planning.planned import Plan
from frbcli.studies.differences import onset_speed

BEYOND = 1.2  # of the speed of the onset, from the first speed on: how far each run goes
RAMPS = (0.5, 2.0)  # durations of the run-up over that of the case
FINER_STEPS = 0.1  # of the tolerance: another noise
OTHER_CELLS = 0.75  # of the cells in each direction
DISTURBED_FROM = 0.9  # of the onset where there is no threshold, the speed that a rotor turns with at once

Watch = Callable[[int, int, Progress], None]
Change = tuple[str, float, tuple[str, ...]]  # what is changed, the last speed in Hz, the settings


@dataclass(frozen=True)
class OnsetRun:
    """One run of the ensemble. changed: in what it differs from the run; onset_Hz: rotor speed at which its first whirl
    begins, NaN if none does until to_Hz; problem: why there is no such run, or nothing."""

    changed: str
    onset_Hz: float
    to_Hz: float
    cpu_s: float = 0.0
    problem: str = ""


def _onset(run: OnsetRun) -> str:
    if run.problem:
        return f"not run: {run.problem}"
    return f"none until {run.to_Hz:.1f}" if math.isnan(run.onset_Hz) else f"{run.onset_Hz:.1f}"


# Of an OnsetRun
ONSET_RUNS = (
    Column("changed", "", "difference from the run", shown=(Shown("run"),)),
    Column("onset", "Hz", "rotor speed at which its first whirl begins"),
    Column("onset", "", "", _onset, shown=(Shown("speed in Hz"),), key="", flat=False),
    Column("to", "Hz", "last rotor speed"),
    Column("problem", "", "why there is no such run"),
)


@dataclass(frozen=True, repr=False)
class OnsetSpread(Tabular):
    """Rotor speeds in Hz at which the first whirl begins. onset_Hz: of the run; threshold_Hz: of linear stability, None
    where there is none, and note then says why; runs: the ensemble."""

    onset_Hz: float
    threshold_Hz: float | None
    note: str
    runs: tuple[OnsetRun, ...]

    def table(self) -> Table:
        """One row per run of the ensemble."""
        return table_of(ONSET_RUNS, self.runs)

    @property
    def interval_Hz(self) -> tuple[float, float]:
        """Lowest and highest speed of onset of all runs; infinite above if one of them has none."""
        found = [self.onset_Hz, *(run.onset_Hz for run in self.runs if not run.problem)]
        return min(x for x in found if not math.isnan(x)), math.inf if any(map(math.isnan, found)) else max(found)

    @property
    def cpu_s(self) -> float:
        """CPU time of the ensemble."""
        return sum(run.cpu_s for run in self.runs)


def onset_spread(case: Case, run: Run, observe: Watch | None = None) -> OnsetSpread | None:
    """The ensemble of a run-up; None if no whirl begins in it. observe: number of the run, all runs, its progress.

    Each run goes as far as BEYOND of the onset. Raises KeyboardInterrupt when it is interrupted, and InputError for a
    speed through points.
    """
    if case.speed.times:
        problem = "are followed as they are, and the spread of an onset is over ramps."
        fault = Fault("speed.points", f"{len(case.speed.times)} points", None, problem, "Give from, to and duration.")
        raise InputError(case.name or "case", (fault,))
    onset = onset_speed(run)
    if math.isnan(onset):
        return None
    threshold, note = _threshold(case)
    disturbed_from = min(threshold or math.inf, case.speed.start + DISTURBED_FROM * (onset - case.speed.start))
    wanted = list(_changes(case, make_plan(case), onset, disturbed_from))
    runs = []
    for number, (changed, to, settings) in enumerate(wanted):
        watch = None if observe is None else lambda progress, n=number: observe(n + 1, len(wanted), progress)
        runs.append(_run(case, changed, to, settings, watch))
    return OnsetSpread(onset, threshold, note, tuple(runs))


def _threshold(case: Case) -> tuple[float | None, str]:
    try:
        found = stability(case)
    except InputError as error:
        return None, f"No linear threshold: {error.faults[0].value} {error.faults[0].problem}"
    return (found.threshold.speed_Hz if found.threshold else None), found.note


def _changes(case: Case, plan: Plan, onset: float, disturbed_from: float) -> Iterator[Change]:
    start, pace = case.speed.start, (case.speed.end - case.speed.start) / case.speed.duration
    end = start + BEYOND * (onset - start)

    def ramp(first: float, factor: float = 1.0) -> tuple[str, ...]:
        return (
            f'speed.from="{first!r} Hz"',
            f'speed.to="{end!r} Hz"',
            f'speed.duration="{factor * (end - first) / pace!r} s"',
        )

    for factor in RAMPS:
        yield f"{factor:g} times the duration", end, ramp(start, factor)
    steps = math.ceil(2.0 * plan.steps_per_revolution)
    finer = (f"accuracy.tolerance={FINER_STEPS * plan.tolerance!r}", f"accuracy.steps_per_revolution={steps}")
    yield "shorter steps", end, (*ramp(start), *finer)
    if plan.form.by_cells:
        sizes = zip(plan.form.mesh_of(plan), (2, 4), strict=True)
        along, around = (max(least, round(OTHER_CELLS * n)) for n, least in sizes)
        yield f"{around} x {along} cells", end, (*ramp(start), f"accuracy.mesh=[{along},{around}]")
    yield f"started at {disturbed_from:.4g} Hz", end, (*ramp(disturbed_from), "start.position=resting")


def _run(
    case: Case, changed: str, to: float, settings: tuple[str, ...], watch: Callable[[Progress], None] | None
) -> OnsetRun:
    with TemporaryDirectory(prefix="frb-onset-") as folder:
        try:
            other = case.with_settings(*settings)
            run = runup(other, Path(folder) / "run.h5", observe=watch, force=True)
        except FrbError as error:
            return OnsetRun(changed, math.nan, to, problem=str(error))
        if run.status == "interrupted":
            raise KeyboardInterrupt
        return OnsetRun(changed, onset_speed(run), to, float(run.cost["cpu_s"]))
