"""Who computes the points of a sweep: processes of this machine, or the workers of a dask cluster."""

from __future__ import annotations

import warnings
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import joblib

from frbcli.runs.record.interrupt import deaf
from frbcli.studies.sweep.points import refused
from frbcli.studies.sweep.task import ERROR, SweepPoint, Task, solve

BACKENDS = ("loky", "dask")
CONNECT_WITHIN_s = 10.0
MOST_PER_CORE = 16
QUEUE = 2  # tasks given out per worker: the next one waits where the last one ends
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
    if workers.backend == "dask" and find_spec("distributed") is None:
        remedy = "Install it: pip install frbcli[cluster]"
        raise refused("--backend", "dask", "needs the library dask.distributed.", remedy)
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
        found: Generator[SweepPoint, None, None] = parallel(joblib.delayed(solve)(task) for task in list(tasks))
    return found


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
    from distributed import Client, KilledWorker

    connect: Any = Client  # without types where it is installed
    if not workers.scheduler:
        count = joblib.cpu_count() if workers.jobs == -1 else workers.jobs
        local = connect(n_workers=count, threads_per_worker=1, dashboard_address=None, set_as_default=False)
        with local, joblib.parallel_config("dask", client=local):
            yield (KilledWorker,)
        return
    try:
        client = connect(workers.scheduler, timeout=CONNECT_WITHIN_s, set_as_default=False)
    except (OSError, ValueError) as error:
        remedy = "Start `dask scheduler` and `dask worker`, and give the scheduler's address."
        raise refused("--scheduler", workers.scheduler, f"cannot be reached: {error}.", remedy) from error
    with client, joblib.parallel_config("dask", client=client):
        yield (KilledWorker,)
