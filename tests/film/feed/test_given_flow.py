"""Films whose supply gives a flow at most: steady, linearised with the filling of the line, and along a motion."""

import math

import fed_films
import numpy as np
import pytest
from differences import differences
from fed_films import AT_REST, AXIAL, BORES, GROOVE, OMEGA, PLACE, by_grooves, fed_case, fed_film

from frbcli import bearing_sheet
from frbcli.bearing_tests.history import march, whirl_path
from frbcli.errors import FilmUnsolved
from frbcli.film.cells.balance.boundaries import ALL, RESPONSE, feed_at, limited, supply_line, supply_pressure
from frbcli.film.cells.balance.ends import outflow
from frbcli.film.cells.balance.states import UPWIND
from frbcli.film.cells.film import Motion, Storage, VolumeFilm, VolumeSolution
from frbcli.film.cells.linearised import linear_film, steady_force, stiffness_at
from frbcli.film.cells.loads import FilmLoads, force, loads
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


AT = np.array(fed_films.PLACE)
STARVED = [(GROOVE, 4e-7), (AXIAL, 2e-6), (AXIAL, 2e-7), (BORES, 2e-7)]  # the second axial groove is filled in part
each_starved = pytest.mark.parametrize(("supply", "flow"), STARVED, ids=["groove", "axial", "emptied", "bores"])


def starved_film(supply: str, flow: float | None, law: str) -> VolumeFilm:
    return fed_film(fed_case(supply, flow, law), (48, 6))


def settled(film: VolumeFilm) -> float:
    """The filling of the openings at rest."""
    return FilmSolver(film).steady(AT_REST, upwind=True).filling


@each_starved
@pytest.mark.parametrize("law", LAWS)
def test_it_is_what_a_small_step_in_time_does(supply: str, flow: float, law: str) -> None:
    """An implicit Euler step of 1 / s of film and line from rest, to a place beside it, see test_dynamic_stiffness.py:
    line s (filling - settled) = given - taken, whose root is found by a secant."""
    film, s, step = starved_film(supply, flow, law), 0.5 * OMEGA, 1e-5
    clearance, line, rest = film.section.clearance, supply_line(film), settled(film)
    linear = linear_film(film, AT * clearance, OMEGA)
    solver, content = FilmSolver(film), film.content(AT_REST, linear.field)

    def moved(d: np.ndarray, filling: float) -> tuple[np.ndarray, float]:
        """Force after the step with a filling, and what the line does not balance."""
        motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), OMEGA)
        solver.fill(filling)
        solver._before = np.full(film.grid.shape, UPWIND)
        gap = film.gap(motion.d, film.grid.centre)[:, None]
        solution = solver._solve(motion, linear.field, Storage(s * gap, s * content))
        off = line.line * s * (filling - rest) - line.given + solution.flows.supply
        return np.array(force(film, film.mean_pressure(solution.state))), off

    def after(d: np.ndarray) -> np.ndarray:
        low, high = rest - step, rest + step
        for _ in range(4):
            (_, at_low), (_, at_high) = moved(d, low), moved(d, high)
            if abs(at_high - at_low) < 1e-12 * line.given:
                break
            low, high = high, high - at_high * (high - low) / (at_high - at_low)
        return moved(d, high)[0]

    found = -differences(after, AT, step) / clearance
    expected = stiffness_at(linear, s).real
    np.testing.assert_allclose(expected, found, atol=3e-4 * np.abs(found).max())


@pytest.mark.parametrize(("supply", "flow"), STARVED[:2], ids=["groove", "axial"])
def test_so_fast_that_the_line_stays_it_is_the_film_at_the_pressure_in_its_openings(supply: str, flow: float) -> None:
    """And not so at rest, where the pressure follows."""
    film = starved_film(supply, flow, "elrod")
    place, section = AT * film.section.clearance, film.section
    gauge = 2e5 * feed_at(film, settled(film)).share
    lower = starved_film(supply.replace("3 bar", f"{1.0 + 1e-5 * gauge!r} bar"), None, "elrod")
    linear, plain = (linear_film(each, place, OMEGA) for each in (film, lower))
    assert section.ambient_pressure == 1e5
    for s, close in ((1e7j, 1e-4), (0.0, None)):
        own, other = stiffness_at(linear, s), stiffness_at(plain, s)
        off = np.abs(own - other).max() / np.abs(other).max()
        assert off < close if close is not None else off > 0.02


def moved_film(supply: str, flow: float | None) -> VolumeFilm:
    return fed_film(fed_case(supply, flow), (32, 6))


@by_grooves
@pytest.mark.parametrize("longest", [1e-3, 4.0 * RESPONSE])
def test_a_journal_that_stands_still_has_the_film_that_takes_what_is_given(supply: str, longest: float) -> None:
    """Steps longer than the response of a line are stable as well. A moved film carries its oil with second order, a
    steady one of Elrod's upwind, which a groove that is filled in part shows."""
    film = moved_film(supply, 4e-7)
    *_, last = march(film, lambda _: AT_REST, np.arange(0.0, 300.0 * longest, longest))
    steady = FilmSolver(film).steady(AT_REST)
    assert steady.filling < ALL
    assert last.solution.filling == pytest.approx(steady.filling, rel=1e-6 if supply == GROOVE else 0.02)
    assert last.solution.flows.supply == pytest.approx(supply_line(film).given, rel=1e-6)


@by_grooves
def test_what_was_given_has_passed_or_fills_the_line(supply: str) -> None:
    """While the line is not full; else the supply gives less."""
    film, times = moved_film(supply, 1e-7), np.linspace(0.0, 0.05, 101)
    moments = list(march(film, whirl_path(0.6, 50.0, OMEGA), times))
    line, fillings = supply_line(film), np.array([each.solution.filling for each in moments])
    taken = np.array([each.solution.flows.supply for each in moments])
    first = int(np.flatnonzero(fillings == ALL)[-1])
    assert first < 50
    assert fillings.min() > line.lowest
    passed = (times[1] - times[0]) * taken[first:-1].sum()
    emptied = line.line * (ALL - fillings[-1])
    assert emptied > 0.01 * passed
    assert passed == pytest.approx(line.given * (times[-2] - times[first]) + emptied, rel=1e-10)


@by_grooves
def test_an_ample_flow_is_a_supply_at_its_pressure_to_the_bit(supply: str) -> None:
    path, times = whirl_path(0.5, 50.0, OMEGA), np.linspace(0.0, 0.01, 21)
    plain, ample = (list(march(moved_film(supply, flow), path, times)) for flow in (None, 1.0))
    assert all(np.array_equal(a.solution.w, b.solution.w) for a, b in zip(plain, ample, strict=True))
