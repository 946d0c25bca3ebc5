"""`frb runup`, `frb rundown`, `frb rotation`, `frb squeeze`, `frb whirl`: JSON keys, files, pictures, exit codes."""

import json
import math
import os
import pty
import random
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb
from hypothesis import given
from hypothesis import strategies as st
from paths import ROOT
from resumed import assert_same

from frbcli.cli.main import run
from frbcli.cli.progress import progress_line
from frbcli.results.store import Run, read_run
from frbcli.runs.march import Progress
from frbcli.units import SpeedUnit

PNG = b"\x89PNG"
QUICK = ["jeffcott", "--set", "film.theory=short", "--set", "speed.duration=0.3 s"]
# Some seconds of work; few samples, so that the files are small.
LONG = ["jeffcott", "--set", "film.theory=short", "--set", "speed.to=200 Hz", "--set", "speed.duration=80 s",
        "--set", "output.step=3 ms"]  # fmt: skip

COST = {"cpu_s", "error_cpu_s", "compile_cpu_s", "predicted_cpu_s", "wall_s", "steps", "rejected_steps",
        "steps_per_revolution", "film_solves", "ms_per_film_solve", "simulated_ms_per_hour"}  # fmt: skip
SECOND = {"second_run_cpu_s", "second_run_predicted_cpu_s"}  # of a run that has ended, the former if it was made
ERROR = ["time_integration", "film_force_relative", "oil_balance_relative", "model_relative", "mesh_relative",
         "coupling", "modal_reduction", "modal_reduction_amplitude", "cells", "eccentricity", "displacement",
         "ring_speed", "oil_fraction", "quiet_until_s"]  # fmt: skip
EVENT = ["kind", "film", "t_s", "speed_Hz", "frequency_Hz", "frequency_ratio", "point", "amplitude",
         "speed_uncertainty_Hz", "frequency_uncertainty_Hz", "amplitude_uncertainty", "certain", "reason"]  # fmt: skip


@pytest.fixture(autouse=True)
def in_a_directory_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def document(text: str) -> dict[str, Any]:
    """The one JSON document that stdout holds, with the keys of every run."""
    found = json.loads(text)
    assert list(found) == ["command", "run", "status", "t_end_s", "events", "cost", "error"]
    assert COST <= set(found["cost"]) <= COST | SECOND
    assert list(found["error"]) == ERROR
    assert all(list(event) == EVENT for event in found["events"])
    return dict(found)


# --- what is said where ---


def test_runup_says_one_json_document_and_leaves_a_picture(frb: Frb) -> None:
    said = frb("runup", *QUICK, "--set", "speed.to=250 Hz", "--json")
    found = document(said.out)
    assert (found["command"], found["run"]) == ("runup", "jeffcott.h5")
    assert (found["status"], found["t_end_s"]) == ("finished", 0.3)
    assert found["events"] == read_run("jeffcott.h5").events
    assert found["cost"]["steps"] == read_run("jeffcott.h5").cost["steps"]
    assert "finished at 0.3 s" not in said.err
    assert Path("jeffcott-summary.png").read_bytes().startswith(PNG)


def test_quiet_says_nothing(frb: Frb) -> None:
    assert frb("runup", *QUICK, "-o", "a.h5", "--quiet", "--no-picture") == ("", "")
    assert os.listdir() == ["a.h5"]


def test_quiet_json_says_json_alone(frb: Frb) -> None:
    said = frb("rundown", *QUICK, "--json", "--quiet", "--no-picture")
    assert document(said.out)["command"] == "rundown"
    assert said.err == ""


# --- progress ---

number = st.floats(allow_nan=True, allow_infinity=True)


@given(number, number, number, number, st.integers(0, 10**18), number, number, number)
def test_progress_line_fits_any_terminal(
    t: float, end: float, speed: float, eccentricity: float, steps: int, per_turn: float, pace: float, left: float
) -> None:
    line = progress_line(Progress(t, end, speed, eccentricity, steps, per_turn, pace, left))
    assert len(line) <= 80
    assert line.isprintable()


def test_progress_line_says_what_matters() -> None:
    line = progress_line(Progress(12.3456, 100.0, 123.45, 0.6789, 10**6, 41.7, 1.2e8, 3725.0))
    assert len(line) < 80
    per_minute = progress_line(Progress(12.3, 100.0, 123.45, 0.6789, 1, 41.7, 1.0, 3.0), SpeedUnit(rpm=True))
    assert "  7407 rpm  " in per_minute
    for word in ("12.346/100 s", "123.5 Hz", "eps 0.679", "41.7 steps/rev", "62:05 left"):
        assert word in line


@pytest.mark.parametrize(
    ("left", "words"),
    [(0.4, "0:00"), (59.6, "1:00"), (5999.0, "99:59"), (6000.0, "1 h"), (1e6, "11 d"), (np.inf, "?"), (np.nan, "?")],
)
def test_time_left_is_told_in_few_columns(left: float, words: str) -> None:
    assert progress_line(Progress(1.0, 2.0, 3.0, 0.4, 5, 41.0, 1e8, left)).endswith(f"steps/rev  {words} left")


def frb_process(*words: str, often: bool = False, **options: Any) -> subprocess.Popen[bytes]:
    """frb in a process of its own; often: with many checkpoints."""
    hurry = "import frbcli.runs.run as r; r.CHECKPOINT_EVERY_s, r.CHECKPOINT_SHARE = 0.05, 1.0;" if often else ""
    code = f"import sys; {hurry} from frbcli.cli.process import main; main()"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "100", "TERM": "xterm"}
    return subprocess.Popen([sys.executable, "-c", code, *words], env=environment, **options)


def test_progress_moves_on_a_terminal() -> None:
    ours, theirs = pty.openpty()
    try:
        words = ("runup", *LONG, "--no-picture", "-o", "a.h5")
        with frb_process(*words, stdout=subprocess.PIPE, stderr=theirs) as process:
            os.close(theirs)
            shown = b""
            while process.poll() is None or select.select([ours], [], [], 0.1)[0]:
                try:
                    shown += os.read(ours, 65536)
                except OSError:  # the other end is closed
                    break
            assert process.stdout is not None
            told = process.stdout.read().decode()
    finally:
        os.close(ours)
    assert process.returncode == 0
    lines = [line for line in shown.decode().replace("\r", "\n").splitlines() if "steps/rev" in line]
    assert len(lines) > 3
    assert len(set(lines)) > 3
    assert "finished at 80 s" in told
    assert "finished" not in shown.decode()
    assert "\x1b" not in told
    assert max(map(len, told.splitlines())) <= 80


def test_no_progress_where_nobody_watches(frb: Frb) -> None:
    assert "steps/rev" not in frb("runup", *QUICK, "--no-picture").err


# --- broken off ---


def wait_for(path: Path, process: subprocess.Popen[bytes]) -> None:
    """Until the run is under way."""
    until = time.monotonic() + 60.0
    while not path.exists() and time.monotonic() < until:
        assert process.poll() is None
        time.sleep(0.01)
    assert path.exists()


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    path = tmp_path_factory.mktemp("whole") / "whole.h5"
    assert run(["runup", *LONG, "-o", str(path), "--quiet", "--no-picture"]) == 0
    return read_run(path)


def test_ctrl_c_keeps_the_run_and_resume_finishes_it(whole_run: Run, frb: Frb) -> None:
    path = Path("a.h5")
    words = ("runup", *LONG, "-o", str(path), "--json")
    with frb_process(*words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        wait_for(path, process)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    assert process.returncode == 130
    found = document(out.decode())
    assert found["status"] == "interrupted"
    assert 0.0 < found["t_end_s"] < 80.0
    assert "--resume" in err.decode()
    assert b"Traceback" not in err
    assert read_run(path).t_end_s == found["t_end_s"]
    frb("runup", *LONG, "-o", str(path), "--resume", "--quiet", "--no-picture")
    assert_same(read_run(path), whole_run)


def test_a_killed_run_opens_and_resumes_to_the_same_numbers(whole_run: Run, frb: Frb) -> None:
    path, chance = Path("a.h5"), random.Random(7)
    words = ("runup", *LONG, "-o", str(path), "--resume", "--quiet", "--no-picture")
    reached = []
    for longest_wait in (0.3, 1.0, 1.5):
        with frb_process(*words, often=True) as process:
            wait_for(path, process)
            # From the second round on the file is there at once: the kill may hit the start of the program as well.
            time.sleep(chance.uniform(0.0, longest_wait))
            process.kill()
        run = read_run(path)
        assert run.status == "interrupted"
        reached.append(run.t_end_s)
    assert reached == sorted(reached)
    frb(*words)
    assert_same(read_run(path), whole_run)
    assert os.listdir() == ["a.h5"]


ROTATION_KEYS = {
    "cavitation", "theory", "status", "displacement", "force_N", "torque_journal_N_m", "torque_shell_N_m", "p_max_Pa",
    "p_min_Pa", "oil_fraction", "oil_balance", "error", "cost",
}  # fmt: skip
HISTORY_KEYS = {"t_s", "force_history_N", "probe_pressure_Pa", "gap_ratio"}
COARSE = ("--set", "accuracy.mesh=[8, 32]")


def test_rotation_of_a_shipped_case(frb: Frb, tmp_path: Path) -> None:
    picture = tmp_path / "film.png"
    words = ("rotation", "bearing-axial-groove", "--cavitation", "half-sommerfeld,elrod", *COARSE, "-o", str(picture))
    found = frb(*words, "--json").document
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
def test_histories(test: str, frb: Frb, tmp_path: Path) -> None:
    picture = tmp_path / "history.png"
    arguments = (test, test, "--cavitation", "half-sommerfeld,elrod", "--set", "motion.periods=1", *COARSE)
    found = frb(*arguments, "-o", str(picture), "--json").document
    for result in found["results"]:
        assert set(result) == ROTATION_KEYS | HISTORY_KEYS
        assert len({len(result[key]) for key in HISTORY_KEYS}) == 1
        assert min(result["gap_ratio"]) == pytest.approx(0.4, abs=0.005)
        assert 0.0 < result["error"]["force_relative"] < 0.1
    assert picture.stat().st_size > 10_000


def test_errors_in_the_table_refer_to_its_largest_force(frb: Frb) -> None:
    """A force that nearly vanishes beside the others has a large error of its own, which says nothing beside them."""
    motion = 'motion={eccentricity=0.6, speed="50 Hz"}'
    words = ("rotation", "bearing", "--cavitation", "half-sommerfeld,two-phase", "--set", motion, *COARSE)
    results = frb(*words, "--no-picture", "--json").document["results"]
    table = frb(*words, "--no-picture").out
    sizes = [math.hypot(*result["force_N"]) for result in results]
    assert sizes[1] < 0.5 * sizes[0]
    expected = [one["error"]["force_relative"] * size / max(sizes) for one, size in zip(results, sizes, strict=True)]
    rows = [line.split() for line in table.splitlines() if "°" in line]
    assert [float(row[-1]) for row in rows] == [float(f"{error:.0e}") for error in expected]


def test_check_plans_a_kinematic_case(frb: Frb) -> None:
    found = frb("check", "squeeze", "--json").document
    assert {"gap", "film", "cells", "steps"} <= {decision["choice"] for decision in found["plan"]}


def test_compare_runs_the_test_with_all_models_unless_told_otherwise(frb: Frb) -> None:
    words = ("compare", "bearing-axial-groove", "--test", "rotation", *COARSE, "--no-picture")
    found = frb(*words, "--json").document
    assert (found["command"], found["test"]) == ("compare", "rotation")
    models = [result["cavitation"] for result in found["results"]]
    assert models == ["half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase", "barotropic", "bubbly"]
    words_alone = ("rotation", "bearing-axial-groove", "--cavitation", "elrod", *COARSE, "--no-picture")
    alone = frb(*words_alone, "--json").document
    assert found["results"][4]["force_N"] == alone["results"][0]["force_N"]
    assert frb(*words, "--theory", "short", "--json", code=2).document["status"] == "input-error"
