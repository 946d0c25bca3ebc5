"""The onset of a whirl in an ensemble of runs: above the linear threshold, the later the faster the ramp."""

from __future__ import annotations

import itertools
import json
import math
from pathlib import Path

import pytest

from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.runs.march import Progress
from frbcli.runs.run import runup
from frbcli.studies.onset_spread import OnsetSpread, onset_spread


@pytest.fixture(scope="module")
def jeffcott(tmp_path_factory: pytest.TempPathFactory) -> OnsetSpread:
    case = load_case("jeffcott")
    found = onset_spread(case, runup(case, tmp_path_factory.mktemp("onset") / "run.h5"))
    assert found is not None
    return found


def test_whirls_begin_above_the_linear_threshold(jeffcott: OnsetSpread) -> None:
    low, high = jeffcott.interval_Hz
    assert jeffcott.threshold_Hz == pytest.approx(177.2, abs=0.1)  # frb stability jeffcott
    assert jeffcott.threshold_Hz < low < jeffcott.onset_Hz < high
    assert not [run.problem for run in jeffcott.runs if run.problem]


def test_a_faster_ramp_whirls_later_and_a_disturbed_rotor_first(jeffcott: OnsetSpread) -> None:
    fast, slow, finer, disturbed = (run.onset_Hz for run in jeffcott.runs)
    assert disturbed < slow < jeffcott.onset_Hz < fast
    # The delay of a whirl that grows from the same disturbance goes with the root of the ramp: growth rises linearly
    # above the threshold, so that its logarithm is the square of the delay over the ramp.
    threshold = jeffcott.threshold_Hz
    assert threshold is not None
    delays = [onset - threshold for onset in (slow, jeffcott.onset_Hz, fast)]
    for slower, faster in itertools.pairwise(delays):
        assert faster / slower == pytest.approx(math.sqrt(2.0), rel=0.15)
    assert abs(finer - jeffcott.onset_Hz) < 0.2 * delays[1]


def test_a_run_without_whirl_has_no_spread(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = ["--set", "speed.to=50 Hz", "--set", "speed.duration=0.5 s"]
    options = ["-o", str(tmp_path / "run.h5"), "--no-picture", "--onset-spread", "--json"]
    assert frb(["runup", "jeffcott", *settings, *options]) == 0
    assert json.loads(capsys.readouterr().out)["onset_spread"] == {"status": "no-onset"}


def test_the_command_tells_the_interval(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert frb(["runup", "jeffcott", "-o", str(tmp_path / "run.h5"), "--no-picture", "--onset-spread", "--json"]) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)["onset_spread"]
    assert found["threshold_Hz"] < found["lowest_Hz"] < found["onset_Hz"] < found["highest_Hz"]
    assert "The onset lies between" in captured.err


def test_an_interruption_keeps_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("frbcli.studies.onset_spread.onset_spread", interrupted)
    path = tmp_path / "run.h5"
    assert frb(["runup", "jeffcott", "-o", str(path), "--no-picture", "--onset-spread", "--quiet"]) == 130
    assert path.exists()


def test_the_ensemble_can_be_watched(tmp_path: Path) -> None:
    case = load_case("jeffcott")
    seen: set[tuple[int, int]] = set()

    def watch(number: int, count: int, progress: Progress) -> None:
        assert progress.t_s >= 0.0
        seen.add((number, count))

    assert onset_spread(case, runup(case, tmp_path / "run.h5"), watch) is not None
    assert seen == {(number, 4) for number in range(1, 5)}
