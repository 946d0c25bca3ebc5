"""Who computes the points of a sweep: processes of this machine, or the workers of a dask cluster.

One point of a sweep: its task and its result, which runs in any process, on any machine; and the log of a sweep, one
line of JSON for each point, from which an interrupted sweep is resumed.

A line is written as soon as its point is computed. The first line says which sweep it is; an incomplete line is left
out, and so are points that are to be computed again.
"""

from __future__ import annotations

import json
import logging
import os
import signal
import warnings
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, replace
from importlib.util import find_spec
from multiprocessing import resource_tracker
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import joblib

from frbcli.caches import is_trusted
from frbcli.case.reading.load import describes
from frbcli.case.schema import Case
from frbcli.compiled import working_time
from frbcli.errors import FrbError, InputError, NotConverged
from frbcli.linear.stability import threshold_alone
from frbcli.results.records import SPEED, WHOLE
from frbcli.results.write import SWEEP_LOG, Unreadable, text_of, write
from frbcli.runs.interruption import deaf
from frbcli.runs.run import runup
from frbcli.studies.sweep_points import refused

METHODS = ("runup", "stability")
FINISHED, INTERRUPTED = "finished", "interrupted"
INPUT_ERROR, NOT_CONVERGED, ERROR = InputError.status, NotConverged.status, FrbError.status
UNDECIDED = (INPUT_ERROR, ERROR, INTERRUPTED)  # a sweep that goes on tries these again
THRESHOLD, ONSET = "threshold", "onset"
NO_WHIRL = "No whirl up to"  # begins a message
Header = Mapping[str, Any]

LARGEST_LOG = 1024**3  # bytes


@dataclass(frozen=True)
class SweepPoint:
    """One point of a sweep and its result.

    number: from 1; settings: key -> value as text; status: as of its run, or "input-error" (no case, or a file that
    cannot be written), "error" (a bug, or its process died), "interrupted" (not computed yet); message: why, where the
    status is not one of WHOLE, or on which side of the speeds a missing onset or threshold lies; events: as in a run,
    or the one of kind "threshold" of the linear stability; cost: as in a run; run: its file, None if not kept.
    """

    number: int
    settings: dict[str, str]
    status: str
    message: str = ""
    events: tuple[dict[str, Any], ...] = ()
    cost: dict[str, Any] = field(default_factory=dict)
    run: Path | None = None

    def first(self, kind: str) -> dict[str, Any] | None:
        """The first event of a kind, None if there is none."""
        return next((event for event in self.events if event["kind"] == kind), None)


@dataclass(frozen=True)
class Task:
    """The work of a worker. method: one of METHODS; run: the file in which the run is kept, None for none."""

    number: int
    settings: dict[str, str]
    case: Case
    method: str
    run: Path | None

    def failed(self, status: str, message: str) -> SweepPoint:
        """The point of this task, which came to nothing."""
        return SweepPoint(self.number, self.settings, status, message)


def solve(task: Task) -> SweepPoint:
    """The point of a task. Raises nothing: a point that fails is a result, too, and leaves the others alone."""
    try:
        return _threshold(task) if task.method == "stability" else _run(task)
    except InputError as error:
        return task.failed(error.status, one_line(error))
    except NotConverged as error:
        return task.failed(error.status, str(error))
    except Exception as error:
        return task.failed(ERROR, f"{type(error).__name__}: {error}")


def one_line(error: InputError) -> str:
    """The faults of an error as a table shows them."""
    return " ".join(map(str, error.faults))


def _run(task: Task) -> SweepPoint:
    with _run_file(task.run) as path:
        run = runup(task.case, path, resume=True)
    message = "" if run.status in WHOLE else f"{run.status} at {run.t_end_s:.4g} s"
    if run.status in WHOLE and not any(event["kind"] == ONSET for event in run.events):
        reached = task.case.speed.top if task.case.drive is None else float(run[SPEED].max())
        message = f"{NO_WHIRL} {reached:.4g} Hz."
    point = SweepPoint(task.number, task.settings, run.status, message, tuple(run.events), run.cost)
    return replace(point, run=task.run)


@contextmanager
def _run_file(kept: Path | None) -> Iterator[Path]:
    if kept is not None:
        yield kept
        return
    with TemporaryDirectory(prefix="frb-sweep-") as folder:
        yield Path(folder) / "run.h5"


def _threshold(task: Task) -> SweepPoint:
    begun = working_time()
    stability = threshold_alone(task.case)
    ended = working_time()
    cost = {"cpu_s": ended.cpu_s - begun.cpu_s, "wall_s": ended.wall_s - begun.wall_s}
    at = stability.threshold
    if at is None:
        status = FINISHED if any(point.rests for point in stability.sweep) else NOT_CONVERGED
        return SweepPoint(task.number, task.settings, status, stability.note, (), cost)
    event = {"kind": THRESHOLD, "film": None, "t_s": None, **asdict(at), "frequency_ratio": at.whirl_ratio}
    return SweepPoint(task.number, task.settings, FINISHED, "", (event,), cost)


def open_log(path: Path, header: Header, case: Case) -> tuple[SweepPoint, ...]:
    """The points that are done already by the log at `path`, which is ready for more afterwards.

    header: of the sweep, with the text of its `case`, which the log may have in other words. Raises InputError if it
    is the log of another sweep, or cannot be read or written.
    """
    try:
        known = text_of(path, LARGEST_LOG).split("\n") if path.exists() else []
        if known and not _same_sweep(_parsed(known[0]), json.loads(json.dumps(header)), case):
            remedy = "Choose another directory with -o, or remove this one."
            raise refused("--output", str(path), "belongs to another sweep, case or version.", remedy)
        done = {point.number: point for point in map(_point, known[1:]) if point and point.status not in UNDECIDED}
    except (OSError, Unreadable) as error:
        problem = str(error) if isinstance(error, Unreadable) else f"cannot be used: {error.strerror}."
        raise refused("--output", str(path), problem, "Choose another directory with -o.") from error
    lines = [json.dumps(header), *map(_line, done.values())]
    write(path, SWEEP_LOG, "".join(f"{line}\n" for line in lines))
    return tuple(done.values())


def append(path: Path, points: Sequence[SweepPoint]) -> None:
    """Note that points are done. Raises InputError if the disk does not take it."""
    try:
        with path.open("a", encoding="utf-8") as file:
            file.writelines(f"{_line(point)}\n" for point in points)
    except OSError as error:
        remedy = "Free some space; the same command then resumes the sweep."
        raise refused("--output", str(path), f"cannot be written: {error.strerror}.", remedy) from error


def _same_sweep(known: object, header: Header, case: Case) -> bool:
    if not isinstance(known, dict) or {**known, "case": ""} != {**header, "case": ""}:
        return False
    text = known.get("case")
    return text == header["case"] or (isinstance(text, str) and describes(text, case))


def _line(point: SweepPoint) -> str:
    return json.dumps(asdict(point), default=str)


def _point(line: str) -> SweepPoint | None:
    """The point of a line, None for an incomplete one."""
    parsed = _parsed(line)
    if not isinstance(parsed, dict):
        return None
    try:
        run = None if parsed["run"] is None else Path(parsed["run"])
        return SweepPoint(**(parsed | {"events": tuple(parsed["events"]), "run": run}))
    except (KeyError, TypeError):
        return None


def _parsed(line: str) -> object:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


BACKENDS = ("loky", "dask")
CONNECT_WITHIN_s = 10.0
MOST_PER_CORE = 16
QUEUE = 2  # tasks given out per worker: the next one waits where the last one ends
START = "Start `dask scheduler` and `dask worker`, and give the scheduler's address."
ENCRYPTED = ("tls://", "wss://")
CERTIFICATES = (
    f"{START} Name your certificates in dask's settings: distributed.comm.tls.ca-file, client.cert and client.key."
)
UNENCRYPTED = (
    "Whoever can connect to %s can run code in its workers and in this process. Give the cluster certificates and an "
    "address tls://, or keep others out of its network."
)
DIED = "its process ended: it was killed, or there was too little memory."


@dataclass(frozen=True)
class Workers:
    """backend: "loky" for processes of this machine, "dask" for a cluster; jobs: how many processes, -1 for one on each
    core; scheduler: address of the cluster's, e.g. "tcp://10.0.0.1:8786", or nothing for a dask cluster of `jobs`
    processes of this machine."""

    backend: str = "loky"
    jobs: int = -1
    scheduler: str = ""


def check_workers(workers: Workers) -> None:
    """Raises InputError if there can be no such workers."""
    if workers.backend not in BACKENDS:
        raise refused("--backend", workers.backend, "is not a backend.", f"There are: {', '.join(BACKENDS)}.")
    for library in ("distributed", "cryptography"):  # the second for the certificates of a cluster of this machine
        needed = workers.backend == "dask" and not (workers.scheduler and library == "cryptography")
        if needed and find_spec(library) is None:
            remedy = "Install it: pip install frbcli[cluster]"
            raise refused("--backend", "dask", f"needs the library {library}.", remedy)
    settings = Path(os.path.expanduser("~/.config/dask"))  # dask runs what they name
    if workers.backend == "dask" and settings.exists() and not is_trusted(settings):
        remedy = f"Let nobody else write there: chmod -R go-w {settings}"
        raise refused("--backend", "dask", f"has settings in {settings}, which other users can change.", remedy)
    if workers.backend != "dask" and workers.scheduler:
        raise refused("--scheduler", workers.scheduler, "is for a cluster.", "Add --backend dask.")
    if workers.jobs != -1 and workers.jobs < 1:
        raise refused("--jobs", str(workers.jobs), "is not a number of processes.", "Write 1 or more.")
    cores = joblib.cpu_count()
    if not workers.scheduler and workers.jobs > MOST_PER_CORE * cores:
        problem = f"are more processes than this machine can run: it has {cores} cores."
        raise refused("--jobs", str(workers.jobs), problem, f"Write {cores}, or leave --jobs out.")


def solved(tasks: Iterable[Task], workers: Workers) -> Generator[SweepPoint, None, None]:
    """The points of all tasks, each as soon as it is computed.

    If a process ends, its tasks run again, one at a time, so that the task that ends its process is found and fails
    alone. Raises InputError if the cluster cannot be reached.
    """
    waiting = {task.number: task for task in tasks}
    with _deaths(workers) as deaths:
        under_way = QUEUE * joblib.effective_n_jobs(workers.jobs)
        while waiting:
            try:
                with _dropped_at_the_end(_together(waiting.values(), workers.jobs)) as points:
                    for point in points:
                        del waiting[point.number]
                        yield point
            except deaths:
                for task in list(waiting.values())[:under_way]:
                    del waiting[task.number]
                    yield _alone(task, workers.jobs, deaths)


def _together(tasks: Iterable[Task], jobs: int) -> Generator[SweepPoint, None, None]:
    parallel = joblib.Parallel(
        n_jobs=jobs, batch_size=1, pre_dispatch=f"{QUEUE} * n_jobs", return_as="generator_unordered"
    )
    with deaf():  # the processes start in it, and ignore what a terminal sends to all
        finished: Generator[SweepPoint, None, None] = parallel(joblib.delayed(solve)(task) for task in list(tasks))
    return finished


@contextmanager
def _dropped_at_the_end(points: Generator[SweepPoint, None, None]) -> Iterator[Iterator[SweepPoint]]:
    """Drops the running tasks when no more of `points` are needed, without the warning of joblib."""
    try:
        yield points
    finally:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            points.close()


def _alone(task: Task, jobs: int, deaths: tuple[type[Exception], ...]) -> SweepPoint:
    try:
        (point,) = _together([task], jobs)
        return point
    except deaths:
        return task.failed(ERROR, DIED)


@contextmanager
def _deaths(workers: Workers) -> Iterator[tuple[type[Exception], ...]]:
    """Within it joblib uses these workers; what is raised when one of them dies."""
    if workers.backend == "loky":
        with joblib.parallel_config("loky", inner_max_num_threads=1):  # one core for each point
            yield (BrokenExecutor,)
        return
    from distributed import KilledWorker

    with ExitStack() as cluster:
        client = cluster.enter_context(_client(workers)) if workers.scheduler else _local_client(workers.jobs, cluster)
        with joblib.parallel_config("dask", client=client):
            yield (KilledWorker,)


def _local_client(jobs: int, cluster: ExitStack) -> Any:
    """A client of a dask cluster of this machine, with certificates of its own: whoever could connect would run code.

    What a terminal sends to all is heard by this process alone, after the start: the threads that start the others have
    it blocked, and so have these.
    """
    from distributed import Client

    connect: Any = Client  # without types where it is installed
    count = joblib.cpu_count() if jobs == -1 else jobs
    blocking = hasattr(signal, "pthread_sigmask")
    resource_tracker.ensure_running()  # whatever thread starts it has the signals no longer blocked
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGHUP)) if blocking else set()
    try:
        client = connect(
            n_workers=count, threads_per_worker=1, dashboard_address=None, set_as_default=False, security=True,
            silence_logs=logging.CRITICAL,
        )  # fmt: skip
        cluster.enter_context(client).run(_say_nothing)
        return client
    finally:
        if blocking:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _say_nothing() -> None:
    """In a process of dask, suppress the tracebacks of tasks that an interruption cuts short."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def _client(workers: Workers) -> Any:
    """A client of a dask cluster. Raises InputError if there is none at the address."""
    from distributed import Client

    connect: Any = Client  # likewise
    encrypted = workers.scheduler.startswith(ENCRYPTED)
    try:
        client = connect(workers.scheduler, timeout=CONNECT_WITHIN_s, set_as_default=False)
    except Exception as error:  # of dask, of the name of the machine, of certificates, of the library of a protocol
        cause = " ".join(str(error).split()).removesuffix(".") or type(error).__name__
        remedy = CERTIFICATES if encrypted else START
        raise refused("--scheduler", workers.scheduler, f"cannot be reached: {cause}.", remedy) from error
    if not encrypted:
        logging.getLogger("frbcli").warning(UNENCRYPTED, workers.scheduler)
    return client
