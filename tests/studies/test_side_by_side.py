"""Runs beside each other: the same as one after the other, with progress and a clean end."""

import signal
from pathlib import Path

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.errors import InputError
from frbcli.results.store import Run, check_output
from frbcli.runs.march import Progress
from frbcli.studies.against import RunTask, in_turn, side_by_side

QUICK = ("speed.from=20 Hz", "speed.to=120 Hz", "film.theory=short", "output.step=2e-4 s")
LAWS = ("half-sommerfeld", "sommerfeld")


def tasks(folder: Path, duration: str) -> list[RunTask]:
    settings = (*QUICK, f"speed.duration={duration}")
    cases = [load_case("jeffcott", (*settings, f"film.cavitation={law}")) for law in LAWS]
    numbered = enumerate(cases, start=1)
    return [RunTask(number, "runup", case, folder / f"{number}.h5", False) for number, case in numbered]


def untold(number: int, progress: Progress) -> None:
    """Nobody listens."""


def test_runs_beside_each_other_are_those_one_after_the_other(tmp_path: Path) -> None:
    for name in ("alone", "beside"):
        (tmp_path / name).mkdir()
    (tmp_path / "beside" / "2.h5").write_text("not a run")  # in the way of the second one
    alone = dict(in_turn(tasks(tmp_path / "alone", "0.2 s"), untold))
    beside = dict(side_by_side(tasks(tmp_path / "beside", "0.2 s"), untold))
    first, second = alone[1], beside[1]
    assert isinstance(first, Run)
    assert isinstance(second, Run)
    assert list(first.signals) == list(second.signals)
    for signal_name in first.signals:
        np.testing.assert_array_equal(first[signal_name], second[signal_name])
    with pytest.raises(InputError) as expected:
        check_output(tmp_path / "beside" / "2.h5")
    assert isinstance(beside[2], InputError)
    assert beside[2].faults == expected.value.faults


def test_ctrl_c_ends_all_runs_under_way_as_it_does_one(tmp_path: Path) -> None:
    numbers: set[int] = set()

    def report(number: int, progress: Progress) -> None:
        numbers.add(number)
        assert progress.end_s == 400.0
        if numbers == {1, 2}:
            signal.raise_signal(signal.SIGINT)

    ended = dict(side_by_side(tasks(tmp_path, "400 s"), report))
    statuses = {number: run.status for number, run in ended.items() if isinstance(run, Run)}
    assert statuses == {1: "interrupted", 2: "interrupted"}
    assert sorted(file.name for file in tmp_path.iterdir()) == ["1.h5", "2.h5"]
