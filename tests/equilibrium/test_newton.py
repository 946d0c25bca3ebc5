"""The search for rest: within the gap, to the force that is asked for, and past jumps of the force."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from frbcli.equilibrium.resting import GAP_KEPT, ForceBalance, Search, search_rest

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


def counted(balance: Callable[..., ForceBalance[None]], start: list[float], search: Search) -> int:
    """Places that a search in vain tries."""
    places = []

    def counting(position: np.ndarray, before: ForceBalance[None] | None) -> ForceBalance[None]:
        places.append(position)
        return balance(position, before)

    found = search_rest(counting, np.array([start]) * CLEARANCES, over_clearance, search)
    assert not found.settled
    return len(places)


def test_a_journal_that_its_film_does_not_hold_is_given_up_at_the_smallest_gap() -> None:
    """A spring of 50 N at the shell under 80 N: seven quarters of the gap reach 1e-4 of it, eighty iterations are
    allowed."""
    stiffness = 50.0 / CLEARANCES[0, 0]

    def weak(position: np.ndarray, _: object) -> ForceBalance[None]:
        return ForceBalance(stiffness * position[0] - [80.0, 0.0], stiffness * np.eye(2), None)

    reached = 1 + math.ceil(math.log(1e-4) / math.log(GAP_KEPT))
    assert counted(weak, [0.0, 0.0], Search(1e-10, 0.0, 1e-8, gap=1e-4)) == reached
    assert counted(weak, [0.0, 0.0], Search(1e-10, 0.0, 1e-8)) > 2 * reached


def test_a_search_that_gains_nothing_by_shortened_steps_ends() -> None:
    """Along a winding valley that hardly falls every step is far too long, and is halved some times: 700 places."""

    def winding(position: np.ndarray, _: object) -> ForceBalance[None]:
        x, y = position[0] / CLEARANCES[0]
        residual = [1.0 - 1e-4 * y, x - 0.3 * math.sin(20.0 * y)]
        slope = np.array([[0.0, -1e-4], [1.0, -6.0 * math.cos(20.0 * y)]])
        return ForceBalance(np.array(residual), slope / CLEARANCES[0, 0], None)

    assert counted(winding, [0.0, 0.0], Search(1e-10, 0.0, 1e-8)) < 250


def test_what_the_slopes_lack_is_told_by_the_steps() -> None:
    """A journal on springs that stiffen, whose slope lacks what a ring's speed adds, 2 % of its size. With the true
    slope the search takes 6 balances; else 8, since it learns on the way what the slope lacks, and 9 if it did not."""
    springs, lacking = np.array([[1.0, 0.6], [-0.6, 1.2]]), np.array([[0.01, -0.02], [0.015, 0.02]])

    def search(share: float) -> int:
        places = []

        def balance(position: np.ndarray, _: object) -> ForceBalance[None]:
            x, whole = over_clearance(position).ravel(), springs + lacking
            places.append(x)
            slope = (1.0 + x @ x) * whole + 2.0 * np.outer(whole @ x, x)
            residual = np.array([0.3, -0.2]) - (1.0 + x @ x) * whole @ x
            return ForceBalance(residual, (share * lacking - slope) / CLEARANCES[0, 0], None)

        found = search_rest(balance, np.zeros((1, 2)), over_clearance, Search(1e-12, 0.0, 1e-8))
        assert found.settled
        assert found.balance.left < 1e-14
        return len(places)

    assert (search(0.0), search(1.0)) == (6, 8)
