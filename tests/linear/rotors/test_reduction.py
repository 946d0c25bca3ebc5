"""Shafts in soft bearings at their ends: the reduction against the rotor with all its modes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.cli.main import run as frb
from frbcli.linear.modes import own_reduction
from frbcli.scene.machine.turbocharger import shaft_of

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
def test_every_command_says_what_is_left_out(command: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
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
    assert frb([command, str(path), *plain]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "Reduction of the shaft to 6 free modes of each plane" in told
    assert "heights of peaks by at most" in told
    assert ("on bearings of any stiffness" in told) == (command == "check")
    assert ("on the stiffness of its own bearings" in told) == (command != "check")
    assert frb([command, str(path), *plain, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
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
