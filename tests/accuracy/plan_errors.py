"""Errors that plans expect and runs state, beside true ones: machines of the page, and others with rings by chance.

`cd tests && python -m accuracy.plan_errors FOLDER [SEED...]` runs each machine with plans for three targets until its
rotor has turned ten times, and on far more cells in far smaller steps, and writes a line for each. Without seeds these
are the machines of docs/accuracy-measured.md; a seed draws one of the shipped machines with rings, with other
clearances, viscosities, unbalances and acceleration.
"""

import math
import os
import random
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads of so small matrices wait for each other, spinning

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.runs.run import runup
from frbcli.runs.second_run import tried_error
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import end_of_trial, expected_error, make_plan, planned_trial
from frbcli.studies.accuracy import difference

TARGETS = (1e-2, 3e-3, 1e-3)
FINE = ("accuracy.mesh=[10, 144]", "accuracy.tolerance=2e-6")
WITH_RINGS = ("floating-ring", "floating-ring-table-7-1", "turbocharger-heavy", "turbocharger-car")
OF_THE_PAGE = {
    name: (name, "") for name in ("jeffcott-two-phase", "rigid-two-phase", "axial-groove-two-phase", *WITH_RINGS)
}
OF_THE_PAGE |= {"floating-ring, two-phase": ("floating-ring", "film.cavitation=two-phase")}
CLEARANCES, VISCOSITIES, ACCELERATIONS, UNBALANCES = (0.76, 1.41), (0.5, 2.0), (0.5, 2.0), (0.4, 2.5)


@dataclass(frozen=True)
class PlanError:
    """true: error of a run with a plan until a time in s; by_cells: what the plan expects of its cells alone; tried: of
    two short runs, None where they would take too long; stated: by the run. Errors of the eccentricities."""

    machine: str
    target: float
    until_s: float
    cells: tuple[int, int] | None
    true: float
    by_cells: float
    tried: float | None
    stated: float

    def __str__(self) -> str:
        announced = self.by_cells if self.tried is None else self.tried
        return (
            f"{self.machine} | {self.until_s:.2g} s | {self.cells} | true over target {self.true / self.target:.2f} | "
            f"over true: by cells {self.by_cells / self.true:.2f}, expected {announced / self.true:.2f}"
            f"{'' if self.tried else ' (not tried)'}, stated {self.stated / self.true:.2f}"
        )


def drawn(seed: int) -> tuple[str, Case]:
    """A machine by chance, one of WITH_RINGS in turn."""
    chance, name = random.Random(1000 + seed), WITH_RINGS[seed % len(WITH_RINGS)]
    ranges = (CLEARANCES, CLEARANCES, VISCOSITIES, ACCELERATIONS)
    inner, outer, oil, faster = (_within(chance, *bounds) for bounds in ranges)
    case, settings = load_case(name), list[str]()
    for bearing in case.given_bearings:
        key = f"bearing.{bearing.name}" if bearing.name else "bearing"
        for side, wider in (("inner", inner), ("outer", outer)):
            film = getattr(bearing, side)
            settings.append(f"{key}.{side}.clearance={film.clearance * wider!r} m")
            settings.append(f"{key}.{side}.viscosity={case.viscosity(film) * oil!r} Pa*s")
    settings.append(f"speed.duration={case.speed.duration / faster!r} s")
    if case.rotor.symmetric:
        settings.append(f"rotor.unbalance={3e-6 * _within(chance, *UNBALANCES)!r} kg*m")
    return f"{name}, seed {seed}", load_case(name, settings)


def _within(chance: random.Random, low: float, high: float) -> float:
    return math.exp(chance.uniform(math.log(low), math.log(high)))


def errors_of(name: str, case: Case, folder: Path) -> Iterator[PlanError]:
    """The errors of a machine with the plan for each target."""
    profile = run_up_profile(case)
    until = end_of_trial(profile)
    speed = case.speed
    end = speed.start + (speed.end - speed.start) * until / speed.duration
    short = case.with_settings(f"speed.to={end!r} Hz", f"speed.duration={until!r} s")
    fine = runup(short.with_settings(*FINE), folder / "fine.h5", force=True)
    for target in TARGETS:
        whole = case.with_settings(f"accuracy.target={target!r}")
        plan = make_plan(whole)
        assert plan.cells is not None
        mesh = f"accuracy.mesh=[{plan.cells[1]}, {plan.cells[0]}]"
        run = runup(short.with_settings(mesh, f"accuracy.tolerance={plan.tolerance!r}"), folder / "run.h5", force=True)
        trial, true = planned_trial(whole, plan, profile), difference(run, fine)
        tried = None if trial is None else tried_error(whole, trial)
        yield PlanError(
            name, target, true.until_s, plan.cells, true.largest, expected_error(plan).eccentricity,
            None if tried is None else tried.error, float(run.error["eccentricity"]),
        )  # fmt: skip


def main(arguments: list[str]) -> None:
    """See the module."""
    folder, seeds = Path(arguments[0]), [int(seed) for seed in arguments[1:]]
    folder.mkdir(parents=True, exist_ok=True)
    shipped = ((name, load_case(case, [setting] if setting else [])) for name, (case, setting) in OF_THE_PAGE.items())
    for name, case in map(drawn, seeds) if seeds else shipped:
        for found in errors_of(name, case, folder):
            sys.stdout.write(f"{found}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
