"""Random films on cells: the plan holds its target, and the run states its error. Random machines: what a run states of
its events and slow signals holds what a finer run finds."""

from pathlib import Path

import pytest
import unseen_films
from accuracy import unseen_machines
from nights import pairs_tonight
from unseen_films import Found, tried


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
    """Each law with a supply of its own, of 36 films with two targets; each begins."""
    laws, supplies = len(unseen_films.LAWS), len(unseen_films.SUPPLIES)
    seeds = (1000 + (pair - 1000) % (laws * supplies) for pair in pairs_tonight(laws, supplies))
    films = [film for seed in seeds for film in tried(seed, tmp_path)]
    assert len(films) >= 10
    assert {film.law for film in films} == set(unseen_films.LAWS)
    assert [film for film in films if not said(film)] == []
    assert {film.status for film in films} <= {"finished", "contact", "starved"}


def test_an_unseen_machine_states_how_certain_its_events_are(tmp_path: Path) -> None:
    """A rotor in floating rings, and a rigid one on tables: their steps are as long as they may be, not as their
    tolerance asks for. The second run had the same steps, and agreed in 0.03 Hz where the finer one is 1.9 Hz off."""
    machine = unseen_machines.tried(2, tmp_path)
    assert machine.events
    assert machine.lacking == ()
    assert [number for number in machine.numbers if not number.holds] == []


@pytest.mark.nightly
def test_nine_of_ten_uncertainties_of_unseen_machines_hold(tmp_path: Path) -> None:
    """All kinds of machines, each with a law of its own."""
    seeds = pairs_tonight(len(unseen_machines.KINDS), len(unseen_machines.LAWS))
    machines = [unseen_machines.tried(seed, tmp_path) for seed in seeds]
    numbers = [n for machine in machines for n in machine.numbers if n.event != "critical-speed"]
    assert len(numbers) > 12
    assert [machine.lacking for machine in machines if machine.lacking] == []
    assert sum(number.holds for number in numbers) >= 0.9 * len(numbers)
