"""Films that keep oil, linearised with its memory: against the settled film, the direct solution, and the time step."""

import math

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.film.cells.balance.states import UPWIND
from frbcli.film.cells.film import Motion, Storage, VolumeFilm
from frbcli.film.cells.linearised import dynamic_stiffness, linear_film, steady_force, stiffness_at
from frbcli.film.cells.loads import force, shear_weights
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.cells.tilted_film import TiltedFilm, linear_tilted, tilted_film, unit_loads
from frbcli.film.gap import whole_width
from frbcli.scene.films import film_places, volume_film

OMEGA = 2.0 * math.pi * 78.0
PLACE = np.array([5.9e-6, -0.8e-6])
WIDTH = 20e-3
LAWS = ["two-phase", "elrod", "peeken"]


def film_of(law: str, cells: tuple[int, int] = (48, 6)) -> VolumeFilm:
    case = load_case("rigid-two-phase", ["bearing.supply.pressure=2 bar", f"film.cavitation={law}"])
    return volume_film(case, film_places(case)[0], cells)


@pytest.mark.parametrize("law", ["two-phase", "elrod"])
def test_at_rest_it_is_the_stiffness_of_the_settled_film(law: str) -> None:
    film = film_of(law)
    linear = linear_film(film, PLACE, OMEGA)
    settled = steady_force(film, PLACE, np.zeros(2), OMEGA)
    expected = -settled.by_displacement
    np.testing.assert_allclose(stiffness_at(linear, 0.0).real, expected, atol=1e-8 * np.abs(expected).max())
    # by a velocity alone; steady_force moves the journal by 1e-9 s times it
    quick = -settled.by_velocity
    own = linear.push @ np.linalg.solve(linear.flow.toarray(), linear.by_rate)
    np.testing.assert_allclose(own, quick, atol=1e-6 * np.abs(quick).max())


@pytest.mark.parametrize("law", LAWS)
def test_it_is_what_a_small_step_in_time_does(law: str) -> None:
    """An implicit Euler step of 1 / s from rest, to a place or a speed beside it, moves the film by Z(s): its rates are
    s times its changes; so it does what missing oil leaves of the torque. The balances are those of
    FilmSolver.keep, with differences for derivatives."""
    film, s, step = film_of(law), 0.5 * OMEGA, 1e-5
    linear, clearance = linear_film(film, PLACE, OMEGA, factor="local").turning(), film.section.clearance
    d = PLACE / clearance
    solver, rest = FilmSolver(film), Motion((float(d[0]), float(d[1])), (0.0, 0.0), OMEGA)
    content, weights = film.content(rest, linear.field), shear_weights(film, rest, "local")
    found = np.empty((3, 3))
    for column, unit in enumerate(step * np.diag([1.0, 1.0, OMEGA])):
        forces = []
        for by in (unit, -unit):
            x, y = (d + by[:2]).tolist()
            moved = Motion((x, y), (0.0, 0.0), OMEGA + float(by[2]))
            solver._before = np.full(film.grid.shape, UPWIND)
            gap = film.gap(moved.d, film.grid.centre)[:, None]
            state = solver._solve(moved, linear.field, Storage(s * gap, s * content)).state
            forces.append(np.append(force(film, film.mean_pressure(state)), (weights * state.fraction).sum()))
        found[:, column] = -(forces[0] - forces[1]) / 2.0
    units = step * np.array([clearance, clearance, OMEGA / s])  # s times an angle is a speed
    expected = stiffness_at(linear, s).real * units
    size = np.abs(found).max(axis=0), np.abs(found).max(axis=1)[:, None]
    for each in size:
        np.testing.assert_allclose(expected / each, found / each, atol=2e-4)
    assert np.abs(found[2]).max() > 0.0


@pytest.mark.parametrize("law", LAWS)
def test_projections_are_exact_at_their_frequencies_and_close_between(law: str) -> None:
    linear = linear_film(film_of(law), PLACE, OMEGA)
    own = dynamic_stiffness(linear, [0.25 * OMEGA, 0.5 * OMEGA, OMEGA])
    for share, close in ((0.0, 1e-9), (0.25, 1e-9), (1.0, 1e-9), (0.35, 2e-3), (0.75, 2e-3), (0.5 - 0.05j, 2e-3)):
        s = 1j * share * OMEGA
        exact, (found, slope) = stiffness_at(linear, s), own.at(s)
        size = np.abs(exact).max()
        np.testing.assert_allclose(found, exact, atol=close * size)
        ahead, behind = (own.at(s + side)[0] for side in (1e-3, -1e-3))
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-3, atol=1e-5 * np.abs(slope).max())


TILTED = np.array([5.9e-6, -0.8e-6, 2e-4, -5e-4])  # m and rad, in a bearing 20 mm wide


def tilted_of(film: VolumeFilm) -> TiltedFilm:
    """The bearing of a section over its whole width, on as many cells."""
    (m, k), reference = film.grid.shape, film.scales.reference
    return tilted_film(whole_width(film.section), film.law, (m, 2 * k), reference)


@pytest.mark.parametrize("law", [*LAWS, "bubbly"])
def test_a_journal_that_is_parallel_has_the_same_film_with_tilts(law: str) -> None:
    """On the same cells to 1e-9: that of its displacements, and by the sum of the speeds; tilts do nothing to forces,
    nor displacements and speeds to moments."""
    even = film_of(law)
    whole = tilted_of(even)
    flat = VolumeFilm(even.section, whole.lands[0].film.grid, even.law, even.scales.reference)
    own, other = (
        linear.turning()
        for linear in (linear_tilted(whole, 0.0, np.append(PLACE, [0.0, 0.0]), OMEGA), linear_film(flat, PLACE, OMEGA))
    )
    for s in (0.0, 0.5j * OMEGA, (0.1 + 1.0j) * OMEGA):
        z, expected = stiffness_at(own, s), stiffness_at(other, s)
        size, tilts = np.abs(expected[:2]).max(axis=0), slice(2, 4)
        np.testing.assert_allclose(z[:2, [0, 1, 4]], expected[:2], atol=1e-9 * size.max())
        assert np.abs(z[:2, tilts]).max() < 1e-9 * size[0] * WIDTH
        assert np.abs(z[tilts, :2]).max() < 1e-9 * size[0] * WIDTH
        assert np.abs(z[tilts, tilts]).max() > 1e-2 * size[0] * WIDTH**2


@pytest.mark.parametrize("law", [*LAWS, "bubbly"])
def test_a_tilted_film_does_what_a_small_step_in_time_does(law: str) -> None:
    """As above, by all four coordinates, and by an angle by which both surfaces turn: s times it is a speed."""
    film, s = tilted_of(film_of(law, (24, 4))), 0.5 * OMEGA
    linear = linear_tilted(film, 0.0, TILTED, OMEGA).turning()
    steps = 1e-5 * np.array([40e-6, 40e-6, 4e-3, 4e-3, OMEGA / s])

    def stepped(by: np.ndarray) -> np.ndarray:
        """(4,) force and moments after an implicit Euler step of 1 / s to coordinates (5,) beside rest."""
        total = np.zeros(4)
        for land, field in zip(film.lands, linear.field, strict=True):
            solver, still = FilmSolver(land.film), np.zeros(4)
            rest, moved = land.motion(TILTED, still, OMEGA), land.motion(TILTED + by[:4], still, OMEGA + s * by[4])
            begun, gap = solver.steady(rest, field, upwind=True), land.film.gaps(moved)
            past = s * land.film.gaps(rest) * begun.state.fraction
            solver._before = np.full(land.film.grid.shape, UPWIND)
            if begun.gas is not None:
                solver._hold_gas(gap, Storage(s * gap, past), past * begun.gas.free)
            pressure = land.film.mean_pressure(solver._solve(moved, begun.w, Storage(s * gap, past)).state)
            total += land.map.T @ (unit_loads(land.film) @ pressure.ravel())
        return total

    found = np.column_stack([(stepped(-by) - stepped(by)) / (2.0 * by.sum()) for by in np.diag(steps)])
    expected = stiffness_at(linear, s).real[:4]
    arms = np.array([1.0, 1.0, WIDTH, WIDTH])
    found, expected = (each / arms[:, None] / np.append(arms, OMEGA / s) for each in (found, expected))
    size = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(found / size, expected / size, atol=2e-4)
    assert size[4] > 0.0
