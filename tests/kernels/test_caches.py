"""Kernels on disk: what is damaged is compiled again, what others can write is not read, a full disk stops nothing.
Private names of numba and matplotlib that frb reaches for: whether they are there, and what happens without them."""

import os
import pickle
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import click
import pytest
from kernel_package import IMPORTS, answers, package
from matplotlib import artist
from numba import __version__
from numba.core.caching import FunctionCache

from frbcli import compiled
from frbcli.caches import is_trusted, store, stored
from frbcli.cli import main, process


class Bomb:
    """Its pickle makes a file where it is read."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[Callable[..., None], tuple[Path]]:
        return Path.touch, (self.mark,)


def numba_index(mark: Path) -> bytes:
    """An index as numba alone would read it, which makes a file then."""
    return pickle.dumps(__version__) + pickle.dumps(Bomb(mark))


def flip(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def replace_by(make: Callable[[Path], None]) -> Callable[[Path], None]:
    def damage(file: Path) -> None:
        file.unlink()
        make(file)

    return damage


DAMAGES: dict[str, Callable[[Path], object]] = {
    "empty": lambda file: file.write_bytes(b""),
    "cut": lambda file: file.write_bytes(file.read_bytes()[:-10]),
    "cut within the checksum": lambda file: file.write_bytes(file.read_bytes()[:10]),
    "longer": lambda file: file.write_bytes(file.read_bytes() + b"0"),
    "flipped": flip,
    "text": lambda file: file.write_text("not a pickle"),
    "a pickle of numba": lambda file: file.write_bytes(numba_index(file.parent / "ran")),
    "unreadable": lambda file: file.chmod(0),
    "missing": lambda file: file.unlink(),
    "folder": replace_by(Path.mkdir),
    "fifo": replace_by(os.mkfifo),
    "device": replace_by(lambda file: file.symlink_to("/dev/zero")),
    "link to nowhere": replace_by(lambda file: file.symlink_to("nowhere/at/all")),
    "link to itself": replace_by(lambda file: file.symlink_to(file.name)),
}  # fmt: skip


def test_a_damaged_kernel_is_compiled_again_and_replaced(tmp_path: Path) -> None:
    """In whatever way, and whether it is its index or its machine code."""
    if os.getuid() == 0:  # reads everything
        DAMAGES.pop("unreadable", None)
    count = 2 * len(DAMAGES)
    package(tmp_path, *[IMPORTS[0]] * count)
    assert answers(tmp_path, count) == [(2.0, 0)] * count
    assert answers(tmp_path, count) == [(2.0, 1)] * count
    for number, damage in enumerate([*DAMAGES.values()] * 2):
        suffix = ".nbi" if number < len(DAMAGES) else ".nbc"
        (file,) = (tmp_path / "cache").glob(f"*/outer{number or ''}.*{suffix}")
        damage(file)
    assert answers(tmp_path, count) == [(2.0, 0)] * count
    assert not list(tmp_path.rglob("ran"))
    assert answers(tmp_path, count) == [(2.0, 1)] * count


def test_a_kernel_in_the_place_of_another_one_is_not_run(tmp_path: Path) -> None:
    """As two processes that compile at once may leave them: each file is whole."""
    room = package(tmp_path, IMPORTS[0], IMPORTS[0])
    (room / "outer1.py").write_text((room / "outer1.py").read_text().replace("inner(x)", "inner(x) + 1.0"))
    assert answers(tmp_path, 2) == [(2.0, 0), (3.0, 0)]
    one, other = ((tmp_path / "cache").glob(f"*/{name}.*.nbc") for name in ("outer", "outer1"))
    next(one).write_bytes(next(other).read_bytes())
    assert answers(tmp_path, 2) == [(2.0, 0), (3.0, 1)]


def asked(folder: Path, **settings: str) -> subprocess.CompletedProcess[str]:
    """A process with the first kernel of a package, which prints its value."""
    left_out = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME")
    environment = {name: value for name, value in os.environ.items() if name not in left_out}
    environment |= {"PYTHONPATH": str(folder), **settings}
    ask = "from frbcli.film.outer import outer; print(outer(1.0))"
    return subprocess.run([sys.executable, "-c", ask], env=environment, cwd=folder, capture_output=True, text=True,
                          preexec_fn=without_room if "FULL" in settings else None)  # fmt: skip


def without_room() -> None:
    """Have no byte written to a file: what a full disk and a quota do."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))


def test_a_full_disk_under_the_cache_costs_time_only(tmp_path: Path) -> None:
    package(tmp_path, IMPORTS[0])
    cache = tmp_path / "cache"
    done = asked(tmp_path, NUMBA_CACHE_DIR=str(cache), FULL="yes")
    assert (done.returncode, done.stdout) == (0, "2.0\n"), done.stderr
    (line,) = done.stderr.splitlines()
    assert line == "Compiled kernels are not kept on disk: File too large. The next start compiles them again."
    assert not [file for file in cache.rglob("*") if file.is_file()]
    assert asked(tmp_path, NUMBA_CACHE_DIR=str(cache)).stderr == ""
    assert len(list(cache.rglob("*.nbc"))) == 1


def test_without_any_place_kernels_are_compiled_in_memory(tmp_path: Path) -> None:
    package(tmp_path, IMPORTS[0])
    file = tmp_path / "file"
    file.touch()
    (tmp_path / "frbcli" / "film" / "__pycache__").touch()
    places = {"NUMBA_CACHE_DIR": str(file / "cache"), "HOME": str(file), "TMPDIR": str(file)}
    (tmp_path / "sitecustomize.py").write_text("import tempfile; tempfile._candidate_tempdir_list = list")  # not /tmp
    done = asked(tmp_path, **places)
    assert (done.returncode, done.stdout) == (0, "2.0\n"), done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith("Compiled kernels are not kept on disk: there is no place for them.")


def test_kernels_in_the_current_folder_are_not_loaded(tmp_path: Path) -> None:
    """An empty name for the caches of a user stands for it, and so does the last one of the temporary directories."""
    package(tmp_path, IMPORTS[0])
    (tmp_path / "frbcli" / "film" / "__pycache__").touch()
    here = "import os, tempfile; tempfile._candidate_tempdir_list = lambda: [os.getcwd()]"
    (tmp_path / "sitecustomize.py").write_text(here)
    (tmp_path / f"frb-cache-{os.getuid()}").mkdir(mode=0o700)
    for _ in range(2):
        done = asked(tmp_path, HOME=str(tmp_path / "home"), XDG_CACHE_HOME="")
        assert done.stdout == "2.0\n"
        assert done.stderr.startswith(f"Compiled kernels are kept in {tmp_path}/frb-cache-")
        assert not list(tmp_path.rglob("*.nbi"))  # they were in a directory that is removed at the end


@pytest.mark.parametrize("place", ["home", "NUMBA_CACHE_DIR"])
def test_kernels_that_others_can_write_are_not_loaded(tmp_path: Path, place: str) -> None:
    """A folder that anybody can write, with an index that runs code where it is unpickled."""
    package(tmp_path, IMPORTS[0])
    (tmp_path / "frbcli" / "film" / "__pycache__").touch()
    home, temporary = tmp_path / "home", tmp_path / "temporary"
    temporary.mkdir()
    cache = home / ".cache" / "numba" if place == "home" else tmp_path / "cache"
    settings = {"HOME": str(home), "TMPDIR": str(temporary)}
    if place != "home":
        settings["NUMBA_CACHE_DIR"] = str(cache)
    assert asked(tmp_path, **settings).stderr == ""  # of this user alone: used
    (index,) = cache.rglob("*.nbi")
    os.chmod(cache, 0o777)
    mark = tmp_path / "ran"
    index.write_bytes(numba_index(mark))
    done = asked(tmp_path, **settings)
    assert (done.stdout, mark.exists()) == ("2.0\n", False)
    (own,) = temporary.glob("frb-cache-*")
    assert done.stderr.startswith(f"Compiled kernels are kept in {own}, for neither")
    assert len(list(own.rglob("*.nbi"))) == 1


def test_a_folder_is_trusted_if_nobody_else_can_change_it(tmp_path: Path) -> None:
    parent = tmp_path / "parent"
    folder = parent / "folder"
    folder.mkdir(parents=True)
    assert is_trusted(folder)
    for mode, trusted in ((0o777, False), (0o1777, False), (0o702, False), (0o755, True), (0o700, True)):
        folder.chmod(mode)
        assert is_trusted(folder) is trusted
    for mode, trusted in ((0o777, False), (0o1777, True), (0o755, True)):
        parent.chmod(mode)
        assert is_trusted(folder) is trusted
    link = tmp_path / "link"
    link.symlink_to(folder)
    assert is_trusted(link)
    parent.chmod(0o777)
    assert not is_trusted(link)
    assert not is_trusted(tmp_path / "missing")


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder to others")
def test_a_folder_of_somebody_else_is_not_trusted(tmp_path: Path) -> None:
    folder = tmp_path / "parent" / "folder"
    folder.mkdir(parents=True)
    for other in (folder, folder.parent):
        os.chown(other, 12345, 12345)
        assert not is_trusted(folder)
        os.chown(other, 0, 0)
        assert is_trusted(folder)
    os.chown(folder, 0, 12345)
    folder.chmod(0o775)
    assert not is_trusted(folder)  # of a group with others, maybe


def test_a_stored_file_is_found_for_its_purpose_alone(tmp_path: Path) -> None:
    file = tmp_path / "file"
    store(file, b"content", "purpose")
    assert (stored(file, "purpose"), stored(file, "other"), stored(file)) == (b"content", None, None)
    store(file, b"")
    assert stored(file) == b""
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_a_file_that_ends_early_is_no_interruption(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a reader of files did not expect was reported as Ctrl-C, with its exit code."""

    def ends_early() -> None:
        raise EOFError("Ran out of input")

    monkeypatch.setattr(main, "command_named", lambda name: click.Command(name, callback=ends_early))
    with pytest.raises(EOFError):
        main.run(["cases"])


def test_numba_has_the_parts_of_kernels() -> None:
    """Without JITCodeLibrary, its methods or _get_implementation kernels are compiled one by one, and more slowly."""
    assert compiled._PARTS


def test_numba_reads_a_kernel_without_preparing_itself() -> None:
    """Without _load_overload or _nrt_python.c_helpers a start takes an eighth longer."""
    assert hasattr(FunctionCache, compiled.READ)
    assert compiled._MEMORY


def test_numba_says_where_the_index_of_a_kernel_is() -> None:
    """Without _cache_file._index_path kernels are kept in memory alone."""
    cache = FunctionCache(compiled._composed)
    assert compiled._index_of(cache) is not None
    assert compiled._index_of(object()) is None


def test_matplotlib_writes_docstrings_by_names_that_can_be_changed() -> None:
    """Without them a picture takes a seventh longer."""
    assert hasattr(artist, "kwdoc")
    assert hasattr(artist.Artist, process.DESCRIBE)


GONE = {
    "parts of kernels": ("_LIBRARY: Any = getattr(codegen, ", "_LIBRARY: Any = getattr(None, "),
    "quick reading": ('READ = "_load_overload"', 'READ = "gone"'),
    "memory of arrays": ('"_nrt_python", None)', '"gone", None)'),
}


@pytest.mark.parametrize(("name", "without"), GONE.values(), ids=GONE)
def test_without_a_private_name_kernels_are_the_same(tmp_path: Path, name: str, without: str) -> None:
    """And kept on disk."""
    file = package(tmp_path, *IMPORTS).parent / "compiled.py"
    text = file.read_text()
    assert text.count(name) == 1
    file.write_text(text.replace(name, without))
    assert answers(tmp_path, len(IMPORTS)) == [(2.0, 0)] * len(IMPORTS)
    assert answers(tmp_path, len(IMPORTS)) == [(2.0, 1)] * len(IMPORTS)


def test_without_the_place_of_the_index_kernels_stay_in_memory(tmp_path: Path) -> None:
    """The cache of numba alone does not follow the sources of all that a kernel is made of."""
    file = package(tmp_path, IMPORTS[0]).parent / "compiled.py"
    file.write_text(file.read_text().replace('"_index_path"', '"gone"'))
    for _ in range(2):
        assert answers(tmp_path, 1) == [(2.0, 0)]
    assert not list(tmp_path.rglob("*.nbc"))
