"""Branches of limit cycles found by shooting (shots.py), followed by their arc length in speed, with their special
points: folds, flips and torus points.

Errors of cycles by the cells of their films: the same cycles on the fewer cells on which a run is repeated for its
error, found from those on the own ones. The error is extrapolated in the direction in which both have the
more similar number of cells: along the axis 6 cells may leave more of it than 32 around.

The results of a cycle, z = (ln Omega, ln T, largest eccentricities), are compared at its speed. For a fold the cycles
before and behind it are found again, too, each in the plane across the branch: the change of the difference along the
branch shows where the other branch turns back. For a Hopf point the first cycle next to it is found again at its size.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.cycles.branch import AT_REST, LEFT
from frbcli.cycles.method.continuation import Unreachable, halved_until, unit_vector
from frbcli.cycles.method.follower import ASKED, FLIP, FOLD, TORUS, CycleError
from frbcli.cycles.shooting.fixed_point import NOISE, SlowSpace
from frbcli.cycles.shooting.period_map import PeriodMap, period_map
from frbcli.cycles.shooting.shots import Rest, Shooting, Shot, both, largest
from frbcli.equilibrium.linearised import LEAST
from frbcli.equilibrium.static_films import share_of_cells
from frbcli.film.cavitation.law import FRONTS
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.tilted import cells_of

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


RESOLVED = 0.5  # length of a slow motion of length 1 on other cells from which on they resolve it
NEIGHBOURS = 0.5  # of the error of a neighbour: differences may change their sign between both
UPWIND = 1.0  # order in which gas that oil carries becomes exact with smaller cells
SPREAD = 0.5  # of what places of the cells differ by: the least error


@dataclass(frozen=True)
class OtherCells:
    """The machine on other cells (around, along). share: of the difference that is the error."""

    shooting: Shooting
    cells: tuple[int, int]
    share: float


def other_cells(case: Case, shooting: Shooting) -> OtherCells | None:
    """The machine of a case on fewer cells; None where there are too few for that."""
    plan = make_plan(case)
    cells = plan.form.fewer_cells(case, plan)
    if cells is None:
        return None
    own, order = cells_of(plan), UPWIND if len(shooting.flow.system.films.gas_contents) else FRONTS
    share = max(share_of_cells(cells, own, order), share_of_cells(cells[::-1], own[::-1], order))
    return OtherCells(Shooting(period_map(case, cells), shooting.unit), cells, share)


def threshold_errors(own: Shooting, other: OtherCells, first: Shot) -> tuple[float, float]:
    """Relative errors of speed and frequency of a Hopf point by the cells of its films: the differences of the first
    cycle next to it, at its size; NaN if that is not found on other cells. Growth at rest scatters more."""
    speed, frequency, *_ = other.share * np.abs(_again(own, other, first, first.tangent) - _own(own, first))
    return float(speed), float(frequency)


def shot_errors(own: Shooting, other: OtherCells, shots: Sequence[Shot]) -> tuple[CycleError, ...]:
    """The errors of the cycles of a branch in their order; at folds at least NEIGHBOURS times the neighbours'
    errors."""
    shot_error = [
        _fold_error(own, other, shots[i - 1 : i + 2]) if shot.kind == FOLD else _cycle_error(own, other, shot)
        for i, shot in enumerate(shots)
    ]
    cycles = [i for i, shot in enumerate(shots) if shot.kind != FOLD]
    errors = np.array([[shot_error[i].frequency, *shot_error[i].eccentricity] for i in cycles])
    neighbours = np.fmax(np.roll(errors, 1, axis=0), np.roll(errors, -1, axis=0))[1:-1]
    errors[1:-1] = np.maximum(errors[1:-1], np.nan_to_num(NEIGHBOURS * neighbours))
    for i, (frequency, *eccentricity) in zip(cycles, errors, strict=True):
        shot_error[i] = CycleError(np.nan, frequency, np.array(eccentricity))
    return tuple(shot_error)


def _cycle_error(own: Shooting, other: OtherCells, shot: Shot) -> CycleError:
    there = _again(own, other, shot, unit_vector(len(shot.x) + 2))
    return _error(own, shot, there - _own(own, shot), other.share)


def _fold_error(own: Shooting, other: OtherCells, around: Sequence[Shot]) -> CycleError:
    """around: the cycle before a fold, the fold and the one behind it."""
    before, fold, behind = around
    along = own.direction(before, behind)
    at = np.array([along @ np.concatenate([shot.x - fold.x, shot.p - fold.p]) for shot in around])
    here = np.array([_own(own, shot) for shot in around])
    apart = np.array([_again(own, other, shot, along) for shot in around]) - here
    return _error(own, fold, _turned(at, here - here[1], apart), other.share)


def _again(own: Shooting, other: OtherCells, shot: Shot, held: Array) -> Array:
    """z on other cells in the plane through a cycle across a direction (N + 2,); NaN where no cycle is found there."""
    flow, twin, size = own.flow, other.shooting, len(shot.x)
    try:
        near = flow.wet_on(twin.flow, shot.wet, math.exp(shot.mean_p[1]) * own.unit)
    except Unreachable:
        return np.full(len(_own(own, shot)), np.nan)
    across = np.append(flow.states_on(twin.flow, held[:size, None])[:, 0], held[size:])
    conditions = both(twin.held(near), across)
    cycles = twin.again(near, shot.mean_p, _space_on(own, other, shot.space), conditions, shot.steps, NOISE)
    return _mean(twin.flow, cycles) if cycles else np.full(len(_own(own, shot)), np.nan)


def _space_on(own: Shooting, other: OtherCells, space: SlowSpace) -> SlowSpace:
    """Slow subspace interpolated to another mesh."""
    states, images, by_parameters = (
        own.flow.states_on(other.shooting.flow, each) for each in (space.states, space.images, space.by_parameters)
    )
    left, sizes, right = np.linalg.svd(states, full_matrices=False)
    kept = sizes > RESOLVED
    return SlowSpace(left[:, kept], images @ (right[kept].T / sizes[kept]), by_parameters)


def _turned(at: Array, z: Array, apart: Array) -> Array:
    """Largest difference of z between two folds, the first of which lies at the length 0: its branch is z (3, n) at
    lengths (3,), with no slope of the first number there, the other one differs by `apart` (3, n), which grows as on
    one side of the fold; NaN if that does not turn back between them."""
    ends = at[[0, 2]]
    bend = np.linalg.solve(np.column_stack([ends**2, ends**3]), z[[0, 2], 0])[0]
    _, along, _ = np.linalg.solve(np.vander(at, increasing=True), z)
    slopes = (apart[[0, 2]] - apart[1]) / ends[:, None]
    turns = -0.5 * slopes[:, :1] / bend
    apart_at = apart[1] + turns * (along + slopes)
    apart_at[:, 0] = apart[1, 0] + 0.5 * turns[:, 0] * slopes[:, 0]
    between = (at.min() <= turns) & (turns <= at.max())
    return np.asarray(np.where(between.all(), np.abs(apart_at).max(axis=0), np.nan))


def _error(own: Shooting, shot: Shot, apart: Array, share: float) -> CycleError:
    """apart: z on other cells less z."""
    spread = np.ptp([_quantities(own.flow, *each) for each in _places(shot)], axis=0)
    least = np.maximum(SPREAD * spread, LEAST * np.array([1.0, 1.0, *_own(own, shot)[2:]]))
    speed, frequency, *eccentricity = np.maximum(share * np.abs(apart), least)
    return CycleError(speed if shot.kind == FOLD else np.nan, frequency, np.array(eccentricity))


def _own(own: Shooting, shot: Shot) -> Array:
    return _mean(own.flow, _places(shot))


def _places(shot: Shot) -> list[tuple[Array, Array]]:
    return [(shot.p, shot.displacements), *shot.others]


def _mean(flow: PeriodMap, places: Sequence[tuple[Array, Array]]) -> Array:
    """z, the mean over places of the cells."""
    return np.asarray(np.mean([_quantities(flow, *each) for each in places], axis=0))


def _quantities(flow: PeriodMap, p: Array, displacements: Array) -> Array:
    return np.array([p[1], p[0], *largest(flow.middles(displacements))])
