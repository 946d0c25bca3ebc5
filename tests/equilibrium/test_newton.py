"""The search for rest: within the gap, to the force that is asked for, and past jumps of the force."""

from __future__ import annotations

import numpy as np
import pytest

from frbcli.equilibrium.resting import ForceBalance, Search, search_rest

CLEARANCES = np.array([[3e-5]])
STIFFNESS = 2e6  # N/m


def over_clearance(position: np.ndarray) -> np.ndarray:
    return position / CLEARANCES


def spring(position: np.ndarray, _: object) -> ForceBalance[None]:
    """A film whose force grows without bounds towards contact: k x / (1 - eps^2), under 50 N along x."""
    x, gap = position[0], 1.0 - float(np.sum((position[0] / CLEARANCES[0]) ** 2))
    slope = STIFFNESS * (np.eye(2) / gap + 2.0 * np.outer(x, x) / (CLEARANCES[0, 0] * gap) ** 2)
    return ForceBalance(STIFFNESS * x / gap - [50.0, 0.0], slope, None)


@pytest.mark.parametrize("search", [Search(1e-10, 0.0, 1e-8), Search(0.0, 1e-6, 0.05)], ids=["step", "force"])
def test_a_journal_rests_where_the_quadratic_equation_says(search: Search) -> None:
    """k c e / (1 - e^2) = 50 N: e = (-1 + sqrt(1 + 4 q^2)) / (2 q) with q = 50 N / (k c)."""
    q = 50.0 / (STIFFNESS * CLEARANCES[0, 0])
    found = search_rest(spring, np.zeros((1, 2)), over_clearance, search)
    assert found.settled
    assert found.position[0] / CLEARANCES[0] == pytest.approx([(np.sqrt(1.0 + 4.0 * q * q) - 1.0) / (2.0 * q), 0.0])


def test_only_patience_gets_past_a_jump_of_the_force() -> None:
    """Half way the force falls by 45 N, and a step across leaves more of it over than there was before."""

    def jump(position: np.ndarray, before: ForceBalance[None] | None) -> ForceBalance[None]:
        found = spring(position, before)
        fallen = 45.0 if position[0, 0] > 0.45 * CLEARANCES[0, 0] else 0.0
        return ForceBalance(found.residual - [fallen, 0.0], found.slope, None)

    start = np.array([[0.4 * CLEARANCES[0, 0], 0.0]])
    assert not search_rest(jump, start, over_clearance, Search(0.0, 1e-3, 0.05)).settled
    assert search_rest(jump, start, over_clearance, Search(0.0, 1e-3, 1.0, 5)).settled
