"""`frb stability`: JSON, table, picture, exit codes."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from frbcli.analysis.stability import stability
from frbcli.case.load import load_case
from frbcli.cli.main import run as frb


def test_command_emits_the_points_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    speeds = ["--speed", "25 Hz", "--speed", "6000 rpm", "--speed", "1e-4 Hz"]
    assert frb(["stability", "jeffcott", *speeds, "--json", "--quiet"]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    document = json.loads(said.out)
    assert document["command"] == "stability"
    assert set(document["threshold"]) == {"speed_Hz", "frequency_Hz", "whirl_ratio"}
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
    assert said.err == ""
    rows = [line for line in said.out.splitlines() if line.startswith("  ") and "°" in line]
    assert len(rows) == 20
    assert max(len(row) for row in rows) <= 80
    assert "Threshold of stability: above 179.8 Hz" in said.out
    assert list(tmp_path.iterdir()) == []


def test_command_draws_where_it_is_told_and_what_is_unstable(tmp_path: Path) -> None:
    stable, unstable = tmp_path / "stable.svg", tmp_path / "unstable.svg"
    short = ["--quiet", "--set", "film.theory=short"]
    assert frb(["stability", "jeffcott", "-o", str(unstable), *short]) == 0
    assert frb(["stability", "jeffcott", "-o", str(stable), *short, "--set", "speed.to=100 Hz"]) == 0
    vermilion = "#d55e00"
    assert unstable.read_text().lower().count(vermilion) > stable.read_text().lower().count(vermilion)
    assert "threshold 179.8 Hz" in unstable.read_text()
    assert "threshold" not in stable.read_text()


@pytest.mark.parametrize(
    "words",
    [
        ["--speed", "0 Hz"],
        ["--speed", "nan"],
        ["--speed", "fast"],
        ["--speed", "25 kg"],
        ["-o", "picture.bmp"],
        ["-o", "a.png", "--no-picture"],
    ],
)
def test_command_refuses_what_makes_no_sense(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert frb(["stability", "jeffcott", "--json", *words]) == 2
    assert json.loads(capsys.readouterr().out)["status"] == "input-error"
    assert list(tmp_path.iterdir()) == []


def test_command_ends_with_3_if_nothing_rests(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert frb(["stability", "jeffcott", "--speed", "1e-4 Hz", "--no-picture", "--quiet"]) == 3
