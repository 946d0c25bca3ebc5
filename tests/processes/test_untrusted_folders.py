"""No file of the current folder is a setting, a module or a program of frb, and none of the home that others write."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import frbcli
import frbcli.compiled

CHART = ("plot", "run.h5", "--what", "orbit", "--animate", "-o", "moving.mp4")
PICTURE = ("waterfall", "run.h5", "-o", "waterfall.png")
SHEET = ("bearing", "jeffcott", "--speed", "100 Hz", "--no-picture")
RUN = ("runup", "jeffcott", "--set", "film.theory=short", "--set", "speed.duration=0.1 s", "--no-picture")
WITHIN_s = 120.0
RAN = "ran"  # the mark that code of the folder leaves
PROGRAM = f'#!/bin/sh\necho ran > {RAN}\necho "ffmpeg version 6.0"\ncat > /dev/null\n'
MODULE = f"open({RAN!r}, 'w').write(__name__)\nraise SystemExit('imported from the current folder')\n"


def frb(place: Path, *words: str, **settings: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "frbcli", *words]
    return subprocess.run(command, cwd=place, env=os.environ | settings, capture_output=True, text=True,
                          timeout=WITHIN_s)  # fmt: skip


@pytest.fixture(scope="module")
def run_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("run")
    done = frb(place, *RUN, "-o", "run.h5")
    assert done.returncode == 0, done.stderr
    return place / "run.h5"


@pytest.fixture
def place(run_file: Path, tmp_path: Path) -> Path:
    """A folder with a run."""
    shutil.copyfile(run_file, tmp_path / "run.h5")
    return tmp_path


def program(path: Path) -> Path:
    path.write_text(PROGRAM)
    path.chmod(0o755)
    return path


# --- settings ---

NUMBA = {
    "code": b"cache_dir: ./cache\n",
    "another compiler": b"disable_jit: 1\nopt: 0\n",
    "no yaml": b"[",
    "no text": b"\xff\xfe\x00",
}


@pytest.mark.parametrize("content", NUMBA.values(), ids=NUMBA)
def test_numba_takes_no_settings_from_the_current_folder(tmp_path: Path, content: bytes) -> None:
    """Its cache is a pickle; PyYAML, with which it reads its settings, comes with several extras."""
    pytest.importorskip("yaml")
    frb(tmp_path, *SHEET)  # compiles, maybe
    (tmp_path / ".numba_config.yaml").write_bytes(content)
    done = frb(tmp_path, *SHEET)
    assert (done.returncode, done.stderr) == (0, "")
    assert [file.name for file in tmp_path.iterdir()] == [".numba_config.yaml"]


IN_PYTHON = """
import {first}, frbcli
from numba import njit
from numba.core import config
from frbcli.film.parabola import hermite
assert njit(lambda x: x + 1.0)(1.0) == 2.0  # numba looks for settings again when it compiles
print(config.CACHE_DIR, hermite._cache.cache_path)
"""


@pytest.mark.parametrize("first", ["sys", "matplotlib"])
def test_numba_takes_none_in_a_session_of_python(tmp_path: Path, first: str) -> None:
    pytest.importorskip("yaml")
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: ./cache\n")
    words = [sys.executable, "-c", IN_PYTHON.format(first=first)]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == str(Path(frbcli.__file__).parent / "film" / "__pycache__")
    assert not (tmp_path / "cache").exists()


MATPLOTLIB: dict[str, Callable[[Path], object]] = {
    "tex": lambda file: file.write_text("text.usetex: True\n"),
    "no text": lambda file: file.write_bytes(b"font.size: \xff\n"),
    "fifo": os.mkfifo,
    "look": lambda file: file.write_text("font.size: 30\naxes.facecolor: red\nnothing: 3\n"),
}


@pytest.mark.parametrize("make", MATPLOTLIB.values(), ids=MATPLOTLIB)
def test_matplotlib_takes_no_settings_from_the_current_folder(place: Path, make: Callable[[Path], object]) -> None:
    plain = frb(place, *PICTURE)
    expected = (place / "waterfall.png").read_bytes()
    make(place / "matplotlibrc")
    done = frb(place, *PICTURE)
    assert (done.returncode, done.stderr) == (0, plain.stderr)
    assert (place / "waterfall.png").read_bytes() == expected


def test_no_program_comes_from_the_current_folder(place: Path) -> None:
    """Not by the settings of matplotlib, and not by an entry of PATH that is no folder's full name."""
    (place / "matplotlibrc").write_text(f"animation.ffmpeg_path: {program(place / 'mine')}\n")
    program(place / "ffmpeg")
    (place / "bin").mkdir()
    program(place / "bin" / "ffmpeg")
    for path in ("", ".", ":", "bin", f"bin:{os.environ['PATH']}", f":{os.environ['PATH']}"):
        frb(place, *CHART, PATH=path)
        assert not (place / RAN).exists(), path
    settings = place / "own"  # of this user, by a variable of the environment
    settings.write_text(f"animation.ffmpeg_path: {place / 'mine'}\n")
    frb(place, *CHART, MATPLOTLIBRC=str(settings))
    assert (place / RAN).exists()


# --- modules ---


def test_no_module_comes_from_the_current_folder(tmp_path: Path) -> None:
    """Nor do those of the processes of a sweep."""
    for name in ("joblib", "threading", "numpy", "typing", "__future__", "random", "click", "matplotlib", "secrets"):
        (tmp_path / f"{name}.py").write_text(MODULE)
    done = frb(tmp_path, "sweep", "jeffcott", "--set", "rotor.unbalance=1 g*mm,2 g*mm", "--set", "film.theory=short",
               "--set", "speed.duration=10 ms", "--jobs", "2", "--no-runs", "--no-picture", "-o", "out")  # fmt: skip
    assert not (tmp_path / RAN).exists()
    assert done.returncode == 0, done.stderr


# --- the home ---


def home_of(folder: Path) -> dict[str, str]:
    left = dict.fromkeys(("XDG_CONFIG_HOME", "XDG_CACHE_HOME", "MPLCONFIGDIR", "MATPLOTLIBRC"), "")
    return {**left, "HOME": str(folder), "TMPDIR": str(folder.parent / "temporary")}


@pytest.mark.parametrize("safe", [True, False])
def test_settings_in_a_home_that_others_write_name_no_program(place: Path, safe: bool) -> None:
    (place / "temporary").mkdir()
    folder = place / "home" / ".config" / "matplotlib"
    folder.mkdir(parents=True)
    folder.chmod(0o700 if safe else 0o777)
    (folder / "matplotlibrc").write_text(f"animation.ffmpeg_path: {program(place / 'mine')}\n")
    frb(place, *CHART, **home_of(place / "home"))
    assert (place / RAN).exists() is safe


DAMAGED: dict[str, Callable[[Path], object]] = {
    "empty": Path.touch,
    "cut": lambda file: file.write_text('{"_version": 390, "ttflist": [{"fname"'),
    "fifo": os.mkfifo,
    "device": lambda file: file.symlink_to("/dev/zero"),
}


@pytest.mark.parametrize("make", DAMAGED.values(), ids=DAMAGED)
def test_a_damaged_list_of_fonts_stops_no_picture(place: Path, make: Callable[[Path], object]) -> None:
    (place / "temporary").mkdir()
    cache = place / "home" / ".cache" / "matplotlib"
    settings = home_of(place / "home")
    assert frb(place, *PICTURE, **settings).returncode == 0
    expected = (place / "waterfall.png").read_bytes()
    (fonts,) = cache.glob("fontlist-*.json")
    fonts.unlink()
    make(fonts)
    done = frb(place, *PICTURE, **settings)
    assert (done.returncode, done.stderr) == (0, "")
    assert (place / "waterfall.png").read_bytes() == expected


def test_settings_that_cannot_be_read_are_one_line(place: Path) -> None:
    folder = place / "home" / ".config" / "matplotlib"
    folder.mkdir(parents=True)
    (folder / "matplotlibrc").write_bytes(b"font.size: \xff\n")
    done = frb(place, *PICTURE, **home_of(place / "home"))
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith("frb: matplotlib cannot read its settings (matplotlibrc): ")
    assert "Traceback" not in done.stderr
