"""Run-up and run-down: from a case to a run file. A run that the file holds already is continued, returned, replaced or
kept, by one rule."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from frbcli.analysis.events import find_events
from frbcli.case.reading.load import describes
from frbcli.case.schema import Case
from frbcli.compiled import working_time
from frbcli.elements.spring import LAWS, law_record
from frbcli.errors import InputError, RunFileError, input_error
from frbcli.linear.critical_speeds import linear_critical_speeds
from frbcli.results.container import locked, refuse
from frbcli.results.records import untold
from frbcli.results.store import Header, Run, RunWriter, check_output, read_run
from frbcli.rotor.loads import SpeedProfile
from frbcli.runs.error_budget import quiet_until
from frbcli.runs.header import PROGRAM, header, version_of
from frbcli.runs.interruption import WrongCheckpoint, held_back
from frbcli.runs.march import March, Progress
from frbcli.runs.second_run import SECOND_RUN, SECOND_RUN_PREDICTED, in_finer_steps, on_fewer_cells, with_second_run
from frbcli.scene.cost import ExpectedCost
from frbcli.scene.cost_limits import require_affordable
from frbcli.scene.machine.system import Segment, make_segments
from frbcli.scene.planning.cell_choice import run_down_profile, run_up_profile
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import cost_of_run, is_cheap, make_plan, second_run_s
from frbcli.solve.state import CONTACT, FINISHED, OVERHEATED, RUNNING, STANDSTILL

INTERRUPTED = "interrupted"
REPLACE = "Replace it with --force, or choose another --output."
CHECKPOINT_EVERY_s = 2.0
CHECKPOINT_SHARE = 0.05  # of the wall time that writing may take
WAIT_s = 10.0  # CPU time for the error of a run that was interrupted
PROFILES = {"runup": run_up_profile, "rundown": run_down_profile}
STATUS = {FINISHED: "finished", CONTACT: "contact", OVERHEATED: "overheated", STANDSTILL: "standstill"}
STARVED = "starved"

Observer = Callable[[Progress], None]


def standing_run(command: str, case: Case, path: Path, resume: bool = False, force: bool = False) -> Run | None:
    """The run in `path` that a `command` of a case goes on with, or returns if it has ended; None if it begins anew.

    A run is replaced with `force` alone, unless it has no samples; it is gone on with by `resume` alone. Raises
    InputError for any other one that would be lost, and for a file that cannot be resumed.
    """
    if resume and force:
        raise _refused(path, "--force", "replaces the run, and --resume continues it.", "Give one of them.")
    if resume:
        return earlier_run(command, case, path)
    if force or not path.exists():
        return None
    try:
        run = read_run(path)
    except RunFileError as error:
        problem = f"holds a run that {error.faults[0].problem}"
        raise _refused(path, "--output", problem, REPLACE) from error
    if run.status == INTERRUPTED:
        if not len(run):
            return None
        problem = "holds an interrupted run, which would be lost."
        raise _refused(path, "--output", problem, "Continue it with --resume, or replace it with --force.")
    if problem := _otherness(command, case, run):
        raise _refused(path, "--output", problem, REPLACE)
    if run.versions.get(PROGRAM) != version_of(PROGRAM) or untold(run.cost, run.error):
        raise _refused(path, "--output", "holds a run of another version, which would be lost.", REPLACE)
    return run


def earlier_run(command: str, case: Case, path: Path) -> Run | None:
    """The run in `path` if it is one of this case; None if there is no file yet. Raises InputError for another one."""
    if not path.exists():
        return None
    run = read_run(path)
    if problem := _otherness(command, case, run):
        raise _refused(path, "--resume", problem, "Give the case and the --set of that run, or another --output.")
    if run.status != INTERRUPTED and (missing := untold(run.cost, run.error)):
        raise refuse(path, f"has no {missing}.", "Remove it, or give another --output.")
    return run


def is_interrupted(path: Path) -> bool:
    """Whether a file is an interrupted run with samples. A damaged file is not one, since it cannot be resumed."""
    if not path.exists():
        return False
    try:
        run = read_run(path)
    except RunFileError:
        return False
    return run.status == INTERRUPTED and len(run) > 0


def _otherness(command: str, case: Case, run: Run) -> str:
    """The way in which a run differs from a case; "" if it is of this one."""
    if run.command != command or not describes(run.case_text, case):
        return f"holds a {run.command} of another case ({run.case_name or 'unnamed'}) or of this one with other keys."
    if run.versions.get(LAWS) != law_record(case).get(LAWS):
        return "was made with other force laws of these names than this process has."
    return ""


def _refused(path: Path, option: str, problem: str, remedy: str) -> InputError:
    return input_error(str(path), option, str(path), problem, remedy)


def runup(
    case: Case,
    output: str | Path,
    resume: bool = False,
    observe: Observer | None = None,
    force: bool = False,
    uncertainty: bool = False,
) -> Run:
    """Run the rotor of a case up as its [speed] says.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    output : str or Path
        Run file (HDF5), written as the run goes. A run of the same case that has ended there before is returned as it
        is.
    resume : bool
        Go on with an interrupted run of the same case in `output`.
    observe : callable, optional
        Called some times a second.
    force : bool
        Replace any run in `output`.
    uncertainty : bool
        Make a second, coarser run for the uncertainties of the events, whatever it costs; without it only where that
        takes at most a third of the CPU time of the run. A run in `output` that has ended without them gets them.

    Returns
    -------
    Run
        Any end for a physical or numerical reason is its status: "finished", "contact", "starved", "overheated",
        "not-converged"; Ctrl-C ends it as "interrupted".

    Raises
    ------
    InputError
        For a case that cannot be modelled or afforded, an output that cannot be written, to which another process
        writes, or which holds a run that would be lost.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> run = frbcli.runup(case, "run-up.h5")  # doctest: +SKIP
    """
    return _run("runup", case, Path(output), Wanted(resume, force, uncertainty), observe)


def rundown(
    case: Case,
    output: str | Path,
    resume: bool = False,
    observe: Observer | None = None,
    force: bool = False,
    uncertainty: bool = False,
) -> Run:
    """Run the rotor of a case up, hold it, and run it down again (section 7.2.2).

    Parameters
    ----------
    case, output, resume, observe, force, uncertainty : as of `runup`

    Returns
    -------
    Run
        As of `runup`.

    Raises
    ------
    InputError
        As `runup`.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> run = frbcli.rundown(case, "down.h5")  # doctest: +SKIP
    """
    return _run("rundown", case, Path(output), Wanted(resume, force, uncertainty), observe)


def run_cost(command: str, case: Case, uncertainty: bool = False) -> ExpectedCost:
    """The expected cost of a "runup" or "rundown" of a case. uncertainty: see runup. Raises InputError for a case that
    cannot be modelled or afforded."""
    return _planned(command, case, uncertainty)[2]


@dataclass(frozen=True)
class Wanted:
    """What a run is asked for, see runup."""

    resume: bool
    force: bool
    uncertainty: bool


def _planned(command: str, case: Case, uncertainty: bool) -> tuple[Plan, SpeedProfile, ExpectedCost]:
    plan, profile = make_plan(case), PROFILES[command](case)
    cost = cost_of_run(case, plan, profile, uncertainty)
    require_affordable(case, plan, cost)
    return plan, profile, cost


def _run(command: str, case: Case, path: Path, wanted: Wanted, observe: Observer | None) -> Run:
    plan, profile, cost = _planned(command, case, wanted.uncertainty)
    check_output(path)
    with locked(path):
        earlier = standing_run(command, case, path, wanted.resume, wanted.force)
        if earlier is not None and earlier.status != "interrupted":
            if not wanted.uncertainty or SECOND_RUN in earlier.cost:
                return earlier
            march = March(case, plan, make_segments(case, plan), profile)
            return _with_second_run(march, RunWriter.of(earlier), earlier, observe)
        segments = make_segments(case, plan)
        march = March(case, plan, segments, profile)
        march.compile()  # before there is a file: an interruption leaves none, or one of a run that has begun
        if earlier is not None and earlier.checkpoint is not None:
            _restore(march, earlier, header(command, case, segments))
            writer = RunWriter.resume(path)
        else:
            writer = RunWriter(path, header(command, case, segments, _critical_speeds(segments)))
        run = _go(march, writer, observe, second_run_s(case, plan, profile))
        if run.status == "interrupted":
            return run
        cheap = bool(run.events) and is_cheap(run.cost[SECOND_RUN_PREDICTED], cost)
        return _with_second_run(march, writer, run, observe) if wanted.uncertainty or cheap else run


def _with_second_run(march: March, writer: RunWriter, run: Run, observe: Observer | None) -> Run:
    """A run that has ended, with its uncertainties, in its file."""
    began = working_time()
    events, error = with_second_run(march, run, observe)
    cost = {**run.cost, SECOND_RUN: working_time().cpu_s - began.cpu_s}
    return writer.finish(run.status, cost, error, events, run.t_end_s)


def _go(march: March, writer: RunWriter, observe: Observer | None, second_s: float) -> Run:
    """March to the end or to Ctrl-C; checkpoints are spaced so that writing takes a small share of the time. second_s:
    expected CPU time of the second run, which is reported with the cost."""

    def checkpoint(error: dict[str, float | None]) -> None:
        writer.checkpoint(march.snapshot(), march.cost(), error, march.time)

    status, saved, pause = RUNNING, time.monotonic(), CHECKPOINT_EVERY_s
    # An interruption between a step and its samples would tear them apart.
    with held_back() as interrupt:
        while status == RUNNING and not interrupt.asked:
            status, signals = march.chunk()
            writer.append(signals)
            if observe is not None:
                observe(march.progress())
            if status == RUNNING and time.monotonic() - saved > pause:
                began = time.monotonic()
                checkpoint(march.error_so_far())
                saved = time.monotonic()
                pause = max(CHECKPOINT_EVERY_s, (saved - began) / CHECKPOINT_SHARE)
        # The final state stays in the file.
        checkpoint(march.error_so_far())
        if status == RUNNING:
            return _interrupted(march, writer)
    ended = STATUS.get(status, "not-converged")
    if status not in (FINISHED, OVERHEATED, STANDSTILL) and march.starves:
        ended = STARVED
    so_far = writer.so_far(ended)
    events = [asdict(event) for event in find_events(so_far)]
    until, begun = quiet_until(events, march.time), working_time()
    error = march.error(until, on_fewer_cells(march, until, observe))
    if (of_steps := in_finer_steps(march, so_far, until, observe)) is not None:
        error |= dict(zip(("time_integration", "displacement"), of_steps, strict=True))
    error_s = working_time().cpu_s - begun.cpu_s
    cost = {**march.cost(), "error_cpu_s": error_s, SECOND_RUN_PREDICTED: second_s}
    return writer.finish(ended, cost, error, events, march.time)


def _restore(march: March, earlier: Run, head: Header) -> None:
    """Take up the checkpoint of an interrupted run. Raises RunFileError if the march cannot go on from it."""
    problem = ""
    if {name: signal.unit for name, signal in earlier.signals.items()} != dict(head.units):
        problem = "it holds other signals than a run of this case"
    elif earlier.checkpoint is not None:
        try:
            march.restore(earlier.checkpoint)
            march.check_samples(earlier)
        except WrongCheckpoint as error:
            problem = f"of its checkpoint, {error}"
    if problem:
        raise refuse(earlier.path, f"cannot be resumed: {problem}.", "Remove it, or give another --output.")


def _interrupted(march: March, writer: RunWriter) -> Run:
    """The run so far, with its events and its error until the first whirl, without the parts that need
    another run, since the user waits and the run may be resumed."""
    events = [asdict(event) for event in find_events(writer.so_far())]
    at_once = march.film_error_s <= WAIT_s
    error = march.error(quiet_until(events, march.time)) if at_once else march.error_so_far()
    writer.checkpoint(march.snapshot(), march.cost(), error, march.time, events)
    return writer.so_far(events=events)


def _critical_speeds(segments: Sequence[Segment]) -> tuple[float, ...] | None:
    """Critical speeds of the linearised machine in all segments of a run, Hz, those that differ in the unbalance alone
    once; None if they are not known for one segment."""
    apart = {id(segment.system.films): segment for segment in reversed(segments)}
    by_segment = [linear_critical_speeds(segment.case) for segment in reversed(apart.values())]
    known = [speeds for speeds in by_segment if speeds is not None]
    return tuple(sorted({speed for speeds in known for speed in speeds})) if len(known) == len(by_segment) else None
