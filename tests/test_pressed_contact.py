"""A journal pressed into an elastic shell: a gap is left, the force has no jump, cells settle, runs go on."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from frbcli.case.load import load_case
from frbcli.film.cavitation.elrod import Elrod
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cavitation.peeken import Peeken
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.data import COS, GAP, LEAST_GAP, SIN, STOPS_FROM
from frbcli.film.cells.states import FRACTION
from frbcli.film.contact_gap import gap_limits, kept_gap
from frbcli.runs.march import March
from frbcli.scene.plan import make_plan
from frbcli.scene.segments import Stretch
from frbcli.scene.system import System, make_system, run_up_profile
from frbcli.solve.cell_films import EMPTY, UNSETTLED, cell_numbers, move_cells
from frbcli.solve.films import make_work
from frbcli.solve.state import FINISHED, RUNNING

Array = NDArray[np.float64]
BASE = "axial-groove-two-phase"
LIMITS = [(0.995, 0.001), (0.998, 1e-4), (0.9995, 1e-4)]  # from where the gap is kept, what is left of it


def film_of(*limits: float) -> System:
    case = load_case(BASE, ["bearing.supply.pressure=4 bar", "accuracy.mesh=[6,48]"])
    system = make_system(case, make_plan(case))
    if limits:
        system.films.numbers[:, STOPS_FROM], system.films.numbers[:, LEAST_GAP] = limits  # type: ignore[union-attr]
    return system


def settle(system: System, d: Array, w: Array, past: Array, g: float, leaps: bool) -> tuple[int, Array, Array]:
    """(iterations, force, oil fractions) of a film under a journal that stands; 24 iterations: it has not settled.
    past: oil at the start over g; leaps: cells may leap over their transition."""
    films: object = system.films
    work = make_work(films, np.zeros((4, 1, *w.shape)), 2)
    work.w[0], grid = w, work.grids[:, 0]
    force, states, iteration = np.zeros(2), work.states[0], 0
    for iteration in range(24):
        force = np.array(cell_numbers(
            films.numbers[0], films.ring[0], films.width[0], films.cells[0], work.w[0], past, states,  # type: ignore[attr-defined]
            work.stencil, work.blocks, work.fields[0], work.stage_oil[1, 0], work.stage_flows[1, 0], grid,
            work.slopes[0], work.w[0], d[0], d[1], 0.0, 0.0, 1700.0, g, iteration,
        )[:2])  # fmt: skip
        if grid[UNSETTLED] == 0.0:
            return iteration, force, states[FRACTION]
        if leaps:
            grid[EMPTY] = -math.inf
        move_cells(work.w[0], work.fields[0], grid, 0.0, 0.0, g, np.zeros(0))
    return iteration + 1, force, states[FRACTION]


def gaps(system: System, d: Array) -> Array:
    """(m, 1) the gap of the cells that the film feels."""
    films: object = system.films
    limits, ring = films.numbers[0, [STOPS_FROM, LEAST_GAP]], films.ring[0]  # type: ignore[attr-defined]
    x, y = kept_gap(*limits, *d)[:2]
    return np.asarray(ring[GAP] + x * ring[SIN] - y * ring[COS])[:, None]


def test_the_gap_is_kept_where_the_surfaces_touch() -> None:
    assert gap_limits(0.995) == pytest.approx((0.995, 0.001))
    stops, least = gap_limits(0.9999)
    assert least == pytest.approx(1e-4)  # where the tables end
    assert stops < 0.9999


@pytest.mark.parametrize("limits", LIMITS)
@pytest.mark.parametrize("eccentricity", [0.5, 0.99801, 0.9996, 1.002, 1.05])
def test_a_journal_in_the_shell_keeps_a_gap(eccentricity: float, limits: tuple[float, float]) -> None:
    x, y = eccentricity * np.cos(0.7), eccentricity * np.sin(0.7)
    felt_x, felt_y, xx, yy, xy = kept_gap(*limits, x, y)
    assert np.hypot(felt_x, felt_y) <= min(eccentricity, 1.0 - limits[1]) * (1.0 + 1e-15)
    step, columns = 1e-7, []
    for side in step * np.eye(2):
        ahead, behind = kept_gap(*limits, x + side[0], y + side[1]), kept_gap(*limits, x - side[0], y - side[1])
        columns.append((np.array(ahead[:2]) - np.array(behind[:2])) / (2.0 * step))
    assert np.array([[xx, xy], [xy, yy]]) == pytest.approx(np.column_stack(columns), abs=1e-5)


def test_the_gap_and_its_rate_have_no_jump() -> None:
    """The derivatives on both sides of where the gap begins to be kept."""
    inside, outside = (np.array(kept_gap(0.995, 0.001, 0.995 + side, 0.0)) for side in (-1e-9, 1e-9))
    assert inside == pytest.approx(outside, abs=1e-6)


def test_a_cell_without_oil() -> None:
    scales, law = Scales(3.0, 0.0, 0.1), TwoPhase(0.99)
    w = law.empty(law.parameters, scales)
    fractions = law.cells(np.array([w - 0.1, w, 0.0, 0.1]), scales).fraction
    below, between, above = np.diff(fractions) / (0.1, -w, 0.1)
    assert max(below, above) < 0.1 * between
    others: tuple[Law, ...] = (Peeken(0.1), Elrod(1e5))
    for other in others:  # their oil goes on below
        assert other.empty(other.parameters, scales) == -math.inf
        steep = other.cells(np.array([-1.1, -0.5]), scales).fraction_slope
        assert min(steep) > 0.9 * max(steep)


def test_cells_of_a_closing_gap_settle() -> None:
    """The narrowest column is to be half full after a very short step, and begins with a huge pressure."""
    system, g = film_of(0.999, 1e-4), 1e-7
    ring = system.films.ring[0]  # type: ignore[union-attr]
    d = 0.9998 * np.array([-ring[SIN, 14], ring[COS, 14]])
    gap = gaps(system, d)
    past = np.repeat(gap / g, 6, axis=1)
    past[14] *= 0.6
    w = np.full(past.shape, 0.1)
    w[14] = 25.0
    iterations, _, theta = settle(system, d, w, past, g, leaps=False)
    assert iterations < 8
    assert theta[14] == pytest.approx(0.6, abs=0.05)
    assert settle(system, d, w, past, g, leaps=True)[0] == 24


@pytest.mark.parametrize("limits", LIMITS)
def test_the_force_has_no_jump_over_the_contact(limits: tuple[float, float]) -> None:
    """From 0.99 to 1.01: where the force is continuous, half the distance makes half the largest difference."""
    system, g = film_of(*limits), 2e-5
    ring = system.films.ring[0]  # type: ignore[union-attr]
    n = np.array([-ring[SIN, 14], ring[COS, 14]])
    past = np.repeat(gaps(system, 0.989 * n) / g, 6, axis=1)

    def largest_difference(count: int) -> float:
        forces, w = [], np.full(past.shape, 0.1)
        for eccentricity in np.linspace(0.99, 1.01, count):
            iterations, force, _ = settle(system, eccentricity * n, w, past, g, leaps=False)
            assert iterations < 24
            forces.append(force)
        return float(np.max(np.linalg.norm(np.diff(forces, axis=0), axis=1)) / np.max(np.abs(forces)))

    coarse, fine = largest_difference(401), largest_difference(801)
    assert fine < 0.6 * coarse
    assert fine < 0.05


@pytest.mark.parametrize("limits", LIMITS)
def test_a_whirl_in_the_shell_goes_on(limits: tuple[float, float]) -> None:
    """Wherever the gap begins to be kept, the journal sinks into the shell and the run gets to its end."""
    speed = ["speed.from=260 Hz", "speed.to=270 Hz", "speed.duration=0.3 s"]
    case = load_case(BASE, ["bearing.supply.pressure=4 bar", *speed])
    plan, system, profile = make_plan(case), film_of(*limits), run_up_profile(case)
    march = March(case, plan, [Stretch(0.0, case, system)], profile)
    status, largest = RUNNING, 0.0
    while status == RUNNING:
        status, signals = march.chunk()
        largest = max(largest, *signals["eccentricity"], 0.0)
    assert status == FINISHED
    assert 1.0 < largest < 1.02
