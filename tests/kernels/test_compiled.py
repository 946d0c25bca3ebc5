"""Kernels are compiled once and kept, follow all their sources, and who waits for them is told."""

import ast
import gc
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from kernel_package import IMPORTS, INNER, answers, package
from numba.core.caching import NullCache
from numba.core.runtime import _nrt_python, rtsys

import frbcli
from frbcli.caches import temporary_cache
from frbcli.case.reading.load import load_case
from frbcli.cli import progress
from frbcli.cli.common import Terminal
from frbcli.cli.progress import Display, compilation_shown
from frbcli.compiled import compiled, counted
from frbcli.runs.run import runup
from frbcli.scene.cost import compile_s
from frbcli.solve import time_loop
from frbcli.studies.accuracy import by_theory


def answer(folder: Path) -> tuple[float, int]:
    """The answer of the only kernel of a package."""
    (found,) = answers(folder, 1)
    return found


def test_a_kernel_follows_those_it_calls_in_other_files(tmp_path: Path) -> None:
    """However it imports them. The cache of numba alone would go on with the old machine code of the inner one."""
    room, count = package(tmp_path, *IMPORTS), len(IMPORTS)
    assert answers(tmp_path, count) == [(2.0, 0)] * count
    assert answers(tmp_path, count) == [(2.0, 1)] * count
    (room / "inner.py").write_text(INNER.format(added="2.0"))
    assert answers(tmp_path, count) == [(3.0, 0)] * count
    (room / "unrelated.py").write_text("")
    assert answers(tmp_path, count) == [(3.0, 1)] * count


MAKES = """
import numpy
from frbcli.compiled import compiled

@compiled(makes_arrays=True)
def doubled(values):
    return 2.0 * numpy.sort(values)

def threefold(x):
    return 3.0 * x
"""
# Reads a kernel, one that makes arrays and a C function; compiles what is not on the disk; what numba had before it did
READS = """
import ctypes, sys
from pathlib import Path
import numba, numpy
from numba.core import types
import frbcli.compiled
frbcli.compiled.READ = sys.argv[1] or frbcli.compiled.READ
from frbcli.film.makes import doubled, threefold
from frbcli.film.outer import outer
value, made = outer(1.0), doubled(numpy.array([3.0, 1.0]))
function = frbcli.compiled.c_function(threefold, types.float64(types.float64), Path(threefold.__code__.co_filename))
hits = sum(outer.stats.cache_hits.values()) + sum(doubled.stats.cache_hits.values()) + function._cache_hits
prepared = "numba.np.arraymath" in sys.modules
called = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(function.address)(2.0)
assert (value, made.tolist(), called) == (2.0, [2.0, 6.0], 6.0)
assert outer(1j) == 1.0 + 1j and doubled(numpy.array([3, 1])).tolist() == [2.0, 6.0]
assert numba.njit(lambda values: numpy.linalg.inv(values).sum())(numpy.eye(3)) == 3.0
print(hits, prepared)
"""


def test_kernels_on_disk_are_read_without_what_numba_needs_to_compile(tmp_path: Path) -> None:
    """With the numba that is installed; one that reads in another way prepares itself, and finds the same kernels.
    What is not on the disk is compiled after both."""
    (package(tmp_path, IMPORTS[0]) / "makes.py").write_text(MAKES)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    told = list[str]()
    for read in ("", "", "not_there"):
        command = [sys.executable, "-c", READS, read]
        done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
        told.append(done.stdout.strip())
    assert told == ["0 True", "3 False", "3 True"]


TYPED = """
from typing import NamedTuple
from frbcli.compiled import compiled

class {kind}(NamedTuple):
    x: float

@compiled()
def of(given):
    return given.x

def outer(x):
    return of({kind}(x))

outer.stats = of.stats
"""


def test_a_cache_that_names_a_type_which_is_no_longer_there_is_not_read(tmp_path: Path) -> None:
    """As after an update that renames a record: numba alone ends with an error when it reads such a cache."""
    room = package(tmp_path, IMPORTS[0])
    (room / "outer.py").write_text(TYPED.format(kind="Older"))
    assert answer(tmp_path) == (1.0, 0)
    assert answer(tmp_path) == (1.0, 1)
    (room / "outer.py").write_text(TYPED.format(kind="Newer"))
    assert answer(tmp_path) == (1.0, 0)
    assert answer(tmp_path) == (1.0, 1)


def test_a_kernel_within_others_is_a_part_of_them() -> None:
    """It becomes machine code when Python calls it; numbers that are written into a call are no types of their own."""

    @compiled()
    def inner(x: float, n: int) -> float:
        return x * n

    @compiled()
    def outer(x: float) -> float:
        return inner(x, 1) + inner(x, 2)

    inner._cache = outer._cache = NullCache()  # type: ignore[attr-defined]
    with counted() as compilations:
        assert outer(2.0) == 6.0
        assert compilations.functions == 3  # both, and the call from Python
        assert inner.signatures == []  # type: ignore[attr-defined]
        assert inner(2.0, 3) == 6.0
        assert compilations.functions == 4


def test_every_kernel_of_the_package_is_compiled_so() -> None:
    """A bare njit would be back to a cache that does not see what changed."""
    import frbcli

    folder = Path(frbcli.__file__).parent
    bare = [
        file.relative_to(folder).as_posix()
        for file in folder.rglob("*.py")
        if re.search(r"\bn?jit\(.*cache", file.read_text(encoding="utf-8")) and file.name != "compiled.py"
    ]
    assert bare == []


# Touch, Rub, SectionEnd, Values, Slopes: records and tuples of numbers.
NUMBERS = re.compile(r"Touch|Rub|GridMotion|SectionEnd|(tuple\[)?((float|int|bool|None|\.\.\.|Values|Slopes)(, )?)+\]?")


def kernels(folder: Path) -> Iterator[tuple[str, str, str, set[str]]]:
    """(name, decorator, what it returns, the functions that it calls) of every kernel."""
    for file in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef):
                continue
            calls = [call.func for call in ast.walk(node) if isinstance(call, ast.Call)]
            called = {function.id for function in calls if isinstance(function, ast.Name)}
            for decorator in map(ast.unparse, node.decorator_list):
                if decorator.startswith(("compiled(", "compiled_for(")):
                    yield node.name, decorator, ast.unparse(node.returns) if node.returns else "", called


def test_arrays_that_kernels_make_have_one_who_counts_their_references() -> None:
    """An array that a kernel makes and returns would never be given free by a kernel that counts no references; one
    that a kernel without them returns would be given free too early by one that counts them, or by Python."""
    import frbcli

    found = list(kernels(Path(frbcli.__file__).parent))
    counts: dict[str, set[bool]] = {}
    for name, decorator, returned, _ in found:
        if not NUMBERS.fullmatch(returned):
            counts.setdefault(name, set()).add("makes_arrays=True" in decorator)
            assert "makes_arrays=True" in decorator or "internal=True" in decorator, name
    assert {"end_flows", "mean_end_flows"} <= set(counts)
    for name, decorator, _, called in found:
        for given in called & set(counts):
            assert counts[given] == {"makes_arrays=True" in decorator}, f"{name} calls {given}"


def test_functions_chosen_by_types_become_no_machine_code_by_themselves() -> None:
    """numba compiles them once more than they are used, to know what they return, also those put into their callers."""
    files = Path(frbcli.__file__).parent.rglob("*.py")
    chosen = [one for file in files for one in re.findall(r"(?m)^@overload\(.*", file.read_text(encoding="utf-8"))]
    assert '@overload(end_flow, jit_options=AS_KERNELS, inline="always")' in chosen
    assert [one for one in chosen if "jit_options=AS_KERNELS" not in one] == []


MORE = [pytest.param(name, marks=pytest.mark.nightly) for name in ("floating-ring", "rigid-two-phase")]


@pytest.mark.parametrize("name", ["jeffcott", *MORE])
def test_a_run_leaves_no_array_behind(name: str, tmp_path: Path) -> None:
    """Of a longer run as many live on as of a short one."""
    _nrt_python.memsys_enable_stats()
    left = []
    for duration in ("2 ms", "2 ms", "10 ms"):
        runup(load_case(name, [f"speed.duration={duration}"]), tmp_path / "run.h5", force=True)
        gc.collect()
        stats = rtsys.get_allocation_stats()
        left.append(stats.mi_alloc - stats.mi_free)
    assert left[2] == left[1]


def test_the_first_start_is_told_and_the_next_is_not(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from numba import njit

    def fresh(x: float) -> float:
        return x * 3.0

    monkeypatch.setattr(progress, "slowness", lambda: 2.0)
    monkeypatch.setattr(time_loop, "some_are_kept", lambda: False)
    about = 2.0 * compile_s([load_case("jeffcott")])
    kernel = njit(fresh)
    for told in (True, False):
        with compilation_shown(Display(Terminal()), load_case("jeffcott")):
            assert kernel(2.0) == 6.0
        assert (f"Compiling the kernels, once: about {about:.0f} s of CPU time." in capsys.readouterr().err) is told


def test_what_moves_on_the_screen_counts_the_kernels() -> None:
    from numba import njit

    shown = list[str]()
    with compilation_shown(Display(Terminal(), shown.append), load_case("jeffcott-two-phase")):
        njit(lambda x: x + 1.0)(1.0)
    (about,) = re.fullmatch(r"Compiling the kernels, once: ((?:at most )?about \d+) s of CPU time\.", shown[0]).groups()
    assert re.fullmatch(rf"Compiling the kernels, once: 1 functions, \d+ s of {about} s\.", shown[1])


def test_a_compilation_that_takes_longer_than_announced_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    from numba import njit

    monkeypatch.setattr(progress, "slowness", lambda: 1e-9)
    shown = list[str]()
    with compilation_shown(Display(Terminal(), shown.append), load_case("jeffcott-two-phase")):
        njit(lambda x: x + 1.0)(1.0)
    assert shown[1].endswith(" s of CPU time, longer than expected.")


def test_kernels_that_are_on_disk_make_the_announced_time_the_most(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = SimpleNamespace(cache_path=str(tmp_path))
    monkeypatch.setattr(time_loop._advance, "_cache", cache)
    assert not time_loop.some_are_kept()
    (tmp_path / "time_loop._advance-174.py311.nbi").touch()
    assert time_loop.some_are_kept()


def test_a_comparison_compiles_for_all_of_its_films() -> None:
    tables, cells = load_case("jeffcott"), load_case("jeffcott", ["film.cavitation=elrod"])
    assert compile_s([tables, cells, cells]) == compile_s([tables]) + compile_s([cells])


def test_films_at_rest_need_no_time_loop_with_rings_and_heat() -> None:
    rings, cells = load_case("floating-ring-heat"), load_case("jeffcott-two-phase")
    rest = compile_s([cells], "rest")
    assert compile_s([rings, cells], "rest") == rest < 0.5 * compile_s([cells])
    assert compile_s([cells], "both") == rest + compile_s([cells])


def test_a_ladder_with_short_bearings_compiles_a_second_time_loop() -> None:
    tables, cells = load_case("jeffcott"), load_case("jeffcott-two-phase")
    assert compile_s([tables, *by_theory(tables)]) == 2.0 * compile_s([tables])
    assert compile_s([cells, *by_theory(cells)]) == compile_s([cells])


@pytest.mark.nightly
@pytest.mark.timing
@pytest.mark.parametrize(
    ("case", "law"), [("jeffcott", "half-sommerfeld"), ("jeffcott", "elrod"), ("floating-ring-heat", "penalty")]
)
def test_the_announced_time_of_compiling_holds(case: str, law: str, tmp_path: Path) -> None:
    """Within a factor of 1.5, in a process with an empty cache: 20 or 40 s were announced for 26, 42 and 66."""
    place = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    words = ["runup", case, "--set", f"film.cavitation={law}", "--set", "speed.duration=2 ms", "--no-picture"]
    told = list[float]()
    for _ in range(2):  # the second one takes the kernels from the cache
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "frbcli", *words, "-o", str(tmp_path / "run.h5")]
        done = subprocess.run(command, env=place, capture_output=True, text=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        told.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        about = re.search(r"once: about (\d+) s of CPU time", done.stderr)
        if about is not None:
            announced = float(about[1])
    assert announced / 1.5 < told[0] - told[1] < 1.5 * announced


# --- nowhere to keep them ---

KEPT = """
import sys, frbcli
assert frbcli.__file__.startswith(sys.argv[1]), frbcli.__file__
from frbcli.film.parabola import hermite
print(hermite._cache._cache_path, hermite._cache._cache_file is not None)
import frbcli.plot.style
"""


def test_an_installation_that_cannot_be_written_has_a_temporary_cache(tmp_path: Path) -> None:
    """Without a home directory either. Files in place of directories keep out also those who may write everywhere."""
    package, temporary = tmp_path / "installed", tmp_path / "temporary"
    shutil.copytree(Path(frbcli.__file__).parent, package / "frbcli", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in {path.parent for path in package.rglob("*.py")}:
        (folder / "__pycache__").touch()
    (tmp_path / "file").touch()
    temporary.mkdir()
    variables = {"PATH": os.environ["PATH"], "HOME": str(tmp_path / "file" / "home"), "TMPDIR": str(temporary)}
    for _ in range(2):  # the second start finds the directory of the first one
        words = [sys.executable, "-c", KEPT, str(package)]
        done = subprocess.run(words, env=variables | {"PYTHONPATH": str(package)}, capture_output=True, text=True,
                              check=True, cwd=tmp_path)  # fmt: skip
        (line,) = done.stderr.splitlines()
        (place,) = temporary.iterdir()
        assert line.startswith(f"Compiled kernels are kept in {place}, for neither")
        assert done.stdout.startswith(str(place))
        assert place.stat().st_mode & 0o777 == 0o700


def test_a_temporary_cache_of_others_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    first = temporary_cache.__wrapped__()
    assert temporary_cache.__wrapped__() == first
    first.chmod(0o777)
    other = temporary_cache.__wrapped__()
    assert other != first
    first.rmdir()
    first.symlink_to(tmp_path)
    assert temporary_cache.__wrapped__() not in (first, other, tmp_path)
