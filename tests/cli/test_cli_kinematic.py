"""`frb rotation`, `frb squeeze`, `frb whirl`: JSON keys, exit codes, pictures, 80 columns."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from frbcli.cli.main import run

ROTATION_KEYS = {
    "cavitation", "theory", "status", "displacement", "force_N", "torque_journal_N_m", "torque_shell_N_m", "p_max_Pa",
    "p_min_Pa", "oil_fraction", "oil_balance", "error", "cost",
}  # fmt: skip
HISTORY_KEYS = {"t_s", "force_history_N", "probe_pressure_Pa", "gap_ratio"}
COARSE = ("--set", "accuracy.mesh=[8, 32]")


def document(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> dict[str, Any]:
    assert run([*arguments, "--json"]) == code
    loaded: dict[str, Any] = json.loads(capsys.readouterr().out)
    return loaded


def test_rotation_of_a_shipped_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "film.png"
    found = document(
        capsys, "rotation", "bearing-axial-groove", "--cavitation", "half-sommerfeld,elrod", *COARSE, "-o", str(picture)
    )
    assert set(found) == {"command", "case", "results"}
    assert [result["cavitation"] for result in found["results"]] == ["half-sommerfeld", "elrod"]
    for result in found["results"]:
        assert set(result) == ROTATION_KEYS
        assert result["status"] == "ok"
        assert result["force_N"] == pytest.approx([0.0, 29.9], abs=0.01)
        assert set(result["oil_balance"]) == {"in_m3_s", "out_m3_s", "defect_relative"}
        assert set(result["cost"]) == {"cpu_s", "unknowns", "newton_iterations"}
    assert abs(found["results"][1]["oil_balance"]["defect_relative"]) < 1e-10
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize("test", ["squeeze", "whirl"])
def test_histories(test: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "history.png"
    arguments = (test, test, "--cavitation", "half-sommerfeld,elrod", "--set", "motion.periods=1", *COARSE)
    found = document(capsys, *arguments, "-o", str(picture))
    for result in found["results"]:
        assert set(result) == ROTATION_KEYS | HISTORY_KEYS
        assert len({len(result[key]) for key in HISTORY_KEYS}) == 1
        assert min(result["gap_ratio"]) == pytest.approx(0.4, abs=0.005)
        assert 0.0 < result["error"]["force_relative"] < 0.1
    assert picture.stat().st_size > 10_000


def test_errors_in_the_table_refer_to_its_largest_force(capsys: pytest.CaptureFixture[str]) -> None:
    """A force that nearly vanishes beside the others has a large error of its own, which says nothing beside them."""
    motion = 'motion={eccentricity=0.6, speed="50 Hz"}'
    words = ("rotation", "bearing", "--cavitation", "half-sommerfeld,two-phase", "--set", motion, *COARSE)
    assert run([*words, "--no-picture", "--json"]) == 0
    results = json.loads(capsys.readouterr().out)["results"]
    assert run([*words, "--no-picture"]) == 0
    sizes = [math.hypot(*result["force_N"]) for result in results]
    assert sizes[1] < 0.5 * sizes[0]
    expected = [one["error"]["force_relative"] * size / max(sizes) for one, size in zip(results, sizes, strict=True)]
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if "°" in line]
    assert [float(row[-1]) for row in rows] == [float(f"{error:.0e}") for error in expected]


def test_check_plans_a_kinematic_case(capsys: pytest.CaptureFixture[str]) -> None:
    found = document(capsys, "check", "squeeze")
    assert {"gap", "film", "cells", "steps"} <= {decision["choice"] for decision in found["plan"]}


def test_compare_runs_the_test_with_all_models_unless_told_otherwise(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("compare", "bearing-axial-groove", "--test", "rotation", *COARSE, "--no-picture")
    found = document(capsys, *words)
    assert (found["command"], found["test"]) == ("compare", "rotation")
    models = [result["cavitation"] for result in found["results"]]
    assert models == ["half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase", "barotropic", "bubbly"]
    alone = document(capsys, "rotation", "bearing-axial-groove", "--cavitation", "elrod", *COARSE, "--no-picture")
    assert found["results"][4]["force_N"] == alone["results"][0]["force_N"]
    assert document(capsys, *words, "--theory", "short", code=2)["status"] == "input-error"
