"""Curves followed by their arc length: through folds, and past other parts of the curve."""

from __future__ import annotations

import numpy as np
import pytest

from frbcli.cycles.method.continuation import Place, Strides, corrected, fold_between, follow, step_from


def test_a_curve_is_followed_through_its_fold() -> None:
    """x^2 + p^2 = 1 from (1, 0): p has its largest value 1 at x = 0, and the curve comes back."""

    def circle(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.array([y @ y - 1.0]), 2.0 * y[None]

    start = Place(np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    steps = list(follow(circle, start, Strides(0.05, 1e-6, 0.2, 60)))
    assert max(abs(place.y @ place.y - 1.0) for place, _ in steps) < 1e-12
    assert min(place.y[0] for place, _ in steps) < -0.9
    before = start
    for place, length in steps:
        if before.tangent[-1] * place.tangent[-1] < 0.0:
            fold = fold_between(circle, before, length)
            assert fold is not None
            np.testing.assert_allclose(fold.y, [0.0, 1.0], atol=1e-8)
            break
        before = place
    else:
        pytest.fail("no fold on the way")


def test_a_step_does_not_change_to_a_part_of_the_curve_that_passes_close_by() -> None:
    """Two straight lines p = x and p = x + 0.02: a guess that is nearer to the other one is not taken for it."""

    def lines(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        a = y[1] - y[0]
        return np.array([a * (a - 0.02)]), np.array([[-(2.0 * a - 0.02), 2.0 * a - 0.02]])

    start = corrected(lines, np.array([0.0, 0.0]), np.array([0.6, 0.8]))
    assert start is not None
    astray = Place(start.y, np.array([0.0, 1.0]), side=start.side)
    assert step_from(lines, astray, 0.03) is None
    assert step_from(lines, start, 0.03) is not None
