"""Runs that are interrupted and go on: they are those in one piece."""

import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.results.store import Run
from frbcli.runs import march
from frbcli.runs.march import Progress
from frbcli.runs.run import runup

COUNTS = ("steps", "rejected_steps", "film_solves", "steps_per_revolution")


def interrupt_after(calls: int) -> Callable[[Progress], None]:
    """An observer that presses Ctrl-C at its given call."""
    left = iter(range(calls - 1, -1, -1))

    def observe(_: Progress) -> None:
        if next(left, None) == 0:
            signal.raise_signal(signal.SIGINT)

    return observe


def interrupt_at(time_s: float) -> Callable[[Progress], None]:
    """An observer that presses Ctrl-C once, at its first look at a run that has come so far."""
    pressed = list[Progress]()

    def observe(progress: Progress) -> None:
        if progress.t_s >= time_s and not pressed:
            pressed.append(progress)
            signal.raise_signal(signal.SIGINT)

    return observe


def assert_same(run: Run, other: Run) -> None:
    """Bit for bit, but for what the clock says."""
    assert list(run.signals) == list(other.signals)
    for name in run.signals:
        np.testing.assert_array_equal(run[name], other[name], strict=True, err_msg=name)
    assert (run.status, run.t_end_s, run.events, run.error) == (other.status, other.t_end_s, other.events, other.error)
    assert [run.cost[name] for name in COUNTS] == [other.cost[name] for name in COUNTS]


def assert_resumable(case: Case, folder: Path, *times_s: float, steps: int = 20) -> Run:
    """A run that is interrupted at these times, and goes on from the case that its file has, is the run in one piece,
    which is returned. steps: of a run between two looks at the clock."""
    broken = folder / "broken.h5"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(march, "BUDGET", steps)
        whole = runup(case, folder / "whole.h5")
        again = load_case_text(whole.case_text, name=case.name)
        for time_s in times_s:
            stopped = runup(again, broken, resume=True, observe=interrupt_at(time_s))
            assert stopped.status == "interrupted"
            assert time_s <= stopped.t_end_s < whole.t_end_s
        resumed = runup(again, broken, resume=True)
    assert_same(resumed, whole)
    assert resumed.checkpoint is not None
    assert whole.checkpoint is not None
    for name in {*whole.checkpoint} - {"clock"}:
        np.testing.assert_array_equal(resumed.checkpoint[name], whole.checkpoint[name], err_msg=name)
    return whole
