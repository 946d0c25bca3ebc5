"""Ends that let out a share of the flow of open ends: closed forms, limits, and the flow that defines the share. Ends
that lie in a bath up to a level: between free to air and an oil bath, and mirror images."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.films import AMBIENT, PLAIN, SUPPLIED

from frbcli.bearing_tests.kinematic import rotation
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.film.cavitation.table import law_named
from frbcli.film.cells.balance.ends import outflow
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.mesh.bores import bathed
from frbcli.film.cells.mesh.grid import force_weights, run_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import AxialGroove, Section
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.end_flow import end_flow, make_end_flow
from frbcli.film.rectangles.film import direct_force, evaluate, make_film
from frbcli.scene.films import film_places, make_law, turns_with_oil, volume_film

MESH, FINE = Mesh(6, 96), Mesh(12, 192)
WIDE = replace(PLAIN, width=30e-3, bearing_width=30e-3)
LEVEL = replace(WIDE, cavitation_pressure=0.7 * AMBIENT)
AXIAL = replace(WIDE, grooves=(AxialGroove(0.3, 0.4, 2e5),))
FILMS = {
    "short": (WIDE, "short", "half-sommerfeld"),
    "short with a groove": (replace(SUPPLIED, far_pressure=0.0), "short", "half-sommerfeld"),
    "table": (WIDE, "finite", "half-sommerfeld"),
    "table, Sommerfeld": (WIDE, "finite", "sommerfeld"),
    "table with a groove": (replace(SUPPLIED, far_pressure=0.0), "finite", "half-sommerfeld"),
    "fields": (LEVEL, "finite", "half-sommerfeld"),
    "fields with a groove": (SUPPLIED, "finite", "half-sommerfeld"),
    "axial groove": (AXIAL, "finite", "half-sommerfeld"),
}

CLIPPED = dict.fromkeys(FILMS, 1e-6) | {"table with a groove": 1e-4, "fields with a groove": 1e-2}


def _damping(section: Section, theory: str, cavitation: str, e: float, omega: float = 0.0) -> np.ndarray:
    """(2, 2) along and across the line of centres, which lies along x."""
    film = make_film(section, theory, cavitation, MESH)
    return -evaluate(film, section.clearance, np.array([e * section.clearance, 0.0]), np.zeros(2), omega).by_velocity


def _full(section: Section, e: float) -> np.ndarray:
    """Damping along and across the line of centres of a film that does not cavitate, solved at that place."""
    at = np.array([e * section.clearance, 0.0])
    return np.array([-direct_force(section, "sommerfeld", FINE, at, v, 0.0)[i] for i, v in enumerate(np.eye(2))])


@pytest.mark.parametrize("share", [1.0, 0.3, 0.02, 0.0])
def test_damping_in_the_centre_is_that_of_the_closed_form(share: float) -> None:
    """With P'' - P / R^2 = c, P' = P / l at both ends, beta = L / D:
    C = 12 pi eta L (R / c)^3 (1 - tanh(beta) / (beta (1 + (l / R) tanh(beta))))."""
    section = replace(WIDE, sealed=share)
    beta, resistance = section.width / (2.0 * section.radius), section.seals[0] * section.width / section.radius
    long = 12.0 * math.pi * section.viscosity * section.width * (section.radius / section.clearance) ** 3
    expected = long * (1.0 - math.tanh(beta) / (beta * (1.0 + resistance * math.tanh(beta))))
    np.testing.assert_allclose(_full(section, 0.0), expected, rtol=1e-5)


@pytest.mark.parametrize("e", [0.2, 0.6, 0.9])
def test_closed_ends_are_those_of_the_infinitely_long_film(e: float) -> None:
    """d/dphi (H^3 dP/dphi) = (R^2 / c^2) 12 eta dH/dt with no flow along the axis."""
    section = replace(WIDE, sealed=0.0)
    unit = 12.0 * math.pi * section.viscosity * section.width * (section.radius / section.clearance) ** 3
    root = math.sqrt(1.0 - e * e)
    np.testing.assert_allclose(_full(section, e), [unit / root**3, 2.0 * unit / ((2.0 + e * e) * root)], rtol=2e-6)


def test_closed_ends_with_half_a_cavity_carry_sommerfelds_load() -> None:
    """The journal turns and stays: P(-Theta) = -P(Theta), of which half is left, with Sommerfeld's classical load
    across the line of centres, 6 pi eta omega L R (R / c)^2 e / ((2 + e^2) (1 - e^2)^0.5)."""
    e, omega, section = 0.6, 300.0, replace(WIDE, sealed=0.0)
    film = make_film(section, "finite", "half-sommerfeld", MESH)
    found = evaluate(film, section.clearance, np.array([e * section.clearance, 0.0]), np.zeros(2), omega)
    unit = 6.0 * section.viscosity * omega * section.width * section.radius * (section.radius / section.clearance) ** 2
    assert found.force[1] == pytest.approx(unit * math.pi * e / ((2.0 + e * e) * math.sqrt(1.0 - e * e)), rel=1e-4)
    assert found.force[0] == pytest.approx(-unit * 2.0 * e * e / ((2.0 + e * e) * (1.0 - e * e)), rel=1e-4)


@pytest.mark.parametrize("share", [0.5, 0.05])
@pytest.mark.parametrize("e", [0.3, 0.8])
def test_a_short_film_is_stiffer_by_three_over_its_share(share: float, e: float) -> None:
    """P = A (z (1 - z) + l / B) has 3 / share - 2 times the mean of an open film, of a groove in the middle 4 - 3
    share times."""
    factor = {"short": 3.0 / share - 2.0, "short with a groove": 4.0 - 3.0 * share}
    for name, expected in factor.items():
        section, *rest = FILMS[name]
        sealed = _damping(replace(section, sealed=share), *rest, e)
        np.testing.assert_allclose(sealed, expected * _damping(section, *rest, e), rtol=1e-12, atol=0.0)


@pytest.mark.parametrize("name", [name for name in FILMS if "short" not in name and "axial" not in name])
@pytest.mark.parametrize("share", [0.4, 0.0])
def test_tables_are_the_film_solved_at_one_position(name: str, share: float) -> None:
    section, theory, cavitation = FILMS[name]
    section = replace(section, sealed=share)
    c, film = section.clearance, make_film(section, theory, cavitation, FINE)
    for d, v in (((0.3, 0.2), (20.0, -5.0)), ((-0.1, 0.75), (0.0, 30.0))):
        at, velocity = c * np.array(d), c * np.array(v)
        exact = direct_force(section, cavitation, FINE, at, velocity, 200.0)
        found = evaluate(film, c, at, velocity, 200.0).force
        assert np.linalg.norm(found - exact) < 1e-3 * np.linalg.norm(exact)


@pytest.mark.parametrize("name", FILMS)
def test_a_share_of_one_is_an_open_end(name: str) -> None:
    """As the share tends to 1; beside a groove the edge of the cavity crosses other lines along the width."""
    section, theory, cavitation = FILMS[name]
    at, v = section.clearance * np.array([0.3, 0.4]), section.clearance * np.array([10.0, 5.0])

    def values(share: float) -> np.ndarray:
        sealed = replace(section, sealed=share)
        found = evaluate(make_film(sealed, theory, cavitation, MESH), section.clearance, at, v, 100.0)
        return np.concatenate([found.force, found.by_velocity.ravel(), found.by_displacement.ravel()])

    np.testing.assert_allclose(values(1.0 - 1e-8), values(1.0), rtol=CLIPPED[name])


@pytest.mark.parametrize("share", [1.0, 0.6, 0.1, 0.01])
@pytest.mark.parametrize("copies", [1, 2])
def test_a_concentric_film_lets_out_its_share(share: float, copies: int) -> None:
    """The definition: pi D c^3 p / (12 eta L) at each end, times the share, by tables and by cells."""
    section = replace(SUPPLIED, sealed=share, copies=copies, near="free-to-air")
    section = replace(section, bearing_width=copies * section.width)
    land = 2.0 * math.pi * section.radius * section.clearance**3 / (12.0 * section.viscosity * section.width)
    expected = copies * share * land * section.far_pressure
    film = make_film(section, "finite", "sommerfeld", MESH)
    flow = make_end_flow(section, film)
    assert section.clearance * end_flow(flow, 0.0, 0.0, 0.0, 0.0, 1.0) == pytest.approx(expected, rel=1e-9)
    cells = VolumeFilm(
        replace(section, near="oil-bath"), run_grid(section, (24, 5)), make_law(CASE, "sommerfeld", section), 1.0
    )
    motion = Motion((0.0, 0.0), (0.0, 0.0), 0.0)
    solved = FilmSolver(cells).steady(motion)
    assert outflow(cells, motion, solved.state.pressure) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", ["table, Sommerfeld", "fields with a groove", "axial groove"])
@pytest.mark.parametrize("share", [0.5, 0.05])
def test_cells_and_modes_have_one_force_and_one_flow(name: str, share: float) -> None:
    section, theory, cavitation = FILMS[name]
    cavitation, section = "sommerfeld", replace(section, sealed=share, cavitation_pressure=0.0)
    motion = Motion((0.5, 0.1), (8.0, -3.0), 60.0)
    film = VolumeFilm(section, run_grid(section, (96, 16)), make_law(CASE, cavitation, section), 10.0)
    pressure = FilmSolver(film).steady(motion).state.pressure
    push = np.stack([-np.diff(np.cos(film.grid.phi)), -np.diff(np.sin(film.grid.phi))])
    found = section.force_scale * np.einsum("am,mk,mk->a", push, pressure, force_weights(section, film.grid))
    data, c = make_film(section, theory, cavitation, FINE), section.clearance
    exact = evaluate(data, c, c * np.array(motion.d), c * np.array(motion.v), motion.omega).force
    assert np.linalg.norm(found - exact) < 4e-3 * np.linalg.norm(exact)
    w = motion.v[0] + 0.5 * motion.omega * motion.d[1], motion.v[1] - 0.5 * motion.omega * motion.d[0]
    leaves = c * end_flow(make_end_flow(section, data), *motion.d, *w, 1.0)
    assert outflow(film, motion, pressure) == pytest.approx(leaves, rel=6e-3)


CASE = load_case("rigid", ["bearing.ends={sealed=0.4}"])


LAWS = ("sommerfeld", "half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase", "barotropic")

FED = 'bearing.supply={kind="bores", count=4, diameter="3 mm", pressure="2 bar"}'


def _rotation(law: str, ends: str) -> FilmLoads:
    settings = [
        f"bearing.ends={ends}", FED, f"film.cavitation={law}", "accuracy.mesh=[8, 48]",
        'motion={eccentricity=0.5, angle="-60 deg", speed="40 Hz"}',
    ]  # fmt: skip
    found = rotation(load_case("bearing", settings)).results[0].loads
    assert found is not None
    return found


@pytest.mark.parametrize("law", LAWS)
def test_every_law_on_cells_takes_sealed_ends(law: str) -> None:
    """1 is open; a tenth keeps the balance of the oil of laws that do, carries more and lets out less; 0 nothing."""
    opened, one, tenth, none = (
        _rotation(law, ends) for ends in ('"free-to-air"', "{sealed=1}", "{sealed=0.1}", "{sealed=0}")
    )
    np.testing.assert_allclose(one.force, opened.force, rtol=1e-12)
    assert one.oil.ends_m3_s == pytest.approx(opened.oil.ends_m3_s, rel=1e-12)
    assert math.hypot(*tenth.force) > 1.1 * math.hypot(*opened.force)
    assert 0.0 < tenth.oil.ends_m3_s < 0.5 * opened.oil.ends_m3_s
    assert abs(none.oil.ends_m3_s) < 1e-5 * opened.oil.ends_m3_s
    if law_named(law).keeps_oil:
        assert tenth.oil.defect_relative < 1e-8


MOTION = Motion((0.3, -0.5), (0.0, 0.0), 300.0)
SUPPLY = 'bearing.supply={ kind = "axial-grooves", opening_angle = "20 deg", pressure = "1.5 bar" }'
RADIUS = 12.5e-3  # m


def case_of(ends: str, law: str = "peeken", *settings: str) -> Case:
    return load_case("rigid", [f"film.cavitation={law}", SUPPLY, f"bearing.ends={ends}", *settings])


def film_of(case: Case) -> VolumeFilm:
    return volume_film(case, film_places(case)[0], (48, 8))


def found(ends: str, law: str = "peeken", motion: Motion = MOTION) -> FilmLoads:
    film = film_of(case_of(ends, law))
    return loads(film, motion, FilmSolver(film).steady(motion))


def at_level(share: float) -> str:
    return f'{{ bath_level = "{1e3 * share * RADIUS!r} mm" }}'


@pytest.mark.parametrize("law", ["peeken", "two-phase"])
def test_a_full_bath_is_an_oil_bath_and_an_empty_one_is_air(law: str) -> None:
    """Bit for bit."""
    assert found(at_level(1.0), law) == found('"oil-bath"', law)
    assert found(at_level(-1.0), law) == found('"free-to-air"', law)
    assert found('"oil-bath"', law).force != found('"free-to-air"', law).force


def test_the_ends_of_cells_lie_in_the_bath_below_its_level() -> None:
    """On its chord the angle to the bottom is acos(-level); a cell on the level lies in it in part."""
    film = film_of(case_of(at_level(0.3)))
    share, size = bathed(film.section, film.grid.phi), np.diff(film.grid.phi)
    assert share @ size == pytest.approx(2.0 * math.acos(-0.3), rel=1e-12)
    below = np.cos(film.grid.centre) < 0.3
    assert np.all(np.abs(share - below) <= 0.5 + 1e-12)
    assert np.count_nonzero((share > 0.0) & (share < 1.0)) == 2


def test_more_of_the_film_fills_from_a_higher_bath() -> None:
    """Oil that is drawn in grows with the level, between no bath and a whole one."""
    levels = ['"free-to-air"', *(at_level(share) for share in (-0.9, -0.5, 0.0, 0.5, 0.9)), '"oil-bath"']
    came = [each.oil.in_m3_s for each in map(found, levels)]
    assert came == sorted(came)
    assert came[0] < came[3] < came[-1]
    assert all(abs(found(level).oil.defect_relative) < 1e-12 for level in levels[:3])


def test_a_mirrored_motion_has_the_mirrored_force() -> None:
    """About the vertical through the middle: the level is even, the groove lies at the top."""
    mirrored = Motion((-MOTION.d[0], MOTION.d[1]), (0.0, 0.0), -MOTION.omega)
    (x, y), (x_m, y_m) = (found(at_level(-0.4), "peeken", motion).force for motion in (MOTION, mirrored))
    assert (x_m, y_m) == pytest.approx((-x, y), rel=1e-9)


def test_cells_of_a_plain_gap_stay_where_the_bath_is() -> None:
    plain = 'bearing.supply={kind="circumferential-groove", pressure="2 bar"}'
    for ends, turns in ((at_level(0.0), False), ('"oil-bath"', True)):
        case = case_of(ends, "peeken", plain)
        assert turns_with_oil(case, film_places(case)[0]) is turns
