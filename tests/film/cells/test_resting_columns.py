"""Columns of cells that keep their oil in the time loop: cavities that turn with the oil, see resting.py."""

from typing import Any

import numpy as np
import pytest
from marches import planned_system

from frbcli.case.reading.load import load_case
from frbcli.film.cells.balance.balances import ENDS_NET
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, PRESSURE_SLOPE, RESTS
from frbcli.film.cells.data import AREA
from frbcli.film.cells.film import Motion, Storage
from frbcli.film.gap import gap_height
from frbcli.scene.machine.system import System
from frbcli.solve.films.cell_steps import Work
from frbcli.solve.films.cells import HELD, cell_response, move_even
from frbcli.solve.films.steps import make_work
from frbcli.solve.stage.equations import FilmMotion

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
    residual, _ = balance.residual(film.cells(work.w[0]), Storage(gap_of(system) / G, work.past[0]))
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
