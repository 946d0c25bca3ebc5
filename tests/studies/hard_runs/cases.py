"""Hard cases: each is computed in a process of its own, and compared with its expected end and its reference."""

import json
import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from studies.hard_runs.worker import DIED, HUNG, Worker

from frbcli.arrays import Array
from frbcli.bearing_tests.kinematic import KinematicResult, rotation, squeeze, whirl
from frbcli.case.reading.shipped import HardCase, hard_cases, hard_folder
from frbcli.case.schema import Case
from frbcli.cli.hard import HARD_CASE
from frbcli.columns import Column, Shown, Table, Tabular, named, short_number, table_of
from frbcli.compiled import working_time
from frbcli.errors import InputError, NotConverged
from frbcli.results.store import Run
from frbcli.runs.run import rundown, runup

FINISHED, INPUT_ERROR, NOT_CONVERGED, ERROR = "finished", "input-error", "not-converged", "error"
RUNS = {"runup": runup, "rundown": rundown}
TESTS = {"rotation": rotation, "squeeze": squeeze, "whirl": whirl}
REFERENCES = "references.json"  # beside the list of hard cases
OIL_LOST = 1e-3  # share of the oil that may be unaccounted for


@dataclass(frozen=True)
class Reference:
    """The result of the fine case. values: by name, at times_s of a run, one number each of a kinematic test; until_s:
    end of the comparison of a run; cpu_s: CPU time; change: reference uncertainty, from a second reference on a coarser
    mesh."""

    status: str
    values: dict[str, list[float]]
    times_s: list[float] = field(default_factory=list)
    until_s: float = 0.0
    cpu_s: float = 0.0
    change: float | None = None


def references() -> dict[str, Reference]:
    """The references of the hard cases that have one, by name."""
    text = hard_folder().joinpath(REFERENCES).read_text(encoding="utf-8")
    return {name: Reference(**entry) for name, entry in json.loads(text).items()}


@dataclass(frozen=True)
class HardResult:
    """How a hard case ended.

    status: of the run or test, "finished" for a test that converged; "input-error", "error" (a bug), "hung", "died";
    message: why, where there is more to say; events: kinds with names of films; error: the largest deviation of the
    eccentricities from those of the reference until until_s, or the relative one of the force, None without reference;
    reported: the stated error, None where there is none; certain: the reference uncertainty, None without; problems:
    deviations from the list.
    """

    hard: HardCase
    status: str
    message: str = ""
    events: tuple[str, ...] = ()
    error: float | None = None
    reported: float | None = None
    certain: float | None = None
    until_s: float | None = None
    cpu_s: float = 0.0
    problems: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the case ended as it has to."""
        return not self.problems


Observer = Callable[[HardResult, int, int], None]  # a result, how many are done, how many there are


@dataclass(frozen=True, repr=False)
class HardResults(Tabular):
    """All results, in the order of the list; complete: not interrupted before the last of them."""

    results: tuple[HardResult, ...]
    complete: bool = True

    @property
    def ok(self) -> bool:
        """Whether all cases ended as they have to."""
        return all(result.ok for result in self.results)

    def table(self) -> Table:
        """One row per case."""
        return table_of(HARD_RESULT, self.results)


def run_hard_cases(names: Sequence[str] = (), observe: Observer | None = None) -> HardResults:
    """Compute the hard cases of these names, () for all, one after the other in a process beside this one.

    A case that takes too long is stopped and "hung". observe: called after each. Ctrl-C ends it with the cases that are
    done. Raises InputError for a name that there is not.
    """
    chosen, known = hard_cases(names), references()
    found: list[HardResult] = []
    with suppress(KeyboardInterrupt), Worker(hard_case_result) as worker:
        for hard in chosen:
            task = hard, known.get(hard.name)
            answer = worker.ask(task, hard.within_s)
            if answer in (HUNG, DIED):
                answer = HardResult(hard, str(answer), problems=(f"{answer} within {hard.within_s:g} s",))
            found.append(answer)
            if observe is not None:
                observe(answer, len(found), len(chosen))
    return HardResults(tuple(found), len(found) == len(chosen))


def hard_case_result(task: tuple[HardCase, Reference | None]) -> HardResult:
    """One hard case in this process, with all deviations from the list. Raises nothing: a bug is a result as well."""
    hard, reference = task
    begun = working_time().cpu_s
    try:
        result = _compared(hard, outcome(hard.command, hard.case()), reference)
    except InputError as error:
        result = HardResult(hard, INPUT_ERROR, " ".join(map(str, error.faults)))
    except NotConverged as error:
        result = HardResult(hard, NOT_CONVERGED, str(error))
    except Exception as error:
        result = HardResult(hard, ERROR, f"{type(error).__name__}: {error}", problems=("a bug",))
    problems = [*result.problems, *_unexpected(result)]
    return replace(result, problems=tuple(problems), cpu_s=working_time().cpu_s - begun)


@dataclass(frozen=True)
class Outcome:
    """values: by name, at times_s (n,) of a run, one number each of a test, which has no times; until_s: how far they
    can be compared."""

    status: str
    message: str
    values: dict[str, Array]
    times_s: Array
    until_s: float
    events: tuple[str, ...]
    reported: float | None
    problems: tuple[str, ...]


def outcome(command: str, case: Case) -> Outcome:
    """The outcome of a run or a test. Raises what they raise."""
    if command in RUNS:
        with TemporaryDirectory(prefix="frb-hard-") as folder:
            return _run_outcome(RUNS[command](case, Path(folder) / "run.h5"))
    return _test_outcome(TESTS[command](case).results[0])


def _run_outcome(run: Run) -> Outcome:
    names = [name for name in run.signals if name.startswith("eccentricity")]
    problems = [f"{name} is not finite" for name in run.signals if not np.isfinite(run[name]).all()]
    lost = run.error["oil_balance_relative"]
    if lost is not None and not lost <= OIL_LOST:
        problems.append(f"oil is lost: {lost:.1e} of it")
    return Outcome(
        status=run.status,
        message="" if run.status == FINISHED else f"{run.status} at {run.t_end_s:.4g} s",
        values={name: run[name] for name in names},
        times_s=run["time_s"],
        until_s=run.error["quiet_until_s"],
        events=tuple(" ".join(filter(None, (event["kind"], event["film"]))) for event in run.events),
        reported=run.error["eccentricity"],
        problems=tuple(problems),
    )


def _test_outcome(result: KinematicResult) -> Outcome:
    values: dict[str, Array] = {}
    problems: list[str] = []
    if result.loads is not None:
        values = {f"force_{axis}_N": np.array([force]) for axis, force in zip("xy", result.loads.force, strict=True)}
        if not np.isfinite([*result.loads.force, result.loads.p_max]).all():
            problems.append("a load is not finite")
    status = FINISHED if result.status == "ok" else result.status
    reported = None if math.isnan(result.force_error) else result.force_error
    return Outcome(status, result.problem, values, np.empty(0), 0.0, (), reported, tuple(problems))


def _compared(hard: HardCase, found: Outcome, reference: Reference | None) -> HardResult:
    result = HardResult(hard, found.status, found.message, found.events, reported=found.reported)
    result = replace(result, problems=found.problems)
    if reference is None:
        return result
    if not found.values:
        return replace(result, problems=(*found.problems, "nothing to compare with the reference"))
    error, until = apart(found, reference)
    return replace(result, error=error, until_s=until, certain=reference.change)


def apart(found: Outcome, reference: Reference) -> tuple[float, float | None]:
    """(error against a reference, see HardResult; end of the comparison in s, None for a test)."""
    if not reference.times_s:
        return _force_error(found.values, reference.values), None
    until = min(found.until_s, reference.until_s)
    return _deviation(found, reference, until), until


def _force_error(values: dict[str, Array], exact: dict[str, list[float]]) -> float:
    names = sorted(exact)
    off = np.array([values[name][0] - exact[name][0] for name in names])
    return float(np.linalg.norm(off) / np.linalg.norm([exact[name][0] for name in names]))


def _deviation(found: Outcome, reference: Reference, until_s: float) -> float:
    """Largest deviation at the times of the reference that lie before until_s."""
    times = np.array(reference.times_s)
    shared = times <= until_s
    off = [
        np.interp(times[shared], found.times_s, found.values[name]) - np.array(exact)[shared]
        for name, exact in reference.values.items()
    ]
    return float(np.max(np.abs(off)))


def _unexpected(result: HardResult) -> list[str]:
    """The deviations of a result from the list."""
    hard, found = result.hard, []
    if result.status != hard.end:
        found.append(f"{result.status} instead of {hard.end}")
    if hard.says not in result.message:
        found.append(f'the message lacks "{hard.says}"')
    if hard.events is not None and result.events != hard.events:
        found.append(f"events: {', '.join(result.events) or 'none'} instead of {', '.join(hard.events) or 'none'}")
    if result.error is not None and not _bounded(result.error, result.reported):
        stated = "none" if result.reported is None else f"{result.reported:.1e}"
        found.append(f"error {result.error:.1e}, stated error {stated}")
    return found


def _bounded(error: float, reported: float | None) -> bool:
    return reported is not None and error <= reported


def _end(result: Any) -> str:
    return result.status if result.status == result.hard.end else f"{result.status}, not {result.hard.end}"


# Of a HardResult
HARD_RESULT = (
    *named(HARD_CASE[:-1], "", attrgetter("hard")),
    Column("status", "", "how it ended"),
    Column("end", "", "", _end, shown=(Shown("end"),), key="", flat=False),
    Column("ok", "", "whether it ended as the list says"),
    Column("message", "", "why it ended early", flat=False),
    Column("events", "", "kinds of events with their films", flat=False),
    Column("error", "", "deviation from the reference", shown=(Shown("error", short_number),),
           more="largest of the eccentricities until a whirl begins or the run ends; relative of a force"),
    Column("reported", "", "error that the run or test states", shown=(Shown("stated", short_number),)),
    Column("certain", "", "uncertainty of the reference"),
    Column("until", "s", "end of the comparison", attrgetter("until_s")),
    Column("cpu", "s", "CPU time", attrgetter("cpu_s"), shown=(Shown("CPU s", ".1f"),)),
    Column("problems", "", "deviations from the list", lambda result: "; ".join(result.problems), key=""),
    Column("problems", "", "deviations from the list, as a list", flat=False),
)  # fmt: skip


def cause_of(result: HardResult) -> str:
    """Why a case ended early: its message, and the cause from the list."""
    return "; ".join(text.rstrip(".") for text in (result.message, result.hard.why) if text)
