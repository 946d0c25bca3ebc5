"""Random films on cells: the plan holds its target, and the run states its error."""

from __future__ import annotations

from pathlib import Path

import pytest
import unseen_films
from unseen_films import Found, tried


def found(folder: Path, seeds: range | tuple[int, ...]) -> list[Found]:
    return [each for seed in seeds for each in tried(seed, folder)]


def said(film: Found) -> bool:
    """Whether a film holds its target, or states an error that covers the true one."""
    return film.true <= film.target or film.true <= film.stated


@pytest.mark.parametrize("seed", [26, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (7, 77, 184))])
def test_an_unseen_film_holds_its_targets(seed: int, tmp_path: Path) -> None:
    """Feed holes; an eccentricity of 0.97, with 1.35 times the target on cells that do not follow it; grooves in narrow
    bearings with oil-keeping laws, whose films had 1.1 to 2.5 times their targets."""
    for film in tried(seed, tmp_path):
        assert film.status == film.fine == "finished"
        assert film.true <= film.target
        assert film.true <= film.stated


@pytest.mark.parametrize("seed", [281, pytest.param(93, marks=pytest.mark.nightly)])
def test_a_film_that_misses_its_target_states_it(seed: int, tmp_path: Path) -> None:
    """A two-phase film under 89 bar; slots in a film that comes five times nearer to its shell than the plan expects.
    They stated a third of their errors."""
    for film in tried(seed, tmp_path):
        assert film.true > film.target
        assert film.true <= film.stated <= 6.0 * film.true


@pytest.mark.nightly  # 8 s, one machine by chance
def test_steps_are_short_where_their_errors_grow_and_the_target_is_not_called_certain(tmp_path: Path) -> None:
    """A two-phase film under a mean pressure of 58 bar: its eccentricities had 5.5 times their targets, which `frb
    check` called held."""
    for film in tried(1019, tmp_path):
        assert film.true <= film.target
        assert film.true <= film.stated
        assert film.announced == f"{film.target:g} is not certain"


@pytest.mark.nightly
def test_unseen_films_hold_their_targets_or_state_their_errors(tmp_path: Path) -> None:
    """All laws and supplies once more, 36 films with two targets; each begins."""
    films = found(tmp_path, range(1000, 1000 + len(unseen_films.LAWS) * len(unseen_films.SUPPLIES)))
    assert len(films) >= 60
    assert [film for film in films if not said(film)] == []
    assert {film.status for film in films} <= {"finished", "contact", "starved"}
