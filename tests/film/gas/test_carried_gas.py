"""The compiled flows and gas of cells against those in array notation, and the cost of film and gas together."""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np
import pytest
from flows import oil_paths
from volume_films import ROTATION, section_of

from frbcli.film.cavitation.bubbly import Bubbly
from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.cells.balance.ends import FLOWS, GAS_IN, GAS_OUT, GAS_RELEASED
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    FREE_GAS,
    STATES,
    TURNOVER,
    cell_states,
    follow_law,
)
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, fitted_grid, reference_pressure
from frbcli.film.cells.gas.balance import Carried, KeptGas, OilPaths, brought
from frbcli.film.cells.gas.carry import PATHS, store_gas_rates, take_gas_along
from frbcli.film.cells.solver import FilmSolver

SUPPLIES = ("circumferential-groove", "axial-groove")
AIR = 1e5 / section_of("axial-groove").pressure_scale


def film_of(law: Law, supply: str, roughness: float = 0.0) -> VolumeFilm:
    section = replace(section_of(supply, 2e5, "free-to-air"), flow_roughness=roughness, shear=0.5)
    grid = fitted_grid(section, ROTATION.d, 32, 4)
    return VolumeFilm(section, grid, law, reference_pressure(section, ROTATION))


def steady(film: VolumeFilm, omega: float) -> tuple[Motion, VolumeSolution]:
    motion = Motion(ROTATION.d, (0.0, 0.0), omega)
    return motion, FilmSolver(film).steady(motion)


@pytest.mark.parametrize("roughness", [0.0, 2e-6])
@pytest.mark.parametrize("omega", [ROTATION.omega, -ROTATION.omega])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_compiled_paths_of_the_oil_are_those_in_array_notation(supply: str, omega: float, roughness: float) -> None:
    film = film_of(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), supply, roughness)
    motion, found = steady(film, omega)
    assert found.gas is not None
    balances = CellBalances(film.section, film.grid, motion, found.before)
    expected = oil_paths(balances, found.state.pressure, found.state.fraction)
    size = float(expected.out.max())
    for name in OilPaths._fields:
        np.testing.assert_allclose(getattr(found.gas.paths, name), getattr(expected, name), rtol=0.0, atol=1e-13 * size)


@pytest.mark.parametrize("omega", [ROTATION.omega, -ROTATION.omega])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_gas_is_the_solution_of_the_balances_of_all_cells_together(supply: str, omega: float) -> None:
    """One linear system of all cells, c = c_in + (c_e - c_in) / (1 + tau r), with the flows of the solution."""
    film = film_of(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), supply)
    gas = steady(film, omega)[1].gas
    assert gas is not None
    n, fixed = gas.free.size, gas.fixed
    unit = np.eye(n).reshape(n, *gas.free.shape)
    brings = np.stack([brought(gas.paths, each).ravel() for each in unit], axis=1)
    settled, time = film.law.exchanged(gas.pressure, gas.carried.gas, film.scales)
    kept = np.where(fixed, 1.0, gas.kept)
    share = np.where(fixed, 1.0, gas.oil / np.maximum(gas.oil + time * kept, 1e-300))
    settled = np.where(fixed, 0.02, settled)
    matrix = np.eye(n) - ((1.0 - share) / kept).ravel()[:, None] * brings
    right = (1.0 - share) / kept * gas.known + share * settled
    expected = np.linalg.solve(matrix, right.ravel()).reshape(gas.free.shape)
    np.testing.assert_allclose(gas.free, expected, rtol=0.0, atol=1e-12)


def test_on_fine_cells_a_film_with_gas_settles_in_few_iterations_wherever_they_begin() -> None:
    """Where gas follows by half of its change alone, 450 iterations do not settle; and what they leave of the oil
    fractions that are held moves the film by 1e-5 with where the search began."""
    section = section_of("circumferential-groove", 1e5, "free-to-air")
    film = VolumeFilm(section, fitted_grid(section, (0.0, 0.0), 144, 20), Bubbly(0.1, 0.0, AIR, 1e-3, 1.0), 500.0)
    motion, near = (Motion((x, -0.04), (0.0, 0.0), 628.0) for x in (0.07, 0.08))
    found, begun = FilmSolver(film).steady(motion), FilmSolver(film).steady(near)
    again = FilmSolver(film).steady(motion, begun.w)
    assert max(found.iterations, again.iterations) < 300
    pressure = found.state.pressure
    np.testing.assert_allclose(again.state.pressure, pressure, rtol=0.0, atol=1e-10 * np.abs(pressure).max())


@pytest.mark.parametrize("omega", [ROTATION.omega, -ROTATION.omega])
def test_gas_at_given_pressures_settles_where_they_ask_for_more_gas_than_there_is(omega: float) -> None:
    """Cells whose flows do not balance would gather any amount of gas; what they carry is all gas of the oil at most,
    and the law makes the free gas of the same."""
    law, rate = Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), 1e4
    film, random = film_of(law, "axial-groove"), np.random.default_rng(4)
    data, motion = volume_films([film]), Motion(ROTATION.d, (0.0, 0.0), omega)
    found = FilmSolver(film).steady(motion)
    shape = film.grid.shape
    states, paths, numbers = np.zeros((STATES, *shape)), np.zeros((PATHS, *shape)), np.empty(LAW_NUMBERS)
    follow_law(data.films[0], 0.0, 0.0, 0.0, 0.0, 1.0, numbers)
    states[CARRIED_GAS], states[TURNOVER], states[BEFORE_UPSTREAM] = 0.06, rate, found.before
    w = found.w + random.uniform(-0.1, 0.1, shape)
    past = rate * film.gaps(motion) * random.uniform(0.0, 0.12, shape)
    off = []
    for _ in range(30):
        cell_states(data.films[0], data.cells[0], numbers, 0.0, w, states)
        at = GridMotion(*motion.d, omega, rate=rate)
        off.append(take_gas_along(data.films[0], data.ring[0], data.places[0], data.cells[0], states, at, past, paths))
    free = ~film.grid.fixed
    assert np.any(states[CARRIED_GAS][free] == law.gas_content)
    assert np.all(states[FREE_GAS] <= law.gas_content)
    assert off[0] > 1e-3
    assert off[-1] < 1e-13


def test_rates_of_a_step_are_what_it_stores_and_their_flows_add_up() -> None:
    """d(H theta c)/dt = rate H theta c - past, in the sum what comes in, leaves the solution and leaves the film."""
    film, rate = film_of(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), "axial-groove"), 1e3
    motion, random = Motion(ROTATION.d, (0.0, 0.0), ROTATION.omega), np.random.default_rng(2)
    gap, theta = film.gaps(motion), random.uniform(0.9, 1.0, film.grid.shape)
    past = rate * gap * theta * 0.03
    solver = FilmSolver(film)
    guess = Carried(np.full_like(theta, 0.03), np.full_like(theta, rate))
    solution, content = solver.keep(motion, motion, film.full(), rate, rate * gap * theta, KeptGas(past, guess))
    assert solution.gas is not None
    data, rates, flows = volume_films([film]), np.zeros(film.grid.shape), np.zeros(FLOWS)
    states, paths = np.zeros((STATES, *rates.shape)), np.zeros((PATHS, *rates.shape))
    film_cells = data.films[0], data.ring[0], data.places[0], data.cells[0]
    states[:CARRIED_GAS] = astuple(solution.state)
    states[CARRIED_GAS], states[TURNOVER] = solution.gas.carried
    states[FREE_GAS], states[BEFORE_UPSTREAM] = solution.gas.free, solution.before
    at = GridMotion(*motion.d, motion.omega, rate=rate)
    take_gas_along(*film_cells, states, at, past, paths)
    store_gas_rates(film_cells[0], film_cells[3], states, paths, rates, flows)
    free, area = ~film.grid.fixed, film.grid.area
    expected = (rate * content * solution.gas.free - past)[free]
    np.testing.assert_allclose(rates[free], expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
    gained = flows[GAS_IN] - flows[GAS_OUT] + flows[GAS_RELEASED]
    assert float((area * rates)[free].sum()) == pytest.approx(gained, abs=1e-13 * flows[GAS_OUT])
    assert [flows[GAS_IN], flows[GAS_OUT], flows[GAS_RELEASED]] == pytest.approx(
        [solution.gas.inflow, solution.gas.outflow, solution.gas.released], rel=1e-9
    )
