"""Kernels of the balance of heat against their plain forms."""

import numpy as np
import pytest
from test_heat import ring_case

from frbcli.scene.machine.heat import heat_of
from frbcli.thermal.exchange import (
    BOOKS,
    CARRIED,
    CHANGES,
    CLEARANCE,
    DISSIPATED,
    ETA,
    FILM_ROWS,
    FLOW,
    GIVEN,
    IN_FILMS,
    LENGTH,
    POWER,
    SHARE,
    HeatArrays,
    arrays_of,
    heat_step,
    viscosity_at,
    write_clearances,
    write_rates,
)
from frbcli.thermal.model import HeatModel, clearances_at, rates, viscosities_at


def step_of(model: HeatModel, now: np.ndarray, step: float, t: np.ndarray, last: np.ndarray, books: np.ndarray) -> None:
    """heat_step as runs have it: the temperatures of the films go on as in the last step."""
    ratio = step / last[LENGTH] if last[LENGTH] > 0.0 else 0.0
    ahead = t + ratio * last[CHANGES:]
    heat_step(kernel_arrays(model), now, step, t, ahead, last, np.zeros(len(t)), books)


def kernel_arrays(model: HeatModel) -> HeatArrays:
    return arrays_of(model, np.ones(2), np.ones(2), np.ones(2), by_formula=False)


def test_kernels_of_the_balance_are_their_plain_forms() -> None:
    case = ring_case("thermal.clearance=follows", "thermal.centrifugal_growth=follows", "thermal.housing=60 degC",
                     "thermal.shaft={ capacity = 40, conductance = 2, temperature = '200 degC' }")  # fmt: skip
    heat = heat_of(case)
    model = heat.model._replace(inlet=np.array([1, -1]))
    rng = np.random.default_rng(4)
    t = heat.start + 60.0 * rng.random(len(heat.start))
    power, flow, speeds = np.array([300.0, 80.0]), np.array([8e-7, 2e-6]), np.array([4000.0, 800.0])
    now, gain, state = np.zeros((FILM_ROWS, 2)), np.empty(len(t)), np.concatenate([np.zeros(BOOKS), speeds, t])
    now[POWER], now[FLOW] = power, flow
    capacity, links, films, numbers, growth = kernel_arrays(model)
    write_clearances(films, growth, len(speeds), state, now)
    clearances = now[CLEARANCE]
    assert clearances == pytest.approx(clearances_at(model, t, speeds), rel=1e-12)
    carried, given = write_rates(capacity, links, films, numbers, now, t, gain)
    assert gain == pytest.approx(rates(model, t, power, flow, clearances), rel=1e-9, abs=1e-9)
    assert float(gain.sum()) == pytest.approx(380.0 - carried, rel=1e-9)
    assert given == pytest.approx(float(gain[np.isinf(model.capacity)].sum()), rel=1e-12)
    assert [viscosity_at(numbers, x) for x in t[:2]] == pytest.approx(viscosities_at(model, t), rel=1e-12)


def test_step_of_heat_is_that_of_the_rates_and_loses_nothing() -> None:
    heat = heat_of(ring_case("thermal.housing=60 degC"))
    model, count = heat.model, len(heat.start)
    now = np.zeros((FILM_ROWS, 2))
    now[POWER], now[FLOW], now[CLEARANCE], now[SHARE] = (300.0, 80.0), (8e-7, 2e-6), model.reference, 1.0
    t, last, books = heat.start.copy(), np.zeros(CHANGES + count), np.zeros(BOOKS)
    step = 1e-7
    step_of(model, now, step, t, last, books)
    expected = step * rates(model, heat.start, now[POWER], now[FLOW], now[CLEARANCE]) / model.capacity
    assert t - heat.start == pytest.approx(expected, rel=1e-6, abs=1e-12)
    for _ in range(200):
        step_of(model, now, 1e-2, t, last, books)  # longer than the films' time constants
    free = np.isfinite(model.capacity)
    kept = float(model.capacity[free] @ (t - heat.start)[free])
    assert books[DISSIPATED] == pytest.approx(380.0 * (2.0 + step), rel=1e-12)
    assert books[DISSIPATED] == pytest.approx(books[CARRIED] + books[GIVEN] + kept, rel=1e-10)


def test_a_long_step_of_heat_ends_in_balance_and_loses_nothing() -> None:
    """Steps a thousand times as long as nodes of little capacity take."""
    node = "{ capacity = 1e-15, conductance = 2, temperature = 330 }"
    heat = heat_of(ring_case(f"thermal.shaft={node}", f"thermal.housing={node}"))
    model, count = heat.model._replace(inlet=np.array([1, -1])), len(heat.start)
    now = np.zeros((FILM_ROWS, 2))
    now[POWER], now[FLOW], now[CLEARANCE], now[SHARE] = (300.0, 80.0), (8e-7, 2e-6), model.reference, 1.0
    t, last, books = heat.start.copy(), np.zeros(CHANGES + count), np.zeros(BOOKS)
    for _ in range(30):
        step_of(model, now, 10.0, t, last, books)
    free = np.isfinite(model.capacity)
    assert rates(model, t, now[POWER], now[FLOW], now[CLEARANCE])[free] == pytest.approx(0.0, abs=1e-9 * 380.0)
    kept = float(model.capacity[free] @ (t - heat.start)[free])
    assert books[DISSIPATED] == pytest.approx(books[CARRIED] + books[GIVEN] + kept, rel=1e-10)


def test_films_in_balance_gain_nothing() -> None:
    """Power proportional to the viscosity, flow to its inverse; the inner film is fed through the outer one."""
    heat = heat_of(ring_case("thermal.housing=60 degC", "thermal.films=quasi-steady"))
    model = heat.model._replace(inlet=np.array([1, -1]))
    assert model.balanced
    now = np.zeros((FILM_ROWS, 2))
    now[POWER], now[FLOW], now[CLEARANCE], now[SHARE] = (300.0, 80.0), (8e-7, 2e-6), model.reference, 1.0
    now[ETA] = viscosities_at(model, heat.start)
    t, last, books = heat.start.copy(), np.zeros(CHANGES + len(heat.start)), np.zeros(BOOKS)
    step_of(model, now, 1e-12, t, last, books)
    thicker = viscosities_at(model, t) / now[ETA]
    handed_on = now[FLOW] / (1.0, thicker[1])  # what the inner film has let out
    for film, flow in ((0, now[FLOW] / thicker), (1, handed_on)):
        left = rates(model, t, now[POWER] * thicker, flow, now[CLEARANCE])
        assert left[film] == pytest.approx(0.0, abs=1e-6)
    assert t[0] > heat.start[0] + 5.0
    assert t[2:] == pytest.approx(heat.start[2:], abs=1e-6)
    assert books[IN_FILMS] == 0.0
