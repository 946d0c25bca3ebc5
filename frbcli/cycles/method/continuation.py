"""Curves of solutions of n equations in n + 1 unknowns, followed by their arc length (Keller 1977).

From a point y with the unit tangent t the next one is predicted at y + h t and corrected by Newton's method in the
plane across t. The plane is met also where the curve turns back in its parameter, the last unknown: at folds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import TypeVar

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from frbcli.arrays import Array

Found = TypeVar("Found")
Equations = Callable[[Array], tuple[Array, Array]]  # residual (n,), and its derivative (n, n + 1)

ITERATIONS = 10
STEP = 1e-10  # a Newton step below this ends the iteration
FORESEEN, SURELY = 1e-6, 0.1  # so does one below the first, if the next is foreseen below the other share of STEP
SLOW = 0.5  # a Newton step that is not shorter than this share of the one before ends it without success
WANTED = 4.0  # iterations that keep the step size
SHARPEST = 0.9  # cosine of the angle between two tangents that a step may turn by
CLOSEST = 1e-4  # step below which a change of the side is one of the curve itself: it branches there
TURNED_BY = 0.98  # beyond which the step size does not grow


class Unreachable(Exception):
    """The equations cannot be asked there."""


@dataclass(frozen=True)
class Place:
    """A point of a curve: the unknowns y (n + 1,) and the unit tangent (n + 1,) there; iterations: that it took; side:
    sign of the determinant of the derivative bordered by the tangent, which does not change along a curve, 0 if it is
    not known."""

    y: Array
    tangent: Array
    iterations: int = 0
    side: int = 0


@dataclass(frozen=True)
class Strides:
    """Step sizes along the curve: first, shortest, longest; turns: at most so many points."""

    first: float
    shortest: float
    longest: float
    points: int


def corrected(equations: Equations, guess: Array, tangent: Array) -> Place | None:
    """The point of the curve in the plane through a guess across a tangent; None if it is not found."""
    y, before = guess, np.inf
    for iteration in range(1, ITERATIONS + 1):
        try:
            residual, slope = equations(y)
        except Unreachable:
            return None
        matrix = np.vstack([slope, tangent])
        if not np.isfinite(matrix).all():
            return None
        right = np.zeros((len(y), 2))
        right[:-1, 0], right[-1, 0] = -residual, tangent @ (guess - y)
        right[-1, 1] = 1.0
        factors, swaps = lu_factor(matrix, overwrite_a=True, check_finite=False)
        pivots = np.diag(factors)
        if not np.all(pivots):
            return None
        step, along = lu_solve((factors, swaps), right, check_finite=False).T
        y = y + step
        size = float(np.linalg.norm(step))
        # Steps become shorter as their squares: size / before^2 stays, and the next one is size^3 / before^2.
        foreseen = iteration > 1 and size < FORESEEN and size**3 < SURELY * STEP * before**2
        if size < STEP or foreseen:
            swapped = np.count_nonzero(swaps != np.arange(len(swaps)))
            side = (-1) ** int(np.count_nonzero(pivots < 0.0) + swapped)
            return Place(y, along / np.linalg.norm(along), iteration + (size >= STEP), side)
        if iteration > 2 and size > SLOW * before:
            return None
        before = size
    return None


def reached(equations: Equations, guess: Array, tangent: Array) -> Place:
    """As corrected. Raises Unreachable where the point is not found."""
    place = corrected(equations, guess, tangent)
    if place is None:
        raise Unreachable
    return place


def unit_vector(size: int, number: int = -1) -> Array:
    """(size,) direction of one unknown alone, the last one if not given: in the plane across it the unknown is kept."""
    direction = np.zeros(size)
    direction[number] = 1.0
    return direction


def oriented(place: Place, direction: Array) -> Place:
    """The point with its tangent turned so that it goes along a direction."""
    if place.tangent @ direction >= 0.0:
        return place
    return replace(place, tangent=-place.tangent, side=-place.side)


def step_from(equations: Equations, place: Place, length: float, guess: Array | None = None) -> Place | None:
    """The point at a length along the tangent; None if it is not found, if the curve turns too much on the way, or if
    the step has come to another part of the curve that passes close by. guess: of it, at this length."""
    ahead = corrected(equations, place.y + length * place.tangent if guess is None else guess, place.tangent)
    if ahead is None or (ahead.side * place.side < 0 and length > CLOSEST):
        return None
    return ahead if abs(ahead.tangent @ place.tangent) >= SHARPEST else None


def halved_until(
    stepped: Callable[[float], Found | None], length: float, shortest: float
) -> tuple[Found | None, float]:
    """The place that a step reaches, and the length of the step, which is halved until it reaches one or is not above
    `shortest`."""
    place = stepped(length)
    while place is None and length > shortest:
        length *= 0.5
        place = stepped(length)
    return place, length


def next_length(length: float, strides: Strides, before: Place, after: Place) -> float:
    """The length of the following step: longer where few iterations were needed and the curve is nearly straight."""
    factor = 2.0 ** ((WANTED - after.iterations) / 2.0)
    if abs(before.tangent @ after.tangent) < TURNED_BY:
        factor = min(factor, 1.0 if after.iterations > 2 else 1.2)
    return float(np.clip(length * np.clip(factor, 0.5, 2.0), strides.shortest, strides.longest))


def follow(equations: Equations, start: Place, strides: Strides) -> Iterator[tuple[Place, float]]:
    """The points of a curve behind `start` with the lengths of their steps, until a step of the shortest length fails
    or there are enough of them."""
    place, length = start, strides.first
    for _ in range(strides.points):
        ahead, length = halved_until(partial(step_from, equations, place), length, strides.shortest)
        if ahead is None:
            return
        yield ahead, length
        length = next_length(length, strides, place, ahead)
        place = ahead


def _between(places: dict[float, Place | None], at: float) -> Array | None:
    """On the chord between the nearest points on both sides: of the same length along the tangent."""
    known = {one: place.y for one, place in places.items() if place is not None}
    below = max((one for one in known if one < at), default=None)
    above = min((one for one in known if one > at), default=None)
    if below is None or above is None:
        return None
    return known[below] + (at - below) / (above - below) * (known[above] - known[below])


def located(
    equations: Equations,
    place: Place,
    length: float,
    criterion: Callable[[Place], float],
    tolerance: float,
    known: Mapping[float, float] = MappingProxyType({}),
) -> Place | None:
    """The place within a step of `length` from one at which `criterion` changes its sign, known to a length `tolerance`
    along the tangent. known: the criterion at some lengths. None where it does not change its sign, or the curve cannot
    be followed."""
    from scipy.optimize import brentq

    places: dict[float, Place | None] = {0.0: place}
    numbers = dict(known)

    def at(along: float) -> Place:
        if along not in places:
            other = step_from(equations, place, along)
            if other is None and (near := _between(places, along)) is not None:
                other = step_from(equations, place, along, near)
            places[along] = None if other is None else oriented(other, place.tangent)
        there = places[along]
        if there is None:
            raise Unreachable
        return there

    def number(along: float) -> float:
        if along not in numbers:
            numbers[along] = criterion(at(along))
        return numbers[along]

    try:
        if number(0.0) * number(length) > 0.0:
            return None
        return at(float(brentq(number, 0.0, length, xtol=tolerance, rtol=1e-12)))
    except Unreachable:
        return None


def fold_between(equations: Equations, place: Place, length: float, tolerance: float = 1e-9) -> Place | None:
    """Where the parameter turns back within a step of `length` from `place`, to a share `tolerance` of it: the tangent
    has no part along the parameter there. None where it does not turn back, or cannot be followed."""
    return located(equations, place, length, lambda one: float(one.tangent[-1]), tolerance * max(length, 1.0))


def at_value(equations: Equations, near: Place, value: float, number: int = -1) -> Place | None:
    """The point at a value of one unknown, the last one if not given, next to another point; None if it is not
    found."""
    guess = near.y + (value - near.y[number]) / near.tangent[number] * near.tangent
    guess[number] = value
    place = corrected(equations, guess, unit_vector(len(guess), number))
    return None if place is None else oriented(place, near.tangent)
