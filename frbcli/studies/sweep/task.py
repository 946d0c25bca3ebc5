"""One point of a sweep: its task and its result, which runs in any process, on any machine; and the log of a sweep, one
line of JSON for each point, from which an interrupted sweep is resumed.

A line is written as soon as its point is computed. The first line says which sweep it is; an incomplete line is left
out, and so are points that are to be computed again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from frbcli.case.reading.load import describes
from frbcli.case.schema import Case
from frbcli.compilation import working_time
from frbcli.errors import InputError, NotConverged
from frbcli.linear.stability import threshold_alone
from frbcli.results.files.named import Unreadable, text_of
from frbcli.results.files.write import SWEEP_LOG, write
from frbcli.results.records import SPEED, WHOLE
from frbcli.runs.run import runup
from frbcli.studies.sweep.points import refused

if TYPE_CHECKING:
    from collections.abc import Iterator

METHODS = ("runup", "stability")
FINISHED, INTERRUPTED = "finished", "interrupted"
INPUT_ERROR, NOT_CONVERGED, ERROR = "input-error", "not-converged", "error"
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
        return task.failed(INPUT_ERROR, one_line(error))
    except NotConverged as error:
        return task.failed(NOT_CONVERGED, str(error))
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
        given = task.case.speed.start, task.case.speed.end
        reached = max(map(abs, given)) if task.case.drive is None else float(run[SPEED].max())
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
