"""Hertz's contact: the limit of spheres, the integral of the pressure, and an independent program."""

from math import pi, sqrt

import pytest
from ball_bearings import STEEL, A, B

from frbcli.elements.ball_force import contact
from frbcli.materials import Elastic

RADIUS = 5e-3


def test_spheres_are_in_closed_form() -> None:
    # Hertz: Q = 4/3 E* sqrt(R) delta^1.5, p_0^3 = 6 Q E*^2 / (pi^3 R^2); a sphere on a plane
    sphere = contact(STEEL, STEEL, 1.0 / RADIUS, 1.0 / RADIUS)
    modulus = 0.5 * 207e9 / (1.0 - 0.3**2)
    assert sphere.stiffness == pytest.approx(4.0 / 3.0 * modulus * sqrt(RADIUS), rel=1e-12)
    assert sphere.pressure(10.0) == pytest.approx((60.0 * modulus**2 / (pi**3 * RADIUS**2)) ** (1.0 / 3.0), rel=1e-12)
    assert sphere.axes(10.0)[0] == pytest.approx((0.75 * 10.0 * RADIUS / modulus) ** (1.0 / 3.0), rel=1e-12)


def test_nearly_round_contacts_join_spheres() -> None:
    values = [contact(STEEL, STEEL, 200.0, 200.0 * (1.0 + off)).stiffness for off in (0.0, 1e-8, 1e-6)]
    assert values == pytest.approx([values[0]] * 3, rel=1e-6)


@pytest.mark.parametrize("curvatures", [(600.0, 40.0), (40.0, 600.0), (500.0, 400.0)])
def test_pressure_carries_the_load(curvatures: tuple[float, float]) -> None:
    """p_0 sqrt(1 - (x/a)^2 - (y/b)^2) has the integral 2/3 pi a b p_0; the order of the curvatures is any."""
    found = contact(STEEL, Elastic(310e9, 0.27, 3200.0), *curvatures)
    long, short = found.axes(50.0)
    assert 2.0 / 3.0 * pi * long * short * found.pressure(50.0) == pytest.approx(50.0, rel=1e-12)
    assert long > short
    assert found.stiffness == pytest.approx(contact(Elastic(310e9, 0.27, 3200.0), STEEL, *curvatures[::-1]).stiffness)


def test_stiffness_is_that_of_an_independent_program() -> None:
    # independent program: Hertz contacts by elliptic integrals; printed with five digits
    assert [each.stiffness for each in A.contacts] == pytest.approx([1.3964e10, 1.4925e10], rel=4e-5)
    assert [each.stiffness for each in B.contacts] == pytest.approx([2.1506e10, 1.9895e10], rel=4e-5)


def test_bodies_that_do_not_part_beside_the_contact_are_refused() -> None:
    with pytest.raises(ValueError, match="not apart"):
        contact(STEEL, STEEL, 400.0, -1.0)
