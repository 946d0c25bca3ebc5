"""The edge of the cavity within cells of a film at rest: derivatives, places of the cells, and Reynolds' own edge."""

from __future__ import annotations

import math

import numpy as np
import pytest
from differences import differences

from frbcli.case.reading.load import load_case
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.linearised import film_at, lying, settled_force
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.rectangles.film import FilmForce
from frbcli.scene.films import film_places, volume_film

OMEGA = 2.0 * math.pi * 100.0
PLACE = (0.66 * math.sin(0.8), -0.66 * math.cos(0.8))


def film(law: str, cells: tuple[int, int], edged: bool = True, pressure: str = "2 bar") -> VolumeFilm:
    case = load_case("jeffcott", [f"film.cavitation={law}", f"bearing.supply.pressure={pressure}"])
    (place,) = film_places(case)
    return film_at(volume_film(case, place, cells, edged=edged), 0.66, OMEGA)


def force(of: VolumeFilm, d: tuple[float, float] = PLACE, v: tuple[float, float] = (0.0, 0.0)) -> FilmForce:
    """The film with its law as it is in PLACE."""
    solver, motion = FilmSolver(of), Motion(d, v, OMEGA)
    return settled_force(solver, motion, solver.steady(motion))


@pytest.mark.parametrize("law", ["reynolds", "penalty"])
def test_derivatives_are_those_of_the_force(law: str) -> None:
    of, nudge = film(law, (48, 6)), 1e-5
    found, clearance = force(of), film(law, (48, 6)).section.clearance
    by_d = differences(lambda d: force(of, d=tuple(d)).force, PLACE, nudge)
    by_v = differences(lambda v: force(of, v=tuple(v)).force, (0.0, 0.0), 300.0 * nudge)
    for derivative, slope in ((found.by_displacement, by_d), (found.by_velocity, by_v)):
        assert np.abs(derivative - slope / clearance).max() < 1e-5 * np.abs(derivative).max()


@pytest.mark.parametrize("law", ["reynolds", "penalty"])
def test_stiffness_and_damping_hardly_depend_on_where_the_cells_lie(law: str) -> None:
    """With the edge between cells they differ by 1 to 2 %, an error of first order; it is of second order within."""

    def scatter(edged: bool) -> float:
        found = [force(lying(film(law, (72, 10), edged), share)) for share in (0.0, 0.25, 0.5, 0.75)]
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
