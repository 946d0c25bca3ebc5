"""A branch of limit cycles from a Hopf point on: followed by its arc length through folds, with the stability of each
cycle and the points where it changes.

Harmonics are added where the next ones would be larger than a tolerance, and left out where the last ones are much
smaller.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from frbcli.cycles.method.balance import Balance, left_out, moments, motion_along, packed, unpacked
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Strides,
    Unreachable,
    corrected,
    fold_between,
    halved_until,
    next_length,
    oriented,
    step_from,
    unit_vector,
)
from frbcli.cycles.method.equilibria import HopfPoint
from frbcli.cycles.method.floquet import HELPS, TRIVIAL, Multipliers, multipliers
from frbcli.cycles.parts.linearised import StateSpace
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.parts.reduced_states import reduced_space

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

STRIDES = Strides(first=0.01, shortest=1e-6, longest=0.06, points=600)
FIRST_HARMONICS, MOST_HARMONICS = 5, 80
REFITS = 4  # of a fold with more harmonics
# Of one film, of several: what the harmonics left out may have of the clearance, and unknowns up to which harmonics are
# added for the trivial multiplier alone.
TAIL, MOST_UNKNOWNS = (1e-7, 1e-6), (1100, 450)
MOST_AT_FOLD = (2400, 450)  # the same at a fold, beside which a film may be nearly at rest for a moment
SPARE = 0.1  # of it: what the last harmonics have where there are too many
NARROWER = 0.6  # share of the smallest gap that one step may leave
LARGEST = 0.9998  # eccentricity beyond which no cycle is followed
NOTHING = 1e-9  # amplitude over the clearance of a cycle that is none
SMALL = 2e-3  # amplitude over the clearance below which a branch has come back to rest
MOMENTS = 256  # of a period at which eccentricities are taken
CLOSE = 6e-5  # share of the step to which a flip or a torus point is located
FOLD, FLIP, TORUS, HOPF = "fold", "flip", "torus", "hopf"
ASKED = "asked"  # a cycle at a speed that was asked for


@dataclass(frozen=True)
class Cycle:
    """A limit cycle. place: on its branch, with its tangent; machine: whose cycle it is; y: see balance.py;
    eccentricity_max: (F,)."""

    place: Place
    machine: Machine
    y: Array
    eccentricity_max: Array
    multipliers: Multipliers
    kind: str = ""


@dataclass(frozen=True)
class Branch:
    """Cycles in their order from the Hopf point on, special ones among them by their kind; note: why it ends;
    ends_at_rest: whether it comes back to rest."""

    cycles: tuple[Cycle, ...]
    note: str
    ends_at_rest: bool = False


LEFT = "It leaves the range."
AT_REST = "It ends at rest, in another Hopf point."


class Follower:
    """One branch while it is followed. omega: as in Balance; scale, unit: the last unknown times `scale` is in the
    unit; free: whether it is a whirl, which may shrink to rest; tail, most_at_fold: see TAIL, MOST_AT_FOLD;
    tail_of_folds: share of the tail that folds may have."""

    free = True
    tail = TAIL
    tail_of_folds = 1.0
    most_at_fold = MOST_AT_FOLD

    def __init__(
        self, machine: Machine, slowest: float, fastest: float, asked: Sequence[float] = (), omega: float | None = None
    ) -> None:
        self.machine = machine
        self.omega = omega
        self.scale, self.unit = machine.pace / (2.0 * math.pi), "Hz"
        self.range = (slowest / machine.pace, fastest / machine.pace)
        self.asked = tuple(speed / machine.pace for speed in asked)

    def cycle(self, place: Place, kind: str = "", near: Cycle | None = None) -> Cycle:
        """A point of the branch with its results. near: one close by."""
        found = self.multipliers(place, None if near is None else near.multipliers.relaxed)
        halved = True  # whether finer intervals have been tried
        while found.defect > TRIVIAL:
            finer = self.with_more(place, self.most_at_fold if kind == FOLD else MOST_UNKNOWNS)
            if finer is None:
                found = found if halved else self.multipliers(place, found)
                break
            enough = HELPS * found.defect
            place, found = finer, self.multipliers(finer, found, enough)
            halved = found.defect > enough
        machine, y = self.machine_at(place.y), self.as_cycle(place.y)
        return Cycle(place, machine, y, eccentricities(machine, y), found, kind)

    def multipliers(self, place: Place, near: Multipliers | None = None, enough: float = TRIVIAL) -> Multipliers:
        """Those of the cycle at a place. near, enough: see floquet.py."""
        machine, y = self.machine_at(place.y), self.as_cycle(place.y)
        return multipliers(machine, self.space_at(place.y), y, near, max(TRIVIAL, enough))

    def space_at(self, _y: Array) -> StateSpace:
        """The states whose multipliers those of the cycle y are."""
        return self._space

    @cached_property
    def _space(self) -> StateSpace:
        return reduced_space(self.machine)

    def machine_at(self, _y: Array) -> Machine:
        """The machine whose cycle y is."""
        return self.machine

    def equations(self, place: Place) -> Equations:
        """Those of the cycles about a place."""
        return Balance(self.machine, self.reference(place), self.omega)

    def reference(self, place: Place) -> Complex:
        """The motion that the phase of cycles about a place is compared with."""
        moving = self.moves(place.y)  # at a Hopf point only the tangent has a phase
        return unpacked((place.y if moving else place.tangent)[:-2], self.machine.size)

    def moves(self, y: Array) -> bool:
        """Whether y is more than rest."""
        return amplitude(self.machine, y) > NOTHING

    def entered(self, y: Array, last: float) -> Place | None:
        """The cycle y with the last unknown `last` as a place of the branch, which rises in it; None if it is none."""
        along = unit_vector(len(y))
        there = np.append(y[:-1], last)
        return corrected(self.equations(Place(there, along)), there, along)

    def as_cycle(self, y: Array) -> Array:
        """The unknowns y with the speed of the rotor at their end."""
        return y if self.omega is None else np.append(y[:-1], self.omega / self.machine.pace)

    def with_more(self, place: Place, most: tuple[int, int]) -> Place | None:
        """The place with half as many harmonics more, None if those are too many. most: see MOST_UNKNOWNS."""
        c, harmonics = self.machine.size, (len(place.y) - 2) // self.machine.size // 2
        more = resized(place, c, harmonics + harmonics // 2)
        if len(more.y) > most[self.machine.film_count > 1]:
            return None
        found = corrected(self.equations(more), more.y, more.tangent)
        return None if found is None else oriented(found, more.tangent)

    def refitted(self, place: Place, share: float = 1.0) -> Place | None:
        """The place with as many harmonics as it needs for a share of the tail; None if that does not converge, or if
        they are too many."""
        c, allowed = self.machine.size, share * self.tail[self.machine.film_count > 1]
        for _ in range(12):
            harmonics = (len(place.y) - 2) // c // 2
            tail = left_out(self.machine_at(place.y), self.as_cycle(place.y))
            motion = unpacked(place.y[:-2], c)
            if tail < allowed:
                used = np.flatnonzero(np.abs(motion).max(axis=1) > SPARE * allowed)
                wanted = max(FIRST_HARMONICS, int(used[-1]) + 2)
                return place if wanted >= harmonics else resized(place, c, wanted)
            if harmonics >= MOST_HARMONICS:
                return None
            place = resized(place, c, min(MOST_HARMONICS, harmonics + max(2, harmonics // 3)))
            found = corrected(self.equations(place), place.y, place.tangent)
            if found is None or found.side * place.side < 0:  # of another part of the branch that passes close by
                return None
            place = oriented(found, place.tangent)
        return None

    def as_fine(self, place: Place, other: Place) -> Place:
        """The place with as many harmonics as another, taken anew: on which side of the curve a place lies, by the sign
        of a determinant, is not the same with more of them."""
        near = resized_like(place, other, self.machine.size)
        found = place if near is place else corrected(self.equations(near), near.y, near.tangent)
        return near if found is None else oriented(found, near.tangent)

    def fold(self, place: Place, length: float) -> Place | None:
        """The refitted fold within a step from a place."""
        found = None
        for _ in range(REFITS):
            found = fold_between(self.equations(place), place, length)
            fitted = None if found is None else self.refitted(found, self.tail_of_folds)
            if found is None or fitted is None or len(fitted.y) <= len(place.y):
                break
            place = self.as_fine(place, fitted)
        return found

    def stepped(self, place: Place, length: float) -> Place | None:
        """The refitted place behind a step."""
        narrow = 1.0 - largest(self.machine, place.y + length * place.tangent)
        if narrow < NARROWER * (1.0 - largest(self.machine, place.y)):
            return None
        found = step_from(self.equations(place), place, length)
        return None if found is None else self.refitted(oriented(found, place.tangent))


class FoldFollower(Follower):
    """Follows branches whose folds alone are asked for: without multipliers, the larger part of the cost, and with few
    harmonics up to the fold."""

    tail = (1e-5, 1e-5)
    tail_of_folds = 1e-2

    def multipliers(self, _place: Place, _near: Multipliers | None = None, _enough: float = 0.0) -> Multipliers:
        """The trivial one alone, (1,), with no defect: none are computed."""
        return Multipliers(np.ones(1, dtype=complex), 0.0)


def follow_branch(
    follower: Follower,
    start: Place,
    observe: Callable[[Cycle], None] | None = None,
    until: Callable[[Cycle], bool] | None = None,
) -> Branch:
    """The cycles from a place on, as that of a Hopf point. observe: called with each cycle;
    until: called with each cycle, special ones too, the last one being that for which it says so.
    """
    machine = follower.machine
    place, length, strides = start, STRIDES.first, STRIDES
    cycles: list[Cycle] = []
    note = ""
    for _ in range(strides.points):
        found, length = halved_until(partial(follower.stepped, place), length, strides.shortest)
        if found is None:
            note = _why_not(follower, place)
            break
        if follower.free and cycles and passed_rest(machine, place, found):
            return Branch(tuple(cycles), AT_REST, ends_at_rest=True)
        beyond = not follower.range[0] <= found.y[-1] <= follower.range[1]
        if beyond:
            limit = follower.range[0] if found.y[-1] < follower.range[0] else follower.range[1]
            found, note = at_speed(follower, place, found, limit), LEFT
            if found is None:
                break
        cycle = follower.cycle(found, near=cycles[-1] if cycles else None)
        known = len(cycles)
        cycles += special_cycles(follower, cycles[-1] if cycles else None, place, cycle, length)
        cycles.append(cycle)
        if until is not None and any(until(one) for one in cycles[known:]):
            return Branch(tuple(cycles), "")
        if observe is not None:
            observe(cycle)
        if beyond:
            break
        if largest(machine, found.y) > LARGEST:
            note = f"The journal comes nearer to its shell than an eccentricity of {LARGEST}."
            break
        if follower.free and len(cycles) > 3 and amplitude(machine, found.y) < SMALL:
            return Branch(tuple(cycles), AT_REST, ends_at_rest=True)
        length = next_length(length, strides, resized_like(place, found, machine.size), found)
        place = found
    else:
        note = f"It was followed over {strides.points} cycles and goes on."
    return Branch(tuple(cycles), note)


def first_place(machine: Machine, hopf: HopfPoint, last: float | None = None) -> Place:
    """The Hopf point as a cycle of no size, with the tangent along its mode. last: the last unknown, its speed over
    the pace if not given."""
    motion = np.zeros((FIRST_HARMONICS + 1, machine.size), dtype=complex)
    along = np.zeros_like(motion)
    motion[0], along[1] = hopf.equilibrium.u, hopf.mode
    over = hopf.equilibrium.omega / machine.pace if last is None else last
    y = np.concatenate([packed(motion), [hopf.nu / machine.pace, over]])
    tangent = np.concatenate([packed(along), [0.0, 0.0]])
    return Place(y, tangent / np.linalg.norm(tangent))


def resized(place: Place, c: int, harmonics: int) -> Place:
    """The place with other harmonics, new ones zero; as it was found."""

    def cut(vector: Array) -> Array:
        body = np.zeros(c * (2 * harmonics + 1))
        kept = min(len(body), len(vector) - 2)
        body[:kept] = vector[:kept]
        return np.concatenate([body, vector[-2:]])

    tangent = cut(place.tangent)
    return replace(place, y=cut(place.y), tangent=tangent / np.linalg.norm(tangent))


def resized_like(place: Place, other: Place, c: int) -> Place:
    """The place with as many harmonics as another."""
    return place if len(place.y) == len(other.y) else resized(place, c, (len(other.y) - 2) // c // 2)


def eccentricities(machine: Machine, y: Array) -> Array:
    """(F,) largest eccentricity of each film on the cycle y."""
    motion = unpacked(y[:-2], machine.size)
    u, _ = motion_along(motion, max(MOMENTS, moments(len(motion))))
    return largest_of(u[:, : 2 * machine.film_count])


def largest_of(displacements: Array) -> Array:
    """(F,) largest eccentricities of displacements (n, 2 F)."""
    return np.asarray(np.hypot(displacements[:, 0::2], displacements[:, 1::2]).max(axis=0))


def largest(machine: Machine, y: Array) -> float:
    """The largest of them."""
    return float(eccentricities(machine, y).max())


def amplitude(machine: Machine, y: Array) -> float:
    """Size over the clearance of what is not the mean of the cycle."""
    motion = unpacked(y[:-2], machine.size)[1:, : 2 * machine.film_count]
    return float(2.0 * np.abs(motion).max(initial=0.0))


def passed_rest(machine: Machine, before: Place, after: Place) -> bool:
    """Whether the cycle has shrunk to rest between two places: behind it the branch comes back."""
    one, other = (unpacked(place.y[:-2], machine.size)[1] for place in (before, after))
    return bool(np.sum(np.conj(one) * other).real < 0.0)


def special_cycles(follower: Follower, before: Cycle | None, place: Place, after: Cycle, length: float) -> list[Cycle]:
    """Folds, flips and torus points between a place and the cycle a step behind it."""
    found: list[Cycle] = []
    if place.tangent[-1] * after.place.tangent[-1] < 0.0:
        fold = follower.fold(follower.as_fine(place, after.place), length)
        if fold is not None:
            found.append(follower.cycle(fold, FOLD, after))
    ends = sorted((place.y[-1], after.y[-1]))
    for speed in follower.asked if not found else ():  # beside a fold there are two of them, or none
        there = at_speed(follower, place, after.place, speed) if ends[0] < speed <= ends[1] else None
        if there is not None:
            found.append(follower.cycle(there, ASKED, after))
    found.sort(key=lambda cycle: abs(cycle.y[-1] - place.y[-1]))
    if before is None:
        return found
    change = after.multipliers.unstable - before.multipliers.unstable
    folds = any(cycle.kind == FOLD for cycle in found)
    if change == 0 or (folds and abs(change) == 1):
        return found
    kind = _kind(before if change < 0 else after)
    if kind == FOLD:  # a real multiplier at 1 away from a fold is one that the harmonics have not resolved
        return found
    finer = follower.as_fine(place, after.place)
    place_there = _crossing(follower, finer, length, (before.multipliers, after.multipliers))
    if place_there is not None:
        found.append(follower.cycle(place_there, kind, after))
    return found


def _kind(cycle: Cycle) -> str:
    """What leads to a cycle with more multipliers outside of the unit circle: by the one that is nearest to it."""
    others = cycle.multipliers.others
    outside = others[np.abs(others) > 1.0 + cycle.multipliers.defect]
    if not len(outside):
        return FOLD
    nearest = outside[np.argmin(np.abs(outside))]
    if abs(nearest.imag) > 1e-6 * abs(nearest):
        return TORUS
    return FLIP if nearest.real < 0.0 else FOLD


def _crossing(
    follower: Follower, place: Place, length: float, ends: tuple[Multipliers, Multipliers]
) -> Place | None:
    """Where a multiplier crosses the unit circle within a step, between those at its ends."""
    from scipy.optimize import brentq

    number = max(found.unstable for found in ends) - 1
    known = {0.0: ends[0].growth(number), length: ends[1].growth(number)}

    def growth(along: float) -> float:
        if along not in known:
            known[along] = follower.multipliers(at(along), ends[1]).growth(number)
        return known[along]

    def at(along: float) -> Place:
        there = step_from(follower.equations(place), place, along)
        if there is None:
            raise Unreachable
        return oriented(there, place.tangent)

    try:
        if known[0.0] * known[length] > 0.0:  # one end is within the error of the trivial multiplier
            return at(min(known, key=lambda along: abs(known[along])))
        return at(float(brentq(growth, 0.0, length, xtol=CLOSE * length)))
    except Unreachable:
        return None


def at_speed(follower: Follower, place: Place, beyond: Place, speed: float) -> Place | None:
    """The cycle at a speed over the pace between two."""
    near = resized_like(place, beyond, follower.machine.size)
    share = (speed - near.y[-1]) / (beyond.y[-1] - near.y[-1])
    guess = near.y + share * (beyond.y - near.y)
    found = corrected(follower.equations(beyond), guess, unit_vector(len(guess)))
    return None if found is None else oriented(found, beyond.tangent)


def _why_not(follower: Follower, place: Place) -> str:
    """Why no step leads on."""
    machine = follower.machine
    harmonics = (len(place.y) - 2) // machine.size // 2
    tail = left_out(follower.machine_at(place.y), follower.as_cycle(place.y))
    there = f"{place.y[-1] * follower.scale:.4g} {follower.unit}".rstrip()
    told = f"It could not be followed beyond {there}, an eccentricity of {largest(machine, place.y):.4f}"
    if harmonics >= MOST_HARMONICS - 2:
        return f"{told}: {harmonics} harmonics leave {tail:.1g} of the clearance."
    return f"{told}: the steps became too short."
