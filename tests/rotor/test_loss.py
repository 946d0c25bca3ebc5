"""A blade that is lost during a run: closed forms of linear rotors, and films that come to the same orbit."""

import cmath
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from resumed import assert_resumable
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from series_rotors import HEAVY

import frbcli
from frbcli.arrays import Array, Complex
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.errors import InputError
from frbcli.linear.response import response
from frbcli.results.store import Run
from frbcli.rotor.assembly import LinearRotor
from frbcli.scene.changes import after_losses, case_at
from frbcli.scene.machine.rotor import make_rotor

TURN = 2.0 * math.pi
M, C, D = 1.0, 1e6, 40.0  # kg, N/m, N s/m: 159 Hz and a damping ratio of 0.02
U, LOST, PHASE, LOSS_s = 2e-5, 5e-5, 2.0, 0.11  # kg m, rad, s
LOSS = {"time": f"{LOSS_s} s", "unbalance": f"{LOST!r} kg*m", "phase": f"{PHASE!r} rad"}
ROTOR = {
    "kind": "jeffcott", "mass": f"{M} kg", "journal_mass": "1 g", "shaft_stiffness": f"{C!r} N/m", "gravity": 0,
    "unbalance": f"{U!r} kg*m", "external_damping": f"{D} N*s/m",
}  # fmt: skip
RIGID = {"kind": "coefficients", "stiffness": "1e13 N/m"}  # against the shaft


def jeffcott(low: float, high: float, **rotor: object) -> frbcli.Case:
    speed = {"from": f"{low} Hz", "to": f"{high} Hz", "duration": "0.25 s"}
    tables = {"rotor": ROTOR | {"loss": LOSS} | rotor, "bearing": RIGID, "speed": speed}
    return case_from_dict({**tables, "accuracy": {"tolerance": 1e-9, "steps_per_revolution": 400}}, "jeffcott")


def disk(run: Run, name: str = "disk") -> Complex:
    return np.asarray(run[f"{name}_x_m"] + 1j * run[f"{name}_y_m"])


def test_a_jeffcott_rotor_goes_on_as_the_closed_form(tmp_path: Path) -> None:
    """W'' + 2 zeta w W' + w^2 W = i u Omega^2 e^(i Omega t) / m in rigid bearings, by its free vibrations and its
    steady state before and after the loss, which place and velocity at the loss join."""
    omega = TURN * 100.0
    run = frbcli.runup(jeffcott(100.0, 100.0), tmp_path / "run.h5")
    times, roots = run["time_s"], np.roots([M, D, C])

    def steady(u: complex) -> complex:
        return 1j * u * omega**2 / (C - M * omega**2 + 1j * D * omega)

    def moved(t: Array | float, start: float, state: Array, u: complex) -> Array:
        """(2, n) place and velocity at t of a motion that has a state (2,) at its start."""
        still = steady(u) * np.exp(1j * omega * start) * np.array([1.0, 1j * omega])
        free = np.linalg.solve(np.array([[1.0, 1.0], roots]), state - still)
        whirls = [amount * np.exp(root * (t - start)) for amount, root in zip(free, roots, strict=True)]
        turning = steady(u) * np.exp(1j * omega * np.asarray(t))
        return np.array([turning + sum(whirls), 1j * omega * turning + roots[0] * whirls[0] + roots[1] * whirls[1]])

    after = U + cmath.rect(LOST, PHASE)
    at_loss = moved(LOSS_s, 0.0, np.zeros(2), U)
    expected = np.where(times <= LOSS_s, moved(times, 0.0, np.zeros(2), U)[0], moved(times, LOSS_s, at_loss, after)[0])
    assert np.abs(disk(run) - expected).max() < 1e-6 * np.abs(expected).max()
    assert [(event["kind"], event["t_s"]) for event in run.events if event["kind"] == "loss"] == [("loss", LOSS_s)]
    before_alone = np.abs(disk(run) - moved(times, 0.0, np.zeros(2), U)[0])
    assert before_alone[times <= LOSS_s].max() < 1e-6 * np.abs(expected).max()
    assert before_alone.max() > 0.1 * np.abs(expected).max()


def test_a_lost_blade_turns_with_the_rotor_as_it_runs_up(tmp_path: Path) -> None:
    """Along and across, by the acceleration and the square of the speed, against an integration of the equation."""
    run = frbcli.runup(jeffcott(60.0, 160.0), tmp_path / "run.h5")
    times, low, rate = run["time_s"], TURN * 60.0, TURN * 400.0

    def motion(t: float, state: Array) -> list[complex]:
        unbalance = U + (cmath.rect(LOST, PHASE) if t >= LOSS_s else 0.0)
        omega, angle = low + rate * t, low * t + 0.5 * rate * t**2
        force = unbalance * (rate + 1j * omega**2) * cmath.exp(1j * angle)
        return [state[1], (force - D * state[1] - C * state[0]) / M]

    state, expected = np.zeros(2, dtype=complex), np.zeros(len(times), dtype=complex)
    for begin, end in ((0.0, LOSS_s - 1e-15), (LOSS_s, 0.25)):
        span = (times >= begin) & (times <= end + 1e-12)
        solved = solve_ivp(motion, (begin, end + 1e-12), state, "DOP853", rtol=1e-12, atol=1e-18, dense_output=True)
        expected[span], state = solved.sol(times[span])[0], solved.y[:, -1]
    assert np.abs(disk(run) - expected).max() < 1e-5 * np.abs(expected).max()


def exact(rotor: LinearRotor, omega: float, times: Array, start: float, state: Array) -> Array:
    """(k, 2 n) displacements and velocities at times (k,) from a state (2 n,) on, at a constant speed."""
    here, n = rotor.at(omega), rotor.size
    damping, inverse = here.damping + omega * here.gyroscopic, np.linalg.inv(here.mass)
    whole = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ here.stiffness, -inverse @ damping]])
    rest = np.concatenate([np.linalg.solve(here.stiffness, here.static_load), np.zeros(n)])
    dynamic = here.stiffness + 1j * omega * damping - omega**2 * here.mass
    q = np.linalg.solve(dynamic, omega**2 * here.unbalance)
    turning = np.concatenate([q, 1j * omega * q])

    def forced(t: float) -> Array:
        return np.asarray(rest + (turning * np.exp(1j * omega * t)).real)

    return np.array([expm((t - start) * whole) @ (state - forced(start)) + forced(t) for t in times])


def heavy(**loss_of: dict[str, str]) -> frbcli.Case:
    disks = [one | ({"loss": loss_of[one["name"]]} if one["name"] in loss_of else {}) for one in HEAVY["disk"]]
    speed = {"from": "220 Hz", "to": "220 Hz", "duration": "0.06 s"}
    accuracy = {"tolerance": 1e-8, "steps_per_revolution": 200}
    rotor = {"kind": "turbocharger", "modes": 5}
    return case_from_dict({**HEAVY, "rotor": rotor, "disk": disks, "speed": speed, "accuracy": accuracy}, "heavy")


def test_two_disks_of_a_shaft_lose_blades_one_after_the_other(tmp_path: Path) -> None:
    """Against the exact motion of the linear machine, with gyroscopic moments, weight and cross-coupled bearings."""
    losses: dict[str, Any] = {
        "turbine": {"time": "20 ms", "unbalance": "30 g*mm", "phase": "70 deg"},
        "compressor": {"time": "35 ms", "unbalance": "10 g*mm", "phase": "-20 deg"},
    }
    case, omega = heavy(**losses), TURN * 220.0
    run = frbcli.runup(case, tmp_path / "run.h5")
    times, begins = run["time_s"], (0.0, 0.02, 0.035, 0.06)
    state, place = np.zeros(2 * make_rotor(case).size), dict(make_rotor(case).points)["disk_turbine"]
    expected = np.zeros((len(times), len(state)))
    for begin, end in pairwise(begins):
        rotor, span = make_rotor(case_at(case, begin)), (times >= begin) & (times <= end + 1e-12)
        expected[span] = exact(rotor, omega, times[span], begin, state)
        state = exact(rotor, omega, np.array([end]), begin, state)[0]
    moved = expected[:, : len(state) // 2] @ place.T
    assert np.abs(disk(run, "disk_turbine") - moved @ [1.0, 1j]).max() < 1e-5 * np.abs(moved).max()
    losses_found = [(event["t_s"], event["point"]) for event in run.events if event["kind"] == "loss"]
    assert losses_found == [(0.02, "disk_turbine"), (0.035, "disk_compressor")]


def test_the_unbalance_after_the_loss_is_the_sum_of_both() -> None:
    whole = U + cmath.rect(LOST, PHASE)
    case = jeffcott(50.0, 200.0)
    before, after = response(case, [100.0]), response(case, [100.0], after_loss=True)
    assert after.motion == pytest.approx(before.motion * whole / U, rel=1e-12)
    assert (before.what, after.what) == ("unbalance response", "unbalance response after the loss")
    early = jeffcott(50.0, 200.0, loss=LOSS | {"time": "0 s"})
    assert response(early, [100.0]).motion == pytest.approx(after.motion, rel=1e-12)
    assert after_losses(case).rotor == early.rotor


def test_a_response_after_no_loss_is_refused() -> None:
    with pytest.raises(InputError, match="no unbalance is lost"):
        response(load_case("seal"), [100.0], after_loss=True)


FILMS = ["film.theory=short", "speed.from=40Hz", "speed.to=40Hz", "speed.duration=0.8s", "rotor.unbalance=50g*mm"]
ONE_MORE = 'rotor.loss={time="0.1 s", unbalance="150 g*mm"}'


def test_journals_in_films_come_to_the_orbit_of_the_whole_unbalance(tmp_path: Path) -> None:
    lost = frbcli.runup(load_case("jeffcott", [*FILMS, ONE_MORE]), tmp_path / "lost.h5")
    whole = frbcli.runup(load_case("jeffcott", [*FILMS, "rotor.unbalance=200g*mm"]), tmp_path / "whole.h5")
    none = frbcli.runup(load_case("jeffcott", FILMS), tmp_path / "none.h5")
    times = lost["time_s"]
    early, late = times <= 0.1, times > 0.7
    np.testing.assert_allclose(lost["eccentricity"][early], none["eccentricity"][early], atol=1e-4)
    np.testing.assert_allclose(lost["eccentricity"][late], whole["eccentricity"][late], atol=2e-4)
    assert np.abs(lost["eccentricity"] - none["eccentricity"])[late].max() > 0.02


def test_a_run_that_goes_on_from_a_checkpoint_is_the_same_run(tmp_path: Path) -> None:
    """Before the loss and after it."""
    assert_resumable(load_case("jeffcott", [*FILMS, "speed.duration=0.15s", ONE_MORE]), tmp_path, 0.05, 0.1)


def test_the_shipped_turbine_comes_to_a_larger_orbit(tmp_path: Path) -> None:
    """Of the size that its linear response has, though a journal moves over much of its gap."""
    case = load_case("blade-loss")
    run = frbcli.runup(case, tmp_path / "run.h5")
    time, expected = run["time_s"], []
    sizes = [0.5 * np.ptp(run["disk_turbine_x_m"][span]) for span in ((time > 0.15) & (time < 0.2), time > 0.38)]
    for after_loss in (False, True):
        found = response(case, [100.0], after_loss=after_loss)
        expected.append(np.abs(found.motion[0, found.points.index("disk_turbine"), 0]))
    assert [event["kind"] for event in run.events] == ["loss"]
    assert sizes == pytest.approx(expected, rel=0.15)
    assert sizes[1] > 15.0 * sizes[0]


def test_a_disk_loses_two_blades_one_after_the_other(tmp_path: Path) -> None:
    """In any order, as with one alone until the second; each is an event. The steady motion has the sum."""
    first, second = (
        {"time": t, "unbalance": u, "phase": "0 rad"} for t, u in (("0.1 s", "3e-5 kg*m"), ("0.15 s", "4e-5 kg*m"))
    )
    both = frbcli.runup(jeffcott(100.0, 100.0, loss=[first, second]), tmp_path / "both.h5")
    turned = frbcli.runup(jeffcott(100.0, 100.0, loss=[second, first]), tmp_path / "turned.h5")
    alone = frbcli.runup(jeffcott(100.0, 100.0, loss=[first]), tmp_path / "first.h5")
    late = both["time_s"] > 0.15
    assert [(event["kind"], event["t_s"]) for event in both.events] == [("loss", 0.1), ("loss", 0.15)]
    np.testing.assert_allclose(disk(turned), disk(both), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(disk(both)[~late], disk(alone)[~late], atol=1e-12)
    assert np.abs(disk(both) - disk(alone))[late].max() > 0.1 * np.abs(disk(alone)).max()
    steady = response(jeffcott(100.0, 100.0, loss=[first, second]), [100.0], after_loss=True)
    one = response(jeffcott(100.0, 100.0), [100.0])
    assert steady.motion == pytest.approx(one.motion * (U + 7e-5) / U, rel=1e-12)
