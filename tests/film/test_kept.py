"""Tables of films are kept on disk, found by what they follow from, and made again if a file is missing or damaged."""

import os
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import pytest

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.film import kept
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.grid import Mesh
from frbcli.film.penalty_table import film as penalty_film
from frbcli.film.rectangles import film
from frbcli.film.rectangles.table import force_table
from frbcli.scene.films import film_places
from frbcli.scene.machine.system import source_film

MESH = Mesh(axial=4, circumferential=16)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(kept, "folder_of", lambda _: tmp_path)
    return tmp_path


def counting(calls: list[tuple[object, ...]]):  # type: ignore[no-untyped-def]
    @kept.kept_beside(print)
    def table(mesh: Mesh, ratio: float, clipped: bool) -> Array:
        calls.append((mesh, ratio, clipped))
        return np.array([ratio, float(clipped), mesh.axial])

    return table


@pytest.mark.usefixtures("folder")
def test_a_table_is_made_once_and_equal_to_the_last_digit() -> None:
    calls: list[tuple[object, ...]] = []
    third = 1.0 / 3.0
    first = counting(calls)(MESH, third, True)
    again = counting(calls)(MESH, third, True)  # as in another process: nothing is held in memory
    assert len(calls) == 1
    assert first.tobytes() == again.tobytes()


@pytest.mark.usefixtures("folder")
def test_another_number_is_another_table() -> None:
    """Also one that differs in the last digit, and a number of numpy is the same as one of Python."""
    calls: list[tuple[object, ...]] = []
    third = 1.0 / 3.0
    for mesh, ratio, clipped in (
        (MESH, third, True), (MESH, np.nextafter(third, 1.0), True), (MESH, third, False),
        (Mesh(4, 18), third, True), (Mesh(4, 16, 2), third, True),
    ):  # fmt: skip
        counting(calls)(mesh, ratio, clipped)
    assert len(calls) == 5
    counting(calls)(MESH, np.float64(third), True)
    assert len(calls) == 5


def test_a_damaged_file_is_not_read(folder: Path) -> None:
    calls: list[tuple[object, ...]] = []
    expected = counting(calls)(MESH, 0.5, True)
    (file,) = folder.glob(f"*{kept.SUFFIX}")
    whole = file.read_bytes()
    for damaged in (b"", whole[:40], whole[:-1], whole[:-8] + bytes(8)):
        file.write_bytes(damaged)
        assert counting(calls)(MESH, 0.5, True).tobytes() == expected.tobytes()
        assert file.read_bytes() == whole
    assert len(calls) == 5


@pytest.mark.parametrize("make", [os.mkfifo, Path.mkdir, lambda file: file.symlink_to("/dev/zero")])
def test_what_is_no_file_is_not_opened(folder: Path, make: Callable[[Path], None]) -> None:
    """A FIFO would be waited for, a device read without end."""
    calls: list[tuple[object, ...]] = []
    counting(calls)(MESH, 0.5, True)
    (file,) = folder.iterdir()
    file.unlink()
    make(file)
    for _ in range(2):
        assert counting(calls)(MESH, 0.5, True)[0] == 0.5
    assert len(calls) == 2  # it was replaced


def test_a_place_that_cannot_be_written_costs_time_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "folder_of", lambda _: tmp_path / "missing")
    calls: list[tuple[object, ...]] = []
    assert counting(calls)(MESH, 0.5, True)[0] == 0.5
    assert len(calls) == 1


def test_the_files_used_last_are_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "MOST_KEPT", 3)
    calls: list[tuple[object, ...]] = []
    for ratio in range(5):
        counting(calls)(MESH, float(ratio), True)
    assert len(list(folder.iterdir())) == 3


@dataclass(frozen=True)
class Field:
    values: Array


@pytest.mark.usefixtures("folder")
def test_what_cannot_be_named_exactly_is_refused() -> None:
    """The `repr` of a long array leaves numbers out: two would have one name."""
    with pytest.raises(TypeError, match="ndarray"):
        kept._exact((Field(np.zeros(3)),))


def test_a_kept_table_is_that_of_the_solver(folder: Path) -> None:
    made = force_table(MESH, 0.6, True)
    for _ in range(2):  # made and written, then read
        film._force_table.cache_clear()
        assert np.array_equal(film._force_table(MESH, 0.6, True), made)
    assert len(list(folder.iterdir())) == 1


def test_a_law_derived_in_python_has_a_table_of_its_own(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its numbers may be those of the penalty model, and its equations others."""
    monkeypatch.setattr(penalty_film, "penalty_table", lambda _: np.zeros(1))
    case = load_case("jeffcott", ["film.cavitation=penalty"])
    solved = source_film(case, film_places(case)[0].geometry, MESH)

    class Derived(Penalty):
        pass

    law = Derived(**{field.name: getattr(solved.law, field.name) for field in fields(solved.law)})
    assert np.array_equal(replace(solved, law=law).film().table, np.zeros(1))
    assert not list(folder.iterdir())
