"""Errors of limit cycles by the mesh of their films: the same cycles and folds are found again on films of another
mesh, from those on the own one, by Newton's method. A share of the difference is the error, as for all static results.

A cycle is compared with the one at the same speed. Next to a fold the other films may have none there: their branch
turns back before. The error is then not known. Folds are compared with each other, in speed, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.cycles.method.balance import Balance
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Unreachable,
    corrected,
    fold_between,
    oriented,
    unit_vector,
)
from frbcli.cycles.method.cycle import FOLD, Cycle, eccentricities, passed_rest
from frbcli.cycles.method.follower import Follower
from frbcli.equilibrium.coefficients import LEAST

Array = NDArray[np.float64]

TAIL_SHARE = 10.0  # of the tail of cycles, which have more harmonics for their multipliers
REACHES = (0.02, 0.1)  # along the branch, within which the fold on the other films is sought
LOCATED = 1e-6  # of it: how closely
STAGES = 4  # from one film to another, where Newton's method does not lead there at once


@dataclass(frozen=True)
class OtherMesh:
    """follower: of branches of the machine on films of another mesh; share: of the difference that is the error."""

    follower: Follower
    share: float


@dataclass(frozen=True)
class CycleError:
    """Expected errors of a cycle by the mesh of the films. speed, frequency: over the pace, that of the speed of folds
    alone; eccentricity: (F,) of the largest ones; all of them NaN if such a cycle was not found on another mesh."""

    speed: float
    frequency: float
    eccentricity: Array


def cycle_error(meshes: Sequence[OtherMesh], cycle: Cycle) -> CycleError:
    """The errors of a cycle: the largest difference to the other meshes times their shares, at least LEAST of each
    number."""
    films = cycle.machine.film_count
    own = np.array([*cycle.y[[-1, -2]], *cycle.eccentricity_max])
    errors = [LEAST * own]
    for mesh in meshes:
        there = _found_again(mesh.follower, cycle)
        if there is None:
            return CycleError(np.nan, np.nan, np.full(films, np.nan))
        machine, y = mesh.follower.machine_at(there.y), mesh.follower.as_cycle(there.y)
        other = np.array([*y[[-1, -2]], *eccentricities(machine, y)])
        errors.append(mesh.share * np.abs(other - own))
    speed, frequency, *eccentricity = np.max(errors, axis=0)
    return CycleError(speed if cycle.kind == FOLD else np.nan, frequency, np.array(eccentricity))


def _found_again(follower: Follower, cycle: Cycle) -> Place | None:
    """The fold on the films of a follower that a fold is there, or the cycle of the same speed; None without one. Films
    that differ much, such as those of two theories, are changed into each other in stages."""
    seek = _fold if cycle.kind == FOLD else _same_speed
    try:
        near = follower.refitted(cycle.place, TAIL_SHARE)
    except Unreachable:
        return None
    if near is None:
        return None
    own, other = Balance(cycle.machine, follower.reference(near)), follower.equations(near)
    for stages in (1, STAGES):
        found: Place | None = near
        for stage in range(1, stages + 1):
            if found is not None:
                before, found = found, seek(_between(own, other, stage / stages), found)
                found = None if found is None or passed_rest(follower.machine, before, found) else found
        if found is not None:
            return found
    return None


def _between(own: Equations, other: Equations, share: float) -> Equations:
    """The equations of films that have a share of others."""
    if share == 1.0:
        return other

    def equations(y: Array) -> tuple[Array, Array]:
        (residual, slope), (new_residual, new_slope) = own(y), other(y)
        return residual + share * (new_residual - residual), slope + share * (new_slope - slope)

    return equations


def _same_speed(equations: Equations, near: Place) -> Place | None:
    upwards = unit_vector(len(near.y))
    found = corrected(equations, near.y, upwards)
    # Both tangents rise in speed; on the other side of a fold that one would lead away from it, this one towards it.
    same_side = found is not None and found.tangent @ oriented(near, upwards).tangent > 0.0
    return found if same_side else None


def _fold(equations: Equations, near: Place) -> Place | None:
    start = corrected(equations, near.y, near.tangent)
    if start is None:
        return None
    for reach in REACHES:
        for along in (near.tangent, -near.tangent):
            found = fold_between(equations, oriented(start, along), reach, LOCATED)
            if found is not None:
                return found
    return None
