"""The uncertainties of a run after a whirl has grown, from a second run on fewer cells or elements and with a larger
tolerance."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frbcli.analysis.events import find_events
from frbcli.analysis.uncertainty import NEAR, slow_uncertainties, with_uncertainties
from frbcli.arrays import Array
from frbcli.equilibrium.static_films import share_of_cells
from frbcli.errors import NotConverged
from frbcli.results.store import Run
from frbcli.runs.march import March, Progress
from frbcli.scene.planning.coarser_plan import LOOSER, coarser_plan
from frbcli.solve.state import CONTACT, FINISHED, RUNNING, STANDSTILL

SECOND_RUN, SECOND_RUN_PREDICTED = "second_run_cpu_s", "second_run_predicted_cpu_s"  # of the cost of a run

SHARED = "the table of its film, which the second run has, too, may move it further"

Observer = Callable[[Progress], None]
Record = dict[str, Any]


@dataclass(frozen=True)
class SecondRun:
    """A run that is in no file. signals: (n,) each, in the unit of its name; references, status: as of a run."""

    signals: Mapping[str, Array]
    references: dict[str, float]
    status: str

    def __getitem__(self, name: str) -> Array:
        """The values of a signal."""
        return self.signals[name]

    def __len__(self) -> int:
        """The number of samples."""
        return len(self.signals["time_s"])


def second_run(march: March, run: Run, observe: Observer | None = None) -> SecondRun | None:
    """The coarser run of the machine of a march, a little farther than `run` has come; None if it does not begin.
    observe: called some times a second."""
    try:
        other = march.again(coarser_plan(march.case, march.plan))
    except NotConverged:
        return None
    end_s, status, chunks = (1.0 + NEAR) * run.t_end_s, RUNNING, list[dict[str, Array]]()
    while status == RUNNING and other.time <= end_s:
        status, signals = other.chunk()
        chunks.append(signals)
        if observe is not None:
            observe(other.progress(run.t_end_s))
    # One signal at a time: all of them are held once, in addition to the run's.
    joined = {name: np.concatenate([chunk.pop(name) for chunk in chunks]) for name in tuple(chunks[0])}
    ended = {RUNNING: "interrupted", FINISHED: "finished", CONTACT: "contact", STANDSTILL: "standstill"}
    return SecondRun(joined, run.references, ended.get(status, "not-converged"))


def with_second_run(march: March, run: Run, observe: Observer | None = None) -> tuple[list[Record], Record]:
    """The events of a run with their uncertainties, see `with_uncertainties`, and its error with `slow_uncertainties`;
    both as they are if the second run does not begin."""
    second = second_run(march, run, observe)
    if second is None:
        return run.events, run.error
    events_of_second = [asdict(event) for event in find_events(second)]
    events = with_uncertainties(run, run.events, events_of_second, _least_amplitude(run.error), _share(march))
    if march.plan.form.table_of_solutions:
        events = [_shared(event) for event in events]
    return events, {**run.error, **slow_uncertainties(run, second)}


def _share(march: March) -> float:
    """Share of the difference between both runs that the error of the finer one is expected to be: by the cells, else
    by the tolerances."""
    own, other = march.plan.cells, coarser_plan(march.case, march.plan).cells
    if own is None or other is None or other[0] >= own[0]:
        return 1.0 / (LOOSER - 1.0)
    return share_of_cells(other, own)


def _shared(event: Record) -> Record:
    """An event of films on tables of solutions. Both runs have the error of such a table, which may move the begin of a
    whirl by far more than they differ."""
    return {**event, "certain": False, "reason": SHARED} if event["kind"] == "onset" and event["certain"] else event


def _least_amplitude(error: Record) -> float:
    """Least uncertainty of amplitudes: the error of the eccentricities before a whirl, without the error of the
    short-bearing theory, which both runs have."""
    own = error.get("eccentricity") if error.get("model_relative") is None else error.get("time_integration")
    return float(own or 0.0)
