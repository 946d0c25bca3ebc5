"""Who computes the points of a sweep: processes of this machine, or the workers of a dask cluster."""

from __future__ import annotations

import logging
import os
import signal
import warnings
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

import joblib

from frbcli.caches import is_trusted
from frbcli.runs.record.interrupt import deaf
from frbcli.studies.sweep.points import refused
from frbcli.studies.sweep.task import ERROR, SweepPoint, Task, solve

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
