"""Second runs of the same machine: on fewer cells for the error of a run by its cells; on fewer cells or elements and
with a larger tolerance for its uncertainties after a whirl has grown.

Force errors at single states underestimate the error of a mass-conserving film, where errors accumulate; the difference
to a run on fewer cells contains all of them. What share of it is the error of the run follows from the errors that both
have in the shipped cases (scene/planning/cell_choice.py). It costs a third to a half of the time loop of the run.

Where fronts of oil cross cells, errors of the steps may be amplified far beyond the sum of the local ones, too. With
few cells and large steps the difference contains them: the tolerance is larger by as much as makes an error of second
order in the step larger by the ratio of the errors of the cells.

The cost and the errors of a run, in words.

The error that is expected of a run, from two short runs of the same machine: on its cells and on more of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from frbcli.analysis.events import find_events, resolution
from frbcli.analysis.uncertainty import NEAR, slow_uncertainties, with_uncertainties
from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.equilibrium.static_films import share_of_cells
from frbcli.errors import FrbError, NotConverged
from frbcli.film.cells.balance.newton_step import film_newton
from frbcli.film.kept import kept_beside
from frbcli.results.columns import event_name
from frbcli.results.store import Run
from frbcli.runs.error_budget import FewerCells
from frbcli.runs.march import March, Progress
from frbcli.scene.cost import clock
from frbcli.scene.course import ERROR_ORDERS
from frbcli.scene.films import film_places
from frbcli.scene.machine.system import System, make_segments
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.cell_choice import worst_film
from frbcli.scene.planning.plan import LOOSER, Trial, coarser_plan
from frbcli.scene.tilted import FRONT_ORDER, cells_of
from frbcli.solve.state import CONTACT, FINISHED, RUNNING, STANDSTILL
from frbcli.units import HERTZ, SpeedUnit

Observer = Callable[[Progress], None]

# Errors differ from the shipped cases, near openings (grooves, slots, pockets, feed holes) also by their order; most
# of all the errors of rings at rest around a journal that turns.
SAFETY, SAFETY_OF_OPENINGS, SAFETY_OF_RINGS, SAFETY_OF_RINGS_AT_REST = 1.5, 2.0, 2.5, 4.0
COARSE = 1e-3  # step of the search for an event, over the speed, from which it is shown
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


LATE = 0.5  # of the time until which the error is stated: from then on its growth is reported
SLOW_WORDS = (
    ("ring_speed_uncertainty_Hz", "ring speeds", " Hz"),
    ("temperature_uncertainty_K", "temperatures", " K"),
    ("power_uncertainty_W", "losses", " W"),
    ("oil_fraction_uncertainty", "oil fractions", ""),
)


def account(run: Run) -> list[tuple[str, str, str]]:
    """Rows of a table, what and how much and a remark: cost, oil that passed, heat, wear, stated errors."""
    cost, error = run.cost, run.error
    film = error.get("film_force_relative")
    in_films = "length_m" not in run.references

    def kept(row: tuple[str, str, str]) -> list[tuple[str, str, str]]:
        """A row about films, if a bearing has one."""
        return [row] if in_films else []

    against = "against a finer mesh" if error.get("model_relative") is None else "of the short-bearing theory"
    return [
        ("CPU time", f"{cost['cpu_s']:.3g} s", _predicted(cost)),
        *_compiled(cost),
        (
            "steps",
            f"{cost['steps']}",
            f"{cost['steps_per_revolution']:.3g} per revolution, {cost['rejected_steps']} rejected",
        ),
        *kept(("film solves", f"{cost['film_solves']}", f"{1e3 * cost['ms_per_film_solve']:.3g} us each")),
        *_oil_rows(run),
        *_heat_rows(run),
        *_wear_rows(run),
        *_second_run(cost),
        *kept(("CPU time of the error", f"{cost.get('error_cpu_s', 0.0):.3g} s", "films on other meshes")),
        ("error, time integration", f"{error['time_integration']:.1e}", _of(run)),
        *kept(("error, film forces", "-" if film is None else f"{film:.1e}", f"relative, {against}")),
        *_error_rows(error),
    ]


def about_certainty(run: Run, events: Sequence[Mapping[str, Any]], unit: SpeedUnit = HERTZ) -> list[str]:
    """Sentences on the uncertainties of the events of a run: which events are not certain and why, or how finely they
    are sought and what it would cost to know. events: with the names of their whirls; unit: of rotor speeds."""
    cost = run.cost
    if SECOND_RUN in cost and any(event.get("certain") is None for event in events):
        return ["No uncertainties of the events: the machine does not begin to run on fewer cells."]
    if SECOND_RUN in cost:
        return [
            f"Not certain: {event_name(event)} at {unit.words(event['speed_Hz'])}: {event['reason']}."
            for event in events
            if event.get("certain") is False
        ]
    if not events or SECOND_RUN_PREDICTED not in cost:
        return []
    steps = [(resolution(run, event)[0], abs(event["speed_Hz"])) for event in events]
    coarse = max((step for step, speed in steps if step > COARSE * speed), default=0.0)
    search = f" Events are sought in steps of up to {unit.words(coarse, 1)}." if coarse else ""
    takes = f"they take about {clock(cost[SECOND_RUN_PREDICTED])} with --uncertainty"
    return [f"No uncertainties of the events: {takes}.{search}"]


def _of(run: Run) -> str:
    """The quantity that the error of the time integration is of."""
    if "length_m" not in run.references:
        return "of the eccentricity, whole run"
    return f"of displacements, over {1e6 * run.references['length_m']:.4g} um, whole run"


def _compiled(cost: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """What a first start takes in addition to the run."""
    spent = cost.get("compile_cpu_s", 0.0)
    return [("CPU time of compiling", f"{spent:.3g} s", "once: kernels are kept")] if spent > 0.0 else []


def _second_run(cost: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    if SECOND_RUN not in cost:
        return []
    return [("CPU time of uncertainties", f"{cost[SECOND_RUN]:.3g} s", "second, coarser run")]


def _oil_rows(run: Run) -> list[tuple[str, str, str]]:
    """Oil that passed mass-conserving films."""
    if "oil_in_m3" not in run.cost:
        return []
    came, left = (1e9 * run.cost[name] for name in ("oil_in_m3", "oil_out_m3"))
    off = run.error.get("oil_balance_relative")
    defect = "" if off is None else f", unaccounted for {off:.0e}"
    if "oil_created_m3" in run.cost:
        made = 1e9 * run.cost["oil_created_m3"]
        defect = f", {made:.3g} mm^3 created" if made >= 0.0 else f", {-made:.3g} mm^3 destroyed"
    return [("oil", f"{came:.3g} mm^3 in", f"{left:.3g} mm^3 out{defect}")]


def _heat_rows(run: Run) -> list[tuple[str, str, str]]:
    """Where the heat of the films went, of one bearing each."""
    if "heat_dissipated_J" not in run.cost:
        return []
    whole, oil, walls, kept = (run.cost[f"heat_{name}_J"] for name in ("dissipated", "carried", "into_walls", "kept"))
    off = run.error.get("heat_balance_relative")
    defect = "" if off is None else f", unaccounted for {off:.0e}"
    of_walls = f"{walls:.4g} J into" if walls >= 0.0 else f"{-walls:.4g} J out of"
    parts = f"{oil:.4g} J with the oil, {of_walls} shaft and housing, {kept:.4g} J kept"
    return [("heat", f"{whole:.4g} J", f"{parts}{defect}")]


def _wear_rows(run: Run) -> list[tuple[str, str, str]]:
    """The largest depth that a shell has lost, of one bearing."""
    if "wear_depth_m" not in run.cost:
        return []
    depth, angle = 1e9 * run.cost["wear_depth_m"], run.cost["wear_angle_deg"]
    return [("wear, an estimate", f"{depth:.3g} nm", f"by Archard, of a shell at phi = {angle:.0f} deg")]


def _predicted(cost: dict[str, Any]) -> str:
    """The prediction of the plan, which runs of earlier versions lack."""
    return f"predicted {cost['predicted_cpu_s']:.2g} s" if "predicted_cpu_s" in cost else ""


def grows_late(error: Mapping[str, Any]) -> str:
    """Words on an error that arises late, "" of any other."""
    late_s = error.get("error_grows_from_s") or 0.0
    late = late_s > LATE * error.get("quiet_until_s", math.inf)
    return f", two thirds of it after {late_s:.3g} s" if late else ""


def _error_rows(error: dict[str, Any]) -> list[tuple[str, str, str]]:
    """The parts of the error that not every run has."""
    rows = [
        (f"uncertainty, {words}", f"{error[key]:.2g}{unit}", "means of a hundredth of the run")
        for key, words, unit in SLOW_WORDS
        if error.get(key) is not None
    ]
    if error.get("modal_reduction") is not None:
        rows.append(("error, modal reduction", f"{error['modal_reduction']:.1e}", "of the natural frequencies"))
    if error.get("modal_reduction_amplitude") is not None:
        rows.append(("", f"{error['modal_reduction_amplitude']:.1e}", "of the heights of peaks at critical speeds"))
    if error.get("eccentricity") is not None:
        until = f"total, until {error['quiet_until_s']:.3g} s{grows_late(error)}"
        rows.append(("error of the eccentricity", f"{error['eccentricity']:.1e}", until))
    return rows


# Expected error over the difference of both runs. The true error is 0.5 to 2.1 times the difference on the machines
# that this number was chosen on, 0.5 to 1.7 times on 12 others (docs/accuracy-measured.md).
SAFETY_OF_TRIALS = 2.2


@dataclass(frozen=True)
class TriedError:
    """error: expected, of the eccentricities until a time in s, at a rotor speed in Hz; cells: (around, along) of the
    finer run that it follows from."""

    error: float
    until_s: float
    speed_Hz: float
    cells: tuple[int, int]


def tried_error(case: Case, trial: Trial) -> TriedError | None:
    """The expected error of a run that begins as a trial; None where a film has no solution, the trial ends early, or
    both runs have the same motion. The difference is kept on disk."""

    def trial_difference(_machine: str, _cells: tuple[int, ...], _numbers: tuple[float, ...]) -> Array:
        return np.array([_difference(case, trial)])

    plans = trial.plan, trial.finer
    cells = tuple(n for plan in plans for n in plan.cells or ())
    numbers = (*trial.profile.times.tolist(), *trial.profile.speeds.tolist(), *(plan.tolerance for plan in plans))
    difference = float(kept_beside(film_newton)(trial_difference)(case.model_dump_json(), cells, numbers)[0])
    if not (math.isfinite(difference) and difference > 0.0):
        return None
    speed = abs(float(trial.profile.speeds[-1])) / (2.0 * math.pi)
    return TriedError(SAFETY_OF_TRIALS * difference, trial.profile.end, speed, (cells[2], cells[3]))


def _difference(case: Case, trial: Trial) -> float:
    """Largest difference of the eccentricities of both runs; NaN if one of them does not reach the end."""
    try:
        own = March(case, trial.plan, make_segments(case, trial.plan), trial.profile)
        finer = own.again(trial.finer)
        if not (_marched(own) and _marched(finer)):
            return math.nan
    except FrbError:  # a run that does not begin says why
        return math.nan
    errors = FewerCells(1.0, finer.samples).error(own.samples, own.system)
    return math.nan if errors is None else errors.eccentricity


def _marched(march: March) -> bool:
    """Whether a run reaches its end."""
    status = RUNNING
    while status == RUNNING:
        status, _ = march.chunk()
    return status in (FINISHED, STANDSTILL)
