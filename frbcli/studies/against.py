"""A computed run compared with a measured one: their events and their ridges.

Several runs of cases side by side, each in a process of its own, with the progress of all of them.
"""

from __future__ import annotations

import math
import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from functools import partial
from operator import attrgetter, itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread
from typing import Any

import joblib
import numpy as np

from frbcli.analysis.measured import events_at
from frbcli.analysis.resonance import Ridges, ridge_speeds, ridges
from frbcli.analysis.signals import bearing_clearance, joined, located
from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, named, spread_table
from frbcli.errors import InputError, NotConverged, input_error
from frbcli.results.records import SPEED
from frbcli.results.store import Run
from frbcli.runs.interruption import Interrupt, deaf, held_back
from frbcli.runs.march import Progress
from frbcli.runs.run import rundown, runup

FEWEST = 4  # speeds that both runs have


def _size(deviation: tuple[str, float, float], value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.3g} Hz" if deviation[0].startswith("frequency") else f"{1e6 * value:.3g} um"


# Of a deviation: what deviates, root mean square of computed less measured, root mean square of the measured ridge
DEVIATIONS = (
    Column("what", "", "amplitude or frequency that is compared", itemgetter(0), shown=(Shown("what"),)),
    Column("rms", "", "rms of computed less measured, m or Hz", itemgetter(1)),
    Column("of", "", "rms of the measured one", itemgetter(2)),
    Column("deviation", "", "", lambda deviation: _size(deviation, deviation[1]), shown=(Shown("deviation, rms"),),
           key="", flat=False),
    Column("measured", "", "", lambda deviation: _size(deviation, deviation[2]), shown=(Shown("measured, rms"),),
           key="", flat=False),
)  # fmt: skip

# Of the ridges of a run, over its speeds
RIDGE = (
    Column("synchronous_x", "m", "synchronous amplitude", lambda ridge: ridge.synchronous[:, 0]),
    Column("synchronous_y", "m", "synchronous amplitude", lambda ridge: ridge.synchronous[:, 1]),
    Column("whirl", "Hz", "frequency of the whirl", lambda ridge: np.where(ridge.whirls, ridge.whirl_Hz, np.nan)),
    Column("whirl", "m", "amplitude of the whirl", lambda ridge: np.where(ridge.whirls, ridge.whirl, np.nan)),
)
RIDGES = (
    Column("speed", "Hz", "rotor speed", attrgetter("computed.speed_Hz")),
    *named(RIDGE, "computed", attrgetter("computed")),
    *named(RIDGE, "measured", attrgetter("measured")),
)


@dataclass(frozen=True, repr=False)
class AgainstMeasured(Tabular):
    """computed, measured: ridges of the runs at the same speeds; clearance: m, of the computed run; point: of the
    computed run, that was measured; computed_events, measured_events: found alike in the motion of that point alone."""

    run: Run
    measurement: Run
    computed: Ridges
    measured: Ridges
    clearance: float
    point: str
    computed_events: Sequence[dict[str, Any]]
    measured_events: Sequence[dict[str, Any]]

    def deviations(self) -> tuple[tuple[str, float, float], ...]:
        """(what, root mean square of computed less measured, root mean square of the measured ridge), m or Hz; of a
        whirl where both runs whirl."""
        both = self.computed.whirls & self.measured.whirls
        rows = []
        for number, axis in enumerate("xy"):
            mine, other = self.computed.synchronous[:, number], self.measured.synchronous[:, number]
            if np.nanmax(other, initial=0.0) > 0.0:
                rows.append((f"synchronous amplitude in {axis}", _rms(mine - other), _rms(other)))
        rows.append(("frequency of the whirl", _rms((self.computed.whirl_Hz - self.measured.whirl_Hz)[both]),
                     _rms(self.measured.whirl_Hz[both])))  # fmt: skip
        rows.append(("amplitude of the whirl", _rms((self.computed.whirl - self.measured.whirl)[both]),
                     _rms(self.measured.whirl[both])))  # fmt: skip
        return tuple(rows)

    def table(self) -> Table:
        """One row per speed."""
        return spread_table(RIDGES, self)


def against_measured(run: Run, measurement: Run, signal: str = "journal") -> AgainstMeasured:
    """Compare the events and the ridges of a run with a measurement.

    Parameters
    ----------
    run : Run
        A run, see `read_run`, `runup` and `measured_run`.
    measurement : Run
        A measured run with a clearance, see `measured_run`.
    signal : str
        The point of the run that was measured: "journal", "disk", or the name of a bearing or disk.

    Returns
    -------
    AgainstMeasured
        Events of both, found alike in the motion of that point, and ridges at the speeds that both have: synchronous
        amplitudes in m, frequency in Hz and amplitude in m of the whirl.

    Raises
    ------
    InputError
        If they have too few speeds in common, or one of them is too short for its spectra.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> given = frbcli.Measurement("x", clearance=35e-6, y="y", time="t", speed="n", unit_m=1e-6)
    >>> found = frbcli.against_measured(run, frbcli.measured_run("measured.csv", given))  # doctest: +SKIP
    """
    clearance = bearing_clearance(run, signal.partition("_")[2]) or measurement.references["clearance_m"]
    speeds = ridge_speeds(measurement)
    mine = np.abs(run[SPEED])
    speeds = speeds[(speeds >= mine.min()) & (speeds <= mine.max())]
    if len(speeds) < FEWEST:
        ranges = (np.abs(each[SPEED]) for each in (run, measurement))
        own, other = (f"{speed.min():.4g} to {speed.max():.4g} Hz" for speed in ranges)
        problem = f"goes from {other}, and the run from {own}."
        raise input_error("comparison", "--measured", "", problem, "Compare runs of the same speeds.")
    computed, measured = ridges(run, speeds, clearance, signal), ridges(measurement, speeds, clearance)
    point = joined(*located(run, signal))
    there = [event | {"point": point} for event in events_at(measurement, "journal", clearance)]
    here = events_at(run, signal, clearance)
    return AgainstMeasured(run, measurement, computed, measured, clearance, point, here, there)


def _rms(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")


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
            yield from all_ended
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


def _in_process(task: RunTask, folder: Path) -> tuple[int, Ended]:
    """The number of a run and how it has ended."""
    stop, file = folder / STOP, folder / f"{task.number}.progress"

    def report(number: int, progress: Progress) -> None:
        new = file.with_suffix(".new")
        new.write_bytes(pickle.dumps((number, progress)))
        new.replace(file)
        if stop.exists():
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return task.number, KeyboardInterrupt() if stop.exists() else _ended(task, report)
    finally:
        signal.signal(signal.SIGINT, before)


def _ended(task: RunTask, report: Report) -> Ended:
    try:
        return task.run(report)
    except (KeyboardInterrupt, NotConverged, InputError) as end:
        return end
