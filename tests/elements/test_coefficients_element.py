"""Bearings of given coefficients: closed forms, ROSS, runs against the response, files and their faults.

With z = x + i y, [[k, q], [-q, k]] is k - i q, and so for damping and mass: a rigid rotor of mass m in two bearings
obeys (m + 2 M) z'' + 2 C z' + 2 K z = -i m g + unbalance, with complex M, C, K.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from series_rotors import HEAVY

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case_text
from frbcli.case.rules.machine_keys import machine_fault
from frbcli.equilibrium.coefficients import coefficients_of
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import InputError
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.modes import natural_modes
from frbcli.linear.response import response
from frbcli.linear.stability import stability, stability_points
from frbcli.linear.stability_point import eigenvalues
from frbcli.rotor.over_speed import LinearPart
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.sweep.sweep import sweep

M, U, G = 6.0, 3e-6, 9.81  # kg, kg m, m/s^2
K, Q = 1e6, 2e5  # N/m, direct and cross-coupled
C, C_CROSS = 300.0, 40.0  # N s/m
MASS, MASS_CROSS = 0.2, 0.05  # kg
TURN = 2.0 * math.pi


def matrix(direct: float, cross: float, unit: str) -> list[list[str]]:
    """[[d, c], [-c, d]] as a case file has it: d - i c."""
    return [[f"{direct!r} {unit}", f"{cross!r} {unit}"], [f"{-cross!r} {unit}", f"{direct!r} {unit}"]]


def bearing(**keys: object) -> dict[str, Any]:
    """A bearing of the coefficients above."""
    return {
        "kind": "coefficients",
        "name": "seal",
        "stiffness": matrix(K, Q, "N/m"),
        "damping": matrix(C, C_CROSS, "N*s/m"),
        "mass": matrix(MASS, MASS_CROSS, "kg"),
    } | keys


def speed(low: float, high: float, duration: float = 1.0) -> dict[str, str]:
    return {"from": f"{low!r} Hz", "to": f"{high!r} Hz", "duration": f"{duration!r} s"}


def rigid(element: dict[str, Any], *, unbalance: float = U, **tables: object) -> frbcli.Case:
    rotor = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{unbalance!r} kg*m"}
    return case_from_dict({"rotor": rotor, "bearing": element, "speed": speed(10.0, 200.0)} | tables, "rigid")


JEFFCOTT = {
    "kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.1 kg", "shaft_stiffness": "5e6 N/m",
    "unbalance": "3e-6 kg*m", "external_damping": "1 N*s/m", "shaft_damping": "0.1 N*s/m",
}  # fmt: skip


def jeffcott(element: dict[str, Any], **tables: object) -> frbcli.Case:
    return case_from_dict({"rotor": JEFFCOTT, "bearing": element, "speed": speed(10.0, 200.0)} | tables, "jeffcott")


def both_planes(roots: np.ndarray) -> np.ndarray:
    """The eigenvalues of x and y out of those of z: with their conjugates, sorted."""
    return np.sort_complex(np.round(np.concatenate([roots, roots.conj()]), 6))


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


def growing_seal(slope: float, top: float = 300.0) -> dict[str, Any]:
    """A bearing whose cross-coupling is `slope` in N/m per rad/s times the speed."""
    q = [0.0, slope * TURN * top]
    columns = {"kxx": [K, K], "kxy": q, "kyx": [-each for each in q], "kyy": [K, K]}
    columns |= {"cxx": [C, C], "cxy": [0.0, 0.0], "cyx": [0.0, 0.0], "cyy": [C, C]}
    with_units = {name: [f"{value!r} {'N/m' if name[0] == 'k' else 'N*s/m'}" for value in values]
                  for name, values in columns.items()}  # fmt: skip
    return {"kind": "coefficients", "name": "seal", "over_speed": {"speed": ["0 Hz", f"{top!r} Hz"], **with_units}}


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


SHORT_FILM = {
    "kind": "single-film", "width": "20 mm", "diameter": "25 mm", "clearance": "35 um", "ends": "oil-bath",
    "supply": {"kind": "circumferential-groove", "pressure": "1 bar"},
}  # fmt: skip
OIL = {"viscosity": "12 mPa*s", "density": "830 kg/m^3", "ambient_pressure": "1 bar", "cavitation_pressure": "1 bar"}


def in_film(*elements: dict[str, Any], **tables: object) -> frbcli.Case:
    bearings = [SHORT_FILM, *elements] if elements else SHORT_FILM
    data = {"rotor": JEFFCOTT, "bearing": bearings, "oil": OIL, "film": {"theory": "short"},
            "speed": speed(0.0, 300.0, 0.4)}  # fmt: skip
    return case_from_dict(data | tables, "film")


def test_a_seal_of_zero_coefficients_changes_nothing(tmp_path: Path) -> None:
    nothing = {"kind": "coefficients", "name": "seal", "stiffness": "0 N/m"}
    without, beside = (runup(case, tmp_path / f"{number}.h5") for number, case in
                       enumerate((in_film(), in_film(nothing))))  # fmt: skip
    assert without.status == beside.status == "finished"
    assert list(without.signals) == list(beside.signals)
    for name in without.signals:
        np.testing.assert_array_equal(np.array(without[name]), np.array(beside[name]))
    assert stability(in_film()).threshold == stability(in_film(nothing)).threshold


def test_a_table_of_equal_rows_is_the_constant_coefficients(tmp_path: Path) -> None:
    """Beside a tabulated film, in a run whose inverse follows the speed."""
    constant = {"kind": "coefficients", "name": "seal", "stiffness": matrix(2e5, 5e4, "N/m"), "damping": "50 N*s/m"}
    columns = {"kxx": 2e5, "kxy": 5e4, "kyx": -5e4, "kyy": 2e5, "cxx": 50.0, "cxy": 0.0, "cyx": 0.0, "cyy": 50.0}
    table = {name: [f"{value} {'N/m' if name[0] == 'k' else 'N*s/m'}"] * 3 for name, value in columns.items()}
    rows = {"kind": "coefficients", "name": "seal", "over_speed": {"speed": ["0 Hz", "50 Hz", "90 Hz"], **table}}
    runs = [
        runup(in_film(element, film={}, speed=speed(20.0, 120.0, 0.2), output={"signals": ["force"]}),
              tmp_path / f"{number}.h5")
        for number, element in enumerate((constant, rows))
    ]  # fmt: skip
    assert runs[0].cost["steps"] == runs[1].cost["steps"]
    for name in runs[0].signals:
        first, second = (np.array(run[name]) for run in runs)
        np.testing.assert_allclose(first, second, atol=1e-9 * np.abs(first).max(), rtol=0.0)
    with pytest.raises(InputError) as caught:
        make_plan(in_film(rows, film={"theory": "short", "coupling": "co-simulation"}))
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("film.coupling", "co-simulation")


def test_a_seal_shifts_the_threshold_as_its_stiffness_in_the_matrices() -> None:
    """The same stiffness added by hand: twice, for a symmetric rotor has two bearings."""
    seal = {"kind": "coefficients", "name": "seal", "stiffness": matrix(2e5, 5e4, "N/m"), "damping": "50 N*s/m"}
    case, alone = in_film(seal), in_film()
    threshold, before = stability(case).threshold, stability(alone).threshold
    assert threshold is not None
    assert before is not None
    assert abs(threshold.speed_Hz / before.speed_Hz - 1.0) > 0.02
    place = dict(make_rotor(alone).points)["journal"]
    part = LinearPart(
        np.zeros(1), np.array([[[2e5, 5e4], [-5e4, 2e5]]]), 50.0 * np.eye(2)[None], np.zeros((1, 2, 2))
    )  # fmt: skip
    by_hand = make_rotor(alone)
    stiffness = by_hand.stiffness + 2.0 * place.T @ part.stiffness[0] @ place
    damping = by_hand.damping + 2.0 * place.T @ part.damping[0] @ place
    rotor = replace(by_hand, stiffness=stiffness, damping=damping)
    system = make_system(alone, make_plan(alone), rotor)
    for share, grows in ((1.0 - 1e-6, False), (1.0 + 1e-6, True)):
        omega = share * TURN * threshold.speed_Hz
        films = resting_position(system, omega).films
        found = eigenvalues(
            rotor, omega, *(-np.array([getattr(film, name) for film in films]) for name in
                            ("by_displacement", "by_velocity"))
        )  # fmt: skip
        assert (found.real.max() > 0.0) == grows


def test_a_turbocharger_in_films_with_a_seal_of_nothing_has_its_eigenvalues() -> None:
    text = frbcli.load_case("turbocharger-car").source_text
    start, end = text.index("[[bearing]]"), text.index("[oil]")
    film = """[[bearing]]
kind = "single-film"
name = "{}"
position = "{}"
width = "5 mm"
diameter = "7 mm"
clearance = "15 um"
ends = "oil-bath"
"""
    both = film.format("front", "42 mm") + film.format("rear", "74 mm")
    seal = '[[bearing]]\nkind = "coefficients"\nname = "seal"\nposition = "34 mm"\nstiffness = "{}"\n'
    settings = ["film.theory=short", "film.cavitation=half-sommerfeld", "speed.to=2000 Hz"]
    cases = [
        load_case_text(text[:start] + both + more + text[end:], settings, name="car")
        for more in ("", seal.format("0 N/m"), seal.format("1e6 N/m"))
    ]
    plain, nothing, held = (stability_points(case, [1500.0])[1][0] for case in cases)
    np.testing.assert_allclose(nothing.eigenvalues, plain.eigenvalues, rtol=1e-12)  # 34 mm is the end of a section
    assert abs(held.growth - plain.growth) > 1e-3 * abs(plain.growth)
    assert [name for name, _ in make_rotor(cases[1]).points if name.startswith("journal")] == [
        "journal_front", "journal_rear", "journal_seal"
    ]  # fmt: skip
    told = [(d.choice, d.value) for d in make_plan(cases[1]).decisions]
    assert ("bearings", "3 of 3") in told
    assert ("bearings", "seal: given coefficients") in told


CSV = """speed_Hz,kxx,kxy,kyx,kyy,cxx,cxy,cyx,cyy
50,1e6,1e5,-1e5,1e6,300,0,0,300
100,1.5e6,2e5,-2e5,1.5e6,250,0,0,250
"""


def with_file(folder: Path, name: str, **keys: object) -> frbcli.Case:
    rotor = {"kind": "rigid", "mass": "6 kg"}
    element = {"kind": "coefficients", "name": "seal", "file": name} | keys
    return case_from_dict({"rotor": rotor, "bearing": element, "speed": speed(10.0, 200.0)}, "rigid", folder)


def test_a_csv_is_linear_between_its_speeds_and_constant_beyond(tmp_path: Path) -> None:
    (tmp_path / "seal.csv").write_text(CSV)
    case = with_file(tmp_path, "seal.csv")
    rotor = make_rotor(case)
    for speed_Hz, k, q, c in ((10.0, 1e6, 1e5, 300.0), (75.0, 1.25e6, 1.5e5, 275.0), (500.0, 1.5e6, 2e5, 250.0)):
        here = rotor.at(TURN * speed_Hz)
        np.testing.assert_allclose(here.stiffness, 2.0 * np.array([[k, q], [-q, k]]), rtol=1e-12)
        np.testing.assert_allclose(here.damping, 2.0 * c * np.eye(2), rtol=1e-12)
    told = {d.value: d.reason for d in make_plan(case).decisions if d.choice == "bearings"}
    assert told["seal: given coefficients, over speed from seal.csv"].startswith("2 speeds, 50 to 100 Hz")
    (tmp_path / "seal.csv").unlink()  # the case has all of its numbers
    assert load_case_text(case.source_text, name="rigid") == case


def test_the_file_of_a_bearing_sheet_and_a_csv_give_the_same(tmp_path: Path) -> None:
    from frbcli.linear.bearing_sheet import bearing_sheet
    from frbcli.results.export import write_ross

    sheet = bearing_sheet(in_film(), [40.0, 80.0, 120.0])
    frame = sheet.to_pandas()
    write_ross(frame, tmp_path / "bearing.toml")
    kinds = (("k", "stiffness", "N_m"), ("c", "damping", "N_s_m"))
    names = {f"{letter}{axes}": f"{kind}_{axes}_{unit}" for letter, kind, unit in kinds
             for axes in ("xx", "xy", "yx", "yy")}  # fmt: skip
    lines = [",".join(["speed_Hz", *names])]
    lines += [",".join(repr(float(row[c])) for c in ("speed_Hz", *names.values())) for _, row in frame.iterrows()]
    (tmp_path / "bearing.csv").write_text("\n".join(lines) + "\n")
    of_ross, of_table = (make_rotor(with_file(tmp_path, name)) for name in ("bearing.toml", "bearing.csv"))
    film = sheet.points[1]
    assert film.stiffness is not None
    np.testing.assert_allclose(of_ross.at(TURN * 80.0).stiffness, 2.0 * film.stiffness, rtol=1e-12)
    for speed_Hz in (0.0, 55.0, 80.0, 200.0):
        mine, other = of_ross.at(TURN * speed_Hz), of_table.at(TURN * speed_Hz)
        np.testing.assert_allclose(mine.stiffness, other.stiffness, rtol=1e-12)
        np.testing.assert_allclose(mine.damping, other.damping, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CSV.replace(",cyy", "").replace(",300\n", "\n").replace(",250\n", "\n"), "lacks cyy"),
        (CSV.replace("100,", "50,"), "do not ascend"),
        (CSV.replace("1.5e6,2e5", "nan,2e5"), "no finite number"),
        (CSV.replace("1.5e6,2e5", "1.5 MN/m,2e5"), "no number"),
        (CSV.replace("cxx", "damping"), "not known here"),
        (CSV.replace("100,1.5e6,", "100,"), "8 values in row 2"),
        (CSV.splitlines()[0], "0 speeds"),
        ("", "is empty"),
        (CSV.replace("cyy", "cyy,mxx,mxy,myx,myy").replace("0,300\n", "0,300,1,0,0,-1\n")
         .replace(",250\n", ",250,1,0,0,1\n"), "mass matrix at 50 Hz"),
        (CSV.replace("cyy", "cyy,mxx").replace(",300\n", ",300,1\n").replace(",250\n", ",250,1\n"), "lacks mxy"),
    ],
)  # fmt: skip
def test_a_table_that_cannot_be_used_is_one_fault(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "seal.csv").write_text(text)
    with pytest.raises(InputError) as caught:
        with_file(tmp_path, "seal.csv")
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("bearing.file", '"seal.csv"')
    assert words in fault.problem
    assert fault.remedy


@pytest.mark.parametrize(
    ("element", "key", "words"),
    [
        ({"file": "seal.csv"}, "bearing.file", "names no file"),
        ({"file": "seal.csv", "stiffness": "1e6 N/m"}, "bearing.file", "beside stiffness"),
        ({}, "bearing.stiffness", "is missing"),
        ({"stiffness": [["1e6 N/m", "0 N/m"]]}, "bearing.stiffness.1", "is missing"),
        ({"stiffness": [["1e6 N/m", "0 N/m"], ["0 N/m"]]}, "bearing.stiffness.1.1", "is missing"),
        ({"stiffness": [["1e6 N/m", "0 N/m"], ["0 N/m", "1e6 kg"]]}, "bearing.stiffness.1.1", ""),
        ({"damping": "300 N/m"}, "bearing.damping", ""),
        ({"mass": [["1 kg", "0 kg"], ["0 kg", "-1 kg"]]}, "bearing.mass", "is negative"),
        ({"mass": [["1 kg", "3 kg"], ["0 kg", "1 kg"]]}, "bearing.mass", "is negative"),
        ({"stiffness": "1e6 N/m", "width": "20 mm"}, "bearing.width", "not known"),
    ],
)
def test_keys_that_cannot_be_used_are_told(element: dict[str, Any], key: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        rigid({"kind": "coefficients", "name": "seal"} | element)
    fault = next(fault for fault in caught.value.faults if fault.key == key)
    assert words in fault.problem
    assert fault.remedy


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        ({"film": {"theory": "short"}}, "film"),
        ({"contact": {"policy": "elastic", "stiffness": "1e8 N/m"}}, "contact"),
        ({"output": {"signals": ["force"]}}, "output.signals"),
        ({"start": {"displacement": [0.1, 0.0]}}, "start.displacement"),
        ({"accuracy": {"mesh": [4, 20]}}, "accuracy.mesh"),
    ],
)
def test_what_is_of_films_alone_is_refused_without_films(tables: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError) as caught:
        rigid(bearing(), **tables)
    (fault,) = caught.value.faults
    assert fault.key == key
    assert "no bearing has a film" in fault.problem


def test_studies_of_films_are_refused_without_films() -> None:
    from frbcli.linear.bearing_sheet import bearing_sheet

    case = rigid(bearing())
    for asked in (frbcli.limit_cycles, bearing_sheet):
        with pytest.raises(InputError) as caught:
            asked(case)
        (fault,) = caught.value.faults
        assert (fault.key, fault.value) == ("bearing.kind", "coefficients")
        assert "no film" in fault.problem
    with pytest.raises(InputError, match="oil"):
        _ = case.oil


@pytest.mark.nightly  # 10 s; Hopf point and threshold: test_support.py
def test_limit_cycles_of_a_film_beside_an_element() -> None:
    """A seal that takes some of the damping away lowers the Hopf point to the threshold of stability."""
    seal = {"kind": "coefficients", "name": "seal", "stiffness": matrix(1e5, 5e4, "N/m")}
    case = in_film(seal, speed=speed(20.0, 320.0))
    threshold = stability(case).threshold
    assert threshold is not None
    found = frbcli.limit_cycles(in_film(seal, speed=speed(0.95 * threshold.speed_Hz, 1.02 * threshold.speed_Hz)))
    (hopf,) = [point for point in found.special if point.kind == "hopf"][:1]
    assert hopf.speed_Hz == pytest.approx(threshold.speed_Hz, rel=1e-6)
    assert any(len(branch.points) > 3 for branch in found.branches)
    growing = in_film(growing_seal(300.0), speed=speed(195.0, 200.0))
    threshold, found = stability(growing).threshold, frbcli.limit_cycles(growing)
    assert threshold is not None
    assert [point.speed_Hz for point in found.of("hopf")] == pytest.approx([threshold.speed_Hz], rel=1e-6)


def test_coefficients_can_be_swept(tmp_path: Path) -> None:
    case = in_film({"kind": "coefficients", "name": "seal", "stiffness": "0 N/m"}, speed=speed(20.0, 320.0))
    found = sweep(case, {"bearing.1.stiffness": ["0 N/m", "2e5 N/m"]}, tmp_path, "stability")
    frame = found.to_pandas()
    assert list(frame["status"]) == ["finished", "finished"]
    assert frame["threshold_speed_Hz"].nunique() == 2
    assert machine_fault("bearing.1.stiffness", "--key") is None
    assert coefficients_of(())[0].shape == (0, 2, 2)
