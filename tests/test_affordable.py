"""Numbers that ask too much: what a run holds in memory, what it costs before it begins, and that it is told before."""

from __future__ import annotations

from pathlib import Path

from frbcli.case.load import load_case
from frbcli.runs.run import runup
from frbcli.scene.cost import MOST_SAMPLES, longest_step
from frbcli.scene.plan import make_plan


def test_a_run_of_an_instant_holds_few_samples(tmp_path: Path) -> None:
    """A step of a millisecond would pass 5e11 of its samples."""
    case = load_case("jeffcott", ["speed.duration=1e-14 s", "speed.hold=0 s", "output.step=2e-15 s"])
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    assert len(run) == 6


def test_a_step_passes_no_more_samples_than_fit_in_memory() -> None:
    fine = load_case("jeffcott", ["speed.duration=1 ms", "speed.hold=0 s", "output.step=1e-10 s"])
    assert longest_step(fine, make_plan(fine)) == MOST_SAMPLES * 1e-10
    usual = load_case("jeffcott")
    assert longest_step(usual, make_plan(usual)) == 1e-3
