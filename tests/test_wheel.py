"""A wheel that brings its kernels along compiles nothing where it is installed."""

import csv
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from llvmlite import binding
from numba import __version__
from numba.core import config, registry

from frbcli import caches
from frbcli.caches import FEATURES, KERNELS, NEEDED, take_shipped_kernels

PROJECT = Path(__file__).parents[1]
SCRIPT = PROJECT / ".ci" / "wheel"
TARGET = "x86-64-v3"
PURE = "frbcli-0.1.0-py3-none-any.whl"
WHEEL = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"

# A run-up of the machine without films, which has the fewest kernels; its processor, and what was compiled
RUN = """
import json, sys, frbcli
from frbcli.compiled import counted
with counted() as compilations:
    frbcli.runup(frbcli.load_case("seal", ["speed.duration=0.01 s", *sys.argv[2:]]), sys.argv[1])
from numba.core import config
print(json.dumps([frbcli.__file__, config.CPU_NAME, compilations.functions]))
"""


def pure_wheel(path: Path) -> None:
    """A wheel of the package as it stands, as the build of the project makes it, without what it may leave out."""
    package = [file for file in (PROJECT / "frbcli").rglob("*") if file.is_file() and file.parent.name != "__pycache__"]
    with zipfile.ZipFile(path, "w") as archive:
        for file in package:
            archive.write(file, file.relative_to(PROJECT).as_posix())
        for case in (PROJECT / "cases").rglob("*.*"):
            archive.write(case, f"frbcli/shipped_cases/{case.relative_to(PROJECT / 'cases').as_posix()}")
        archive.writestr("frbcli-0.1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: frbcli\nVersion: 0.1.0\n")
        archive.writestr("frbcli-0.1.0.dist-info/WHEEL", WHEEL)
        archive.writestr("frbcli-0.1.0.dist-info/RECORD", "")


def run_installed(place: Path, folder: Path, *case: str, **settings: str) -> tuple[str, str | None, int]:
    """(file of the package, processor, functions compiled) of a run-up in a process of its own. case: its settings."""
    left_out = ("NUMBA_CACHE_DIR", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")
    environment = {name: value for name, value in os.environ.items() if name not in left_out}
    environment |= {"PYTHONPATH": str(place), **settings}
    folder.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(folder / "run.h5"), *case], env=environment, cwd=folder, capture_output=True,
        text=True, check=True,
    )  # fmt: skip
    found = json.loads(done.stdout)
    return found[0], found[1], found[2]


def has(target: str) -> bool:
    features = binding.get_host_cpu_features()
    return all(features.get(feature) for feature in NEEDED[target])


@pytest.mark.skipif(not has(TARGET), reason=f"this processor is no {TARGET}")
@pytest.mark.nightly  # compiles two time loops of its own; what a change may break of it is in test_warm_up
def test_an_installed_wheel_with_kernels_compiles_nothing_but_what_it_lacks(tmp_path: Path) -> None:
    """In another place, with other times of its files, and where kernels are kept apart from the package."""
    pure_wheel(tmp_path / PURE)
    words = [str(tmp_path / PURE), str(tmp_path / "dist"), "seal", "--only", TARGET]
    told = subprocess.run([sys.executable, SCRIPT, *words], capture_output=True, text=True, check=True).stdout
    (wheel,) = (tmp_path / "dist").iterdir()
    version = "cp{}{}".format(*sys.version_info)
    assert wheel.name.startswith(f"frbcli-0.1.0-{version}-{version}-")
    assert TARGET in told

    place = tmp_path / "installed"
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        archive.extractall(place)
    assert f"Tag: {version}-{version}-" in (place / "frbcli-0.1.0.dist-info" / "WHEEL").read_text()
    with (place / "frbcli-0.1.0.dist-info" / "RECORD").open(newline="") as record:
        assert [row[0] for row in csv.reader(record)] == names
    assert not [name for name in names if name.endswith(".pyc")]
    for file in place.rglob("*"):
        os.utime(file, (1e9, 1e9))

    file, processor, compiled = run_installed(place, tmp_path / "run")
    assert file.startswith(str(place))
    assert (processor, compiled) == (TARGET, 0)
    apart = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert run_installed(place, tmp_path / "apart", **apart)[1:] == (TARGET, 0)

    # A machine that the wheel was not made for: loads have kernels of their own, which are compiled once and kept
    own = "force=[{ at = 'journal', force = ['1 N', '0 N'], order = 2 }]"
    first, again = (run_installed(place, tmp_path / name, own) for name in ("own", "again"))
    assert first[1] == again[1] == TARGET
    assert first[2] > 0 == again[2]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with kernels for both kinds of processors; numba has not been used yet."""
    monkeypatch.setattr(registry, "cpu_target", registry.CPUTarget("cpu"))
    monkeypatch.setattr(config, "reload_config", lambda: None)
    monkeypatch.setattr(caches.os, "environ", {})
    shipped = {"targets": list(NEEDED), "numba": __version__, "python": sys.implementation.cache_tag}
    (tmp_path / KERNELS).write_text(json.dumps(shipped))
    return tmp_path


@pytest.mark.parametrize(("features", "taken"), [("v4", "x86-64-v4"), ("v3", "x86-64-v3"), ("v2", None)])
def test_the_best_kind_of_processor_is_taken(
    package: Path, monkeypatch: pytest.MonkeyPatch, features: str, taken: str | None
) -> None:
    """Of those that the machine has; none if it has none of them."""
    machine = {"v4": NEEDED["x86-64-v4"], "v3": NEEDED["x86-64-v3"], "v2": ("sse4.2",)}[features]
    monkeypatch.setattr(binding, "get_host_cpu_features", lambda: dict.fromkeys(machine, True))
    take_shipped_kernels(package)
    assert caches.os.environ.get("NUMBA_CPU_NAME") == taken
    assert caches.os.environ.get("NUMBA_CPU_FEATURES") == (None if taken is None else FEATURES[taken])


@pytest.mark.parametrize("other", ["numba", "python"])
def test_kernels_of_another_version_are_left_alone(package: Path, other: str) -> None:
    """numba would find none of them, and would compile for less than this machine is."""
    shipped = json.loads((package / KERNELS).read_text())
    (package / KERNELS).write_text(json.dumps({**shipped, other: "0"}))
    take_shipped_kernels(package)
    assert "NUMBA_CPU_NAME" not in caches.os.environ


@pytest.mark.parametrize("content", ["", "[1", "[]", "3", "{}", '{"python": 3}', "\0"])
def test_a_damaged_file_of_a_wheel_stops_nothing(package: Path, content: str) -> None:
    (package / KERNELS).write_text(content)
    take_shipped_kernels(package)
    assert "NUMBA_CPU_NAME" not in caches.os.environ


def test_targets_that_are_none_stop_nothing(package: Path) -> None:
    shipped = json.loads((package / KERNELS).read_text())
    for targets in (None, 3, ["z80"], [[]]):
        (package / KERNELS).write_text(json.dumps({**shipped, "targets": targets}))
        take_shipped_kernels(package)
        assert "NUMBA_CPU_NAME" not in caches.os.environ


def test_a_choice_of_the_user_stands(package: Path) -> None:
    caches.os.environ["NUMBA_CPU_NAME"] = "generic"
    take_shipped_kernels(package)
    assert caches.os.environ["NUMBA_CPU_NAME"] == "generic"
    assert "NUMBA_CPU_FEATURES" not in caches.os.environ


def test_numba_that_was_used_before_stays_as_it_is(package: Path) -> None:
    """As in a notebook with kernels of its own: what is compiled for two processors does not fit together."""
    assert registry.cpu_target.target_context is not None
    take_shipped_kernels(package)
    assert "NUMBA_CPU_NAME" not in caches.os.environ
