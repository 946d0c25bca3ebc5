"""Springs and stops: closed forms of free and forced vibrations, rest, rub, and what their law says of itself."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marches import Result, control, march, start
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.case.surroundings import Spring
from frbcli.elements.spring import STICKS, SpringForce
from frbcli.linear.stability import stability
from frbcli.rotor.loads import speed_profile
from frbcli.rotor.port import ANSWER, MOTION, XX
from frbcli.rotor.port_function import evaluate
from frbcli.runs.run import runup
from frbcli.scene.machine.findings import remarks
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan

M, K, CUBIC, GAP, U = 2.0, 1e6, 1e15, 20e-6, 2e-4  # kg, N/m of both bearings, N/m^3, m, kg m
STOP = 5e6  # N/m
TURN = 2.0 * math.pi


def sprung(
    spring: dict[str, Any], gravity: float = 0.0, damping: float = 0.0, unbalance: float = 0.0, **rotor: Any
) -> frbcli.Case:
    """A rigid rotor in two linear bearings, with one spring at each of its journals."""
    given = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{unbalance!r} kg*m", "gravity": f"{gravity} m/s^2"}
    data = {
        "rotor": given | rotor,
        "bearing": {
            "kind": "coefficients", "stiffness": f"{0.5 * K!r} N/m", "damping": f"{0.5 * damping!r} N*s/m",
        },
        "spring": [{"at": "journal", **spring}],
        "speed": {"from": "100 Hz", "to": "100 Hz", "duration": "0.2 s"},
    }  # fmt: skip
    return case_from_dict(data, "sprung")


def cubic(**more: Any) -> dict[str, Any]:
    return {"cubic": f"{0.5 * CUBIC!r} N/m^3", **more}


def stop(**more: Any) -> dict[str, Any]:
    return {"stiffness": f"{0.5 * STOP!r} N/m", "gap": f"{GAP!r} m", **more}


def made(case: frbcli.Case) -> System:
    return make_system(case, make_plan(case))


def run_from(case: frbcli.Case, time: float, q: tuple[float, float], v: tuple[float, float], tolerance: float,
             output: float, omega: float = 0.0) -> tuple[System, Result]:  # fmt: skip
    system, profile = made(case), speed_profile([0.0, time], [omega, omega])
    limits = control(tolerance=tolerance, longest=time / 200.0, output=output)
    return system, march(system, profile, limits, start(system, profile, np.array(q), np.array(v)))


@pytest.mark.parametrize(
    "given",
    [
        cubic(stiffness="3e6 N/m", damping="40 N*s/m"),
        stop(damping="300 N*s/m"),
        stop(cubic="1e16 N/m^3", damping="300 N*s/m", friction=0.2),
        stop(damping="300 N*s/m", friction=0.2, radius="4 um"),
    ],
)
def test_the_derivatives_of_the_force_are_those_of_its_differences(given: dict[str, Any]) -> None:
    law = SpringForce(Spring.model_validate({"at": "journal", **given}))
    random = np.random.default_rng(4)
    for _ in range(20):
        angle, r = random.uniform(0.0, TURN), random.uniform(1.1, 2.0) * GAP
        motion = np.array([r * math.cos(angle), r * math.sin(angle), *random.uniform(-2e-3, 2e-3, 2), 300.0, 0.0])
        answer = evaluate(law, motion)
        for column, size in enumerate((1e-10, 1e-10, 1e-8, 1e-8)):
            step = size * np.eye(MOTION)[column]
            rise = (evaluate(law, motion + step) - evaluate(law, motion - step))[:XX] / (2.0 * size)
            told = answer[XX + 4 * (column // 2) + column % 2 :: 2][:2]
            np.testing.assert_allclose(told, rise, rtol=2e-5, atol=1e-6 * np.abs(answer[XX:]).max())


def test_the_compiled_force_is_the_plain_one() -> None:
    law = SpringForce(Spring.model_validate({"at": "journal", **stop(friction=0.2, damping="300 N*s/m")}))
    motion, plain = np.array([25e-6, -12e-6, 1e-3, 2e-3, -300.0, 0.0]), np.zeros(ANSWER)
    law.force(law.numbers, law.memory, motion, plain)
    np.testing.assert_allclose(evaluate(law, motion), plain, rtol=1e-13)


def test_a_cubic_spring_has_the_frequency_of_its_amplitude() -> None:
    """m x'' + k x + c x^3 = 0 from x = A at rest: a quarter period is the integral of dx / v over the energy."""
    amplitude = 40e-6

    def quarter(angle: float) -> float:  # x = A sin(angle)
        x = amplitude * math.sin(angle)
        return 1.0 / math.sqrt((K + 0.5 * CUBIC * (amplitude**2 + x**2)) / M)

    period = 4.0 * quad(quarter, 0.0, 0.5 * math.pi, epsabs=0.0, epsrel=1e-12)[0]
    assert period < 0.8 * TURN * math.sqrt(M / K)  # far from linear
    system, result = run_from(sprung(cubic()), 10.0 * period, (amplitude, 0.0), (0.0, 0.0), 1e-10, period)
    np.testing.assert_allclose(result.q[:, 0], amplitude, rtol=1e-6)
    energy = 0.5 * M * result.v[:, 0] ** 2 + 0.5 * K * result.q[:, 0] ** 2 + 0.25 * CUBIC * result.q[:, 0] ** 4
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
    assert not result.q[:, 1].any()
    assert len(system.rotor.ports) == 1


def test_a_rotor_leaves_a_stop_with_the_energy_that_it_came_with() -> None:
    """Free flight within the gap: half a period of the spring in the stop, then back."""
    case = sprung(stop())
    speed = 0.3
    _, result = run_from(case, 4e-3, (0.0, 0.0), (speed, 0.0), 1e-10, 1e-5)
    q, v = result.q[:, 0], result.v[:, 0]
    depth = np.maximum(np.abs(q) - GAP, 0.0)
    energy = 0.5 * M * v**2 + 0.5 * K * q**2 + 0.5 * STOP * depth**2
    assert depth.max() > 0.5 * GAP
    np.testing.assert_allclose(energy, 0.5 * M * speed**2, rtol=1e-7)


def test_a_rotor_rests_in_its_stop() -> None:
    """k d + s (d - gap) = m g, and small motions about it have k + s across the gap, and s (d - gap) / d along it."""
    gravity = 100.0
    case = sprung(stop(), gravity)
    rest = (M * gravity + STOP * GAP) / (K + STOP)
    assert rest > GAP
    (point,) = stability(case, [100.0]).points
    expected = np.sqrt(np.array([K + STOP * (rest - GAP) / rest, K + STOP]) / M)
    found = np.sort(point.eigenvalues.imag[point.eigenvalues.imag > 0.0])
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    np.testing.assert_allclose(point.eigenvalues.real, 0.0, atol=1e-6)


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_a_rotor_rubs_all_around_its_stop(friction: float) -> None:
    """(k - m w^2 + i c w) r + s (r - gap) (1 + i mu) = m e w^2 exp(i phase): the synchronous motion of annular rub."""
    omega, damping = TURN * 100.0, 900.0
    case = sprung(stop(friction=friction), damping=damping, unbalance=U)

    def surplus(r: float) -> float:
        spring = (K - M * omega**2 + 1j * damping * omega) * r + STOP * (r - GAP) * (1.0 + 1j * friction)
        return abs(spring) - U * omega**2

    radius = brentq(surplus, GAP, 1e-3, xtol=1e-16)
    _, result = run_from(case, 0.5, (0.0, -radius), (omega * radius, 0.0), 1e-8, 1e-3, omega)
    found = np.hypot(*result.q[-100:].T)
    np.testing.assert_allclose(found, radius, rtol=1e-6)


def test_a_rotor_that_rolls_in_a_stop_whirls_backwards() -> None:
    """Dry whirl: r (K + k - M nu^2) = k gap holds it outside, mu N tanh(u / STICKS) = D nu r turns it against its
    damping, with the sliding u = Omega R - nu r, which is nearly 0."""
    damping, friction, omega, radius = 20.0, 0.3, 100.0, 0.25e-3

    def place(nu: float) -> float:
        return STOP * GAP / (K + STOP - M * nu**2)

    def surplus(nu: float) -> float:
        r = place(nu)
        slides = math.tanh((omega * radius - nu * r) / STICKS)
        return friction * STOP * (r - GAP) * slides - damping * nu * r

    nu = brentq(surplus, 800.0, 1200.0, xtol=1e-12)
    r = place(nu)
    assert omega * radius - nu * r < 0.01 * omega * radius
    case = sprung(stop(friction=friction, radius="0.25 mm"), damping=damping)
    _, result = run_from(case, 0.5, (1.01 * r, 0.0), (0.0, -0.98 * nu * r), 1e-9, 1e-3, omega)
    q, v = result.q[-100:], result.v[-100:]
    np.testing.assert_allclose(np.hypot(*q.T), r, rtol=1e-6)
    np.testing.assert_allclose((q[:, 0] * v[:, 1] - q[:, 1] * v[:, 0]) / r**2, -nu, rtol=1e-6)


def test_a_run_says_when_a_stop_is_touched_and_left(tmp_path: Path) -> None:
    """An orbit of the size of the gap: r = |U w^2 / (k - m w^2 + i c w)|, below the critical speed and beyond it."""
    data = sprung(stop(), damping=300.0, unbalance=2e-5).model_dump(by_alias=True, exclude_unset=True)
    data["speed"] = {"from": "60 Hz", "to": "300 Hz", "duration": "4 s"}
    run = runup(case_from_dict(data, "passing"), tmp_path / "run.h5", force=True)
    touched, left = ([each for each in run.events if each["kind"] == kind] for kind in ("touch", "lift-off"))

    def beyond(speed: float) -> float:
        w = TURN * speed
        return 2e-5 * w**2 / abs(K - M * w**2 + 300j * w) - GAP

    known = brentq(beyond, 60.0, math.sqrt(K / M) / TURN)
    assert touched[0]["point"] == "stop_1"
    assert touched[0]["speed_Hz"] == pytest.approx(known, abs=2.0)
    assert left[-1]["speed_Hz"] > math.sqrt(K / M) / TURN
    force, x = run["stop_force_1_x_N"], run["journal_x_m"]
    assert np.all((force == 0.0) | (force * x < 0.0))


def test_friction_against_the_motion_of_the_centre_loses_the_work_that_it_does() -> None:
    """With a radius of nearly nothing, a shaft at rest slides as its centre moves: the energy never rises."""
    case = sprung(stop(friction=0.3, radius="1 nm"))
    _, result = run_from(case, 4e-3, (0.0, 10e-6), (0.3, 0.1), 1e-9, 1e-5)
    depth = np.maximum(np.hypot(*result.q.T) - GAP, 0.0)
    energy = 0.5 * M * (result.v**2).sum(axis=1) + 0.5 * K * (result.q**2).sum(axis=1) + 0.5 * STOP * depth**2
    assert np.diff(energy).max() < 1e-8 * energy[0]
    assert energy[-1] < 0.99 * energy[0]


@pytest.mark.parametrize("ends", [["disk", "journal"], ["journal", "disk"]])
def test_a_stop_between_disk_and_journals_acts_on_both_as_they_run_up(ends: list[str], tmp_path: Path) -> None:
    """Through the critical speed at 94 Hz against an integration of both bodies, with damper, third power and friction
    against the sliding u = R Omega + v_t."""
    mass, small, shaft, held, damping, unbalance = 2.0, 0.5, 1e6, 2e6, 300.0, 2e-5
    stiff, third, gap, damper, friction, radius = 8e5, 1e15, 15e-6, 80.0, 0.2, 2e-5
    data = {
        "rotor": {"kind": "jeffcott", "mass": f"{mass} kg", "journal_mass": f"{small} kg", "gravity": 0,
                  "shaft_stiffness": f"{shaft} N/m", "unbalance": f"{unbalance} kg*m"},
        "bearing": {"kind": "coefficients", "stiffness": f"{0.5 * held} N/m", "damping": f"{0.5 * damping} N*s/m"},
        "spring": [{"between": ends, "stiffness": f"{stiff} N/m", "cubic": f"{third} N/m^3", "gap": f"{gap} m",
                    "damping": f"{damper} N*s/m", "friction": friction, "radius": f"{radius} m"}],
        "speed": {"from": "60 Hz", "to": "140 Hz", "duration": "0.2 s"}, "accuracy": {"tolerance": 1e-8},
    }  # fmt: skip
    run, rate = runup(case_from_dict(data, "stop"), tmp_path / "run.h5"), TURN * 400.0

    def motion(t: float, state: np.ndarray) -> np.ndarray:
        (disk, journal), (v_disk, v_journal) = state[:2], state[2:]
        omega, turned = TURN * 60.0 + rate * t, np.exp(1j * (TURN * 60.0 * t + 0.5 * rate * t**2))
        apart, bent = disk - journal, shaft * (disk - journal)
        if (depth := abs(apart) - gap) > 0.0:
            n = apart / abs(apart)
            moved = np.conj(n) * (v_disk - v_journal)
            pushed = max(stiff * depth + third * depth**3 + damper * moved.real, 0.0)
            bent += pushed * n * (1.0 + 1j * friction * math.tanh((radius * omega + moved.imag) / STICKS))
        driven = unbalance * (rate + 1j * omega**2) * turned
        left = bent - held * journal - damping * v_journal
        return np.array([v_disk, v_journal, (driven - bent) / mass, left / small])

    known = solve_ivp(motion, (0.0, 0.2), np.zeros(4, complex), "DOP853", rtol=1e-9, atol=1e-13, max_step=1e-4,
                      t_eval=run["time_s"]).y[:2]  # fmt: skip
    found = np.array([run[f"{name}_x_m"] + 1j * run[f"{name}_y_m"] for name in ("disk", "journal")])
    assert np.abs(known[0] - known[1]).max() > 1.5 * gap
    assert np.abs(found - known).max() < 2e-5 * np.abs(known).max()


@pytest.mark.parametrize(("place", "told"), [("housing", 0), ("journal", 1)])
def test_a_stop_that_rubs_between_places_that_turn_together_is_remarked(place: str, told: int) -> None:
    data = {
        "rotor": {"kind": "jeffcott", "mass": "2 kg", "journal_mass": "0.5 kg", "shaft_stiffness": "1e6 N/m",
                  "unbalance": "1 g*mm"},
        "bearing": {"kind": "coefficients", "stiffness": "1e6 N/m"},
        "housing": {"mass": "3 kg", "mounts": [{"stiffness": "2e6 N/m"}]},
        "spring": [{"between": ["disk", place], **stop(friction=0.1)}],
        "speed": {"from": "60 Hz", "to": "140 Hz", "duration": "0.2 s"},
    }  # fmt: skip
    said = remarks(case_from_dict(data, "stop"))
    assert len(said) == told
    assert all("rubs between two places of the shaft, disk and journal" in each for each in said)


def assert_springs_are(data: dict[str, Any], table: str, key: str, stiffer: str) -> None:
    """The machine without its springs has the same frequencies with a stiffer part beside them."""
    without = {name: keys for name, keys in data.items() if name != "spring"} | {table: data[table] | {key: stiffer}}
    both = (stability(case_from_dict(each, "springs"), [100.0]).points[0] for each in (data, without))
    np.testing.assert_allclose(*(np.sort(point.eigenvalues.imag) for point in both), rtol=1e-9)


@pytest.mark.parametrize("ends", [["disk", "journal"], ["journal", "disk"]])
def test_a_spring_between_two_places_acts_on_both(ends: list[str]) -> None:
    data = {
        "rotor": {"kind": "jeffcott", "mass": "2 kg", "journal_mass": "1 kg", "shaft_stiffness": "1e6 N/m",
                  "unbalance": "0 kg*m", "gravity": "0 m/s^2"},
        "bearing": {"kind": "coefficients", "stiffness": "4e5 N/m"},
        "spring": [{"between": ends, "stiffness": "5e5 N/m"}],
        "speed": {"from": "100 Hz", "to": "100 Hz", "duration": "0.2 s"},
    }  # fmt: skip
    assert_springs_are(data, "rotor", "shaft_stiffness", "1.5e6 N/m")


@pytest.mark.parametrize("ends", [["journal", "housing"], ["housing", "journal"]])
def test_springs_of_journals_are_two_from_either_end(ends: list[str]) -> None:
    """In parallel to both bearings, between the journals and the housing that carries these."""
    data = {
        "rotor": {"kind": "rigid", "mass": "2 kg", "gravity": "0 m/s^2"},
        "bearing": {"kind": "coefficients", "stiffness": "4e5 N/m"},
        "housing": {"mass": "3 kg", "mounts": [{"stiffness": "2e6 N/m"}]},
        "spring": [{"between": ends, "stiffness": "1e5 N/m"}],
        "speed": {"from": "100 Hz", "to": "100 Hz", "duration": "0.2 s"},
    }  # fmt: skip
    assert_springs_are(data, "bearing", "stiffness", "5e5 N/m")
