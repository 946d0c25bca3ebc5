"""The second, coarser run: what it says of the events of a run, when it is made, and where it is kept."""

from __future__ import annotations

import re
import tracemalloc
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from frbcli.analysis.uncertainty import partners
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.errors import NotConverged
from frbcli.results.store import Run, read_run
from frbcli.runs import second_run
from frbcli.runs.march import March
from frbcli.runs.run import run_cost, runup
from frbcli.runs.second_run import about_certainty
from frbcli.scene.cost import expected_cost
from frbcli.scene.machine.system import make_segments
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import cost_of_run, is_cheap, make_plan, second_run_s
from frbcli.solve.state import RUNNING

CASE = ("film.theory=short", "output.step=0.2 ms")


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("jeffcott", CASE)


@pytest.fixture(scope="module")
def run(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return runup(case, tmp_path_factory.mktemp("second") / "run.h5", uncertainty=True)


def test_a_run_at_a_tenth_of_the_target_is_within_the_uncertainties(run: Run, case: Case, tmp_path: Path) -> None:
    exact = runup(case.with_settings("accuracy.target=1e-4"), tmp_path / "exact.h5")
    assert [event["kind"] for event in run.events] == ["critical-speed", "onset"]
    for event, true in zip(run.events, partners(run.events, exact.events), strict=True):
        assert event["certain"]
        assert true is not None
        for key in ("speed_Hz", "frequency_Hz", "amplitude"):
            uncertainty = event[key.removesuffix("_Hz") + "_uncertainty" + ("_Hz" if key.endswith("_Hz") else "")]
            assert abs(event[key] - true[key]) <= uncertainty < 0.03 * max(event[key], 1.0)


@pytest.mark.bitwise
def test_a_run_that_has_ended_gets_them_later(run: Run, case: Case, tmp_path: Path) -> None:
    path = tmp_path / "later.h5"
    first = runup(case, path)
    assert all(event["certain"] is None for event in first.events)
    assert "with --uncertainty" in about_certainty(first, first.events)[0]
    later = runup(case, path, uncertainty=True)
    assert later.events == run.events
    assert later.cost["cpu_s"] == first.cost["cpu_s"]
    assert all((later[name] == first[name]).all() for name in first.signals)
    assert read_run(path).checkpoint_samples == len(first)


def test_the_terminal_says_them_and_their_cost(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["jeffcott", *(word for key in CASE for word in ("--set", key)), "--no-picture"]
    words += ["-o", str(tmp_path / "run.h5")]
    assert frb(["runup", *words]) == 0
    assert "No uncertainties of the events: they take about 0." in capsys.readouterr().out
    assert frb(["runup", *words, "--uncertainty"]) == 0
    told = capsys.readouterr()
    assert re.search(r"14\d\.\d\(\d\)", told.out)
    assert "second, coarser run" in told.out
    assert "--force" not in told.err


def test_an_onset_on_a_table_of_solutions_is_not_certain(tmp_path: Path) -> None:
    """Both runs have the error of the table: with numbers of another machine the onset was at 230 Hz +- 4 Hz on it, and
    at 248 Hz on cells."""
    case = load_case("jeffcott", ["film.cavitation=penalty", "speed.from=100 Hz", "speed.duration=2 s"])
    assert make_plan(case).form.table_of_solutions
    events = runup(case, tmp_path / "run.h5", uncertainty=True).events
    onsets = [event for event in events if event["kind"] == "onset"]
    assert onsets
    assert all(event["certain"] is False and "table" in event["reason"] for event in onsets)
    assert all(event["speed_uncertainty_Hz"] > 0.0 for event in onsets)


@pytest.mark.parametrize(("law", "unasked"), [("elrod", True), ("reynolds", False)])
def test_its_cost_is_announced_where_it_is_made_unasked(law: str, unasked: bool) -> None:
    """The run with Elrod's law takes 1.4 times the time without it."""
    case = load_case("jeffcott", [f"film.cavitation={law}"])
    plan, profile = make_plan(case), run_up_profile(case)
    alone = expected_cost(case, plan, profile)
    second = second_run_s(case, plan, profile)
    assert is_cheap(second, alone) == unasked
    assert cost_of_run(case, plan, profile).total_s == alone.run_s + (second if unasked else 0.0)
    assert run_cost("runup", case) == cost_of_run(case, plan, profile)


@dataclass
class Long:
    """A march of eight signals in chunks of a fifth of a second."""

    time: float = 0.0
    names: tuple[str, ...] = ("time_s", *(f"signal_{number}" for number in range(7)))

    def chunk(self) -> tuple[int, dict[str, Array]]:
        self.time += 0.2
        return RUNNING, {name: np.full(20_000, self.time) for name in self.names}


def test_the_second_run_holds_its_signals_once(monkeypatch: pytest.MonkeyPatch, case: Case, run: Run) -> None:
    """And one of them twice, while its pieces are joined."""
    monkeypatch.setattr(March, "again", lambda *_: Long())
    plan = make_plan(case)
    march = March(case, plan, make_segments(case, plan), run_up_profile(case))
    tracemalloc.start()
    try:
        found = second_run.second_run(march, run)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert found is not None
    held = 8.0 * len(found) * len(Long().names)
    assert held > 50e6
    assert peak < 1.2 * held
    assert found["time_s"][0] == pytest.approx(0.2)


def test_a_second_run_that_does_not_begin_leaves_the_events(
    monkeypatch: pytest.MonkeyPatch, case: Case, tmp_path: Path
) -> None:
    def again(*_: object) -> March:
        raise NotConverged("no")

    monkeypatch.setattr(March, "again", again)
    found = runup(case, tmp_path / "run.h5", uncertainty=True)
    assert all(event["certain"] is None for event in found.events)
    assert second_run.SECOND_RUN in found.cost
    assert "does not begin" in about_certainty(found, found.events)[0]
