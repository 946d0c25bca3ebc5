"""Errors of limit cycles by the mesh of their films: the same cycles and folds are found again on films of another
mesh, from those on the own one, by Newton's method. A share of the difference is the error, as for all static results.

A cycle is compared with the one at the same speed, or value of the number that the branch goes over. Next to a fold the
other films may have none there: their branch turns back before. The error is then not known. Folds are compared with
each other, in this number, too. The error of a Hopf point follows from the eigenvalues of the static equilibrium of the
other films at its value, and from how the eigenvalue changes with the number. """

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Unreachable,
    corrected,
    fold_between,
    oriented,
    unit_vector,
)
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.equilibria import HopfPoint, settled
from frbcli.cycles.method.follower import FOLD, Cycle, Follower, eccentricities, passed_rest
from frbcli.cycles.method.machine import Machine
from frbcli.equilibrium.coefficients import LEAST
from frbcli.equilibrium.static_films import other_plans, share_of_cells
from frbcli.film.grid import Mesh
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.planned import Plan

UNKNOWN = "Hopf points, folds and cycles have no errors by the mesh:"
# Of tables made from solutions on cells: how many more of these each way; and the share of the difference to half as
# many nodes that is the error of splines, at least of second order where the edge of the cavity crosses them.
MORE, SPLINES = 4.0 / 3.0, 1.0 / 3.0


@dataclass(frozen=True)
class OtherFilms:
    """Films on another mesh. plan: of the machine with them; share: of the difference that is the error; halved:
    whether their tables have every other node alone."""

    plan: Plan
    share: float
    halved: bool = False

    def system(self, case: Case) -> System:
        """The machine of a case with these films."""
        made = make_system(case, self.plan)
        return replace(made, films=made.films.with_half_the_nodes()) if self.halved else made


def other_films(plan: Plan) -> tuple[OtherFilms, ...]:
    """Other films of a plan; none of openings that turn, whose tables would cost more than the diagram."""
    if plan.form.table_of_solutions:
        mesh = plan.mesh
        finer = Mesh(round(MORE * mesh.axial), round(MORE * mesh.circumferential))
        share = abs(share_of_cells((finer.circumferential, finer.axial), (mesh.circumferential, mesh.axial)))
        return OtherFilms(replace(plan, mesh=finer), share), OtherFilms(plan, SPLINES, halved=True)
    if plan.form.fine_when_static:
        return ()
    return tuple(OtherFilms(*other) for other in other_plans(plan))


def why_no_error(plan: Plan) -> str:
    """Why cycles of a plan have no errors, a sentence; empty if they have some."""
    if other_films(plan):
        return ""
    return f"{UNKNOWN} means over the angle of openings that turn are tabulated, and others would cost as much."


Seek = Callable[[Equations, Place], Place | None]

TAIL_SHARE = 10.0  # of the tail of cycles, which have more harmonics for their multipliers
REACHES = (0.02, 0.1)  # along the branch, within which the fold on the other films is sought
LOCATED = 1e-5  # of it: how closely
STAGES = 4  # from one film to another, where Newton's method does not lead there at once
AHEAD = 1e-3  # of the value of a Hopf point, for the derivative of its eigenvalue


@dataclass(frozen=True)
class OtherMesh:
    """The machine on films of another mesh. follower: of its branches, along its course; share: of the difference that
    is the error."""

    follower: Follower
    share: float


@dataclass(frozen=True)
class CycleError:
    """Expected errors of a cycle by the mesh or the cells of its films. value: of the number that its branch goes over,
    of folds alone, and frequency: both relative; eccentricity: (F,) of the largest ones; all of them NaN if such a
    cycle was not found on another mesh."""

    value: float
    frequency: float
    eccentricity: Array


def cycle_error(own: Follower, meshes: Sequence[OtherMesh], cycle: Cycle) -> CycleError:
    """The errors of a cycle: the largest difference to the other meshes times their shares, at least LEAST of each
    number. own: the follower of its branch."""
    here = np.array([*cycle.place.y[[-1, -2]], *cycle.eccentricity_max])
    errors = [LEAST * here]
    for place in _found_again(own, [mesh.follower for mesh in meshes], cycle):
        if place is None:
            return CycleError(np.nan, np.nan, np.full(cycle.machine.film_count, np.nan))
        there = np.array([*place.y[[-1, -2]], *eccentricities(cycle.machine, place.y)])
        errors.append(meshes[len(errors) - 1].share * np.abs(there - here))
    value, frequency = np.max(errors, axis=0)[:2] / here[:2]
    eccentricity = np.max(errors, axis=0)[2:]
    return CycleError(float(value) if cycle.kind == FOLD else np.nan, float(frequency), eccentricity)


def hopf_error(own: MachineCourse, meshes: Sequence[OtherMesh], hopf: HopfPoint) -> tuple[float, float]:
    """The errors of a Hopf point: of the value of its course and of its frequency in rad/s, NaN if another mesh has no
    static equilibrium there. To first order in the eigenvalues on the other meshes."""
    value = hopf.equilibrium.value
    errors = [(LEAST * value, LEAST * hopf.nu)]
    try:
        slope = (_whirl(own, hopf, (1.0 + AHEAD) * value) - 1j * hopf.nu) / (AHEAD * value)
        for mesh in meshes:
            apart = _whirl(mesh.follower.course, hopf, value) - 1j * hopf.nu
            further = -apart.real / slope.real
            errors.append((mesh.share * abs(further), mesh.share * abs(apart.imag + slope.imag * further)))
    except Unreachable:
        return np.nan, np.nan
    values, frequencies = zip(*errors, strict=True)
    return max(values), max(frequencies)


def _whirl(course: MachineCourse, hopf: HopfPoint, value: float) -> complex:
    """The eigenvalue in 1/s of the whirl of a Hopf point where a course rests at a value. Raises Unreachable."""
    values = settled(course, hopf.equilibrium.u, value).eigenvalues
    return complex(values[np.argmin(np.abs(values - 1j * hopf.nu))])


def _found_again(own: Follower, followers: Sequence[Follower], cycle: Cycle) -> Iterator[Place | None]:
    """The fold on the films of each follower that a fold is there, or the cycle of the same speed; None without one.
    own: the follower of its branch."""
    near = own.refitted(cycle.place, TAIL_SHARE) or cycle.place
    if cycle.kind == FOLD:
        here = own.equations_near(near)
        yield from (_in_stages(_fold, here, each.equations_near(near), near, cycle.machine) for each in followers)
    else:
        here = own.equations_at(near)
        near = _with_side(here, near)
        yield from (_in_stages(_same_speed, here, each.equations_at(near), near, cycle.machine) for each in followers)


def _in_stages(seek: Seek, here: Equations, there: Equations, near: Place, machine: Machine) -> Place | None:
    """The sought place on other films. Films that differ much, such as films of two theories, are changed into each
    other in stages."""
    for stages in (1, STAGES):
        place: Place | None = near
        for stage in range(1, stages + 1):
            if place is not None:
                before, place = place, seek(_between(here, there, stage / stages), place)
                place = None if place is None or passed_rest(machine, before, place) else place
        if place is not None:
            return place
    return None


def _between(own: Equations, other: Equations, share: float) -> Equations:
    """The equations of films that have a share of others."""
    if share == 1.0:
        return other

    def equations(y: Array) -> tuple[Array, Array]:
        (residual, slope), (new_residual, new_slope) = own(y), other(y)
        return residual + share * (new_residual - residual), slope + share * (new_slope - slope)

    return equations


def _with_side(equations: Equations, place: Place) -> Place:
    """The place with the sign of the determinant that belongs to the plane in which the last unknown stays: another one
    on the other side of a fold."""
    _, slope = equations(place.y)
    return replace(place, side=int(np.linalg.slogdet(slope[:, :-1])[0]))


def _same_speed(equations: Equations, near: Place) -> Place | None:
    place = corrected(equations, near.y, unit_vector(len(near.y)))
    return place if place is not None and place.side == near.side else None


def _fold(equations: Equations, near: Place) -> Place | None:
    start = corrected(equations, near.y, near.tangent)
    if start is None:
        return None
    for reach in REACHES:
        for along in (near.tangent, -near.tangent):
            fold = fold_between(equations, oriented(start, along), reach, LOCATED)
            if fold is not None:
                return fold
    return None
