"""Oil that carries gas: limits of its rates, the balance of the gas, and the linear response in closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from volume_films import ROTATION, section_of

import frbcli
from frbcli.bearing_tests.history import Moment, march, squeeze_path
from frbcli.film.cavitation.bubbly import Bubbly
from frbcli.film.cavitation.compiled import CARRIED_GAS, LAW_NUMBERS, TURNOVER
from frbcli.film.cavitation.conditions import Elrod
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cavitation.two_phase import Peeken
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE, STATES, cell_states, follow_law
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, fitted_grid, reference_pressure
from frbcli.film.cells.loads import force, oil_balance
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

    plain, compiled = film.law.cells_with_gas(w, film.scales, carried, turnover), states(w)
    free = ~film.grid.fixed
    for layer, name in enumerate(("pressure", "fraction", "source", "pressure_slope", "fraction_slope")):
        values = getattr(plain, name)
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
        state = law.cells_with_gas(w, scales, np.full_like(w, carried), np.full_like(w, turnover))
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
