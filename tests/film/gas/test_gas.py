"""Oil with bubbles and dissolved gas: the law, how gas is carried and kept, films at rest and moved, linear films."""

import math
from dataclasses import astuple, replace

import numpy as np
import pytest
from differences import differences
from plain_balances import CellBalances, oil_paths
from volume_films import ROTATION, section_of

import frbcli
from frbcli.bearing_tests.history import Moment, march, squeeze_path
from frbcli.film.cavitation.bubbly import Bubbly
from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cavitation.conditions import Elrod
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cavitation.two_phase import Peeken
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.cells.balance.ends import FLOWS, GAS_IN, GAS_OUT, GAS_RELEASED
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    FREE_GAS,
    PRESSURE,
    PRESSURE_SLOPE,
    SOURCE_SLOPE,
    STATES,
    TURNOVER,
    cell_states,
    follow_law,
)
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, fitted_grid, reference_pressure
from frbcli.film.cells.gas.balance import Carried, KeptGas, OilPaths, brought, linear_states
from frbcli.film.cells.gas.carry import PATHS, store_gas_rates, take_gas_along
from frbcli.film.cells.linearised import LinearFilm, linear_film, stiffness_at
from frbcli.film.cells.loads import force, oil_balance, pushed
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import BEARING, LADDER, RUN, SPEED_CYCLES, STABILITY, WHIRLS

NEVER = 1e12  # s
SUPPLIES = ("circumferential-groove", "axial-groove")
AIR = 1e5 / section_of("axial-groove").pressure_scale  # saturation pressure, scaled


def film_of(law: Law, supply: str = "axial-groove", cells: tuple[int, int] = (48, 6)) -> VolumeFilm:
    section = section_of(supply, 2e5)
    return VolumeFilm(
        section, fitted_grid(section, ROTATION.d, *cells), law, reference_pressure(section, ROTATION)
    )


def steady(law: Law, supply: str = "axial-groove") -> VolumeSolution:
    return FilmSolver(film_of(law, supply)).steady(ROTATION)


def test_compiled_law_with_gas_of_its_own_is_the_plain_one_and_its_slopes_are_those_of_its_values() -> None:
    random, film = np.random.default_rng(3), film_of(Bubbly(0.1, 0.03, AIR, 1e-3, 5e-3))
    data, (m, k) = volume_films([film]), film.grid.shape
    w = random.uniform(-1.6, 0.6, (m, k))
    carried, turnover = random.uniform(0.0, 0.13, (m, k)), 10.0 ** random.uniform(-2.0, 6.0, (m, k))
    numbers = np.empty(LAW_NUMBERS)
    follow_law(data.films[0], 0.0, 0.0, 0.0, 0.0, 1.0, numbers)

    def states(at: np.ndarray) -> np.ndarray:
        found = np.zeros((STATES, m, k))
        found[CARRIED_GAS], found[TURNOVER] = carried, turnover
        cell_states(data.films[0], data.cells[0], numbers, 0.0, at, found)
        return found

    own = zip(w.flat, carried.flat, turnover.flat, strict=True)
    plain = np.array([film.law.cell(at, (*film.law.parameters, *gas), film.scales) for at, *gas in own])
    compiled, free = states(w), ~film.grid.fixed
    for layer in range(SOURCE_SLOPE):
        values = plain[:, layer].reshape(m, k)
        np.testing.assert_allclose(compiled[layer][free], values[free], rtol=1e-12, atol=1e-12 * np.abs(values).max())
    step = 1e-7
    difference = (states(w + step)[PRESSURE] - states(w - step)[PRESSURE]) / (2.0 * step)
    off = np.abs(difference - compiled[PRESSURE_SLOPE])[free] > 1e-5 * np.abs(compiled[PRESSURE_SLOPE]).max()
    assert np.count_nonzero(off) <= 1  # a corner of the law


def test_gas_of_a_cell_is_the_implicit_relaxation_to_henrys_law() -> None:
    """c of pressure and oil fraction against c_in + (c_e - c_in) / (1 + tau r), on both sides of equilibrium."""
    law, scales = Bubbly(0.1, 0.02, 400.0, 1e-3, 1e-2), Scales(900.0, -60.0, 500.0)
    w = np.linspace(-1.2, 0.8, 200)
    for carried, turnover in ((0.0, 1e3), (0.05, 300.0), (0.1, 1e2), (0.12, 3.0)):
        state = law.cells(w, scales, np.full_like(w, carried), np.full_like(w, turnover))
        u = (state.pressure + scales.ambient) / 400.0
        inside = u > 0.0
        settled = np.maximum(0.12 - 0.1 * u, 0.0)
        share = 1.0 / (1.0 + np.where(settled > carried, 1e-3, 1e-2) * turnover)
        expected = carried + share * (settled - carried)
        np.testing.assert_allclose(law.free_gas(state, scales)[inside], expected[inside], atol=1e-12)


@pytest.mark.parametrize("supply", SUPPLIES)
def test_at_once_it_is_peekens_model(supply: str) -> None:
    found, peeken = steady(Bubbly(0.1, 0.0, AIR, 0.0, 0.0), supply), steady(Peeken(0.1), supply)
    np.testing.assert_allclose(found.state.pressure, peeken.state.pressure, rtol=0.0, atol=1e-9 * AIR)
    np.testing.assert_allclose(found.state.fraction, peeken.state.fraction, atol=1e-10)


def force_of(law: Law) -> np.ndarray:
    film = film_of(law)
    return np.array(force(film, film.mean_pressure(steady(law).state)))


def test_without_exchange_the_film_is_barotropic() -> None:
    """All oil has the gas it came with; and the less there is, the nearer is the film to Elrod's with no pressure in
    its cavity."""
    found = steady(Bubbly(0.1, 0.04, AIR, NEVER, NEVER))
    assert found.gas is not None
    np.testing.assert_allclose(found.gas.free, 0.04, rtol=1e-10)
    u = (found.state.pressure + AIR) / AIR
    free = ~film_of(Elrod()).grid.fixed
    np.testing.assert_allclose(found.state.fraction[free], (u / (u + 0.04))[free], rtol=1e-11)
    section = section_of("axial-groove", 2e5)
    grid = film_of(Elrod()).grid
    dry = VolumeFilm(replace(section, cavitation_pressure=0.0), grid, Elrod(), reference_pressure(section, ROTATION))
    elrod = np.array(force(dry, FilmSolver(dry).steady(ROTATION).state.pressure))
    size = float(np.hypot(*elrod))
    off = [
        float(np.hypot(*(force_of(Bubbly(0.0, gas, AIR, NEVER, NEVER)) - elrod))) / size for gas in (1e-2, 1e-4, 0.0)
    ]
    assert off[2] < 1e-10
    assert 1e-10 < off[1] < 0.1 * off[0]


@pytest.mark.parametrize("times", [(1e-3, 1.0), (1e-4, 1e-2), (1e-3, NEVER)])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_steady_gas_balances(supply: str, times: tuple[float, float]) -> None:
    found = steady(Bubbly(0.1, 0.02, AIR, *times), supply)
    gas = found.gas
    assert gas is not None
    assert gas.defect < 1e-11
    assert gas.off < 1e-10
    assert gas.inflow + gas.released == pytest.approx(gas.outflow, rel=1e-10)
    assert gas.outflow > gas.inflow > 0.0
    assert abs(oil_balance(film_of(Elrod(), supply), found).defect_relative) < 1e-12


def test_rotation_states_the_balance_of_the_gas() -> None:
    """Of a shipped case whose gas settles slowly: a stop where it falls by less than a half leaves 2e-9."""
    found = frbcli.rotation(frbcli.load_case("bearing-axial-groove"), ["peeken", "bubbly"])
    table = found.to_pandas()
    gas = found.results[1].loads.gas  # type: ignore[union-attr]
    assert gas is not None
    assert abs(gas.defect_relative) < 1e-10
    assert gas.released_m3_s == pytest.approx(gas.out_m3_s, rel=1e-9)
    assert np.isnan(table["free_gas"][0])
    assert table["free_gas"][1] == gas.share > 0.0


def test_all_analyses_follow_gas() -> None:
    case = frbcli.load_case("rigid", ["film.cavitation=bubbly"])
    with pytest.raises(frbcli.InputError, match="saturation_pressure = 1000 bar: is above 100 bar"):
        frbcli.make_plan(case.with_settings({"film.bubbly.saturation_pressure": "1000 bar"}))
    unbalanced = case.with_settings({"rotor.unbalance": "3 g*mm"})
    assert require(unbalanced, WHIRLS) is None  # type: ignore[func-returns-value]
    for analysis in (BEARING, STABILITY, RUN, LADDER, SPEED_CYCLES):
        assert require(case, analysis) is None  # type: ignore[func-returns-value]


# An enclosed film, closed at both ends; its journal is squeezed by a small amplitude.
ENCLOSED = Section(0.0125, 0.01, 0.02, 40e-6, 0.01, 1e5, 1e5, 1, "symmetry", "symmetry")
CELLS, STEPS, FREQUENCY, AMPLITUDE = 12, 24, 20.0, 1e-4
RATE = 2.0 * math.pi * FREQUENCY
BUNSEN, FREE = 0.1, 0.05


def squeezed(law: Bubbly, periods: int) -> list[Moment]:
    path = squeeze_path(AMPLITUDE, FREQUENCY, 0.0)
    grid = fitted_grid(ENCLOSED, (0.0, 0.0), CELLS, 1)
    film = VolumeFilm(ENCLOSED, grid, law, reference_pressure(ENCLOSED, path(0.0)))
    return list(march(film, path, np.linspace(0.0, periods / FREQUENCY, periods * STEPS + 1)))


@pytest.mark.parametrize(("periods", "rate_times_tau"), [(3, 0.0), (3, 0.1), (5, 1.0), (12, 10.0)])
def test_bubbles_in_an_enclosed_film_respond_as_in_closed_form(periods: int, rate_times_tau: float) -> None:
    """The mode cos(phi) of the pressure, amplitude and phase, for small motions.

    H theta' + theta_0 H' = p'' / p_s P, with theta = u / (u + c) and c' = (c_e - c) / tau. Time steps and cells have
    exact responses to a harmonic motion, too: (1 - exp(-i omega dt)) / dt and (2 - 2 cos dphi) / dphi^2.
    """
    tau = rate_times_tau / RATE
    saturation = 1e5 / ENCLOSED.pressure_scale
    found = squeezed(Bubbly(BUNSEN, FREE, saturation, tau, tau), periods)
    step, angle = 1.0 / FREQUENCY / STEPS, 2.0 * math.pi / CELLS
    grid = fitted_grid(ENCLOSED, (0.0, 0.0), CELLS, 1)
    ends = step * (np.arange(len(found)) + 1.0)
    pressures = np.array([each.solution.state.pressure[:, 0] for each in found]) / saturation
    mode = 2.0 / CELLS * pressures @ np.cos(grid.centre)
    seen = 2.0 / STEPS * (mode * np.exp(-1j * RATE * ends))[-STEPS:].sum()
    s = (1.0 - np.exp(-1j * RATE * step)) / step
    compliance = (FREE + BUNSEN / (1.0 + s * tau)) / (1.0 + FREE) ** 2
    stiffness = saturation * (2.0 - 2.0 * math.cos(angle)) / angle**2
    expected = -s / (1.0 + FREE) * (-1j * AMPLITUDE) / (stiffness + s * compliance)
    assert seen == pytest.approx(expected, rel=4e-4)


def test_gas_of_a_moved_film_is_kept_to_round_off() -> None:
    """Its content changes by what comes in, is released and leaves, over all steps."""
    film = film_of(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), cells=(32, 4))
    rate = 2.0 * math.pi * 30.0

    def path(t: float) -> Motion:
        c, s = math.cos(rate * t), math.sin(rate * t)
        return Motion((0.5 * c, 0.5 * s), (-0.5 * rate * s, 0.5 * rate * c), ROTATION.omega)

    area = np.where(film.grid.fixed, 0.0, film.grid.area)

    def content(moment: Moment, at: float) -> float:
        gas = moment.solution.gas
        assert gas is not None
        gap = film.gap(path(at).d, film.grid.centre)[:, None]
        return float((area * gap * moment.solution.state.fraction * gas.free).sum())

    times = np.linspace(0.0, 0.02, 61)
    moments = list(march(film, path, times))
    contents = [content(moment, float(time)) for moment, time in zip(moments, times[1:], strict=True)]
    for number in range(1, len(moments)):
        gas = moments[number].solution.gas
        assert gas is not None
        assert gas.defect < 1e-10
        gained = (times[number + 1] - times[number]) * (gas.inflow + gas.released - gas.outflow)
        assert contents[number] - contents[number - 1] == pytest.approx(gained, abs=1e-10 * contents[number])
    assert max(contents) > 1.2 * min(contents)


def carrying_film(law: Law, supply: str, roughness: float = 0.0) -> VolumeFilm:
    section = replace(section_of(supply, 2e5, "free-to-air"), flow_roughness=roughness, shear=0.5)
    grid = fitted_grid(section, ROTATION.d, 32, 4)
    return VolumeFilm(section, grid, law, reference_pressure(section, ROTATION))


def carried(film: VolumeFilm, omega: float) -> tuple[Motion, VolumeSolution]:
    motion = Motion(ROTATION.d, (0.0, 0.0), omega)
    return motion, FilmSolver(film).steady(motion)


@pytest.mark.parametrize("roughness", [0.0, 2e-6])
@pytest.mark.parametrize("omega", [ROTATION.omega, -ROTATION.omega])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_compiled_paths_of_the_oil_are_those_in_array_notation(supply: str, omega: float, roughness: float) -> None:
    film = carrying_film(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), supply, roughness)
    motion, found = carried(film, omega)
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
    film = carrying_film(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), supply)
    gas = carried(film, omega)[1].gas
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
    film, random = carrying_film(law, "axial-groove"), np.random.default_rng(4)
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
    film, rate = carrying_film(Bubbly(0.1, 0.02, AIR, 1e-3, 1e-2), "axial-groove"), 1e3
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


OMEGA, PLACE = 600.0, (0.3, -0.5)
RATES = [(1e-3, 3e-3), (1e-4, 1.0), (0.0, 1e-2)]


def even_film(law: Law, supply: str) -> VolumeFilm:
    section = section_of(supply, 2e5)
    return VolumeFilm(section, fitted_grid(section, (0.0, 0.0), 32, 4), law, 500.0)


def air(section: Section) -> float:
    return 1e5 / section.pressure_scale


def linear(law: Law, supply: str) -> LinearFilm:
    film = even_film(law, supply)
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
    film = even_film(Bubbly(0.1, 0.02, air(section_of(supply)), *times), supply)

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
