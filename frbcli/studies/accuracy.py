"""Speed against error: a run-up on a ladder of theories, meshes, tolerances and couplings, against a fine reference.

Differences are between two runs of the same machine at each time, until a whirl grows. They also check the stated
error of a run: by one with shorter steps, and one with rotor and films solved together.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from operator import attrgetter, itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, named, short_number, table_of
from frbcli.compiled import Clock, working_time
from frbcli.errors import Fault, InputError, NotConverged, did_you_mean, input_error
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.error_budget import quiet_until
from frbcli.runs.march import Progress
from frbcli.runs.run import rundown, runup
from frbcli.scene.coupling import COUPLINGS, chosen_coupling, coupling_named
from frbcli.scene.course import default_speeds
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import LADDER
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.film_choice import DEFAULT_MESH, Plan
from frbcli.scene.planning.plan import THEORIES, make_plan

RESOLVED = 0.01  # Hz; resolution of the terminal's table
INTERRUPTED = "interrupted"
COMMANDS = {"runup": runup, "rundown": rundown}
MESHES = (0.5, 1.0, 1.5)  # of the plan's elements or cells in each direction
TOLERANCES = (100.0, 10.0, 1.0, 0.1)  # of the plan's
LOOSEST = 0.1  # tolerance that a case may have
REFERENCE_MESH, REFERENCE_TOLERANCE = 2.0, 0.02
COARSER_MESH, LOOSER = 1.5, 2.0  # second reference: factors of the plan's elements, and of the tolerance
FINITE = "finite"
TICKS_s = 0.02  # clocks of CPU time advance by 4 ms on some machines, and say 0 of shorter work


@dataclass(frozen=True)
class Rung:
    """One way to compute the run. mesh: elements or cells (along, around), None for the short-bearing theory."""

    theory: str
    cavitation: str
    mesh: tuple[int, int] | None
    tolerance: float
    coupling: str

    @property
    def name(self) -> str:
        """For tables and progress."""
        mesh = "" if self.mesh is None else f" {self.mesh[0]} x {self.mesh[1]}"
        return f"{self.theory}{mesh}, {self.tolerance:.0e}, {self.coupling}".replace("e-0", "e-")


@dataclass(frozen=True)
class RungError:
    """Error against the reference. eccentricity_largest, eccentricity_rms: deviation from the start until until_s,
    where a whirl begins to grow in either run, or it touches its shell or ends; onset_Hz: difference of the rotor
    speeds at which the whirl begins; threshold_Hz: difference of the stability thresholds, NaN if either has none;
    force_relative: of the film forces at states of the run, against a finer mesh."""

    eccentricity_largest: float
    eccentricity_rms: float
    until_s: float
    onset_Hz: float
    force_relative: float
    threshold_Hz: float = math.nan


@dataclass(frozen=True)
class RungResult:
    """A run on a rung. cpu_s: to tabulate its films and to march; status: how it ended; planned: the choice
    of the plan; signals: largest error of each signal, see Difference; stated: stated error of the run;
    work_s: CPU time from the number of its film solves and the times of scene/forms.py, which does not depend on the
    load of the machine."""

    rung: Rung
    status: str
    cpu_s: float
    error: RungError
    planned: bool = False
    signals: Mapping[str, float] = field(default_factory=dict)
    stated: Mapping[str, float | None] = field(default_factory=dict)
    work_s: float = math.nan


@dataclass(frozen=True, repr=False)
class AccuracyLadder(Tabular):
    """until_s: how long the runs are; reference: its error is how far a run on the rung `coarser` is from it; ladder:
    in the order of their cost; complete: not interrupted; failed: rungs whose run did not begin, and why."""

    case: Case
    until_s: float
    reference: RungResult
    coarser: Rung
    ladder: tuple[RungResult, ...]
    complete: bool = True
    failed: tuple[tuple[Rung, str], ...] = ()

    @property
    def front(self) -> tuple[RungResult, ...]:
        """Pareto's front: the rungs for which no cheaper rung has a smaller error."""
        best, cheapest = math.inf, []
        for result in sorted(self.ladder, key=lambda item: item.cpu_s):
            if result.error.eccentricity_largest < best:
                best = result.error.eccentricity_largest
                cheapest.append(result)
        return tuple(cheapest)

    def above_front(self, quiet: bool = False) -> float:
        """Cost of the planned rung over the cost of the cheapest rung that is as close; 1 on the front.
        quiet: by the counted work instead of the measured CPU time. Infinite if that run did not begin, and among runs
        that end at once, which cost nothing; NaN if its error is not known."""
        planned = next((item for item in self.ladder if item.planned), None)
        if planned is None:
            return math.inf
        error = planned.error.eccentricity_largest
        costs = {item.rung: item.work_s if quiet else item.cpu_s for item in self.ladder}
        as_close = [item.rung for item in self.ladder if item.error.eccentricity_largest <= error]
        own, cheapest = costs[planned.rung], min((costs[rung] for rung in as_close), default=math.nan)
        if own == cheapest:
            return 1.0
        return math.inf if cheapest == 0.0 else own / cheapest

    def table(self) -> Table:
        """One row per rung."""
        return table_of(LADDER_COLUMNS, ((item, item in self.front) for item in self.ladder))


def _film(item: Any) -> str:
    rung = item.rung
    return rung.theory if rung.mesh is None else f"{rung.mesh[0]}x{rung.mesh[1]}"


def _tolerance(value: float) -> str:
    return short_number(value).replace(".0e", "e")


def _difference(value: float) -> str:
    return f"{value:+.2f}" if abs(value) >= RESOLVED else short_number(value)


# Of a Rung
RUNG = (
    Column("theory", "", "theory of the films"),
    Column("cavitation", "", "cavitation model"),
    Column("mesh", "", "elements or cells along and around; none of the short bearing"),
    Column("tolerance", "", "local error of a step", shown=(Shown("tol.", _tolerance),)),
    Column("coupling", "", "coupling of rotor and films"),
)

# Of a RungResult
RESULT = (
    Column("film", "", "short bearing, or elements of a finite one", _film, shown=(Shown("film"),), key="", flat=False),
    *named(RUNG, "", attrgetter("rung")),
    Column("status", "", "how the run ended"),
    Column("cpu", "s", "CPU time", attrgetter("cpu_s"), shown=(Shown("CPU", ".3g"),)),
    Column("eccentricity_largest", "", "largest error of the eccentricity", attrgetter("error.eccentricity_largest"),
           shown=(Shown("max", short_number),), key="error.eccentricity_largest"),
    Column("eccentricity_rms", "", "its root mean square", attrgetter("error.eccentricity_rms"),
           shown=(Shown("rms", short_number),), key="error.eccentricity_rms"),
    Column("until", "s", "end of both errors, at the growth of a whirl", attrgetter("error.until_s"), key=""),
    Column("window", "s", "their begin and end", lambda item: [0.0, item.error.until_s],
           key="error.window_s", flat=False),
    Column("onset_speed", "Hz", "error of the rotor speed at the onset of whirl", attrgetter("error.onset_Hz"),
           shown=(Shown("onset", _difference),), key="error.onset_speed_Hz"),
    Column("threshold", "Hz", "error of the linear threshold", attrgetter("error.threshold_Hz"),
           shown=(Shown("thr.", _difference),), key="error.threshold_Hz"),
    Column("film_force_relative", "", "relative error of the film forces", attrgetter("error.force_relative"),
           shown=(Shown("force", short_number),), key="error.film_force_relative"),
    Column("stated", "", "stated error of the eccentricity", lambda item: item.stated.get("eccentricity"), key=""),
    Column("work", "s", "CPU time by the number of film solves", attrgetter("work_s"), key=""),
)  # fmt: skip

# Of a RungResult and whether it is on Pareto's front
LADDER_COLUMNS = (
    Column("mark", "", "", lambda item: ("*" if item[0].planned else "") + ("+" if item[1] else ""),
           shown=(Shown(""),), key="", flat=False),
    *named(RESULT, "", itemgetter(0)),
    Column("planned", "", "chosen by the plan", lambda item: item[0].planned),
    Column("on_front", "", "no cheaper one has a smaller error", itemgetter(1), key="pareto"),
)  # fmt: skip


Observer = Callable[[Rung, int, int, Progress], None]


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


def accuracy(
    case: Case,
    until: float | None = None,
    theories: Sequence[str] = (),
    couplings: Sequence[str] = (),
    observe: Observer | None = None,
) -> AccuracyLadder:
    """Run a case up on a ladder and compare cost and error of each rung with a fine reference.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    until : float, optional
        Time in s at which the runs end; the rotor speeds up as before.
    theories, couplings : sequence of str
        What is tried; by default all theories that can be had, and the coupling of the plan.
    observe : callable, optional
        Called some times a second with the rung, its number from 1, how many there are with both references, and its
        progress.

    Returns
    -------
    AccuracyLadder
        Rungs with their cost in s of CPU time and their errors, the reference, and what was left out. A rung that does
        not begin is left out and named. Ctrl-C ends it with the rungs done so far; before the reference is there it is
        raised on.

    Raises
    ------
    InputError
        For names that there are not, and for a case that cannot be modelled.
    NotConverged
        If the reference does not begin.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.accuracy(case, until=0.1)  # doctest: +SKIP
    >>> found.to_pandas()  # doctest: +SKIP
    """
    _check(case, theories, couplings)
    short = _until(case, until)
    own = planned_rung(make_plan(short))
    fine, coarser = _references(own)
    rungs = list(ladder(short, own, theories, couplings))
    numbers = itertools.count(1)
    with TemporaryDirectory(prefix="frb-accuracy-") as folder:

        def run(rung: Rung) -> Run:
            watch = None if observe is None else functools.partial(observe, rung, next(numbers), len(rungs) + 2)
            return _whole(runup(_with_rung(short, rung), Path(folder) / "run.h5", observe=watch, force=True))

        exact = run(fine)
        reference = _result(fine, exact, run(coarser), _tabulating(short, fine), forces_of=exact)
        rung_results: list[RungResult] = []
        failed: list[tuple[Rung, str]] = []
        complete = False
        with suppress(KeyboardInterrupt):
            for rung in rungs:
                try:
                    rung_results.append(_result(rung, run(rung), exact, _tabulating(short, rung), rung == own))
                except NotConverged as problem:
                    failed.append((rung, str(problem)))
            reference, *rung_results = _with_thresholds(case, reference, coarser, rung_results)
            complete = True
    rung_results.sort(key=lambda item: item.cpu_s)
    return AccuracyLadder(case, short.speed.duration, reference, coarser, tuple(rung_results), complete, tuple(failed))


def _references(own: Rung) -> tuple[Rung, Rung]:
    """The fine reference of the planned rung `own`, and a coarser one, which gives its error."""
    *_, best = THEORIES
    mesh, coarse = (_mesh(own, best, factor) for factor in (REFERENCE_MESH, COARSER_MESH))
    fine = replace(own, theory=best, mesh=mesh, tolerance=REFERENCE_TOLERANCE * own.tolerance)
    return fine, replace(fine, mesh=coarse, tolerance=LOOSER * fine.tolerance)


def _whole(run: Run) -> Run:
    """A run that Ctrl-C did not end; else this is raised on."""
    if run.status == INTERRUPTED:
        raise KeyboardInterrupt
    return run


def planned_rung(plan: Plan) -> Rung:
    """The rung that the plan of a case chooses."""
    mesh = plan.form.mesh_of(plan)
    return Rung(plan.theory, plan.cavitation, mesh if plan.theory == "finite" else None, plan.tolerance, plan.coupling)


def ladder(case: Case, own: Rung, theories: Sequence[str] = (), couplings: Sequence[str] = ()) -> Iterator[Rung]:
    """The rungs for a case whose plan is `own`: all meshes by all tolerances, and the same tolerances for the short
    bearing where it applies. Raises InputError for a theory or coupling that was asked for and cannot be had."""
    rungs: list[Rung] = [own]
    for coupling in couplings or (own.coupling,):
        for tolerance in sorted({min(LOOSEST, factor * own.tolerance) for factor in TOLERANCES}, reverse=True):
            for theory in theories or THEORIES:
                meshes = [_mesh(own, theory, factor) for factor in MESHES]
                rungs += [Rung(theory, own.cavitation, mesh, tolerance, coupling) for mesh in meshes]
    for rung in dict.fromkeys(rungs):
        try:
            make_plan(_with_rung(case, rung))
        except InputError:
            if theories or rung.theory == "finite":
                raise
            continue  # a film that the short-bearing theory does not know
        yield rung


def by_theory(case: Case, theories: Sequence[str] = ()) -> list[Case]:
    """A case by each theory of its ladder that can be modelled: theories have kernels of their own."""
    variants = []
    for theory in theories or THEORIES:
        with suppress(InputError):
            variants.append(case.with_settings(f"film.theory={theory}"))
            make_plan(variants[-1])
    return variants


def _mesh(own: Rung, theory: str, factor: float) -> tuple[int, int] | None:
    """The plan's mesh made finer or coarser by a factor; None for theories without a mesh."""
    if theory != FINITE:
        return None
    along, around = own.mesh or (DEFAULT_MESH.axial, DEFAULT_MESH.circumferential)
    return max(2, round(factor * along)), max(12, 4 * round(0.25 * factor * around))


def _result(
    rung: Rung, run: Run, reference: Run, cpu_s: float, planned: bool = False, forces_of: Run | None = None
) -> RungResult:
    apart = difference(run, reference)
    force = (forces_of or run).error["film_force_relative"]
    onset = onset_speed(run) - onset_speed(reference)
    error = RungError(apart.largest, apart.rms, apart.until_s, onset, math.nan if force is None else float(force))
    case = load_case_text(run.case_text)
    plan = make_plan(case)
    work = 1e-6 * float(run.cost["film_solves"]) * plan.form.solve_us(case, plan)
    march = _measured(Clock(float(run.cost["cpu_s"]), float(run.cost["wall_s"])))
    return RungResult(rung, run.status, cpu_s + march, error, planned, apart.signals, run.error, work)


def _with_thresholds(
    case: Case, reference: RungResult, coarser: Rung, results: Sequence[RungResult]
) -> Iterator[RungResult]:
    """The reference and what was found, with the errors of the thresholds of linear stability over all speeds of the
    case. They depend on theory and mesh alone."""
    rungs = {(rung.theory, rung.mesh): rung for rung in (coarser, reference.rung, *(item.rung for item in results))}
    speeds = {film: _threshold(_with_rung(case, rung)) for film, rung in rungs.items()}

    def off(one: Rung, other: Rung) -> float:
        return speeds[one.theory, one.mesh] - speeds[other.theory, other.mesh]

    for item, other in ((reference, coarser), *((item, reference.rung) for item in results)):
        yield replace(item, error=replace(item.error, threshold_Hz=off(item.rung, other)))


def _threshold(case: Case) -> float:
    """Threshold in Hz; NaN without one, and for finite-volume films: mass-conserving ones have none, the others take
    minutes."""
    if make_plan(case).cells is not None or not default_speeds(case):
        return math.nan
    threshold = stability(case).threshold
    return math.nan if threshold is None else threshold.speed_Hz


def _tabulating(case: Case, rung: Rung) -> float:
    """CPU time in s that it takes to tabulate the films of a rung, which the cost of a run leaves out."""
    rung_case = _with_rung(case, rung)
    plan = make_plan(rung_case)
    began = working_time()
    make_system(rung_case, plan)
    ended = working_time()
    return _measured(Clock(ended.cpu_s - began.cpu_s, ended.wall_s - began.wall_s))


def _measured(spent: Clock) -> float:
    """CPU time in s; the elapsed time of work that is too short for a clock of CPU time."""
    return spent.cpu_s if spent.cpu_s > TICKS_s else spent.wall_s


def _until(case: Case, until: float | None) -> Case:
    """The case up to a time."""
    speed = case.speed
    if until is None or until >= speed.duration:
        return case
    if until <= case.output.step:
        problem = f"is not above the output step of {case.output.step:g} s."
        raise input_error(case.name or "case", "--until", f"{until:g} s", problem, "Lengthen it.")
    if speed.times:
        problem = "ends a ramp, and speed.points are no ramp."
        remedy = "Leave the later points out of the case."
        raise input_error(case.name or "case", "--until", f"{until:g} s", problem, remedy)
    end = speed.start + (speed.end - speed.start) * until / speed.duration
    return case.with_settings(f"speed.to={end!r} Hz", f"speed.duration={until!r} s")


def _with_rung(case: Case, rung: Rung) -> Case:
    settings = [f"film.theory={rung.theory}", f"film.coupling={rung.coupling}"]
    settings.append(f"accuracy.tolerance={rung.tolerance!r}")
    if rung.mesh is not None:
        settings.append(f"accuracy.mesh=[{rung.mesh[0]}, {rung.mesh[1]}]")
    return case.with_settings(*settings)


def _check(case: Case, theories: Sequence[str], couplings: Sequence[str]) -> None:
    """Raises InputError for a case or a name that the ladder does not have."""
    require(case, LADDER)
    faults = [
        Fault(option, name, None, "is not known.", did_you_mean(name, known))
        for option, names, known in (("--theory", theories, THEORIES), ("--coupling", couplings, COUPLINGS))
        for name in dict.fromkeys(names)
        if name not in known
    ]
    if faults:
        raise case.refused(*faults)
