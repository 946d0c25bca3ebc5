"""Rotor speeds in the unit of the case: all that a user of a case in rpm reads; JSON stays in Hz."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.units import SpeedUnit

PER_MINUTE = ("--set", "speed.to=18000 rpm")
HERTZ = ("--set", "speed.to=300 Hz")
# the command, with how its text names a speed in rpm
COMMANDS: dict[str, tuple[tuple[str, ...], str]] = {
    "stability": (("stability", "jeffcott", "--threshold", "--no-picture"), r"above 10632 rpm the rotor whirls"),
    "bearing": (("bearing", "jeffcott", "--no-picture"), r"rpm: rotor speed;"),
    "balls": (("bearing", "turbocharger-ball", "--load", "60 N", "--no-picture"), r"rpm: rotor speed;"),
    "thrust": (("thrust", "turbocharger-car-thrust", "--no-picture"), r"rpm: rotor speed;"),
    "runup": (("runup", "jeffcott", "--no-picture", "--set", "speed.duration=2 s", "-o", "run.h5", "--force"),
              r"speed, rpm"),
}  # fmt: skip


@pytest.mark.parametrize("name", list(COMMANDS))
def test_text_is_in_the_unit_of_the_case_and_json_in_hertz(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words, told = COMMANDS[name]
    documents = {}
    for unit, settings in (("rpm", PER_MINUTE), ("Hz", HERTZ)):
        assert frb([*words, *settings]) == 0
        text = " ".join(capsys.readouterr().out.split())
        assert (re.search(told, text) is not None) == (unit == "rpm"), text
        assert frb([*words, *settings, "--json", "--quiet"]) == 0
        documents[unit] = without_times(json.loads(capsys.readouterr().out))
    assert documents["rpm"] == documents["Hz"]


def without_times(document: object) -> object:
    """A document without what follows the clock."""
    if isinstance(document, dict):
        return {key: without_times(value) for key, value in document.items() if key not in ("cost", "resumes")}
    return [without_times(value) for value in document] if isinstance(document, list) else document


def test_an_option_in_rpm_turns_the_text_to_rpm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for asked in (("--speed", "3000 rpm"), ("--speed", "50 Hz", "--rpm")):
        assert frb(["stability", "jeffcott", "--no-picture", *asked]) == 0
        said = capsys.readouterr().out
        assert re.search(r"^ +rpm ", said, re.MULTILINE)
        assert re.search(r"^ +3000 ", said, re.MULTILINE)


@pytest.mark.parametrize(
    ("settings", "per_minute"),
    [(("speed.to=3000 r/min",), True), (("speed.to=3 krpm",), True), (("speed.to=300 rad/s",), False), ((), False),
     ((r'speed={points=[["0 s", "0 rpm"], ["1 s", "900 rpm"]]}',), True), (("speed.duration=1 min",), False),
     (('motion={eccentricity=0.5, speed="600 rpm"}',), True), (('motion={eccentricity=0.5, speed="6 Hz"}',), False)],
)  # fmt: skip
def test_unit_of_a_case(settings: tuple[str, ...], per_minute: bool) -> None:
    assert load_case("jeffcott", settings).speed_unit.rpm is per_minute


def test_speeds_in_words() -> None:
    hertz, per_minute, both = SpeedUnit(), SpeedUnit(rpm=True), SpeedUnit(both=True)
    assert (hertz.words(177.2), per_minute.words(177.2)) == ("177.2 Hz", "10632 rpm")
    assert (hertz.number(0.5), per_minute.number(0.5)) == ("0.5", "30")
    assert (hertz.cell(204.43, 1.8), per_minute.cell(204.43, 1.8)) == ("204.4(18)", "12266(108)")
    assert both.words(200.0) == "200.0 Hz, 12000 rpm"
    assert per_minute.span(10.0, 20.0) == "600 to 1200 rpm"
    assert per_minute.cell(None) == "-"


def test_a_measurement_with_speeds_per_minute_is_shown_in_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    time = np.arange(20_000) * 2.5e-4
    speed = 600.0 + 3000.0 * time
    angle = np.cumsum(speed / 60.0) * 2.5e-4 * 2.0 * np.pi
    whirl = np.where(time > 3.0, 15.0, 0.0)
    x, y = (3.0 * of(angle) + whirl * of(0.48 * angle) for of in (np.cos, np.sin))
    file = tmp_path / "measured.csv"
    np.savetxt(file, np.c_[time, speed, x, y], delimiter=",", header="time_s,speed_rpm,x_um,y_um", comments="")
    words = ["waterfall", str(file), "--x", "x_um", "--y", "y_um", "--time", "time_s", "--speed-column", "speed_rpm"]
    assert frb([*words, "--clearance", "30 um", "-o", str(tmp_path / "w.svg")]) == 0
    assert "speed, rpm" in capsys.readouterr().out
    assert "rotor speed in rpm" in (tmp_path / "w.svg").read_text(encoding="utf-8")
    assert frb([*words, "--linear", "-o", str(tmp_path / "linear.svg")]) == 0  # amplitudes refer to no clearance
