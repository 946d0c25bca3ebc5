"""Nothing computed is lost: runs that were interrupted, rows that are finished, files that cannot be written."""

import contextlib
import errno
import io
import json
import os
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from commands import Frb
from output_options import MODELS, SETTINGS, SHORT

from frbcli.bearing_tests import tested_film
from frbcli.case.reading.load import load_case
from frbcli.cli.main import run
from frbcli.errors import InputError, NotConverged
from frbcli.results.container import seal
from frbcli.runs.march import March
from frbcli.runs.run import runup
from frbcli.studies import accuracy as ladder
from frbcli.studies.accuracy import verify
from frbcli.studies.compare import compare
from frbcli.studies.sweep import Workers, sweep
from frbcli.thermal.exchange import HOT

QUICK = ["jeffcott", *SHORT]
WARM = (
    "film.theory=short", "speed.duration=0.1 s", 'oil.viscosity={grade="SAE 10W-40"}',
    "thermal.supply_temperature=60 degC",
)  # fmt: skip


@pytest.fixture(autouse=True)
def in_a_directory_of_its_own(tmp_path: Path) -> Iterator[None]:
    """Not by monkeypatch: where a test undoes its patches, it would go on beside the files of the user."""
    with contextlib.chdir(tmp_path):
        yield


def ask_to_end(*_: object) -> None:
    signal.raise_signal(signal.SIGINT)


@pytest.fixture
def interrupted(tmp_path: Path) -> Path:
    """The file of a run of QUICK that was interrupted on its way."""
    path = tmp_path / "run.h5"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("frbcli.runs.march.BUDGET", 100)
        run = runup(load_case("jeffcott", SETTINGS), path, observe=ask_to_end)
    assert (run.status, len(run) > 0) == ("interrupted", True)
    return path


# --- run files ---
def test_an_interrupted_run_is_not_replaced_unasked(interrupted: Path) -> None:
    before = interrupted.read_bytes()
    with pytest.raises(InputError, match=r"--resume.*--force"):
        runup(load_case("jeffcott", SETTINGS), interrupted)
    assert interrupted.read_bytes() == before
    assert runup(load_case("jeffcott", SETTINGS), interrupted, force=True).status == "finished"


def test_command_names_the_ways_out_of_an_interrupted_run(interrupted: Path, frb: Frb) -> None:
    before = interrupted.read_bytes()
    assert "--resume" in frb("runup", *QUICK, "-o", "run.h5", code=2).err
    assert interrupted.read_bytes() == before
    frb("runup", *QUICK, "-o", "run.h5", "--resume", "--force", code=2)
    assert interrupted.read_bytes() == before
    frb("runup", *QUICK, "-o", "run.h5", "--resume", "--no-picture")
    interrupted.write_bytes(before)
    frb("runup", *QUICK, "-o", "run.h5", "--force", "--no-picture")


def test_a_run_that_has_ended_is_replaced_as_the_readme_s_first_line_needs(frb: Frb) -> None:
    for _ in range(2):
        frb("runup", *QUICK, "-o", "run.h5", "--quiet")
        frb("waterfall", "run.h5", "-o", "waterfall.png", "--window", "10 ms", "--quiet")


def test_an_interruption_before_the_first_step_leaves_no_run(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(March, "compile", ask_to_end)
        frb("runup", *QUICK, "-o", "run.h5", code=130)
    assert not Path("run.h5").exists()
    frb("runup", *QUICK, "-o", "run.h5", "--no-picture")


# --- rows ---
def after_calls(monkeypatch: pytest.MonkeyPatch, owner: Any, name: str, calls: int, error: BaseException) -> None:
    """Have a function work for some calls and then raise."""
    done, original = [0], getattr(owner, name)

    def limited(*arguments: Any, **options: Any) -> Any:
        done[0] += 1
        if done[0] > calls:
            raise error
        return original(*arguments, **options)

    monkeypatch.setattr(owner, name, limited)


@pytest.mark.parametrize(
    ("error", "code", "status"),
    [(KeyboardInterrupt(), 130, "interrupted"), (NotConverged("no way\nto begin"), 3, "not-converged")],
)
def test_finished_rows_of_a_comparison_are_printed(
    error: BaseException,
    code: int,
    status: str,
    monkeypatch: pytest.MonkeyPatch,
    frb: Frb,
) -> None:
    after_calls(monkeypatch, March, "compile", 1, error)
    said = frb("compare", *QUICK, *MODELS, "--json", code=code)
    found = json.loads(said.out)
    assert found["status"] == status
    (row,) = found["results"]
    assert (row["cavitation"], row["status"]) == ("half-sommerfeld", "finished")
    assert " ".join(found["message"].split()) == " ".join(str(error).split())


def test_a_comparison_without_a_row_ends_as_its_first_run(frb: Frb) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(March, "compile", ask_to_end)
        frb("compare", *QUICK, *MODELS, code=130)
    with pytest.MonkeyPatch.context() as patch:
        after_calls(patch, March, "compile", 0, NotConverged("no"))
        frb("compare", *QUICK, *MODELS, code=3)
    assert os.listdir() == []


def test_a_comparison_goes_on_with_the_interrupted_runs_that_it_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    case, models, folder = load_case("jeffcott", SETTINGS), ["half-sommerfeld", "sommerfeld"], Path("kept")
    with monkeypatch.context() as patch:
        patch.setattr("frbcli.runs.march.BUDGET", 100)
        compare(case, models, keep=folder, observe=ask_to_end)
    (begun,) = folder.iterdir()
    first = begun.read_bytes()
    with pytest.raises(InputError, match="another case"):
        compare(load_case("jeffcott", (*SETTINGS, "speed.to=100 Hz")), models, keep=folder)
    assert begun.read_bytes() == first
    taken_up: list[str] = []
    restore = March.restore
    monkeypatch.setattr(March, "restore", lambda march, state: (taken_up.append("yes"), restore(march, state))[1])
    assert [result.run.status for result in compare(case, models, keep=folder).results] == ["finished"] * 2
    assert taken_up == ["yes"]


def test_rungs_of_a_ladder_stay_when_it_is_interrupted(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    after_calls(monkeypatch, ladder, "runup", 4, KeyboardInterrupt())
    words = ["accuracy", "jeffcott", "--theory", "short", "--until", "10 ms", "--no-picture"]
    said = frb(*words, "--json", code=130)
    found = json.loads(said.out)
    assert (found["status"], len(found["ladder"])) == ("interrupted", 2)
    assert "2 rungs" not in said.err  # text is for people, without --json


def test_a_ladder_without_its_reference_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    original = ladder.runup
    monkeypatch.setattr(ladder, "runup", lambda *a, **o: replace(original(*a, **o), status="interrupted"))
    with pytest.raises(KeyboardInterrupt):
        ladder.accuracy(load_case("jeffcott"), 0.01, ["short"])


def test_models_of_a_test_that_are_done_are_printed(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    after_calls(monkeypatch, tested_film, "film_moment", 1, KeyboardInterrupt())
    words = ["rotation", "bearing-axial-groove", "--set", "accuracy.mesh=[4, 16]", "--no-picture", "--json"]
    said = frb(*words, "--cavitation", "half-sommerfeld,reynolds", code=130)
    found = json.loads(said.out)
    assert (found["status"], [result["cavitation"] for result in found["results"]]) == (
        "interrupted",
        ["half-sommerfeld"],
    )
    assert "Interrupted" not in said.err  # text is for people, without --json


def test_an_interrupted_point_ends_a_sweep_in_this_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("frbcli.studies.sweep._compile", lambda _: None)
    chunk = March.chunk
    monkeypatch.setattr(March, "chunk", lambda march: (ask_to_end(), chunk(march))[1])
    found = sweep(load_case("jeffcott", SETTINGS), {"rotor.unbalance": ["1 g*mm", "2 g*mm", "3 g*mm"]}, tmp_path / "s",
                  workers=Workers(jobs=1))  # fmt: skip
    assert [point.status for point in found.points] == ["interrupted"] * 3
    assert len(list((tmp_path / "s" / "runs").iterdir())) == 1


def test_an_interrupted_verification_is_no_second_run(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    case = load_case("jeffcott", SETTINGS)
    run = runup(case, "run.h5")
    seen: list[float] = []

    def observe(progress: Any) -> None:
        seen.append(progress.t_s)
        ask_to_end()

    monkeypatch.setattr("frbcli.runs.march.BUDGET", 100)
    assert verify(case, run, observe).status == "interrupted"
    assert len(seen) == 1
    monkeypatch.undo()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("frbcli.studies.accuracy.verify", ask_to_end)
        found = frb("runup", *QUICK, "-o", "again.h5", "--no-picture", "--verify", "--json", code=130).document
    assert (found["status"], found["error"]["verified"]) == ("finished", {"status": "interrupted"})


# --- a full disk ---
def test_a_full_disk_is_one_line_wherever_it_is_met(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/cache/of/kernels")
    after_calls(monkeypatch, March, "compile", 0, full)  # numba does not expect it
    said = frb("runup", *QUICK, "-o", "run.h5", "--json", code=1)
    assert json.loads(said.out)["message"] == "No space left on device: /cache/of/kernels"
    lines = [line for line in said.err.splitlines() if not line.startswith("Compiling the kernels")]  # where none are
    assert lines == ["frb: No space left on device: /cache/of/kernels"]
    monkeypatch.undo()
    after_calls(monkeypatch, March, "compile", 0, OSError(errno.EIO, "a bug"))
    with pytest.raises(OSError, match="a bug"):
        run(["runup", *QUICK, "-o", "run.h5"])


# --- a run file that somebody has made up ---

FORGED: dict[str, tuple[str, Any]] = {  # array of the checkpoint, and what makes it one of no machine
    "no numbers": ("numbers", lambda _: np.zeros(1)),
    "numbers of a table": ("numbers", lambda own: np.zeros((len(own), 2))),
    "no step": ("numbers", lambda own: np.full(len(own), np.nan)),
    "heat of nothing": ("heat", lambda _: np.zeros(2)),
    "heat without a number": ("heat", lambda own: np.full(len(own), np.nan)),
    "below absolute zero": ("heat", lambda own: np.where(np.arange(len(own)) < len(own) - 1, own, -1.0)),
    "a hot film of none": ("heat", lambda own: np.where(np.arange(len(own)) == HOT, 77.0, own)),
    "far away": ("q", lambda own: np.full(len(own), 1.0)),
    "of another size": ("q", lambda own: np.zeros(len(own) + 1)),
}


def forged(path: Path, name: str, change: Any) -> None:
    """A run file with another array in its checkpoint, and the checksum of that."""
    content = io.BytesIO(path.read_bytes())
    with h5py.File(content, "r+") as file:
        own = file["checkpoint"][name][...]
        del file["checkpoint"][name]
        file["checkpoint"][name] = change(own)
    seal(content)
    path.write_bytes(content.getvalue())


@pytest.fixture(scope="module")
def warm_run(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A run with heat that was interrupted."""
    path = tmp_path_factory.mktemp("warm") / "run.h5"
    assert runup(load_case("jeffcott", WARM), path, observe=ask_to_end).status == "interrupted"
    return path.read_bytes()


@pytest.mark.parametrize("forgery", FORGED)
def test_a_checkpoint_of_another_machine_is_refused(forgery: str, warm_run: bytes, frb: Frb) -> None:
    """By what resumes it; what reads the run says so, or has no need of it."""
    Path("run.h5").write_bytes(warm_run)
    forged(Path("run.h5"), *FORGED[forgery])
    before = Path("run.h5").read_bytes()
    words = ["runup", "jeffcott", *(word for each in WARM for word in ("--set", each)), "-o", "run.h5", "--no-picture"]
    assert "cannot be resumed" in frb(*words, "--resume", code=2).err
    assert Path("run.h5").read_bytes() == before
    assert run(["report", "run.h5"]) in (0, 2)
    assert run(["export", "run.h5"]) in (0, 2)
