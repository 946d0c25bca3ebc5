"""One point of a sweep: its task and its result. Runs in any process, on any machine."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from frbcli.case.schema import Case
from frbcli.compilation import working_time
from frbcli.errors import InputError, NotConverged
from frbcli.linear.stability import threshold_alone
from frbcli.results.records import SPEED, WHOLE
from frbcli.runs.run import runup

if TYPE_CHECKING:
    from collections.abc import Iterator

METHODS = ("runup", "stability")
FINISHED, INTERRUPTED = "finished", "interrupted"
INPUT_ERROR, NOT_CONVERGED, ERROR = "input-error", "not-converged", "error"
UNDECIDED = (INPUT_ERROR, ERROR, INTERRUPTED)  # a sweep that goes on tries these again
THRESHOLD, ONSET = "threshold", "onset"
NO_WHIRL = "No whirl up to"  # begins a message


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
