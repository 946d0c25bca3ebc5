"""Second runs of the same machine: on fewer cells for the error of a run by its cells; on fewer cells or elements and
with a larger tolerance for its uncertainties after a whirl has grown.

Force errors at single states underestimate the error of a mass-conserving film, where errors accumulate; the difference
to a run on fewer cells contains all of them. What share of it is the error of the run follows from the errors that both
have in the shipped cases (scene/planning/cell_choice.py). It costs a third to a half of the time loop of the run.

Where fronts of oil cross cells, errors of the steps may be amplified far beyond the sum of the local ones, too. With
few cells and large steps the difference contains them: the tolerance is larger by as much as makes an error of second
order in the step larger by the ratio of the errors of the cells.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from frbcli.analysis.events import find_events
from frbcli.analysis.uncertainty import NEAR, slow_uncertainties, with_uncertainties
from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.equilibrium.static_films import share_of_cells
from frbcli.errors import NotConverged
from frbcli.results.store import Run
from frbcli.runs.errors.error_budget import FewerCells
from frbcli.runs.march import March, Progress
from frbcli.scene.course import ERROR_ORDERS
from frbcli.scene.films import film_places
from frbcli.scene.forms.cells import FRONT_ORDER, cells_of
from frbcli.scene.machine.system import System
from frbcli.scene.planning.cell_choice import worst_film
from frbcli.scene.planning.error_runs import LOOSER, coarser_plan
from frbcli.scene.shafts.table import shaft_of
from frbcli.solve.state import CONTACT, FINISHED, RUNNING, STANDSTILL

Observer = Callable[[Progress], None]

# Errors differ from the shipped cases, near openings (grooves, slots, pockets, feed holes) also by their order; most
# of all the errors of rings at rest around a journal that turns.
SAFETY, SAFETY_OF_OPENINGS, SAFETY_OF_RINGS, SAFETY_OF_RINGS_AT_REST = 1.5, 2.0, 2.5, 4.0
QUARTER = 0.25  # of the steps of a run without films, in the run that its error is computed from
LONG_s = 20.0  # CPU time of a run without films above which its error is the sum of all local errors, which is larger
LEAST = 0.5  # of the error that these cells were expected to make, which is 1.3 to 7 times the true one
SECOND_RUN, SECOND_RUN_PREDICTED = "second_run_cpu_s", "second_run_predicted_cpu_s"  # of the cost of a run

SHARED = "the table of its film, which the second run has, too, may move it further"

Record = dict[str, Any]


def on_fewer_cells(march: March, until: float, observe: Observer | None = None) -> FewerCells | None:
    """The run of `march` from its beginning to a time in s on fewer cells; None for films that have none, too few, or
    that do not begin on fewer. observe: called some times a second."""
    cells = march.plan.form.fewer_cells(march.case, march.plan)
    if cells is None:
        return None
    worst = worst_film(march.case, march.plan.eccentricity)
    share = march.plan.form.as_exact
    own, others = (worst.of((around, share * along)) for around, along in (cells_of(march.plan), cells))
    tolerance = march.plan.tolerance * _looser(march.case, others / own)
    try:
        other = march.again(replace(march.plan, cells=cells, tolerance=tolerance))
    except NotConverged:
        return None
    status = RUNNING
    while status == RUNNING and other.time <= until:
        status, _ = other.chunk()
        if observe is not None:
            observe(other.progress(until))
    safety = _safety(march.case, march.system)
    return FewerCells(safety * own / (others - own), other.samples, LEAST * own, march.plan.eccentricity)


def in_finer_steps(march: March, run: Run, until: float, observe: Observer | None = None) -> tuple[float, float] | None:
    """The largest error of the displacements of a run without films, over the length of the plan, of the whole run and
    until a time in s, from the same run in steps of a quarter; None for a run with films, a long one, and where the
    other one does not get as far. run: what the march has recorded.

    Nothing damps a vibration of such a rotor but what the case gives, so that no sum of local errors bounds its error.
    Errors fall at least as the steps do: the other run has a quarter of them at most, and the error is at most 4/3 of
    the difference.
    """
    plan = march.plan
    if march.system.names or march.cost()["cpu_s"] > LONG_s:
        return None
    tolerance = plan.tolerance * QUARTER ** ERROR_ORDERS[plan.method]
    try:
        other = march.again(
            replace(plan, tolerance=tolerance, steps_per_revolution=plan.steps_per_revolution / QUARTER)
        )
    except NotConverged:
        return None
    status, first, points = RUNNING, 0, [name.removesuffix("_x_m") for name in run.signals if name.endswith("_x_m")]
    largest = [0.0, 0.0]
    while status == RUNNING and first < len(run):
        status, signals = other.chunk()
        last = min(first + len(signals["time_s"]), len(run))
        for point in points:
            apart = (signals[f"{point}_{axis}_m"][: last - first] - run.read(f"{point}_{axis}_m", first, last)
                     for axis in "xy")  # fmt: skip
            off = np.hypot(*apart)
            quiet = signals["time_s"][: last - first] <= until
            largest = [max(largest[0], off.max(initial=0.0)), max(largest[1], off[quiet].max(initial=0.0))]
        first = last
        if observe is not None:
            observe(other.progress(march.time))
    if first < len(run):
        return None
    whole, before = (float(size) / march.system.length / (1.0 - QUARTER) for size in largest)
    return whole, before


def _looser(case: Case, coarser: float) -> float:
    """Tolerance of the run on fewer cells over the tolerance of the run, for an error of the cells that is larger by
    `coarser`: the same for elastic rotors, whose disks vibrate long enough for a phase to shift with the steps."""
    return 1.0 if shaft_of(case).elastic else coarser**FRONT_ORDER


def _safety(case: Case, system: System) -> float:
    if not system.ring_count:
        plain = all(place.geometry.supply.plain for place in film_places(case))
        return SAFETY if plain else SAFETY_OF_OPENINGS
    at_rest = case.speed.start != 0.0 and case.start.position != "resting"
    return SAFETY_OF_RINGS_AT_REST if at_rest else SAFETY_OF_RINGS


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
