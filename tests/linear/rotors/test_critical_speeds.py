"""Critical speeds of `response` against closed forms, and against the machine solved densely around them. Shafts in
soft bearings at their ends: the reduction against the rotor with all its modes."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.linear.modes import own_reduction
from frbcli.rotor.beam import BeamSection
from frbcli.scene.machine.turbocharger import shaft_of

TURN = 2.0 * math.pi
K, M, U = 1e6, 2.0, 1e-6


def rigid(damping: float, top: float = 300.0, stiffness: Any = None, **rotor: Any) -> frbcli.Case:
    """A mass on two bearings: w^2 = 2 K / M."""
    bearing = {"kind": "coefficients", "damping": f"{damping!r} N*s/m"}
    bearing["stiffness"] = f"{K} N/m" if stiffness is None else stiffness
    own = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{U} kg*m", "gravity": 0} | rotor
    speed = {"from": "0 Hz", "to": f"{top} Hz", "duration": "1 s"}
    return case_from_dict({"rotor": own, "bearing": bearing, "speed": speed}, "rigid")


def of_one_mass(ratio: float) -> tuple[float, float, float]:
    """Speed over the natural frequency, amplitude over U / M, and factor of the response r^2 / |1 - r^2 + 2 i z r|."""
    speed = 1.0 / math.sqrt(1.0 - 2.0 * ratio**2)
    height = 1.0 / (2.0 * ratio * math.sqrt(1.0 - ratio**2))
    # r^4 height^-2 2 = (1 - r^2)^2 + 4 z^2 r^2 at the half power
    roots = np.sqrt(np.roots([1.0 - 2.0 / height**2, 4.0 * ratio**2 - 2.0, 1.0]).real)
    return speed, height, speed / float(abs(roots[1] - roots[0]))


@pytest.mark.parametrize("damping", [0.1, 1.0, 30.0, 300.0])
def test_the_peak_of_a_mass_on_springs_is_that_of_the_closed_form(damping: float) -> None:
    natural = math.sqrt(2.0 * K / M)
    ratio = damping / (M * natural)
    speed, height, factor = of_one_mass(ratio)
    (peak,) = frbcli.response(rigid(damping)).critical_speeds
    assert peak.speed_Hz == pytest.approx(speed * natural / TURN, rel=2e-6)
    assert peak.amplitude == pytest.approx(height * U / M, rel=1e-6)
    assert peak.amplification_factor == pytest.approx(factor, rel=1e-4)
    assert peak.logarithmic_decrement == pytest.approx(TURN * ratio / math.sqrt(1.0 - ratio**2), rel=1e-9)
    assert (peak.direction, peak.node) == ("forward", "journal")
    assert 0.0 < peak.speed_uncertainty_Hz < 1e-4 * peak.speed_Hz


def test_a_peak_is_found_from_given_speeds_which_stay_as_they_are() -> None:
    found = frbcli.response(rigid(0.1), [100.0, 150.0, 250.0])
    assert found.speeds_Hz.tolist() == [100.0, 150.0, 250.0]
    assert found.critical_speeds_Hz == pytest.approx([math.sqrt(2.0 * K / M) / TURN], rel=1e-5)
    assert frbcli.response(rigid(0.1), [100.0]).critical_speeds == ()


@pytest.mark.parametrize("inner", [0.0, 0.03])
@pytest.mark.parametrize(("polar", "diametral"), [(0.3, 0.16), (0.05, 0.2)])
def test_an_undamped_overhung_disk_in_stiff_bearings_has_its_forward_whirls_alone(
    inner: float, polar: float, diametral: float
) -> None:
    """Round-off of the stiffest motion is no damping, and excites no backward whirl: the flexibility of a massless
    overhang with its shear has as many critical speeds as I_d - I_p allows, all without a height."""
    span, over, mass = 0.3, 0.25, 15.0
    own = BeamSection(span + over, 0.04, inner, 1.0, 211e9, 0.3)
    bending, shear = own.youngs_modulus * own.second_moment, own.shear_stiffness
    both = over * (2 * span + 3 * over) / (6 * bending) + over / (span * shear)
    tip = over**2 * (span + over) / (3 * bending) + (over**2 / span + over) / shear
    stiffness = np.linalg.inv([[tip, both], [both, (span + 3 * over) / (3 * bending) + 1.0 / (span * shear)]])
    squares = np.linalg.eigvals(np.linalg.solve(np.diag([mass, diametral - polar]), stiffness)).real
    part = {"length": span + over, "diameter": 0.04, "inner_diameter": inner, "density": 1.0, "youngs_modulus": 211e9}
    disk = {"name": "disk", "position": span + over, "mass": mass, "polar_inertia": polar,
            "diametral_inertia": diametral, "unbalance": U}  # fmt: skip
    places = (("a", 0.0), ("b", span))
    found = frbcli.response(
        case_from_dict(
            {
                "rotor": {"kind": "turbocharger", "gravity": 0},
                "shaft": [part],
                "disk": [disk],
                "bearing": [{"kind": "coefficients", "name": n, "position": p, "stiffness": 1e12} for n, p in places],
                "speed": {"from": 0.0, "to": 800.0, "duration": 1.0},
            },
            "overhung",
        )
    ).critical_speeds
    expected = sorted(np.sqrt(squares[squares > 0.0]) / TURN)
    assert [peak.speed_Hz for peak in found] == pytest.approx(expected, rel=2e-5)
    assert {peak.direction for peak in found} == {"forward"}
    assert {(peak.amplitude, peak.amplification_factor) for peak in found} == {(None, None)}


def test_directions_of_unlike_stiffness_have_two_and_close_ones_are_told_apart() -> None:
    """To and fro in a line each: no sense of whirl."""
    stiffness = [[f"{K} N/m", "0 N/m"], ["0 N/m", f"{1.01 * K} N/m"]]
    expected = [math.sqrt(2.0 * each / M) / TURN for each in (K, 1.01 * K)]
    for damping in (0.0, 0.1):
        found = frbcli.response(rigid(damping, stiffness=stiffness)).critical_speeds
        assert [peak.speed_Hz for peak in found] == pytest.approx(expected, rel=1e-5)
        assert [peak.mode for peak in found] == [1, 2]
        assert {peak.direction for peak in found} == {"mixed"}


def test_a_rotor_that_turns_about_its_centre_of_mass_has_no_critical_speed() -> None:
    """Far above its natural frequency, where the amplitude is U / M but for round-off."""
    case = rigid(1.0)
    assert frbcli.response(case, np.linspace(3000.0, 9000.0, 40).tolist()).critical_speeds == ()


def two_disks(damping: float, stiffness: tuple[float, float] = (1e6, 0.8e6)) -> frbcli.Case:
    """A shaft of 1.5 m with two disks in soft bearings of unlike stiffness."""
    k = [[f"{stiffness[0]} N/m", "0 N/m"], ["0 N/m", f"{stiffness[1]} N/m"]]
    disk = {"mass": "32.59 kg", "polar_inertia": "0.3296 kg*m^2", "diametral_inertia": "0.1781 kg*m^2"}
    return case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "modes": 16, "gravity": 0},
            "shaft": [{"length": "1.5 m", "diameter": "50 mm", "density": "7810 kg/m^3", "youngs_modulus": "211 GPa"}],
            "disk": [
                {"name": "one", "position": "0.5 m", "unbalance": "10 g*mm", **disk},
                {"name": "two", "position": "1 m", **disk},
            ],
            "bearing": [
                {"kind": "coefficients", "name": name, "position": place, "stiffness": k,
                 "damping": f"{damping} N*s/m"} for name, place in (("a", "0 m"), ("b", "1.5 m"))
            ],
            "speed": {"from": "0 Hz", "to": "150 Hz", "duration": "1 s"},
        },
        "two disks",
    )  # fmt: skip


def test_undamped_critical_speeds_are_where_a_whirl_has_the_frequency_of_the_rotor() -> None:
    found = frbcli.response(two_disks(0.0)).critical_speeds
    assert [round(peak.speed_Hz) for peak in found] == [15, 15, 43, 48, 101, 138]
    assert [peak.mode for peak in found] == [1, 2, 3, 4, 5, 6]
    assert [peak.direction for peak in found] == ["backward", "forward"] * 3
    for peak in found:
        modes = frbcli.damped_modes(two_disks(0.0), peak.speed_Hz).modes
        assert min(abs(mode.frequency_Hz / peak.speed_Hz - 1.0) for mode in modes) < 1e-9
        assert peak.amplitude is None


def test_isotropic_bearings_leave_backward_whirls_at_rest() -> None:
    found = frbcli.response(two_disks(0.0, (1e6, 1e6))).critical_speeds
    assert {peak.direction for peak in found} == {"forward"}
    assert len(found) == 3


def test_every_peak_is_the_highest_speed_around_it() -> None:
    """The same machine at many speeds beside each: 1e-4 in speed, 1e-3 in height."""
    case = two_disks(100.0)
    found = frbcli.response(case)
    assert len(found.critical_speeds) >= 5
    for peak in found.critical_speeds:
        point = found.points.index(peak.node)
        near = peak.speed_Hz * (1.0 + np.linspace(-2e-3, 2e-3, 81))
        amplitude = frbcli.response(case, near.tolist()).amplitude[:, point]
        top = int(np.argmax(amplitude))
        assert near[top] == pytest.approx(peak.speed_Hz, rel=1e-4)
        assert peak.amplitude == pytest.approx(amplitude[top], rel=1e-3)
        assert float(found.amplitude[:, point].max()) >= peak.amplitude * (1.0 - 1e-6)  # the curve has its peaks


def test_peaks_on_films_are_where_the_machine_solved_there_has_them() -> None:
    case = frbcli.load_case("jeffcott", ["film.theory=short", "rotor.unbalance=0.1 g*mm"])
    found = frbcli.response(case)
    for peak in found.critical_speeds:
        point = found.points.index(peak.node)
        near = peak.speed_Hz * (1.0 + np.linspace(-1e-2, 1e-2, 21))
        amplitude = frbcli.response(case, near.tolist()).amplitude[:, point]
        fit = np.polynomial.Polynomial.fit(near, amplitude, 4)
        tops = [root.real for root in fit.deriv().roots() if abs(root.imag) < 1e-9 and near[0] < root.real < near[-1]]
        top = max(tops, key=fit)
        assert peak.speed_Hz == pytest.approx(top, rel=2e-4)
        assert peak.amplitude == pytest.approx(float(fit(top)), rel=1e-3)


def test_speeds_of_operation_have_a_margin(frb: Frb, tmp_path: Path) -> None:
    path = tmp_path / "mass.toml"
    path.write_text(
        f"""
[rotor]
kind = "rigid"
mass = "{M} kg"
unbalance = "1 g*mm"
[[bearing]]
kind = "coefficients"
stiffness = "{K} N/m"
damping = "10 N*s/m"
[speed]
from = "0 Hz"
to = "300 Hz"
duration = "1 s"
""",
        encoding="utf-8",
    )
    critical = 60.0 * math.sqrt(2.0 * K / M) / TURN  # rpm
    for given, margin in (
        ("12000..15000 rpm", 1.0 - critical / 12000.0), ("100 Hz..120 Hz", critical / 7200.0 - 1.0),
        ("9000 rpm..200 Hz", 0.0),
    ):  # fmt: skip
        document = frb("response", str(path), "--operating", given, "--no-picture", "--json").document
        (peak,) = document["critical_speeds"]
        assert set(peak) == {
            "speed_Hz", "speed_uncertainty_Hz", "mode", "direction", "node", "amplitude_m", "amplification_factor",
            "separation_margin", "logarithmic_decrement",
        }  # fmt: skip
        assert document["critical_speeds_Hz"] == [peak["speed_Hz"]]
        assert peak["separation_margin"] == pytest.approx(margin, abs=1e-4)
    assert "Critical speeds" in frb("response", str(path), "--operating", "12000..15000 rpm", "--no-picture").out
    said = frb("response", str(path), "--operating", "15000..12000 rpm", "--no-picture", code=2)
    assert "does not ascend" in said.err


SPEEDS = [2.0, 80.0, 160.0]  # peaks between them are found
MANY = 48  # free modes


def shaft(stiffness: float, damping: float, **rotor: Any) -> frbcli.Case:
    """Two disks on a shaft of 1.5 m in bearings at its ends."""
    disk = {"mass": "32.59 kg", "polar_inertia": "0.3296 kg*m^2", "diametral_inertia": "0.1781 kg*m^2"}
    bearing = {"kind": "coefficients", "stiffness": f"{stiffness} N/m", "damping": f"{damping} N*s/m"}
    return case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "gravity": 0, **rotor},
            "shaft": [{"length": "1.5 m", "diameter": "50 mm", "density": "7810 kg/m^3"}],
            "disk": [{"name": "one", "position": "0.5 m", "unbalance": "10 g*mm", **disk},
                     {"name": "two", "position": "1 m", **disk}],
            "bearing": [{"name": name, "position": place, **bearing} for name, place in (("a", "0 m"), ("b", "1.5 m"))],
            "speed": {"from": "0 Hz", "to": "160 Hz", "duration": "1 s"},
        },
        "shaft",
    )  # fmt: skip


@pytest.mark.parametrize("stiffness", [1e6, 1e7])
def test_the_default_reduction_has_the_peaks_of_all_modes(stiffness: float) -> None:
    """accuracy.target is 1e-3 by default: of speeds and of heights."""
    damping = 1e-4 * stiffness
    own, whole = (frbcli.response(shaft(stiffness, damping, **more), SPEEDS) for more in ({}, {"modes": MANY}))
    assert len(own.critical_speeds) == len(whole.critical_speeds) >= 2
    for peak, other in zip(own.critical_speeds, whole.critical_speeds, strict=True):
        assert peak.speed_Hz == pytest.approx(other.speed_Hz, rel=1e-3)
        assert peak.amplitude == pytest.approx(other.amplitude, rel=2e-3)
    assert shaft_of(shaft(stiffness, damping)).freedoms <= 30


def test_six_free_modes_are_as_far_off_as_is_said() -> None:
    stiffness, damping = 1e7, 1e3
    few, whole = (frbcli.response(shaft(stiffness, damping, modes=count), SPEEDS) for count in (6, MANY))
    told = shaft_of(shaft(stiffness, damping, modes=6)).reduction
    assert told is not None
    off = [
        (abs(a.speed_Hz / b.speed_Hz - 1.0), abs((a.amplitude or 0.0) / (b.amplitude or 1.0) - 1.0))
        for a, b in zip(few.critical_speeds, whole.critical_speeds, strict=False)
    ]
    speeds, heights = (max(each) for each in zip(*off, strict=True))
    assert 1e-3 < speeds <= 1.1 * told.frequency
    assert 0.01 < heights <= 1.1 * told.amplitude


def test_a_smaller_target_keeps_more_modes() -> None:
    counts = []
    for target in (1e-1, 1e-3, 1e-4):
        found = shaft_of(shaft(1e6, 100.0).with_settings(f"accuracy.target = {target}"))
        assert found.reduction is not None
        assert max(found.reduction.frequency, found.reduction.amplitude) <= target
        counts.append(len(found.reduction.modes.frequencies))
    assert counts[0] < counts[1] <= counts[2] < 30


def test_static_modes_leave_no_flexibility_between_the_bearings() -> None:
    free = shaft_of(shaft(1e6, 100.0)).free()
    missing = free.reduction_error(np.full(2, 1e6), 100.0).missing_flexibility
    bent = free.held[:, 2:] / free.modes.frequencies[2:]
    assert np.abs(missing).max() < 1e-9 * np.abs(bent @ bent.T).max()


@pytest.mark.parametrize("command", ["check", "response", "stability"])
def test_every_command_says_what_is_left_out(command: str, frb: Frb, tmp_path: Path) -> None:
    path = tmp_path / "shaft.toml"
    path.write_text(
        """
[rotor]
kind = "turbocharger"
modes = 6
[[shaft]]
length = "1.5 m"
diameter = "50 mm"
[[disk]]
name = "one"
position = "0.5 m"
mass = "30 kg"
unbalance = "10 g*mm"
[[bearing]]
kind = "coefficients"
name = "a"
position = "0 m"
stiffness = "1e6 N/m"
damping = "100 N*s/m"
[[bearing]]
kind = "coefficients"
name = "b"
position = "1.5 m"
stiffness = "1e6 N/m"
damping = "100 N*s/m"
[speed]
from = "0 Hz"
to = "100 Hz"
duration = "1 s"
""",
        encoding="utf-8",
    )
    plain = [] if command == "check" else ["--no-picture"]
    told = " ".join(frb(command, str(path), *plain).out.split())
    assert "Reduction of the shaft to 6 free modes of each plane" in told
    assert "heights of peaks by at most" in told
    assert ("on bearings of any stiffness" in told) == (command == "check")
    assert ("on the stiffness of its own bearings" in told) == (command != "check")
    document = frb(command, str(path), *plain, "--json").document
    found = document["findings"]["reduction"] if command == "check" else document["reduction"]
    assert found["free_modes"] == 6
    assert found["amplitude_relative"] > found["frequency_relative"]
    assert found["amplitude_relative"] > 1e-3
    anything = shaft_of(frbcli.load_case(str(path))).reduction
    assert anything is not None
    assert (found["amplitude_relative"] < anything.amplitude) == (command != "check")


def test_the_own_bearings_bound_the_error_of_six_modes() -> None:
    """The change is stated on the case's own stiffness, and the peaks of the rotor with many modes are within it."""
    stiffness, damping = 1e7, 1e3
    few, whole = (frbcli.response(shaft(stiffness, damping, modes=count), SPEEDS) for count in (6, MANY))
    told = own_reduction(few.case, few.resting)
    assert told is not None
    for a, b in zip(few.critical_speeds, whole.critical_speeds, strict=False):
        assert abs(a.speed_Hz / b.speed_Hz - 1.0) <= 1.1 * told.frequency
        assert abs((a.amplitude or 0.0) / (b.amplitude or 1.0) - 1.0) <= 1.1 * told.amplitude
