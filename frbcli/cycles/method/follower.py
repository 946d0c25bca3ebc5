"""A limit cycle on its branch, how large it is and how many harmonics it has; and what follows it along a course: the
equations about a place of a branch, as many harmonics as its cycles need, their multipliers, and steps and folds.

Harmonics are added where the next ones would be larger than a tolerance, and left out where the last ones are much
smaller.

Errors of limit cycles by the mesh of their films: the same cycles and folds are found again on films of another
mesh, from those on the own one, by Newton's method. A share of the difference is the error, as for all static results.

A cycle is compared with the one at the same speed, or value of the number that the branch goes over. Next to a fold the
other films may have none there: their branch turns back before. The error is then not known. Folds are compared with
each other, in this number, too. The error of a Hopf point follows from the eigenvalues of the static equilibrium of the
other films at its value, and from how the eigenvalue changes with the number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.cycles.method.balance import (
    HELPS,
    TRIVIAL,
    Balance,
    Multipliers,
    left_out,
    moments,
    motion_along,
    multipliers,
    unpacked,
)
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Unreachable,
    corrected,
    fold_between,
    oriented,
    step_from,
    unit_vector,
)
from frbcli.cycles.method.equilibria import MOST_UNKNOWNS, EquationsOf, HopfPoint, MachineCourse, settled
from frbcli.cycles.method.machine import Machine
from frbcli.equilibrium.linearised import LEAST
from frbcli.equilibrium.static_films import other_plans, share_of_cells
from frbcli.film.grid import Mesh
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.film_choice import Plan

FIRST_HARMONICS = 5  # of a cycle of no size
MOMENTS = 256  # of a period at which eccentricities are taken
FOLD, FLIP, TORUS, HOPF = "fold", "flip", "torus", "hopf"
ASKED = "asked"  # a cycle at a speed that was asked for
MOST_HARMONICS = 80
REFITS = 4  # of a fold with more harmonics
TAIL = (1e-7, 1e-6)  # of one film, of several: what the harmonics left out may have of the clearance
SPARE = 0.1  # of it: what the last harmonics have where there are too many
LOOSE = 10.0  # times it: what may be left out with the most harmonics, as by a film that nearly rests for a moment
NARROWER = 0.6  # share of the smallest gap that one step may leave
NOTHING = 1e-9  # amplitude over the clearance of a cycle that is none


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


def with_harmonics(vector: Array, c: int, harmonics: int, numbers: int = 2) -> Array:
    """Unknowns of a cycle with other harmonics, new ones zero. numbers: how many stand behind them, frequency, speed
    and what else."""
    body = np.zeros(c * (2 * harmonics + 1))
    kept = min(len(body), len(vector) - numbers)
    body[:kept] = vector[:kept]
    return np.concatenate([body, vector[-numbers:]])


def resized(place: Place, c: int, harmonics: int) -> Place:
    """The place with other harmonics, new ones zero; as it was found."""
    tangent = with_harmonics(place.tangent, c, harmonics)
    return replace(place, y=with_harmonics(place.y, c, harmonics), tangent=tangent / np.linalg.norm(tangent))


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
    """The largest eccentricity of all films on the cycle y."""
    return float(eccentricities(machine, y).max())


def amplitude(machine: Machine, y: Array) -> float:
    """Size over the clearance of what is not the mean of the cycle."""
    motion = unpacked(y[:-2], machine.size)[1:, : 2 * machine.film_count]
    return float(2.0 * np.abs(motion).max(initial=0.0))


def passed_rest(machine: Machine, before: Place, after: Place) -> bool:
    """Whether the cycle has shrunk to rest between two places: behind it the branch comes back."""
    one, other = (unpacked(place.y[:-2], machine.size)[1] for place in (before, after))
    return bool(np.sum(np.conj(one) * other).real < 0.0)


class Follower:
    """Branches over a course between two shares. asked: shares at which cycles are computed exactly; free: whether
    motions are whirls, which may shrink to rest; tail: see TAIL; tail_of_folds: share of the tail that folds may
    have."""

    free = True
    tail = TAIL
    tail_of_folds = 1.0

    def __init__(self, course: MachineCourse, lowest: float, highest: float = 1.0, asked: Sequence[float] = ()) -> None:
        self.course, self.machine = course, course.top
        self.range, self.asked = (lowest, highest), tuple(asked)

    def cycle(self, place: Place, kind: str = "", near: Cycle | None = None) -> Cycle:
        """A point of the branch with its results. near: one close by."""
        spectrum = self.multipliers(place, None if near is None else near.multipliers.relaxed)
        halved = True  # whether finer intervals have been tried
        while spectrum.defect > TRIVIAL:
            finer = self.with_more(place, self.course.most_at_fold if kind == FOLD else MOST_UNKNOWNS)
            if finer is None:
                spectrum = spectrum if halved else self.multipliers(place, spectrum)
                break
            enough = HELPS * spectrum.defect
            place, spectrum = finer, self.multipliers(finer, spectrum, enough)
            halved = spectrum.defect > enough
        machine, y = self.course.machine(place.y), self.course.with_speed(place.y)
        return Cycle(place, machine, y, eccentricities(machine, y), spectrum, kind)

    def multipliers(self, place: Place, near: Multipliers | None = None, enough: float = TRIVIAL) -> Multipliers:
        """Multipliers of the cycle at a place. near, enough: see balance.py."""
        machine, y = self.course.machine(place.y), self.course.with_speed(place.y)
        fast = self.fast_multipliers(machine, y, near, max(TRIVIAL, enough))
        if not self.moves(y):
            return fast
        motion = self.motion(place)
        size = len(y) - (1 if self.free else 2)
        return self.course.multipliers(fast, y, lambda machine: motion(machine)(y)[1][:size, :size])

    def fast_multipliers(self, machine: Machine, y: Array, near: Multipliers | None, enough: float) -> Multipliers:
        """Multipliers of a cycle y while its machine stays. near, enough: see balance.py."""
        return multipliers(machine, self.course.states(machine), y, near, enough)

    def motion(self, place: Place) -> EquationsOf:
        """The equations of the cycles of a machine about a place."""
        return partial(Balance, reference=self.reference(place))

    def equations(self, place: Place) -> Equations:
        """Equations of the cycles about a place, over the number."""
        return self.course.equations(self.motion(place), place.y)

    def equations_at(self, place: Place) -> Equations:
        """Equations of the cycles about a place at its number, see MachineCourse."""
        return self.course.equations_at(self.motion(place), place.y)

    def equations_near(self, place: Place) -> Equations:
        """Equations of the cycles about a place next to its number, see MachineCourse."""
        return self.course.equations_near(self.motion(place), place.y)

    def reference(self, place: Place) -> Complex:
        """The motion that the phase of cycles about a place is compared with."""
        moving = self.moves(place.y)  # at a Hopf point only the tangent has a phase
        return unpacked((place.y if moving else place.tangent)[:-2], self.machine.size)

    def moves(self, y: Array) -> bool:
        """Whether the unknowns y are more than rest."""
        return amplitude(self.machine, y) > NOTHING

    def entered(self, y: Array, last: float) -> Place | None:
        """The cycle y with the last unknown `last` as a place of the branch, which rises in it; None if it is none."""
        along = unit_vector(len(y))
        there = np.append(y[:-1], last)
        return corrected(self.equations(Place(there, along)), there, along)

    def with_more(self, place: Place, most: tuple[int, int]) -> Place | None:
        """The place with half as many harmonics more, None if those are too many. most: see MOST_UNKNOWNS."""
        c, harmonics = self.machine.size, (len(place.y) - 2) // self.machine.size // 2
        more = resized(place, c, harmonics + harmonics // 2)
        if len(more.y) > most[self.machine.film_count > 1]:
            return None
        finer = corrected(self.equations(more), more.y, more.tangent)
        return None if finer is None else oriented(finer, more.tangent)

    def refitted(self, place: Place, share: float = 1.0) -> Place | None:
        """The place with as many harmonics as it needs for a share of the tail; None if that does not converge, or if
        they are too many."""
        c, allowed = self.machine.size, share * self.tail[self.machine.film_count > 1]
        for _ in range(12):
            harmonics = (len(place.y) - 2) // c // 2
            tail = left_out(self.course.machine(place.y), self.course.with_speed(place.y))
            motion = unpacked(place.y[:-2], c)
            if tail < allowed:
                used = np.flatnonzero(np.abs(motion).max(axis=1) > SPARE * allowed)
                wanted = max(FIRST_HARMONICS, int(used[-1]) + 2)
                return place if wanted >= harmonics else resized(place, c, wanted)
            if harmonics >= MOST_HARMONICS:
                return place if tail < LOOSE * allowed else None
            place = resized(place, c, min(MOST_HARMONICS, harmonics + max(2, harmonics // 3)))
            solved = corrected(self.equations(place), place.y, place.tangent)
            if solved is None or solved.side * place.side < 0:  # of another part of the branch that passes close by
                return None
            place = oriented(solved, place.tangent)
        return None

    def as_fine(self, place: Place, other: Place) -> Place:
        """The place with as many harmonics as another, taken anew: on which side of the curve a place lies, by the sign
        of a determinant, is not the same with more of them."""
        near = resized_like(place, other, self.machine.size)
        renewed = place if near is place else corrected(self.equations(near), near.y, near.tangent)
        return near if renewed is None else oriented(renewed, near.tangent)

    def fold(self, place: Place, length: float) -> Place | None:
        """The refitted fold within a step from a place."""
        fold = None
        for _ in range(REFITS):
            fold = fold_between(self.equations(place), place, length)
            fitted = None if fold is None else self.refitted(fold, self.tail_of_folds)
            if fold is None or fitted is None or len(fitted.y) <= len(place.y):
                break
            place = self.as_fine(place, fitted)
        return fold

    def stepped(self, place: Place, length: float) -> Place | None:
        """The refitted place behind a step."""
        narrow = 1.0 - largest(self.machine, place.y + length * place.tangent)
        if narrow < NARROWER * (1.0 - largest(self.machine, place.y)):
            return None
        ahead = step_from(self.equations(place), place, length)
        return None if ahead is None else self.refitted(oriented(ahead, place.tangent))


class FoldFollower(Follower):
    """Follows branches whose folds alone are asked for: without multipliers, the larger part of the cost, and with few
    harmonics up to the fold."""

    tail = (1e-5, 1e-5)
    tail_of_folds = 1e-2

    def multipliers(self, _place: Place, _near: Multipliers | None = None, _enough: float = 0.0) -> Multipliers:
        """The trivial one alone, (1,), with no defect: none are computed."""
        return Multipliers(np.ones(1, dtype=complex), 0.0)


def at_speed(follower: Follower, place: Place, beyond: Place, speed: float) -> Place | None:
    """The cycle at a speed over the pace between two."""
    near = resized_like(place, beyond, follower.machine.size)
    share = (speed - near.y[-1]) / (beyond.y[-1] - near.y[-1])
    guess = near.y + share * (beyond.y - near.y)
    there = corrected(follower.equations(beyond), guess, unit_vector(len(guess)))
    return None if there is None else oriented(there, beyond.tangent)


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
