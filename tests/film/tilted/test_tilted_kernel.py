"""The compiled balances and loads of films whose journal tilts, against the plain ones and against differences."""

from dataclasses import astuple, replace
from functools import partial

import numpy as np
import pytest
from differences import differences
from plain_balances import CellBalances, oil_paths, path_layers

from frbcli.film.cavitation.conditions import Elrod, HalfSommerfeld, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import CellState, Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.balance.balances import COLUMNS, GridMotion, balances
from frbcli.film.cells.balance.ends import ENDS_NET, FLOWS, SUPPLY_NET
from frbcli.film.cells.balance.faces import film_loads
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, CARRIED_GAS, STATES, before_upstream
from frbcli.film.cells.block_cyclic import ENTRIES
from frbcli.film.cells.data import ALL_SIDES, BY_ENDS
from frbcli.film.cells.film import Motion, Storage, VolumeFilm, gap_height
from frbcli.film.cells.gas.carry import BACKWARD, DOWNWARD, GIVEN, KEPT, ONWARD, OUT, PATHS, UPWARD, follow_oil
from frbcli.film.cells.tilted_film import TiltedLand, TiltedVolumes, _loads, tilted_film, tilted_volumes
from frbcli.film.gap import AxialGroove, Hole, Section, gap_rate

R, B, C, ETA, TOTAL = 0.01, 0.012, 40e-6, 0.01, 900.0
HOLES = (Hole(1.0, 0.005, 0.2, 0.0025, 1.5e5, True), Hole(-2.0, 0.0095, 0.15, 0.0012, 0.5e5, False))
GROOVES = (AxialGroove(0.7, 0.3, 0.5e5),)
SECTIONS = {
    "plain": Section(R, B, B, C, ETA, 1e5, 0.9e5, 1, "oil-bath", "oil-bath"),
    "divided": Section(R, 0.5 * B, B, C, ETA, 1e5, 0.9e5, 2, "free-to-air", "groove", 0.7e5),
    "bores": Section(R, B, B, C, ETA, 1e5, 0.9e5, 1, "free-to-air", "oil-bath", holes=HOLES),
    "grooves": Section(R, B, B, C, ETA, 1e5, 0.9e5, 1, "oil-bath", "oil-bath", grooves=GROOVES),
}
LAWS: dict[str, Law] = {
    "sommerfeld": Sommerfeld(),
    "half-sommerfeld": HalfSommerfeld(),
    "reynolds": Reynolds(),
    "elrod": Elrod(),
    "two-phase": TwoPhase(0.9),
}
D, V = np.array([0.3, -0.35, -0.2, -0.5]), np.array([120.0, 40.0, -200.0, 90.0])
G = 2e-5


def lands_of(section: Section, law: Law, around: int = 30) -> tuple[TiltedVolumes, tuple[TiltedLand, ...]]:
    film = tilted_film(section, law, (around, 12), 500.0)
    return tilted_volumes([film]), film.lands


def between(d: np.ndarray, v: np.ndarray, total: float, g: float, rate: float) -> GridMotion:
    """The motion between the coordinates at both ends of a bearing."""
    (near, more), (near_v, more_v) = ((x[:2], x[2:] - x[:2]) for x in (d, v))
    return GridMotion(*map(float, (*near, total, *near_v, 0.0, g, rate, *more, *more_v)), True)


def motion_of(land: TiltedLand, d: np.ndarray, v: np.ndarray) -> Motion:
    """Of the land, from the coordinates at the ends of the bearing."""
    low, high = land.places(np.array([0.0, 1.0]))

    def at(x: np.ndarray) -> tuple[tuple[float, float], tuple[float, float]]:
        near, far = ((1.0 - z) * x[:2] + z * x[2:] for z in (low, high))
        middle, growth = 0.5 * (near + far), far - near
        return (middle[0], middle[1]), (growth[0], growth[1])

    (place, slope), (rate, slope_rate) = at(d), at(v)
    return Motion(place, rate, TOTAL, slope, slope_rate)


def some_states(film: VolumeFilm) -> tuple[np.ndarray, CellState]:
    """States of all kinds of cells, as the kernel and as the plain form has them."""
    m, k = film.grid.shape
    phi, z = film.grid.centre[:, None], film.grid.height[None, :]
    w = 0.8 * np.sin(phi) + 0.3 * np.cos(2.0 * phi) * z + 0.2 * z
    state = film.cells(w)
    states = np.zeros((STATES, m, k))
    states[:CARRIED_GAS] = astuple(state)
    states[BEFORE_UPSTREAM] = before_upstream(state.fraction, TOTAL)
    return states, state


def kernel(
    data: TiltedVolumes, number: int, states: np.ndarray, d: np.ndarray, v: np.ndarray, g: float, rate: float,
    past: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    m, k = states.shape[1:]
    stencil, right, flows = np.ones((ENTRIES, m, k)), np.ones((m, k, k + ALL_SIDES)), np.ones(FLOWS)
    given = (part[number] for part in (data.films, data.ring, data.places, data.cells))
    balances(*given, states, between(d, v, TOTAL, g, rate), past, stencil, right, flows)
    return stencil, right, flows


@pytest.mark.parametrize("keeps", [False, True])
@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
@pytest.mark.parametrize("law", [LAWS["reynolds"], LAWS["two-phase"]], ids=["reynolds", "two-phase"])
@pytest.mark.parametrize("around", [30, 3 * COLUMNS + 1], ids=["part", "one-left"])
def test_balances_are_the_plain_ones(law: Law, section: Section, keeps: bool, around: int) -> None:
    """Also where the last of the columns that are balanced at a time stands alone."""
    data, lands = lands_of(section, law, around)
    for number, land in enumerate(lands):
        film = land.film
        states, state = some_states(film)
        motion = motion_of(land, D, V)
        rate, past = (1.0 / G if keeps else 0.0), np.random.default_rng(1).uniform(-90.0, 90.0, film.grid.shape)
        stencil, right, flows = kernel(data, number, states, D, V, G, rate, past)
        phi, z = film.grid.centre[:, None], film.grid.height
        factor = (
            rate * gap_height(film.section, motion.displacement_at(z), phi)
            if keeps
            else gap_rate(motion.velocity_at(z), phi)
        )
        balance = CellBalances(film.section, film.grid, motion, states[BEFORE_UPSTREAM])
        storage = Storage(factor, past)
        residual, plain = balance.residual(state, storage), balance.stencil(state, storage)
        k = film.grid.shape[1]
        assert right[:, :, k] == pytest.approx(-residual, abs=1e-12 * np.abs(residual).max())
        assert stencil[:5] == pytest.approx(plain, rel=1e-6, abs=1e-8 * np.abs(plain).max())
        fluxes = balance.fluxes(state.pressure, state.fraction)
        ends = fluxes.near.sum() + (0.0 if film.section.far == "groove" else fluxes.far.sum())
        assert flows[ENDS_NET] == pytest.approx(ends, abs=1e-12 * np.abs(residual).sum())
        if film.grid.fixed.any():
            assert flows[SUPPLY_NET] != 0.0


@pytest.mark.parametrize("total", [TOTAL, -TOTAL])
@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
def test_the_oil_that_carries_gas_takes_the_plain_paths(section: Section, total: float) -> None:
    data, lands = lands_of(section, TwoPhase(0.9))
    for number, land in enumerate(lands):
        film = land.film
        states, state = some_states(film)
        states[BEFORE_UPSTREAM] = before_upstream(state.fraction, total)
        motion = replace(motion_of(land, D, V), omega=total)
        balances = CellBalances(film.section, film.grid, motion, states[BEFORE_UPSTREAM])
        paths, expected = np.ones((PATHS, *film.grid.shape)), np.zeros((PATHS, *film.grid.shape))
        path_layers(oil_paths(balances, state.pressure, state.fraction), expected)
        given = (part[number] for part in (data.films, data.ring, data.places, data.cells))
        follow_oil(*given, states, between(D, V, total, G, 0.0), paths)
        free = ~film.grid.fixed  # what given cells take and give is not asked for
        for layer in (ONWARD, BACKWARD, UPWARD, DOWNWARD, OUT, GIVEN):
            of = slice(None, -1) if layer in (UPWARD, DOWNWARD) else slice(None)
            found, plain = paths[layer][:, of][free[:, of]], expected[layer][:, of][free[:, of]]
            assert found == pytest.approx(plain, abs=1e-12 * np.abs(expected[:KEPT]).max())
        assert expected[GIVEN].max() > 0.0


def moved_balances(data: TiltedVolumes, number: int, states: np.ndarray, keeps: bool, v: np.ndarray) -> np.ndarray:
    past, rate = np.zeros(states.shape[1:]), (1.0 / G if keeps else 0.0)
    return kernel(data, number, states, D + G * (v - V), v, G, rate, past)[1]


@pytest.mark.parametrize("keeps", [False, True])
@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
def test_derivatives_by_velocities_are_those_of_differences(section: Section, keeps: bool) -> None:
    """A velocity moves the journal by g, too."""
    data, lands = lands_of(section, TwoPhase(0.9))
    for number, land in enumerate(lands):
        states, _ = some_states(land.film)
        k, right = states.shape[2], partial(moved_balances, data, number, states, keeps)
        measured, exact = differences(right, V, 4.0)[:, :, k], right(V)[:, :, k + BY_ENDS : k + BY_ENDS + 4]
        assert np.all(np.abs(exact - measured).max(axis=(0, 1)) < 1e-7 * np.abs(measured).max(axis=(0, 1)))


def loads_of(data: TiltedVolumes, number: int, states: np.ndarray, fields: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    loads, slopes, push = np.empty(4), np.empty((4, 4)), np.empty((4, *states.shape[1:]))
    given = (part[number] for part in (data.films, data.ring, data.places, data.cells))
    film_loads(*given, states, fields, push, loads, slopes)
    return loads, slopes


def moved_loads(
    data: TiltedVolumes, number: int, states: np.ndarray, fields: np.ndarray, by: np.ndarray
) -> np.ndarray:
    """The loads after the ends have moved by (4,)."""
    changed, k = fields.copy(), states.shape[2]
    changed[:, :, k] += fields[:, :, k + BY_ENDS : k + BY_ENDS + 4] @ by
    return loads_of(data, number, states, changed)[0]


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("section", ["plain", "divided"])
def test_loads_do_the_work_of_the_plain_ones(section: str, law: Law) -> None:
    """After a change of the cells by Newton's method, and their derivatives by differences of it."""
    random = np.random.default_rng(2)
    data, lands = lands_of(SECTIONS[section], law)
    for number, land in enumerate(lands):
        film = land.film
        m, k = film.grid.shape
        states, state = some_states(film)
        fields = random.uniform(-0.02, 0.02, (m, k, k + ALL_SIDES))
        loads, slopes = loads_of(data, number, states, fields)
        changed = replace(state, pressure=state.pressure + state.pressure_slope * fields[:, :, k])
        ends = land.places(np.array([0.0, 1.0]))
        # u = middle and growth over the land, of what the two ends of the bearing do
        by_ends = np.array([[1.0 - ends.mean(), ends.mean()], [ends[0] - ends[1], ends[1] - ends[0]]])
        expected = np.kron(by_ends, np.eye(2)).T @ _loads(film, film.mean_pressure(changed))
        assert loads == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
        measured = differences(partial(moved_loads, data, number, states, fields), np.zeros(4), 1e-6)
        assert np.abs(slopes - measured).max() < 1e-6 * np.abs(slopes).max()
