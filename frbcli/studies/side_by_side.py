"""Several runs of cases side by side, each in a process of its own, with the progress of all of them."""

from __future__ import annotations

import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread
from typing import Any

import joblib

from frbcli.case.schema import Case
from frbcli.errors import InputError, NotConverged
from frbcli.results.store import Run
from frbcli.runs.march import Progress
from frbcli.runs.record.interrupt import Interrupt, deaf, held_back
from frbcli.runs.run import rundown, runup

COMMANDS = {"runup": runup, "rundown": rundown}
ASKED_EVERY_s = 0.2  # how far runs are, and whether Ctrl-C was pressed
STOP = "stop"  # file by which all runs are to end
Report = Callable[[int, Progress], None]
Ended = Run | KeyboardInterrupt | NotConverged | InputError

@dataclass(frozen=True)
class RunTask:
    """A run. number: from 1; command: of COMMANDS; path: of its file; resume: whether it goes on."""

    number: int
    command: str
    case: Case
    path: Path
    resume: bool

    def run(self, report: Report) -> Run:
        """The run. report: called some times a second with its number and its progress."""
        return COMMANDS[self.command](self.case, self.path, self.resume, partial(report, self.number))


def in_turn(tasks: Sequence[RunTask], report: Report) -> Iterator[tuple[int, Ended]]:
    """The numbers of runs and how each has ended, up to the first that was interrupted or did not begin."""
    for task in tasks:
        ended = _ended(task, report)
        yield task.number, ended
        if not isinstance(ended, Run) or ended.status == "interrupted":
            return


def side_by_side(tasks: Sequence[RunTask], report: Report) -> Iterator[tuple[int, Ended]]:
    """As in_turn, but several at once, one on each core, begun in the order given. Ctrl-C ends the runs under way as it
    does a run in this process."""
    over, jobs = Event(), min(len(tasks), joblib.cpu_count())
    with TemporaryDirectory(prefix="frb-progress-") as name, held_back() as interrupt:
        listener = Thread(target=_listen, args=(Path(name), interrupt, over, report))
        listener.start()
        try:
            with joblib.parallel_config("loky", inner_max_num_threads=1), deaf():  # the processes start in it
                run = joblib.Parallel(jobs, batch_size=1, pre_dispatch=jobs, return_as="generator_unordered")
                all_ended = run(joblib.delayed(_in_process)(task, Path(name)) for task in tasks)
            for number, ended in all_ended:
                yield number, ended if not isinstance(ended, tuple) else ended[0](*ended[1:])
        except BrokenExecutor as death:
            raise NotConverged("The process of a run ended: it was killed, or there was too little memory.") from death
        finally:
            over.set()
            listener.join()


def _listen(folder: Path, interrupt: Interrupt, over: Event, report: Report) -> None:
    """Pass on what the processes leave in a folder, and to them that they are to end, until all is over."""
    known: dict[Path, bytes] = {}
    while not over.wait(ASKED_EVERY_s):
        if interrupt.asked:
            (folder / STOP).touch()
        for file in folder.glob("*.progress"):
            if (said := file.read_bytes()) != known.get(file):
                known[file] = said
                report(*pickle.loads(said))


def _in_process(task: RunTask, folder: Path) -> tuple[int, Any]:
    """The number of a run and how it has ended; an InputError in its parts, since processes cannot pass it on."""
    stop, file = folder / STOP, folder / f"{task.number}.progress"

    def report(number: int, progress: Progress) -> None:
        new = file.with_suffix(".new")
        new.write_bytes(pickle.dumps((number, progress)))
        new.replace(file)
        if stop.exists():
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        ended = KeyboardInterrupt() if stop.exists() else _ended(task, report)
        parts = (type(ended), ended.source, ended.faults) if isinstance(ended, InputError) else ended
        return task.number, parts
    finally:
        signal.signal(signal.SIGINT, before)


def _ended(task: RunTask, report: Report) -> Ended:
    try:
        return task.run(report)
    except (KeyboardInterrupt, NotConverged, InputError) as end:
        return end
