"""The error that is expected of a run, from two short runs of the same machine: on its cells and on more of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.errors import FrbError
from frbcli.film.cells.balance.newton_step import film_newton
from frbcli.film.kept import kept_beside
from frbcli.scene.planning.error_runs import Trial

if TYPE_CHECKING:
    from frbcli.runs.march import March

# Expected error over the difference of both runs. The true error is 0.5 to 2.1 times the difference on the machines
# that this number was chosen on, 0.5 to 1.7 times on 12 others (docs/accuracy-measured.md).
SAFETY_OF_TRIALS = 2.2


@dataclass(frozen=True)
class TriedError:
    """error: expected, of the eccentricities until a time in s, at a rotor speed in Hz; cells: (around, along) of the
    finer run that it follows from."""

    error: float
    until_s: float
    speed_Hz: float
    cells: tuple[int, int]


def tried_error(case: Case, trial: Trial) -> TriedError | None:
    """The expected error of a run that begins as a trial; None where a film has no solution, the trial ends early, or
    both runs have the same motion. The difference is kept on disk."""

    def trial_difference(_machine: str, _cells: tuple[int, ...], _numbers: tuple[float, ...]) -> Array:
        return np.array([_difference(case, trial)])

    plans = trial.plan, trial.finer
    cells = tuple(n for plan in plans for n in plan.cells or ())
    numbers = (*trial.profile.times.tolist(), *trial.profile.speeds.tolist(), *(plan.tolerance for plan in plans))
    difference = float(kept_beside(film_newton)(trial_difference)(case.model_dump_json(), cells, numbers)[0])
    if not (math.isfinite(difference) and difference > 0.0):
        return None
    speed = abs(float(trial.profile.speeds[-1])) / (2.0 * math.pi)
    return TriedError(SAFETY_OF_TRIALS * difference, trial.profile.end, speed, (cells[2], cells[3]))


def _difference(case: Case, trial: Trial) -> float:
    """Largest difference of the eccentricities of both runs; NaN if one of them does not reach the end."""
    from frbcli.runs.errors.error_budget import FewerCells  # a difference that is kept on disk needs no time loop
    from frbcli.runs.march import March
    from frbcli.scene.machine.system import make_segments

    try:
        own = March(case, trial.plan, make_segments(case, trial.plan), trial.profile)
        finer = own.again(trial.finer)
        if not (_marched(own) and _marched(finer)):
            return math.nan
    except FrbError:  # a run that does not begin says why
        return math.nan
    errors = FewerCells(1.0, finer.samples).error(own.samples, own.system)
    return math.nan if errors is None else errors.eccentricity


def _marched(march: March) -> bool:
    """Whether a run reaches its end."""
    from frbcli.solve.state import FINISHED, RUNNING, STANDSTILL

    status = RUNNING
    while status == RUNNING:
        status, _ = march.chunk()
    return status in (FINISHED, STANDSTILL)
