"""How commands tell how far they are, with the time left, on a terminal and without one, never silent for long; tables
of whole words."""

import re
import time
from collections import Counter
from pathlib import Path

import pytest
from screen import seen

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


LONGEST_s = 2.0
SLOW_s = 3.5
SHORT = ("--set", "film.theory=short")
# Makes a function of a module take SLOW_s longer, as a compilation or a large machine would.
SLOW = f"""
import importlib, time
def slow(module, name):
    module = importlib.import_module(module)
    whole = getattr(module, name)
    def slower(*given, **named):
        time.sleep({SLOW_s})
        return whole(*given, **named)
    setattr(module, name, slower)
"""
COMMANDS = {
    "response": ("frbcli.linear.modes", "critical_map", ("jeffcott", *SHORT, "--speed", "50 Hz", "--map")),
    "stability": ("frbcli.linear.stability", "stability", ("jeffcott", *SHORT, "--speed", "50 Hz", "--no-picture")),
    "limit-cycles": ("frbcli.cycles.limit_cycles", "limit_cycles",
                     ("jeffcott", *SHORT, "--set", "speed.from=190 Hz", "--no-picture")),
    "rotation": ("frbcli.bearing_tests.kinematic", "rotation",
                 ("bearing-axial-groove", "--set", "accuracy.mesh=[4, 16]", "--no-picture")),
    "compare": ("frbcli.studies.compare", "compare",
                ("jeffcott", *SHORT, "--cavitation", "half-sommerfeld,sommerfeld", "--set", "speed.duration=10 ms",
                 "--no-picture")),
    "report": ("frbcli.report.page", "write_report", ("run.h5",)),
    "waterfall": ("frbcli.plot.waterfall", "run_spectra", ("run.h5",)),
    "accuracy": ("frbcli.studies.accuracy", "accuracy", ("jeffcott", *SHORT, "--until", "10 ms")),
    "sweep": ("frbcli.studies.sweep", "sweep",
              ("jeffcott", *SHORT, "--set", "oil.viscosity=9 mPa*s,10 mPa*s", "--stability")),
    "plot": ("frbcli.plot.style", "save_figure", ("run.h5",)),
}  # fmt: skip


EVERY_CHANGE = ("stability", "compare", "report")  # one of each kind: the same clock watches all commands


@pytest.mark.parametrize(
    "command",
    [pytest.param(name, marks=() if name in EVERY_CHANGE else pytest.mark.nightly) for name in COMMANDS],
)
def test_slow_work_is_not_silent(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    module, name, words = COMMANDS[command]
    if "run.h5" in words:
        frbcli.runup(frbcli.load_case("jeffcott", ["film.theory=short", "speed.duration=0.3 s"]), "run.h5")
    found = seen([command, *words], f"{SLOW}\nslow({module!r}, {name!r})")
    assert found.code == 0, found.text
    assert found.silent_s < LONGEST_s
    assert "s so far" in found.text


def test_the_screen_tells_silence() -> None:
    """The measure itself: a clock that does not tick leaves the screen as it is."""
    before = f"{SLOW}\nimport frbcli.cli.progress as shown\nshown.CLOCK_AFTER_s = 1e9\n"
    module, name, words = COMMANDS["stability"]
    assert seen(["stability", *words], f"{before}slow({module!r}, {name!r})").silent_s > SLOW_s - 0.5


@pytest.mark.nightly  # compiles a time loop of its own, up to twice
def test_compiling_is_not_silent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With an empty cache, and the machine that has the fewest kernels. A machine that is shared may stand still for
    seconds: the better of two starts counts, for what the program does not tell it does not tell in both."""
    monkeypatch.chdir(tmp_path)
    words = ["runup", "seal", "--set", "speed.duration=10 ms", "--no-picture", "--force"]
    silences = []
    for trial in ("first", "second"):
        found = seen(words, environment={"NUMBA_CACHE_DIR": str(tmp_path / trial)})
        assert found.code == 0, found.text
        assert "Compiling the kernels, once" in found.text
        silences.append((found.silent_s, found.silent_after))
        if found.silent_s < LONGEST_s:
            break
    assert min(silences)[0] < LONGEST_s, silences
