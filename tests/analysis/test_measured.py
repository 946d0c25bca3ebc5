"""Measured motions: read from CSV, WAV and MAT, with the spectra and events of the run that they are made of."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from synthetic_run import CLEARANCE, Rotor, signals

from frbcli.analysis.measured import Measurement, measured_run
from frbcli.analysis.order_tracking import order_track
from frbcli.analysis.tacho import MARK
from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.errors import InputError
from frbcli.plot.signals import clearance
from frbcli.plot.waterfall import LevelScale, waterfall_figure
from frbcli.results.measured_columns import unit_in
from frbcli.results.store import Run
from frbcli.runs.run import runup

STEP_s = 2e-4
NOISE = np.random.default_rng(0)


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """A run-up as sensors see it: in um, off the centre, noisy, with a pulse per revolution."""
    found = signals(Rotor(step_s=STEP_s))
    time, speed = found["time_s"], found["speed_Hz"]
    turn = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    x, y = (1e6 * found[f"journal_{axis}_m"] + NOISE.normal(0.0, 0.02, len(time)) for axis in "xy")
    return pd.DataFrame({"t": time, "x": x + 7.0, "y": y - 3.0, "n": speed, "key": 5.0 * (turn % 1.0 < 0.2)})


GIVEN = Measurement("x", CLEARANCE, "y", time="t", speed="n", unit_m=1e-6)


def onset(path: Path, given: Measurement) -> tuple[float, float]:
    event = next(event for event in measured_run(path, given).events if event["kind"] == "onset")
    return float(event["speed_Hz"]), float(event["frequency_ratio"])


def test_a_table_has_the_events_of_the_run(tmp_path: Path, table: pd.DataFrame) -> None:
    """The whirl is half grown at 6.5 s, where the rotor turns with 195 Hz; it begins with 0.47 times that."""
    path = tmp_path / "run.csv"
    path.write_text("# from the test rig\n" + table.to_csv(index=False, sep=";"), encoding="utf-8")
    speed, ratio = onset(path, GIVEN)
    assert 191.0 < speed < 195.0
    assert ratio == pytest.approx(0.47, abs=0.01)
    run = measured_run(path, GIVEN)
    assert run["journal_x_m"].mean() == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(run["journal_y_m"]) == pytest.approx(1e-6 * np.ptp(table["y"]))


def test_the_command_draws_a_measurement(
    tmp_path: Path, table: pd.DataFrame, capsys: pytest.CaptureFixture[str]
) -> None:
    path, picture = tmp_path / "run.csv", tmp_path / "picture.png"
    table.to_csv(path, index=False)
    columns = ["--x", "x", "--y", "y", "--time", "t", "--speed-column", "n", "--clearance", "35 um"]
    assert frb(["waterfall", str(path), *columns, "-o", str(picture), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [event["kind"] for event in document["events"]][-1] == "onset"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert frb(["waterfall", str(path), *columns, "--order", "1,0.5", "-o", str(picture), "--quiet"]) == 0
    one = ["--x", "x", "--rate", "5000", "--speed-at", "100 Hz", "--clearance", "35 um"]
    assert frb(["waterfall", str(path), *one, "-o", str(picture), "--quiet"]) == 0


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path]:
    """A run-up of the Jeffcott rotor through critical speed and onset, and the table that frb exports of it."""
    folder = tmp_path_factory.mktemp("exported")
    settings = ("speed.from=100 Hz", "speed.to=190 Hz", "speed.duration=4 s", "output.step=0.2 ms")
    run = runup(load_case("jeffcott", [*settings, "rotor.unbalance=40 g*mm"]), folder / "run.h5")
    assert frb(["export", str(run.path), "-o", str(folder / "own.csv"), "--quiet"]) == 0
    return run, folder / "own.csv"


def columns_of(point: str) -> list[str]:
    axes = ["--x", f"{point}_x_m", "--y", f"{point}_y_m"]  # in m, as their names say
    return [*axes, "--time", "time_s", "--speed-column", "speed_Hz", "--clearance", "35 um"]


@pytest.mark.parametrize("point", ["journal", "disk"])
def test_a_run_and_its_own_table_have_the_same_events_at_the_same_point(
    point: str, exported: tuple[Run, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """README says so of `frb waterfall`; the critical speed of the journal is not that of the disk."""
    run, path = exported
    close = 1e-5  # Hz: the top of a flat peak follows the root of round-off, sqrt(1e-15) of 180 Hz
    words = ["--measured", str(path), *columns_of(point), "--signal", point, "-o", str(tmp_path / "a.png"), "--json"]
    assert frb(["compare", str(run.path), *words]) == 0
    document = json.loads(capsys.readouterr().out)
    computed, measured = document["events"]["computed"], document["events"]["measured"]
    assert [event["kind"] for event in computed] == ["critical-speed", "onset"]
    for own, other in zip(computed, measured, strict=True):
        assert (own["kind"], own["point"]) == (other["kind"], other["point"]) == (own["kind"], point)
        assert other["t_s"] == pytest.approx(own["t_s"], abs=1e-6)
        assert other["speed_Hz"] == pytest.approx(own["speed_Hz"], abs=close)
        assert other["frequency_Hz"] == pytest.approx(own["frequency_Hz"], rel=1e-6)
    assert frb(["waterfall", str(path), *columns_of(point), "-o", str(tmp_path / "a.png"), "--json"]) == 0
    seen = {event["kind"]: event["speed_Hz"] for event in json.loads(capsys.readouterr().out)["events"]}
    assert seen == pytest.approx({event["kind"]: event["speed_Hz"] for event in computed}, abs=close)
    told = {event["kind"]: event for event in run.events if event["point"] == point}
    assert set(told) == {"disk": {"critical-speed"}, "journal": {"onset"}}[point]
    for kind, event in told.items():  # the run's own events at this point
        assert seen[kind] == pytest.approx(event["speed_Hz"], abs=close)


def test_a_unit_against_the_name_of_an_exported_column_is_refused(exported: tuple[Run, Path]) -> None:
    given = Measurement("journal_x_m", CLEARANCE, time="time_s", speed="speed_Hz", unit_m=1e-6)
    with pytest.raises(InputError, match='says that "journal_x_m" is in m, but --unit is 1e-06 m'):
        measured_run(exported[1], given)
    assert measured_run(exported[1], replace(given, unit_m=None)).signals["journal_x_m"].unit == "m"


def test_a_measurement_of_one_direction_has_no_events_beside_a_run(
    exported: tuple[Run, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run, path = exported
    words = ["--measured", str(path), *(word for word in columns_of("journal") if word not in ("--y", "journal_y_m"))]
    assert frb(["compare", str(run.path), *words, "-o", str(tmp_path / "a.png"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["events"]["measured"] == []


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"x": "z"}, "has no column"),
        ({"time": None}, "--time"),  # and no column is called so
        ({"speed": None}, "--tacho"),
        ({"time": "n"}, "do not rise"),
        ({"speed": None, "tacho": "x"}, ""),
    ],
)
def test_what_is_missing_is_said(
    changed: dict[str, str | None], said: str, tmp_path: Path, table: pd.DataFrame
) -> None:
    path = tmp_path / "run.csv"
    table = table.rename(columns={} if changed.get("time", "t") else {"t": "a"})
    table[::-1].to_csv(path, index=False) if changed.get("time") else table.to_csv(path, index=False)
    if not said:
        table.assign(x=1.0).to_csv(path, index=False)
        said = "pulses"
    with pytest.raises(InputError, match=said):
        measured_run(path, replace(GIVEN, **changed))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["waterfall", "m.csv"], "--x COLUMN"),
        (["waterfall", "m.csv", "--x", "x"], "needs --clearance"),
        (["waterfall", "run.h5", "--x", "x", "--clearance", "35 um"], "needs no --x"),
        (["waterfall", "m.csv", "--x", "x", "--clearance", "-1 um"], "not greater than 0"),
    ],
)
def test_options_that_do_not_fit_are_said(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(words[1]).write_text("t,x\n0,1\n1,2\n", encoding="utf-8")
    assert frb(words) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    "twice",
    [["--time", "t", "--rate", "100", "--speed-column", "n"], ["--time", "t", "--speed-column", "n", "--tacho", "k"]],
)
def test_options_that_tell_the_same_are_refused(twice: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["waterfall", "measured.csv", "--x", "x", "--clearance", "35 um", *twice]) == 2
    assert "give one of them" in capsys.readouterr().err


def hum(folder: Path, rotor: Rotor, lines: dict[float, float]) -> list[tuple[str, float | None, float | None]]:
    """(kind, frequency in Hz, amplitude) of the events of a measurement with lines of mains, by their frequency and
    amplitude over the clearance, forward and half as much backward."""
    found = signals(rotor)
    time, motion = found["time_s"], found["journal_x_m"] + 1j * found["journal_y_m"]
    for frequency, amplitude in lines.items():
        turned = np.exp(2j * np.pi * frequency * time)
        motion = motion + CLEARANCE * amplitude * (turned + 0.5 * np.conj(turned)) / 1.5
    columns = {"t": time, "x": 1e6 * motion.real, "y": 1e6 * motion.imag, "n": found["speed_Hz"]}
    pd.DataFrame(columns).to_csv(folder / "hum.csv", index=False)
    events = measured_run(folder / "hum.csv", GIVEN).events
    return [(event["kind"], event["frequency_Hz"], event["amplitude"]) for event in events]


@pytest.mark.parametrize("noise", [0.0, 0.05])
@pytest.mark.parametrize("speeds_Hz", [(0.0, 300.0), (20.0, 180.0, 20.0)])
def test_a_line_of_constant_frequency_is_forced(speeds_Hz: tuple[float, ...], noise: float, tmp_path: Path) -> None:
    rotor = Rotor(whirl_s=None, noise=noise, speeds_Hz=speeds_Hz, step_s=STEP_s, critical_Hz=None)
    events = hum(tmp_path, rotor, {50.0: 0.12, 100.0: 0.06})
    assert [kind for kind, *_ in events] == ["forced", "forced"]
    assert [frequency for _, frequency, _ in events] == pytest.approx([50.0, 100.0], abs=1e-2)
    assert [amplitude for *_, amplitude in events] == pytest.approx([0.12, 0.06], rel=0.03)


def test_whirl_beside_hum_is_found_as_without_it(tmp_path: Path) -> None:
    own, beside = (hum(tmp_path, Rotor(step_s=STEP_s), lines) for lines in ({}, {50.0: 0.12}))
    assert [kind for kind, *_ in own] == ["critical-speed", "onset"]
    assert beside[0][0] == "forced"
    assert [kind for kind, *_ in beside[1:]] == [kind for kind, *_ in own]
    for (_, frequency, _), (_, expected, _) in zip(beside[1:], own, strict=True):
        assert frequency == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("speeds_Hz", [(280.0, 300.0), (240.0, 400.0), (150.0, 150.0)])
def test_a_whip_and_a_line_at_one_speed_are_not_forced(speeds_Hz: tuple[float, ...], tmp_path: Path) -> None:
    rotor = Rotor(whirl_s=-1.0, speeds_Hz=speeds_Hz, step_s=STEP_s, critical_Hz=None)
    assert [kind for kind, *_ in hum(tmp_path, rotor, {})] == ["onset"]


ROLL = np.array([14.0 * np.exp(0.7j), 9.0 * np.exp(-2.0j)])  # um of x and y, of a shaft that runs out
CRITICAL_Hz, ZETA, FORCED = 60.0, 0.05, 3.0  # of the resonance; um of its mass off the axis


def running_out(rate: float = 5000.0, roll: np.ndarray = ROLL) -> tuple[pd.DataFrame, np.ndarray]:
    """A hold at 4 Hz and a run-up to 120 Hz as probes see it: a resonance and a runout, with a pickup at the shaft. And
    the resonance alone, (n,) of x in um."""
    time = np.arange(int(24.0 * rate)) / rate
    speed = 4.0 + np.clip(time - 4.0, 0.0, None) * 116.0 / 20.0
    turn = 4.0 * time + 0.5 * np.clip(time - 4.0, 0.0, None) ** 2 * 116.0 / 20.0
    angle, r = 2.0 * np.pi * (turn - 0.3), speed / CRITICAL_Hz
    whirl = FORCED * r**2 / (1.0 - r**2 + 2j * ZETA * r)
    motion = np.array([whirl, -1j * whirl])
    x, y = ((motion + roll[:, None]) * np.exp(1j * angle)).real
    key = 5.0 * np.sin(angle + 0.5 * np.pi)  # of a pickup, which rises where the angle does not begin a revolution
    return pd.DataFrame({"t": time, "x": x + 7.0, "y": y - 3.0, "key": key}), (motion[0] * np.exp(1j * angle)).real


TURNING = Measurement("x", CLEARANCE, "y", time="t", tacho="key", unit_m=1e-6)


def test_the_mark_of_a_tacho_is_no_length(tmp_path: Path) -> None:
    """Amplitudes refer to the clearance alone, and without one to none."""
    path, (table, _) = tmp_path / "run.csv", running_out()
    table.to_csv(path, index=False)
    measured = measured_run(path, TURNING)
    assert clearance(replace(measured, references={MARK: 0.25} | measured.references)) == CLEARANCE
    bare = replace(measured_run(path, replace(TURNING, clearance=None)), references={MARK: 0.25})
    assert waterfall_figure(bare, scale=LevelScale(linear=True)).axes[0].get_ylabel() == "frequency in Hz"


def test_a_resonance_is_right_without_the_slow_roll(tmp_path: Path) -> None:
    """To 1e-3 of its height, where the runout shifts it by more than a tenth."""
    path, (table, alone) = tmp_path / "run.csv", running_out()
    table.to_csv(path, index=False)
    run, as_seen = (measured_run(path, replace(TURNING, slow_roll_Hz=speed)) for speed in (4.0, None))
    time = run["time_s"]
    height = np.abs(alone).max()
    near = (time > 8.0) & (time < 20.0)
    left = 1e6 * run["journal_x_m"] - alone
    # What turns at 4 Hz is subtracted at all speeds, with the motion of then: FORCED (4 / 60)^2.
    of_motion = FORCED * (4.0 / CRITICAL_Hz) ** 2 / (1.0 - (4.0 / CRITICAL_Hz) ** 2)
    assert np.abs(left - left.mean())[near].max() < of_motion + 1e-3 * height
    assert of_motion < 1e-3 * height
    peak, seen = (1e6 * np.abs(order_track(each, 1.0, revolutions=4).along("x")).max() for each in (run, as_seen))
    assert peak == pytest.approx(height, rel=1e-3)
    assert abs(seen / height - 1.0) > 0.1
    assert any("Slow roll subtracted, of 4 Hz" in remark for remark in run.remarks)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"tacho": None, "speed_Hz": 4.0}, "does not hold the angle"),
        ({"slow_roll_Hz": 2.0}, "turns 0 times within 10% of 2 Hz"),
    ],
)
def test_a_slow_roll_that_is_not_measured_is_refused(tmp_path: Path, changes: dict[str, Any], fault: str) -> None:
    path, (table, _) = tmp_path / "run.csv", running_out(1000.0)
    table.to_csv(path, index=False)
    with pytest.raises(InputError, match=fault):
        measured_run(path, replace(TURNING, **({"slow_roll_Hz": 4.0} | changes)))


def test_the_command_subtracts_the_slow_roll(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is left is seen as the resonance without a runout is, through the same windows."""
    seen = []
    for roll, more in ((ROLL, ["--slow-roll", "4 Hz"]), (0.0 * ROLL, [])):
        path = tmp_path / f"run-{len(seen)}.csv"
        running_out(1000.0, roll)[0].to_csv(path, index=False)
        columns = ["--x", "x", "--y", "y", "--time", "t", "--tacho", "key", "--order", "1", "--json"]
        assert frb(["waterfall", str(path), *columns, *more, "-o", str(tmp_path / "orders.png")]) == 0
        seen.append(json.loads(capsys.readouterr().out)["orders"][0]["amplitude_max_m"])
    assert seen[0] == pytest.approx(seen[1], rel=1e-3)


@pytest.mark.parametrize(
    ("head", "x", "speed"),
    [
        ("t/s,x/mm,n in 1/min", "x/mm", "n in 1/min"),
        ("Time [s],x in mm,n / (rev/min)", "x in mm", "n / (rev/min)"),
        ("#,x,n\ns,mm,rpm", "x", "n"),  # a head of its own whose first column counts
        ("Zeit (s),x (mm),n (U/min)", "x (mm)", "n (U/min)"),
        ("x-axis,x,n\nsecond,mm,rpm", "x", "n"),
    ],
)
def test_units_in_names_and_the_only_times_are_used(head: str, x: str, speed: str, tmp_path: Path) -> None:
    """1 mm at 1200 rpm, 1 kHz; the times are in the only column that can have them."""
    time = np.arange(2000) / 1e3
    rows = [f"{t:.3f},{math.cos(40.0 * math.pi * t):.9f},1200" for t in time]
    (path := tmp_path / "a.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    run = measured_run(path, Measurement(x, 35e-6, speed=speed, **({"time": "#"} if head.startswith("#") else {})))
    assert run["speed_Hz"] == pytest.approx(20.0, rel=1e-12)
    assert run["time_s"] == pytest.approx(time, abs=1e-12)
    assert np.max(run["journal_x_m"]) == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize(
    ("head", "row", "said"),
    [
        ("t,x,omega", "{t:.3f},{x:.6f},125", "Hz or rad/s"),
        ("t/s,x in mm/s,n", "{t:.3f},{x:.6f},20", "no displacement"),
        ("t;x;n", "{t:.3f};{x:.6f};1,200.0", "marks between thousands"),
        ("t;x;n", "{t:.3f};{x:.6f};1'200", "marks between thousands"),
    ],
)
def test_what_a_column_may_mean_is_not_guessed(head: str, row: str, said: str, tmp_path: Path) -> None:
    rows = [row.format(t=t / 1e3, x=math.cos(0.1 * t)) for t in range(2000)]
    (path := tmp_path / "a.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    x, speed = re.split("[,;]", head)[1:]
    with pytest.raises(InputError, match=said):
        measured_run(path, Measurement(x, 35e-6, speed=speed, unit_m=None))


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("t/s", "s"), ("x / mm", "mm"), ("n in 1/min", "1/min"), ("v_x in mm/s", "mm/s"),
        ("rev/s", None), ("n rev/s", None), ("v m/s", None), ("V/s", None), ("l/min", None),
    ],
)  # fmt: skip
def test_a_unit_over_time_is_no_name_with_a_unit_of_time(name: str, unit: str | None) -> None:
    assert unit_in(name) == unit
