"""`frb stability`: JSON, table, picture, exit codes."""

import json
import math
from pathlib import Path

import pytest

from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.linear.stability import stability


def test_command_emits_the_points_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    speeds = ["--speed", "25 Hz", "--speed", "6000 rpm", "--speed", "1e-4 Hz"]
    assert frb(["stability", "jeffcott", *speeds, "--json", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out)["threshold"] is None
    assert frb(["stability", "jeffcott", *speeds, "--threshold", "--json", "--quiet"]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    document = json.loads(said.out)
    assert document["command"] == "stability"
    uncertainty = {"speed_uncertainty_Hz", "frequency_uncertainty_Hz"}
    assert set(document["threshold"]) == {"speed_Hz", "frequency_Hz", "whirl_ratio"} | uncertainty
    assert all(0.0 < document["threshold"][key] < 0.1 for key in uncertainty)
    slow, fast, none = document["points"]
    assert (slow["speed_Hz"], fast["speed_Hz"]) == (25.0, 100.0)
    point = stability(load_case("jeffcott"), [25.0]).points[0]
    assert slow["displacement"] == pytest.approx(point.films[0].displacement.tolist())
    assert slow["stiffness_N_m"][0][1] == pytest.approx(point.films[0].stiffness[0, 1])
    assert slow["damping_N_s_m"][1][1] == pytest.approx(point.films[0].damping[1, 1])
    assert math.hypot(*slow["displacement"]) == pytest.approx(slow["eccentricity"])
    assert [tuple(pair) for pair in slow["eigenvalues"]] == [
        pytest.approx((value.real, value.imag)) for value in point.eigenvalues
    ]
    assert none["status"] == "not-converged"
    assert none["displacement"] is None
    assert (tmp_path / "jeffcott-campbell.png").read_bytes().startswith(b"\x89PNG")


def test_command_speaks_in_eighty_columns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    assert frb(["stability", "jeffcott", "--no-picture", "--set", "film.theory=short"]) == 0
    said = capsys.readouterr()
    assert [line for line in said.err.splitlines() if not line.startswith("Compiling the kernels, once: ")] == []
    rows = [line for line in said.out.splitlines() if line.startswith("  ") and "°" in line]
    assert len(rows) == 20
    assert max(len(row) for row in rows) <= 80
    assert "Threshold of stability: above 179.8 Hz" in said.out
    assert list(tmp_path.iterdir()) == []


def one_speed(case: str, speed_Hz: float) -> list[str]:
    """Words that ask for the stability of a case at one speed and no other one."""
    settings = ("film.cavitation=half-sommerfeld", f"speed.from={speed_Hz} Hz", f"speed.to={speed_Hz} Hz")
    return ["stability", case, *(word for setting in settings for word in ("--set", setting))]


def test_turbocharger_shows_its_growing_modes_and_names_its_films(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    picture = tmp_path / "campbell.svg"
    assert frb([*one_speed("turbocharger-heavy", 600), "-o", str(picture), "--json"]) == 0
    (point,) = json.loads(capsys.readouterr().out)["points"]
    assert frb([*one_speed("turbocharger-heavy", 600), "--no-picture"]) == 0
    said = capsys.readouterr().out.splitlines()
    names = ["compressor_inner", "compressor_outer", "turbine_inner", "turbine_outer"]
    assert [film["film"] for film in point["films"]] == names
    growing = [mode for mode in point["modes"] if mode["growth_1_s"] > 0.0]
    assert len(growing) == 3
    assert point["modes"][:3] == growing
    assert all(mode["damping"] < 0.0 for mode in growing)
    rows = [line.split() for line in said if "°" in line]
    assert ["_".join(row[-7:-5]) for row in rows] == names
    for row, mode in zip(rows, growing, strict=False):
        assert row[-3:] == [f"{mode['frequency_Hz']:.1f}", f"{mode['damping']:.4f}", f"{mode['growth_1_s']:.1f}"]
    assert max(len(line) for line in said if "°" in line or "film" in line) <= 80
    assert picture.read_text().lower().count("#d55e00") >= 2 * len(growing)  # in both panels


def test_springs_of_films_without_direct_stiffness_are_left_out_and_told(capsys: pytest.CaptureFixture[str]) -> None:
    """The compressor's inner film is full all around there: its half-Sommerfeld pressure holds nothing."""
    words = [*one_speed("turbocharger-heavy", 1200), "--no-picture"]
    assert frb([*words, "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["natural_frequencies"]) == 1
    assert frb(words) == 0
    assert "no direct stiffness" in capsys.readouterr().out


ROLLING = """
[rotor]
kind = "turbocharger"
[[shaft]]
length = "200 mm"
diameter = "20 mm"
[speed]
from = "100 Hz"
to = "900 Hz"
duration = "1 s"
""" + "".join(f"""
[[bearing]]
kind = "ball"
name = "{name}"
position = "{position}"
balls = 9
ball_diameter = "4 mm"
pitch_diameter = "18 mm"
contact_angle = "25 deg"
preload = "50 N"
""" for name, position in (("front", "20 mm"), ("rear", "180 mm")))


def test_natural_frequencies_on_balls_are_left_to_the_damped_modes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Balls hold the shaft as they do at a static equilibrium, softer by far at this speed than standing."""
    (tmp_path / "rolling.toml").write_text(ROLLING)
    words = ["stability", str(tmp_path / "rolling.toml"), "--no-picture", "--speed", "900 Hz"]
    assert frb([*words, "--json"]) == 0
    (free,) = json.loads(capsys.readouterr().out)["natural_frequencies"]
    assert not free["stiffness_N_m"]
    assert frb(words) == 0
    assert "--shapes SPEED" in " ".join(capsys.readouterr().out.split())


def test_speeds_that_are_asked_for_are_all_shown(capsys: pytest.CaptureFixture[str]) -> None:
    speeds = [word for speed in range(101, 126) for word in ("--speed", f"{speed} Hz")]
    assert frb(["stability", "jeffcott", "--no-picture", "--set", "film.theory=short", *speeds]) == 0
    assert "".join(capsys.readouterr()).count("°") == 25


def test_many_speeds_without_a_resting_position_are_told_in_short(capsys: pytest.CaptureFixture[str]) -> None:
    slow = ["--set", "film.theory=short", "--set", "speed.to=1e-8 Hz"]
    assert frb(["stability", "jeffcott", "--no-picture", *slow]) == 3
    said = "".join(capsys.readouterr())
    assert "No modes at 60 of 60 speeds" in said
    assert said.count("Ask for a higher speed") == 1
