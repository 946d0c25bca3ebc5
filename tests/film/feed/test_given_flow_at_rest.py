"""Films whose supply gives a flow at the most, linearised with the filling of its line: against settled films at the
flow, an implicit step in time of film and line, and films at the pressure that is left in the openings."""

from __future__ import annotations

import fed_films
import numpy as np
import pytest
from differences import differences
from fed_films import AT_REST, AXIAL, BORES, GROOVE, OMEGA, fed_case, fed_film

from frbcli.film.cells.balance.boundaries import feed_at, supply_line
from frbcli.film.cells.balance.states import UPWIND
from frbcli.film.cells.film import Motion, Storage, VolumeFilm
from frbcli.film.cells.linearised import linear_film, stiffness_at
from frbcli.film.cells.loads import force
from frbcli.film.cells.solver import FilmSolver

PLACE = np.array(fed_films.PLACE)
STARVED = [(GROOVE, 4e-7), (AXIAL, 2e-6), (AXIAL, 2e-7), (BORES, 2e-7)]  # the second axial groove is filled in part
each_supply = pytest.mark.parametrize(("supply", "flow"), STARVED, ids=["groove", "axial", "emptied", "bores"])
LAWS = ["elrod", "two-phase", "peeken"]


def film_of(supply: str, flow: float | None, law: str) -> VolumeFilm:
    return fed_film(fed_case(supply, flow, law), (48, 6))


def settled(film: VolumeFilm) -> float:
    """The filling of the openings at rest."""
    return FilmSolver(film).steady(AT_REST, upwind=True).filling


@each_supply
@pytest.mark.parametrize("law", LAWS)
def test_it_is_what_a_small_step_in_time_does(supply: str, flow: float, law: str) -> None:
    """An implicit Euler step of 1 / s of film and line from rest, to a place beside it, see test_dynamic_stiffness.py:
    line s (filling - settled) = given - taken, whose root is found by a secant."""
    film, s, step = film_of(supply, flow, law), 0.5 * OMEGA, 1e-5
    clearance, line, rest = film.section.clearance, supply_line(film), settled(film)
    linear = linear_film(film, PLACE * clearance, OMEGA)
    solver, content = FilmSolver(film), film.content(AT_REST, linear.field)

    def moved(d: np.ndarray, filling: float) -> tuple[np.ndarray, float]:
        """Force after the step with a filling, and what the line does not balance."""
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), OMEGA)
        solver.fill(filling)
        solver._before = np.full(film.grid.shape, UPWIND)
        gap = film.gap(motion.d, film.grid.centre)[:, None]
        solution = solver._solve(motion, linear.field, Storage(s * gap, s * content))
        off = line.line * s * (filling - rest) - line.given + solution.flows.supply
        return np.array(force(film, film.mean_pressure(solution.state))), off

    def after(d: np.ndarray) -> np.ndarray:
        low, high = rest - step, rest + step
        for _ in range(4):
            (_, at_low), (_, at_high) = moved(d, low), moved(d, high)
            if abs(at_high - at_low) < 1e-12 * line.given:
                break
            low, high = high, high - at_high * (high - low) / (at_high - at_low)
        return moved(d, high)[0]

    found = -differences(after, PLACE, step) / clearance
    expected = stiffness_at(linear, s).real
    np.testing.assert_allclose(expected, found, atol=3e-4 * np.abs(found).max())


@pytest.mark.parametrize(("supply", "flow"), STARVED[:2], ids=["groove", "axial"])
def test_so_fast_that_the_line_stays_it_is_the_film_at_the_pressure_in_its_openings(supply: str, flow: float) -> None:
    """And not so at rest, where the pressure follows."""
    film = film_of(supply, flow, "elrod")
    place, section = PLACE * film.section.clearance, film.section
    gauge = 2e5 * feed_at(film, settled(film)).share
    lower = film_of(supply.replace("3 bar", f"{1.0 + 1e-5 * gauge!r} bar"), None, "elrod")
    linear, plain = (linear_film(each, place, OMEGA) for each in (film, lower))
    assert section.ambient_pressure == 1e5
    for s, close in ((1e7j, 1e-4), (0.0, None)):
        own, other = stiffness_at(linear, s), stiffness_at(plain, s)
        off = np.abs(own - other).max() / np.abs(other).max()
        assert off < close if close is not None else off > 0.02
