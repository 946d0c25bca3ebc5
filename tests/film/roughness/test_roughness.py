"""Rough surfaces: flow and shear of films between them by their published factors, and summits that meet and rub."""

import math
from dataclasses import replace

import numpy as np
import pytest
from differences import differences
from films import plain_pressure, plain_touch, summit_integral
from plain_balances import pressure_flow, shear_flow
from scipy.integrate import quad

from frbcli.film.cavitation.conditions import Elrod, Sommerfeld
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.film import Motion, VolumeFilm, fitted_grid
from frbcli.film.cells.linearised import settled_force
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section
from frbcli.film.roughness.asperities import (
    CUT,
    FLAT,
    LAST,
    LAST_STRESS,
    Asperities,
    elastic_summits,
    rub,
    shear_stress,
    summit_pressure,
    touch,
    touching_summits,
)
from frbcli.film.roughness.contact import (
    Rubbing,
    flowing_cube,
    rough_flow,
    sheared_gap,
    stress_factor,
)

SIGMA = 0.03  # over the clearance
GAPS = (0.5, 0.9, 1.0, 2.0, 2.99, 3.01, 4.9, 5.1, 8.9, 9.1, 30.0)
OMEGA = 200.0
BATH = Section(0.0125, 0.02, 0.02, 35e-6, 0.012, 1e5, 1e5, 1, "oil-bath", "oil-bath")


def film_of(section: Section, law: Law, d: tuple[float, float]) -> VolumeFilm:
    return VolumeFilm(section, fitted_grid(section, d, 64, 8), law, 500.0)


def solved(section: Section, law: Law, motion: Motion) -> FilmLoads:
    film = film_of(section, law, motion.d)
    return loads(film, motion, FilmSolver(film).steady(motion))


def rough(share: float = 0.0, sigma: float = SIGMA) -> Section:
    return replace(BATH, flow_roughness=sigma * BATH.clearance, shear=share)


def test_factors_have_the_published_values() -> None:
    """Patir and Cheng 1978, 1979; isotropic surfaces."""
    np.testing.assert_array_equal(np.round(pressure_flow(np.array([1.0, 3.0])), 3), [0.486, 0.832])
    np.testing.assert_allclose(shear_flow(np.array([6.0, 9.0])), 1.126 * np.exp([-1.5, -2.25]), rtol=3e-4)
    stress = shear_stress(np.array([LAST_STRESS - 1e-9])) - shear_stress(np.array([LAST_STRESS]))
    assert stress == pytest.approx(11.1 * 7.0**2.31 * np.exp(-2.38 * 7.0 + 0.11 * 49.0), rel=1e-6)


def test_factors_tend_to_the_second_order_of_shallow_roughness() -> None:
    """In sigma / h the flow between shallow roughness of no direction falls by 3/2 of its square, the stress rises by
    5/2 of it, half from the flow to and fro, and a rough surface carries 3/2 of it more: means of the exact solutions
    for ridges along and across."""
    x = np.array([5.0])
    assert x**2 * (1.0 - pressure_flow(x)) == pytest.approx(1.5, rel=0.1)
    assert x * shear_flow(x) == pytest.approx(1.5, rel=0.1)
    assert x**2 * (shear_stress(x) - 1.0) == pytest.approx(2.5, rel=0.1)


@pytest.mark.parametrize("x", [0.5, 1.0, 2.5, 3.5, 8.9, 9.1, 40.0])
def test_stress_is_that_of_the_local_gaps_and_of_what_they_press(x: float) -> None:
    z = x / 3.0
    local, _ = quad(lambda s: (1.0 - s**2) ** 3 / (z + s), max(-1.0, CUT - z), 1.0, epsrel=1e-12, limit=200)
    pressed = 11.1 * x**2.31 * np.exp(-2.38 * x + 0.11 * x**2) if x < LAST_STRESS else 0.0
    assert shear_stress(np.array(x)) == pytest.approx(35.0 / 32.0 * z * local + pressed, rel=1e-9)


@pytest.mark.parametrize("x", GAPS)
def test_kernels_are_the_equations_and_their_derivatives(x: float) -> None:
    h = SIGMA * x
    (factor, by_h), (cube, cube_by_h) = rough_flow(h, SIGMA), flowing_cube(h, SIGMA)
    carried, carried_by_h = sheared_gap(h, SIGMA, 3.0)
    assert factor == pytest.approx(pressure_flow(np.array(x)), rel=1e-13)
    assert cube == pytest.approx(factor * h**3, rel=1e-13)
    assert carried == pytest.approx(3.0 * SIGMA * shear_flow(np.array(x)), rel=1e-12)
    assert stress_factor(h, SIGMA) == pytest.approx(shear_stress(np.array(x)), rel=1e-10)
    complex_h = h + 1e-30j
    exact = (complex_h**3 * (1.0 - 0.90 * np.exp(-0.56 * complex_h / SIGMA))).imag / 1e-30
    assert cube_by_h == pytest.approx(exact, rel=1e-12)
    found = differences(lambda y: (rough_flow(y[0], SIGMA)[0], sheared_gap(y[0], SIGMA, 3.0)[0]), [h], 1e-7 * SIGMA)
    assert (by_h, carried_by_h) == pytest.approx(found[:, 0], rel=1e-6, abs=1e-7)
    assert flowing_cube(h, 0.0) == pytest.approx((h**3, 3.0 * h**2), rel=1e-14)
    assert stress_factor(h, 0.0) == 1.0


def test_an_even_gap_has_the_same_factors_everywhere() -> None:
    """The force of a squeezed film rises with 1 / phi_x, and Petroff's torque with phi_f + Phi_fs."""
    x = np.array(1.0 / SIGMA) / 8.0
    section = rough(sigma=8.0 * SIGMA)
    squeeze = Motion((0.0, 0.0), (30.0, -10.0), OMEGA)
    found, smooth = (solved(each, Sommerfeld(), squeeze) for each in (section, BATH))
    np.testing.assert_allclose(found.force, np.array(smooth.force) / pressure_flow(x), rtol=1e-10)
    assert found.torque.couette == pytest.approx(smooth.torque.couette * float(shear_stress(x)), rel=1e-10)


@pytest.mark.parametrize("share", [-1.0, 0.4, 1.0])
def test_a_rough_journal_carries_more_oil_and_a_rough_shell_less(share: float) -> None:
    """Near the centre the film is driven by how much more is carried where the gap is wider."""
    sigma, d = 8.0 * SIGMA, 1e-6
    motion = Motion((0.0, -d), (0.0, 0.0), OMEGA)
    found, smooth = (np.array(solved(each, Sommerfeld(), motion).force) for each in (rough(share, sigma), BATH))
    x = 1.0 / sigma
    by_gap = float(shear_flow(np.array(x))) * (0.98 / x - 0.92 + 0.10 * x)
    np.testing.assert_allclose(
        found, smooth * (1.0 + share * by_gap) / float(pressure_flow(np.array(x))), atol=1e-5 * abs(smooth).max()
    )


def test_forces_have_their_derivatives() -> None:
    section, motion = rough(0.5, 0.1), Motion((0.3, -0.6), (4.0, 2.0), OMEGA)
    film = film_of(section, Sommerfeld(), motion.d)
    solver = FilmSolver(film)
    found = settled_force(solver, motion, solver.steady(motion))

    def force(d: np.ndarray) -> tuple[float, float]:
        moved = replace(motion, d=tuple(d))
        return loads(film, moved, FilmSolver(film).steady(moved)).force

    slopes = differences(force, motion.d, 1e-6) / section.clearance
    np.testing.assert_allclose(found.by_displacement, slopes, atol=1e-7 * abs(found.by_displacement).max())


def test_oil_is_conserved() -> None:
    found = solved(rough(0.5, 0.1), Elrod(2e4), Motion((0.3, -0.6), (0.0, 0.0), OMEGA))
    assert abs(found.oil.defect_relative) < 1e-11


# Greenwood, Tripp 1970: F_5/2 to the digits in print
PRINTED = {0.0: 0.6166, 1.0: 0.0806, 2.0: 0.0054}
C = 35e-6
SHELL_SPEED = 40.0


def surfaces(roughness: float = 0.4e-6, plastic: float = math.inf, friction: float = 0.12) -> Asperities:
    return Asperities(roughness, 2.4e8, plastic, friction, np.array([12.5e-3]), np.array([20e-3]))


def test_summits_carry_a_load_or_stand_nowhere() -> None:
    own = surfaces()
    stands, weak = Rubbing(own, 0, C), Rubbing(own._replace(elastic=1e-30), 0, C)
    assert touch(own, 0, C, stands.standing(30.0)).radial == pytest.approx(30.0, rel=1e-9)
    assert weak.standing(30.0) == stands.standing(0.0) == 0.0


@pytest.mark.parametrize("height", [0.3e-6, 2e-6])
def test_high_summits_meet_as_in_a_smaller_clearance(height: float) -> None:
    """Of the same displacement: the gap less the mean height, all around."""
    own, high = surfaces(), surfaces()._replace(mean_height=height)
    for e in (0.9 * C, 0.97 * C, C):
        assert touch(high, 0, C, e) == pytest.approx(touch(own, 0, C - height, e), rel=1e-12)
        assert touch(high, 0, C, e)[:2] == pytest.approx(plain_touch(high, 0, C, e), rel=1e-6)
    stands = Rubbing(high, 0, C).standing(30.0)
    assert stands == pytest.approx(Rubbing(own, 0, C - height).standing(30.0), rel=1e-12)
    assert C - stands > height


def test_integral_gives_the_printed_table() -> None:
    assert {x: round(summit_integral(2.5, x), 4) for x in PRINTED} == PRINTED


@pytest.mark.parametrize("x", [-30.0, -6.0, FLAT - 1e-9, FLAT, -1.3, 0.0, 0.4, 1.0, 2.0, 3.3, 5.0, 7.9])
def test_kernels_are_the_integrals(x: float) -> None:
    value, slope = elastic_summits(x)
    area, area_slope = touching_summits(x)
    assert value == pytest.approx(summit_integral(2.5, x), rel=1e-6)
    assert slope == pytest.approx(-2.5 * summit_integral(1.5, x), rel=2e-5)
    assert area == pytest.approx(summit_integral(2.0, x), rel=1e-9)
    assert area_slope == pytest.approx(-2.0 * summit_integral(1.0, x), rel=1e-9)


def test_no_summits_meet_from_the_last_distance_on() -> None:
    assert elastic_summits(LAST) == touching_summits(LAST) == (0.0, 0.0)
    assert 0.0 < elastic_summits(LAST - 1e-9)[0] < 1e-15 * elastic_summits(0.0)[0]


def test_summits_carry_no_more_than_their_area_at_the_hardness() -> None:
    soft, hard = surfaces(plastic=1e8), surfaces(plastic=1e12)
    for gap in (0.0, 0.4e-6, 1.2e-6):
        for each in (soft, hard):
            found = summit_pressure(gap / each.roughness, each.elastic, each.plastic)[0]
            assert found == pytest.approx(plain_pressure(each, gap), rel=1e-6)
        x = gap / soft.roughness
        assert plain_pressure(soft, gap) == pytest.approx(soft.plastic * summit_integral(2.0, x))
        assert plain_pressure(hard, gap) == pytest.approx(hard.elastic * summit_integral(2.5, x))


@pytest.mark.parametrize(
    ("roughness", "eccentricity"),
    [(0.05e-6, 0.995), (0.05e-6, 1.001), (0.4e-6, 0.95), (0.4e-6, 0.97), (0.4e-6, 0.99), (6e-6, 0.3), (6e-6, 0.97)],
)
def test_integrals_over_a_bearing(roughness: float, eccentricity: float) -> None:
    rough = surfaces(roughness)
    found = touch(rough, 0, C, eccentricity * C)
    normal, radial = plain_touch(rough, 0, C, eccentricity * C)
    assert (found.normal, found.radial) == pytest.approx((normal, radial), rel=2e-7)


@pytest.mark.parametrize("slip", [0.02, 600.0])
@pytest.mark.parametrize("angle", [-1.5, 0.4])
def test_derivatives_are_those_of_the_force(angle: float, slip: float) -> None:
    rough = surfaces()
    e, v = 0.975 * C * np.array([math.cos(angle), math.sin(angle)]), np.array([1e-4, -3e-4])
    found = rub(rough, 0, C, *e, *v, slip, SHELL_SPEED)
    by_place, by_rate = np.array(found[2:6]).reshape(2, 2), np.array(found[6:10]).reshape(2, 2)
    place = differences(lambda e: rub(rough, 0, C, *e, *v, slip, SHELL_SPEED)[:2], e, 1e-5 * C)
    rate = differences(lambda v: rub(rough, 0, C, *e, *v, slip, SHELL_SPEED)[:2], v, 1e-7)
    np.testing.assert_allclose(by_place, place, rtol=1e-5, atol=1e-6 * abs(by_place).max())
    np.testing.assert_allclose(by_rate, rate, rtol=1e-6, atol=1e-6 * abs(by_rate).max() + 1e-12)


@pytest.mark.parametrize("slip", [-500.0, 0.01, 500.0])
def test_friction_takes_what_the_motions_lose(slip: float) -> None:
    """Power of forces and torques on both bodies, less what the summits store as springs, is the heat of friction."""
    rough, e, v = surfaces(), 0.974 * C * np.array([0.6, -0.8]), np.array([2e-3, 1e-3])
    found = rub(rough, 0, C, *e, *v, slip, SHELL_SPEED)
    work = found.f_x * v[0] + found.f_y * v[1] + found.torque * (slip + SHELL_SPEED) + found.shell_torque * SHELL_SPEED
    stored = -found.radial * float(e @ v) / float(np.hypot(*e))
    assert stored - work == pytest.approx(found.power, rel=1e-10)
    assert found.power > 0.0


def test_torques_and_force_are_in_balance() -> None:
    e = 0.974 * C * np.array([0.6, -0.8])
    found = rub(surfaces(), 0, C, *e, 0.0, 0.0, 500.0, SHELL_SPEED)
    moment = e[0] * found.f_y - e[1] * found.f_x
    assert found.torque + found.shell_torque + moment == pytest.approx(0.0, abs=1e-12 * abs(found.torque))
    assert found.torque < 0.0  # against a rotor that turns forwards


def test_force_turns_with_the_line_of_centres_and_with_the_sense_of_sliding() -> None:
    at = rub(surfaces(), 0, C, 0.0, -0.975 * C, 0.0, 0.0, 400.0, 0.0)
    turned = rub(surfaces(), 0, C, 0.975 * C, 0.0, 0.0, 0.0, 400.0, 0.0)
    backwards = rub(surfaces(), 0, C, 0.0, -0.975 * C, 0.0, 0.0, -400.0, 0.0)
    assert (turned.f_x, turned.f_y) == pytest.approx((-at.f_y, at.f_x))
    assert (backwards.f_x, backwards.f_y) == pytest.approx((-at.f_x, at.f_y))
    assert at.f_y > 0.0
    assert at.f_x == pytest.approx(-0.12 * at.f_y)  # the lowest point slides along +x
