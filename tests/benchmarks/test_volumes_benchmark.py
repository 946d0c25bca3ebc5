"""Cost of the compiled film on volumes, CPU time in one process: `pytest -m timing -s` prints it.

One iteration of Newton's method of the two-phase film, with its derivatives by the journal's velocity, beside the naive
way: one assembly with scikit-fem and one sparse solve on quadratic elements with as many nodes, without derivatives.
And a warm step of Elrod's film through time. Both on the cells that one would take without parabolas over the width,
and on the fewer ones that are as exact with them (tests/film/cells/test_volumes.py).
"""

import math
import time
from collections.abc import Callable

import numpy as np
import pytest
from films import rectangular
from numba import njit
from test_benchmark import NaiveFilm, report
from volume_films import AMBIENT, CLEARANCE, RADIUS, ROTATION, VISCOSITY, WIDTH, section_of

from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cavitation.conditions import Elrod
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.cells.balance.ends import FLOWS
from frbcli.film.cells.balance.newton_step import film_newton
from frbcli.film.cells.balance.states import FRACTION, STATES, cell_states, follow_law
from frbcli.film.cells.block_cyclic import ENTRIES
from frbcli.film.cells.data import COS, GAP, SIDES, SIN, level, volume_films
from frbcli.film.cells.film import VolumeFilm, fitted_grid, reference_pressure
from frbcli.film.cells.solver import FilmSolver

pytestmark = [pytest.mark.nightly, pytest.mark.timing]

REPEATS, ITERATIONS, STEPS = 5, 200, 300
STEP_s, WHIRL, OMEGA = 1e-4, 2.0 * math.pi * 10.0, 2.0 * math.pi * 100.0
SETTLED, MOST_ITERATIONS = 1e-6, 12  # change of w that ends a step


@njit
def iterate(  # type: ignore[no-untyped-def]
    films, w, motion, nothing, states, stencil, blocks, fields, flows, count
):
    """Iterations of a steady film from the same w; returns the last force."""
    force = 0.0
    for _ in range(count):
        force = film_newton(
            films, 0, w, motion, nothing, states, stencil, blocks, fields, flows
        )[0]  # fmt: skip
    return force


@njit
def circle(  # type: ignore[no-untyped-def]
    films, w, content, past, dt, omega, speed, states, stencil, blocks, fields, flows, count
):
    """Euler steps of a whirl with eps 0.6; returns the number of iterations."""
    m, k = w.shape
    own, ring, cells = films.films[0], films.ring[0], films.cells[0]
    law = np.empty(LAW_NUMBERS)
    iterations = 0
    for n in range(count):
        d_x, d_y = 0.6 * math.cos(speed * dt * (n + 1)), 0.6 * math.sin(speed * dt * (n + 1))
        past[:] = content / dt
        for _ in range(MOST_ITERATIONS):
            film_newton(
                films, 0, w, level(d_x, d_y, omega, 0.0, 0.0, 0.0, dt, 1.0 / dt), past,
                states, stencil, blocks, fields, flows,
            )  # fmt: skip
            iterations += 1
            largest = 0.0
            for i in range(m):
                for j in range(k):
                    w[i, j] += fields[i, j, k]
                    largest = max(largest, abs(fields[i, j, k]))
            if largest < SETTLED:
                break
        follow_law(own, 0.0, 0.0, 0.0, 0.0, omega, law)
        cell_states(own, cells, law, 0.0, w, states)
        for i in range(m):
            gap = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
            for j in range(k):
                content[i, j] = gap * states[FRACTION, i, j]
    return iterations


def film_of(law: Law, around: int, along: int) -> VolumeFilm:
    section = section_of("circumferential-groove", 2e5)
    grid = fitted_grid(section, (0.0, 0.0), around, along)
    return VolumeFilm(section, grid, law, reference_pressure(section, ROTATION))


def scratch(m: int, k: int) -> tuple[np.ndarray, ...]:
    shapes = (STATES, m, k), (ENTRIES, m, k), (m, k, k), (m, k, k + SIDES), (FLOWS,)
    return tuple(np.zeros(shape) for shape in shapes)


def seconds(job: Callable[[], object], count: int) -> float:
    """The least CPU time of one of `count` in a job that does them all."""
    times = []
    for _ in range(REPEATS):
        began = time.process_time()
        job()
        times.append((time.process_time() - began) / count)
    return min(times)


def iteration_seconds(along: int) -> float:
    film = film_of(TwoPhase(0.99), 40, along)
    w = FilmSolver(film).steady(ROTATION).w
    data = volume_films([film])
    at = GridMotion(*ROTATION.d, ROTATION.omega, g=1e-4)

    def job() -> None:
        iterate(data, w, at, np.zeros(w.shape), *scratch(*w.shape), ITERATIONS)

    job()  # compiles
    return seconds(job, ITERATIONS)


def test_iteration_of_the_two_phase_film_against_the_naive_way() -> None:
    bearing = rectangular(WIDTH, 2.0 * RADIUS, CLEARANCE, VISCOSITY, AMBIENT, AMBIENT, groove=2)
    naive_film = NaiveFilm(bearing)
    d, v = np.array(ROTATION.d), np.zeros(2)
    naive = seconds(lambda: [naive_film.force(d, v, ROTATION.omega) for _ in range(5)], 5)
    many, few = iteration_seconds(20), iteration_seconds(6)
    report(
        f"\none iteration, two-phase: 40 x 20 cells {1e3 * many:.3f} ms, ratio {naive / many:.0f}; 40 x 6, as exact, "
        f"{1e3 * few:.3f} ms, ratio {naive / few:.0f}; naive {1e3 * naive:.1f} ms"
    )
    assert naive / few >= 40


def step_figures(along: int) -> tuple[float, float]:
    """(CPU seconds, iterations) of one warm step of Elrod's film."""
    film = film_of(Elrod(), 100, along)
    data = volume_films([film])
    m, k = film.grid.shape
    begun = film.full(), film.gap((0.6, 0.0), film.grid.centre)[:, None] * np.ones((m, k))

    def job() -> int:
        w, content = (array.copy() for array in begun)
        total: int = circle(data, w, content, np.zeros((m, k)), STEP_s, OMEGA, WHIRL, *scratch(m, k), STEPS)
        assert np.all(np.isfinite(w))
        return total

    iterations = job()
    return seconds(job, STEPS), iterations / STEPS


def test_warm_step_of_elrods_film() -> None:
    (many, spent), (few, spent_few) = step_figures(26), step_figures(8)
    report(
        f"\nwarm step, Elrod: 100 x 26 cells {1e3 * many:.2f} ms in {spent:.1f} iterations; 100 x 8, as exact, "
        f"{1e3 * few:.2f} ms in {spent_few:.1f}"
    )
    assert few < 1e-3
