"""Wear, and the run that a file holds already.

Wear of rough surfaces over a run, by Archard: an estimate. The gap of the run does not follow it.

A place of the shell loses the depth k p |u| dt, with the pressure p of the summits, their sliding speed u and the
specific wear rate k, volume over force and path. A shell that turns, a ring, and every journal lose it all around.

Source: Archard: Contact and rubbing of flat surfaces. J. Appl. Phys. 24 (1953), 981-988.

A run that the file holds already: it is continued, returned, replaced or kept, by one rule.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from frbcli.arrays import Array
from frbcli.case.reading.load import describes
from frbcli.case.schema import Case
from frbcli.compiled import Indices
from frbcli.elements.spring import LAWS, law_record
from frbcli.errors import InputError, RunFileError, input_error
from frbcli.film.roughness.asperities import wear_along
from frbcli.results.files.container import refuse
from frbcli.results.records import untold
from frbcli.results.store import Run, read_run
from frbcli.runs.record.film_numbers import FilmNumbers, unchanged
from frbcli.runs.record.film_signals import Samples, film_motions
from frbcli.runs.record.header import PROGRAM, version_of
from frbcli.runs.record.restored import WrongCheckpoint, array
from frbcli.scene.machine.system import System

ANGLES = 72  # places around a shell, evenly from the top on, counter-clockwise
NAME, DEEPEST = "wear", 1.0  # in a checkpoint; m, deeper than any shell


class RunWear:
    """Depths that the shells of a run have lost so far, as if none of them turned. rate: m^2/N, None for none; step: of
    the output in s; bodies: see System."""

    def __init__(self, rate: float | None, step: float, bodies: Indices) -> None:
        self._scale = 0.0 if rate is None else rate * step
        self._depths = np.zeros((0 if rate is None else len(bodies), ANGLES))
        self._turns = bodies[:, 1] >= 0

    def add(self, system: System, warm: FilmNumbers | None, samples: Samples) -> None:
        """Let the surfaces wear as they slide at these samples."""
        if system.asperities is None or not len(self._depths):
            return
        for i, depths in enumerate(self._depths):
            clearances, motions = film_motions(system, warm or unchanged(system), samples, i)
            wear_along(system.asperities, i, clearances, motions, self._scale, depths)

    def snapshot(self) -> dict[str, Array]:
        """What a checkpoint holds: (films, ANGLES) m."""
        return {NAME: self._depths.copy()} if len(self._depths) else {}

    def restore(self, checkpoint: Mapping[str, Array]) -> None:
        """Take up the depths of a checkpoint. Raises WrongCheckpoint."""
        if len(self._depths):
            depths = array(checkpoint, NAME, self._depths.shape)
            if not np.all((depths >= 0.0) & (depths <= DEEPEST)):
                raise WrongCheckpoint("wear holds depths that no shell has")
            self._depths = depths

    def deepest(self) -> dict[str, float]:
        """The largest depth in m and phi of its place in degrees, 0 all around a shell that turns."""
        if not len(self._depths):
            return {}
        depths = np.where(self._turns[:, None], self._depths.mean(axis=1, keepdims=True), self._depths)
        film, place = np.unravel_index(int(np.argmax(depths)), depths.shape)
        return {"wear_depth_m": float(depths[film, place]), "wear_angle_deg": 360.0 * float(place) / ANGLES}


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
    if run.versions.get(LAWS) != law_record(case).get(LAWS):
        return "was made with other force laws of these names than this process has."
    return ""


def _refused(path: Path, option: str, problem: str, remedy: str) -> InputError:
    return input_error(str(path), option, str(path), problem, remedy)
