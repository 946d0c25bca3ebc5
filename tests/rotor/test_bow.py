"""A bow that turns with the rotor: closed forms of a Jeffcott rotor, static shapes of shafts that turn slowly.

In rigid bearings W / i = (u r^2 + b) / (1 - r^2 + 2 i zeta r) with the bow b, the eccentricity u of the unbalance and
r = Omega / w (Nicholas, Gunter and Allaire, "Effect of residual shaft bow on unbalance response and balancing of a
single mass flexible rotor", J. Eng. Power 98, 1976); W = x + i y, and an unbalance of phase 0 points to y at angle 0.
"""

import cmath
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marches import control, march
from scipy.integrate import solve_ivp
from series_rotors import HEAVY

import frbcli
from frbcli.arrays import Array
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.linear.response import Response, response
from frbcli.results.store import Run
from frbcli.rotor.assembly import held_rotor
from frbcli.rotor.loads import speed_profile
from frbcli.runs.start import first_state
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

TURN = 2.0 * math.pi
M, C, D, STIFF = 1.0, 1e6, 40.0, 1e11  # kg, N/m, N s/m: 159 Hz and a damping ratio of 0.02; N/m of a bearing
W = math.sqrt(2.0 * STIFF * C / (2.0 * STIFF + C) / M)  # of shaft and bearings in series
ZETA = D / (2.0 * W * M)
U, B, PHASE = 8e-6, 1e-5, 2.5  # m, m, rad
ROTOR = {
    "kind": "jeffcott", "mass": f"{M} kg", "journal_mass": "1 mg", "shaft_stiffness": f"{C!r} N/m", "gravity": 0,
    "unbalance": f"{M * U!r} kg*m", "external_damping": f"{D} N*s/m",
}  # fmt: skip
RIGID = {"kind": "coefficients", "stiffness": f"{STIFF!r} N/m"}  # against the shaft
SPEEDS = TURN * np.array([0.01, 20.0, 80.0, 158.0, 159.155, 160.0, 240.0, 800.0])


def jeffcott(bow: float = B, phase: float = PHASE, **rotor: object) -> frbcli.Case:
    bent = {"bow": f"{bow!r} m", "bow_phase": f"{phase!r} rad"} if bow else {}
    speed = {"from": "0 Hz", "to": "800 Hz", "duration": "1 s"}
    return case_from_dict({"rotor": ROTOR | bent | rotor, "bearing": RIGID, "speed": speed}, "bent")


def turned(found: Response, point: str) -> Array:
    """(n,) forward motion of a point in the frame of the rotor, along an unbalance of phase 0."""
    return np.asarray(found.forward[:, found.points.index(point)] / 1j)


def test_the_response_of_a_bent_jeffcott_rotor_is_the_closed_form() -> None:
    found, r = response(jeffcott(), (SPEEDS / TURN).tolist()), SPEEDS / W
    expected = (U * r**2 + B * cmath.exp(1j * PHASE)) / (1.0 - r**2 + 2j * ZETA * r)
    np.testing.assert_allclose(turned(found, "disk"), expected, rtol=1e-8)
    assert np.abs(found.backward).max() < 1e-8 * np.abs(expected).max()
    alone = response(jeffcott(), (SPEEDS / TURN).tolist(), excitation="bow")
    np.testing.assert_allclose(turned(alone, "disk"), expected - U * r**2 / (1.0 - r**2 + 2j * ZETA * r), rtol=1e-6)


@pytest.mark.parametrize("ratio", [0.6, 1.0, 1.7])
def test_bow_and_unbalance_of_opposite_phase_cancel_at_one_speed(ratio: float) -> None:
    """At Omega = w (b / u)^(1/2) the disk stays in the middle, at the critical speed, too, and none of both alone
    would leave it there."""
    speed = ratio * W / TURN
    whole, alone = (response(jeffcott(ratio**2 * U, phase), [speed]) for phase in (math.pi, 0.5 * math.pi))
    assert np.abs(turned(whole, "disk")).max() < 1e-8 * np.abs(turned(alone, "disk")).min()


def test_internal_damping_does_not_see_a_bow_that_turns_with_it() -> None:
    plain, damped = (
        turned(response(jeffcott(internal_damping=size), (SPEEDS / TURN).tolist()), "disk")
        for size in ("0 N*s/m", "30 N*s/m")
    )
    np.testing.assert_allclose(damped, plain, rtol=1e-8)


def run_at(case: frbcli.Case, speed_Hz: float, path: Path, *settings: str) -> Run:
    course = {"speed": {"from": f"{speed_Hz!r} Hz", "to": f"{speed_Hz!r} Hz", "duration": "0.4 s"}}
    return frbcli.runup(case.with_settings(course, "accuracy.tolerance=1e-8", *settings), path)


@pytest.mark.parametrize("internal", ["0 N*s/m", "30 N*s/m"])
@pytest.mark.parametrize("speed_Hz", [0.0, 60.0])
def test_a_run_begins_bent_and_turns_so(speed_Hz: float, internal: str, tmp_path: Path) -> None:
    """At rest and slowly the orbit is the bow; at 60 Hz the rotor comes to the closed form, about which it vibrates at
    first."""
    run = run_at(jeffcott(unbalance="0 kg*m", internal_damping=internal), speed_Hz, tmp_path / "run.h5")
    motion, angle = run["disk_x_m"] + 1j * run["disk_y_m"], TURN * speed_Hz * run["time_s"]
    bow, r = 1j * B * np.exp(1j * (angle + PHASE)), TURN * speed_Hz / W
    steady = bow / (1.0 - r**2 + 2j * ZETA * r)
    off, apart = np.abs(motion - steady) / B, r**2 + 2.0 * ZETA * r
    assert abs(motion[0] - bow[0]) < 1e-5 * B  # of the bearings
    assert off.max() < 2.2 * apart + 1e-5
    assert off[-1] < 0.02 * apart + 1e-5


LENGTH, DIAMETER, E_MODULUS, G_MODULUS = 0.4, 0.01, 210e9, 210e9 / 2.6
SHAFT: dict[str, Any] = {
    "rotor": {"kind": "turbocharger"},
    "shaft": [{"length": f"{LENGTH} m", "diameter": f"{DIAMETER} m"}],
    "disk": [{"name": name, "position": f"{place * LENGTH!r} m", "mass": "10 g"}
             for name, place in (("quarter", 0.25), ("middle", 0.5), ("late", 0.9))],
    "bearing": [{"kind": "coefficients", "name": name, "position": f"{place} m", "stiffness": "1e9 N/m"}
                for name, place in (("left", 0.0), ("right", LENGTH))],
    "speed": {"from": "0 Hz", "to": "100 Hz", "duration": "1 s"},
}  # fmt: skip
SLOW_Hz = 1e-3


def bent_beam(x: float) -> float:
    """Deflection of a shaft on two bearings under a unit force in its middle, by bending and shear."""
    near = min(x, LENGTH - x)
    second, area = math.pi / 64.0 * DIAMETER**4, math.pi / 4.0 * DIAMETER**2
    cowper = 6.0 * 1.3 / (7.0 + 6.0 * 0.3)
    bending = near * (3.0 * LENGTH**2 - 4.0 * near**2) / (48.0 * E_MODULUS * second)
    return bending + near / (2.0 * cowper * G_MODULUS * area)


@pytest.mark.parametrize("stiffness", ["1e9 N/m", "1e4 N/m"])
def test_a_shaft_that_turns_slowly_has_the_shape_of_one_loaded_at_its_bow(stiffness: str) -> None:
    """On bearings of any stiffness, since nothing loads them."""
    bow = {"position": f"{0.5 * LENGTH} m", "offset": "20 um", "phase": "40 deg"}
    bearings = [one | {"stiffness": stiffness} for one in SHAFT["bearing"]]
    found = response(case_from_dict({**SHAFT, "bow": [bow], "bearing": bearings}, "bent"), [SLOW_Hz])
    for name, place in (("quarter", 0.25), ("middle", 0.5), ("late", 0.9)):
        expected = 20e-6 * bent_beam(place * LENGTH) / bent_beam(0.5 * LENGTH)
        shown = turned(found, f"disk_{name}")[0]
        assert shown == pytest.approx(expected * cmath.exp(1j * math.radians(40.0)), rel=1e-6)
    assert np.abs(turned(found, "journal_left")).max() < 1e-6 * 20e-6


def test_a_bow_between_several_places_is_the_static_deflection_under_loads_there() -> None:
    """Loads at nut, compressor and turbine bend the shaft of a turbocharger; a bow by its deflections there has, as it
    turns slowly, those of a run in which it is loaded, at all places."""
    forces = [{"at": at, "force": [size, "0 N"]}
              for at, size in (("nut", "40 N"), ("compressor", "-300 N"), ("turbine", "90 N"))]  # fmt: skip
    bearings = [one | {"stiffness": "1e13 N/m", "damping": "0 N*s/m"} for one in HEAVY["bearing"]]
    rotor = HEAVY["rotor"] | {"gravity": 0}
    loaded = make_rotor(case_from_dict({**HEAVY, "rotor": rotor, "bearing": bearings, "force": forces}, "loaded"))
    shape, places = held_rotor(loaded).shape, dict(loaded.points)
    given = [("nut", 0.0), ("compressor", 25.0), ("turbine", 224.0)]
    sags = {name: float((places[f"disk_{name}"] @ shape)[0]) for name, _ in given}
    phases = {name: "180 deg" if sag < 0.0 else "0 deg" for name, sag in sags.items()}
    bows = [{"position": f"{place} mm", "offset": f"{abs(sags[name])!r} m", "phase": phases[name]}
            for name, place in given]  # fmt: skip
    disks = [one | {"unbalance": 0} for one in HEAVY["disk"]] + [
        {"name": "between", "position": "130 mm", "mass": "1 g"}
    ]
    bent = case_from_dict({**HEAVY, "rotor": rotor, "bow": bows, "disk": disks}, "bent")
    found = response(bent, [SLOW_Hz])
    for name in sags:
        assert turned(found, f"disk_{name}")[0] == pytest.approx(sags[name], rel=1e-6)
    also = make_rotor(
        case_from_dict({**HEAVY, "rotor": rotor, "bearing": bearings, "force": forces, "disk": disks}, "loaded")
    )
    between = float((dict(also.points)["disk_between"] @ held_rotor(also).shape)[0])
    assert turned(found, "disk_between")[0] == pytest.approx(between, rel=1e-5)


def test_a_reduced_shaft_has_its_bow_exactly() -> None:
    bow = [{"position": f"{0.37 * LENGTH!r} m", "offset": "20 um"}]
    settings: list[dict[str, object]] = [{"rotor": {"kind": "turbocharger", "modes": 200}}, {}]
    whole, reduced = (
        response(case_from_dict({**SHAFT, "bow": bow, **rotor}, "bent"), [SLOW_Hz, 20.0]) for rotor in settings
    )
    assert reduced.resting[0].rotor is not None
    assert whole.resting[0].rotor is not None
    assert reduced.resting[0].rotor.size < 0.25 * whole.resting[0].rotor.size
    np.testing.assert_allclose(turned(reduced, "disk_middle")[0], turned(whole, "disk_middle")[0], rtol=1e-9)
    np.testing.assert_allclose(turned(reduced, "disk_middle")[1], turned(whole, "disk_middle")[1], rtol=1e-4)


def test_a_bent_rotor_in_films_runs_as_its_linear_response(tmp_path: Path) -> None:
    case = load_case(
        "jeffcott", ["film.theory=short", "rotor.unbalance=0 g*mm", "rotor.bow=0.2 um", "rotor.bow_phase=1"]
    )
    run = run_at(case, 50.0, tmp_path / "run.h5", "speed.duration=1 s", "start.position=resting")
    found, late = response(case, [50.0]), run["time_s"] >= 0.8 - 1e-9
    turn = np.exp(-1j * TURN * 50.0 * run["time_s"][late][:-1])
    for axis, of in (("x", 0), ("y", 1)):
        seen = 2.0 * np.mean(run[f"disk_{axis}_m"][late][:-1] * turn)
        assert seen == pytest.approx(found.motion[0, found.points.index("disk"), of], rel=2e-3)


def sag(x: float, at: float) -> float:
    """Deflection at x under a unit force, of a massless shaft on two rigid bearings, by bending and shear."""
    x, at = min(x, at), max(x, at)
    beyond, second, area = LENGTH - at, math.pi / 64.0 * DIAMETER**4, math.pi / 4.0 * DIAMETER**2
    bending = x * beyond * (LENGTH**2 - beyond**2 - x**2) / (6.0 * LENGTH * E_MODULUS * second)
    return bending + x * beyond / LENGTH / (6.0 * 1.3 / (7.0 + 6.0 * 0.3) * G_MODULUS * area)


def test_a_bent_shaft_runs_up_as_its_equations_of_motion() -> None:
    """Two disks with unbalances u on a light shaft through its first critical speed, each at a point of a bow b, from
    q = b e^(i alpha) on, alpha from y: M q'' + D q' + K (q - b e^(i alpha)) = (Omega^2 - i Omega') u e^(i alpha)."""
    places, masses, damping = np.array([0.12, 0.25]), np.array([0.4, 0.6]), 15.0
    unbalance, bow = np.array([4e-6, 3e-6j]), 1e-5 * np.exp(1j * np.array([0.7, -1.2]))
    stiffness = np.linalg.inv([[sag(x, at) for at in places] for x in places])
    low, rate, end = TURN * 20.0, TURN * 300.0, 0.2
    disks = [{"name": f"{k}", "position": f"{x} m", "mass": f"{masses[k]} kg", "unbalance": f"{abs(unbalance[k])} kg*m",
              "phase": f"{cmath.phase(unbalance[k])} rad"} for k, x in enumerate(places)]  # fmt: skip
    bows = [{"position": f"{x} m", "offset": f"{abs(bow[k])} m", "phase": f"{cmath.phase(bow[k])} rad"}
            for k, x in enumerate(places)]  # fmt: skip
    data = {
        "rotor": {"kind": "turbocharger", "gravity": 0, "external_damping": f"{damping} N*s/m"}, "disk": disks,
        "bow": bows, "shaft": [SHAFT["shaft"][0] | {"density": "0.01 kg/m^3"}],
        "bearing": [one | {"stiffness": "1e13 N/m"} for one in SHAFT["bearing"]],
        "speed": {"from": "20 Hz", "to": "80 Hz", "duration": f"{end} s"},
    }  # fmt: skip
    case = case_from_dict(data, "bent")
    system, profile = make_system(case, make_plan(case)), speed_profile([0.0, end], [low, low + rate * end])
    limits = control(tolerance=1e-8, longest=end / 200.0, output=5e-4)
    run, places_of = march(system, profile, limits, first_state(case.start, system, profile)), dict(system.rotor.points)

    def motion(t: float, state: Array) -> Array:
        omega, turned = low + rate * t, 1j * cmath.exp(1j * (low * t + 0.5 * rate * t**2))
        force = (omega**2 - 1j * rate) * unbalance * turned - stiffness @ (state[:2] - bow * turned)
        return np.concatenate([state[2:], (force - damping * state[2:]) / masses])

    start = np.concatenate([1j * bow, -low * bow])  # turns with the rotor
    known = solve_ivp(motion, (0.0, end), start, "DOP853", rtol=1e-10, atol=1e-15, t_eval=run.times).y[:2]
    found = np.array([[1.0, 1j] @ places_of[f"disk_{k}"] @ run.q.T for k in range(2)])
    assert np.abs(known).max() > 4.0 * np.abs(bow).max()
    assert np.abs(found - known).max() < 2e-5 * np.abs(known).max()
