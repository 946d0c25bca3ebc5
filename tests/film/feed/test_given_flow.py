"""Films whose supply gives a flow at the most: its balance, Poiseuille's flow, and films at a pressure."""

from __future__ import annotations

import math

import numpy as np
import pytest
from differences import differences
from fed_films import AT_REST, AXIAL, BORES, GROOVE, PLACE, fed_case, fed_film

from frbcli import bearing_sheet
from frbcli.errors import FilmUnsolved
from frbcli.film.cells.balance.boundaries import ALL, feed_at, limited, supply_pressure
from frbcli.film.cells.balance.side_flow import outflow
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution
from frbcli.film.cells.linearised import steady_force
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.scene.gate.rule import STILL
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

each_supply = pytest.mark.parametrize("supply", [GROOVE, AXIAL, BORES], ids=["groove", "axial", "bores"])
LAWS = ("elrod", "peeken", "two-phase")


def film_of(supply: str, flow: float | None, law: str = "elrod") -> VolumeFilm:
    return fed_film(fed_case(supply, flow, law), (48, 8))


def steady(film: VolumeFilm, motion: Motion = AT_REST) -> tuple[VolumeSolution, FilmLoads]:
    solution = FilmSolver(film).steady(motion)
    return solution, loads(film, motion, solution)


def supplied(film: VolumeFilm, solution: VolumeSolution) -> float:
    """What the openings of the whole bearing give, m^3/s."""
    section = film.section
    return section.copies * section.radius * section.width * section.clearance * solution.flows.supply


def at_pressure(supply: str, law: str = "elrod") -> float:
    """The flow that a film takes at the pressure of its supply."""
    film = film_of(supply, None, law)
    return supplied(film, steady(film)[0])


def test_a_concentric_film_has_the_pressure_of_poiseuilles_flow_in_its_groove() -> None:
    """Two lands of the length b let out Q = 2 (2 pi R) C^3 p / (12 eta b)."""
    flow, still = 5e-7, Motion((0.0, 0.0), (0.0, 0.0), 300.0)
    film = film_of(GROOVE, flow)
    solution, _ = steady(film, still)
    section = film.section
    gauge = feed_at(film, solution.filling).share * supply_pressure(section)
    expected = 3.0 * section.viscosity * section.width * flow / (math.pi * section.radius * section.clearance**3)
    assert 0.0 < expected < 2e5
    assert gauge == pytest.approx(expected, rel=1e-9)


@each_supply
@pytest.mark.parametrize("law", LAWS)
def test_what_is_given_comes_in_and_leaves(supply: str, law: str) -> None:
    """Half of what the film takes at the pressure of the supply, and a hundredth."""
    whole = at_pressure(supply, law)
    for share in (0.5, 0.01):
        film = film_of(supply, share * whole, law)
        solution, found = steady(film)
        assert supplied(film, solution) == pytest.approx(share * whole, rel=1e-10)
        assert abs(found.oil.defect_relative) < 1e-12
        assert solution.filling < ALL
        assert feed_at(film, solution.filling).share < 1.0
    if law == "elrod":  # no oil comes in at the ends: all that leaves there was given
        assert outflow(film, AT_REST, film.pressure(solution.state)) == pytest.approx(share * whole, rel=1e-10)


def test_a_film_without_a_solution_at_empty_openings_is_found_between() -> None:
    """As the two-phase film on 128 x 32 cells, of which a comparison then had nothing."""
    film = film_of(GROOVE, 4e-7, "two-phase")
    solver = FilmSolver(film)

    def solve(filling: float, near: VolumeSolution | None) -> VolumeSolution:
        if filling == 0.0:
            raise FilmUnsolved("it runs dry")
        return solver.filled(filling, AT_REST, None if near is None else near.w)

    assert supplied(film, limited(film, solve)) == pytest.approx(4e-7, rel=1e-10)


@each_supply
def test_a_film_that_is_given_less_and_less_oil_empties_and_carries_nothing(supply: str) -> None:
    whole = at_pressure(supply)
    found = [steady(film_of(supply, share * whole))[1] for share in (0.1, 1e-2, 1e-3)]
    forces, fractions = [math.hypot(*each.force) for each in found], [each.oil_fraction for each in found]
    assert forces == sorted(forces, reverse=True)
    assert fractions == sorted(fractions, reverse=True)
    assert forces[-1] < 0.05 * forces[0]


def test_a_groove_along_the_axis_is_filled_in_part_where_the_surfaces_carry_away_more() -> None:
    """Behind it the film holds the oil fraction of the groove: the upwind oil of Couette's flow."""
    film = film_of(AXIAL, 0.1 * at_pressure(AXIAL))
    solution, _ = steady(film)
    feed = feed_at(film, solution.filling)
    assert feed.share == 0.0  # at the pressure of the cavities, which is that of the air
    assert 0.0 < feed.fraction < 1.0
    assert set(np.round(solution.state.fraction[film.grid.fixed], 12)) == {round(feed.fraction, 12)}


@pytest.mark.parametrize("law", ["elrod", "peeken"])
def test_stiffness_and_damping_are_of_films_at_the_same_flow(law: str) -> None:
    """Against differences of forces of films that were each solved at the flow."""
    film = film_of(AXIAL, 0.3 * at_pressure(AXIAL, law), law)
    c, size, at = film.section.clearance, 3e-5, np.array(PLACE)
    found = steady_force(film, c * at, np.zeros(2), 300.0)
    by_d = differences(lambda d: steady_force(film, d, np.zeros(2), 300.0).force, c * at, c * size)
    by_v = differences(lambda v: steady_force(film, c * at, v, 300.0).force, np.zeros(2), 1e3 * c * size)
    assert found.by_displacement == pytest.approx(by_d, rel=1e-5)
    assert found.by_velocity == pytest.approx(by_v, rel=1e-5)


def test_the_balance_of_heat_and_the_sheet_have_the_flow_that_is_given() -> None:
    flow = 0.4 * at_pressure(GROOVE)
    case = fed_case(GROOVE, flow, "elrod", "accuracy.mesh=[8, 48]")
    films = make_system(case, make_plan(case, STILL)).films
    place = np.array(PLACE) * films.clearances[0]
    assert films.power_and_flow(0, place, 300.0, 300.0, 1.0)[1] == pytest.approx(flow, rel=1e-9)
    (state,) = bearing_sheet(case, [20.0], 30.0).points
    assert state.side_flow == pytest.approx(flow, rel=1e-9)
