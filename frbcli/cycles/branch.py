"""A branch of limit cycles from a Hopf point on: followed by its arc length through folds, with the stability of each
cycle and the points where it changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.cycles.method.balance import Multipliers, left_out, packed
from frbcli.cycles.method.continuation import (
    Place,
    Strides,
    halved_until,
    located,
    next_length,
    oriented,
    step_from,
)
from frbcli.cycles.method.equilibria import HopfPoint
from frbcli.cycles.method.follower import (
    ASKED,
    FIRST_HARMONICS,
    FLIP,
    FOLD,
    MOST_HARMONICS,
    TORUS,
    Cycle,
    Follower,
    amplitude,
    at_speed,
    largest,
    passed_rest,
    resized_like,
)

STRIDES = Strides(first=0.01, shortest=1e-6, longest=0.06, points=600)
LARGEST = 0.9998  # eccentricity beyond which no cycle is followed
SMALL = 2e-3  # amplitude over the clearance below which a branch has come back to rest
CLOSE = 6e-5  # share of the step to which a flip or a torus point is located


@dataclass(frozen=True)
class Branch:
    """Cycles in their order from the Hopf point on, special ones among them by their kind; note: why it ends;
    ends_at_rest: whether it comes back to rest."""

    cycles: tuple[Cycle, ...]
    note: str
    ends_at_rest: bool = False


LEFT = "It leaves the range."
AT_REST = "It ends at rest, in another Hopf point."


def follow_branch(
    follower: Follower,
    start: Place,
    observe: Callable[[Cycle], None] | None = None,
    until: Callable[[Cycle], bool] | None = None,
) -> Branch:
    """The cycles from a place on, e.g. a Hopf point. observe: called with each cycle; until: called with each cycle,
    special ones too; the branch ends where it returns True. """
    machine = follower.machine
    place, length, strides = start, STRIDES.first, STRIDES
    cycles: list[Cycle] = []
    note = ""
    for _ in range(strides.points):
        ahead, length = halved_until(partial(follower.stepped, place), length, strides.shortest)
        if ahead is None:
            note = _why_not(follower, place)
            break
        if follower.free and cycles and passed_rest(machine, place, ahead):
            return Branch(tuple(cycles), AT_REST, ends_at_rest=True)
        beyond = not follower.range[0] <= ahead.y[-1] <= follower.range[1]
        if beyond:
            limit = follower.range[0] if ahead.y[-1] < follower.range[0] else follower.range[1]
            ahead, note = at_speed(follower, place, ahead, limit), LEFT
            if ahead is None:
                break
        cycle = follower.cycle(ahead, near=cycles[-1] if cycles else None)
        known = len(cycles)
        cycles += special_cycles(follower, cycles[-1] if cycles else None, place, cycle, length)
        cycles.append(cycle)
        if until is not None and any(until(one) for one in cycles[known:]):
            return Branch(tuple(cycles), "")
        if observe is not None:
            observe(cycle)
        if beyond:
            break
        if largest(machine, ahead.y) > LARGEST:
            note = f"The journal comes nearer to its shell than an eccentricity of {LARGEST}."
            break
        if follower.free and len(cycles) > 3 and amplitude(machine, ahead.y) < SMALL:
            return Branch(tuple(cycles), AT_REST, ends_at_rest=True)
        length = next_length(length, strides, resized_like(place, ahead, machine.size), ahead)
        place = ahead
    else:
        note = f"It was followed over {strides.points} cycles and goes on."
    return Branch(tuple(cycles), note)


def first_place(hopf: HopfPoint) -> Place:
    """The Hopf point as a cycle of no size, with the tangent along its mode."""
    here = hopf.equilibrium
    motion, along = (np.zeros((FIRST_HARMONICS + 1, len(here.u)), dtype=complex) for _ in range(2))
    motion[0], along[1] = here.u, hopf.mode
    tangent = np.concatenate([packed(along), [0.0, 0.0]])
    y = np.concatenate([packed(motion), [hopf.nu / here.machine.pace, here.value]])
    return Place(y, tangent / np.linalg.norm(tangent))


def special_cycles(follower: Follower, before: Cycle | None, place: Place, after: Cycle, length: float) -> list[Cycle]:
    """Folds, flips and torus points between a place and the cycle a step behind it."""
    special: list[Cycle] = []
    if place.tangent[-1] * after.place.tangent[-1] < 0.0:
        fold = follower.fold(follower.as_fine(place, after.place), length)
        if fold is not None:
            special.append(follower.cycle(fold, FOLD, after))
    ends = sorted((place.y[-1], after.y[-1]))
    for speed in follower.asked if not special else ():  # next to a fold there are two of them, or none
        there = at_speed(follower, place, after.place, speed) if ends[0] < speed <= ends[1] else None
        if there is not None:
            special.append(follower.cycle(there, ASKED, after))
    special.sort(key=lambda cycle: abs(cycle.y[-1] - place.y[-1]))
    if before is None:
        return special
    change = after.multipliers.unstable - before.multipliers.unstable
    folds = any(cycle.kind == FOLD for cycle in special)
    if change == 0 or (folds and abs(change) == 1):
        return special
    kind = _kind(before if change < 0 else after)
    if kind == FOLD:  # a real multiplier at 1 away from a fold is one that the harmonics have not resolved
        return special
    finer = follower.as_fine(place, after.place)
    place_there = _crossing(follower, finer, length, (before.multipliers, after.multipliers))
    if place_there is not None:
        crossed = follower.cycle(place_there, kind, after)
        special.append(replace(crossed, kind=_kind_of(_nearest(crossed)) or kind))
    return special


def _kind(cycle: Cycle) -> str:
    """What leads to a cycle with more multipliers outside of the unit circle: by the one that is nearest to it."""
    others = cycle.multipliers.others
    outside = others[np.abs(others) > 1.0 + cycle.multipliers.defect]
    if not len(outside):
        return FOLD
    return _kind_of(complex(outside[np.argmin(np.abs(outside))])) or FOLD


def _nearest(cycle: Cycle) -> complex:
    """The multiplier that is nearest to the unit circle, the trivial one apart."""
    others = cycle.multipliers.others
    return complex(others[np.argmin(np.abs(np.abs(others) - 1.0))])


def _kind_of(multiplier: complex) -> str:
    """What a cycle is whose multiplier crosses the unit circle there; nothing of one that is positive."""
    if abs(multiplier.imag) > 1e-6 * abs(multiplier):
        return TORUS
    return FLIP if multiplier.real < 0.0 else ""


def _crossing(follower: Follower, place: Place, length: float, ends: tuple[Multipliers, Multipliers]) -> Place | None:
    """Where a multiplier crosses the unit circle within a step, between those at its ends."""
    number, asked = max(pair_of.unstable for pair_of in ends) - 1, follower.equations(place)
    known = {0.0: ends[0].growth(number), length: ends[1].growth(number)}
    if known[0.0] * known[length] > 0.0:  # one end is within the error of the trivial multiplier
        crossing = step_from(asked, place, min(known, key=lambda along: abs(known[along])))
        return None if crossing is None else oriented(crossing, place.tangent)

    def growth(one: Place) -> float:
        return follower.multipliers(one, ends[1]).growth(number)

    return located(asked, place, length, growth, CLOSE * length, known)


def _why_not(follower: Follower, place: Place) -> str:
    """Why no step leads on."""
    machine = follower.machine
    harmonics = (len(place.y) - 2) // machine.size // 2
    tail = left_out(follower.course.machine(place.y), follower.course.with_speed(place.y))
    there = f"{place.y[-1] * follower.course.scale:.4g} {follower.course.unit}".rstrip()
    reason = f"It could not be followed beyond {there}, an eccentricity of {largest(machine, place.y):.4f}"
    if harmonics >= MOST_HARMONICS - 2:
        return f"{reason}: {harmonics} harmonics leave {tail:.1g} of the clearance."
    return f"{reason}: the steps became too short."
