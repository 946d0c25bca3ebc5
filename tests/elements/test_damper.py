"""Squeeze film dampers: closed forms of centred orbits, series with springs, floating rings that do not turn, faults.

A shell that moves on a circle of radius e c around the centre of a short film, half of which cavitates, meets
F = -(K + i omega C) e c with K = 2 eta omega R (L/c)^3 e / (1 - e^2)^2 and C = pi eta R (L/c)^3 / (2 (1 - e^2)^1.5).
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from films import short_pressure
from scipy.optimize import brentq

import frbcli
from frbcli.analysis.signals import bearing_clearance, point_of
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.report.sketch import film_sketches, rotor_sketch
from frbcli.runs.run import rundown, runup
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import STABILITY
from frbcli.scene.machine.findings import findings
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan

WIDTH, DIAMETER, CLEARANCE, VISCOSITY = 22.86e-3, 129.54e-3, 76.2e-6, 27.968e-3
OMEGA = 18600.0 / 60.0 * 2.0 * math.pi
CUBE = VISCOSITY * 0.5 * DIAMETER * (WIDTH / CLEARANCE) ** 3
M, U, K, C = 20.0, 1e-3, 5e7, 2000.0  # kg, kg m; N/m and N s/m of one bearing
SHELL, SPRING = 3.0, 1e7  # kg and N/m of one damper
DAMPER = {
    "width": f"{WIDTH!r} m", "diameter": f"{DIAMETER!r} m", "clearance": f"{CLEARANCE!r} m", "mass": f"{SHELL} kg",
    "spring": f"{SPRING!r} N/m",
}  # fmt: skip
RIGID = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{U!r} kg*m", "gravity": "0 m/s^2"}


def damped(film: dict[str, object] | None = None, settings: tuple[str, ...] = (), **damper: object) -> frbcli.Case:
    """A rigid rotor without weight in bearings of given coefficients, in dampers."""
    data: dict[str, Any] = {
        "rotor": RIGID,
        "bearing": {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m",
                    "damper": DAMPER | damper},
        "oil": {"viscosity": f"{VISCOSITY!r} Pa*s", "density": "850 kg/m^3"},
        "film": {"theory": "short"} if film is None else film,
        "speed": {"from": "310 Hz", "to": "310 Hz", "duration": "0.1 s"},
    }  # fmt: skip
    case = case_from_dict(data, "damped")
    return case.with_settings(*settings) if settings else case


def system(case: frbcli.Case) -> System:
    return make_system(case, make_plan(case))


def centred_orbit(e: Any, omega: float = OMEGA) -> tuple[Any, Any]:
    """K in N/m and C in N s/m."""
    stiffness = 2.0 * omega * CUBE * e / (1.0 - e**2) ** 2
    return stiffness, 0.5 * math.pi * CUBE / (1.0 - e**2) ** 1.5


def test_the_figures_of_the_known_damper() -> None:
    stiffness, damping = centred_orbit(0.5)
    assert stiffness == pytest.approx(1.69362e8, rel=1e-5)
    assert damping == pytest.approx(118284.0, rel=1e-5)


@pytest.mark.parametrize("e", [0.05, 0.3, 0.5, 0.8, 0.95])
def test_a_centred_orbit_in_a_short_film_has_the_stiffness_and_damping_of_the_closed_form(e: float) -> None:
    """Wherever the shell is on its circle."""
    films = system(damped()).films
    for angle in (0.0, 1.1, 4.0):
        along = np.array([math.cos(angle), math.sin(angle)])
        across = np.array([-along[1], along[0]])
        force = films.force(0, e * CLEARANCE * along, OMEGA * e * CLEARANCE * across, 0.0).force
        stiffness, damping = -force @ along / (e * CLEARANCE), -force @ across / (e * CLEARANCE * OMEGA)
        np.testing.assert_allclose((stiffness, damping), centred_orbit(e), rtol=1e-9)


@pytest.mark.parametrize("share", [1.0, 0.2])
def test_sealed_ends_multiply_the_closed_form_of_a_short_film(share: float) -> None:
    e, films = 0.5, system(damped(ends={"sealed": share})).films
    found = films.force(0, np.array([e * CLEARANCE, 0.0]), np.array([0.0, OMEGA * e * CLEARANCE]), 0.0)
    expected = (3.0 / share - 2.0) * np.array(centred_orbit(e))
    np.testing.assert_allclose(found.force / (-e * CLEARANCE * np.array([1.0, OMEGA])), expected, rtol=1e-9)


def test_the_largest_pressure_of_a_centred_orbit() -> None:
    """In the middle of the film behind its narrowest gap: 3/2 eta omega (L/c)^2 e sin(theta) / (1 + e cos(theta))^3."""
    e, theta = 0.5, np.linspace(0.0, 2.0 * math.pi, 200001)
    scale = 12.0 * VISCOSITY * (0.5 * DIAMETER / CLEARANCE) ** 2
    slenderness = (WIDTH / (0.5 * DIAMETER)) ** 2
    # the scale of pressures is that of velocities over the clearance; the shell moves across the line of centres
    pressure = scale * short_pressure(theta, [0.5], e, 0.0, OMEGA * e, slenderness, 0.0)
    expected = 1.5 * VISCOSITY * OMEGA * (WIDTH / CLEARANCE) ** 2 * e * np.sin(theta) / (1.0 + e * np.cos(theta)) ** 3
    assert pressure.max() == pytest.approx(expected.max(), rel=1e-9)
    assert pressure.max() == pytest.approx(10.248e6, rel=1e-4)


def test_a_full_film_of_finite_length_in_its_centre() -> None:
    """C = 12 pi eta L R^3 / c^3 (1 - tanh(L/D) / (L/D)): tanh along the axis, a cosine around."""
    films = system(damped({"theory": "finite", "cavitation": "sommerfeld"})).films
    ratio = WIDTH / DIAMETER
    closed = 12.0 * math.pi * VISCOSITY * WIDTH * (0.5 * DIAMETER / CLEARANCE) ** 3 * (1.0 - math.tanh(ratio) / ratio)
    found = films.force(0, np.zeros(2), np.array([0.01, 0.0]), 0.0).force / -0.01
    assert found[0] == pytest.approx(closed, rel=2e-6)
    assert abs(found[1]) < 1e-9 * closed


def orbit(omega: float) -> tuple[float, complex]:
    """Eccentricity of the shell and motion in m of the rotor, both on circles around the centre at one speed."""
    bearing = K + 1j * omega * C

    def motion(e: float) -> tuple[complex, complex]:
        stiffness, damping = centred_orbit(e, omega)
        carried = SPRING + stiffness + 1j * omega * damping - omega**2 * SHELL
        shell_over_rotor = bearing / (bearing + carried)
        rotor = U * omega**2 / (-(omega**2) * M + 2.0 * bearing * (1.0 - shell_over_rotor))
        return rotor, rotor * shell_over_rotor

    found = float(brentq(lambda e: abs(motion(e)[1]) / CLEARANCE - e, 1e-6, 0.999, xtol=1e-13))
    return found, motion(found)[0]


def test_a_run_settles_on_the_circle_of_the_closed_form(tmp_path: Path) -> None:
    """Rotor and shell with the unbalance at a constant speed; the film alone makes them a nonlinear equation."""
    run = runup(damped(settings=("accuracy.tolerance=1e-7",)), tmp_path / "run.h5")
    eccentricity, rotor = orbit(OMEGA)
    assert eccentricity > 0.2
    late = run["time_s"] > 0.9 * run.t_end_s
    np.testing.assert_allclose(run["eccentricity_damper"][late], eccentricity, rtol=1e-4)
    np.testing.assert_allclose(np.hypot(run["journal_x_m"], run["journal_y_m"])[late], abs(rotor), rtol=1e-4)
    np.testing.assert_allclose(np.hypot(run["shell_x_m"], run["shell_y_m"])[late], eccentricity * CLEARANCE, rtol=1e-4)


BISTABLE = """
rotor = { kind = "jeffcott", mass = "20 kg", journal_mass = "2 kg", shaft_stiffness = "2e7 N/m", unbalance = "1 kg*mm",
          external_damping = "20 N*s/m", shaft_damping = "1 N*s/m", gravity = "0 m/s^2" }
oil = { viscosity = "1 mPa*s", density = "850 kg/m^3" }
film = { theory = "short" }
speed = { from = "95 Hz", to = "165 Hz", duration = "20 s", hold = "0.2 s" }
output = { step = "1e-3 s" }
[bearing]
kind = "coefficients"
stiffness = "5e7 N/m"
damping = "500 N*s/m"
damper = { width = "20 mm", diameter = "90 mm", clearance = "90 um", mass = "1 kg", spring = "1e6 N/m" }
""".replace(",\n          ", ", ")


def circles(speed_Hz: float) -> list[float]:
    """All eccentricities of the shell of BISTABLE on a circle around the centre, ascending."""
    w, cube = 2.0 * math.pi * speed_Hz, 1e-3 * 0.045 * (20e-3 / 90e-6) ** 3
    e = np.linspace(1e-3, 0.995, 20001)
    stiffness, damping = 2.0 * w * cube * e / (1.0 - e**2) ** 2, 0.5 * math.pi * cube / (1.0 - e**2) ** 1.5
    carried, bearing = 2.0 * (1e6 + stiffness + 1j * w * damping - w**2), 2.0 * (5e7 + 1j * w * 500.0)
    shaft, journal = 2e7 + 1j * w, -2.0 * w**2 + bearing * carried / (bearing + carried)
    disk = 1e-3 * w**2 / (-20.0 * w**2 + 20j * w + shaft * journal / (shaft + journal))
    shell = disk * shaft / (shaft + journal) * bearing / (bearing + carried)
    left = np.abs(shell) / 90e-6 - e
    return [float(each) for each in 0.5 * (e[1:] + e[:-1])[np.diff(np.sign(left)) != 0]]


def test_the_jumps_of_a_damper_that_stiffens_are_the_folds_of_the_closed_form(tmp_path: Path) -> None:
    """Up, the shell stays on the large circle until that ends; down, on the small one. In between there are three."""
    run = rundown(load_case_text(BISTABLE), tmp_path / "run.h5")
    assert run.status == "finished"
    time, speed, found = run["time_s"], run["speed_Hz"], run["eccentricity_damper"]
    folds = [speed_Hz for speed_Hz in np.arange(95.0, 165.0, 0.25) if len(circles(speed_Hz)) == 3]
    lower, upper = folds[0], folds[-1]
    assert upper - lower > 25.0
    up, down = time < 20.0, time > 20.2
    for speed_Hz in (lower + 8.0, upper - 8.0):
        small, _, large = circles(speed_Hz)
        for way, expected in ((up, large), (down, small)):
            near = way & (np.abs(speed - speed_Hz) < 0.2)
            assert found[near].mean() == pytest.approx(expected, rel=0.02)
    jump_down = speed[up][np.argmax((found < 0.6)[up] & (speed > lower)[up])]
    jump_up = speed[down][np.argmax((found > 0.75)[down])]
    assert upper - 0.5 < jump_down < 1.03 * upper  # not before the circle ends, and after it has had time to leave it
    assert 0.97 * lower < jump_up < lower + 0.5


def fold(three: float, one: float) -> float:
    """The speed in Hz at which the number of circles changes from three to one."""
    while abs(one - three) > 1e-4:
        middle = 0.5 * (one + three)
        three, one = (middle, one) if len(circles(middle)) == 3 else (three, middle)
    return three


def test_the_branch_of_limit_cycles_with_unbalance_turns_back_in_the_folds_of_the_closed_form() -> None:
    """Of a film half of which cavitates: stable before the one fold and behind the other, unstable in between."""
    found = limit_cycles(load_case_text(BISTABLE)).synchronous
    places = [number for number, point in enumerate(found) if point.kind == "fold"]
    speeds = [found[number].speed_Hz for number in places]
    np.testing.assert_allclose(speeds, [fold(110.0, 95.0), fold(140.0, 150.0)], rtol=1e-4)
    small, between, large = found[: places[0]], found[places[0] + 1 : places[1]], found[places[1] + 1 :]
    assert all(point.stable for point in (*small, *large))
    assert not any(point.stable for point in between)
    for point in (small[-3], between[10], large[-1]):
        assert np.abs(np.array(circles(point.speed_Hz)) - point.eccentricity_max[0]).min() < 1e-4


FULL = ("oil.ambient_pressure=3 bar", "oil.cavitation_pressure=1 bar")  # no part of the film cavitates at rest


@pytest.mark.parametrize("settings", [FULL, ("film.cavitation=sommerfeld",)], ids=["pressurised", "sommerfeld"])
def test_eigenvalues_and_response_of_a_rotor_in_full_dampers_are_the_closed_form(settings: tuple[str, ...]) -> None:
    """In the centre, with twice the damping of half a film: film beside spring, and both in series with the bearing."""
    case, full = damped(settings=settings), math.pi * CUBE
    bearing, own = np.array([2 * C, 2 * K]), np.array([2 * SHELL, 2 * full, 2 * SPRING])
    both = np.polymul(np.polyadd([M, 0, 0], bearing), np.polyadd(own, bearing))
    expected = np.roots(np.polysub(both, np.polymul(bearing, bearing)))
    found = stability(case, [80.0]).points[0].eigenvalues
    assert len(found) == 8
    for value in expected:
        assert np.sum(np.abs(found - value) < 1e-9 * abs(value)) == 2  # of both directions
    oscillating = [mode.frequency_Hz for mode in damped_modes(case, 80.0).modes]
    assert max(oscillating) == pytest.approx(max(expected.imag) / (2 * math.pi), rel=1e-9)
    answer = response(case, [90.0, 310.0])
    s = 2j * math.pi * answer.speeds_Hz
    given, carried = 2 * (K + s * C), 2 * (SPRING + s * full + s**2 * SHELL)
    rotor = -(s**2) * U / (M * s**2 + given * carried / (given + carried))
    np.testing.assert_allclose(answer.motion[:, answer.points.index("journal"), 1], rotor, rtol=1e-9)


def test_half_a_film_in_its_centre_has_half_the_damping() -> None:
    (point,) = stability(damped(), [80.0]).points
    np.testing.assert_allclose(point.films[0].damping, 0.5 * math.pi * CUBE * np.eye(2), atol=1e-5 * CUBE)
    np.testing.assert_allclose(point.films[0].stiffness, 0.0, atol=1e-9 * CUBE)


def test_a_damper_stands_on_a_support_in_series() -> None:
    """Rotor, bearing, shell, damper, support and ground follow each other."""
    given = {"mass": "4 kg", "stiffness": "3e7 N/m", "damping": "100 N*s/m"}
    answer = response(damped(settings=FULL).with_settings({"bearing.support": given}), [90.0, 310.0])
    s = 2j * math.pi * answer.speeds_Hz
    film, bearing = 2 * (SPRING + s * math.pi * CUBE), 2 * (K + s * C)
    seat = 2 * (3e7 + 100.0 * s + 4.0 * s**2)
    shell = 2 * SHELL * s**2 + film * seat / (film + seat)
    rotor = -(s**2) * U / (M * s**2 + bearing * shell / (bearing + shell))
    np.testing.assert_allclose(answer.motion[:, answer.points.index("journal"), 1], rotor, rtol=1e-9)
    assert answer.points == ("journal", "shell", "support")


SEMI_FLOATING = """
rotor = { kind = "rigid", mass = "2 kg", unbalance = "40 g*mm" }
oil = { viscosity = "12 mPa*s", density = "830 kg/m^3" }
film = { theory = "short" }
speed = { from = "100 Hz", to = "120 Hz", duration = "30 ms" }
"""
INNER = 'width = "20 mm"\ndiameter = "25 mm"\nclearance = "30 um"\n'
OUTER = 'width = "18 mm"\ndiameter = "35 mm"\nclearance = "60 um"\n'
RING = f"""[bearing]
kind = "floating-ring"
ring = {{ mass = "40 g", inertia = "5 kg*mm^2", spin = "blocked" }}
[bearing.inner]
{INNER}[bearing.outer]
{OUTER}"""
IN_DAMPER = f"""[bearing]
kind = "single-film"
{INNER}[bearing.damper]
mass = "40 g"
{OUTER}"""


@pytest.mark.parametrize(
    "settings",
    [pytest.param((), id="short"), pytest.param(("film.theory=finite",), id="finite", marks=pytest.mark.nightly)],
)
def test_a_semi_floating_ring_is_a_shell_in_a_damper_without_a_spring(
    settings: tuple[str, ...], tmp_path: Path
) -> None:
    """To the last digit: the same bodies in the same films."""
    ring, shell = (load_case_text(SEMI_FLOATING + part, settings) for part in (RING, IN_DAMPER))
    np.testing.assert_array_equal(make_rotor(ring).mass, make_rotor(shell).mass)
    runs = [runup(case, tmp_path / f"{number}.h5") for number, case in enumerate((ring, shell))]
    pairs = {"eccentricity_inner": "eccentricity", "eccentricity_outer": "eccentricity_damper",
             "journal_x_m": "journal_x_m", "ring_x_m": "shell_x_m", "ring_y_m": "shell_y_m"}  # fmt: skip
    for name, other in pairs.items():
        np.testing.assert_array_equal(runs[0][name], runs[1][other], err_msg=name)
    assert np.ptp(runs[0]["ring_x_m"]) > 0.0


LAWS = {
    "reynolds": {}, "penalty": {}, "peeken": {}, "elrod": {}, "two-phase": {"steepness": 0.9}, "sommerfeld": {},
}  # fmt: skip


@pytest.mark.parametrize("law", LAWS)
def test_the_damper_may_have_any_cavitation_law_of_its_own(law: str, tmp_path: Path) -> None:
    """Fed by a groove: a run-up of the unbalance finishes with an orbit within the clearance."""
    supply = {"kind": "circumferential-groove", "pressure": "2 bar"}
    film: dict[str, object] = {law: LAWS[law]} if LAWS[law] else {}
    case = damped(
        {"theory": "auto", **film}, ("accuracy.mesh=[12, 16]", "speed.duration=6 ms"), cavitation=law, supply=supply
    )
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    assert 0.01 < run["eccentricity_damper"].max() < 0.9


def test_the_spring_carries_the_weight() -> None:
    """The film at rest carries nothing; the shell sinks by the weight of half the rotor and of itself."""
    heavy = damped(settings=(*FULL, "rotor.gravity=9.81 m/s^2"))
    (point,) = stability(heavy, [80.0]).points
    sag = 9.81 * (0.5 * M + SHELL) / SPRING
    np.testing.assert_allclose(point.films[0].displacement, [0.0, -sag / CLEARANCE], atol=1e-9)
    assert findings(heavy).films[0].load == pytest.approx(9.81 * (0.5 * M + SHELL), rel=1e-9)


@pytest.mark.parametrize("inner", ["coefficients", "film"])
def test_a_spring_that_is_set_for_the_weight_holds_the_shell_in_the_centre(inner: str) -> None:
    """The rotor sinks in its bearings alone, and half a film has the damping of its centre."""
    case = damped(settings=("rotor.gravity=9.81 m/s^2", "bearing.damper.centred=true"))
    if inner == "film":
        case = load_case_text(SEMI_FLOATING + IN_DAMPER + 'spring = "1e6 N/m"\ncentred = true\n')
    (point,) = stability(case, [80.0]).points
    np.testing.assert_allclose(point.films[-1].displacement, 0.0, atol=1e-9)
    if inner == "coefficients":
        np.testing.assert_allclose(point.films[0].damping, 0.5 * math.pi * CUBE * np.eye(2), atol=1e-5 * CUBE)
        system_ = system(case)
        held = np.linalg.solve(system_.rotor.stiffness, system_.rotor.static_load)
        place = dict(system_.rotor.points)
        assert (place["journal"] @ held)[1] == pytest.approx(-9.81 * 0.5 * M / K, rel=1e-9)
        assert abs((place["shell"] @ held)[1]) < 1e-18
    assert "in the centre" in next(each.reason for each in make_plan(case).decisions if each.choice == "damper")


def test_the_preset_of_a_loaded_damper_on_a_support_leaves_the_support_its_weight() -> None:
    support = {"mass": "4 kg", "stiffness": "3e7 N/m"}
    case = damped(settings=("rotor.gravity=9.81 m/s^2", "bearing.damper.centred=true"))
    rotor = make_rotor(case.with_settings({"bearing.support": support}))
    place, rest = dict(rotor.points), np.linalg.solve(rotor.stiffness, rotor.static_load)
    sunk = -9.81 * (0.5 * M + SHELL + 4.0) / 3e7
    np.testing.assert_allclose([(place[name] @ rest)[1] for name in ("shell", "support")], sunk, rtol=1e-9)


def test_a_damper_without_a_spring_sinks_under_a_weight() -> None:
    case = load_case_text(SEMI_FLOATING + IN_DAMPER)
    (found,) = faults(case, STABILITY)
    assert found.key == "bearing.damper.spring"
    assert "sinks" in found.problem
    told = {each.choice: each for each in make_plan(case).decisions}
    assert "sinks" in told["damper"].reason
    assert not faults(case.with_settings("rotor.gravity=0 m/s^2"), STABILITY)


def test_sketches_show_the_damper() -> None:
    case = damped()
    assert rotor_sketch(case)[0].count('class="ground"') == 4
    films = film_sketches(case)
    assert [name for name, _ in films] == ["damper"]
    assert "arrow" not in films[0][1]  # its shell does not turn
    plain = load_case_text(SEMI_FLOATING + IN_DAMPER)
    assert rotor_sketch(plain)[0].count('class="ring"') == rotor_sketch(load_case_text(SEMI_FLOATING + RING))[0].count(
        'class="ring"'
    )


def test_the_shipped_damper_takes_the_resonance_away(tmp_path: Path) -> None:
    """The same machine with a hundredth of the oil's viscosity swings more than four times as far, at the frequency of
    rotor and springs, sqrt(k / m) of 22 kg and two shells on shaft and springs in series."""
    cases = [load_case("squeeze-film-damper", [f"bearing.damper.viscosity={eta} mPa*s"]) for eta in (10.0, 0.1)]
    runs = [runup(case, tmp_path / f"{number}.h5") for number, case in enumerate(cases)]
    swings = [np.hypot(*(run[f"disk_{axis}_m"] - run[f"disk_{axis}_m"].mean() for axis in "xy")).max() for run in runs]
    assert swings[0] < 30e-6
    assert swings[1] > 4.0 * swings[0]
    natural = math.sqrt(1.0 / (1.0 / 2e7 + 1.0 / 1e7 + 1.0 / 1e8) / 22.0) / (2.0 * math.pi)
    (passed,) = [event for event in runs[0].events if event["kind"] == "critical-speed"]
    assert natural < passed["speed_Hz"] < 1.5 * natural  # the damping stiffens it


def test_points_of_a_run_in_dampers_are_found_and_the_journal_moves_through_both_films(tmp_path: Path) -> None:
    rolling = runup(load_case("squeeze-film-damper", ["speed.duration=20 ms"]), tmp_path / "rolling.h5")
    plain = runup(load_case_text(SEMI_FLOATING + IN_DAMPER), tmp_path / "plain.h5")
    assert [point_of(run, "shell") for run in (rolling, plain)] == ["shell", "shell"]
    assert bearing_clearance(rolling) == pytest.approx(90e-6)
    assert bearing_clearance(plain) == pytest.approx(30e-6 + 60e-6)
