"""The edge of the cavity within cells, also of clipped films: derivatives, places of the cells, Reynolds' own edge."""

import math

import numpy as np
import pytest
from differences import differences

from frbcli.case.reading.load import load_case
from frbcli.film.cavitation.conditions import HalfSommerfeld
from frbcli.film.cells.balance.faces import film_loads
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE, STATES
from frbcli.film.cells.data import SIDES, volume_films
from frbcli.film.cells.film import Motion, VolumeFilm, clipped_means
from frbcli.film.cells.linearised import film_at, lying, settled_force
from frbcli.film.cells.loads import force
from frbcli.film.cells.mesh.grid import volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section
from frbcli.film.rectangles.film import FilmForce
from frbcli.scene.films import film_places, volume_film

OMEGA = 2.0 * math.pi * 100.0
PLACE = (0.66 * math.sin(0.8), -0.66 * math.cos(0.8))


def film(law: str, cells: tuple[int, int], edged: bool = True, pressure: str = "2 bar") -> VolumeFilm:
    case = load_case("jeffcott", [f"film.cavitation={law}", f"bearing.supply.pressure={pressure}"])
    (place,) = film_places(case)
    return film_at(volume_film(case, place, cells, edged=edged), 0.66, OMEGA)


def force_at(of: VolumeFilm, d: tuple[float, float] = PLACE, v: tuple[float, float] = (0.0, 0.0)) -> FilmForce:
    """The film with its law as it is in PLACE."""
    solver, motion = FilmSolver(of), Motion(d, v, OMEGA)
    return settled_force(solver, motion, solver.steady(motion))


@pytest.mark.parametrize("law", ["reynolds", "penalty"])
def test_derivatives_are_those_of_the_force(law: str) -> None:
    of, nudge = film(law, (48, 6)), 1e-5
    found, clearance = force_at(of), film(law, (48, 6)).section.clearance
    by_d = differences(lambda d: force_at(of, d=tuple(d)).force, PLACE, nudge)
    by_v = differences(lambda v: force_at(of, v=tuple(v)).force, (0.0, 0.0), 300.0 * nudge)
    for derivative, slope in ((found.by_displacement, by_d), (found.by_velocity, by_v)):
        assert np.abs(derivative - slope / clearance).max() < 1e-5 * np.abs(derivative).max()


@pytest.mark.parametrize("law", ["reynolds", "penalty"])
def test_stiffness_and_damping_hardly_depend_on_where_the_cells_lie(law: str) -> None:
    """With the edge between cells they differ by 1 to 2 %, an error of first order; it is of second order within."""

    def scatter(edged: bool) -> float:
        found = [force_at(lying(film(law, (72, 10), edged), share)) for share in (0.0, 0.25, 0.5, 0.75)]
        return max(
            float(np.ptp([getattr(each, name) for each in found], axis=0).max() / np.abs(getattr(found[0], name)).max())
            for name in ("by_displacement", "by_velocity")
        )

    assert scatter(False) > 1e-2
    assert scatter(True) < 0.4 * scatter(False)


def test_oil_appears_where_the_gap_opens_behind_the_edge() -> None:
    """The source of Reynolds' condition is omega/2 H' in the whole cavity and none in the film: their integral is the
    rise of the gap from the edge on, which must not jump by a cell as the edge moves by a part of one."""
    of = film("reynolds", (72, 10), pressure="1 bar")

    def edge(place: tuple[float, float]) -> float:
        """Angle from which the gap has risen by as much as the oil in the row beside the plane of symmetry tells."""
        solution, grid = FilmSolver(of).steady(Motion(place, (0.0, 0.0), OMEGA)), of.grid
        cavity = np.flatnonzero(solution.state.source[:, -1] > 0.0)
        made = float(solution.state.source[cavity, -1] @ np.diff(grid.phi)[cavity])
        narrowest = math.atan2(-place[0], place[1])
        end = grid.phi[np.argmax(of.gap(place, grid.phi))]
        risen = float(of.gap(place, np.array([end]))[0]) - made / (0.5 * OMEGA)
        return math.acos((1.0 - risen) / math.hypot(*place)) + narrowest

    turned = 0.2 * 2.0 * math.pi / 72  # a fifth of a cell
    edges = []
    for number in range(5):
        angle = 0.8 + number * turned
        edges.append(edge((0.66 * math.sin(angle), -0.66 * math.cos(angle))) - number * turned)
    assert np.ptp(edges) < 0.1 * 2.0 * math.pi / 72


TURN = 2.0 * math.pi
SECTION = Section(12.5e-3, 10e-3, 20e-3, 40e-6, 12e-3, 1e5, 0.9e5, 2, "oil-bath", "symmetry")


def plain_film(around: int, along: int) -> VolumeFilm:
    grid = volume_grid(SECTION, np.linspace(-math.pi, math.pi, around + 1), np.linspace(0.0, 1.0, along + 1))
    return VolumeFilm(SECTION, grid, HalfSommerfeld(), 100.0)


def towards(film: VolumeFilm, eccentricity: float, angle: float) -> np.ndarray:
    """Force along and across the line of centres, at an angle of it to the grid."""
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    d = eccentricity * along
    solution = FilmSolver(film).steady(Motion((float(d[0]), float(d[1])), (0.0, 0.0), 900.0))
    found = np.array(force(film, film.mean_pressure(solution.state)))
    return np.array([along @ found, across @ found])


@pytest.mark.parametrize(("eccentricity", "error", "spread"), [(0.2, 5e-4, 2e-4), (0.6, 1e-3, 5e-4), (0.9, 5e-3, 2e-3)])
def test_force_is_the_same_wherever_the_edge_of_the_cavity_lies(
    eccentricity: float, error: float, spread: float
) -> None:
    """Over a cell in eighths; clipped cell by cell, error and spread were 1.6e-3, 2.8e-3 and 1.7e-2."""
    finer, finest = (towards(plain_film(cells, cells // 8), eccentricity, 0.3) for cells in (144, 288))
    limit = finest + (finest - finer) / 3.0
    film = plain_film(48, 6)
    forces = np.array([towards(film, eccentricity, i * TURN / 48 / 8) for i in range(8)])
    size = float(np.linalg.norm(limit))
    assert np.linalg.norm(forces - limit, axis=1).max() < error * size
    assert np.linalg.norm(forces - forces.mean(axis=0), axis=1).max() < spread * size


def test_edges_of_a_parabola_are_found() -> None:
    """The area under a parabola whose values are off by -h^2 / 48 of its curvature, half of what balances of flows
    around are off by."""
    cells = 40
    h = 1.0 / cells
    x = (np.arange(cells) + 0.5) * h
    for middle in np.linspace(0.45, 0.45 + h, 7):
        values = 0.1 - (x - middle) ** 2 + h**2 / 24.0
        area = h * clipped_means(values[:, None]).sum()
        assert area == pytest.approx(4.0 / 3.0 * 0.1**1.5, rel=2e-4)
        clipped = h * np.maximum(values, 0.0).sum()
        assert abs(area - 4.0 / 3.0 * 0.1**1.5) < 0.2 * abs(clipped - 4.0 / 3.0 * 0.1**1.5)


def test_kernel_is_the_plain_one_and_has_its_derivatives() -> None:
    film = plain_film(24, 4)
    data, (m, k) = volume_films([film]), film.grid.shape
    random = np.random.default_rng(2)
    states, fields = np.zeros((STATES, m, k)), np.zeros((m, k, k + SIDES))
    cavity = film.scales.cavitation
    states[PRESSURE], states[PRESSURE_SLOPE] = cavity + random.normal(size=(m, k)), random.uniform(0.5, 1.5, (m, k))
    fields[:, :, k:] = 0.3 * random.normal(size=(m, k, SIDES))

    def push(own: np.ndarray) -> tuple[float, ...]:
        changed = fields.copy()
        changed[:, :, k] = own
        scratch, loads, slopes = np.empty((4, m, k)), np.empty(2), np.empty((2, 2))
        parts = data.films[0], data.ring[0], data.places[0], data.cells[0]
        film_loads(*parts, states, changed, scratch, loads, slopes)
        return *loads, *slopes.T.ravel()

    f_x, f_y, *by = push(fields[:, :, k])
    pressure = states[PRESSURE] + states[PRESSURE_SLOPE] * fields[:, :, k]
    expected = force(film, cavity + clipped_means(pressure - cavity))
    assert (f_x, f_y) == pytest.approx(expected, rel=1e-12)
    rises = differences(lambda by: push(fields[:, :, k] + fields[:, :, k + 1 : k + 3] @ by)[:2], np.zeros(2), 1e-6)
    assert by == pytest.approx(rises.T.ravel(), rel=1e-6)
