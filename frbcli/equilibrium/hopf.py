"""Whirls about rest, and the Hopf points where they begin or cease to grow.

A whirl is an oscillating motion: a pair of conjugate eigenvalues. Its real part is the growth, its imaginary part the
frequency. At a Hopf point the growth of a whirl passes through zero as a number of the machine, such as its speed,
changes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Complex
from frbcli.rotor.loads import fastest_first

OSCILLATING = 1e-9  # imaginary part over absolute value from which an eigenvalue oscillates
HALVINGS = 30  # of an interval with several Hopf points
UNDAMPED = -1e-300  # 1/s, of a whirl that does not grow yet and has no damping: its zero is where growth begins
JUMP = 1e-2  # growth over that at the ends of an interval above which a whirl has turned into a drift


def oscillating(eigenvalues: Complex) -> NDArray[np.bool_]:
    """(N,) of each oscillating pair of eigenvalues (N,) the one with positive imaginary part."""
    return np.asarray(eigenvalues.imag > OSCILLATING * np.abs(eigenvalues))


def whirls(eigenvalues: Complex, slowest: float = 0.0) -> NDArray[np.int64]:
    """(W,) numbers of the eigenvalues that oscillate, by falling growth. slowest: frequency in rad/s above which a
    motion counts as a whirl."""
    numbers = np.flatnonzero(oscillating(eigenvalues) & (eigenvalues.imag > slowest))
    return numbers[fastest_first(eigenvalues[numbers])]


class AtRest(Protocol):
    """A machine at rest at one value of a number that changes, such as its speed."""

    @property
    def value(self) -> float:
        """The value of the number that changes."""
        ...

    @property
    def eigenvalues(self) -> Complex:
        """(N,) of the linearised machine, 1/s."""
        ...

    def growth_of(self, number: int) -> float:
        """Growth in 1/s of the whirl number 0, 1, ... by falling growth; -inf if there are not as many."""


Rest = TypeVar("Rest", bound=AtRest)


@dataclass(frozen=True)
class Crossing(Generic[Rest]):
    """A Hopf point. here: the machine there; rising: whether the whirl grows above it."""

    here: Rest
    rising: bool


def hopf_points(
    between: Callable[[Rest, Rest, float], Rest], points: Sequence[Rest], close: float
) -> Iterator[Crossing[Rest]]:
    """The Hopf points between machines at rest whose values are in their order.

    between: the machine at a value between two others; close: relative error of the value at a Hopf point. """
    for low, high in itertools.pairwise(points):
        yield from _within(between, low, high, close, HALVINGS)


def _within(
    between: Callable[[Rest, Rest, float], Rest], low: Rest, high: Rest, close: float, halvings: int
) -> Iterator[Crossing[Rest]]:
    count = _crossed(low, high)
    if count == 0 or halvings == 0:
        return
    before, after = growing(low.eigenvalues), growing(high.eigenvalues)
    if count == 1 and before != after:  # else one whirl begins to grow, and another one becomes a drift
        number = max(before, after) - 1
        here = located(lambda value: between(low, high, value), low, high, number, close)
        ends = [growth for at in (low, high) if math.isfinite(growth := at.growth_of(number))]
        if abs(here.growth_of(number)) < JUMP * max(map(abs, ends)):
            yield Crossing(here, after > before)
        return
    middle = between(low, high, 0.5 * (low.value + high.value))
    yield from _within(between, low, middle, close, halvings - 1)
    yield from _within(between, middle, high, close, halvings - 1)


def _crossed(low: AtRest, high: AtRest) -> int:
    """How many oscillating pairs cross the imaginary axis between two machines, one way or the other: eigenvalues are
    the same motion where they are nearest to each other."""
    from scipy.optimize import linear_sum_assignment

    before, after = (at.eigenvalues[at.eigenvalues.imag >= 0.0] for at in (low, high))
    mine, others = linear_sum_assignment(np.abs(before[:, None] - after[None, :]))
    turned = (before[mine].real > 0.0) != (after[others].real > 0.0)
    whirling = np.abs(before[mine].imag) + np.abs(after[others].imag) > OSCILLATING * np.abs(before[mine])
    return max(int(np.count_nonzero(turned & whirling)), abs(growing(high.eigenvalues) - growing(low.eigenvalues)))


def located(
    at: Callable[[float], Rest], low: Rest, high: Rest, number: int, close: float, guess: float | None = None
) -> Rest:
    """The machine at the value between two at which the growth of the whirl `number` passes through zero.

    at: the machine at a value; close: relative error of the value; guess: a value between the two that may be near.
    """
    from scipy.optimize import brentq  # runs, which need eigenvalues alone, need not wait for its import

    known = {low.value: low, high.value: high}

    def growth(value: float) -> float:
        if value not in known:
            known[value] = at(value)
        return known[value].growth_of(number) or UNDAMPED

    ends, tolerance = [low.value, high.value], close * high.value
    if guess is not None and low.value < guess < high.value:
        ends[(growth(guess) > 0.0) == (growth(high.value) > 0.0)] = guess
    value = float(brentq(growth, *ends, xtol=tolerance, rtol=close))
    growth(value)
    return known[value]


def growth_of(eigenvalues: Complex, number: int, slowest: float = 0.0) -> float:
    """Growth in 1/s of the whirl number 0, 1, ... of eigenvalues (N,) by falling growth; -inf if there are not as many.
    slowest: see whirls."""
    numbers = whirls(eigenvalues, slowest)
    return float(eigenvalues[numbers[number]].real) if number < len(numbers) else -math.inf


def growing(eigenvalues: Complex) -> int:
    """How many whirls of eigenvalues (N,) grow."""
    return int(np.count_nonzero(oscillating(eigenvalues) & (eigenvalues.real > 0.0)))
