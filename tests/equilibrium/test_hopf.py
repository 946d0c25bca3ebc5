"""Hopf points among eigenvalues that are given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from frbcli.equilibrium.hopf import growth_of, hopf_points, located


@dataclass(frozen=True)
class Given:
    """A drift of 1/s that oscillates below 0.3, and a pair of 50 rad/s that grows from 0.7 on."""

    value: float

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        swing = np.sqrt(complex(self.value - 0.3))
        return np.array([1.0 + swing, 1.0 - swing, self.value - 0.7 + 50j, self.value - 0.7 - 50j])

    def growth_of(self, number: int) -> float:
        return growth_of(self.eigenvalues, number)


class Growing(Given):
    """The same with one pair alone, whose growth is curved."""

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        growth = np.expm1(4.0 * (self.value - 0.7))
        return np.array([growth + 50j, growth - 50j])


def test_a_whirl_that_begins_to_grow_where_another_one_becomes_a_drift() -> None:
    """As many whirls grow at 0 as at 1."""
    (found,) = hopf_points(lambda _low, _high, value: Given(value), [Given(0.0), Given(1.0)], 1e-12)
    assert found.rising
    assert found.here.value == pytest.approx(0.7, rel=1e-9)


@pytest.mark.parametrize("guess", [0.7001, 0.6999, 0.3, 0.97, -1.0])
def test_a_guess_changes_no_hopf_point(guess: float) -> None:
    """One that is off, or outside."""
    low, high = Growing(0.5), Growing(1.0)
    for more in ((), (guess,)):
        assert located(Growing, low, high, 0, 1e-4, *more).value == pytest.approx(0.7, abs=1e-4)
