"""The films that a run keeps at some moments: held to the signals of the run, and their pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from marches import planned_system
from PIL import Image
from resumed import assert_resumable

from frbcli import load_case, read_run, runup
from frbcli.case.schema import Case
from frbcli.errors import RunFileError
from frbcli.film.cells.data import SHEARED
from frbcli.plot.moving import MOMENTS, animate_films, film_moments_figure
from frbcli.results.store import GAS, OIL, KeptFilm, Run, kept_film

FRAMES = 9
KEPT = f'output.films={{ from="10 ms", to="30 ms", frames={FRAMES} }}'
SPEED = ("speed.from=80 Hz", "speed.to=80 Hz", "speed.duration=35 ms", "start.position=resting")
FILM = ("film.cavitation=bubbly", "bearing.supply.pressure=2 bar", "accuracy.mesh=[4, 24]", "rotor.unbalance=60 g*mm")


def case_of(*settings: str) -> Case:
    return load_case("rigid", [*SPEED, *FILM, *settings])


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return runup(case_of(KEPT), tmp_path_factory.mktemp("kept") / "kept.h5")


def test_the_oil_and_the_place_of_each_moment_are_those_of_the_signals(kept: Run) -> None:
    """Of the step that reaches a moment, on cells that turn with the oil."""
    case = case_of(KEPT)
    sheared = planned_system(case).films.loop.cells[0, SHEARED]
    film, times = kept_film(read_run(kept.path), [""]), kept["time_s"]
    asked = np.linspace(0.01, 0.03, FRAMES)
    assert np.all(film.times >= asked)
    assert np.all(film.times < asked + 2e-3)
    assert np.ptp(film.angles) == pytest.approx(np.pi * 80.0 * np.ptp(film.times), rel=1e-9)
    for frame, now in enumerate(film.times):
        before = int(np.searchsorted(times, now, side="right")) - 1
        mean = float((sheared * film.oil[frame]).sum() / sheared.sum())
        assert mean == pytest.approx(kept["oil_fraction"][before], abs=1e-5)
        drawn = [np.interp(now, times, kept[f"journal_{axis}_m"]) / kept.references["clearance_m"] for axis in "xy"]
        assert film.places[frame] == pytest.approx(drawn, abs=1e-4)
    assert film.gas is not None
    assert 0.01 < film.gas.max() < 0.1  # of all its gas, a tenth, the oil has released a part
    assert film.gas.min() > -0.01 * film.gas.max()
    assert film.oil[film.gas > 0.02].mean() < film.oil[film.gas < 0.002].mean() - 0.01


@pytest.mark.bitwise
def test_a_run_with_kept_films_is_the_same_and_may_be_resumed(kept: Run, tmp_path: Path) -> None:
    """Bit for bit, with the films that it has kept."""
    plain = runup(case_of(), tmp_path / "plain.h5")
    for name in plain.signals:
        np.testing.assert_array_equal(kept[name], plain[name], strict=True)
    whole = assert_resumable(case_of(KEPT), tmp_path, 0.02)
    assert whole.checkpoint is not None
    assert {OIL, GAS} <= set(whole.checkpoint)


def test_cells_are_seen_where_they_are_in_the_lab() -> None:
    """A field of the angle in the lab, on uneven cells of a grid that has turned."""
    edges = np.linspace(0.0, 1.0, 200) ** 1.2 * 2.0 * np.pi + 0.3
    turned = 0.5 * (edges[1:] + edges[:-1]) + 4.0
    place = np.array([[0.3, -0.4]])
    values = np.sin(turned)[None, :, None]
    film = KeptFilm("", np.zeros(1), np.array([4.0]), place, edges, values, None)
    even = (np.arange(64) + 0.5) * 2.0 * np.pi / 64
    np.testing.assert_allclose(film.around(0, values[0], 64)[:, 0], np.sin(even), atol=0.03)
    phi = np.linspace(0.0, 2.0 * np.pi, 100_000)
    gap = 1.0 + 0.3 * np.sin(phi) + 0.4 * np.cos(phi)
    assert film.narrowest(0) == pytest.approx(phi[np.argmin(gap)], abs=1e-4)


def test_films_move_in_a_picture(kept: Run, tmp_path: Path) -> None:
    counted: list[tuple[int, int]] = []
    path = animate_films(kept, tmp_path / "a.gif", dpi=50, observe=lambda *told: counted.append(told))
    assert counted[-1] == (FRAMES, FRAMES)
    with Image.open(path) as image:
        assert image.n_frames == FRAMES  # type: ignore[attr-defined]
        first = np.asarray(image.convert("L"), dtype=float)
        image.seek(FRAMES // 2)
        assert np.abs(np.asarray(image.convert("L"), dtype=float) - first).max() > 50.0
    with Image.open(animate_films(kept, tmp_path / "b.gif", from_time=0.015, frames=3, dpi=50)) as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]
    assert path.stat().st_size < 2e6
    figure = film_moments_figure(kept)
    shown = [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]
    assert len(shown) == MOMENTS
    assert "80.0 Hz" in shown[0]
    with pytest.raises(RunFileError, match="has not kept two films"):
        film_moments_figure(kept, from_time=0.032)
    with pytest.raises(RunFileError, match='has no film "outer"'):
        film_moments_figure(kept, "outer")
