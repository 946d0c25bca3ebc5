"""Motions of two frequencies along their branch, by its arc length and thus through folds.

The unknowns are those of two_frequencies.py and the speed of the rotor, y = (motion, nu / pace, Omega / pace). How the
equations change with the speed is a central difference, with the machine at each speed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import packed, unpacked
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Strides,
    Unreachable,
    at_value,
    corrected,
    fold_between,
    halved_until,
    next_length,
    oriented,
    step_from,
    unit_vector,
)
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.cycle import FOLD
from frbcli.cycles.parts.machine import driven_motions
from frbcli.cycles.unbalance.synchronous import WHIRLS
from frbcli.cycles.unbalance.two_frequencies import Linearised, Orders, Torus, left_out

STRIDES = Strides(first=0.03, shortest=1e-4, longest=0.2, points=60)
DIFFERENCE = 1e-6  # of the pace
MOST_UNKNOWNS = 900  # more of them, as where a whirl nearly locks in, end a branch
REFITS = 6
LOCATED = 1e-4  # of the arc length: a fold, whose speed is then known to its square
LEFT = "It leaves the range."


@dataclass(frozen=True)
class TorusPlace:
    """A motion on its branch; y, tangent: see Place; kind: "fold" or ""."""

    orders: Orders
    place: Place
    kind: str = ""


@dataclass(frozen=True)
class TorusBranch:
    """places: in their order, behind the start; note: why it ends."""

    places: tuple[TorusPlace, ...]
    note: str


class TorusFollower:
    """Follows the motions of a machine over the speed. course: of the machine; speeds: the slowest and the fastest one
    in rad/s."""

    def __init__(self, course: MachineCourse, speeds: tuple[float, float]) -> None:
        self.course, first = course, course.top
        self.pace, self.size, self.films = first.pace, first.size, first.film_count
        self.range = (speeds[0] / self.pace, speeds[1] / self.pace)

    def torus(self, orders: Orders, y: Array) -> Torus:
        """The motion of unknowns."""
        return Torus(orders, unpacked(y[:-2], self.size), float(y[-2] * self.pace), float(y[-1] * self.pace))

    def equations(self, here: TorusPlace) -> Equations:
        """Equations of the motions about a place."""
        reference = self.torus(here.orders, here.place.y).motion

        def linearised(y: Array) -> Linearised:
            torus = self.torus(here.orders, y)
            return Linearised(self.course.machine(y), torus, reference)

        def residual(balance: Linearised) -> Array:
            return balance.residual(driven_motions(balance.machine, balance.torus.omega))

        def at(y: Array) -> tuple[Array, Array]:
            balance, step = linearised(y), DIFFERENCE * unit_vector(len(y))
            ahead, behind = (residual(linearised(y + sign * step)) for sign in (1.0, -1.0))
            by_speed = (ahead - behind) / (2.0 * DIFFERENCE)
            return residual(balance), np.column_stack([balance.matrix(), by_speed])

        return at

    def start(self, torus: Torus, upwards: bool) -> TorusPlace | None:
        """The place of a motion, with its tangent to higher or lower speeds."""
        y = np.concatenate([packed(torus.motion), [torus.nu / self.pace, torus.omega / self.pace]])
        along = unit_vector(len(y)) * (1.0 if upwards else -1.0)
        found = corrected(self.equations(TorusPlace(torus.orders, Place(y, along))), y, along)
        return None if found is None else TorusPlace(torus.orders, oriented(found, along))

    def stepped(self, here: TorusPlace, length: float) -> TorusPlace | None:
        """The fitted place behind a step; None if it is not found. Raises Unreachable if it has too many harmonics."""
        found = step_from(self.equations(here), here.place, length)
        return None if found is None else self.fitted(replace(here, place=oriented(found, here.place.tangent)))

    def fitted(self, here: TorusPlace) -> TorusPlace | None:
        """The place with as many harmonics as it needs. Raises Unreachable if those are too many."""
        for _ in range(REFITS):
            torus = self.torus(here.orders, here.place.y)
            wanted = left_out(self.course.machine(here.place.y), torus)
            if not len(wanted):
                return here
            orders = np.concatenate([here.orders, wanted])
            if self.size * (2 * len(orders) - 1) > MOST_UNKNOWNS:
                raise Unreachable
            again = self.with_orders(here, orders)
            if again is None:
                return None
            here = again
        return None

    def with_orders(self, here: TorusPlace, orders: Orders) -> TorusPlace | None:
        """The place with other orders behind its own."""
        none = np.zeros(2 * self.size * (len(orders) - len(here.orders)))
        y, tangent = (np.concatenate([each[:-2], none, each[-2:]]) for each in (here.place.y, here.place.tangent))
        wider = TorusPlace(orders, Place(y, tangent))
        found = corrected(self.equations(wider), y, tangent)
        return None if found is None else TorusPlace(orders, oriented(found, tangent), here.kind)

    def fold(self, here: TorusPlace, beyond: TorusPlace, length: float) -> TorusPlace | None:
        """The fold within a step from a place to the one beyond."""
        wider = self.with_orders(here, beyond.orders)
        found = None if wider is None else fold_between(self.equations(wider), wider.place, length, LOCATED)
        return None if found is None else TorusPlace(beyond.orders, found, FOLD)

    def at_speed(self, here: TorusPlace, speed: float) -> TorusPlace | None:
        """The motion next to a place at a speed over the pace."""
        found = at_value(self.equations(here), here.place, speed)
        return None if found is None else replace(here, place=found)


def follow_torus(
    follower: TorusFollower, start: TorusPlace, until: Callable[[TorusPlace, TorusPlace], str] = lambda *_: ""
) -> TorusBranch:
    """The motions behind a start. until: called with two places after one another, says why the branch ends in the
    second one, or nothing."""
    places: list[TorusPlace] = []
    here, length = start, STRIDES.first
    for _ in range(STRIDES.points):
        try:
            found, length = halved_until(partial(follower.stepped, here), length, STRIDES.shortest)
        except Unreachable:
            return TorusBranch(tuple(places), "It has too many lines beyond: next to a speed at which it locks in.")
        if found is None:
            return TorusBranch(tuple(places), "The steps became too short.")
        if _ended(follower, here, found):
            return TorusBranch(tuple(places), "The whirl ends in the synchronous response.")
        speed = float(np.clip(found.place.y[-1], *follower.range))
        if speed != found.place.y[-1]:
            border = follower.at_speed(found, speed)
            return TorusBranch((*places, *([] if border is None else [border])), LEFT)
        if here.place.tangent[-1] * found.place.tangent[-1] < 0.0:
            fold = follower.fold(here, found, length)
            places += [] if fold is None else [fold]
        places.append(found)
        if note := until(here, found):
            return TorusBranch(tuple(places), note)
        if len(here.orders) == len(found.orders):
            length = next_length(length, STRIDES, here.place, found.place)
        here = found
    return TorusBranch(tuple(places), f"It was followed over {STRIDES.points} motions and goes on.")


def _ended(follower: TorusFollower, here: TorusPlace, there: TorusPlace) -> bool:
    """Whether the whirl has shrunk to nothing between two places: behind that the branch comes back."""
    before, after = (_whirl(follower, each) for each in (here, there))
    return bool(np.sum(np.conj(before) * after).real < 0.0 or np.abs(after).max() < WHIRLS)


def _whirl(follower: TorusFollower, here: TorusPlace) -> Complex:
    """(2 F,) the harmonic of the whirl over the clearance."""
    motion = follower.torus(here.orders, here.place.y).motion
    return np.asarray(motion[(here.orders == [1, 0]).all(axis=1), : 2 * follower.films][0])
