"""Films whose oil carries gas, linearised: against Peeken's model, differences of the static force, a closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from differences import differences
from volume_films import section_of

from frbcli.bearing_tests.history import march
from frbcli.film.cavitation.bubbly import Bubbly
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import Peeken
from frbcli.film.cells.film import Motion, VolumeFilm, fitted_grid
from frbcli.film.cells.gas.balance import linear_states
from frbcli.film.cells.linearised import LinearFilm, linear_film, stiffness_at
from frbcli.film.cells.loads import force, pushed
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section

OMEGA, PLACE = 600.0, (0.3, -0.5)
RATES = [(1e-3, 3e-3), (1e-4, 1.0), (0.0, 1e-2)]


def film_of(law: Law, supply: str) -> VolumeFilm:
    section = section_of(supply, 2e5)
    return VolumeFilm(section, fitted_grid(section, (0.0, 0.0), 32, 4), law, 500.0)


def air(section: Section) -> float:
    return 1e5 / section.pressure_scale


def linear(law: Law, supply: str) -> LinearFilm:
    film = film_of(law, supply)
    return linear_film(film, film.section.clearance * np.array(PLACE), OMEGA)


@pytest.mark.parametrize("supply", ["circumferential-groove", "axial-groove"])
def test_at_once_the_dynamic_stiffness_is_that_of_peekens_model(supply: str) -> None:
    """Whose derivatives are the compiled ones, on one state per cell."""
    saturation = air(section_of(supply))
    bubbly, peeken = linear(Bubbly(0.1, 0.0, saturation, 0.0, 0.0), supply), linear(Peeken(0.1), supply)
    for s in (0.0, 300j, 20.0 + 1000j):
        exact = stiffness_at(peeken, s)
        assert stiffness_at(bubbly, s) == pytest.approx(exact, abs=1e-7 * np.abs(exact).max())


@pytest.mark.parametrize("supply", ["circumferential-groove", "axial-groove"])
@pytest.mark.parametrize("times", RATES)
def test_at_rest_it_is_the_derivative_of_the_force_of_films_that_have_settled(
    times: tuple[float, float], supply: str
) -> None:
    film = film_of(Bubbly(0.1, 0.02, air(section_of(supply)), *times), supply)

    def settled(d: np.ndarray) -> tuple[float, float]:
        found = FilmSolver(film).steady(Motion(tuple(d), (0.0, 0.0), OMEGA), upwind=True)
        return force(film, found.state.pressure)

    expected = -differences(settled, PLACE, 1e-5) / film.section.clearance
    found = stiffness_at(linear_film(film, film.section.clearance * np.array(PLACE), OMEGA), 0.0)
    assert found == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("rate_times_tau", [0.0, 0.1, 1.0, 10.0])
def test_an_enclosed_film_has_the_dynamic_stiffness_in_closed_form(rate_times_tau: float) -> None:
    """Of the mode cos(phi) on equal cells: s (theta_0 H + K p / p_s) + P lambda p / p_s = 0."""
    bunsen, free, cells, rate = 0.1, 0.05, 24, 500.0
    section = Section(0.0125, 0.01, 0.02, 40e-6, 0.01, 1e5, 1e5, 1, "symmetry", "symmetry")
    grid, angle = fitted_grid(section, (0.0, 0.0), cells, 1), 2.0 * math.pi / cells
    saturation, time = air(section), rate_times_tau / rate
    film = VolumeFilm(section, grid, Bubbly(bunsen, free, saturation, time, time), 500.0)
    still = Motion((0.0, 0.0), (0.0, 0.0), 0.0)
    settled = next(march(film, lambda _: still, np.array([0.0, 1e-3]))).solution
    found, s = linear_states(film, still, settled, np.zeros(grid.shape)), 1j * rate
    compliance = (free + bunsen / (1.0 + s * time)) / (1.0 + free) ** 2
    stiffness = saturation * (2.0 - 2.0 * math.cos(angle)) / angle**2
    mode = s / (1.0 + free) / (stiffness + s * compliance)  # p / p_s per displacement, of H = 1 - d cos(phi)
    unit = saturation * np.cos(grid.centre)[:, None]
    expected = -mode * pushed(film, unit)[1]
    whole = LinearFilm(*found, settled.w)
    assert stiffness_at(whole, s)[1, 1] == pytest.approx(expected, rel=1e-6)
