"""A whirl beside the unbalance: motions of two frequencies, and whirls that lock in at half the speed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cycle_machines import machine_of, ring_case
from whirls_of_jeffcott import SHORT, harmonic, jeffcott

import frbcli
from frbcli.case.reading.load import load_case_text
from frbcli.cycles.method.balance import packed, unpacked
from frbcli.cycles.parts.linearised import state_space
from frbcli.cycles.parts.machine import Loads, Machine, driven_motions, film_loads, transfer
from frbcli.cycles.result import CyclePoint, UnbalancedWhirl
from frbcli.cycles.unbalance import torus_branch, two_frequencies
from frbcli.cycles.unbalance.growth import is_stable
from frbcli.cycles.unbalance.two_frequencies import Torus, fitted, of_cycle, samples, solved, with_unbalance
from frbcli.cycles.unbalance.whirls import motion_of


def asked(case: frbcli.Case, speed_Hz: float) -> CyclePoint:
    """The stable cycle at a speed."""
    points = [point for branch in frbcli.limit_cycles(case, [speed_Hz]).branches for point in branch.points]
    (point,) = [point for point in points if point.kind == "asked" and point.stable]
    return point


@pytest.fixture(scope="module")
def short() -> tuple[Machine, CyclePoint]:
    """The Jeffcott rotor in short films and its cycle at 190 Hz."""
    case = jeffcott(0.3, SHORT, "speed.from=186 Hz", "speed.to=192 Hz")
    return machine_of(case), asked(case, 190.0)


def cycle_of(machine: Machine, point: CyclePoint) -> Torus:
    return of_cycle(motion_of(machine, point), 2.0 * math.pi * point.frequency_Hz, 2.0 * math.pi * point.speed_Hz)


def largest(machine: Machine, torus: Torus) -> np.ndarray:
    d = samples(torus.orders, torus.motion, (256, 128))
    return np.array([np.hypot(d[..., 2 * f], d[..., 2 * f + 1]).max() for f in range(machine.film_count)])


def test_samples_and_harmonics_are_inverse() -> None:
    """u = cos(a + 2 b) + 3 sin(2 a - b) + 5 on the grid; and back."""
    orders = np.array([[0, 0], [1, 2], [-2, 1], [1, 0]])
    motion = np.array([[5.0], [0.5], [1.5j], [0.0]])
    a, b = np.meshgrid(2.0 * np.pi * np.arange(12) / 12, 2.0 * np.pi * np.arange(10) / 10, indexing="ij")
    found = samples(orders, motion.astype(complex), (12, 10))
    np.testing.assert_allclose(found[..., 0], np.cos(a + 2.0 * b) + 3.0 * np.sin(2.0 * a - b) + 5.0, atol=1e-14)
    np.testing.assert_allclose(two_frequencies.harmonics(found, orders), motion, atol=1e-14)


def test_without_unbalance_it_is_the_cycle(short: tuple[Machine, CyclePoint]) -> None:
    machine, point = short
    torus = fitted(machine, cycle_of(machine, point), share=0.0)
    assert torus.nu / (2.0 * math.pi) == pytest.approx(point.frequency_Hz, rel=1e-7)
    np.testing.assert_allclose(largest(machine, torus), point.eccentricity_max, atol=1e-5)
    assert np.abs(torus.motion[torus.orders[:, 1] > 0]).max() < 1e-9


def test_the_derivative_is_that_of_the_residual(short: tuple[Machine, CyclePoint]) -> None:
    """And equations with the mean of the films' derivatives over b are those of a motion without unbalance."""
    machine, point = short
    torus, c = cycle_of(machine, point), machine.size
    balance = two_frequencies.Linearised(machine, torus, torus.motion)
    step = 1e-8 * np.random.default_rng(0).standard_normal(c * (2 * len(torus.orders) - 1) + 1)

    def at(sign: float) -> np.ndarray:
        motion = torus.motion + sign * unpacked(step[:-1], c)
        moved = replace(torus, motion=motion, nu=torus.nu + sign * float(step[-1]) * machine.pace)
        return two_frequencies.Linearised(machine, moved, torus.motion).residual([])

    changed = balance.moved(step)
    np.testing.assert_allclose(changed, 0.5 * (at(1.0) - at(-1.0)), atol=1e-5 * np.abs(changed).max())
    np.testing.assert_allclose(two_frequencies._ByMean(balance).solved(changed), step, atol=1e-9 * np.abs(step).max())


def test_linear_films_make_the_sum_of_whirl_and_response(
    short: tuple[Machine, CyclePoint], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A spring and a dashpot for each film: the response to the unbalance is what it is without a whirl, and the
    equations of the whirl do not see it."""
    machine, point = short
    spring, dashpot, c = 3e5, 2e2, machine.size

    def linear(machine: Machine, u: np.ndarray, v: np.ndarray, omega: float) -> Loads:
        loads, eye = film_loads(machine, 0.0 * u, 0.0 * v, omega), np.broadcast_to(np.eye(c), (len(u), c, c))
        return replace(loads, values=-spring * u - dashpot * v, by_u=-spring * eye, by_v=-dashpot * eye)

    monkeypatch.setattr(two_frequencies, "film_loads", linear)
    torus = cycle_of(machine, point)
    alone = two_frequencies.Linearised(machine, torus, torus.motion).residual([])
    omega, ((_, driven),) = torus.omega, driven_motions(machine, torus.omega)
    passing = transfer(machine, np.array([omega]), omega)
    felt = passing.values[0] @ np.diag(passing.kappa[0] - spring - 1j * omega * dashpot)
    motion = torus.motion.copy()
    motion[(torus.orders == [0, 1]).all(axis=1)] = np.linalg.solve(np.eye(c) - felt, driven)
    both = two_frequencies.Linearised(machine, replace(torus, motion=motion), torus.motion).residual([(1, driven)])
    np.testing.assert_allclose(both, alone, atol=1e-13)


def test_a_force_that_turns_with_the_rotor_is_an_unbalance(short: tuple[Machine, CyclePoint]) -> None:
    """Of Omega^2 times the unbalance, at the one speed at which it has this size."""
    machine, point = short
    size = 0.3e-6 * (2.0 * math.pi * point.speed_Hz) ** 2
    push = f'force=[{{at="disk", force=["0 N", "{size!r} N"], rotating=true}}]'
    pushed = machine_of(jeffcott(0.0, SHORT, "speed.from=186 Hz", "speed.to=192 Hz", push))
    one, other = (with_unbalance(each, cycle_of(each, point)) for each in (machine, pushed))
    assert np.abs(harmonic(one, 0, 1)).max() > 1e-4
    assert other.nu == pytest.approx(one.nu, rel=1e-9)
    np.testing.assert_allclose(harmonic(other, 0, 1), harmonic(one, 0, 1), atol=1e-9)


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


def test_a_whirl_beside_a_force_of_order_two_has_its_line(short: tuple[Machine, CyclePoint]) -> None:
    _, point = short
    push = 'force=[{at="disk", force=["100 N", "0 N"], order=2}]'
    machine = machine_of(jeffcott(0.0, SHORT, "speed.from=186 Hz", "speed.to=192 Hz", push))
    one, two = (solved(machine, of_cycle(motion_of(machine, point), 2.0 * math.pi * point.frequency_Hz,
                                         2.0 * math.pi * point.speed_Hz, machine.orders), share)
                for share in (0.01, 0.02))  # fmt: skip
    assert np.abs(harmonic(one, 0, 2)).max() > 5e-7
    np.testing.assert_allclose(harmonic(two, 0, 2), 2.0 * harmonic(one, 0, 2), rtol=2e-3)
    np.testing.assert_allclose(harmonic(two, 0, 1), 0.0, atol=1e-9)


def test_a_small_unbalance_acts_linearly(short: tuple[Machine, CyclePoint]) -> None:
    """On the harmonics with k = 1, and with its square on the frequency."""
    machine, point = short
    rest = solved(machine, cycle_of(machine, point), share=0.0)
    one, two = (solved(machine, rest, share) for share in (0.001, 0.002))
    for j in (-3, -2, -1, 0, 1):
        np.testing.assert_allclose(harmonic(two, j, 1), 2.0 * harmonic(one, j, 1), rtol=2e-3)
    one, two = (solved(machine, rest, share) for share in (0.05, 0.1))
    assert (two.nu - rest.nu) / (one.nu - rest.nu) == pytest.approx(4.0, rel=0.02)


def run_at(case: frbcli.Case, speed_Hz: float, duration_s: float, path: Path, *more: str) -> dict[str, np.ndarray]:
    """The last half of a run at constant speed."""
    settings = [f"speed.from={speed_Hz} Hz", f"speed.to={speed_Hz} Hz", f"speed.duration={duration_s} s"]
    settings += ["output.step=5e-5 s", "accuracy.tolerance=1e-7", "accuracy.steps_per_revolution=200"]
    signals = frbcli.runup(load_case_text(case.source_text, [*settings, *more], "run"), path / "r.h5").signals
    return {name: np.asarray(values)[len(np.asarray(values)) // 2 :] for name, values in signals.items()}


def lines_in(signals: dict[str, np.ndarray], torus: Torus, clearance: float) -> dict[tuple[int, int], float]:
    """Amplitudes over the clearance of exp(i (j nu + k Omega) t) in x + i y of the journal, by least squares."""
    size = np.abs(torus.motion).max(axis=1)
    kept = np.argsort(-size)[:60]
    orders = np.concatenate([torus.orders[kept], -torus.orders[kept][np.any(torus.orders[kept] != 0, axis=1)]])
    t = signals["time_s"]
    waves = np.exp(1j * np.outer(t, orders @ np.array([torus.nu, torus.omega])))
    motion = (signals["journal_x_m"] + 1j * signals["journal_y_m"]) / clearance
    found = np.linalg.lstsq(waves, motion, rcond=None)[0]
    return {(int(j), int(k)): float(abs(value)) for (j, k), value in zip(orders, found, strict=True)}


@pytest.mark.nightly
@pytest.mark.parametrize(("speed_Hz", "unbalance"), [(190.0, 0.1), (180.0, 1.0)])
def test_a_whirl_of_two_frequencies_is_that_of_a_run(speed_Hz: float, unbalance: float, tmp_path: Path) -> None:
    """Jeffcott rotor, half-Sommerfeld, in the last 15 of 30 s: eccentricity, and the lines at nu, Omega, Omega - nu."""
    case = jeffcott(unbalance, "start.displacement=[0.3, -0.3]")
    machine = machine_of(case)
    torus = with_unbalance(machine, cycle_of(machine, asked(case, speed_Hz)))
    signals = run_at(case, speed_Hz, 30.0, tmp_path)
    assert largest(machine, torus)[0] == pytest.approx(signals["eccentricity"].max(), abs=1e-4)
    seen = lines_in(signals, torus, float(machine.clearances[0]))
    for j, k in ((1, 0), (0, 1), (-1, 1)):
        x, y = harmonic(torus, j, k)
        assert abs(x + 1j * y) == pytest.approx(seen[(j, k)], rel=1e-3)


def beating_at(speed_Hz: float) -> UnbalancedWhirl:
    case = jeffcott(1.0, SHORT, f"speed.from={speed_Hz - 0.1} Hz", f"speed.to={speed_Hz} Hz")
    found = frbcli.limit_cycles(case, [speed_Hz], with_unbalance=True)
    return found.branches[0].with_unbalance[-1]


def test_a_whirl_that_beats_with_the_unbalance_is_found_and_stable() -> None:
    """1 g mm at 190 Hz, where nothing locks in; a run has 95.048432 Hz and 0.884790 over four beats of 10.3 s."""
    whirl = beating_at(190.0)
    assert not whirl.locked
    assert whirl.stable
    assert whirl.frequency_Hz == pytest.approx(95.048432, abs=1e-6)
    assert whirl.eccentricity_max[0] == pytest.approx(0.884790, abs=2e-6)


@pytest.mark.nightly
@pytest.mark.parametrize(("speed_Hz", "beats"), [(193.0, 4.0), (196.8, 4.0)])
def test_a_beat_is_that_of_a_run(speed_Hz: float, beats: float, tmp_path: Path) -> None:
    """Frequency over whole beats, in which the phase against half the speed gains a turn, and eccentricity."""
    whirl = beating_at(speed_Hz)
    beat_s = 1.0 / abs(2.0 * whirl.frequency_Hz - speed_Hz)
    case = jeffcott(1.0, SHORT, "start.displacement=[0.3, -0.3]")
    signals = run_at(case, speed_Hz, beats * beat_s, tmp_path, "output.step=0.5 ms", "accuracy.tolerance=1e-5",
                     "accuracy.steps_per_revolution=50")  # fmt: skip
    t, z = signals["time_s"], signals["journal_x_m"] + 1j * signals["journal_y_m"]
    phase = np.unwrap(np.angle((z - z.mean()) * np.exp(-1j * np.pi * speed_Hz * t)))
    smooth = np.convolve(phase, np.ones(401) / 401, "valid")
    passed = np.flatnonzero(np.diff(np.floor(smooth / np.pi)))
    seen = 0.5 * speed_Hz + 0.5 / np.diff(t[passed]).mean()
    assert len(passed) > 1
    assert whirl.frequency_Hz == pytest.approx(seen, abs=1e-4)
    assert whirl.eccentricity_max[0] == pytest.approx(signals["eccentricity"].max(), abs=1e-5)
    assert whirl.stable


def test_without_unbalance_it_is_as_stable_as_the_cycle() -> None:
    """Of the floating ring the smaller one of two cycles below its Hopf point is unstable."""
    case = load_case_text(ring_case().source_text, ["rotor.unbalance=0 g*mm", "speed.to=260 Hz"], "ring")
    machine = machine_of(case)
    (branch,) = frbcli.limit_cycles(case).branches
    kinds = {point.stable: point for point in branch.points if not point.kind}
    assert len(kinds) == 2
    for stable, point in kinds.items():
        nu, omega = 2.0 * math.pi * point.frequency_Hz, 2.0 * math.pi * point.speed_Hz
        motion = motion_of(machine, point)
        cycle = np.concatenate([packed(motion), [nu / machine.pace, omega / machine.pace]])
        assert is_stable(machine, state_space(machine), of_cycle(motion, nu, omega), cycle) == stable


def test_newtons_matrix_is_what_a_step_changes(short: tuple[Machine, CyclePoint]) -> None:
    """So that small systems, solved directly, and large ones, solved by GMRES, have the same step."""
    machine, point = short
    balance = two_frequencies.Linearised(machine, cycle_of(machine, point), cycle_of(machine, point).motion)
    step = np.random.default_rng(1).standard_normal(len(balance.row) + 1)
    changed = balance.moved(step)
    np.testing.assert_allclose(balance.matrix() @ step, changed, atol=1e-12 * np.abs(changed).max())


@pytest.mark.nightly
def test_the_whirl_of_a_floating_ring_with_unbalance_is_that_of_a_run(tmp_path: Path) -> None:
    """Without feed holes, at 200 Hz with 3 g mm, after 2 of 4 s."""
    case = load_case_text(ring_case().source_text, ["rotor.unbalance=3 g*mm", "speed.to=240 Hz"], "ring")
    machine = machine_of(case)
    torus = with_unbalance(machine, cycle_of(machine, asked(case, 200.0)))
    signals = run_at(case, 200.0, 4.0, tmp_path)
    seen = [signals[f"eccentricity_{film}"].max() for film in ("inner", "outer")]
    np.testing.assert_allclose(largest(machine, torus), seen, atol=1e-4)


def locked(case: frbcli.Case, speed_Hz: float) -> UnbalancedWhirl:
    found = frbcli.limit_cycles(case, [speed_Hz], with_unbalance=True)
    (whirl,) = [
        whirl for branch in found.branches for whirl in branch.with_unbalance if abs(whirl.speed_Hz - speed_Hz) < 1e-9
    ]
    return whirl


def test_a_whirl_that_locks_in_is_that_of_a_run(tmp_path: Path) -> None:
    """Jeffcott rotor with 3 g mm at 190 Hz: 95.045 Hz without unbalance, half the speed with it."""
    whirl = locked(jeffcott(3.0, "speed.from=186 Hz", "speed.to=192 Hz"), 190.0)
    assert whirl.locked
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


@pytest.mark.nightly
def test_a_large_unbalance_is_reached_by_raising_it(tmp_path: Path) -> None:
    """30 g mm at 190 Hz, which a cycle without unbalance does not lead to at once."""
    whirl = locked(jeffcott(30.0, "speed.from=186 Hz", "speed.to=192 Hz"), 190.0)
    signals = run_at(jeffcott(30.0, "start.displacement=[0.3, -0.3]"), 190.0, 12.0, tmp_path)
    assert whirl.locked
    assert whirl.eccentricity_max[0] == pytest.approx(signals["eccentricity"].max(), abs=2e-5)


@pytest.mark.nightly  # 15 s; a branch with its fold: the tests of followers below
def test_a_branch_with_unbalance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a floating ring: next to its cycles, with the lines of whirl and unbalance first. It is followed on from there
    towards 3 nu = 2 Omega, where it needs ever more lines; here only few are allowed."""
    monkeypatch.setattr(torus_branch, "MOST_UNKNOWNS", 620)
    case = load_case_text(ring_case().source_text, ["rotor.unbalance=3 g*mm", "speed.to=260 Hz"], "ring")
    found = frbcli.limit_cycles(case, with_unbalance=True)
    (branch,) = found.branches
    pairs = [(whirl, point) for whirl in branch.with_unbalance for point in branch.points
             if point.speed_Hz == pytest.approx(whirl.speed_Hz, rel=1e-12)]  # fmt: skip
    assert 3 < len(pairs) < len(branch.with_unbalance)
    assert any("too many lines" in note for note in found.notes)
    for whirl, cycle in pairs:
        assert not whirl.locked
        assert whirl.stable
        assert [line.name for line in whirl.lines[:2]] == ["nu", "Omega"]
        assert whirl.frequency_Hz == pytest.approx(cycle.frequency_Hz, rel=0.02)
        np.testing.assert_allclose(whirl.eccentricity_max, cycle.eccentricity_max, atol=0.02)
    table = found.to_pandas()
    assert (table["kind"] == "two frequencies").sum() == len(branch.with_unbalance)
