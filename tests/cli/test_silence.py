"""No command is silent for long on a terminal: the clock of the screen is read while work is made slow."""

from pathlib import Path

import pytest
from screen import seen

import frbcli

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
