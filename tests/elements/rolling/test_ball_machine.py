"""Rotors on ball bearings: rest, small motions, free vibrations, balls that pass, and cases that make no sense."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ball_bearings import solve_plain
from marches import Result, control, march, start
from scipy.integrate import quad
from scipy.optimize import brentq

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.elements.ball import BallBearing, BallBearingElement, BallForce, at_displacement, balls_of, row_in_tilt
from frbcli.elements.ball_force import RINGS, ball, ball_friction, of_balls
from frbcli.errors import InputError
from frbcli.linear.sheets.ball import ball_bearing_sheet
from frbcli.linear.stability import stability
from frbcli.rotor.loads import speed_profile
from frbcli.rotor.port import ANSWER
from frbcli.rotor.port_function import evaluate, evaluate_along
from frbcli.runs.run import runup
from frbcli.scene.machine.findings import remarks
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan

TURN, GRAVITY = 2.0 * math.pi, 9.81
A = {  # of tests/data/ball-bearing.csv
    "balls": 8, "ball_diameter": "3.175 mm", "pitch_diameter": "14 mm", "contact_angle": "15 deg",
    "inner_curvature": 0.53, "outer_curvature": 0.53, "preload": "60 N",
}  # fmt: skip
RADIAL = {  # without clearance
    "balls": 60, "ball_diameter": "2 mm", "pitch_diameter": "50 mm", "radial_clearance": "0 m", "cage": "mean",
}  # fmt: skip
LOAD, KXX, KYY = 60.0, 3.929573e7, 3.404362e7  # N and N/m of A at 1000 Hz there


def on_balls(bearing: dict[str, Any], load: float = 0.0, mass: float = 2.0, unbalance: float = 0.0) -> frbcli.Case:
    """A rigid rotor with a load in N on each of its two bearings."""
    data = {
        "rotor": {"kind": "rigid", "mass": f"{mass!r} kg", "unbalance": f"{unbalance!r} kg*m",
                  "gravity": f"{2.0 * load / mass!r} m/s^2"},
        "bearing": {"kind": "ball", **bearing},
        "speed": {"from": "100 Hz", "to": "100 Hz", "duration": "0.2 s"},
    }  # fmt: skip
    return case_from_dict(data, "balls")


def run_from(
    case: frbcli.Case, time: float, y: float, tolerance: float, output: float, omega: float
) -> tuple[System, Result]:
    system, profile = make_system(case, make_plan(case)), speed_profile([0.0, time], [omega, omega])
    limits = control(tolerance=tolerance, longest=time / 200.0, output=output)
    return system, march(system, profile, limits, start(system, profile, np.array([0.0, y])))


def test_the_compiled_force_is_the_plain_one() -> None:
    (element,) = BallBearingElement.of(on_balls(A))
    law, motion, plain = BallForce(element.rings), np.array([2e-6, -1e-6, 0.1, 0.2, 6000.0, 0.7]), np.zeros(ANSWER)
    law.force(law.numbers, law.memory, motion, plain)
    np.testing.assert_allclose(evaluate(law, motion), plain, rtol=1e-9)


def test_small_motions_have_the_stiffness_at_rest() -> None:
    """Both natural frequencies are sqrt(2 k / m) of the independent program's stiffness, at any mass under its load."""
    (point,) = stability(on_balls(A, LOAD), [1000.0]).points
    found = np.sort(point.eigenvalues.imag[point.eigenvalues.imag > 0.0])
    np.testing.assert_allclose(found, np.sqrt(np.array([KYY, KXX])), rtol=1e-6)  # of 2 kg


def test_bearings_of_a_shaft_carry_its_weight() -> None:
    sheet = ball_bearing_sheet(frbcli.load_case("turbocharger-ball"), [1000.0])
    loads = np.array([point.load for point in sheet.points])
    np.testing.assert_allclose(loads.sum(axis=0), [0.0, -0.1001 * GRAVITY], rtol=2e-3, atol=1e-6)
    assert [point.bearing for point in sheet.points] == ["compressor", "turbine"]


def test_a_machine_rests_where_its_sheet_says() -> None:
    (state,) = ball_bearing_sheet(on_balls(A, LOAD), [1000.0]).points
    (given,) = ball_bearing_sheet(on_balls(A), [1000.0], [LOAD]).points
    np.testing.assert_allclose(state.displacement, given.displacement, rtol=1e-7, atol=1e-14)
    np.testing.assert_allclose(np.diag(given.stiffness), [KXX, KYY], rtol=1e-6)
    assert (state.cage_frequency, state.ball_pass_outer) == pytest.approx((390.4709, 3123.767), rel=1e-6)
    assert state.life_h is None


def test_a_free_vibration_keeps_its_energy() -> None:
    """At a constant speed the mean over the cage has a potential, that of contacts and centrifugal forces."""
    omega, mass = TURN * 1000.0, 2.0
    case = on_balls({**A, "cage": "mean"})
    (element,) = BallBearingElement.of(case)
    _, result = run_from(case, 6e-3, 3e-6, 1e-10, 1e-4, omega)
    potential = [solve_plain(element.rings.numbers, place, omega).energy for place in result.q]
    energy = 0.5 * mass * (result.v**2).sum(axis=1) + 2.0 * np.array(potential)
    kinetic = 0.5 * mass * (result.v**2).sum(axis=1).max()
    assert kinetic > 1e-5
    assert np.abs(energy - energy[0]).max() < 1e-8 * kinetic


@pytest.mark.parametrize("amplitude", [2e-6, 8e-6])
def test_a_bearing_without_clearance_has_the_frequency_of_its_amplitude(amplitude: float) -> None:
    """m x'' = -2 Z K J x^1.5: a quarter period is the integral of dx / v, T in proportion to A^(-1/4)."""
    mass, case = 2.0, on_balls(RADIAL)
    (element,) = BallBearingElement.of(case)
    inner, outer = (each.stiffness for each in element.rings.contacts)
    both = (inner ** (-2.0 / 3.0) + outer ** (-2.0 / 3.0)) ** -1.5
    share = quad(lambda psi: math.cos(psi) ** 2.5, -0.5 * math.pi, 0.5 * math.pi)[0] / TURN  # Stribeck's J
    push = 2.0 * RADIAL["balls"] * both * share
    quarter = quad(lambda u: 2.0 * u / math.sqrt(1.0 - (1.0 - u * u) ** 2.5), 0.0, 1.0)[0]  # x = A (1 - u^2)
    period = 4.0 * quarter * math.sqrt(2.5 * mass / (2.0 * push)) * amplitude**-0.25
    _, result = run_from(case, 5.0 * period, amplitude, 1e-10, period, 0.0)
    np.testing.assert_allclose(result.q[:, 1], amplitude, rtol=1e-5)


def test_balls_pass_in_the_spectrum(tmp_path: Path) -> None:
    bearing = {**A, "preload": "10 N", "damping": "500 N*s/m"}
    data = on_balls(bearing, LOAD).model_dump(by_alias=True, exclude_unset=True)
    speed = {**data["speed"], "duration": "0.5 s"}
    case = case_from_dict(data | {"start": {"position": "resting"}, "speed": speed}, "passing")
    (element,) = BallBearingElement.of(case)
    run = runup(case, tmp_path / "run.h5", force=True)
    t, y = np.asarray(run.signal("time_s")), np.asarray(run.signal("journal_y_m"))
    late = np.linspace(0.1, 0.5, 8192, endpoint=False)
    spectrum = np.abs(np.fft.rfft((np.interp(late, t, y) - y.mean()) * np.hanning(len(late))))
    spectrum[:3] = 0.0
    force = np.asarray(run.signal("ball_force_y_N"))
    assert force.mean() == pytest.approx(LOAD, rel=1e-3)
    largest, apart = run["ball_inner_load_N"], run["balls_apart"]
    assert largest.min() > 10.0 / (A["balls"] * math.sin(math.radians(15.0)))  # an even share of the preload
    assert set(np.unique(apart)) <= set(range(A["balls"]))
    inner, outer = element.rings.contacts
    pressures = inner.pressure(float(largest[-1])), outer.pressure(float(run["ball_outer_load_N"][-1]))
    assert run["ball_pressure_Pa"][-1] == pytest.approx(max(pressures), rel=1e-9)
    strongest = np.argmax(spectrum) / 0.4
    assert strongest == pytest.approx(100.0 * element.rings.pass_outer, abs=2.5)


def test_keys_have_their_meaning() -> None:
    figures = {"modulus": "310 GPa", "poisson": 0.27, "density": "3200 kg/m^3"}
    (named,) = BallBearingElement.of(on_balls({**A, "ball_material": "silicon nitride"}))
    (told,) = BallBearingElement.of(on_balls({**A, "ball_material": figures, "arrangement": "back-to-back"}))
    assert told.rings.contacts == named.rings.contacts
    assert (named.rings.rows, told.rings.rows) == (1, 2)
    (held,) = BallBearingElement.of(on_balls({**A, "preload": {"offset": "4 um"}}))
    assert (held.rings.preload, held.rings.offset) == (None, 4e-6)
    (deep,) = BallBearingElement.of(on_balls({**RADIAL, "radial_clearance": "8 um"}))
    assert deep.rings.free == pytest.approx(4e-6, rel=1e-9)


def axial_force(rings: BallBearing, moved: float) -> tuple[float, float]:
    """N on a row whose inner ring is moved along the axis from first contact, and on each ball, without speed:
    Z K (A (cos(alpha_0) / cos(alpha) - 1))^1.5 sin(alpha)."""
    inner, outer = (each.stiffness ** (-2.0 / 3.0) for each in rings.contacts)
    radial, axial = (rings.grooves * each(rings.contact_angle) for each in (math.cos, math.sin))
    length = math.hypot(radial, axial + moved)
    load = (max(length - rings.grooves, 0.0) / (inner + outer)) ** 1.5
    return rings.balls * load * (axial + moved) / length, load


@pytest.mark.parametrize("preload", [{"offset": "5 um"}, "60 N"])
def test_a_preload_that_dents_the_balls_is_remarked(preload: Any) -> None:
    rings = BallBearingElement(key="", given=on_balls({**A, "preload": preload}).given_bearings[0]).rings
    pressed = brentq(lambda z: axial_force(rings, z)[0] - 60.0, 0.0, 1e-4, xtol=1e-16)
    moved = 5e-6 if isinstance(preload, dict) else pressed
    load = axial_force(rings, moved)[1]
    assert rings.preload_pressure == pytest.approx(rings.contacts[0].pressure(load), rel=1e-8)
    assert not remarks(on_balls({**A, "preload": preload}, LOAD, unbalance=1e-6))
    dented = on_balls({**A, "preload": {"offset": "60 um"} if isinstance(preload, dict) else "20 kN"}, LOAD, 2.0, 1e-6)
    assert all("ISO 76" in sentence for sentence in remarks(dented))
    assert len(remarks(dented)) == 1


def test_natural_modes_on_springs_have_no_balls() -> None:
    with pytest.raises(InputError, match="has balls"):
        frbcli.natural_modes(on_balls(A, LOAD), "bearings")
    film = {"kind": "single-film", "name": "film", "width": "20 mm", "diameter": "25 mm", "clearance": "35 um"}
    settings = {"bearing": [film, {"kind": "ball", "name": "balls", **A}]}
    with pytest.raises(InputError, match="has balls"):
        frbcli.natural_modes(frbcli.load_case("jeffcott").with_settings(settings), 1e7)


def test_signals_of_balls_do_not_depend_on_how_a_run_is_cut() -> None:
    """A law begins with what it has left at the moment before: another first moment changes round-off alone."""
    law = BallForce(next(iter(BallBearingElement.of(frbcli.load_case("turbocharger-ball")))).rings)
    time = np.linspace(0.0, 0.01, 200)
    motion = np.column_stack([5e-6 * np.cos(900 * time), 5e-6 * np.sin(900 * time), 0 * time, 0 * time,
                              np.full(len(time), 5000.0), 5000 * time])  # fmt: skip
    whole = law.inside(evaluate_along(law, motion)[1])
    cut = law.inside(np.concatenate([evaluate_along(law, part)[1] for part in np.array_split(motion, 7)]))
    for name, (_, values) in whole.items():
        np.testing.assert_allclose(cut[name][1], values, rtol=0, atol=1e-12 * np.abs(values).max())


def test_a_locating_bearing_carries_the_axial_load_beside_its_preload() -> None:
    """The other one keeps the force of its spring; a load with the square of the speed is that of the speed."""
    case = frbcli.load_case("turbocharger-ball")
    loaded = {"bearing.0.locating": "right", "axial": {"load": {"at": "2000 Hz", "load": "80 N"}}}
    given = frbcli.stability(case.with_settings(loaded), speeds_Hz=[1000.0]).points[0]
    pressed = frbcli.stability(case.with_settings({"bearing.0.preload": "80 N"}), speeds_Hz=[1000.0]).points[0]
    np.testing.assert_allclose(given.eigenvalues, pressed.eigenvalues, rtol=1e-9)
    plain = frbcli.stability(case, speeds_Hz=[1000.0]).points[0]
    assert not np.allclose(given.eigenvalues, plain.eigenvalues, rtol=1e-3)


# A rotor of one steel shaft, which an opposed pair of rows holds in its middle
LENGTH, RADIUS, APART = 0.04, 0.01, 0.008  # m
MASS = 7850.0 * math.pi * RADIUS**2 * LENGTH


def on_a_pair(arrangement: str, **more: Any) -> frbcli.Case:
    bearing, tables = {**A, "arrangement": arrangement, "row_distance": f"{APART} m"}, dict[str, Any]()
    for key, value in more.items():
        (tables if key == "axial" else bearing)[key] = value
    data = {
        "rotor": {"kind": "turbocharger", "gravity": 0.0},
        "shaft": [{"length": f"{LENGTH} m", "diameter": f"{2.0 * RADIUS} m", "youngs_modulus": "4e12 Pa"}],
        "bearing": [
            {"kind": "ball", "name": "pair", "position": f"{0.5 * LENGTH} m", **bearing},
            {"kind": "coefficients", "name": "loose", "position": "1 mm", "stiffness": "1 N/m"},
        ],
        "speed": {"from": "1 Hz", "to": "1 Hz", "duration": "0.1 s"},
    }  # fmt: skip
    return case_from_dict(data | tables, "pair")


def moment_of_a_row(row: BallBearing, place: float, sense: float, omega: float, slope: float) -> tuple[float, float]:
    """Force across and moment that hold a ring at a slope about y, by the whole rotation of its grooves, with the axial
    displacement at which the balls carry the preload."""
    of = row.numbers
    centrifugal, rest = of_balls(of, omega)
    psi = TURN * np.arange(row.balls) / row.balls
    across = 0.5 * row.pitch_diameter + of.inner * math.cos(row.contact_angle)
    along = place + sense * of.inner * math.sin(row.contact_angle)
    x, z = across * np.cos(psi), np.full(row.balls, along)
    s, c = math.sin(slope), math.cos(slope)
    moved = np.array([x * c + z * s - x, -x * s + z * c - z])
    turning = np.array([-x * s + z * c, -x * c - z * s])  # by the slope

    def pressed(w: float) -> np.ndarray:
        memory = row.memory
        return np.array([ball(of, of.axial + w + sense * dz, of.radial + dx * math.cos(angle), centrifugal, rest,
                              memory, RINGS)[:2] for dx, dz, angle in zip(*moved, psi, strict=True)])  # fmt: skip

    assert row.preload is not None
    w = brentq(lambda w: pressed(w)[:, 0].sum() - row.preload, -2e-5, 4e-5, xtol=1e-16)
    q_a, q_r = pressed(w).T
    force = q_r * np.cos(psi)
    return float(force.sum()), float((force * turning[0] + sense * q_a * turning[1]).sum())


@pytest.mark.parametrize("omega", [0.0, TURN * 2500.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_row_in_tilt_has_the_slope_of_its_moment(sense: float, omega: float) -> None:
    (element,) = BallBearingElement.of(on_balls(A))
    row, place, step = replace(element.rings, turning=False), -0.5 * APART, 1e-6
    above, below = (np.array(moment_of_a_row(row, place, sense, omega, each)) for each in (step, -step))
    np.testing.assert_allclose(row_in_tilt(row, place, sense, omega), (above - below) / (2.0 * step), rtol=1e-5)


def whirls(case: frbcli.Case) -> np.ndarray:
    """Natural frequencies in rad/s, hardly turning."""
    (point,) = stability(case, [1.0]).points
    return np.sort(point.eigenvalues.imag[point.eigenvalues.imag > 0.0])


@pytest.mark.parametrize("arrangement", ["back-to-back", "face-to-face"])
def test_an_opposed_pair_holds_the_shaft_in_tilt(arrangement: str) -> None:
    """Without speed a row holds the shaft where its contacts meet the axis, but for what its preload turns: 2 k l^2
    with the distance l of this point from the middle, D / 2 tan(alpha) beyond the row back to back."""
    (element,) = BallBearingElement.of(on_a_pair(arrangement))
    rest = at_displacement(replace(element.rings, turning=False), np.zeros(2), 0.0)
    sense = 1.0 if arrangement == "back-to-back" else -1.0
    lever = 0.5 * APART + sense * 0.5 * element.rings.pitch_diameter * math.tan(rest.balls.inner_angle[0])
    assert element.tilt is not None
    tilt = element.tilt.stiffness[0, 2, 2]
    size = 0.5 * element.rings.pitch_diameter
    assert tilt == pytest.approx(rest.stiffness[0, 0] * lever**2, abs=0.02 * rest.stiffness[0, 0] * size**2)
    inertia = MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0
    expected = np.sort([math.sqrt(rest.stiffness[0, 0] / MASS)] * 2 + [math.sqrt(tilt / inertia)] * 2)
    np.testing.assert_allclose(whirls(on_a_pair(arrangement))[:4], expected, rtol=5e-3)


def test_rotors_rest_where_all_balls_but_three_are_lifted() -> None:
    """A light preload and fast balls: the first guess of the place would lean on a single ball, which holds nothing
    across. Natural frequencies as the stiffness where the bearing carries the load."""
    mass, speed_Hz, load = 2.0, 520.0, 11.665
    bearing = {"balls": 10, "ball_diameter": "5 mm", "pitch_diameter": "28 mm", "contact_angle": "25 deg",
               "ball_material": "silicon nitride", "preload": "4.288 N"}  # fmt: skip
    case = on_balls(bearing, load, mass)
    (element,) = BallBearingElement.of(case)

    def carried(way: float) -> float:
        return float(at_displacement(element.rings, np.array([0.0, -way]), TURN * speed_Hz).force[1]) - load

    rest = at_displacement(element.rings, np.array([0.0, -brentq(carried, 0.0, 3e-5)]), TURN * speed_Hz)
    assert np.count_nonzero(rest.balls.inner_load) == 3
    (point,) = stability(case, [speed_Hz]).points
    expected = np.sqrt(2.0 * np.sort(np.diag(rest.stiffness)) / mass)
    np.testing.assert_allclose(np.sort(point.eigenvalues.imag)[-2:], expected, rtol=1e-6)


def test_a_load_that_grows_with_the_speed_parts_rings_beyond_the_speeds_of_the_case() -> None:
    """60 N of preload against 40 N times the square of the speed over 1000 Hz are gone at 1225 Hz."""
    axial = {"load": {"at": "1000 Hz", "load": "-40 N"}}
    case = on_a_pair("tandem", row_distance=None, preload="30 N", locating="right", axial=axial)
    held, parted = stability(case, [1220.0, 1230.0]).points
    assert held.rests
    assert "pulls the rings of the bearing pair apart at 1230 Hz" in parted.problem
    held, parted = ball_bearing_sheet(case, [1220.0, 1230.0], [1.0]).points
    assert not held.problem
    assert parted.problem


@pytest.mark.parametrize("speed_Hz", [151.0, 720.0, 1500.0, 3900.0])
def test_a_pair_holds_the_shaft_in_tilt_at_any_speed(speed_Hz: float) -> None:
    """Within and beyond the speeds of the case, as the moments of both rows have it; light preloads are lost early."""
    case = on_a_pair("back-to-back", preload="10 N").with_settings("speed.to = 1000 Hz")
    (element,), omega, step = BallBearingElement.of(case), TURN * speed_Hz, 1e-6
    row, moment = replace(element.rings, rows=1, turning=False), 0.0
    for place, sense in ((-0.5 * APART, 1.0), (0.5 * APART, -1.0)):
        above, below = (moment_of_a_row(row, place, sense, omega, each)[1] for each in (step, -step))
        moment += (above - below) / (2.0 * step)
    assert element.tilt is not None
    assert element.tilt.at(omega)[0][3, 3] == pytest.approx(moment, rel=1e-3)


def test_a_pair_is_not_taken_for_known_at_speeds_far_beyond_the_case() -> None:
    case = on_a_pair("back-to-back").with_settings("speed.to = 1000 Hz")
    known, beyond = stability(case, [3999.0, 4001.0]).points
    assert known.rests
    assert "known up to 4000 Hz, and not at 4001 Hz" in beyond.problem


@pytest.mark.parametrize(("arrangement", "locating", "end"), [
    ("back-to-back", "right", "left"), ("face-to-face", "right", "right"), ("back-to-back", "left", "right"),
])  # fmt: skip
def test_one_row_of_an_opposed_pair_carries_the_axial_load(arrangement: str, locating: str, end: str) -> None:
    """Pushed to the right, the left row back to back is pressed; the other one keeps the force of its spring."""
    push = "40 N" if locating == "right" else "-40 N"
    case = on_a_pair(arrangement, locating=locating, axial={"load": push})
    (element,) = BallBearingElement.of(case)
    assert [name for name in element.signals if name.endswith(end)] == [f"ball_force_pair_{end}"]
    pressed = dict(element.rows)
    loads = {name: row.numbers.preload for name, row in pressed.items()}
    assert loads == {end: 100.0, "left" if end == "right" else "right": 60.0}
    both = [at_displacement(replace(row, turning=False), np.zeros(2), 0.0).stiffness[0, 0] for row in pressed.values()]
    coupled = element.tilt
    assert coupled is not None
    inertia = MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0
    k, force, moment = sum(both), coupled.stiffness[0, 0, 3], coupled.stiffness[0, 3, 3]
    plane = np.linalg.eigvals(np.array([[k / MASS, force / MASS], [force / inertia, moment / inertia]]))
    np.testing.assert_allclose(whirls(case)[:4], np.sort(np.repeat(np.sqrt(plane.real), 2)), rtol=5e-3)


OFFSET = {"offset": "5 um"}


def held_pair(thrust: float, square: float = 0.0, turning: bool = False) -> BallBearing:
    """Two rows that an offset of 5 um holds against each other, under an axial load."""
    (element,) = BallBearingElement.of(on_a_pair("back-to-back", preload=OFFSET))
    return replace(element.rings, pair=True, thrust=(thrust, square), turning=turning)


def test_a_held_pair_shares_the_axial_load_as_its_closed_form() -> None:
    """The difference of both rows is the load."""
    rings = held_pair(120.0)

    def missing(z: float) -> float:
        return axial_force(rings, 5e-6 + z)[0] - axial_force(rings, 5e-6 - z)[0] - 120.0

    z = brentq(missing, 0.0, 2e-5, xtol=1e-16)
    found = at_displacement(rings, np.zeros(2), 0.0)
    assert found.displacement[2] == pytest.approx(z, rel=1e-8)
    assert found.force[2] == pytest.approx(-120.0, rel=1e-9)
    rows = rings.apart(0.0)
    assert [row.offset for row in rows] == pytest.approx([5e-6 + z, 5e-6 - z], rel=1e-8)


@pytest.mark.parametrize("omega", [0.0, TURN * 2500.0])
def test_a_held_pair_is_two_held_rows_moved_by_the_load(omega: float) -> None:
    """Without a load it is the pair of before; under one its force is that of both rows, and its stiffness the slope of
    the force, the rings free along the axis."""
    place, rings = np.array([1.2e-6, -0.7e-6]), held_pair(60.0, 1e-7)
    plain = at_displacement(replace(rings, pair=False, thrust=(0.0, 0.0)), place, omega)
    unloaded = at_displacement(replace(rings, thrust=(0.0, 0.0)), place, omega)
    np.testing.assert_allclose(unloaded.force[:2], plain.force[:2], rtol=1e-12)
    found = at_displacement(rings, place, omega)
    assert found.force[2] == pytest.approx(-60.0 - 1e-7 * omega**2, rel=1e-9)
    one, z = replace(rings, rows=1, pair=False, thrust=(0.0, 0.0)), found.displacement[2]
    both = [at_displacement(replace(one, offset=5e-6 + each), place, omega).force for each in (z, -z)]
    np.testing.assert_allclose(found.force[:2], (both[0] + both[1])[:2], rtol=1e-9)
    step = 1e-9 * np.eye(2)
    moved = ([place + sign * each for each in step] for sign in (1.0, -1.0))
    ahead, behind = ([at_displacement(rings, each, omega).force[:2] for each in places] for places in moved)
    slope = -(np.array(ahead) - np.array(behind)).T / 2e-9
    np.testing.assert_allclose(found.stiffness, slope, rtol=1e-5, atol=1e-6 * np.abs(slope).max())


def test_a_held_pair_in_a_run_is_that_at_rest_and_its_friction_counts_both_rows() -> None:
    """Compiled and plain; the balls of both rows bear the loads of two rows by themselves."""
    rings = replace(held_pair(60.0, turning=True), f_1=1e-3)
    place, omega = np.array([1.2e-6, -0.7e-6]), TURN * 1000.0
    rest = at_displacement(rings, place, omega)
    motion = np.array([[*place, 0.0, 0.0, omega, 0.0]])
    answers, memories = evaluate_along(BallForce(rings), motion)
    np.testing.assert_allclose(answers[0, :2], rest.force[:2], rtol=1e-9)
    loads = balls_of(rings.numbers, memories[0], 0.0).inner_load
    np.testing.assert_allclose(loads, rest.balls.inner_load, rtol=1e-6, atol=1e-9)
    torque, _ = ball_friction(rings.numbers, omega, memories[0])
    assert torque == pytest.approx(-1e-3 * rings.pitch_diameter * loads.sum(), rel=1e-6)


@pytest.mark.parametrize("arrangement", ["back-to-back", "face-to-face"])
@pytest.mark.parametrize("push", [40.0, -40.0])
def test_a_held_pair_in_a_machine(arrangement: str, push: float) -> None:
    """The row that the load presses is stiffer: it couples tilt and displacement, with the sign of the load."""
    case = on_a_pair(arrangement, preload=OFFSET, locating="both", axial={"load": f"{push} N"})
    (element,) = BallBearingElement.of(case)
    assert element.signals == ("ball_force_pair",)
    assert element.tilt is not None
    stiffness = element.tilt.stiffness[0]
    left = (arrangement == "back-to-back") == (push > 0.0)  # the row that is pressed
    assert (stiffness[0, 3] < 0.0) == left
    rest = at_displacement(replace(element.rings, turning=False), np.zeros(2), 0.0)
    inertia = MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0
    k, force, moment = rest.stiffness[0, 0], stiffness[0, 3], stiffness[3, 3]
    plane = np.linalg.eigvals(np.array([[k / MASS, force / MASS], [force / inertia, moment / inertia]]))
    np.testing.assert_allclose(whirls(case)[:4], np.sort(np.repeat(np.sqrt(plane.real), 2)), rtol=5e-3)


def test_an_axial_load_that_takes_the_preload_off_a_row_is_remarked() -> None:
    def said(load: str) -> list[str]:
        case = on_a_pair("back-to-back", preload=OFFSET, locating="both", axial={"load": load})
        return [sentence for sentence in remarks(case) if "off one row" in sentence]

    assert not said("40 N")
    assert len(said("4 kN")) == 1


def on_two_bearings(front: dict[str, Any]) -> frbcli.Case:
    """A shaft with a disk between a front and a rear ball bearing, without films, up to 1000 Hz."""
    balls = {"kind": "ball", "balls": 12, "ball_diameter": "4 mm", "pitch_diameter": "20 mm", "contact_angle": "15 deg",
             "damping": "500 N*s/m", "preload": "60 N"}  # fmt: skip
    data = {
        "rotor": {"kind": "turbocharger"},
        "shaft": [{"length": "80 mm", "diameter": "10 mm"}],
        "disk": [{"name": "wheel", "position": "75 mm", "mass": "0.3 kg", "polar_inertia": "60 kg*mm^2",
                  "diametral_inertia": "40 kg*mm^2", "unbalance": "0.2 g*mm"}],
        "bearing": [{"name": "front", "position": "25 mm", **balls, **front},
                    {"name": "rear", "position": "60 mm", **balls}],
        "speed": {"from": "0 Hz", "to": "1000 Hz", "duration": "0.5 s"},
    }  # fmt: skip
    return case_from_dict(data, "balls")


@pytest.mark.parametrize("front", [{}, {"arrangement": "back-to-back", "row_distance": "10 mm",
                                        "preload": {"offset": "4 um"}}])  # fmt: skip
def test_critical_speeds_follow_the_stiffness_that_balls_have_at_them(front: dict[str, Any]) -> None:
    """Balls soften with the speed: each peak of the response solved speed by speed is a critical speed, and no other
    one is."""
    case = on_two_bearings(front)
    dense = frbcli.response(case, np.linspace(10.0, 1000.0, 100).tolist())
    height = dense.amplitude.max(axis=1)
    tops = [k for k in range(1, 99) if height[k - 1] < height[k] > height[k + 1]]
    peaks = frbcli.response(case).critical_speeds
    assert len(peaks) == len(tops) >= 1
    for peak, top in zip(peaks, tops, strict=True):
        around = np.linspace(0.999, 1.001, 21) * peak.speed_Hz
        near = frbcli.response(case, around.tolist()).amplitude.max(axis=1)
        assert peak.speed_Hz == pytest.approx(dense.speeds_Hz[top], abs=10.0)
        assert peak.amplitude == pytest.approx(near.max(), rel=1e-3)
        assert peak.speed_Hz == pytest.approx(around[near.argmax()], rel=1.5e-4)
