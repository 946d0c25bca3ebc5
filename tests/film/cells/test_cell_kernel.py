"""The compiled kernel of films on volumes against the plain one, its derivatives against differences, and columns of
cells that keep their oil: cavities that turn with the oil, see resting.py."""

import math
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from differences import differences
from marches import planned_system
from plain_balances import CellBalances, limited
from scipy.special import wrightomega

from frbcli.case.reading.load import load_case
from frbcli.film.cavitation.barotropic import Barotropic
from frbcli.film.cavitation.bubbly import Bubbly
from frbcli.film.cavitation.compiled import LAW_NUMBERS, wright_omega
from frbcli.film.cavitation.conditions import Elrod, HalfSommerfeld, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import FilmOil, Law
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cavitation.table import SHIPPED
from frbcli.film.cavitation.two_phase import Peeken, TwoPhase
from frbcli.film.cells.balance.balances import GridMotion, balances
from frbcli.film.cells.balance.ends import ENDS_NET, FLOWS
from frbcli.film.cells.balance.newton_step import film_newton
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    FRACTION,
    PRESSURE_SLOPE,
    RESTS,
    STATES,
    before_upstream,
    cell_states,
    follow_law,
    hold,
    limited_at,
)
from frbcli.film.cells.block_cyclic import (
    ABOVE,
    BEFORE,
    BEHIND,
    BELOW,
    CENTRE,
    ENTRIES,
    ring_solver,
    solve_ring_at,
)
from frbcli.film.cells.data import ALL_SIDES, AREA, SIDES, volume_films
from frbcli.film.cells.film import Motion, Storage, VolumeFilm
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Hole, Section, gap_height, gap_rate
from frbcli.scene.machine.system import System
from frbcli.solve.films.cell_steps import Work
from frbcli.solve.films.cells import HELD, cell_response, move_even
from frbcli.solve.films.steps import make_work
from frbcli.solve.stage.equations import FilmMotion

LAWS: dict[str, Law] = {
    "sommerfeld": Sommerfeld(),
    "half-sommerfeld": HalfSommerfeld(),
    "reynolds": Reynolds(),
    "penalty": Penalty(0.01, 30.0),
    "peeken": Peeken(0.1),
    "elrod": Elrod(),
    "elrod, compressible": Elrod(2e4),
    "two-phase 0.9": TwoPhase(0.9),
    "two-phase 0.9999": TwoPhase(0.9999, 1e-6),
    "bubbly": Bubbly(0.1, 0.0, 5.0, 1e-3, 1e-2),
    "barotropic": Barotropic.scaled(
        SimpleNamespace(liquid_sound_speed=1400.0, vapour_sound_speed=350.0), FilmOil(250.0, 1e5, 0.9e5, 850.0)
    ),
}
HOLES = (Hole(1.0, 0.005, 0.2, 0.0025, 1.5e5, True), Hole(-2.0, 0.0095, 0.15, 0.0012, 0.5e5, False))
M, K = 30, 6


def section(near: str, far: str) -> Section:
    return Section(0.0125, 0.01, 0.02, 40e-6, 0.01, 1e5, 0.9e5, 2, near, far, 0.7e5, holes=HOLES)


def film_of(law: Law, near: str, far: str, roughness: float = 0.0) -> VolumeFilm:
    cut = replace(section(near, far), flow_roughness=roughness, shear=0.6)
    grid = volume_grid(cut, np.linspace(0, 2 * np.pi, M + 1), np.linspace(0, 1, K + 1))
    return VolumeFilm(cut, grid, law, 500.0)


def test_every_shipped_law_is_held_to_its_plain_form() -> None:
    assert {type(law) for law in LAWS.values()} == set(SHIPPED)


def test_wrights_function_solves_its_equation() -> None:
    x = np.concatenate([np.linspace(-36.9, 12.0, 2000), np.geomspace(1.0, 1e12, 1000)])
    omega, logarithm = np.array([wright_omega(value) for value in x]).T
    np.testing.assert_allclose(omega + np.log(omega), x, rtol=1e-13, atol=1e-12)
    np.testing.assert_allclose(omega, wrightomega(x), rtol=1e-12)
    np.testing.assert_allclose(logarithm, np.log(wrightomega(x)), rtol=1e-12, atol=1e-12)
    assert wright_omega(-50.0)[0] == 0.0
    assert wright_omega(1e15) == pytest.approx((1e15, math.log(1e15)), rel=1e-11)


def film_like(shape: tuple[int, int], closed: bool, seed: int, unfelt: Sequence[int] = ()) -> np.ndarray:
    """Entries over six decades: what leaves a cell enters others, and some is stored. unfelt: columns without a way
    into others."""
    random = np.random.default_rng(seed)
    m, k = shape
    stencil = -(10.0 ** random.uniform(-3.0, 3.0, (ENTRIES, m, k)))
    stencil[BELOW, :, 0] = stencil[ABOVE, :, -1] = 0.0
    if closed:  # the last column is cavitated
        stencil[BEHIND, -1] = 0.0
    for i in unfelt:
        stencil[BEFORE, (i + 1) % m] = stencil[BEHIND, i - 1] = 0.0
    entered = np.roll(stencil[BEFORE], -1, axis=0) + np.roll(stencil[BEHIND], 1, axis=0)
    entered[:, :-1] += stencil[BELOW, :, 1:]
    entered[:, 1:] += stencil[ABOVE, :, :-1]
    stencil[CENTRE] = -entered * (1.0 + 10.0 ** random.uniform(-4.0, 0.0, shape))
    return stencil


def solved_ring(stencil: np.ndarray, right: np.ndarray) -> np.ndarray:
    m, k, sides = right.shape
    fields = np.concatenate([np.zeros((m, k, k)), right], axis=2)
    solve_ring_at(ring_solver(k, sides), stencil, np.empty((m, k, k)), fields)
    return fields[:, :, k:].reshape(-1, sides)


COUNTS = [SIDES, ALL_SIDES]  # of right-hand sides, of films whose journal does not tilt and of those where it does
SHAPES = [
    (3, 1), (4, 2), (3, 3), (8, 4), (12, 5), (30, 6), (9, 8), (9, 9), (24, 10), (16, 12), (16, 14), (16, 16), (40, 20)
]  # fmt: skip


@pytest.mark.parametrize("sides", COUNTS)
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
def test_ring_solver_against_a_dense_one(shape: tuple[int, int], closed: bool, sides: int) -> None:
    for seed in (1, 2, 3):
        assert_solved(film_like(shape, closed, seed), seed, sides)


def assert_solved(stencil: np.ndarray, seed: int, sides: int) -> None:
    shape = stencil.shape[1:]
    right = np.random.default_rng(seed).normal(size=(*shape, sides))
    cell = np.arange(shape[0] * shape[1]).reshape(shape)
    matrix = np.zeros((cell.size, cell.size))
    matrix[cell, cell] = stencil[CENTRE]
    matrix[cell, np.roll(cell, 1, axis=0)] += stencil[BEFORE]
    matrix[cell, np.roll(cell, -1, axis=0)] += stencil[BEHIND]
    matrix[cell[:, 1:], cell[:, :-1]] = stencil[BELOW, :, 1:]
    matrix[cell[:, :-1], cell[:, 1:]] = stencil[ABOVE, :, :-1]
    exact = np.linalg.solve(matrix, right.reshape(-1, sides))
    assert np.allclose(solved_ring(stencil, right), exact, rtol=1e-9, atol=1e-10 * np.abs(exact).max())


@pytest.mark.parametrize("sides", COUNTS)
@pytest.mark.parametrize("shape", [(5, 3), (8, 4), (12, 5), (30, 6), (9, 8), (24, 10), (16, 12)])
def test_ring_that_unfelt_columns_part(shape: tuple[int, int], sides: int) -> None:
    """As cavities at p_cav do that turn with the oil: one of them anywhere, two, some beside each other, all."""
    last = shape[0] - 1
    for seed, columns in enumerate([(0,), (1,), (last,), (0, last), (0, 1), (2, 3), (1, 2, last), range(last + 1)]):
        assert_solved(film_like(shape, False, seed, columns), seed, sides)


def test_singular_ring_has_no_finite_solution() -> None:
    assert not np.isfinite(solved_ring(np.zeros((ENTRIES, 4, 2)), np.ones((4, 2, SIDES)))).any()


def arrays() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    return (
        np.zeros((STATES, M, K)),
        np.zeros((ENTRIES, M, K)),
        np.zeros((M, K, K)),
        np.zeros((M, K, K + SIDES)),
        np.zeros(FLOWS),
    )


@pytest.mark.parametrize("ends", [("oil-bath", "groove"), ("free-to-air", "symmetry"), ("free-to-air", "oil-bath")])
@pytest.mark.parametrize(("omega", "roughness"), [(300.0, 0.0), (-200.0, 0.0), (-200.0, 4e-6), (0.0, 0.0), (0.0, 4e-6)])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_balances_are_the_plain_ones(law: Law, omega: float, roughness: float, ends: tuple[str, str]) -> None:
    film = film_of(law, *ends, roughness)
    random = np.random.default_rng(2)
    w, past, rate = random.uniform(-0.6, 0.6, (M, K)), random.uniform(0.0, 3e3, (M, K)), 2e3
    motion = Motion((0.3, -0.5), (10.0, 40.0), omega)
    gap = gap_height(film.section, motion.d, film.grid.centre)[:, None]
    before = random.uniform(0.0, 1.0, (M, K))
    balance = CellBalances(film.section, film.grid, motion, before)
    state, storage = film.cells(w), Storage(rate * gap, past)
    residual, plain = balance.residual(state, storage), balance.stencil(state, storage)
    data = volume_films([film])
    states, stencil, _, fields, flows = arrays()
    parts = data.films[0], data.ring[0], data.places[0], data.cells[0]
    numbers = np.empty(LAW_NUMBERS)
    follow_law(parts[0], *motion.d, 0.0, 0.0, omega, numbers)
    cell_states(parts[0], parts[3], numbers, 0.0, w, states)
    states[BEFORE_UPSTREAM] = before
    at = GridMotion(*motion.d, omega, g=1e-4, rate=rate)
    balances(*parts, states, at, past, stencil, fields, flows)
    size = np.max(np.abs(residual))
    assert np.allclose(-fields[:, :, K], residual, rtol=1e-10, atol=1e-11 * size)
    for found, expected in zip(stencil, plain, strict=False):
        assert np.allclose(found, expected, rtol=1e-6, atol=1e-7 * np.max(np.abs(expected)))


@pytest.mark.parametrize("omega", [300.0, -200.0])
def test_limiter_is_the_plain_one(omega: float) -> None:
    random = np.random.default_rng(6)
    states = np.zeros((STATES, M, K))
    states[FRACTION] = random.uniform(0.0, 1.4, (M, K))
    hold(states, omega)
    assert np.array_equal(states[BEFORE_UPSTREAM], before_upstream(states[FRACTION], omega))
    a, b = random.normal(size=(2, 200))
    value, by_a, by_b = np.transpose([limited_at(*pair) for pair in zip(a, b, strict=True)])
    step = 1e-6
    assert np.allclose(value, limited(a, b), rtol=1e-13, atol=1e-15)
    assert np.allclose(by_a, (limited(a + step, b) - limited(a - step, b)) / (2.0 * step), rtol=1e-6, atol=1e-8)
    assert np.allclose(by_b, (limited(a, b + step) - limited(a, b - step)) / (2.0 * step), rtol=1e-6, atol=1e-8)


def test_limiter_is_of_second_order_where_oil_fractions_are_smooth_and_upwind_at_fronts() -> None:
    """Against the oil fraction at the face, for a wave, and for a step from full to nearly dry."""

    def off(cells: int) -> float:
        phi = (np.arange(cells) + 0.5) * 2.0 * np.pi / cells
        theta, at_face = 0.6 + 0.3 * np.sin(phi), 0.6 + 0.3 * np.sin(phi + np.pi / cells)
        more = limited(theta - np.roll(theta, 1), np.roll(theta, -1) - theta)
        away = np.abs(np.cos(phi)) > 0.2  # at an extreme value every limiter is of first order
        return float(np.max(np.abs(theta + more - at_face)[away]))

    assert off(200) < 0.27 * off(100)
    front = np.where(np.arange(20) < 8, 1.0, 0.2)
    assert not limited(front - np.roll(front, 1), np.roll(front, -1) - front).any()


@pytest.mark.parametrize("flowing", [None, Motion((0.29, -0.46), (20.0, 60.0), 400.0)], ids=["steady", "step"])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_solved_films_balance_by_the_plain_equations(law: Law, flowing: Motion | None) -> None:
    """To round-off; a step keeps the oil in the gap of its end, and lets it flow through that of its middle."""
    film, motion, rate = film_of(law, "free-to-air", "groove"), Motion((0.3, -0.5), (20.0, 60.0), 400.0), 2e3
    past = np.random.default_rng(4).uniform(0.5, 0.9, (M, K)) * rate
    if flowing is None:
        solution = FilmSolver(film).steady(motion)
        storage = Storage(gap_rate(motion.v, film.grid.centre)[:, None], np.zeros((M, K)))
    else:
        solution, content = FilmSolver(film).keep(motion, flowing, film.full(), rate, past)
        storage = Storage(rate * gap_height(film.section, motion.d, film.grid.centre)[:, None], past)
        assert np.allclose(content, film.content(motion, solution.w), rtol=1e-12, atol=1e-12)
    state = film.cells(solution.w, solution.gas and solution.gas.carried)
    if flowing is not None:
        assert np.array_equal(solution.before, np.ones((M, K)))  # held by a step: of where it began, a full film
    elif law.starves or not law.keeps_oil:
        assert np.isnan(solution.before).all()
    else:  # held by the last of several solutions: nearly its own, but for single cells where the limiter switches
        assert np.abs(solution.before - before_upstream(state.fraction, motion.omega)).mean() < 1e-3
    balance = CellBalances(film.section, film.grid, flowing or motion, solution.before)
    size = np.abs(balance.stencil(state, storage)[CENTRE]) * (1.0 + np.abs(solution.w))
    assert np.abs(balance.residual(state, storage)).max() < 1e-11 * size.max()
    fluxes = balance.fluxes(film.pressure(state), state.fraction)
    whole, film_only = (fluxes.net_outflow(share) for share in (np.ones((M, K)), film.grid.share))
    net, flows = film_only[film.grid.fixed].sum() + (whole - film_only - fluxes.excess).sum(), solution.flows
    net, ends = net - fluxes.far.sum(), fluxes.near  # at z = 1 lies a groove
    scale = 1e-9 * max(flows.inflow, flows.outflow)
    assert flows.supply == pytest.approx(net, abs=scale)
    assert flows.ends == pytest.approx(ends.sum(), abs=scale)
    assert flows.inflow - flows.outflow == pytest.approx(net - ends.sum(), abs=scale)


def test_start_in_any_order_of_memory_leads_to_the_same_film() -> None:
    film, motion = film_of(TwoPhase(0.9), "free-to-air", "groove"), Motion((0.3, -0.5), (0.0, 0.0), 400.0)
    start = np.random.default_rng(5).uniform(-0.2, 0.5, (M, K))
    found = [FilmSolver(film).steady(motion, w) for w in (start, np.asfortranarray(start))]
    assert np.array_equal(found[0].w, found[1].w)


@pytest.mark.parametrize("remembers", [True, False])
@pytest.mark.parametrize("name", LAWS)
def test_derivatives_by_the_journals_velocity(name: str, remembers: bool) -> None:
    law = LAWS[name]
    film = film_of(law, "free-to-air", "groove")
    data = volume_films([film])
    random = np.random.default_rng(3)
    g, spin, rate = 1e-4, 150.0, 1e4 if remembers else 0.0
    past = random.uniform(0.5, 1.0, (M, K)) * rate
    start = np.array([0.2, -0.4])

    def solved(v: np.ndarray) -> tuple[float, ...]:
        """Loads of a film in equilibrium with a journal that moves with v; v is that against a grid that turns."""
        w = film.full() + 0.01
        d = start + g * v
        against = v - spin * np.array([-d[1], d[0]])
        for _ in range(60):
            states, stencil, blocks, fields, flows = arrays()
            loads = film_newton(
                data, 0, w, GridMotion(d[0], d[1], 250.0, against[0], against[1], spin, g, rate), past,
                states, stencil, blocks, fields, flows,
            )  # fmt: skip
            w = w + fields[:, :, K]
            if np.max(np.abs(fields[:, :, K])) < 1e-12:
                break
        found: tuple[float, ...] = loads
        return found

    at = np.array([30.0, 50.0])
    loads = solved(at)
    change, expected = differences(lambda v: solved(v)[:2], at, 1e-3), np.reshape(loads[2:6], (2, 2))
    assert np.allclose(change, expected, rtol=2e-4, atol=1e-4 * np.max(np.abs(loads[2:])))


UNFED = ("bearing.ends=oil-bath", "bearing.supply={kind='none'}")
PLACE, OMEGA, G = (0.3, -0.5), 600.0, 2e-5


def system_of(*settings: str, cells: int = 5, law: str = "elrod") -> System:
    case = load_case("jeffcott", [*UNFED, f"film.cavitation={law}", f"accuracy.mesh=[{cells},48]", *settings])
    return planned_system(case)


def work_of(system: System, spin: float, oil: np.ndarray) -> Work:
    """Scratch for a film at PLACE that begins a stage with this oil fraction (m, k), on a grid that turns with spin."""
    data: Any = system.films.loop
    m, k = data.cells.shape[2:]
    work: Any = make_work(data, np.zeros((4, 1, m, k)), 2)
    work.grids["speed"], work.w[0] = spin, oil - 1.0
    work.past[0] = oil * gap_of(system) / G
    return work  # type: ignore[no-any-return]


def gap_of(system: System) -> np.ndarray:
    film = system.films.own[0]  # type: ignore[attr-defined]
    return np.asarray(gap_height(film.section, PLACE, film.grid.centre)[:, None])


def half_empty(cells: int) -> np.ndarray:
    """An oil fraction (m, k): three columns with more oil than their gap holds, all others partly empty."""
    oil = np.random.default_rng(7).uniform(0.1, 0.8, (48, cells))
    oil[20:23] = 1.02
    return oil


def ask(system: System, work: Any, iteration: int) -> None:
    cell_response(system.films.loop, work, 0, FilmMotion(*PLACE, 0.0, 0.0, OMEGA), G, 1, iteration)  # type: ignore[arg-type]


def move(system: System, work: Any) -> int:
    return move_even(system.films.loop, work, 0, 0.0, 0.0, G)  # type: ignore[arg-type]


@pytest.mark.parametrize("cells", [5, 7])  # an elimination made for this length, and the one for all others
def test_all_columns_balance_by_the_plain_equations(cells: int) -> None:
    """Also those that rest, of which nothing is solved; what leaves through the ends is what the film loses."""
    system, oil = system_of(cells=cells), half_empty(cells)
    work: Any = work_of(system, 0.5 * OMEGA, oil)
    work.w[0] += 0.05  # a bad guess
    for iteration in range(24):
        ask(system, work, iteration)
        if work.grids["balance"][0] == HELD:
            break
        move(system, work)
        work.grids["ratio"] = 0.0  # the journal stands still
    film = system.films.own[0]  # type: ignore[attr-defined]
    balance = CellBalances(film.section, film.grid, Motion(PLACE, (0.0, 0.0), 0.0), work.states[0, BEFORE_UPSTREAM])
    residual = balance.residual(film.cells(work.w[0]), Storage(gap_of(system) / G, work.past[0]))
    assert np.abs(residual).max() < 1e-5 * np.abs(work.past[0] * film.grid.area).max()
    rests = work.states[0, RESTS, :, 0] == 1.0
    assert list(np.flatnonzero(~rests)) == list(range(19, 24))  # the full ones, and a cavity on either side of them
    assert work.w[0][rests] == pytest.approx(oil[rests] - 1.0, rel=1e-12)
    rates = work.stage_oil[1, 0]
    assert np.abs(rates[rests]).max() < 1e-12 * work.past[0].max()
    lost = -float(np.sum(system.films.loop.cells[0, AREA] * rates))  # type: ignore[union-attr]
    assert lost > 0.0
    assert work.stage_flows[1, 0, ENDS_NET] == pytest.approx(lost, rel=1e-5)


@pytest.mark.parametrize(
    ("settings", "law", "spin"),
    [
        ((), "elrod", 0.4 * OMEGA),  # the surfaces carry oil through the faces
        (("oil.cavitation_pressure=0.9 bar",), "elrod", 0.5 * OMEGA),  # the bath flows into the cavity
        ((), "two-phase", 0.5 * OMEGA),  # whose pressure drives oil wherever it falls
    ],
)
def test_columns_that_oil_flows_through_do_not_rest(settings: tuple[str, ...], law: str, spin: float) -> None:
    system = system_of(*settings, law=law)
    work: Any = work_of(system, spin, half_empty(5))
    ask(system, work, 0)
    assert not work.states[0, RESTS].any()


def test_a_column_that_the_gap_closes_on_fills() -> None:
    """The oil that it keeps is more than its gap holds: it is full then, and presses."""
    system, oil = system_of(), half_empty(5)
    work: Any = work_of(system, 0.5 * OMEGA, oil)
    work.past[0, 40] = 1.01 * gap_of(system)[40] / G
    ask(system, work, 0)
    assert work.states[0, RESTS, 40, 0] == 1.0
    move(system, work)
    assert (work.w[0, 40] > 0.0).all()
    ask(system, work, 1)
    assert (work.states[0, PRESSURE_SLOPE, 40] > 0.0).all()
    assert not work.states[0, RESTS, 39:42, 0].any()
