"""Bearings of given coefficients without films: closed forms, ROSS, runs against the response.

With z = x + i y, [[k, q], [-q, k]] is k - i q, and so for damping and mass: a rigid rotor of mass m in two bearings
obeys (m + 2 M) z'' + 2 C z' + 2 K z = -i m g + unbalance, with complex M, C, K.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from given_rotors import (
    C_CROSS,
    JEFFCOTT,
    MASS,
    MASS_CROSS,
    TURN,
    C,
    G,
    K,
    M,
    Q,
    U,
    bearing,
    growing_seal,
    matrix,
    rigid,
    speed,
)
from series_rotors import HEAVY

import frbcli
from frbcli.analysis.events import about_critical_speeds
from frbcli.analysis.measured import events_at
from frbcli.case.reading.load import case_from_dict, load_case_text
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.modes import natural_modes
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.linear.stability_point import eigenvalues
from frbcli.runs.run import rundown, runup
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.plan import make_plan


def jeffcott(element: dict[str, Any], **tables: object) -> frbcli.Case:
    return case_from_dict({"rotor": JEFFCOTT, "bearing": element, "speed": speed(10.0, 200.0)} | tables, "jeffcott")


RIGID_POLYNOMIAL = [M + 2 * (MASS - 1j * MASS_CROSS), 2 * (C - 1j * C_CROSS), 2 * (K - 1j * Q)]
JEFFCOTT_POLYNOMIAL = np.polysub(
    np.polymul(
        [0.1 + 2 * (MASS - 1j * MASS_CROSS), 2 * (C - 1j * C_CROSS) + 0.1, 2 * (K - 1j * Q) + 5e6],
        [6.0, 1.0 + 0.1, 5e6],
    ),
    np.polymul([0.1, 5e6], [0.1, 5e6]),
)


@pytest.mark.parametrize(
    ("make", "polynomial"), [(rigid, RIGID_POLYNOMIAL), (jeffcott, JEFFCOTT_POLYNOMIAL)], ids=["rigid", "jeffcott"]
)
def test_eigenvalues_are_the_roots_of_the_closed_form(make: Any, polynomial: Any) -> None:
    roots = np.roots(polynomial)
    case = make(bearing())
    (point,) = stability(case, [80.0]).points
    expected = np.concatenate([roots, roots.conj()])
    for value in point.eigenvalues:  # each is one of the closed form, and as many as there are
        assert np.abs(expected - value).min() < 1e-9 * abs(value)
    assert len(point.eigenvalues) == len(expected)
    for value in expected:
        assert np.abs(point.eigenvalues - value).min() < 1e-9 * abs(value)
    frequencies = sorted(mode.frequency_Hz for mode in damped_modes(case, 80.0).modes)
    np.testing.assert_allclose(frequencies, np.sort(np.abs(roots.imag)) / TURN, rtol=1e-9)


def test_the_response_of_the_rigid_rotor_is_the_closed_form() -> None:
    """z = i Omega^2 U / (K - Omega^2 M + i Omega C) exp(i alpha), a circle."""
    found = response(rigid(bearing()), [20.0, 90.0, 150.0])
    omega = TURN * found.speeds_Hz
    expected = 1j * omega**2 * U / (RIGID_POLYNOMIAL[2] + 1j * omega * RIGID_POLYNOMIAL[1]
                                    - omega**2 * RIGID_POLYNOMIAL[0])  # fmt: skip
    np.testing.assert_allclose(found.forward[:, 0], expected, rtol=1e-9)
    assert np.abs(found.backward).max() < 1e-12 * np.abs(expected).max()
    assert found.validity == ("linear",) * 3
    assert found.films == ()
    assert found.gap_share.shape == (3, 0)
    pull = omega[:, None] ** 2 * make_rotor(found.case).unbalance
    assert found.bearings == ("seal",)  # both of them, with the unbalance, accelerate the rotor
    inertia = -(omega[:, None] ** 2) * M * found.motion[:, 0]
    np.testing.assert_allclose(2.0 * found.forces[:, 0] + pull, inertia, rtol=1e-9)


def test_the_response_of_the_jeffcott_rotor_is_the_closed_form() -> None:
    """Disk and journals by Cramer's rule: the unbalance pulls at the disk."""
    found = response(jeffcott(bearing()), [20.0, 90.0, 150.0])
    s = 1j * TURN * found.speeds_Hz
    shaft = 5e6 + 0.1 * s
    journal = np.polyval([0.1 + RIGID_POLYNOMIAL[0] - M, RIGID_POLYNOMIAL[1], RIGID_POLYNOMIAL[2]], s) + shaft
    disk = 6.0 * s**2 + 1.0 * s + shaft
    pull = -1j * s**2 * U
    determinant = journal * disk - shaft**2
    named = dict(zip(found.points, found.forward.T, strict=True))
    np.testing.assert_allclose(named["disk"], pull * journal / determinant, rtol=1e-9)
    np.testing.assert_allclose(named["journal"], pull * shaft / determinant, rtol=1e-9)


def test_one_quantity_is_that_of_both_directions() -> None:
    one = rigid(bearing(stiffness="2e6 N/m", damping="0 N*s/m", mass="0 kg"))
    two = rigid(bearing(stiffness=matrix(2e6, 0.0, "N/m"), damping=matrix(0.0, 0.0, "N*s/m"), mass=matrix(0, 0, "kg")))
    assert one.elements == two.elements
    assert load_case_text(one.source_text, name="rigid") == one


# ross-rotordynamics 2.3.0: the shaft and the wheels of turbocharger-heavy, 16 elements for each section with
# shear_method_calc="cowper", eigenvalues of Rotor.A(speed) as (frequency in Hz, growth in 1/s).
ROSS = {
    0.0: [(190.460167, -116.93842), (191.350248, -222.88775), (340.686012, -301.56912), (362.028569, -504.70131),
          (679.384145, -835.26350), (686.326601, -648.88170), (1161.110024, -503.43651)],
    1200.0: [(115.36889, -110.59528), (258.899364, -227.86659), (263.129491, -68.0546), (366.6936, -402.75942),
             (408.184637, -893.33718), (749.65839, -639.05848), (1494.96755, -1214.42716)],
}  # fmt: skip


@pytest.mark.parametrize("speed_Hz", list(ROSS))
def test_a_shaft_on_coefficients_has_the_eigenvalues_of_ross(speed_Hz: float) -> None:
    rotor, none = make_rotor(case_from_dict(HEAVY, "heavy")), np.zeros((0, 2, 2))
    values = eigenvalues(rotor, TURN * speed_Hz, none, none)
    found = values[values.imag > 1.0]
    found = found[np.argsort(found.imag)][: len(ROSS[speed_Hz])]
    frequency, growth = np.array(ROSS[speed_Hz]).T
    np.testing.assert_allclose(found.imag / TURN, frequency, rtol=1e-5)
    np.testing.assert_allclose(found.real, growth, rtol=2e-5)


def test_natural_modes_have_elements_as_springs() -> None:
    """The mean of both direct stiffnesses, here the same in both directions: those of undamped eigenvalues."""
    bearings = [
        {"kind": "coefficients", "name": name, "position": position, "stiffness": stiffness}
        for name, position, stiffness in (("front", "80 mm", "1.2e7 N/m"), ("rear", "185 mm", "2e7 N/m"))
    ]
    case = case_from_dict(HEAVY | {"bearing": bearings}, "heavy")
    (point,) = natural_modes(case, [], [900.0]).points
    none = np.zeros((0, 2, 2))
    values = eigenvalues(make_rotor(case), TURN * 900.0, none, none)
    expected = np.sort(values[values.imag > 1.0].imag)[:6] / TURN
    np.testing.assert_allclose([mode.frequency_Hz for mode in point.modes][:6], expected, rtol=1e-7)
    assert not natural_modes(case, None, [0.0]).stiffness_N_m


def synchronous(run: Any, name: str, omega: float, after: float) -> complex:
    """Z of the forward motion z = Z exp(i alpha) + rest at a constant speed, by least squares of what is later."""
    time = np.array(run["time_s"])
    late = time >= after
    z = np.array(run[f"{name}_x_m"])[late] + 1j * np.array(run[f"{name}_y_m"])[late]
    turn = np.exp(1j * omega * time[late])
    parts = np.column_stack([turn, turn.conj(), np.ones_like(turn)])
    return complex(np.linalg.lstsq(parts, z, rcond=None)[0][0])


def test_a_run_at_constant_speed_is_the_response(tmp_path: Path) -> None:
    case = jeffcott(
        bearing(stiffness=matrix(K, 1e5, "N/m"), damping=matrix(2000.0, C_CROSS, "N*s/m")),
        speed=speed(90.0, 90.0, 1.5),
        accuracy={"tolerance": 1e-10},
        output={"step": "1e-4 s"},
    )
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    found = response(case, [90.0])
    slowest = -found.resting[0].eigenvalues.real.max()
    assert math.exp(-slowest * 1.0) < 1e-7  # what is left of the beginning after 1 s
    for name, expected in zip(found.points, found.forward[0], strict=True):
        assert abs(synchronous(run, name, TURN * 90.0, 1.0) - expected) < 1e-6 * abs(expected)
    assert "eccentricity" not in run.signals
    assert run.references["length_m"] == make_plan(case).length


def test_a_run_of_a_gyroscopic_shaft_at_constant_speed_is_the_response(tmp_path: Path) -> None:
    """On coefficients alone, those of a shaft with wheels: points at the elements are recorded like journals."""
    tables = {"rotor": {"kind": "turbocharger", "modes": 5, "modal_damping": 0.02}, "speed": speed(300.0, 300.0, 0.3)}
    case = case_from_dict(HEAVY | tables | {"accuracy": {"tolerance": 1e-10}}, "heavy")
    run = runup(case, tmp_path / "run.h5")
    found = response(case, [300.0])
    slowest = -found.resting[0].eigenvalues.real.max()
    assert math.exp(-slowest * 0.25) < 1e-7
    assert found.points[:2] == ("journal_front", "journal_rear")
    for name, motion in zip(found.points, found.motion[0], strict=True):
        forward = 0.5 * (motion[0] + 1j * motion[1])
        assert abs(synchronous(run, name, TURN * 300.0, 0.25) - forward) < 2e-6 * abs(forward)


OVER_SPEED = {"speed": ["0 Hz", "60 Hz", "160 Hz"]} | {
    name: [f"{value} {unit}" for value in values]
    for name, values, unit in (
        ("kxx", (1e6, 1.1e6, 1.3e6), "N/m"), ("kxy", (0.0, 1e5, 1.5e5), "N/m"), ("kyx", (0.0, -1e5, -1.5e5), "N/m"),
        ("kyy", (1e6, 1.1e6, 1.3e6), "N/m"), ("cxx", (1500, 1200, 1000), "N*s/m"), ("cxy", (0, 0, 0), "N*s/m"),
        ("cyx", (0, 0, 0), "N*s/m"), ("cyy", (1500, 1200, 1000), "N*s/m"), ("mxx", (0.0, 0.2, 0.1), "kg"),
        ("mxy", (0, 0, 0), "kg"), ("myx", (0, 0, 0), "kg"), ("myy", (0.0, 0.2, 0.1), "kg"),
    )
}  # fmt: skip


def run_up_error(duration: float, folder: Path) -> np.ndarray:
    """How far Z of a run-up with coefficients over the speed is from the response at four speeds, relative."""
    element = {"kind": "coefficients", "name": "seal", "over_speed": OVER_SPEED}
    case = rigid(element, speed=speed(20.0, 150.0, duration), accuracy={"target": 1e-5})
    run, ramp = runup(case, folder / f"{duration}.h5"), 130.0 / duration
    found, time = response(case, [50.0, 80.0, 110.0, 140.0]), np.array(run["time_s"])
    turns, angle = 20.0 + ramp * time, TURN * (20.0 + 0.5 * ramp * time) * time
    z, errors = np.array(run["journal_x_m"]) + 1j * np.array(run["journal_y_m"]), []
    for speed_Hz, expected in zip(found.speeds_Hz, found.forward[:, 0], strict=True):
        near = np.abs(turns - speed_Hz) < 4.0
        off, turn = 0.25 * (turns[near] - speed_Hz), np.exp(1j * angle[near])
        parts = np.column_stack([*(turn * off**k for k in range(5)), *(off**k for k in range(4))])
        errors.append(abs(np.linalg.lstsq(parts, z[near], rcond=None)[0][0] / expected - 1.0))
    return np.array(errors)


def test_a_slow_run_up_follows_the_response(tmp_path: Path) -> None:
    """What is left is of the ramp: in proportion to it, as a motion lags that needs a time to follow."""
    faster, slower = run_up_error(4.0, tmp_path), run_up_error(16.0, tmp_path)
    assert faster.max() < 0.01
    assert slower.max() < 0.0025
    np.testing.assert_allclose(faster / slower, 4.0, rtol=0.03)


def test_cross_coupling_makes_the_rotor_whirl_where_it_exceeds_c_omega() -> None:
    """At s = i w the imaginary part of m s^2 + 2 C s + 2 (K - i q) is C w - q: with q = slope Omega and w^2 = 2 K / m
    the threshold is Omega = C w / slope, and the whirl w."""
    natural, slope = math.sqrt(2.0 * K / M), 1.1 * C
    case = rigid(growing_seal(slope), speed=speed(20.0, 300.0))
    threshold = stability(case).threshold
    assert threshold is not None
    assert threshold.speed_Hz == pytest.approx(C * natural / slope / TURN, rel=1e-9)
    assert threshold.frequency_Hz == pytest.approx(natural / TURN, rel=1e-9)


def test_the_shipped_seal_whirls_where_it_says() -> None:
    threshold = stability(frbcli.load_case("seal")).threshold
    assert threshold is not None
    assert threshold.speed_Hz == pytest.approx(math.sqrt(2.0 * K / M) / 0.8 / TURN, rel=1e-9)


def test_the_run_of_the_shipped_seal_shows_its_critical_speed_and_its_whirl(tmp_path: Path) -> None:
    """Behind the threshold the whirl grows with its natural frequency until it is seen."""
    run = runup(frbcli.load_case("seal"), tmp_path / "run.h5")
    critical, onset = frbcli.find_events(run)
    natural = math.sqrt(2.0 * K / M) / TURN
    assert (critical.kind, critical.point, onset.kind, onset.film) == ("critical-speed", "journal", "onset", None)
    assert critical.speed_Hz == pytest.approx(natural, rel=0.05)
    assert natural / 0.8 < onset.speed_Hz < 1.1 * natural / 0.8
    assert onset.frequency_Hz == pytest.approx(natural, rel=0.01)


@pytest.mark.parametrize("ratio", [1e-3, 3e-4, 1e-4])
def test_a_free_vibration_that_hardly_dies_is_no_whirl(ratio: float, tmp_path: Path) -> None:
    """A fast ramp leaves it behind a resonance, with damping so small that it lasts up to the end of the run."""
    damping = f"{ratio * math.sqrt(2.0 * K * M)!r} N*s/m"  # of each of two bearings
    mount = {"kind": "coefficients", "name": "mount", "stiffness": f"{K!r} N/m", "damping": damping}
    run = runup(rigid(mount, speed=speed(20.0, 250.0)), tmp_path / "run.h5")
    late = run["speed_Hz"] > 200.0
    assert np.ptp(run["journal_x_m"][late]) > 0.1 * run.references["length_m"]  # it is there, and large
    assert not {"onset", "self-excited"} & {event["kind"] for event in run.events}


@pytest.mark.parametrize("share", [0.8, 1.25])
def test_a_run_grows_above_the_threshold_and_decays_below(share: float, tmp_path: Path) -> None:
    """At a constant speed, without unbalance: the forward whirl out of the start grows by its eigenvalue."""
    natural, slope = math.sqrt(2.0 * K / M), 1.1 * C
    at = share * C * natural / slope / TURN
    case = rigid(growing_seal(slope), unbalance=0.0, speed=speed(at, at, 0.25), accuracy={"tolerance": 1e-9})
    run = runup(case, tmp_path / "run.h5")
    q = slope * TURN * at
    roots = np.roots([M, 2.0 * C, 2.0 * (K - 1j * q)])
    forward = roots[np.argmax(roots.imag)]
    assert (forward.real > 0.0) == (share > 1.0)
    still = -1j * M * G / (2.0 * (K - 1j * q))
    time = np.array(run["time_s"])
    z = np.array(run["journal_x_m"]) + 1j * np.array(run["journal_y_m"]) - still
    late = time > 0.2  # the backward whirl has decayed by exp(-20) then
    rate = np.polyfit(time[late], np.log(np.abs(z[late])), 1)[0]
    assert rate == pytest.approx(forward.real, rel=1e-5)


def test_a_motion_without_bound_ends_the_run(tmp_path: Path) -> None:
    case = rigid(bearing(stiffness=matrix(K, 1e6, "N/m"), damping=matrix(C, 0.0, "N*s/m"), mass="0 kg"))
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "not-converged"
    last = np.hypot(run["journal_x_m"][-1], run["journal_y_m"][-1])
    assert 1e5 < last / make_plan(case).length < 1e9


def test_bearings_without_stiffness_do_not_hold_a_rotor() -> None:
    case = rigid({"kind": "coefficients", "name": "damper", "damping": "300 N*s/m"})
    plan = make_plan(case)
    assert plan.length == pytest.approx(U / M)  # no static deflection
    (point,) = stability(case, [100.0]).points
    assert point.status == "not-converged"
    assert "do not hold the rotor" in point.problem


# ------------------------------------------------------------------- critical speeds of runs
TWO_MODES = {"kind": "jeffcott", "mass": "6 kg", "journal_mass": "6 kg", "shaft_stiffness": "5e5 N/m",
             "unbalance": "3e-5 kg*m", "external_damping": "30 N*s/m", "shaft_damping": "0 N*s/m"}  # fmt: skip
SEAT = {"kind": "coefficients", "name": "seat", "stiffness": "2.07e5 N/m", "damping": "40 N*s/m"}


def closed_form() -> list[float]:
    """Natural frequencies in Hz of disk and journals, undamped: det(K - w^2 M) = 0 of two masses in series."""
    a, b, c = 6.0 * 6.0, -(6.0 * (5e5 + 2 * 2.07e5) + 6.0 * 5e5), 5e5 * 2 * 2.07e5
    return sorted(math.sqrt(root) / TURN for root in np.roots([a, b, c]).real)


def passed(tmp_path: Path, low: float, high: float, run: Any = runup, **tables: object) -> tuple[list[float], Any]:
    """Speeds in Hz of the critical speeds of a run, which has no other events, and the run."""
    case = case_from_dict({"rotor": TWO_MODES, "bearing": SEAT, "speed": speed(low, high, 12.0)} | tables, "two")
    found = run(case, tmp_path / "run.h5")
    assert {event["kind"] for event in found.events} <= {"critical-speed"}
    return [event["speed_Hz"] for event in found.events], found


@pytest.mark.parametrize(("low", "high"), [(8.0, 105.0), (105.0, 8.0)], ids=["up", "down"])
def test_a_run_has_both_critical_speeds(low: float, high: float, tmp_path: Path) -> None:
    """A ramp of 8 Hz/s passes a mode a little late, by 1.5 sqrt(8) Hz at most."""
    late = 1.5 * math.sqrt(8.0)
    found, _ = passed(tmp_path, low, high)
    assert closed_form() == pytest.approx([26.5, 72.6], abs=0.1)
    assert sorted(found) == pytest.approx(closed_form(), abs=late)
    assert found == sorted(found, reverse=low > high)


def test_a_rundown_has_its_critical_speeds_both_ways(tmp_path: Path) -> None:
    found, run = passed(tmp_path, 8.0, 105.0, rundown)
    first, second = closed_form()
    assert found == pytest.approx([first, second, second, first], abs=1.5 * math.sqrt(8.0))
    assert found[0] > found[3]  # late on either way
    seen = events_at(run, "disk", 1e-4)  # as of a measurement, which knows no modes
    assert [event["speed_Hz"] for event in seen if event["kind"] == "critical-speed"] == pytest.approx(found, abs=0.5)


def test_a_critical_speed_that_is_not_found_has_its_reason(tmp_path: Path) -> None:
    """Without unbalance nothing excites the modes; a run that ends in the second one has no peak of it."""
    none = {"rotor": TWO_MODES | {"unbalance": "0 kg*m", "gravity": 0.0}}
    found, run = passed(tmp_path, 8.0, 105.0, **none)
    assert found == []
    (told,) = about_critical_speeds(run, run.events)
    assert "want of unbalance" in told
    assert "26.46, 72.59 Hz on the way up" in told
    (tmp_path / "end").mkdir()
    found, run = passed(tmp_path / "end", 8.0, closed_form()[1] + 1.0)
    assert found == pytest.approx(closed_form()[:1], abs=5.0)
    (told,) = about_critical_speeds(run, run.events)
    assert "turns or ends too near" in told


LIGHT = TWO_MODES | {"external_damping": "1 N*s/m"}


@pytest.mark.parametrize(
    ("rotor", "stiffness", "damping"),
    [({"kind": "rigid", "mass": "6 kg", "unbalance": "3e-6 kg*m"}, 1e6, 300.0),
     ({"kind": "rigid", "mass": "6 kg", "unbalance": "3e-6 kg*m"}, 4e5, 15.0), (TWO_MODES, 2.07e5, 40.0),
     (LIGHT, 2.07e5, 2.0)],
    ids=["rigid", "light rigid", "two modes", "light"],
)  # fmt: skip
def test_the_error_of_a_run_without_films_is_the_true_one(
    rotor: dict[str, Any], stiffness: float, damping: float, tmp_path: Path
) -> None:
    """Beside the same run in sixteenths of its steps, whose own error is 4^-4 of it or less."""
    seat = {"kind": "coefficients", "stiffness": f"{stiffness!r} N/m", "damping": f"{damping!r} N*s/m"}
    case = case_from_dict({"rotor": rotor, "bearing": seat, "speed": speed(10.0, 105.0, 2.0)}, "two")
    plan = make_plan(case)
    finer = {"accuracy.tolerance": 16.0**-4 * plan.tolerance,
             "accuracy.steps_per_revolution": round(16.0 * plan.steps_per_revolution)}  # fmt: skip
    run, fine = (
        runup(each, tmp_path / f"{number}.h5") for number, each in enumerate((case, case.with_settings(finer)))
    )
    points = {name.removesuffix("_x_m") for name in run.signals if name.endswith("_x_m")}
    off = [np.hypot(*(run[f"{point}_{axis}_m"] - fine[f"{point}_{axis}_m"] for axis in "xy")) for point in points]
    true = float(np.max(off)) / run.references["length_m"]
    for key in ("time_integration", "displacement"):
        assert true <= run.error[key] <= 1.5 * true
