"""Errors of cycles by the cells of their films: the same cycles on the fewer cells on which a run is repeated for its
error, found from those on the own ones. The error is extrapolated in the direction in which both have the
more similar number of cells: along the axis 6 cells may leave more of it than 32 around.

The results of a cycle, z = (ln Omega, ln T, largest eccentricities), are compared at its speed. For a fold the cycles
before and behind it are found again, too, each in the plane across the branch: the change of the difference along the
branch shows where the other branch turns back. For a Hopf point the first cycle next to it is found again at its size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.cycles.method.continuation import Unreachable, unit_vector
from frbcli.cycles.method.follower import FOLD
from frbcli.cycles.method.mesh_error import CycleError
from frbcli.cycles.shooting.fixed_point import NOISE, SlowSpace
from frbcli.cycles.shooting.period_map import PeriodMap, period_map
from frbcli.cycles.shooting.shots import Shooting, Shot, both, largest
from frbcli.equilibrium.coefficients import LEAST
from frbcli.equilibrium.static_films import share_of_cells
from frbcli.film.cavitation.law import FRONTS
from frbcli.scene.forms.cells import cells_of
from frbcli.scene.planning.plan import make_plan

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
    """What is known of slow motions, on other cells."""
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
