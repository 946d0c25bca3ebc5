"""The synchronous response beside the linear one and a run, and whirls that lock in at half the speed, beside runs."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from cycle_machines import machine_of

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.cli.main import run as frb
from frbcli.cycles.columns import UnbalancedWhirl
from frbcli.cycles.method.machine import driven_motions

SHORT = "film.theory=short"


def jeffcott(unbalance: float, *settings: str) -> frbcli.Case:
    return frbcli.load_case("jeffcott", [f"rotor.unbalance={unbalance} g*mm", *settings])


def test_a_small_force_of_order_two_has_the_linear_response() -> None:
    push = 'force=[{at="disk", force=["0.2 N", "0.1 N"], order=2}]'
    case = jeffcott(0.0, SHORT, "speed.from=60 Hz", "speed.to=61 Hz", push)
    point = frbcli.limit_cycles(case).synchronous[0]
    linear = frbcli.response(case, [point.speed_Hz], excitation="force 1")
    journal = linear.motion[0, linear.points.index("journal")]
    found = 2.0 * 35e-6 * point.harmonics[2].ravel()
    assert np.abs(found).max() > 1e-4 * 35e-6
    np.testing.assert_allclose(found, journal, atol=1e-3 * np.abs(journal).max())
    np.testing.assert_allclose(point.harmonics[1], 0.0, atol=1e-4)


def test_a_force_that_turns_with_the_rotor_is_an_unbalance() -> None:
    """Of Omega^2 times the unbalance, at the one speed at which it has this size."""
    omega = 2.0 * math.pi * 120.0
    push = f'force=[{{at="disk", force=["0 N", "{30e-6 * omega**2!r} N"], rotating=true}}]'
    one, other = (
        sum(motion for order, motion in driven_motions(machine_of(case), omega) if order == 1)
        for case in (jeffcott(30.0, SHORT), jeffcott(0.0, SHORT, push))
    )
    assert np.abs(one).max() > 1e-2
    np.testing.assert_allclose(other, one, atol=1e-9)


def test_a_ground_that_moves_with_the_rotor_drives_as_the_inertia_of_all_masses() -> None:
    """Of order 2: forces of mass times acceleration on the disk and on both journals."""
    omega = 2.0 * math.pi * 80.0
    base = 'base={acceleration=["2 m/s^2", "1 m/s^2"], order=2}'
    plain = jeffcott(0.0, SHORT, base)
    assert plain.rotor.kind == "jeffcott"
    push = [
        {"at": place, "force": [-2.0 * mass, -1.0 * mass], "order": 2.0}
        for place, mass in (("disk", plain.rotor.mass), ("journal", 0.5 * plain.rotor.journal_mass))
    ]
    pushed = jeffcott(0.0, SHORT).with_settings({"force": push})
    shaken, forced = (
        sum(motion for order, motion in driven_motions(machine_of(case), omega) if order == 2)
        for case in (plain, pushed)
    )
    assert np.abs(shaken).max() > 0.0
    np.testing.assert_allclose(shaken, forced, rtol=1e-9)


def test_the_synchronous_motion_is_that_of_a_run(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """Jeffcott rotor with 60 g mm at 130 Hz, where the orbit is a quarter of the clearance: a run at constant speed."""
    settings = ["film.theory=short", "rotor.unbalance=60 g*mm"]
    constant = ["speed.from=130 Hz", "speed.to=130 Hz", "speed.duration=1.5 s", "output.step=2e-5 s"]
    constant += ["accuracy.tolerance=1e-8", "accuracy.steps_per_revolution=400"]
    run_ = frbcli.runup(frbcli.load_case("jeffcott", [*settings, *constant]), tmp_path / "r.h5")
    seen = run_.signals["eccentricity"][-5000:]
    response = frbcli.limit_cycles(frbcli.load_case("jeffcott", [*settings, "speed.to=130 Hz"])).synchronous
    assert response[0].speed_Hz == pytest.approx(130.0)
    assert response[0].stable
    assert response[0].eccentricity_max[0] == pytest.approx(seen.max(), abs=2e-4)


def test_a_bistable_damper_has_branches_that_meet_in_folds(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Three motions at one speed between the folds, of which the middle one is unstable."""
    settings = {"bearing.damper.centred": "true", "film.theory": "short", "bearing.damper.spring": "2e7 N/m",
                "oil.viscosity": "3 mPa*s", "rotor.unbalance": "800 g*mm"}  # fmt: skip
    command = ["limit-cycles", "squeeze-film-damper", "--with-unbalance", "-o", str(tmp_path / "it.png")]
    command += [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    assert frb([*command, "--json"]) == 0
    document = json.loads(capfd.readouterr().out)
    folds = [point for point in document["special"] if point["kind"] == "fold"]
    assert [(fold["synchronous"], fold["branch"]) for fold in folds] == [(True, None)] * 2
    lower, upper = sorted(fold["speed_Hz"] for fold in folds)
    between = [point for point in document["synchronous"] if lower < point["speed_Hz"] < upper and not point["kind"]]
    assert {point["stable"] for point in between} == {True, False}
    at_once = [note for note in document["notes"] if "synchronous motion" in note]
    assert len(at_once) == 4  # that there are three branches, and each of them
    told = " and ".join(f"{fold['speed_Hz']:.6g} Hz" for fold in folds)
    assert f"3 branches, which meet in folds at {told}." in at_once[0]
    assert [("unstable" in note, note.count("stable")) for note in at_once[1:]] == [(False, 1), (True, 1), (False, 1)]


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
