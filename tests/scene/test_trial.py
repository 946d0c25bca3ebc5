"""The error that is expected of a run, from two short runs before it. Numbers that ask too much: what a run holds in
memory, what it costs before it begins, and that it is told before."""

import json
import math
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from commands import Frb

from frbcli.arrays import Array
from frbcli.case.reading import load
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli import check
from frbcli.compiled import CompilationNeededError
from frbcli.errors import NotConverged
from frbcli.runs import march
from frbcli.runs import second_run as tried
from frbcli.runs.run import runup
from frbcli.scene.course import MOST_SAMPLES, longest_step
from frbcli.scene.machine.system import make_segments
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import Trial, expected_error, make_plan, planned_trial
from frbcli.solve.state import RUNNING

RINGS = "floating-ring"
LOOSE = ("accuracy.target=1e-2",)


def trial_of(name: str, *settings: str) -> tuple[Case, Trial | None]:
    case = load_case(name, settings)
    return case, planned_trial(case, make_plan(case), run_up_profile(case))


def test_a_trial_ends_after_ten_revolutions() -> None:
    case, trial = trial_of(RINGS)
    assert trial is not None
    speed = case.speed
    # angle = pi (900 Hz / 3 s) t^2
    assert trial.profile.end == pytest.approx(math.sqrt(2.0 * 10.0 * speed.duration / speed.end), rel=1e-3)
    turned = trial.profile.angle(trial.profile.end) / (2.0 * math.pi)
    assert turned == pytest.approx(10.0, rel=1e-3)


@pytest.mark.parametrize("target", [1e-2, 4.5e-3, 1e-3])
def test_the_finer_run_of_a_trial_has_other_places_of_the_openings(target: float) -> None:
    _, trial = trial_of(RINGS, f"accuracy.target={target!r}")
    assert trial is not None
    assert trial.plan.cells is not None
    assert trial.finer.cells is not None
    assert trial.finer.cells[0] >= 1.5 * trial.plan.cells[0]
    assert trial.finer.cells[0] % 3 != 0
    assert trial.finer.cells[1] >= trial.plan.cells[1]
    assert trial.finer.tolerance < trial.plan.tolerance


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("jeffcott", ()),  # tables
        (RINGS, ("speed.to=60 Hz", "speed.duration=0.2 s")),  # as short as its trial
        ("turbocharger-car", ("accuracy.mesh=[10, 192]", "accuracy.tolerance=1e-6")),  # more than a second
    ],
)
def test_no_trial_without_cells_or_where_it_would_take_long(name: str, settings: tuple[str, ...]) -> None:
    assert trial_of(name, *settings)[1] is None


def eccentricities(case: Case, trial: Trial, plan: Plan) -> Array:
    """(n, films) at the output times of a short run."""
    run = march.March(case, plan, make_segments(case, plan), trial.profile)
    status, parts = RUNNING, list[Array]()
    while status == RUNNING:
        status, signals = run.chunk()
        parts.append(np.column_stack([signals[f"eccentricity_{film}"] for film in ("inner", "outer")]))
    return np.concatenate(parts)


def test_a_trial_tells_one_to_five_times_the_true_error() -> None:
    """The true error is that to a run on more than twice the cells each way, in smaller steps."""
    case, trial = trial_of(RINGS, *LOOSE)
    assert trial is not None
    found = tried.tried_error(case, trial)
    assert found is not None
    fine = replace(trial.plan, cells=(88, 10), tolerance=3e-5)
    own, finer, exact = (eccentricities(case, trial, plan) for plan in (trial.plan, trial.finer, fine))
    # which is found at all output times here, at 192 of them there
    assert found.error == pytest.approx(tried.SAFETY_OF_TRIALS * float(np.abs(own - finer).max()), rel=0.02)
    true = float(np.abs(own - exact).max())
    assert true < found.error < 5.0 * true
    assert expected_error(trial.plan).eccentricity > 4.0 * true  # what the number of cells alone tells


def test_a_trial_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    case, trial = trial_of(RINGS, *LOOSE)
    assert trial is not None
    first = tried.tried_error(case, trial)

    def fails(*_: object) -> float:
        raise AssertionError

    monkeypatch.setattr(tried, "_difference", fails)
    assert tried.tried_error(case, trial) == first
    other, its_trial = trial_of(RINGS, *LOOSE, "rotor.unbalance=3.5 g*mm")
    assert its_trial is not None
    with pytest.raises(AssertionError):
        tried.tried_error(other, its_trial)


@pytest.mark.parametrize("value", [0.0, math.nan])
def test_runs_that_do_not_differ_or_end_early_tell_no_error(value: float, monkeypatch: pytest.MonkeyPatch) -> None:
    case, trial = trial_of(RINGS, "rotor.unbalance=2.9 g*mm")
    assert trial is not None
    monkeypatch.setattr(tried, "_difference", lambda *_: value)
    monkeypatch.setattr(tried, "kept_beside", lambda _: lambda make: make)
    assert tried.tried_error(case, trial) is None


def test_a_run_that_does_not_begin_leaves_the_error_to_its_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    case, trial = trial_of(RINGS, "rotor.unbalance=2.8 g*mm")
    assert trial is not None

    def fails(*_: object) -> object:
        raise NotConverged("no")

    monkeypatch.setattr(tried, "March", fails)
    monkeypatch.setattr(tried, "kept_beside", lambda _: lambda make: make)
    assert tried.tried_error(case, trial) is None


def test_check_tells_what_was_tried_and_compiles_nothing_for_it(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    case, trial = trial_of(RINGS, *LOOSE)
    assert trial is not None
    found = tried.tried_error(case, trial)
    assert found is not None
    expected = frb("check", RINGS, "--json", "--set", *LOOSE).document["expected"]
    assert expected["eccentricity_error"] == pytest.approx(found.error)
    assert expected["tried_until_s"] == pytest.approx(found.until_s)
    assert "short runs on these and on 64 x 8 cells" in " ".join(frb("check", RINGS, "--set", *LOOSE).out.split())

    def needs_a_compiler(*_: object) -> None:
        raise CompilationNeededError

    monkeypatch.setattr(tried, "tried_error", needs_a_compiler)
    expected = frb("check", RINGS, "--json", "--set", *LOOSE).document["expected"]
    assert expected["eccentricity_error"] == expected_error(trial.plan).eccentricity
    assert expected["tried_until_s"] is None
    assert check.BY_CELLS_WITH_RINGS + check.UNTRIED in " ".join(frb("check", RINGS, "--set", *LOOSE).out.split())
    assert np.isfinite(found.speed_Hz)


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


# --- little memory ---

needs_ulimit = pytest.mark.skipif(shutil.which("sh") is None or sys.platform == "win32", reason="ulimit -v")


def limited(kilobytes: int, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = ["sh", "-c", f'ulimit -v {kilobytes} && exec "$@"', "sh", sys.executable, "-m", "frbcli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)


@needs_ulimit
@pytest.mark.parametrize("kilobytes", [80_000, 500_000])
def test_little_memory_is_told_in_one_line(kilobytes: int, tmp_path: Path) -> None:
    """Without asking before, libraries fail to load, wait forever, or abort."""
    done = limited(kilobytes, "runup", "jeffcott", "--json", "-o", str(tmp_path / "run.h5"))
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("frb: out of memory")
    assert f"{kilobytes * 1024 / 1e6:.0f} MB (ulimit -v)" in done.stderr
    assert json.loads(done.stdout)["status"] == "error"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("error", [MemoryError(), MemoryError("Unable to allocate 116. TiB for an array")])
def test_memory_that_runs_out_later_is_told_in_one_line(
    error: MemoryError, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    def fails(*_: object) -> None:
        raise error

    monkeypatch.setattr(load, "load_case", fails)
    told = frb("check", "jeffcott", code=1).err
    assert told.count("\n") == 1
    assert told.startswith(f"frb: out of memory{f' ({error})' if str(error) else ''}.")


@needs_ulimit
def test_what_computes_nothing_needs_little_memory() -> None:
    assert "jeffcott" in limited(60_000, "cases", "--json").stdout
