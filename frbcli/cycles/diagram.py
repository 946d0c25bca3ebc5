"""From static equilibria and their Hopf points to a whole diagram, over the speed or another number of the case.

A course without a Hopf point, whose rotor whirls at all of its values, needs a cycle to begin with. Springs and
dashpots act parallel to its films (machine.py) in the share a. With enough of them the rotor rests; as a falls a whirl
is born at a Hopf point in a, and its cycles are followed to a = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.cycles.branch import LEFT, Branch, first_place, follow_branch
from frbcli.cycles.columns import (
    SUBCRITICAL,
    SUPERCRITICAL,
    Cost,
    CycleBranch,
    CyclePoint,
    LimitCycles,
    RestingPoint,
    SpecialPoint,
    hertz,
)
from frbcli.cycles.method.balance import loads_along, unpacked
from frbcli.cycles.method.continuation import (
    Place,
    Strides,
    Unreachable,
    follow,
    oriented,
    reached,
    unit_vector,
)
from frbcli.cycles.method.equilibria import (
    Changing,
    Equilibrium,
    HopfPoint,
    Lyapunov,
    MachineCourse,
    Resting,
    equations,
    equilibrium,
    hopf_points,
    lyapunov_coefficient,
)
from frbcli.cycles.method.follower import (
    FLIP,
    FOLD,
    HOPF,
    TORUS,
    Cycle,
    CycleError,
    FoldFollower,
    Follower,
    OtherMesh,
    cycle_error,
    hopf_error,
)
from frbcli.cycles.method.machine import Machine
from frbcli.scene.films import film_places

RISE = Strides(first=0.02, shortest=1e-6, longest=0.2, points=400)
MOST = 50.0  # share up to which springs and dashpots are added
Observer = Callable[[int, float, float], None]

SAME = 0.02  # relative: a branch that ends at rest at this distance from a Hopf point ends in it


class _WithoutMultipliers(FoldFollower):
    """Follows cycles as closely as for a diagram, but without multipliers and past folds."""

    tail = Follower.tail

    def fold(self, _place: Place, _length: float) -> Place | None:
        """None: folds on the way are not located."""
        return None


def _stiffened(machine: Machine, share: float) -> Machine:
    """A machine with a share of its springs and dashpots parallel to the films."""
    rotor, (damping, stiffness) = machine.rotor, machine.held_up
    return replace(
        machine,
        rotor=replace(
            rotor,
            damping=rotor.damping + share * (damping - rotor.damping),
            stiffness=rotor.stiffness + share * (stiffness - rotor.stiffness),
        ),
    )


def seed_cycle(resting: Equilibrium) -> Array | None:
    """A cycle, see balance.py, at the speed of an unstable static equilibrium; None if none was found."""
    course = Changing(partial(_stiffened, resting.machine), resting.omega)
    try:
        hopf = _stabilised(course, resting)
    except Unreachable:
        return None
    if hopf is None:
        return None
    cycles = follow_branch(_WithoutMultipliers(course, 0.0, MOST), first_place(hopf)).cycles
    return cycles[-1].y if cycles and abs(cycles[-1].place.y[-1]) < 1e-12 else None


def _stabilised(course: Changing, resting: Equilibrium) -> HopfPoint | None:
    """The Hopf point in a above which nothing grows. Raises Unreachable."""
    asked, along = course.equations(equations), unit_vector(len(resting.u) + 1)
    start = reached(asked, np.append(resting.u, 0.0), along)
    low = equilibrium(course, start)
    for place, _ in follow(asked, start, RISE):
        high = equilibrium(course, place)
        if high.growth_of(0) < 0.0:
            crossings = hopf_points(course, (low, high))
            return crossings[-1] if crossings else None
        if high.value > MOST:
            return None
        low = high
    return None


@dataclass
class CycleCount:
    """Counts cycles and passes number, value and largest eccentricity to an observer."""

    observe: Observer | None
    count: int = 0

    def __call__(self, value: float, eccentricity_max: Array) -> None:
        """Count a cycle, and report its place and eccentricities."""
        self.count += 1
        if self.observe is not None:
            self.observe(self.count, value, float(eccentricity_max.max()))


@dataclass(frozen=True)
class Walk:
    """What a diagram is computed of: the static equilibria along the course of a follower, which follows the branches;
    meshes: others, for the errors of cycles; unknown: why there are none."""

    resting: Resting
    follower: Follower
    meshes: tuple[OtherMesh, ...] = ()
    unknown: str = ""

    @property
    def course(self) -> MachineCourse:
        """What the diagram goes over."""
        return self.follower.course

    def value(self, motion: Cycle | Equilibrium) -> float:
        """The number of a cycle or a static equilibrium, in its unit."""
        share = motion.value if isinstance(motion, Equilibrium) else float(motion.place.y[-1])
        return share * self.course.scale


def diagram(case: Case, walk: Walk, observe: Observer | None, cpu: Callable[[], float]) -> LimitCycles:
    """The branches of all Hopf points of a walk. observe: see limit_cycles; cpu: gives the CPU time so far in s."""
    resting, course, count = walk.resting, walk.course, CycleCount(observe)

    def record(cycle: Cycle) -> None:
        count(walk.value(cycle), cycle.eccentricity_max)

    branches: list[Branch | None] = []
    for number, hopf in enumerate(resting.hopf):
        known = any(branch is not None and _ends_in(walk, branch, hopf) for branch in branches[:number])
        branches.append(None if known else follow_branch(walk.follower, first_place(hopf), record))
    followed: list[tuple[int | None, Branch]] = [(i, branch) for i, branch in enumerate(branches) if branch is not None]
    numbers = {hopf: number for number, (hopf, _) in enumerate(followed)}
    notes = [resting.note, *_notes(case, walk)]
    if not any(point.stable for point in resting.points) and not resting.hopf:
        seeded = _seeded(walk, record)
        followed += [] if seeded is None else [(None, seeded)]
    special = [hopf_special(walk, hopf, numbers.get(i)) for i, hopf in enumerate(resting.hopf)]
    grown = tuple(
        CycleBranch(hopf, tuple(point_of(walk, cycle) for cycle in branch.cycles), branch.note)
        for hopf, branch in followed
    )
    notes += [_uncertain(walk, point) for point in special_cycles(grown) if point.certain is False]
    return LimitCycles(
        case=case,
        over=course.over,
        unit=course.unit,
        films=walk.follower.machine.names,
        equilibria=tuple(_resting(walk, point) for point in resting.points),
        branches=grown,
        special=(*special, *special_cycles(grown)),
        notes=tuple(filter(None, notes)),
        cost=Cost(cpu(), count.count),
    )


def special_cycles(branches: Sequence[CycleBranch], response: Sequence[CyclePoint] = ()) -> Iterator[SpecialPoint]:
    """The folds, flips and torus points of branches, and the folds of the synchronous response."""
    numbered: list[tuple[int | None, CyclePoint]] = [
        (number, point) for number, branch in enumerate(branches) for point in branch.points
    ]
    for number, point in [*numbered, *((None, point) for point in response if point.kind == FOLD)]:
        if point.kind in (FOLD, FLIP, TORUS):
            yield SpecialPoint(
                kind=point.kind,
                branch=number,
                value=point.value,
                speed_Hz=point.speed_Hz,
                frequency_Hz=point.frequency_Hz,
                eccentricity_max=point.eccentricity_max,
                value_uncertainty=point.value_uncertainty,
                frequency_uncertainty_Hz=point.frequency_uncertainty_Hz,
                eccentricity_max_uncertainty=point.eccentricity_max_uncertainty,
                certain=_certain(point),
                synchronous=number is None,
            )


def _certain(point: CyclePoint) -> bool | None:
    """Whether a fold was found on films of another mesh, too; None of other cycles and where it was not sought."""
    sought = point.kind == FOLD and point.eccentricity_max_uncertainty is not None
    return math.isfinite(point.value_uncertainty) if sought else None


def _uncertain(walk: Walk, point: SpecialPoint) -> str:
    """Notes on folds that were not found on films of another mesh."""
    at = f"{point.value:.4g} {walk.course.unit}".rstrip()
    return f"The fold at {at} is uncertain: it was not found with the same films on another mesh."


def with_hopf_errors(computed: LimitCycles, walk: Walk) -> LimitCycles:
    """The diagram with the errors of its Hopf points by the other meshes of the walk."""
    hopf = [
        _with_hopf_error(walk, point, begin) for point, begin in zip(computed.of(HOPF), walk.resting.hopf, strict=True)
    ]
    return replace(computed, special=(*hopf, *computed.special[len(hopf) :]))


def _with_hopf_error(walk: Walk, point: SpecialPoint, hopf: HopfPoint) -> SpecialPoint:
    value, frequency = hopf_error(walk.course, walk.meshes, hopf) if walk.meshes else (math.nan, math.nan)
    return replace(
        point,
        value_uncertainty=value * walk.course.scale,
        frequency_uncertainty_Hz=hertz(frequency),
    )


def with_response(computed: LimitCycles, walk: Walk, response: Branch | None) -> LimitCycles:
    """The diagram with the synchronous response."""
    if response is None:
        return replace(computed, notes=(*computed.notes, "No synchronous response was found at the highest speed."))
    points = tuple(_cycle(walk, cycle) for cycle in response.cycles)
    cost = replace(computed.cost, cycles=computed.cost.cycles + len(points))
    if not response.note.startswith(LEFT):
        computed = replace(computed, notes=(*computed.notes, f"Synchronous response: {response.note}"))
    return replace(computed, synchronous=points, special=(*computed.special, *special_cycles((), points)), cost=cost)


def _notes(case: Case, walk: Walk) -> list[str]:
    """Notes on feed holes, and where no whirl begins."""
    points, notes = walk.resting.points, [walk.unknown]
    if any(place.geometry.supply.turns for place in film_places(case)):
        notes.append("Feed holes that turn with a ring enter by their mean over the angle.")
    between = f"{walk.value(points[0]):.4g} and {walk.value(points[-1]):.4g} {walk.course.unit}".rstrip()
    if walk.resting.hopf:
        return notes
    if all(point.stable for point in points):
        notes.append(f"No whirl begins between {between}: every small motion decays there.")
    elif not any(point.stable for point in points):
        notes.append(f"The static equilibrium is unstable between {between}: the whirl begins outside of the range.")
    else:
        notes.append(f"No whirl begins between {between}.")
    return notes


def _seeded(walk: Walk, record: Callable[[Cycle], None]) -> Branch | None:
    """The branch through a cycle that no Hopf point in the range leads to, from its low to its high end."""
    points = walk.resting.points
    for resting in (points[len(points) // 2], points[0], points[-1]):
        y = seed_cycle(resting)
        place = None if y is None else walk.follower.entered(y, resting.value)
        if place is not None:
            break
    else:
        return None
    up = follow_branch(walk.follower, place, record)
    down = follow_branch(walk.follower, oriented(place, -place.tangent), record)
    notes = dict.fromkeys((down.note, up.note))
    return Branch((*reversed(down.cycles), *up.cycles), " ".join(notes), down.ends_at_rest or up.ends_at_rest)


def _ends_in(walk: Walk, branch: Branch, hopf: HopfPoint) -> bool:
    """Whether a branch comes back to rest in a Hopf point."""
    if not branch.ends_at_rest or not branch.cycles:
        return False
    at = walk.value(hopf.equilibrium)
    return abs(walk.value(branch.cycles[-1]) - at) < SAME * abs(at)


def _resting(walk: Walk, point: Equilibrium) -> RestingPoint:
    machine = point.machine
    films = 2 * machine.film_count
    return RestingPoint(
        value=walk.value(point),
        speed_Hz=hertz(point.omega),
        displacement=point.u[:films].reshape(-1, 2),
        ring_speeds_Hz=hertz(machine.pace) * point.u[films:],
        eigenvalues=point.eigenvalues,
        stable=point.stable,
        temperatures_K=machine.temperatures,
    )


def point_of(walk: Walk, cycle: Cycle) -> CyclePoint:
    """A cycle of a branch with its errors by the mesh of the films, if other meshes are known."""
    point = _cycle(walk, cycle)
    if not walk.meshes:
        return point
    return with_error(point, cycle_error(walk.follower, walk.meshes, cycle))


def with_error(point: CyclePoint, error: CycleError) -> CyclePoint:
    """A cycle with its errors by the films."""
    return replace(
        point,
        value_uncertainty=error.value * point.value,
        frequency_uncertainty_Hz=error.frequency * point.frequency_Hz,
        eccentricity_max_uncertainty=error.eccentricity,
    )


def _cycle(walk: Walk, cycle: Cycle) -> CyclePoint:
    machine = cycle.machine
    films = 2 * machine.film_count
    motion, nu, omega = unpacked(cycle.y[:-2], machine.size), cycle.y[-2] * machine.pace, cycle.y[-1] * machine.pace
    loads, _ = loads_along(machine, motion, float(nu), float(omega))
    return CyclePoint(
        value=walk.value(cycle),
        speed_Hz=hertz(omega),
        frequency_Hz=hertz(nu),
        eccentricity_max=cycle.eccentricity_max,
        ring_speeds_Hz=hertz(machine.pace) * motion[0, films:].real,
        torque_N_m=float(loads.drive.mean()),
        stable=cycle.multipliers.stable,
        multipliers=cycle.multipliers.values,
        harmonics=motion[:, :films].reshape(len(motion), -1, 2),
        temperatures_K=machine.temperatures,
        kind=cycle.kind,
    )


def hopf_special(walk: Walk, hopf: HopfPoint, branch: int | None) -> SpecialPoint:
    """A Hopf point with its criticality; branch: number of the one that begins there."""
    here = hopf.equilibrium
    d = here.u[: 2 * here.machine.film_count].reshape(-1, 2)
    lyapunov = lyapunov_coefficient(hopf)
    return SpecialPoint(
        kind=HOPF,
        branch=branch,
        value=walk.value(here),
        speed_Hz=hertz(here.omega),
        frequency_Hz=hertz(hopf.nu),
        eccentricity_max=np.hypot(d[:, 0], d[:, 1]),
        criticality=criticality_of(lyapunov),
        lyapunov=lyapunov.value.real,
        lyapunov_uncertainty=lyapunov.uncertainty,
    )


def criticality_of(lyapunov: Lyapunov) -> str | None:
    """Whether a Hopf point is subcritical or supercritical, by its Lyapunov coefficient; None where the error leaves
    that open."""
    return (None, SUBCRITICAL, SUPERCRITICAL)[lyapunov.sign]


def cycle_special(walk: Walk, cycle: Cycle, branch: int) -> SpecialPoint:
    """A special cycle of the branch with this number, with the value of what the walk goes over, and Hz."""
    speed, frequency = hertz(cycle.y[-1] * cycle.machine.pace), hertz(cycle.y[-2] * cycle.machine.pace)
    return SpecialPoint(cycle.kind, branch, walk.value(cycle), speed, frequency, cycle.eccentricity_max)
