"""Whirls that lock in with the unbalance at half the speed, against runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.cycles.columns import UnbalancedWhirl


def jeffcott(unbalance: float, *settings: str) -> frbcli.Case:
    return frbcli.load_case("jeffcott", [f"rotor.unbalance={unbalance} g*mm", *settings])


def run_at(case: frbcli.Case, speed_Hz: float, duration_s: float, path: Path, *more: str) -> dict[str, np.ndarray]:
    """The last half of a run at constant speed."""
    settings = [f"speed.from={speed_Hz} Hz", f"speed.to={speed_Hz} Hz", f"speed.duration={duration_s} s"]
    settings += ["output.step=5e-5 s", "accuracy.tolerance=1e-7", "accuracy.steps_per_revolution=200"]
    signals = frbcli.runup(load_case_text(case.source_text, [*settings, *more], "run"), path / "r.h5").signals
    return {name: np.asarray(values)[len(np.asarray(values)) // 2 :] for name, values in signals.items()}


def locked(case: frbcli.Case, speed_Hz: float) -> UnbalancedWhirl:
    found = frbcli.limit_cycles(case, [speed_Hz], with_unbalance=True)
    (whirl,) = [
        whirl for branch in found.branches for whirl in branch.with_unbalance if abs(whirl.speed_Hz - speed_Hz) < 1e-9
    ]
    return whirl


def test_a_whirl_that_locks_in_is_that_of_a_run(tmp_path: Path) -> None:
    """Jeffcott rotor with 3 g mm at 190 Hz: 95.045 Hz without unbalance, half the speed with it."""
    whirl = locked(jeffcott(3.0, "speed.from=186 Hz", "speed.to=192 Hz"), 190.0)
    assert whirl.stable
    assert whirl.frequency_Hz == pytest.approx(95.0, rel=1e-12)
    assert [line.name for line in whirl.lines[:2]] == ["Omega / 2", "Omega"]
    signals = run_at(jeffcott(3.0, "start.displacement=[0.3, -0.3]"), 190.0, 16.0, tmp_path)
    assert whirl.eccentricity_max[0] == pytest.approx(signals["eccentricity"].max(), abs=2e-5)


def test_a_whirl_locks_in_at_the_speed_of_its_cycle() -> None:
    """Also where harmonics are added: penalty model, 3 g mm, 200 Hz; 0.940716 is what a run has after 30 s."""
    whirl = locked(jeffcott(3.0, "film.cavitation=penalty", "speed.from=196 Hz", "speed.to=202 Hz"), 200.0)
    assert whirl.frequency_Hz == pytest.approx(100.0, rel=1e-12)
    assert whirl.eccentricity_max[0] == pytest.approx(0.940716, abs=2e-6)


def test_a_speed_at_which_a_whirl_does_not_lock_in_says_so() -> None:
    """Jeffcott rotor with 1 g mm in short films at 190 Hz: a run has 95.0484 Hz over four beats of 10.3 s."""
    case = jeffcott(1.0, "film.theory=short", "speed.from=189.9 Hz", "speed.to=190 Hz")
    (branch,) = frbcli.limit_cycles(case, [190.0], with_unbalance=True).branches
    assert not branch.with_unbalance
    assert {missing.reason for missing in branch.missing} == {"no stable motion of half the speed was found"}


def test_a_case_without_unbalance_is_refused() -> None:
    with pytest.raises(frbcli.InputError, match="is zero"):
        frbcli.limit_cycles(jeffcott(0.0), with_unbalance=True)
