"""The functions of summits, the pressure that they carry and their integrals over a bearing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from differences import differences

from frbcli.film.roughness.asperities import (
    FLAT,
    LAST,
    Asperities,
    elastic_summits,
    rub,
    summit_integral,
    summit_pressure,
    touch,
    touching_summits,
)
from frbcli.film.roughness.contact import Rubbing
from frbcli.film.roughness.plain import plain_pressure, plain_touch

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
