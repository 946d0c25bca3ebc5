"""The hard cases: the quick ones here, all of them as a benchmark; and what a case that goes wrong looks like."""

import os
import time
from dataclasses import replace
from pathlib import Path

import pytest
from commands import Frb
from studies.hard_runs.cases import Reference, hard_case_result, references, run_hard_cases
from studies.hard_runs.worker import DIED, HUNG, Worker

from frbcli.case.reading.load import load_case_text
from frbcli.case.reading.shipped import HardCase, hard_cases
from frbcli.errors import InputError

ALL = hard_cases()
QUICK = [hard for hard in ALL if hard.quick]
ENDS = {"finished", "contact", "starved", "not-converged", "input-error"}
TOPICS = {
    "eccentricity 0.99", "x1 = 0.9999", "Elrod with bores", "supply 4 bar", "starving", "speed zero and reversed",
    "start at rest in the centre", "unbalance 50 g mm", "journal mass to zero", "ring mass to zero",
    "turbocharger of 100 g at 5000 Hz", "outer gap 40 um", "viscosities 1e4 apart", "clearance step in time",
}  # fmt: skip


@pytest.mark.parametrize("hard", QUICK, ids=lambda hard: hard.name)
def test_quick_hard_cases_end_as_listed(hard: HardCase) -> None:
    assert hard_case_result((hard, references().get(hard.name))).problems == ()


@pytest.mark.nightly
@pytest.mark.timing
def test_all_hard_cases_end_as_listed() -> None:
    found = run_hard_cases()
    assert {result.hard.name: result.problems for result in found.results if not result.ok} == {}
    print(found.to_pandas().to_string())  # noqa: T201


def test_the_list_covers_every_topic_and_says_why_a_case_ends_early() -> None:
    assert {hard.topic for hard in ALL} == TOPICS
    assert {hard.end for hard in ALL} <= ENDS
    assert [hard.name for hard in ALL if hard.end != "finished" and not hard.why] == []
    assert {hard.name for hard in ALL if hard.fine} == set(references())


# --- a case that goes wrong is seen ---


def quick(name: str) -> tuple[HardCase, Reference | None]:
    (hard,) = hard_cases([name])
    return hard, references().get(name)


def test_a_wrong_number_is_seen() -> None:
    hard, reference = quick("no-speed")
    assert reference is not None
    off = {name: [value + 0.01 for value in row] for name, row in reference.values.items()}
    result = hard_case_result((hard, replace(reference, values=off)))
    assert result.error == pytest.approx(0.01, abs=1e-4)
    assert [problem.split(",")[0] for problem in result.problems] == ["error 1.0e-02"]


def odd_work(task: str) -> str:
    """Hangs, dies or answers."""
    if task == "hang":
        time.sleep(60.0)
    if task == "die":
        os._exit(1)
    return f"{task} done"


def test_a_worker_that_hangs_or_dies_begins_anew() -> None:
    with Worker(odd_work) as worker:
        assert worker.ask("this", 60.0) == "this done"
        assert worker.ask("hang", 0.2) == HUNG
        assert worker.ask("die", 60.0) == DIED
        assert worker.ask("that", 60.0) == "that done"


# --- on the command line ---


def test_the_command_lists_and_shows_them(frb: Frb, tmp_path: Path) -> None:
    listed = frb("cases", "--hard", "--json").document["hard"]
    assert [entry["name"] for entry in listed] == [hard.name for hard in ALL]
    assert listed[0]["command"].startswith("frb rotation bearing-axial-groove --set ")

    copy = tmp_path / "copy.toml"
    frb("cases", "--hard", "no-speed", "-o", str(copy), "--quiet")
    assert load_case_text(copy.read_text(encoding="utf-8")).speed.end == 0.0


def test_names_that_there_are_not_are_wrong_input(frb: Frb) -> None:
    assert 'Did you mean "no-speed"?' in frb("cases", "--hard", "no-sped", code=2).err
    with pytest.raises(InputError):
        hard_cases(["no-speed", "nothing"])
