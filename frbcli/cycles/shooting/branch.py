"""Branches of limit cycles found by shooting (shots.py), followed by their arc length in speed, with their special
points: folds, flips and torus points."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.branch import AT_REST, LEFT
from frbcli.cycles.method.continuation import halved_until
from frbcli.cycles.method.follower import ASKED, FLIP, FOLD, TORUS
from frbcli.cycles.shooting.shots import Rest, Shooting, Shot

FIRST, SHORTEST, LONGEST = 0.05, 1e-3, 0.1  # steps along a branch
MOST_POINTS = 150
# Growth of a step where directions differ by little, what is left of it where they differ by much; by most.
LONGER, STRAIGHT, SHORTER, BENT, SHARPEST = 1.5, 0.98, 0.7, 0.95, 0.85
SMALL = 0.02  # amplitude over the clearance below which a branch has come back to rest
# A branch that turns back has a fold if its speed differs by so many times what it differs by between places of the
# cells, of which at least so much is taken, relative.
CLEAR, BLUR = 2.0, 2e-4
REFINED, REFINED_SMOOTH = 6, 14  # evaluations that locate a special point, with cells and without


def follow_shots(
    shooting: Shooting,
    start: Shot,
    speeds: tuple[float, float],
    asked: Sequence[float] = (),
    observe: Callable[[Shot], None] | None = None,
) -> tuple[tuple[Shot, ...], str]:
    """The cycles of a branch from one on, special ones among them, and why it ends. speeds: lowest and highest, and
    asked: those at which cycles are computed exactly, in rad/s."""
    shots, length, along = [start], FIRST, start.tangent
    limit = shooting.flow.limit
    lowest, highest = (math.log(speed / shooting.unit) for speed in speeds)
    while len(shots) < MOST_POINTS:
        shot = shots[-1]
        ahead, length = halved_until(partial(_next, shooting, shot, along), length, SHORTEST)
        if ahead is None:  # the last step has passed a bend: on along the tangent
            along = shot.tangent
            ahead, length = halved_until(partial(_next, shooting, shot, along), FIRST, SHORTEST)
        if ahead is None:
            note = f"It could not be followed beyond {shooting.speed_Hz(shot):.4g} Hz: the steps became too short."
            return with_folds(shooting, shots), note
        if observe is not None:
            observe(ahead)
        if not lowest <= ahead.p[1] <= highest:
            limit_speed = speeds[0] if ahead.p[1] < lowest else speeds[1]
            end = shooting.at_speed(shot, ahead, limit_speed)
            if end is None and length > SHORTEST:  # a straight line to it is too far
                length *= 0.5
                continue
            shots += [] if end is None else [*special_shots(shooting, shot, end, asked), end]
            return with_folds(shooting, shots), LEFT
        shots += [*special_shots(shooting, shot, ahead, asked), ahead]
        if shooting.free and ahead.amplitude < SMALL:
            return with_folds(shooting, shots), AT_REST
        if ahead.eccentricity_max.max() > limit:
            note = f"The journal comes nearer to its shell than an eccentricity of {limit}."
            return with_folds(shooting, shots), note
        before, along = along, shooting.direction(shot, ahead)
        straight = float(before @ along)
        if straight > STRAIGHT:
            length = min(LONGER * length, LONGEST)
        elif straight < BENT:
            length *= SHORTER
    return with_folds(shooting, shots), f"It was followed over {MOST_POINTS} cycles and goes on."


def synchronous_shots(
    shooting: Shooting,
    rests: Sequence[Rest],
    speeds: tuple[float, float],
    asked: Sequence[float] = (),
    observe: Callable[[Shot], None] | None = None,
) -> tuple[tuple[Shot, ...], str]:
    """The synchronous motions near static equilibria by falling speed, from the fastest one near which such a motion is
    found both ways, and why they end; the rest as for follow_shots."""
    for rest in reversed(rests):
        start = shooting.with_unbalance(rest)
        if start is None:
            continue
        down, note = follow_shots(shooting, start, speeds, asked, observe)
        if rest is rests[-1]:
            return down, note
        up, end = follow_shots(shooting, replace(start, tangent=-start.tangent), speeds, asked, observe)
        return (*reversed(up[1:]), *down), " ".join(dict.fromkeys((end, note)))
    return (), "No synchronous motion was found near a static equilibrium."


def with_folds(shooting: Shooting, shots: Sequence[Shot]) -> tuple[Shot, ...]:
    """The cycles of a branch with its folds: where its speed turns back by more than places of the cells differ in."""
    speeds = np.array([float(shot.mean_p[1]) for shot in shots])
    blur = np.array([float(shot.blur[1]) for shot in shots])
    folded = list(shots)
    side, extreme = 0, 0  # which way the speed goes, and where it went furthest
    for i in range(1, len(shots)):
        gone = speeds[i] - speeds[extreme]
        if side == 0 or side * gone >= 0.0:
            clear = side != 0 or abs(gone) > CLEAR * max(blur[i], blur[extreme], BLUR)
            side, extreme = (int(np.sign(gone)), i) if clear else (side, extreme)
        elif abs(gone) > CLEAR * max(blur[i], blur[extreme], BLUR):
            folded[extreme] = _fold(shooting, shots[max(extreme - 1, 0) : extreme + 2], shots[extreme], side)
            side, extreme = -side, i
    return tuple(folded)


def _fold(shooting: Shooting, around: Sequence[Shot], furthest: Shot, side: int) -> Shot:
    """The cycle of a few that follow each other at which the branch turns back by its tangents, else the one that went
    furthest; side: 1 if its speed rises before, -1 if it falls."""
    for one, after in itertools.pairwise(around):
        if one.tangent[-1] * after.tangent[-1] < 0.0:
            there = _located(shooting, one, after, lambda shot: float(shot.tangent[-1]))
            furthest = max(furthest, there, key=lambda shot: side * float(shot.mean_p[1]))
            break
    return replace(furthest, kind=FOLD)


def special_shots(shooting: Shooting, shot: Shot, after: Shot, asked: Sequence[float]) -> list[Shot]:
    """Flips, torus points and cycles at speeds asked for within a step."""
    special: list[Shot] = []
    change = abs(after.multipliers.unstable - shot.multipliers.unstable)
    worse = max(shot, after, key=lambda one: one.multipliers.unstable)
    outside = worse.multipliers.others[: worse.multipliers.unstable]
    turning = bool(len(outside)) and abs(outside[-1].imag) > 0.05 * abs(outside[-1])
    if change > 0 and (turning or (bool(len(outside)) and outside[-1].real < 0.0)):
        few = shot.multipliers.unstable
        there = _located(shooting, shot, after, lambda one: 0.5 - float(one.multipliers.unstable != few))
        special.append(replace(there, kind=TORUS if turning else FLIP))
    for speed in asked:
        if min(shot.p[1], after.p[1]) < math.log(speed / shooting.unit) <= max(shot.p[1], after.p[1]):
            there_too = _at_speed(shooting, shot, after, speed)
            special += [] if there_too is None else [replace(there_too, kind=ASKED)]
    return sorted(special, key=lambda one: abs(one.p[1] - shot.p[1]))


def _at_speed(shooting: Shooting, shot: Shot, after: Shot, speed: float) -> Shot | None:
    """The cycle at a speed in rad/s within a step: from its ends, else from one between them that is nearer to it."""
    cycle = shooting.at_speed(shot, after, speed)
    if cycle is None:
        nearer = _located(shooting, shot, after, lambda one: float(one.p[1]) - math.log(speed / shooting.unit))
        cycle = shooting.at_speed(nearer, after if nearer is shot else shot, speed)
    return cycle


def _next(shooting: Shooting, shot: Shot, along: Array, length: float) -> Shot | None:
    ahead = shooting.stepped(shot, length, along)
    return None if ahead is None or shooting.direction(shot, ahead) @ along < SHARPEST else ahead


def _located(shooting: Shooting, shot: Shot, after: Shot, criterion: Callable[[Shot], float]) -> Shot:
    """The cycle within a step at which a number changes its sign: between the ends by halves of the straight line."""
    along = shooting.direction(shot, after)
    length = float(along @ np.concatenate([after.x - shot.x, after.p - shot.p]))
    low, high, at_low, at_high = 0.0, length, criterion(shot), criterion(after)
    best = shot if abs(at_low) < abs(at_high) else after
    for _ in range(REFINED_SMOOTH if shooting.flow.smooth else REFINED):
        share = min(max(at_low / (at_low - at_high), 0.1), 0.9)
        middle = low + share * (high - low)
        there = shooting.stepped(shot, middle, along)
        if there is None:
            break
        value = criterion(there)
        if abs(value) <= abs(criterion(best)):
            best = there
        if value * at_low > 0.0:
            low, at_low = middle, value
        else:
            high, at_high = middle, value
    return best
