"""Thousands of calls of all commands with results onto inputs, links, folders and pipes: what was there before stays.

What is computed is computed once, and pictures are not drawn: it is about their places. A night has a fifth of
FRB_TRIALS calls.
"""

import functools
import importlib
import json
import os
import random
import resource
import shutil
import stat
import sys
import time
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from nights import seeds_tonight
from output_options import CALLS, CASE, RUN, SHORT, TABLE, Option, output_options

from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import find_shipped
from frbcli.cli.main import run as frb
from frbcli.results.write import MARK, PAGE, PICTURES, TABLES
from frbcli.results.write import RUN as RUN_KIND
from frbcli.runs.run import runup

TRIALS = int(os.environ.get("FRB_TRIALS", "5000"))
OWN = MARK.encode()
HEADS = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}
PICTURE = {suffix: head + OWN + bytes(500) for suffix, head in HEADS.items()}
COMPUTED = (
    "linear.sheets.bearing.bearing_sheet", "linear.response.response", "linear.stability.stability",
    "studies.sweep_workers.threshold_alone", "cycles.limit_cycles.limit_cycles", "cycles.limit_cycles.threshold_kind",
    "studies.fit.fit", "studies.accuracy.accuracy", "bearing_tests.kinematic.rotation", "report.page.report",
    "bearing_tests.kinematic.squeeze", "bearing_tests.kinematic.whirl",
)  # fmt: skip
CHECKSUM = 25 * b"0" + b"%010d" % zlib.crc32(b"film,a\n1,2.5\n")
OLD = {"old.png": PICTURE[".png"], "old.csv": b"film,a\n1,2.5" + CHECKSUM + b"\n",
       "old.html": b"<!doctype html>\n<p>old" + OWN}  # fmt: skip
OTHERS = {
    TABLE: b"t,x\n0,1\n1,2\n", "points.csv": b"rotor.unbalance\n1 g*mm\n2 g*mm\n", "notes.txt": b"notes\n",
    "rotor.json": json.dumps({"ShaftElement_0": {}}).encode(), "data.mat": b"no MAT",
    "image.png": PICTURE[".png"].replace(OWN, b""),
    "mine.csv": b"time_s,speed_Hz\n0.0,1.5\n", "mine.html": b"<!doctype html>\n<p>mine",
    "no.h5": b"",
}  # fmt: skip
SUFFIXES = (".png", ".svg", ".csv", ".html", ".h5", ".toml", ".gif", ".mat", "")
LINKED = (CASE, RUN, TABLE, "notes.txt", "old.csv", "folder", "pipe", "nothing", "folder/inside.csv", "/dev/null")
DEFAULTS = ("my-bearing.png", "my.h5", "my-summary.png", "whole.csv", "whole-report.html", "whole-waterfall.png")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A run of the case."""
    folder = tmp_path_factory.mktemp("whole")
    settings = SHORT[1::2]
    return runup(load_case("jeffcott", settings), folder / RUN).path.read_bytes()


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each result is computed once; pictures are empty."""

    def once(function: Callable[..., Any]) -> Callable[..., Any]:
        found: list[Any] = []

        @functools.wraps(function)
        def known(*arguments: Any, **options: Any) -> Any:
            if not found:
                found.append(function(*arguments, **options))
            return found[0]

        return known

    for name in COMPUTED:
        module, _, function = f"frbcli.{name}".rpartition(".")
        monkeypatch.setattr(f"frbcli.{name}", once(getattr(importlib.import_module(module), function)))
    monkeypatch.setattr("frbcli.plot.style.picture", lambda _, suffix, *__, **___: PICTURE[suffix])


def make_files(folder: Path, whole: bytes, chance: random.Random) -> None:
    """What is there before a call: inputs, earlier results, other files, links, a folder, a pipe."""
    contents = {CASE: find_shipped("jeffcott").encode(), "bearing.toml": find_shipped("bearing").encode(), RUN: whole,
                "cut.h5": whole[:-9], **OLD, **OTHERS, "folder/inside.csv": OLD["old.csv"],
                "folder/sweep.jsonl": b"mine"}  # fmt: skip
    (folder / "folder").mkdir()
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    os.mkfifo(folder / "pipe")
    (folder / "loop").symlink_to("loop")
    for number in range(6):
        (folder / f"link{number}{chance.choice(SUFFIXES)}").symlink_to(chance.choice(LINKED))
    os.link(folder / chance.choice((CASE, RUN, TABLE)), folder / f"same{chance.choice(SUFFIXES)}")
    default = folder / chance.choice(DEFAULTS)
    default.symlink_to(chance.choice(LINKED))


def state(folder: Path) -> dict[str, tuple[int, bytes | str]]:
    """Kind and content of all files: of links what they name."""
    found: dict[str, tuple[int, bytes | str]] = {}
    for path in sorted(folder.rglob("*")):
        kind, content = stat.S_IFMT(path.lstat().st_mode), b""
        if kind == stat.S_IFREG:
            content = path.read_bytes()
        found[str(path.relative_to(folder))] = (kind, os.readlink(path) if kind == stat.S_IFLNK else content)
    return found


def call(options: list[Option], there: list[str], chance: random.Random) -> list[str]:
    """A command with results at places that are taken, or not."""
    command = chance.choice(sorted(CALLS))
    words = list(CALLS[command])
    for option in options:
        if option.command == command and chance.random() < 0.8:
            name = chance.choice(there) if chance.random() < 0.85 else f"new{chance.choice(SUFFIXES)}"
            words += [option.name, name]
    if command in ("runup", "rundown") and chance.random() < 0.3:
        words.append(chance.choice(("--force", "--resume", "--no-picture")))
    if command == "export":
        words += ["--format", chance.choice(("csv", "mat"))]
    if command == "compare" and "--keep" not in words:
        words += ["--test", "rotation"]
    return [*words, "--quiet"]


def may_change(name: str, before: bytes, after: bytes, words: list[str]) -> bool:
    """Whether a file was an earlier result, whose place a whole one of its kind has taken, or by --force any file that
    the command does not read."""
    kinds = {**PICTURES, ".html": PAGE, ".csv": TABLES["csv"]}
    if RUN_KIND.head.match(before):
        return words[0] in ("runup", "rundown") and "--force" in words and RUN_KIND.head.match(after) is not None
    if "--force" in words and name != CASE:
        return any(kind.head.match(after) for kind in kinds.values())
    kind = next((kind for kind in kinds.values() if kind.head.match(before)), None)
    own = OWN in before or before == OLD["old.csv"]
    return len(before) == 0 or (name != CASE and own and kind is not None and kind.head.match(after) is not None)


@pytest.mark.nightly
def test_nothing_that_was_there_is_lost(
    whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    options, codes = output_options(), dict[int, int]()
    for command in sorted(CALLS):  # computes all, for a disk without room is none for kernels either
        folder = tmp_path / "first"
        folder.mkdir()
        make_files(folder, whole, random.Random(0))
        monkeypatch.chdir(folder)
        (folder / "folder").rename("kept")
        frb([*CALLS[command], "--quiet"])
        monkeypatch.chdir(tmp_path)
        shutil.rmtree(folder)
    begun = time.monotonic()
    seeds = seeds_tonight(range(TRIALS), 5)
    for seed in seeds:
        chance, folder = random.Random(seed), tmp_path / "trial"
        folder.mkdir()
        make_files(folder, whole, chance)
        monkeypatch.chdir(folder)
        before = state(folder)
        words = call(options, sorted(before), chance)
        limit = chance.choice((-1, -1, 0, 50, 1000, 20_000))
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit if limit >= 0 else limits[0], limits[1]))
        try:
            code = frb(words)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        codes[code] = codes.get(code, 0) + 1
        after, told = state(folder), (seed, words, limit, code, capsys.readouterr().err)
        assert code in ((0, 2, 3) if limit < 0 else (0, 1, 2, 3)), told
        for name, (kind, content) in before.items():
            assert name in after, (name, told)
            assert after[name][0] == kind, (name, told)
            if after[name][1] != content:
                assert kind == stat.S_IFREG, (name, told)
                assert isinstance(content, bytes)
                assert may_change(name, content, bytes(after[name][1]), words), (name, told)  # type: ignore[arg-type]
        assert not [name for name in after if name.endswith((".part", ".lock"))], told
        monkeypatch.chdir(tmp_path)
        shutil.rmtree(folder)
    assert codes[0] > len(seeds) // 20
    assert codes[2] > len(seeds) // 4
    told = ", ".join(f"{number} ended with {code}" for code, number in sorted(codes.items()))
    with capsys.disabled():
        sys.stdout.write(f"\n{len(seeds)} calls in {time.monotonic() - begun:.0f} s: {told}\n")
