"""The run that stands in a file already: it is gone on with, returned, replaced or kept, by one rule."""

from __future__ import annotations

from pathlib import Path

from frbcli.case.reading.load import describes
from frbcli.case.schema import Case
from frbcli.errors import InputError, RunFileError, input_error
from frbcli.results.files.container import refuse
from frbcli.results.records import untold
from frbcli.results.store import Run, read_run
from frbcli.runs.record.header import PROGRAM, version_of
from frbcli.scene.machine.bearing_model_films import RECORD, model_record

INTERRUPTED = "interrupted"
REPLACE = "Replace it with --force, or choose another --output."


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
    if run.versions.get(RECORD) != model_record(case).get(RECORD):
        return f"was made with another bearing model of the name {case.film.theory} than this process has."
    return ""


def _refused(path: Path, option: str, problem: str, remedy: str) -> InputError:
    return input_error(str(path), option, str(path), problem, remedy)
