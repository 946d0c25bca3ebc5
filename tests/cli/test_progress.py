"""How commands tell how far they are, with the time left, on a terminal and without one; tables of whole words."""

import re
import time
from collections import Counter

import pytest

import frbcli
from frbcli.cli import common, progress
from frbcli.cli.common import Terminal
from frbcli.cli.main import run
from frbcli.cli.progress import Display
from frbcli.runs.march import Progress

PROGRESS = Progress(0.5, 1.0, 30.0, 0.4, 100, 40.0, 1e6, 3.0)


def test_the_time_left_is_that_of_the_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first number, which compiles, does not count: then 2 s each."""
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    lines: list[str] = []
    observe = Display(Terminal(), lines.append).counting()
    for number in range(1, 6):
        observe(number, 10)
        now[0] += 2.0
    assert lines[0] == "1 of 10"
    assert lines[-1] == "5 of 10  0:10 left"


def test_without_a_terminal_a_line_comes_now_and_then(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    spent = [0.0]
    monkeypatch.setattr(time, "process_time", lambda: spent[0])
    shown = Display(Terminal())
    observe, tell = shown.counting(), shown.of_runs()
    for number in range(1, 100):
        observe(number, 100)
        tell("a rung", number, 100, PROGRESS)
        spent[0] += 1.0
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2 * int(99 / (progress.PRINT_EVERY_s + 1.0))
    assert any(re.match(r"\d+ of 100: a rung: .*left$", line) for line in lines)


def test_what_is_done_is_not_announced(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """One test whose kernels took a slow machine 40 s to compile ended with the line "1 of 1"."""
    spent = [0.0]
    monkeypatch.setattr(time, "process_time", lambda: spent[0])
    observe = Display(Terminal()).counting()
    spent[0] += progress.PRINT_EVERY_s + 10.0
    observe(1, 1)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(("each_s", "said"), [(0.4, ["4 of 120  0:46 left"]), (0.01, [])])
def test_without_a_terminal_what_takes_long_is_announced(
    each_s: float, said: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Once, after the first numbers: the response of a shaft with hundreds of modes took 26 s without a word."""
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    observe = Display(Terminal()).counting()
    for number in range(1, 30):
        observe(number, 120)
        now[0] += each_s
    assert capsys.readouterr().err.splitlines() == said


def test_stability_is_told_speed_by_speed() -> None:
    seen: list[tuple[int, int]] = []
    case = frbcli.load_case("jeffcott", ["film.theory=short"])
    frbcli.stability(case, [50.0], lambda *told: seen.append(told), threshold=True)
    assert len(seen) > 1  # the speed asked for, and those that the threshold is looked for at
    assert seen == [(number, len(seen)) for number in range(1, len(seen) + 1)]


def test_a_squeeze_is_told_moment_by_moment_and_a_rotation_model_by_model() -> None:
    """The moments of both models are counted through: those that their histories hold."""
    seen: list[tuple[int, int]] = []
    squeeze = frbcli.load_case("squeeze", ["motion.periods=0.1", "accuracy.mesh=[4, 16]"])
    moved = frbcli.squeeze(squeeze, ["half-sommerfeld", "sommerfeld"], lambda *told: seen.append(told))
    whole = sum(len(result.history.time_s) for result in moved.results if result.history is not None)
    assert whole > 2
    assert seen == [(number, whole) for number in range(1, whole + 1)]
    turns: list[tuple[int, int]] = []
    bearing = frbcli.load_case("bearing-axial-groove", ["accuracy.mesh=[4, 16]"])
    frbcli.rotation(bearing, ["half-sommerfeld", "sommerfeld"], lambda *told: turns.append(told))
    assert turns == [(1, 2), (2, 2)]


@pytest.mark.parametrize("words", [
    ["check", "turbocharger-car"], ["check", "floating-ring", "--all"],
    ["cases", "--hard"],
    pytest.param(["stability", "turbocharger-heavy", "--speed", "500 Hz"], marks=pytest.mark.nightly),
    ["rotation", "bearing-axial-groove", "--cavitation", "half-sommerfeld,two-phase", "--set", "accuracy.mesh=[8, 32]"],
])  # fmt: skip
def test_tables_break_no_words(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """On 80 columns: every word of a cell stands in one piece, as on a very wide table."""
    given = ["--no-picture"] if words[0] in ("stability", "rotation", "limit-cycles") else []
    run([*words, *given])
    narrow = capsys.readouterr().out
    assert max(len(line) for line in narrow.splitlines() if line.startswith("  ")) <= 80
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(common, "PIPE_WIDTH", 400)
        run([*words, *given])
    wide = capsys.readouterr().out
    told = re.compile(r"[A-Za-z][A-Za-z_.-]{3,}")  # numbers of a cost change from run to run
    missing = Counter(told.findall(wide)) - Counter(told.findall(narrow))
    assert not missing


def test_a_table_that_is_too_wide_for_its_words_becomes_several(capsys: pytest.CaptureFixture[str]) -> None:
    names = [f"column-{number}" for number in range(12)]
    common.Terminal().table("Wide", names, [[f"value-{number}{row}" for number in range(12)] for row in range(3)])
    told = capsys.readouterr().out
    assert max(len(line) for line in told.splitlines()) <= common.PIPE_WIDTH
    assert set(names) <= set(told.split())
    assert {f"value-{number}{row}" for number in range(12) for row in range(3)} <= set(told.split())
    assert told.count("Wide") == 1
    assert told.count("value-01") == told.count("column-0 ") > 1  # each part begins with the first column
