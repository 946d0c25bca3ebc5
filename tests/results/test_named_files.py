"""Files that are named, whatever they are: each command ends in one clear line, without a wait or a traceback."""

import errno
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from commands import Frb

from frbcli.case.reading.shipped import find_shipped

WAIT_s = 60  # no command may take as long
FIELD = 200_000  # characters, more than the 131072 that Python's reader of CSV takes
ROWS = "time,x,y\n0,1,1\n1,2,1\n2,1,2\n"

HAZARDS: dict[str, Callable[[Path], object]] = {
    "pipe": os.mkfifo,
    "directory": Path.mkdir,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "loop": lambda path: path.symlink_to(path.name),
    "empty": lambda path: path.write_bytes(b""),
    "zeros": lambda path: path.write_bytes(b"time,x,y\n0,\0,1\n"),
    "utf-16": lambda path: path.write_bytes(ROWS.encode("utf-16")),
    "latin-1": lambda path: path.write_bytes(b"time,x,y\n0,\xb5,1\n"),
    "binary": lambda path: path.write_bytes(bytes(range(256)) * 20),
    "long field": lambda path: path.write_text(f'time,x,y\n0,"{"a" * FIELD}",1\n1,2,1\n'),
    "long name of a column": lambda path: path.write_text(f'time,"{"x" * FIELD}",y\n0,1,1\n1,2,1\n'),
    "open quote": lambda path: path.write_text('time,x,y\n0,"1,1\n1,2,1\n' * 9000),
    "many columns": lambda path: path.write_text(f"{','.join(map(str, range(50_000)))}\n{'1,' * 49_999}1\n"),
    "tiny times": lambda path: path.write_text("time,x,y\n0,1,1\n1e-300,2,1\n2e-300,1,1\n"),
    "large times": lambda path: path.write_text("time,x,y\n0,1,1\n1e300,2,1\n1e308,1,1\n"),
    "large values": lambda path: path.write_text("time,x,y\n0,1e308,1\n1,-1e308,1\n2,1e308,2\n"),
    "large file": lambda path: os.truncate(_touched(path), 2 * 1024**3),
}
SHORT = ("--set", "film.theory=short", "--set", "speed.duration=20 ms", "--no-picture")
MEASURED = ("--x", "x", "--y", "y", "--time", "time", "--clearance", "35 um")


def _touched(path: Path) -> Path:
    path.touch()
    return path


def calls(name: str) -> Iterator[tuple[str, ...]]:
    """Every way in which a command reads a file of that name."""
    for setting in (
        f'force=[{{at="journal", file="{name}"}}]', f'base={{file="{name}"}}', f'speed={{file="{name}"}}',
        f'bearing.supply.pressure={{file="{name}"}}', f'bearing=[{{kind="coefficients", file="{name}"}}]',
    ):  # fmt: skip
        yield ("check", "my.toml", "--set", setting)
    yield ("check", "turbocharger-engine", "--set", f'housing={{file="{name}"}}')
    yield ("check", "turbocharger-car", "--set", f'rotor.file="{name}"')
    yield ("check", name)
    yield ("sweep", "my.toml", "--stability", "--list", name, "--jobs", "1", "-o", "study", *SHORT)
    yield ("compare", "my.toml", "--measured", name, *MEASURED, *SHORT)
    yield ("fit", "my.toml", "--measured", name, "--vary", "bearing.clearance", *SHORT)
    yield ("waterfall", name, *MEASURED)
    yield ("report", name)
    yield ("response", "my.toml", "--run", name, "--speed", "30 Hz", *SHORT)


@pytest.fixture(autouse=True)
def _bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A directory with a case, and an end of a wait."""

    def over(*_: object) -> None:
        raise AssertionError("waits")

    monkeypatch.chdir(tmp_path)
    Path("my.toml").write_text(find_shipped("jeffcott"))
    before = signal.signal(signal.SIGALRM, over)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def refuses(words: tuple[str, ...], frb: Frb) -> str:
    """What a command says that ends with 2."""
    signal.alarm(WAIT_s)
    said = frb(*words, code=2).err
    signal.alarm(0)
    assert said.strip()
    assert max(map(len, said.splitlines())) < 1000
    return said


@pytest.mark.parametrize("hazard", HAZARDS)
def test_a_file_that_is_none_of_what_it_should_be_is_refused(hazard: str, frb: Frb) -> None:
    HAZARDS[hazard](Path("given.csv"))
    for words in calls("given.csv"):
        if hazard in ("latin-1", "utf-16") and words[0] in ("compare", "fit", "waterfall"):
            continue  # which measurements may be
        refuses(words, frb)


@pytest.mark.parametrize("name", ["n" * 300, "nowhere", "a\0b", "x/y/z", "~"])
def test_a_name_of_no_file_is_refused(name: str, frb: Frb) -> None:
    for words in calls(f"{name}.csv"):
        refuses(words, frb)


@pytest.mark.parametrize("suffix", ["mat", "wav", "uff", "toml", "json", "h5", "txt"])
def test_files_of_every_suffix_are_refused(suffix: str, frb: Frb) -> None:
    if suffix == "uff":
        pytest.importorskip("pyuff")
    for hazard in ("pipe", "device", "directory", "empty", "zeros", "binary", "long field"):
        path = Path(f"{hazard.replace(' ', '-')}.{suffix}")
        HAZARDS[hazard](path)
        for words in calls(str(path)):
            refuses(words, frb)


def test_a_list_of_utf_8_with_its_mark_is_read(frb: Frb) -> None:
    Path("points.csv").write_bytes(b"\xef\xbb\xbfrotor.unbalance\r\n1 g*mm\r\n2 g*mm\r\n")
    frb("sweep", "my.toml", "--stability", "--list", "points.csv", "--jobs", "1", "-o", "study", *SHORT)
    assert "2 g*mm" in Path("study/sweep.csv").read_text()


@pytest.mark.parametrize("option", [("--seed", "-1"), ("--samples", "-4"), ("--samples", "0"), ("--jobs", "0")])
def test_a_number_of_an_option_that_cannot_be_is_refused(option: tuple[str, ...], frb: Frb) -> None:
    scattered = ("--set", "bearing.clearance=normal(35 um, 1 um)", "--samples", "4", "--stability", "--jobs", "1")
    said = refuses(("sweep", "my.toml", *scattered, *SHORT, *option), frb)
    assert option[0] in said


@pytest.mark.parametrize("hazard", ["pipe", "device", "directory", "binary", "zeros"])
def test_a_log_of_no_sweep_is_refused(hazard: str, frb: Frb) -> None:
    Path("points.csv").write_text("rotor.unbalance\n1 g*mm\n2 g*mm\n")
    Path("study").mkdir()
    HAZARDS[hazard](Path("study/sweep.jsonl"))
    words = ("sweep", "my.toml", "--stability", "--list", "points.csv", "--jobs", "1", "-o", "study", *SHORT)
    assert "study/sweep.jsonl" in refuses(words, frb)


def test_what_the_system_says_of_a_file_is_one_line(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    """Wherever a library meets it."""

    def denied(*_: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), "there/run.h5")

    monkeypatch.setattr("frbcli.results.store.read_run", denied)
    assert refuses(("report", "run.h5"), frb) == (
        "frb: file there/run.h5\n  file: cannot be used: Permission denied. Check path and permissions.\n"
    )


@pytest.mark.parametrize(
    ("name", "setting", "key"),
    [
        ("thrust", "thrust_bearing.end_play=1e15 m", "thrust_bearing.end_play"),
        ("thrust", "thrust_bearing.taper=20 m", "thrust_bearing.taper"),
        ("turbocharger-car-thrust", "thrust_bearing.taper=1 mm", "thrust_bearing.taper"),
        ("turbocharger-car-thrust", "thrust_bearing.end_play=2 mm", "thrust_bearing.end_play"),
        ("thrust", "thrust_bearing.outer_radius=1e9 m", "thrust_bearing.outer_radius"),
        ("jeffcott", "rotor.mass=1e12 kg", "rotor.mass"),
        ("jeffcott", "rotor.unbalance=1e9 kg*m", "rotor.unbalance"),
        ("turbocharger-car", "shaft.0.length=1e6 m", "shaft.0.length"),
        ("turbocharger-car", "disk.turbine.polar_inertia=1e12 kg*m^2", "disk.2.polar_inertia"),
        ("turbocharger-car", "disk.turbine.position=-1e9 m", "disk.2.position"),
    ],
)
def test_sizes_of_no_machine_are_refused(name: str, setting: str, key: str, frb: Frb) -> None:
    assert key in refuses(("check", name, "--set", setting), frb)
