"""Random films on cells: the plan holds its target, and the run states its error."""

from __future__ import annotations

from pathlib import Path

import pytest
import unseen_films
from unseen_films import Found, tried

MISSED, UNSTATED = 0.15, 0.15  # share of the films that may miss their target, or state less than their error


def found(folder: Path, seeds: range | tuple[int, ...]) -> list[Found]:
    return [each for seed in seeds for each in tried(seed, folder)]


@pytest.mark.parametrize("seed", [7, 77, 184])
def test_an_unseen_film_holds_its_targets(seed: int, tmp_path: Path) -> None:
    """Feed holes; grooves in narrow bearings with oil-keeping laws, whose films had 1.1 to 2.5 times their targets."""
    for film in tried(seed, tmp_path):
        assert film.status == film.fine == "finished"
        assert film.true <= film.target
        assert film.true <= film.stated


@pytest.mark.nightly
def test_unseen_films_hold_their_targets(tmp_path: Path) -> None:
    """All laws and supplies once more, 36 films with two targets; each begins."""
    films = found(tmp_path, range(1000, 1000 + len(unseen_films.LAWS) * len(unseen_films.SUPPLIES)))
    assert len(films) >= 60
    said = [film for film in films if "out of reach" not in film.announced]
    assert sum(film.true > film.target for film in said) <= MISSED * len(said)
    assert sum(film.true > film.stated for film in films) <= UNSTATED * len(films)
    assert {film.status for film in films} <= {"finished", "contact", "starved"}
