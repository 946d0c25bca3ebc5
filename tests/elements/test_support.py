"""Bearings on supports: closed forms, the series law, limits, runs against the response, faults and pictures.

With impedances Z = K + s C + s^2 M, links in series have 1 / Z = 1 / Z_1 + 1 / Z_2, and those beside each other
Z_1 + Z_2; a symmetric rotor has two of each bearing and support.
"""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paths import DATA
from series_rotors import HEAVY, assert_eigenvalues, in_series

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.equilibrium.linearised import coefficients_of
from frbcli.errors import InputError
from frbcli.linear.modes import critical_map, natural_modes
from frbcli.linear.response import excited, forced_motion, response
from frbcli.linear.stability import stability
from frbcli.linear.stability_point import eigenvalues
from frbcli.report.sketch import rotor_sketch
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor

G, M, U = 9.81, 6.0, 3e-6  # m/s^2, kg, kg m
K, C = 1e6, 300.0  # N/m, N s/m of one bearing
SHELL, SPRINGS, DAMPERS = 1.5, (4e6, 7e6), (200.0, 90.0)  # kg, N/m and N s/m in x and y of one support
SPEED = {"from": "10 Hz", "to": "200 Hz", "duration": "1 s"}
RIGID = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{U!r} kg*m"}


def support(**keys: object) -> dict[str, Any]:
    stiffness, damping = [f"{k!r} N/m" for k in SPRINGS], [f"{c!r} N*s/m" for c in DAMPERS]
    return {"mass": f"{SHELL} kg", "stiffness": stiffness, "damping": damping} | keys


def on_support(rotor: dict[str, Any], **keys: object) -> frbcli.Case:
    """A rotor in bearings of given coefficients on supports."""
    bearing = {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m", "support": support(**keys)}
    return case_from_dict({"rotor": rotor, "bearing": bearing, "speed": SPEED}, "on-support")


def bearing_impedance(s: Any) -> Any:
    return 2.0 * (K + s * C)


def support_impedance(s: Any, axis: int) -> Any:
    return 2.0 * (SPRINGS[axis] + s * DAMPERS[axis] + s**2 * SHELL)


def test_eigenvalues_of_a_rigid_rotor_on_supports_are_the_roots_of_the_closed_form() -> None:
    bodies = [[2 * SHELL, 2 * DAMPERS[axis], 2 * SPRINGS[axis]] for axis in (0, 1)]
    assert_eigenvalues(on_support(RIGID), M, [2 * C, 2 * K], bodies)


def test_the_response_of_a_rigid_rotor_on_supports_is_the_closed_form() -> None:
    """x and y of rotor and shell, with amplitude and phase: the unbalance pulls with Omega^2 U (i, 1) exp(i alpha)."""
    found = response(on_support(RIGID), [20.0, 90.0, 150.0])
    assert found.points == ("journal", "support")
    s = 2j * math.pi * found.speeds_Hz
    for axis, pull in enumerate((1.0j, 1.0)):
        bearing, shell = bearing_impedance(s), support_impedance(s, axis)
        rotor = -(s**2) * U * pull / (M * s**2 + in_series(bearing, shell))
        np.testing.assert_allclose(found.motion[:, 0, axis], rotor, rtol=1e-9)
        np.testing.assert_allclose(found.motion[:, 1, axis], rotor * bearing / (bearing + shell), rtol=1e-9)
        force = -0.5 * bearing * (found.motion[:, 0, axis] - found.motion[:, 1, axis])  # of one bearing
        np.testing.assert_allclose(found.forces[:, 0, axis], force, rtol=1e-9)


def short_film(**tables: object) -> frbcli.Case:
    """The shipped rigid rotor in its short films, of few revolutions."""
    return load_case("rigid", ["film.theory=short", "rotor.unbalance=3 g*mm"]).with_settings(tables)


@pytest.mark.parametrize("mass", ["1e-9 kg", "1 g"])
def test_a_support_in_series_with_a_film_obeys_the_series_law(mass: str) -> None:
    """Of K + i omega C, cross-coupled, at no mass; one that is not zero adds omega^2 times itself."""
    given = support(mass=mass)
    found = response(short_film(**{"bearing.support": given}), [30.0, 80.0])
    rotor = found.case.rotor
    for point, motion in zip(found.resting, found.motion, strict=True):
        omega = 2 * math.pi * point.speed_Hz
        stiffness, damping = coefficients_of(point.films)
        film = 2.0 * (stiffness[0] + 1j * omega * damping[0])
        weight = 1e-3 if mass == "1 g" else 0.0
        shell = 2.0 * np.diag(SPRINGS + 1j * omega * np.array(DAMPERS) - omega**2 * weight)
        whole = np.linalg.inv(np.linalg.inv(film) + np.linalg.inv(shell))
        dynamic = whole + (1j * omega * rotor.external_damping - omega**2 * rotor.mass) * np.eye(2)
        expected = np.linalg.solve(dynamic, omega**2 * rotor.unbalance * np.array([1.0j, 1.0]))
        np.testing.assert_allclose(motion[found.points.index("journal")], expected, rtol=1e-9)


def test_the_springs_carry_the_weight_of_rotor_and_shell_and_the_film_that_of_the_rotor(tmp_path: Path) -> None:
    given = support(mass="20 kg")
    fixed, moved = short_film(), short_film(**{"bearing.support": given})
    (still,), (sunk,) = (stability(case, [50.0]).points for case in (fixed, moved))
    np.testing.assert_allclose(sunk.films[0].displacement, still.films[0].displacement, rtol=1e-9)
    np.testing.assert_allclose(sunk.films[0].stiffness, still.films[0].stiffness, rtol=1e-7)
    steady = moved.with_settings({"start.position": "resting", "rotor.unbalance": 0.0, "speed.from": "50 Hz",
                                     "speed.to": "50 Hz", "speed.duration": "20 ms"})  # fmt: skip
    run = runup(steady, tmp_path / "run.h5")
    weight = 0.5 * moved.rotor.mass * G + 20.0 * G
    np.testing.assert_allclose(run["support_y_m"], -weight / SPRINGS[1], rtol=1e-6)
    np.testing.assert_allclose(run["support_x_m"], 0.0, atol=1e-6 * weight / SPRINGS[1])


STEADY = {"start.position": "resting", "speed.from": "60 Hz", "speed.to": "60 Hz", "speed.duration": "60 ms",
          "accuracy.tolerance": 1e-9}  # fmt: skip


def test_a_stiff_support_changes_no_signal(tmp_path: Path) -> None:
    """By more than 1e-6, displacements over the clearance, with a million times the stiffness of the film."""
    fixed = short_film(**STEADY)
    (point,) = stability(fixed, [60.0]).points
    stiff = f"{1e6 * float(np.abs(point.films[0].stiffness).max())!r} N/m"
    moved = fixed.with_settings({"bearing.support": {"mass": "1 g", "stiffness": stiff, "damping": "100 N*s/m"}})
    runs = [runup(case, tmp_path / f"{number}.h5") for number, case in enumerate((fixed, moved))]
    shared = [name for name in runs[0].signals if name in runs[1].signals]
    assert {"eccentricity", "journal_x_m", "journal_y_m"} <= set(shared)
    for name in shared:
        one, other = (run[name] for run in runs)
        unit = runs[0].references["clearance_m"] if name.endswith("_m") else np.abs(one).max()
        assert np.abs(one - other).max() <= 1e-6 * unit, name


RING_SUPPORT = {"mass": "200 g", "stiffness": "2e7 N/m", "damping": "500 N*s/m"}


def test_rings_and_several_bearings_stand_on_supports(tmp_path: Path) -> None:
    """Each outer film lies between its ring and its own shell."""
    case = load_case("turbocharger-heavy").with_settings(
        {"bearing.0.support": RING_SUPPORT, "speed.duration": "4 ms", "film.cavitation": "half-sommerfeld"}
    )
    run = runup(case, tmp_path / "run.h5")
    name = case.bearings[0].name
    assert {f"support_{name}_x_m", f"support_{name}_y_m"} <= set(run.signals)
    assert not any(signal.startswith(f"support_{case.bearings[1].name}") for signal in run.signals)
    assert np.abs(run[f"support_{name}_y_m"]).max() > 0.0


def test_the_hopf_point_of_limit_cycles_is_the_threshold_of_stability() -> None:
    """Both linearise the same machine, by different ways; the support moves the threshold."""
    moved = short_film(**{"bearing.support": {"mass": "2 kg", "stiffness": ["2e6 N/m", "6e6 N/m"],
                                              "damping": "2000 N*s/m"}, "rotor.unbalance": 0.0})  # fmt: skip
    threshold, fixed = stability(moved).threshold, stability(short_film()).threshold
    assert threshold is not None
    assert fixed is not None
    assert abs(threshold.speed_Hz - fixed.speed_Hz) > 0.02 * fixed.speed_Hz
    hopf = [special for special in limit_cycles(moved).special if special.kind == "hopf"]
    assert min(abs(each.speed_Hz - threshold.speed_Hz) for each in hopf) < 1e-3 * threshold.speed_Hz


def test_one_quantity_is_that_of_both_directions_and_the_text_gives_the_case_again() -> None:
    one = on_support(RIGID, stiffness="2e6 N/m", damping="10 N*s/m")
    two = on_support(RIGID, stiffness=["2e6 N/m", "2e6 N/m"], damping=["10 N*s/m", "10 N*s/m"])
    assert one.elements == two.elements
    assert load_case_text(one.source_text, name="on-support") == one


def test_a_setting_reaches_one_direction() -> None:
    """What is no value of the pair is refused with one that is."""
    case = on_support(RIGID)
    assert case.with_settings("bearing.support.stiffness.1=9e6 N/m").elements[0].support == on_support(
        RIGID, stiffness=["4e6 N/m", "9e6 N/m"]
    ).elements[0].support  # fmt: skip
    crossed = case.with_settings({"bearing.stiffness": [["1e6 N/m", "0 N/m"], ["0 N/m", "1e6 N/m"]]})
    assert crossed.with_settings("bearing.stiffness.0.1=2e5 N/m").elements[0].stiffness[0] == (1e6, 2e5)  # type: ignore[union-attr]
    for key in ("2", "x", "*.1", "0.1"):
        with pytest.raises(InputError, match=r"is no value of bearing\.support\.stiffness, which has 2.*stiffness\.0,"):
            case.with_settings(f"bearing.support.stiffness.{key}=1e6 N/m")


def test_the_sketch_shows_supports() -> None:
    case = short_film()
    fixed, moved = (rotor_sketch(each)[0] for each in (case, case.with_settings({"bearing.support": support()})))
    assert fixed.count('class="ground"') == 0
    assert moved.count('class="ground"') == 4  # above and below the axis, at both bearings
    heavy = load_case("turbocharger-heavy", ['bearing.0.support={mass="1 kg", stiffness="1e7 N/m"}'])
    assert rotor_sketch(heavy)[0].count('class="ground"') == 2


def test_analyses_of_a_rotor_on_the_ground_refuse_supports() -> None:
    heavy = load_case("turbocharger-heavy", ['bearing.0.support={mass="1 kg", stiffness="1e7 N/m"}'])
    for analysis in (lambda: critical_map(heavy), lambda: natural_modes(heavy, 1e7)):
        with pytest.raises(InputError) as caught:
            analysis()
        assert caught.value.faults[0].key == "bearing.0.support"
    assert natural_modes(heavy).stiffness_N_m == ()  # the free shaft has no supports


ROSS = tomllib.loads((DATA / "ross-supports.toml").read_text())


def heavy_on_supports() -> frbcli.Case:
    bearings = [bearing | {"support": each} for bearing, each in zip(HEAVY["bearing"], ROSS["support"], strict=True)]
    return case_from_dict(HEAVY | {"bearing": bearings}, "heavy")


@pytest.mark.parametrize("speed_Hz", [0, 1200])
def test_a_shaft_on_supports_has_the_damped_modes_of_ross(speed_Hz: int) -> None:
    none = np.zeros((0, 2, 2))
    values = eigenvalues(make_rotor(heavy_on_supports()), 2.0 * math.pi * speed_Hz, none, none)
    expected = np.array(ROSS["modes"][str(speed_Hz)])
    found = values[values.imag > 1.0]
    found = found[np.argsort(found.imag)][: len(expected)]
    np.testing.assert_allclose(found.imag / (2.0 * math.pi), expected[:, 0], rtol=1e-6)
    np.testing.assert_allclose(found.real, expected[:, 1], rtol=1e-5)


def test_a_shaft_on_supports_answers_its_unbalance_as_in_ross() -> None:
    """Amplitude and phase of wheels, journals and supports; here the unbalance points to y at angle 0. Without critical
    speeds, which take minutes with all modes of the shaft."""
    rotor, none = make_rotor(heavy_on_supports()), np.zeros((0, 2, 2))
    omegas = 2.0 * math.pi * np.array([150.0, 350.0, 700.0])
    motions = np.array([forced_motion(rotor, omega, excited(rotor, omega), none, none) for omega in omegas])
    places = dict(rotor.points)
    for axis, name in enumerate("xy"):
        for point, each in ROSS["response"][name].items():
            expected = 1e-9j * (np.array(each) @ [1.0, 1.0j])
            motion = motions @ places[point][axis]
            np.testing.assert_allclose(motion, expected, atol=1e-5 * np.abs(expected).max())
