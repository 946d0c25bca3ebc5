"""Private names of numba and matplotlib that frb reaches for: whether they are there, and what happens without them."""

from pathlib import Path

import pytest
from kernel_package import IMPORTS, answers, package
from matplotlib import artist
from numba.core.caching import FunctionCache

from frbcli import compiled
from frbcli.cli import process


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
