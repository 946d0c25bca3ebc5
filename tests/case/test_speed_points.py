"""The rotor speed through points, or as it was measured: what follows from them, runs, a tacho, and faults."""

import math
from pathlib import Path

import numpy as np
import pytest

import frbcli
from frbcli.analysis.measured import Measurement, measured_run
from frbcli.analysis.order_tracking import order_track
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import case_from_dict, load_case_text
from frbcli.errors import InputError
from frbcli.runs.run import rundown, runup
from frbcli.scene.course import default_speeds
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.studies.accuracy import accuracy
from frbcli.studies.warm_up import moment_of_run

MACHINE = {
    "rotor": {"kind": "rigid", "mass": "6 kg", "gravity": 0.0, "unbalance": "3 g*mm"},
    "bearing": {"kind": "coefficients", "stiffness": "1e6 N/m", "damping": "300 N*s/m"},
}
POINTS = [["0 s", "0 Hz"], ["0.1 s", "1800 rpm"], ["0.2 s", "30 Hz"], ["300 ms", "10 Hz"]]


def machine(folder: Path | str = ".", **speed: object) -> frbcli.Case:
    return case_from_dict(MACHINE | {"speed": speed}, "points", folder=folder)


def test_the_speed_goes_through_its_points() -> None:
    """Range and duration follow; the angle is the area under the lines."""
    case = machine(points=POINTS)
    assert (case.speed.start, case.speed.end, case.speed.duration) == (0.0, 30.0, 0.3)
    profile = run_up_profile(case)
    between = profile.speed(np.array([0.05, 0.15, 0.25])) / (2.0 * math.pi)
    np.testing.assert_allclose(between, [15.0, 30.0, 20.0])
    assert profile.angles[-1] == pytest.approx(2.0 * math.pi * (1.5 + 3.0 + 2.0), rel=1e-12)
    assert load_case_text(case.source_text, name="points") == case
    assert not [value.key for value in values(case) if value.bare and value.key.startswith("speed")]
    assert case.with_settings("rotor.unbalance=1 g*mm").speed == case.speed
    assert default_speeds(case)[-1] == 30.0
    moment = moment_of_run(case)
    assert moment.speed.times == ()
    assert moment.speed.start == moment.speed.end == 30.0


def test_a_ramp_as_two_points_is_the_ramp(tmp_path: Path) -> None:
    ramp = runup(machine(**{"from": "5 Hz", "to": "25 Hz", "duration": "0.2 s"}), tmp_path / "ramp.h5")
    points = runup(machine(points=[["0 s", "5 Hz"], ["0.2 s", "25 Hz"]]), tmp_path / "points.h5")
    for name in ramp.signals:
        np.testing.assert_array_equal(points[name], ramp[name], strict=True)


def test_orders_of_a_run_lie_on_those_of_the_measurement_with_the_tacho(tmp_path: Path) -> None:
    """A machine that speeds up, slows down and speeds up again, measured with four pulses in a revolution: the computed
    synchronous motion follows the same speeds, and its line in spectra is the measured one."""
    time = np.arange(0.0, 2.0, 1e-4)
    speed = 40.0 + 2.0 * np.sin(3.0 * time) + time
    angle = 2.0 * math.pi * np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * 1e-4)])
    tacho = (np.sin(4.0 * angle) > 0.9).astype(float)
    columns = np.column_stack([time, 1e-5 * np.cos(angle), 1e-5 * np.sin(angle), tacho])
    np.savetxt(tmp_path / "measured.csv", columns, delimiter=",", header="t,x,y,tacho", comments="", fmt="%.9g")
    case = machine(tmp_path, file="measured.csv", tacho="tacho", pulses=4)
    assert len(case.speed.times) < 2.2 * angle[-1] / (2.0 * math.pi)  # a point for each revolution
    run = runup(case, tmp_path / "run.h5")
    assert run.t_end_s == pytest.approx(time[-1])
    inside = (run["time_s"] > 0.2) & (run["time_s"] < 1.8)
    there = np.interp(run["time_s"][inside], time, speed)
    # The speed of a tacho is the mean over T = 8 revolutions, 0.2 s: it is off by T^2 / 24 of the second derivative,
    # 0.03 Hz, and by a sample of 0.1 ms in T, 0.02 Hz.
    np.testing.assert_allclose(run["speed_Hz"][inside], there, rtol=0.0, atol=0.05)
    given = Measurement("x", clearance=35e-6, y="y", time="t", tacho="tacho", pulses=4, unit_m=1.0)
    measured = measured_run(tmp_path / "measured.csv", given)
    mine, other = (order_track(each, 1.0, "journal") for each in (run, measured))
    both = np.interp(mine.time_s, other.time_s, other.speed_Hz)
    within = (mine.time_s > 0.3) & (mine.time_s < 1.7)
    # Both begin and end of T are known to a sample: by 0.04 Hz the speed jitters from pulse to pulse.
    np.testing.assert_allclose(mine.speed_Hz[within], both[within], rtol=0.0, atol=0.05)


def test_a_file_of_speeds_has_units(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "speed.csv", [[0.0, 0.0], [100.0, 1800.0], [300.0, 600.0]], delimiter=",",
               header="time [ms],speed [rpm]", comments="")  # fmt: skip
    case = machine(tmp_path, file="speed.csv")
    np.testing.assert_allclose(case.speed.times, (0.0, 0.1, 0.3))
    np.testing.assert_allclose(case.speed.speeds, (0.0, 30.0, 10.0))


def test_what_needs_a_ramp_refuses_points(tmp_path: Path) -> None:
    case = machine(points=POINTS)
    with pytest.raises(InputError, match="how the speed goes down"):
        rundown(case, tmp_path / "run.h5")
    film = frbcli.load_case("jeffcott").with_settings({"speed": {"points": POINTS}})
    with pytest.raises(InputError, match="are no ramp"):
        accuracy(film, until=0.2)
