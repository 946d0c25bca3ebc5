"""Numbers that ask too much: what a run holds in memory, what it costs before it begins, and that it is told before."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from frbcli.case.reading import load
from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.runs.run import runup
from frbcli.scene.course import MOST_SAMPLES, longest_step
from frbcli.scene.planning.plan import make_plan


def test_a_run_of_an_instant_holds_few_samples(tmp_path: Path) -> None:
    """A step of a millisecond would pass 5e11 of its samples."""
    case = load_case("jeffcott", ["speed.duration=1e-14 s", "speed.hold=0 s", "output.step=2e-15 s"])
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    assert len(run) == 6


def test_a_step_passes_no_more_samples_than_fit_in_memory() -> None:
    fine = load_case("jeffcott", ["speed.duration=1 ms", "speed.hold=0 s", "output.step=1e-10 s"])
    assert longest_step(fine, make_plan(fine)) == MOST_SAMPLES * 1e-10
    usual = load_case("jeffcott")
    assert longest_step(usual, make_plan(usual)) == 1e-3


# --- little memory ---

needs_ulimit = pytest.mark.skipif(shutil.which("sh") is None or sys.platform == "win32", reason="ulimit -v")


def limited(kilobytes: int, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = ["sh", "-c", f'ulimit -v {kilobytes} && exec "$@"', "sh", sys.executable, "-m", "frbcli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)


@needs_ulimit
@pytest.mark.parametrize("kilobytes", [80_000, 500_000])
def test_little_memory_is_told_in_one_line(kilobytes: int, tmp_path: Path) -> None:
    """Without asking before, libraries fail to load, wait forever, or abort."""
    done = limited(kilobytes, "runup", "jeffcott", "--json", "-o", str(tmp_path / "run.h5"))
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("frb: out of memory")
    assert f"{kilobytes * 1024 / 1e6:.0f} MB (ulimit -v)" in done.stderr
    assert json.loads(done.stdout)["status"] == "error"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("error", [MemoryError(), MemoryError("Unable to allocate 116. TiB for an array")])
def test_memory_that_runs_out_later_is_told_in_one_line(
    error: MemoryError, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails(*_: object) -> None:
        raise error

    monkeypatch.setattr(load, "load_case", fails)
    assert frb(["check", "jeffcott"]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert told.startswith(f"frb: out of memory{f' ({error})' if str(error) else ''}.")


@needs_ulimit
def test_what_computes_nothing_needs_little_memory() -> None:
    assert "jeffcott" in limited(60_000, "cases", "--json").stdout
