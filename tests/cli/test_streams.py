"""stdout and stderr that are full, closed, or read by nobody: one line where it can be told, no traceback."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest
from paths import ROOT

from frbcli.cli.main import COMMANDS, run

FULL, CLOSED, UNREAD = "No space left on device", "Bad file descriptor", ""
SHELL = {FULL: "{}>/dev/full", CLOSED: "{}>&-", UNREAD: ""}
SHORT = ("--set", "film.theory=short", "--set", "speed.duration=0.05 s", "--no-picture")
COARSE = ("--set", "accuracy.mesh=[4, 16]", "--cavitation", "half-sommerfeld", "--no-picture")
MOMENT = ("--set", "motion.periods=0.1", *COARSE)


class Command(NamedTuple):
    """What is called, the streams that it speaks on, and its exit code where all of them take what it says."""

    words: tuple[str, ...]
    speaks: str
    code: int = 0


QUICK = [
    Command(("--help",), "out"),
    Command((), "err", 2),
    Command(("schema",), "out"),
    Command(("cases",), "out err"),
    Command(("cases", "--json"), "out err"),
    Command(("docs", "conventions", "--text"), "out"),
    Command(("cases", "nothing"), "err", 2),
]
SLOW = [
    Command(("check", "jeffcott"), "out"),
    Command(("stability", "jeffcott", "--speed", "30 Hz", "--set", "film.theory=short", "--no-picture"), "out"),
    Command(("bearing", "jeffcott", "--speed", "30 Hz", "--no-picture"), "out"),
    Command(("thrust", "thrust", "--gap", "12 um", "--speed", "900 Hz", "--no-picture"), "out"),
    Command(("warm-up", "nothing"), "err", 2),
    Command(("response", "jeffcott", "--speed", "30 Hz", "--set", "film.theory=short", "--no-picture"), "out"),
    Command(("limit-cycles", "jeffcott", "--set", "film.theory=short", "--set", "speed.to=100 Hz", "--no-picture"),
            "out"),
    Command(("rotation", "bearing-axial-groove", *COARSE), "out"),
    Command(("squeeze", "squeeze", *MOMENT), "out"),
    Command(("whirl", "whirl", *MOMENT), "out"),
    Command(("runup", "jeffcott", *SHORT), "out"),
    Command(("rundown", "jeffcott", *SHORT), "out"),
    Command(("compare", "jeffcott", "--cavitation", "half-sommerfeld,sommerfeld", *SHORT), "out"),
    Command(("accuracy", "jeffcott", "--theory", "short", "--until", "10 ms", "--no-picture"), "out"),
    Command(("sweep", "jeffcott", "--stability", "--jobs", "1", "--set", "film.theory=short", "--set",
             "rotor.unbalance=1 g*mm,2 g*mm", "--no-picture"), "out err"),
    Command(("waterfall", "run.h5", "--window", "10 ms"), "out"),
    Command(("plot", "run.h5"), "out"),
    Command(("fit", "jeffcott", "--measured", "run.h5", "--vary", "oil.viscosity", *SHORT), "err", 2),
    Command(("balance", "run.h5", "--planes", "nowhere"), "err", 2),
    Command(("export", "run.h5"), "out"),
    Command(("report", "run.h5"), "out"),
]  # fmt: skip
# All commands speak through one terminal: of those that compute these are tried for every change
EVERY_CHANGE = ("check", "runup", "sweep", "plot", "export")
LOST = [("out", fault) for fault in SHELL] + [("err", fault) for fault in SHELL] + [("out err", f) for f in SHELL]


@pytest.fixture(scope="module")
def run_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "run.h5"
    assert run(["runup", "jeffcott", *SHORT, "--quiet", "-o", str(path)]) == 0
    return path


@contextmanager
def unread_pipe() -> Iterator[int]:
    """The end for writing of a pipe that has no other end any more."""
    ours, theirs = os.pipe()
    os.close(ours)
    try:
        yield theirs
    finally:
        os.close(theirs)


def with_lost(command: Command, streams: str, fault: str, cwd: Path) -> tuple[int, dict[str, str]]:
    """Exit code of a command some of whose streams take nothing, and what was said on the others."""
    numbers = {"out": 1, "err": 2}
    redirections = " ".join(SHELL[fault].format(numbers[stream]) for stream in streams.split())
    words = ["sh", "-c", f'exec "$@" {redirections}', "sh", sys.executable, "-m", "frbcli", *command.words]
    with unread_pipe() as unread:
        ends = {stream: unread if fault == UNREAD and stream in streams else subprocess.PIPE for stream in numbers}
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            words, stdout=ends["out"], stderr=ends["err"], cwd=cwd, env=environment, text=True, check=False
        )
    return done.returncode, {"out": done.stdout or "", "err": done.stderr or ""}


def assert_quiet_or_told(command: Command, streams: str, fault: str, cwd: Path) -> None:
    code, said = with_lost(command, streams, fault, cwd)
    lost = [stream for stream in streams.split() if stream in command.speaks]
    if command.code or not lost:
        assert code == command.code
    else:
        assert code == (141 if fault == UNREAD else 1)
    assert "Traceback" not in said["out"] + said["err"]
    assert "Exception" not in said["out"] + said["err"]
    told = [f"frb: std{stream} cannot be written: {fault}." for stream in lost if fault != UNREAD]
    if lost == ["err"] and "--json" in command.words:
        told = []  # stdout is for one document
    for other in {"out", "err"} - set(streams.split()):
        assert [line for line in said[other].splitlines() if "cannot be written" in line] == told
        assert bool(said[other]) == bool(told or other in command.speaks)


@pytest.mark.parametrize(("streams", "fault"), LOST, ids=str)
@pytest.mark.parametrize("command", QUICK, ids=lambda command: " ".join(command.words))
def test_a_stream_that_takes_nothing_is_told_on_the_other(
    command: Command, streams: str, fault: str, tmp_path: Path
) -> None:
    assert_quiet_or_told(command, streams, fault, tmp_path)


@pytest.mark.parametrize(
    ("command", "streams", "fault"),
    [
        pytest.param(command, streams, fault, marks=() if command.words[0] in EVERY_CHANGE else pytest.mark.nightly)
        for streams, fault, names in (
            ("out", FULL, COMMANDS),
            ("out", UNREAD, ("stability", "runup", "plot")),
            ("err", CLOSED, ("sweep", "compare")),
        )
        for command in SLOW if command.words[0] in names
    ],
    ids=lambda value: value.words[0] if isinstance(value, Command) else value,
)  # fmt: skip
def test_commands_that_compute_end_so_too(
    command: Command, streams: str, fault: str, run_file: Path, tmp_path: Path
) -> None:
    shutil.copy(run_file, tmp_path)
    assert_quiet_or_told(command, streams, fault, tmp_path)


def test_every_command_is_tried() -> None:
    assert {command.words[0] for command in QUICK + SLOW if command.words} >= set(COMMANDS)


def test_files_are_finished_although_nobody_reads(tmp_path: Path) -> None:
    words = ("runup", "jeffcott", *SHORT[:-1], "-o", "run.h5")
    code, said = with_lost(Command(words, "out"), "out", UNREAD, tmp_path)
    assert (code, said["err"]) == (141, "")
    assert {file.name for file in tmp_path.iterdir()} == {"run.h5", "run-summary.png"}
    assert run(["export", str(tmp_path / "run.h5"), "--quiet"]) == 0


def test_no_file_is_taken_for_a_stream_that_was_closed(tmp_path: Path) -> None:
    words = ("runup", "jeffcott", *SHORT, "-o", "run.h5")
    code, _ = with_lost(Command(words, "out"), "out err", CLOSED, tmp_path)
    assert code == 1
    assert run(["export", str(tmp_path / "run.h5"), "--quiet"]) == 0


def test_a_table_of_many_lines_stops_where_its_reader_does(run_file: Path) -> None:
    command = Command(("export", "run.h5", "-o", "-"), "out")
    assert with_lost(command, "out", UNREAD, run_file.parent) == (141, {"out": "", "err": ""})
    assert_quiet_or_told(command, "out", FULL, run_file.parent)


@pytest.mark.parametrize(
    "variables",
    [{}, {"FORCE_COLOR": "1"}, *(pytest.param({name: value}, marks=pytest.mark.nightly)
                                 for name, value in (("NO_COLOR", "1"), ("COLUMNS", "200")))],
    ids=str,
)  # fmt: skip
def test_a_table_in_a_pipe_is_plain_and_eighty_columns_wide(variables: dict[str, str]) -> None:
    words = [sys.executable, "-m", "frbcli", "cases", "--hard"]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TERM": "xterm-256color"} | variables
    said = subprocess.run(words, env=environment, capture_output=True, text=True, check=True).stdout
    assert "\x1b" not in said
    assert max(map(len, said.splitlines())) == 80


def test_letters_that_a_stream_does_not_know_are_no_bug(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "latin-1"}
    words = [sys.executable, "-m", "frbcli", "check", "jeffcott", "--set", "title=漢"]
    done = subprocess.run(words, env=environment, cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 0
    assert b"jeffcott: ?" in done.stdout


def test_a_process_ends_as_soon_as_libraries_have_done_what_they_do_at_the_exit() -> None:
    """Objects that are left are not taken apart; what was said arrives, and so does the exit code."""
    code = """
import atexit, os, sys
import frbcli.cli.main as commands
from frbcli.cli.process import main
class Kept:
    def __del__(self, write=os.write): write(1, b"taken apart")
def run(words):
    atexit.register(lambda: sys.stdout.write("library"))
    return 3
kept, commands.run = Kept(), run
main()
"""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (3, "library", "")
