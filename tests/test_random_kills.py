"""Runs that are killed at random times, again and again, and end with the numbers of one that was left alone."""

from __future__ import annotations

import multiprocessing
import random
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import frbcli.solve.run as solve_run
from frbcli.case.load import load_case
from frbcli.results.store import Run, read_run
from frbcli.solve.run import runup

MOMENT = ["speed.duration=5 ms", "speed.to=101 Hz"]


@dataclass(frozen=True)
class Machine:
    """A case that takes some seconds; kills: how often; budget: steps between two looks at the clock."""

    name: str
    base: str
    settings: tuple[str, ...]
    kills: int
    budget: int


SHORT = ("film.theory=short", "speed.to=200 Hz", "speed.duration=40 s", "output.step=3 ms")
CELLS = ("speed.from=100 Hz", "speed.to=110 Hz", "speed.duration=2 s", "output.step=1 ms")
APART = ("film.coupling=co-simulation", "accuracy.macro_step=1e-6 s", "speed.from=50 Hz", "speed.to=60 Hz",
         "speed.duration=1 s", "output.step=1 ms")  # fmt: skip
MACHINES = [
    Machine("table", "jeffcott", SHORT, 60, 400),
    Machine("cells", "axial-groove-two-phase", CELLS, 20, 20),
    Machine("co-simulation", "jeffcott", APART, 20, 400),
]


def march(settings: tuple[str, ...], base: str, path: str, budget: int) -> None:
    """Go on with the run, with a checkpoint after each look at the clock."""
    solve_run.CHECKPOINT_EVERY_s, solve_run.CHECKPOINT_SHARE = 0.0, 1.0
    solve_run.BUDGET = solve_run.CELL_BUDGET = budget
    runup(load_case(base, settings), path, resume=True)


def assert_same(run: Run, other: Run) -> None:
    """Bit for bit, but for what the clock says."""
    assert list(run.signals) == list(other.signals)
    for name in run.signals:
        np.testing.assert_array_equal(run[name], other[name], strict=True)
    assert (run.status, run.t_end_s, run.events, run.error) == (other.status, other.t_end_s, other.events, other.error)


@pytest.mark.benchmark
@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
def test_killed_at_random_times_it_resumes_to_equal_results(machine: Machine, tmp_path: Path) -> None:
    settings = machine.settings
    begun = time.monotonic()
    whole = runup(load_case(machine.base, settings), tmp_path / "whole.h5")
    path, chance, reached = tmp_path / "killed.h5", random.Random(11), [0.0]
    pace = (time.monotonic() - begun) / machine.kills
    context = multiprocessing.get_context("fork")  # the kernels are loaded already
    killed = 0
    while killed < machine.kills and not (path.exists() and read_run(path).status == "finished"):
        process = context.Process(target=march, args=(settings, machine.base, str(path), machine.budget))
        process.start()
        time.sleep(chance.uniform(0.0, 2.0 * pace))
        process.kill()
        process.join()
        killed += 1
        if path.exists():
            reached.append(read_run(path).t_end_s)
    assert killed == machine.kills
    assert reached == sorted(reached)
    assert len(set(reached)) > machine.kills // 4  # the kills fell in the run, not before it
    assert_same(runup(load_case(machine.base, settings), path, resume=True), whole)
    assert {file.name for file in tmp_path.iterdir()} == {"whole.h5", "killed.h5"}
