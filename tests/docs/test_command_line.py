"""Exit codes and streams of docs/command-line.md: the table of command_lines.md is run, line after line."""

import json
import re
import shlex
import shutil
from pathlib import Path
from typing import NamedTuple

import pytest
from commands import Frb
from paths import DOCS

from frbcli.cli.main import COMMANDS

PAGE = DOCS / "command-line.md"
LINES = Path(__file__).with_name("command_lines.md")
ROW = re.compile(r"^\| `frb (.+?)` \| (\d+) \| (.*?) \| (.*?) \|$", re.MULTILINE)
# no results for people
TEXTS = ("--help", "--version", "cases jeffcott", "schema", "docs conventions --text", "export run.h5 -o -")
# Said on slow machines, and where kernels are not compiled yet
LEFT, COUNT, COMPILING = r".*(?:\d:\d\d|\?) left.*", r"(?:frame )?\d+ of \d+", "Compiling the kernels, once.*"
PROGRESS = re.compile(rf"^(?:{LEFT}|{COUNT}|{COMPILING})\n", re.MULTILINE)
# Their documents: test_cli_stability.py, that of the same picture that does not move, test_fit.py
LONG = (
    "limit-cycles my.toml --set film.theory=short --csv cycles.csv",
    "plot run.h5 --what orbit --animate",
    'fit my.toml --set film.theory=short --set "speed.duration=0.3 s" --set "rotor.unbalance=4 g*mm" '
    "--measured run.h5 --vary rotor.unbalance",
)


class Line(NamedTuple):
    """A row of the table: what is called, how it ends, and words of stdout and stderr."""

    words: str
    code: int
    out: list[str]
    err: list[str]


def table() -> list[Line]:
    rows = ROW.findall(LINES.read_text(encoding="utf-8"))
    return [Line(words, int(code), *(re.findall(r"`([^`]+)`", cell) for cell in cells)) for words, code, *cells in rows]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The directory of all lines."""
    return tmp_path_factory.mktemp("lines")


def assert_says(said: str, words: list[str]) -> None:
    assert [word for word in words if word not in said] == []
    assert bool(said) == bool(words)


@pytest.mark.parametrize("line", table(), ids=lambda line: f"{line.words} ends with {line.code}")
def test_each_line_of_the_table_is_true(
    line: Line, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    words = shlex.split(line.words)
    there = sorted(file.name for file in folder.iterdir())
    if line.words not in (*TEXTS, *LONG):  # wrong input leaves the folder as it is
        monkeypatch.chdir(folder if line.code == 2 else shutil.copytree(folder, tmp_path / "before"))
        said = frb(*words, "--json", code=line.code)
        assert isinstance(json.loads(said.out), dict)
        assert_says(PROGRESS.sub("", said.err), line.err)
    monkeypatch.chdir(folder)
    said = frb(*words, code=line.code)
    assert_says(said.out, line.out)
    assert_says(PROGRESS.sub("", said.err), line.err)
    assert not [word for word in line.err if word in said.out]
    assert line.code != 2 or sorted(file.name for file in folder.iterdir()) == there


def test_the_table_has_every_command_and_what_makes_it_fail() -> None:
    ends: dict[str, set[int]] = {name: set() for name in COMMANDS}
    for line in table():
        ends.setdefault(line.words.split()[0], set()).add(line.code)
    assert all(0 in codes for codes in ends.values())
    codes = re.findall(r"^\| (\d+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert codes == ["0", "1", "2", "3", "130", "141"]
    assert {code for found in ends.values() for code in found} == {0, 2, 3}
