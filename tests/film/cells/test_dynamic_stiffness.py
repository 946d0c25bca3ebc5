"""Films that keep oil, linearised with its memory: against the settled film, the direct solution, and the time step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.film.cells.balance.carried import UPWIND
from frbcli.film.cells.dynamic_stiffness import dynamic_stiffness, stiffness_at, weighted, without_memory
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.linearised import linear_film, lying
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion, Storage
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.steady_force import steady_force
from frbcli.scene.films import film_places, volume_film

OMEGA = 2.0 * math.pi * 78.0
PLACE = np.array([5.9e-6, -0.8e-6])
LAWS = ["two-phase", "elrod", "peeken"]


def film_of(law: str, cells: tuple[int, int] = (48, 6)) -> VolumeFilm:
    case = load_case("rigid-two-phase", ["bearing.supply.pressure=2 bar", f"film.cavitation={law}"])
    return volume_film(case, film_places(case)[0], cells)


@pytest.mark.parametrize("law", ["two-phase", "elrod"])
def test_at_rest_it_is_the_stiffness_of_the_settled_film(law: str) -> None:
    film = film_of(law)
    linear = linear_film(film, PLACE, OMEGA)
    settled = steady_force(film, PLACE, np.zeros(2), OMEGA)
    expected = -settled.by_displacement
    np.testing.assert_allclose(stiffness_at(linear, 0.0).real, expected, atol=1e-8 * np.abs(expected).max())
    # by a velocity alone; steady_force moves the journal by 1e-9 s times it
    quick = -settled.by_velocity
    own = linear.push @ np.linalg.solve(linear.flow.toarray(), linear.by_rate)
    np.testing.assert_allclose(own, quick, atol=1e-6 * np.abs(quick).max())


@pytest.mark.parametrize("law", LAWS)
def test_it_is_what_a_small_step_in_time_does(law: str) -> None:
    """An implicit Euler step of 1 / s from rest, to a place beside it, moves the film by Z(s): its rates are s times
    its changes. The balances are those of FilmSolver.keep, with differences for derivatives."""
    film, s, step = film_of(law), 0.5 * OMEGA, 1e-5
    linear, clearance = linear_film(film, PLACE, OMEGA), film.section.clearance
    d = PLACE / clearance
    solver = FilmSolver(film)
    content = film.content(Motion((float(d[0]), float(d[1])), (0.0, 0.0), OMEGA), linear.field)
    found = np.empty((2, 2))
    for column, unit in enumerate(np.eye(2)):
        forces = []
        for side in (step, -step):
            x, y = (d + side * unit).tolist()
            moved = Motion((x, y), (0.0, 0.0), OMEGA)
            solver._before = np.full(film.grid.shape, UPWIND)
            gap = film.gap(moved.d, film.grid.centre)[:, None]
            solution = solver._solve(moved, linear.field, Storage(s * gap, s * content))
            forces.append(np.array(force(film, film.mean_pressure(solution.state))))
        found[:, column] = -(forces[0] - forces[1]) / (2.0 * step * clearance)
    expected = stiffness_at(linear, s).real
    np.testing.assert_allclose(expected, found, atol=2e-4 * np.abs(found).max())


@pytest.mark.parametrize("law", LAWS)
def test_projections_are_exact_at_their_frequencies_and_close_between(law: str) -> None:
    linear = linear_film(film_of(law), PLACE, OMEGA)
    own = dynamic_stiffness(linear, [0.25 * OMEGA, 0.5 * OMEGA, OMEGA])
    for share, close in ((0.0, 1e-9), (0.25, 1e-9), (1.0, 1e-9), (0.35, 2e-3), (0.75, 2e-3), (0.5 - 0.05j, 2e-3)):
        s = 1j * share * OMEGA
        exact, (found, slope) = stiffness_at(linear, s), own.at(s)
        size = np.abs(exact).max()
        np.testing.assert_allclose(found, exact, atol=close * size)
        ahead, behind = (own.at(s + side)[0] for side in (1e-3, -1e-3))
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-3, atol=1e-5 * np.abs(slope).max())


def test_a_film_without_memory_is_its_eight_coefficients() -> None:
    stiffness, damping = np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[5.0, 6.0], [7.0, 8.0]])
    film = without_memory(stiffness, damping)
    z, slope = weighted([(film, 2.0), (film, -1.0)]).at(3j)
    np.testing.assert_allclose(z, stiffness + 3j * damping)
    np.testing.assert_allclose(slope, damping)


def test_cells_lie_further_around() -> None:
    film = film_of("two-phase")
    grid = lying(film, 0.25).grid
    np.testing.assert_allclose(grid.phi - film.grid.phi, 0.25 * 2.0 * math.pi / 48)
