"""Motions with unbalance: synchronous ones, also of films on cells, and whirls that lock in.

The answers are those of linear responses, of the time loop, which the motions come back to, and of the machine without
unbalance.
"""

import json
import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from cycle_machines import machine_of
from known_flows import KnownFlow
from marches import rigid_shaft

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.cycles.columns import CycleBranch, CyclePoint, UnbalancedWhirl
from frbcli.cycles.method.machine import driven_motions
from frbcli.cycles.shooting.diagram import _locking, whirls_of_branch
from frbcli.cycles.shooting.period_map import SAMPLES, Passage, PeriodMap, Wet, period_map, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting, Shot, largest

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


OMEGA = 2.0 * math.pi * 120.0
TURNS = 60


@lru_cache
def rigid(unbalance: str = "30 g*mm") -> PeriodMap:
    return period_map(frbcli.load_case("rigid", ["film.cavitation=reynolds", f"rotor.unbalance={unbalance}"]))


def after(shooting: Shooting, wet: Wet, omega: float, turns: int, periods: int = 1) -> tuple[Wet, np.ndarray]:
    """The machine after so many times of some periods of the rotor, and the orbit of the last."""
    for _ in range(turns):
        passage = shooting.flow.passage(wet, 2.0 * math.pi * periods / omega, omega, 100 * periods)
        wet = passage.end
    return wet, passage.displacements


def test_a_synchronous_motion_is_what_the_time_loop_ends_in() -> None:
    free = Shooting(rigid(), OMEGA)
    rest = settled(free, OMEGA)
    assert rest is not None
    assert rest.stable
    shot = free.with_all_unbalance.with_unbalance(rest)
    assert shot is not None
    assert shot.multipliers.stable
    assert math.exp(shot.p.sum()) == pytest.approx(2.0 * math.pi, rel=1e-9)
    assert np.abs(shot.multipliers.others[0]) ** TURNS < 1e-3
    _, orbit = after(free.with_all_unbalance, rest.wet, OMEGA, TURNS)
    assert largest(orbit)[0] > largest(rest.displacement[None] * np.ones((3, 1, 1)))[0] + 0.01
    np.testing.assert_allclose(shot.eccentricity_max, largest(orbit), atol=1e-5)


def test_little_unbalance_leaves_the_multipliers_of_the_resting_position() -> None:
    free = Shooting(rigid(), OMEGA)
    rest = settled(free, OMEGA)
    assert rest is not None
    shot = Shooting(replace(rigid(), driven=0.01), OMEGA).with_unbalance(rest)
    assert shot is not None
    sizes = np.exp(np.sort(rest.eigenvalues.real)[::-1] * 2.0 * math.pi / OMEGA)
    np.testing.assert_allclose(np.abs(shot.multipliers.others)[:2], sizes[:2], atol=5e-3)


@dataclass(frozen=True)
class Carried(KnownFlow):
    """A whirl with nu = 0.49 Omega on a circle of the radius 0.5, on which disturbances of the radius decay with 2 and
    those of two further numbers with `decay`, on a centre that the unbalance carries around on a circle of 0.1."""

    decay: float = 0.3

    def passage(self, wet: Wet, time: float, omega: float, _: int, samples: int = SAMPLES) -> Passage:
        t = np.linspace(0.0, time, samples + 1)
        z, growth = complex(*wet.q) - 0.1 * self.driven, np.exp(2.0 * t)
        size = np.sqrt(growth / (1.0 + 4.0 * abs(z) ** 2 * (growth - 1.0)))
        moved = z * size * np.exp(0.49j * omega * t) + 0.1 * self.driven * np.exp(1j * omega * t)
        places = np.column_stack([moved.real, moved.imag])
        end = np.concatenate([places[-1], np.exp(-self.decay * time) * wet.v])
        return Passage(replace(wet, q=end[:2], v=end[2:]), places[:, None])


def one_cycle(flow: KnownFlow) -> tuple[Shooting, CycleBranch, Shot]:
    """The whirl of a known flow as a branch of one stable cycle behind a resting position."""
    free, wet = Shooting(flow, 2.0), flow.wet(np.array([0.5, 0.0, 0.0, 0.0]), 2.0)  # type: ignore[arg-type]
    p = np.array([math.log(2.0 * math.pi / 0.49), 0.0])
    shot = free._near(wet, p, np.zeros(6), 200)
    rest = CyclePoint(
        value=0.3, speed_Hz=0.3, frequency_Hz=0.49 / math.pi, eccentricity_max=np.zeros(1), ring_speeds_Hz=np.zeros(0),
        torque_N_m=0.0, stable=False, multipliers=np.ones(1, dtype=complex),
        harmonics=np.zeros((1, 1, 2), dtype=complex),
    )  # fmt: skip
    branch = CycleBranch(0, (rest, replace(rest, speed_Hz=1.0 / math.pi, stable=True)), "It leaves the range.")
    return free, branch, shot


def test_a_whirl_that_does_not_lock_in_says_what_a_run_does() -> None:
    free, branch, shot = one_cycle(Carried(lambda z, _: z, held=np.zeros(1)))
    found = whirls_of_branch(free, branch, [shot], 1.0, None)
    assert found.note == branch.note
    assert not found.with_unbalance
    (missing,) = found.missing
    assert missing.speed_Hz == pytest.approx(1.0 / math.pi)
    assert missing.reason == "a run from the cycle whirls on with 0.156 Hz and an eccentricity of 0.600"


@dataclass(frozen=True)
class Decaying(Carried):
    """The same without a whirl: what is off the circle of the unbalance decays, or, without it, stays."""

    def passage(self, wet: Wet, time: float, omega: float, _: int, samples: int = SAMPLES) -> Passage:
        t = np.linspace(0.0, time, samples + 1)
        z = (complex(*wet.q) - 0.1 * self.driven) * np.exp((0.49j * omega - 0.2 * self.driven) * t)
        moved = z + 0.1 * self.driven * np.exp(1j * omega * t)
        places = np.column_stack([moved.real, moved.imag])
        return Passage(replace(wet, q=places[-1], v=np.exp(-self.decay * time) * wet.v), places[:, None])


def test_a_speed_at_which_the_whirl_decays_says_so() -> None:
    free, branch, shot = one_cycle(Decaying(lambda z, _: z, held=np.zeros(1)))
    (missing,) = whirls_of_branch(free, branch, [shot], 1.0, None).missing
    assert missing.speed_Hz == pytest.approx(1.0 / math.pi)
    assert missing.reason == "a run from the cycle comes back to the synchronous motion"


def whirling(name: str, speed_Hz: float, turns: int, *settings: str) -> tuple[Shooting, Shot]:
    """A cycle without unbalance that the time loop goes to from a large whirl."""
    flow, omega = period_map(frbcli.load_case(name, settings)), 2.0 * math.pi * speed_Hz
    free = Shooting(flow, omega)
    rest = settled(free, omega)
    assert rest is not None
    seen, middle = flow.journals[0], flow.scale * np.array([0.85, 0.0])
    q = rest.wet.q + np.linalg.lstsq(seen, middle - seen @ rest.wet.q, rcond=None)[0]
    v = np.linalg.lstsq(seen, 0.5 * omega * middle[::-1], rcond=None)[0]
    wet, _ = after(free, wet_at(flow, q, v, omega), omega, turns)
    passage = flow.passage(wet, 60.0 * 2.0 * math.pi / omega, omega, 6000, 6000)
    d = passage.displacements[:, 0] - passage.displacements[:, 0].mean(axis=0)
    turned = np.unwrap(np.arctan2(d[:, 1], d[:, 0]))
    p = np.array([math.log(2.0 * math.pi * 60.0 * 2.0 * math.pi / (turned[-1] - turned[0])), 0.0])
    return free, replace(free._near(passage.end, p, np.zeros(len(rest.x) + 2), 200))


POCKET = 'bearing.supply={kind="pocket",position="0 deg",opening_angle="60 deg",width="10 mm",pressure="2 bar"}'
GROOVE = 'bearing.inner.supply={kind="circumferential-groove",pressure="2 bar"}'
SHAKEN, CELLS = "rotor.unbalance=20 g*mm", "accuracy.mesh=[4,24]"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("case", "speed_Hz"),
    [
        (frbcli.load_case("jeffcott", [SHAKEN, CELLS, POCKET, "film.cavitation=reynolds"]), 110.0),
        (rigid_shaft(CELLS, "film.tilt=follows", "disk.0.position=12 mm"), 150.0),
        (
            frbcli.load_case(
                "floating-ring", [SHAKEN, "accuracy.mesh=[5,32]", GROOVE, "film.cavitation=two-phase"]
            ),
            55.0,
        ),
    ],
    ids=("pocket", "tilt", "ring and oil"),
)  # fmt: skip
def test_synchronous_motions_of_all_films_are_what_the_time_loop_ends_in(case: Case, speed_Hz: float) -> None:
    flow, omega = period_map(case), 2.0 * math.pi * speed_Hz
    free = Shooting(flow, omega)
    rest = settled(free, omega)
    assert rest is not None
    shot = free.with_all_unbalance.with_unbalance(rest)
    assert shot is not None
    assert shot.multipliers.stable
    _, orbit = after(free.with_all_unbalance, rest.wet, omega, 160)
    assert np.abs(shot.eccentricity_max - np.hypot(*rest.displacement.T)).max() > 0.01
    np.testing.assert_allclose(largest(orbit), shot.eccentricity_max, atol=1e-6)


@pytest.mark.nightly
def test_a_whirl_that_locks_in_is_what_the_time_loop_ends_in_with_oil_that_films_keep() -> None:
    free, shot = whirling("rigid-two-phase", 82.0, 300, 'bearing.supply.pressure="2 bar"', "rotor.unbalance=10 g*mm")
    omega = 2.0 * math.pi * 82.0
    _, found = _locking(free.with_all_unbalance, shot.wet, omega)
    assert found is not None
    _, orbit = after(free.with_all_unbalance, found.wet, omega, 150, 2)
    np.testing.assert_allclose(largest(orbit), found.eccentricity_max, atol=1e-6)
