"""Hopf points among eigenvalues that are given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from frbcli.equilibrium.hopf import growth_of, hopf_points


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


def test_a_whirl_that_begins_to_grow_where_another_one_becomes_a_drift() -> None:
    """As many whirls grow at 0 as at 1."""
    (found,) = hopf_points(lambda _low, _high, value: Given(value), [Given(0.0), Given(1.0)], 1e-12)
    assert found.rising
    assert found.here.value == pytest.approx(0.7, rel=1e-9)
