"""Pins of semi-floating rings: free turning within the play, rest against the pin, rebound, and a pin without play."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from marches import march, planned_system, start

import frbcli
from frbcli.case.schema import Case
from frbcli.elements.pin import pin_torque
from frbcli.errors import FrbError
from frbcli.plot.motion import quantity_figure
from frbcli.rotor.loads import speed_profile
from frbcli.scene.machine.system import System
from frbcli.solve.ring_spin import DAMPING, PLAY, STIFFNESS, pinned
from frbcli.solve.state import Control

OMEGA, INERTIA = 200.0 * math.pi, 20e-6  # rad/s, kg m^2
RADIUS, PLAYS, SPRING, DASHPOT = 16e-3, 1.6e-3, 1e6, 400.0  # m, m, N/m, N s/m
GROOVE = 'bearing.inner.supply={kind="circumferential-groove", pressure="2 bar"}'
CONCENTRIC = (GROOVE, "film.cavitation=sommerfeld", "rotor.gravity=0", "rotor.unbalance=0", "accuracy.mesh=[3, 16]")


def pin(play: float = PLAYS, stiffness: float = SPRING, damping: float = DASHPOT) -> str:
    return f"bearing.pin={{radius={RADIUS}, play={play}, stiffness={stiffness}, damping={damping}}}"


def ringed(*settings: str) -> Case:
    return frbcli.load_case("floating-ring", [*CONCENTRIC, *settings])


def turned(system: System, duration: float, speed: float = 0.0, output: float = 1e-4) -> tuple[np.ndarray, ...]:
    """Times, angles and speeds of the ring of a machine at OMEGA that begins with a speed in rad/s."""
    v = np.zeros(system.rotor.size)
    v[-1] = speed
    profile = speed_profile((0.0, duration), (OMEGA, OMEGA))
    run = march(system, profile, Control(1e-8, 24.0, 1e-3, output, 0.9999, 0.0), start(system, profile, v=v))
    return run.times, run.q[:, -1], run.v[:, -1]


def test_a_ring_turns_through_its_play_and_rests_where_the_spring_balances_its_films() -> None:
    """Concentric films pull with k_i (omega - w) - k_o w, k = 2 pi eta R^3 B / C: the ring turns as without a pin until
    it has turned by the play, 0.1 rad, and comes to rest at k_i omega / K behind it."""
    system = planned_system(ringed(pin()))
    k_i, k_o = 2.0 * math.pi * np.array(system.drags)
    rate, last = (k_i + k_o) / INERTIA, k_i * OMEGA / (k_i + k_o)
    t, angle, speed = turned(system, 0.06)
    play, spring = PLAYS / RADIUS, SPRING * RADIUS**2
    free = last * (t - (1.0 - np.exp(-rate * t)) / rate)
    before = free < play
    assert 50 < np.count_nonzero(before) < 200
    np.testing.assert_allclose(angle[before], free[before], atol=1e-6)
    np.testing.assert_allclose(speed[before], last * (1.0 - np.exp(-rate * t[before])), atol=1e-4)
    assert angle.max() > play + 5.0 * k_i * OMEGA / spring  # it had come with a speed
    assert angle[-1] == pytest.approx(play + k_i * OMEGA / spring, rel=1e-8)
    assert abs(speed[-1]) < 1e-6 * last
    torque = pin_torque(system.pins[0], angle, speed)
    assert not torque[before].any()
    assert torque[-1] == pytest.approx(-k_i * OMEGA, rel=1e-6)


def test_a_pin_gives_back_what_its_damper_leaves() -> None:
    """Without drag a ring bounces to and fro: as fast as it came without a damper, and with one by the factor
    exp(-b t), b = C / (2 I), tan(w t) = -2 b w / (w^2 - b^2), at which its acceleration and so the force is zero."""
    system, speed = planned_system(ringed(pin(damping=0.0))), 25.0
    still = replace(system, drags=(0.0, 0.0), torque="couette")
    row = system.pins[0]
    own = math.sqrt(row[STIFFNESS] / INERTIA)
    t, angle, v = turned(still, 0.02, speed, 2e-5)
    touches, leaves = row[PLAY] / speed, row[PLAY] / speed + math.pi / own
    back = (t > leaves + 1e-4) & (t < leaves + 2.0 * touches - 1e-4)
    assert np.count_nonzero(back) > 100
    np.testing.assert_allclose(v[back], -speed, rtol=1e-5)
    assert angle.max() == pytest.approx(row[PLAY] + speed / own, rel=1e-4)
    assert v[-1] == pytest.approx(speed, rel=1e-4)  # twice
    rows = system.pins.copy()
    rows[0, DAMPING] = 0.3 * own * INERTIA
    damped = replace(still, pins=rows)
    b = 0.15 * own
    w = math.sqrt(own**2 - b**2)
    last = (math.pi - math.atan(2.0 * b * w / (w**2 - b**2))) / w
    t, _, v = turned(damped, touches + last + 2e-3, speed, 2e-5)
    np.testing.assert_allclose(v[t > touches + last + 1e-4], -speed * math.exp(-b * last), rtol=1e-4)


def test_a_stiff_pin_without_play_is_a_blocked_ring() -> None:
    """They differ by 1 / stiffness, and its torque is what the films pull with."""
    loaded = "rotor.gravity=9.81", "rotor.unbalance=50 g*mm"
    held = march_of(planned_system(ringed('bearing.ring.spin="blocked"', *loaded)))
    away = []
    for stiffness in (1e7, 1e9):
        q = march_of(planned_system(ringed(pin(0.0, stiffness, 0.0), *loaded)))
        away.append(np.abs(q[:, :-1] - held).max() / np.abs(held).max())
    assert away[0] > 1e-7
    assert away[1] < 0.03 * away[0]


def march_of(system: System) -> np.ndarray:
    profile = speed_profile((0.0, 0.02), (OMEGA, OMEGA))
    q: np.ndarray = march(system, profile, Control(1e-9, 24.0, 1e-3, 1e-3, 0.9999, 0.0)).q
    return q


@pytest.mark.parametrize("damping", [0.0, 0.03, 0.3])
def test_a_stage_solves_the_equation_of_the_ring(damping: float) -> None:
    """I a = pulled + pin, at the angle and speed of the end of the stage; at the edge the pin gives a part of the
    torque of its damper."""
    chance, kinds = np.random.default_rng(3), set()
    row = np.array([0.1, 289.0, damping, 0.016])
    for _ in range(400):
        g, q, v, pulled = 10.0 ** chance.uniform(-6, -3), chance.uniform(-0.12, 0.12), *chance.normal(0, (30.0, 0.1))
        a = pinned(row, q, v, g, INERTIA, pulled)
        speed = v + g * a
        angle, torque = q + g * speed, INERTIA * a - pulled
        if abs(abs(angle) - row[PLAY]) < 1e-12:
            kinds.add("edge")
            assert 0.0 <= -np.sign(angle) * torque <= row[DAMPING] * abs(speed) + 1e-9
            continue
        kinds.add("free" if torque == 0.0 else "pin")
        assert torque == pytest.approx(float(pin_torque(row, angle, speed)), rel=1e-6, abs=1e-9)
    assert kinds == ({"free", "pin", "edge"} if damping > 0.1 else {"free", "pin"} | (kinds & {"edge"}))


# -------------------------------------------------------------------------------------------------------------- case


def test_a_run_has_angle_and_torque_of_its_pin(tmp_path: Path) -> None:
    case = ringed(pin(), "speed.from=100 Hz", "speed.to=100 Hz", "speed.duration=20 ms", "output.step=0.1 ms")
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert run.signals["pin_torque_N_m"].unit == "N m"
    assert run["pin_angle_rad"].max() > PLAYS / RADIUS
    expected = pin_torque(planned_system(case).pins[0], run["pin_angle_rad"], 2.0 * math.pi * run["ring_speed_Hz"])
    np.testing.assert_allclose(run["pin_torque_N_m"], expected, atol=1e-9)
    (touch,) = (event for event in run.events if event["kind"] == "touch")
    assert touch["point"] == "ring"
    assert touch["t_s"] == pytest.approx(run["time_s"][np.argmax(run["pin_angle_rad"] > PLAYS / RADIUS)])
    angle, torque = quantity_figure([run], "pin").axes[:2]
    assert "mrad" in angle.get_ylabel()
    assert "N mm" in torque.get_ylabel()
    other = frbcli.runup(case.with_settings({"bearing.pin": None}), tmp_path / "other.h5")
    assert "pin_angle_rad" not in other.signals
    assert not any(event["kind"] == "touch" for event in other.events)
    with pytest.raises(FrbError, match="no ring with a pin"):
        quantity_figure([other], "pin")
