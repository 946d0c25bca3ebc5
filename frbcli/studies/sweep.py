"""Parameter studies: one case with many settings, on all cores or on a cluster.

All results are in one directory: `sweep.jsonl`, from which an interrupted sweep is resumed, and the runs in `runs/`.

Statistics of a sweep over samples of machines: percentiles, sensitivities, the share that whirls.
"""

from __future__ import annotations

import math
import re
import textwrap
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from importlib.util import find_spec
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from frbcli import __version__
from frbcli.analysis.subsynchronous import whirls
from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, table_of
from frbcli.errors import InputError, input_error
from frbcli.linear.stability_point import STABLE, UNSTABLE
from frbcli.results.container import locked
from frbcli.results.records import WHOLE
from frbcli.results.write import MARK, TABLES, written
from frbcli.results.write import write_table as write_csv
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.sweep_points import NUMBER as NUMBER_TEXT
from frbcli.studies.sweep_points import Settings, checked, grid, refused
from frbcli.studies.sweep_workers import (
    INPUT_ERROR,
    INTERRUPTED,
    METHODS,
    NO_WHIRL,
    ONSET,
    THRESHOLD,
    SweepPoint,
    Task,
    Workers,
    append,
    check_workers,
    one_line,
    open_log,
    solve,
    solved,
)
from frbcli.studies.warm_up import machine_kernels, moment_of_run
from frbcli.units import HERTZ, SpeedUnit

__all__ = ["Observer", "Sweep", "SweepPoint", "Workers", "check_table_format", "sweep", "write_table"]

LOG, RUNS = "sweep.jsonl", "runs"
TABLE_FORMATS = ("csv", "parquet")
FIRST, START_s = 2, 3.0  # thresholds whose time is measured; CPU time in which two processes start

Observer = Callable[[SweepPoint, int, int], None]  # a point, how many are done, how many there are

EVENTS = {
    "runup": ("critical-speed", "self-excited", "onset", "offset", "lock-in", "contact"),
    "stability": ("threshold",),
}
LISTED = ("onset", "threshold")  # events in the table of the terminal
LONGEST_REASON = 100  # characters in the table of the terminal


@dataclass(frozen=True, repr=False)
class Sweep(Tabular):
    """points: in the order of their numbers, those that failed included."""

    case: Case
    method: str
    points: tuple[SweepPoint, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that the points set, in the order in which they first appear."""
        return tuple(dict.fromkeys(key for point in self.points for key in point.settings))

    def table(self) -> Table:
        """One row per point: number, values set as text, status, message, first event of each kind, cost."""
        return table_of(point_columns(self.keys, self.method, any(map(reason, self.points))), self.points)


def sweep(
    case: Case,
    points: Mapping[str, Sequence[object]] | Sequence[Mapping[str, object]],
    directory: str | Path,
    method: str = "runup",
    keep_runs: bool = True,
    workers: Workers | None = None,
    observe: Observer | None = None,
) -> Sweep:
    """Compute a case at many points.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    points : mapping or sequence of mappings
        Keys with the values of each, of which all combinations are points; or the points one by one.
    directory : str or Path
        Holds the log and, with keep_runs, the runs. A second call with the same case and points goes on with what is
        missing.
    method : {"runup", "stability"}
        Run-ups, or the threshold speed alone.
    keep_runs : bool
        Whether the runs are kept.
    workers : Workers, optional
        Processes; by default one for each core.
    observe : callable, optional
        Called in this process after each point.

    Returns
    -------
    Sweep
        The points; one that fails has a status and a message, and the others go on. Ctrl-C returns what there is, the
        others are "interrupted".

    Raises
    ------
    InputError
        If no point is a case, or for a directory that cannot be written, holds another sweep, or is written by another
        process.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.sweep(case, {"bearing.clearance": ["30 um", "40 um"]}, "study", "stability")  # doctest: +SKIP
    """
    workers = workers or Workers()
    settings = grid(points) if isinstance(points, Mapping) else checked(points)
    if method not in METHODS:
        raise refused("method", method, "is not known.", f"There are: {', '.join(METHODS)}.")
    check_workers(workers)
    _check_laws(cases := _cases(case, settings), workers)
    folder = Path(directory).absolute()
    runs = folder / RUNS if keep_runs and method == "runup" else None
    _make(runs or folder)
    log = folder / LOG
    with locked(log):
        done = {point.number: point for point in open_log(log, _header(case, settings, method), case)}

        def take(point: SweepPoint) -> None:
            done[point.number] = point
            append(log, [point])
            if observe is not None:
                observe(point, len(done), len(settings))

        missing = [number for number in range(1, len(settings) + 1) if number not in done]
        _compute(_tasks(missing, settings, cases, method, runs, take), workers, take)
    numbered = enumerate(settings, 1)
    return Sweep(case, method, tuple(done.get(n, SweepPoint(n, chosen, INTERRUPTED)) for n, chosen in numbered))


def _cases(case: Case, settings: Sequence[Settings]) -> list[Case | InputError]:
    """The cases of all points, or why they cannot be modelled. Raises InputError if none can."""
    cases = [_case(case, chosen) for chosen in settings]
    if isinstance(cases[0], InputError) and not any(isinstance(each, Case) for each in cases):
        raise cases[0]
    return cases


def _tasks(
    numbers: Sequence[int], settings: Sequence[Settings], cases: Sequence[Case | InputError], method: str,
    runs: Path | None, take: Callable[[SweepPoint], None],
) -> list[Task]:  # fmt: skip
    """The points of these numbers, from 1, that can be computed; the others are given to `take`. runs: folder of the
    runs, None where they are not kept."""
    tasks: list[Task] = []
    digits = max(3, len(str(len(settings))))
    for number in numbers:
        chosen, its_case = settings[number - 1], cases[number - 1]
        if isinstance(its_case, InputError):
            take(SweepPoint(number, chosen, INPUT_ERROR, one_line(its_case)))
        else:
            run = None if runs is None else runs / f"{number:0{digits}d}.h5"
            tasks.append(Task(number, chosen, its_case, method, run))
    return tasks


def _compute(tasks: Sequence[Task], workers: Workers, take: Callable[[SweepPoint], None]) -> None:
    """Give every point to `take` as soon as it is computed, until all are or Ctrl-C ends it."""
    try:
        if tasks and workers.backend == "loky":
            _compile(tasks)
            if workers.jobs == -1 and tasks[0].method == "stability":
                tasks, workers = _first_here(tasks, workers, take)
        with closing(solved(tasks, workers)) as points_solved:
            for point in points_solved:
                take(point)
                if point.status == INTERRUPTED:  # of a run in this process, which heard it first
                    break
    except KeyboardInterrupt:
        pass


def _first_here(
    tasks: Sequence[Task], workers: Workers, take: Callable[[SweepPoint], None]
) -> tuple[Sequence[Task], Workers]:
    """Compute the first two thresholds in this process. Returns the other tasks, and who computes them: this process
    too, where they take it less time than other processes take to start."""
    spent = 0.0
    for task in tasks[:FIRST]:
        began = time.process_time()
        take(solve(task))
        spent = time.process_time() - began  # without what the first point has to load
    others = tasks[FIRST:]
    return others, replace(workers, jobs=1) if len(others) * spent < START_s else workers


def write_table(swept: Sweep, path: str | Path, table_format: str = "csv", force: bool = False) -> Path:
    """Write the table of a sweep as "csv" or "parquet"; force: also replace a file that frb did not write. Raises
    InputError if that does not work."""
    path = Path(path)
    check_table_format(table_format)
    if table_format == "csv":
        write_csv(swept.to_pandas(), path, force)
    else:
        import pyarrow as pa
        from pyarrow import parquet

        rows = pa.Table.from_pandas(swept.to_pandas(), preserve_index=False)
        rows = rows.replace_schema_metadata({**(rows.schema.metadata or {}), "writer": MARK})
        with written(path, TABLES[table_format], force=force) as part:
            parquet.write_table(rows, part)
    return path


def check_table_format(table_format: str) -> None:
    """Raises InputError if no table can be written so: before the work, not after."""
    if table_format not in TABLE_FORMATS:
        raise refused("--format", table_format, "is not a format.", f"There are: {', '.join(TABLE_FORMATS)}.")
    if table_format == "parquet" and find_spec("pyarrow") is None:
        raise refused("--format", "parquet", "needs the library pyarrow.", "pip install frbcli[parquet], or use csv.")


def _case(case: Case, chosen: Settings) -> Case | InputError:
    """The case of a point that can be modelled, or why it cannot."""
    try:
        its_case = case.with_settings(*(f"{key}={value}" for key, value in chosen.items()))
        make_plan(its_case)
    except InputError as error:
        return error
    return its_case


def _check_laws(cases: Sequence[Case | InputError], workers: Workers) -> None:
    """Raises InputError for force laws that the processes of a sweep do not have."""
    laws = {spring.law for each in cases if isinstance(each, Case) for spring in each.springs} - {""}
    if laws and (workers.jobs != 1 or workers.backend != "loky"):
        problem = f"start processes that do not have the force law {min(laws)} of this process."
        raise refused("--jobs", str(workers.jobs), problem, "Take one: Workers(jobs=1).")


def _compile(tasks: Sequence[Task]) -> None:
    """Run a moment of one task of each kind, so that its kernels are compiled once and not in every process."""
    kinds: dict[object, Task] = {}
    for task in tasks:
        kinds.setdefault(machine_kernels(task.case, make_plan(task.case).decisions), task)
    for task in kinds.values():
        with TemporaryDirectory(prefix="frb-sweep-") as folder:
            run = Path(folder) / "moment.h5"
            solve(Task(0, {}, moment_of_run(task.case), task.method, run))


def _header(case: Case, settings: Sequence[Settings], method: str) -> dict[str, Any]:
    return {"version": __version__, "method": method, "case": case.source_text, "points": list(settings)}


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise refused("--output", str(folder), f"cannot be made: {reason}.", "Choose another directory.") from error


def reason(point: Any) -> str:
    """Why a point has no result, no longer than a cell of a table; the message has all of it."""
    event = point.first("threshold") or point.first("onset")
    return "" if event is not None else textwrap.shorten(point.message, LONGEST_REASON, placeholder=" ...")


def _setting(key: str) -> Callable[[Any], str | None]:
    return lambda point: point.settings.get(key)


def _cost(name: str) -> Callable[[Any], float]:
    return lambda point: _number(point.cost.get(name))


def _first(kind: str, key: str) -> Callable[[Any], float]:
    return lambda point: _number((point.first(kind) or {}).get(key))


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


NUMBER = Column("point", "", "number of the point, from 1", attrgetter("number"), shown=(Shown(""),), key="")
RESULT = (
    Column("set", "", "values of the keys, as text", attrgetter("settings"), flat=False),
    Column("status", "", "how the run ended; without a run `input-error`, `error` or `interrupted`"),
    Column("message", "", "why it is not `finished`"),
    Column("events", "", "events of the run, or the threshold", flat=False),
    Column("cost", "", "cost of the run", flat=False),
    Column("run", "", "run file, if kept", flat=False),
)
COST = tuple(
    Column(quantity, "s", f"{words} time", _cost(f"{quantity}_s"), key="")
    for quantity, words in (("cpu", "CPU"), ("wall", "elapsed"))
)
REASON = Column("reason", "", "", reason, shown=(Shown("reason"),), key="", flat=False)
ENDED = Column("ended", "", "", attrgetter("status"), shown=(Shown("status"),), key="", flat=False)


def _all_whirls(point: SweepPoint) -> str:
    spans = []
    for whirl in whirls(point.events):
        end = "end" if whirl.end is None else f"{whirl.end['speed_Hz']:.1f}"
        name = " ".join(filter(None, (whirl.name, whirl.film.replace("_", " ") or "whirl")))
        spans.append(f"{name} {whirl.begin['speed_Hz']:.1f} to {end}")
    return "; ".join(spans)


WHIRLS = Column("whirls", "", "all whirls, from and to which rotor speed in Hz", _all_whirls, key="")


def point_columns(keys: Sequence[str], method: str, reasons: bool = False) -> tuple[Column, ...]:
    """The columns of a SweepPoint of a sweep over some keys of the case. reasons: whether some have no result."""
    settings = (
        Column(key, "", f"value of {key}, as text", _setting(key), shown=(Shown(key),), key="")
        for key in keys
    )  # fmt: skip
    return (NUMBER, *settings, *RESULT, *(one for kind in EVENTS[method] for one in event_columns(kind)),
            *([WHIRLS] if method == "runup" else []), *COST, ENDED, *([REASON] if reasons else []))  # fmt: skip


def event_columns(kind: str) -> tuple[Column, ...]:
    """Rotor speed and frequency at the first event of a kind, with their uncertainties where the point has them."""
    name, columns = kind.replace("-", "_").removesuffix("_speed"), []
    wanted = (("speed", kind, "rotor speed"), ("frequency", "frequency", "frequency of the motion"))
    for quantity, head, words in wanted:
        value, uncertainty = _first(kind, f"{quantity}_Hz"), _first(kind, f"{quantity}_uncertainty_Hz")
        at = f"at the first event `{kind}`"
        columns.append(Column(f"{name}_{quantity}", "Hz", f"{words} {at}", value, key=""))
        columns.append(
            Column(f"{name}_{quantity}_uncertainty", "Hz", f"uncertainty of the {words} {at}", uncertainty, key="")
        )
        if kind in LISTED:
            shown = _with_unit(head, HERTZ)
            if quantity == "speed":
                shown = replace(shown, per_minute=_with_unit(head, SpeedUnit(rpm=True)))
            columns.append(Column(head, "", "", _pair(value, uncertainty), shown=(shown,), key="", flat=False))
    return tuple(columns)


def _with_unit(head: str, unit: SpeedUnit) -> Shown:
    """A number with its uncertainty and its unit in a cell."""
    return Shown(head, lambda pair: f"{unit.cell(pair[0], pair[1])} {unit.name}")


def _pair(value: Callable[[Any], float], uncertainty: Callable[[Any], float]) -> Callable[[Any], Any]:
    def pair(point: Any) -> tuple[float, float] | None:
        number = value(point)
        return None if math.isnan(number) else (number, uncertainty(point))

    return pair


PERCENTS = (5.0, 25.0, 50.0, 75.0, 95.0)
SURE = 1.959964  # standard deviations of an interval of 95 %
FEWEST = 8  # machines with a whirl, for sensitivities
_LEADING = re.compile(rf"\s*({NUMBER_TEXT})")


@dataclass(frozen=True)
class Sensitivity:
    """rank: Spearman's correlation of a key with the speed; per_deviation_Hz: change of the speed in Hz with one
    standard deviation of the key, by least squares, the other keys unchanged."""

    key: str
    rank: float
    per_deviation_Hz: float


@dataclass(frozen=True)
class Scatter:
    """Statistics of the machines of a sweep whose result is known.

    count: these machines, left_out: the others; speeds_Hz: (count,) ascending rotor speed at which each begins to
    whirl, 0 for one that whirls from the lowest speed on, infinite for one that does not up to the highest;
    percentiles: percent and speed in Hz; sensitivities: of the keys, empty where fewer than FEWEST machines whirl;
    explained: share of the variance that the linear sensitivities explain; below_Hz, share: a speed, and the
    share of machines that begin to whirl below it; interval: 95 % interval of this share (Wilson 1927), as for
    random samples.
    """

    count: int
    left_out: int
    speeds_Hz: Array
    percentiles: tuple[tuple[float, float], ...]
    sensitivities: tuple[Sensitivity, ...]
    explained: float
    below_Hz: float
    share: float
    interval: tuple[float, float]


def scatter(swept: Sweep, below_Hz: float | None = None) -> Scatter:
    """The scatter of the speeds at which the points of a sweep begin to whirl; below_Hz: default the case's highest
    speed. Raises InputError if no point has a known result."""
    speeds = np.array([whirl_speed(point) for point in swept.points])
    known = ~np.isnan(speeds)
    if not known.any():
        remedy = "The table gives the reason for each machine."
        raise input_error("sweep", "--set", "", "no machine has a result.", remedy)
    ordered = np.sort(speeds[known])
    limit = swept.case.speed.top if below_Hz is None else below_Hz
    share = float(np.mean(ordered < limit))
    places = np.minimum(np.ceil(0.01 * np.array(PERCENTS) * len(ordered)).astype(int), len(ordered)) - 1
    percentiles = tuple(zip(PERCENTS, ordered[places].tolist(), strict=True))
    sensitivities, explained = _sensitivities(swept, speeds)
    return Scatter(
        count=len(ordered),
        left_out=int(np.count_nonzero(~known)),
        speeds_Hz=ordered,
        percentiles=percentiles,
        sensitivities=sensitivities,
        explained=explained,
        below_Hz=limit,
        share=share,
        interval=_wilson(share, len(ordered)),
    )


def whirl_speed(point: SweepPoint) -> float:
    """The speed in Hz at which a machine begins to whirl, 0 from the lowest speed on, infinite for none up to the
    highest, NaN where that is not known."""
    event = point.first(THRESHOLD) or point.first(ONSET)
    if event is not None:
        return float(event["speed_Hz"])
    if point.status not in WHOLE:
        return math.nan
    if point.message.startswith((STABLE, NO_WHIRL)):
        return math.inf
    return 0.0 if point.message.startswith(UNSTABLE) else math.nan


def _sensitivities(swept: Sweep, speeds: Array) -> tuple[tuple[Sensitivity, ...], float]:
    from scipy.stats import spearmanr

    whirls = np.isfinite(speeds) & (speeds > 0.0)
    columns = {key: _numbers(swept.points, key)[whirls] for key in swept.keys}
    varied = {key: column for key, column in columns.items() if len(column) and np.std(column) > 0.0}
    speed = speeds[whirls]
    if len(speed) < max(FEWEST, len(varied) + 2) or not varied or not np.std(speed) > 0.0:
        return (), math.nan
    standard = np.stack([(column - column.mean()) / column.std() for column in varied.values()], axis=1)
    slopes = np.linalg.lstsq(standard, speed - speed.mean(), rcond=None)[0]
    left = speed - speed.mean() - standard @ slopes
    explained = 1.0 - float(np.sum(left**2) / np.sum((speed - speed.mean()) ** 2))
    ranks = [float(spearmanr(column, speed).statistic) for column in varied.values()]
    rows = zip(varied, ranks, slopes.tolist(), strict=True)
    return tuple(Sensitivity(*row) for row in rows), explained


def _numbers(points: Sequence[SweepPoint], key: str) -> Array:
    read = (_LEADING.match(point.settings.get(key, "")) for point in points)
    return np.array([math.nan if one is None else float(one[1]) for one in read])


def _wilson(share: float, count: int) -> tuple[float, float]:
    """Interval of a share of `count` samples."""
    square = SURE**2 / count
    middle = (share + 0.5 * square) / (1.0 + square)
    half = SURE / (1.0 + square) * math.sqrt(share * (1.0 - share) / count + 0.25 * square / count)
    return max(0.0, middle - half), min(1.0, middle + half)
