"""Roots and summits of parabolas whose curvature is round-off."""

import math
from fractions import Fraction

import numpy as np
import pytest

from frbcli.film.parabola import parabola_roots, share_within, summit


@pytest.mark.parametrize("curvature", [1e-17, -1e-17, 1e-9, -1e-9, 0.3, -2.0])
@pytest.mark.parametrize("root", [-0.7, 1e-6, 0.9])
def test_the_small_root_is_exact_however_small_the_curvature_is(curvature: float, root: float) -> None:
    """a (x - r) (x - s) with s = 5 / a far away, multiplied out exactly."""
    far = Fraction(5) / Fraction(curvature)
    a, b, c = curvature, -curvature * (Fraction(root) + far), curvature * Fraction(root) * far
    small, large = sorted(parabola_roots(a, float(b), float(c)), key=abs)
    expected = sorted((root, float(far)), key=abs)
    assert small == pytest.approx(expected[0], rel=1e-14)
    assert large == pytest.approx(expected[1], rel=1e-14)


def test_straight_lines_double_roots_and_none() -> None:
    assert parabola_roots(0.0, 2.0, -3.0) == (1.5, -math.inf)
    assert parabola_roots(2.0, 0.0, 0.0) == (0.0, 0.0)
    assert sorted(parabola_roots(1.0, 0.0, -4.0)) == [-2.0, 2.0]
    assert all(map(math.isnan, parabola_roots(1.0, 0.0, 1.0)))
    assert all(map(math.isnan, parabola_roots(0.0, 0.0, 1.0)))


def test_a_short_step_within_a_circle_is_whole_and_a_long_one_ends_on_it() -> None:
    place = np.array([0.3, -0.2])
    assert share_within(place, np.array([1e-170, 0.0]), 0.9) == 1.0
    assert share_within(place, np.zeros(2), 0.9) == 1.0
    for length in (1.0, 1e3, 1e9):
        step = length * np.array([0.6, 0.8])
        assert np.linalg.norm(place + share_within(place, step, 0.9) * step) == pytest.approx(0.9, rel=1e-12)


def test_the_summit_is_that_of_the_parabola_and_never_beyond_its_neighbours() -> None:
    place, value = summit(4.0 - 1.3**2, 4.0 - 0.3**2, 4.0 - 1.7**2, 1.0, 2.0)  # 4 - (x - 0.3)^2
    assert (place, value) == (pytest.approx(0.3), pytest.approx(4.0))
    assert summit(1.0, 1.0, 1.0, 1.0, 1.0) == (0.0, 1.0)
    place, value = summit(1.0 - 2.0**-52, 1.0, 1.0, 1.0, 1.0)
    assert abs(place) <= 0.5
    assert value == pytest.approx(1.0, rel=1e-15)
