"""Films along a given motion whose supply gives a flow at the most: where they settle, their balance, their limit."""

from __future__ import annotations

import numpy as np
import pytest
from fed_films import AT_REST, GROOVE, OMEGA, by_grooves, fed_case, fed_film

from frbcli.bearing_tests.history import march, whirl_path
from frbcli.film.cells.balance.boundaries import ALL, RESPONSE, supply_line
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.solver import FilmSolver


def film_of(supply: str, flow: float | None) -> VolumeFilm:
    return fed_film(fed_case(supply, flow), (32, 6))


@by_grooves
@pytest.mark.parametrize("longest", [1e-3, 4.0 * RESPONSE])
def test_a_journal_that_stands_still_has_the_film_that_takes_what_is_given(supply: str, longest: float) -> None:
    """Steps longer than the response of a line are stable as well. A moved film carries its oil with second order, a
    steady one of Elrod's upwind, which a groove that is filled in part shows."""
    film = film_of(supply, 4e-7)
    *_, last = march(film, lambda _: AT_REST, np.arange(0.0, 300.0 * longest, longest))
    steady = FilmSolver(film).steady(AT_REST)
    assert steady.filling < ALL
    assert last.solution.filling == pytest.approx(steady.filling, rel=1e-6 if supply == GROOVE else 0.02)
    assert last.solution.flows.supply == pytest.approx(supply_line(film).given, rel=1e-6)


@by_grooves
def test_what_was_given_has_passed_or_fills_the_line(supply: str) -> None:
    """While the line is not full; else the supply gives less."""
    film, times = film_of(supply, 1e-7), np.linspace(0.0, 0.05, 101)
    moments = list(march(film, whirl_path(0.6, 50.0, OMEGA), times))
    line, fillings = supply_line(film), np.array([each.solution.filling for each in moments])
    taken = np.array([each.solution.flows.supply for each in moments])
    first = int(np.flatnonzero(fillings == ALL)[-1])
    assert first < 50
    assert fillings.min() > line.lowest
    passed = (times[1] - times[0]) * taken[first:-1].sum()
    emptied = line.line * (ALL - fillings[-1])
    assert emptied > 0.01 * passed
    assert passed == pytest.approx(line.given * (times[-2] - times[first]) + emptied, rel=1e-10)


@by_grooves
def test_an_ample_flow_is_a_supply_at_its_pressure_to_the_bit(supply: str) -> None:
    path, times = whirl_path(0.5, 50.0, OMEGA), np.linspace(0.0, 0.01, 21)
    plain, ample = (list(march(film_of(supply, flow), path, times)) for flow in (None, 1.0))
    assert all(np.array_equal(a.solution.w, b.solution.w) for a, b in zip(plain, ample, strict=True))
