"""What is sought at rest: places of journals by Newton's method, Hopf points, and errors by where cells lie."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from frbcli.equilibrium.dynamic_films import SPREAD, DynamicFilm, Oscillator, modes, place_errors
from frbcli.equilibrium.hopf import growth_of, hopf_points, located
from frbcli.equilibrium.resting import ForceBalance, Search, search_rest
from frbcli.film.cells.linearised import weighted, without_memory

CLEARANCES = np.array([[3e-5]])
SPRING = 2e6  # N/m


def over_clearance(position: np.ndarray) -> np.ndarray:
    return position / CLEARANCES


def spring(position: np.ndarray, _: object) -> ForceBalance[None]:
    """A film whose force grows without bounds towards contact: k x / (1 - eps^2), under 50 N along x."""
    x, gap = position[0], 1.0 - float(np.sum((position[0] / CLEARANCES[0]) ** 2))
    slope = SPRING * (np.eye(2) / gap + 2.0 * np.outer(x, x) / (CLEARANCES[0, 0] * gap) ** 2)
    return ForceBalance(SPRING * x / gap - [50.0, 0.0], slope, None)


@pytest.mark.parametrize("search", [Search(1e-10, 0.0, 1e-8), Search(0.0, 1e-6, 0.05)], ids=["step", "force"])
def test_a_journal_rests_where_the_quadratic_equation_says(search: Search) -> None:
    """k c e / (1 - e^2) = 50 N: e = (-1 + sqrt(1 + 4 q^2)) / (2 q) with q = 50 N / (k c)."""
    q = 50.0 / (SPRING * CLEARANCES[0, 0])
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


MASS, STIFFNESS, JUMP, OMEGA = 2.0, 2e6, 2e3, 1000.0
PLACES, OFFSETS = 8, 50


def oscillator() -> Oscillator:
    """A mass on one film that pushes it as its journal moves, along one line."""
    one = np.ones((1, 1))
    return Oscillator(MASS * one, 0.0 * one, 0.0 * one, one[None], one[None])


def film(offset: float, jumps: tuple[float, ...]) -> DynamicFilm:
    """A film whose damping jumps by JUMP / OMEGA at each of the places in `jumps` and rises evenly between them, in
    shares of a cell; its cells lie at `offset` and evenly behind it."""
    shares = [sum((offset + number / PLACES - jump) % 1.0 for jump in jumps) for number in range(PLACES)]
    parts = tuple(
        without_memory(np.array([[STIFFNESS / PLACES]]), np.array([[JUMP / OMEGA * share / PLACES]]))
        for share in shares
    )
    mean = weighted([(part, 1.0) for part in parts])
    whole = tuple(weighted([(part, float(PLACES))]) for part in parts)
    return DynamicFilm(mean, mean, mean, weighted([(mean, 0.0)]), None, (whole,))


def growth_and_error(offset: float, jumps: tuple[float, ...]) -> tuple[float, float]:
    machine, films = oscillator(), [film(offset, jumps)]
    (value, _), *_ = modes(machine, films, [films[0].own], OMEGA)
    return value.real, float(place_errors(machine, films, np.array([value]))[0])


@pytest.mark.parametrize("jumps", [(0.3,), (0.05, 0.62)])
def test_the_error_by_the_places_is_the_scatter_over_where_the_cells_lie(jumps: tuple[float, ...]) -> None:
    """The growth is -D / (2 m), D in the mean a half of each jump. Two fronts are 0.57 cells or 4.56 places apart, so
    that what they leave adds up neither always nor never."""
    found = np.array([growth_and_error(offset / OFFSETS / PLACES, jumps) for offset in range(OFFSETS)])
    off = found[:, 0] + 0.5 * len(jumps) * JUMP / OMEGA / (2.0 * MASS)
    rms, told = math.sqrt(np.mean(off**2)), found[:, 1] / SPREAD
    if len(jumps) == 1:
        np.testing.assert_allclose(told, rms, rtol=2e-3)
    assert np.abs(off).max() < 2.0 * told.min()
    assert 0.5 * rms < told.min() <= told.max() < 2.0 * rms
