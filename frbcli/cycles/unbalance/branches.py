"""The whirls of each branch with the unbalance: what its stable cycles become, and what a motion of two frequencies
leads to where no other one follows it: through folds, to unstable motions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from frbcli.arrays import Array
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.cycle import ASKED, FOLD
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.parts.reduced_states import reduced_space
from frbcli.cycles.result import CycleBranch, CyclePoint, LimitCycles, MissingWhirl, UnbalancedWhirl, hertz
from frbcli.cycles.unbalance.growth import is_stable
from frbcli.cycles.unbalance.torus_branch import TorusFollower, TorusPlace, follow_torus
from frbcli.cycles.unbalance.two_frequencies import UNKNOWN, Torus
from frbcli.cycles.unbalance.whirls import Chain, WhirlFound, free_whirl

Observer = Callable[[int, float, float], None]
Tell = Callable[[UnbalancedWhirl], None]

APART = 1.0 / 40.0  # of the range of speeds: distance between the cycles of a branch that are taken
SAME = 1e-3  # of its frequency: a motion lies on a branch that passes it at this distance
MOST_INTERVALS = 60_000  # in which the stability of a motion behind others is to be seen
BORDER = 1e-9  # of the fastest speed


def whirls_with_unbalance(found: LimitCycles, course: MachineCourse, observe: Observer | None = None) -> LimitCycles:
    """A diagram over the speed with its whirls with the unbalance.

    course: which the diagram goes over; observe: called with the number of motions so far, the speed in Hz and the
    largest eccentricity of the latest one.
    """
    speeds = [point.speed_Hz for point in found.equilibria]
    follower = TorusFollower(course, (2.0 * math.pi * min(speeds), 2.0 * math.pi * max(speeds)))
    branches, notes, count = [], list(found.notes), 0

    def tell(whirl: UnbalancedWhirl) -> None:
        nonlocal count
        count += 1
        if observe is not None:
            observe(count, whirl.speed_Hz, float(whirl.eccentricity_max.max()))

    for number, branch in enumerate(found.branches):
        driven, remarks = _with_unbalance(follower, branch, tell)
        notes += [f"Branch {number + 1} with unbalance: {remark}" for remark in remarks]
        branches.append(driven)
    return replace(found, branches=tuple(branches), notes=tuple(notes))


def _with_unbalance(follower: TorusFollower, branch: CycleBranch, tell: Tell) -> tuple[CycleBranch, list[str]]:
    """A branch with its whirls in its order, and what is to be said of them."""
    course, missing, remarks = follower.course, [], []
    chain, motions = Chain(course.at_its_heat), dict[int, WhirlFound | None]()
    for place in taken(branch, APART * hertz((follower.range[1] - follower.range[0]) * follower.pace)):
        point = branch.points[place]
        try:
            motion = chain.next(course.machine_at(point.speed_Hz / course.scale), point)
        except Unreachable as why:
            motions[place] = None
            missing.append(MissingWhirl(point.speed_Hz, str(why) or UNKNOWN))
        else:
            motions[place] = motion
            tell(motion.whirl)
    ends = [end for place in motions for way in (-1, 1) if (end := _end(follower, branch.points, motions, place, way))]
    behind: dict[tuple[int, int], list[UnbalancedWhirl]] = {}
    reached: list[_End] = []
    for end in ends:
        if course.at_its_heat is not None:
            remarks.append(f"with heat the whirls behind {hertz(end.torus.omega):.4g} Hz are not followed.")
        elif end not in reached:
            others = [other for other in ends if other.place != end.place]
            behind[end.place, end.way], remark = _followed(follower, end, others, reached, tell)
            remarks.append(remark)
    whirls = []
    for place, there in motions.items():
        own = [] if there is None else [there.whirl]
        whirls += [*reversed(behind.get((place, -1), [])), *own, *behind.get((place, 1), [])]
    return replace(branch, with_unbalance=tuple(whirls), missing=tuple(missing)), remarks


def taken(branch: CycleBranch, apart: float) -> list[int]:
    """Places in a branch of stable cycles at some distance from each other in Hz, with those that were asked for."""
    places: list[int] = []
    for place, point in enumerate(branch.points):
        far = not places or abs(point.speed_Hz - branch.points[places[-1]].speed_Hz) >= apart
        if point.stable and (far or point.kind == ASKED):
            places.append(place)
    return places


def of_no_whirl(found: LimitCycles) -> LimitCycles:
    """A diagram whose whirls with the unbalance were asked for, with what is to be said where none was sought, and
    where the synchronous motion is stable."""
    notes = list(found.notes)
    if not any(branch.with_unbalance or branch.missing for branch in found.branches):
        notes.append("With unbalance: no branch has a stable cycle, from which a whirl is sought.")
    return replace(found, notes=(*notes, *_synchronous(found)))


def _synchronous(found: LimitCycles) -> list[str]:
    """Where the synchronous motion is stable, in words: each of the branches between its folds by itself."""
    pieces = between_folds(found.synchronous)
    if not pieces:
        return []
    if len(pieces) == 1:
        return [f"The synchronous motion is {_stability(pieces[0])}, where it was computed."]
    folds = " and ".join(f"{point.speed_Hz:.6g} Hz" for point in found.synchronous if point.kind == FOLD)
    told = [f"The synchronous motion has {len(pieces)} branches, which meet in folds at {folds}."]
    return told + [
        f"Branch {number} of the synchronous motion is {_stability(piece)}, with eccentricities of "
        f"{min(sizes):.3g} to {max(sizes):.3g}."
        for number, piece in enumerate(pieces, start=1)
        for sizes in [[float(point.eccentricity_max.max()) for point in piece]]
    ]


def between_folds(points: Sequence[CyclePoint]) -> list[list[CyclePoint]]:
    """The branches of a response, whose points are in their order along it, between its folds: each passes a speed
    once."""
    pieces: list[list[CyclePoint]] = [[]]
    for point in points:
        if point.kind == FOLD:
            pieces.append([])
            continue
        here, speed = pieces[-1], point.speed_Hz
        if len(here) > 1 and (speed - here[-1].speed_Hz) * (here[-1].speed_Hz - here[-2].speed_Hz) < 0.0:
            pieces.append([])  # a fold that was not located
        pieces[-1].append(point)
    return [piece for piece in pieces if piece]


def _stability(points: Sequence[CyclePoint]) -> str:
    """Where a branch that passes each speed once is stable, in words."""
    spans: list[tuple[bool, list[float]]] = []
    for point in sorted(points, key=lambda each: each.speed_Hz):
        if not spans or spans[-1][0] != point.stable:
            spans.append((point.stable, []))
        spans[-1][1].append(point.speed_Hz)
    return ", ".join(f"{'stable' if stable else 'unstable'} {_span(speeds)}" for stable, speeds in spans)


def _span(speeds: Sequence[float]) -> str:
    return f"at {speeds[0]:.4g} Hz" if len(speeds) == 1 else f"from {speeds[0]:.4g} to {speeds[-1]:.4g} Hz"


@dataclass(frozen=True, eq=False)
class _End:
    """A motion of two frequencies behind which, on a way of 1 or -1 along its branch, none is known. place: of its
    cycle in the branch; upwards: whether that way leads to higher speeds."""

    torus: Torus
    motion: WhirlFound
    place: int
    way: int
    upwards: bool


def _end(
    follower: TorusFollower, points: Sequence[CyclePoint], motions: dict[int, WhirlFound | None], place: int, way: int
) -> _End | None:
    """The end of the motions at a place on a way; None if another motion follows, or the border of the range."""
    motion = motions[place]
    if motion is None or motion.torus is None:
        return None
    beyond = range(place + way, len(points) if way > 0 else -1, way)
    first = points[beyond[0]] if beyond else None
    inner = points[place - way] if 0 <= place - way < len(points) else points[place]
    upwards = points[place].speed_Hz > inner.speed_Hz if first is None else first.speed_Hz > points[place].speed_Hz
    for at in beyond:
        if not points[at].stable or (at in motions and motions[at] is None):
            return _End(motion.torus, motion, place, way, upwards)
        if at in motions:
            return None
    last = 2.0 * math.pi * points[beyond[-1] if beyond else place].speed_Hz / follower.pace
    at_border = min(abs(last - limit) for limit in follower.range) < BORDER
    return None if at_border else _End(motion.torus, motion, place, way, upwards)


def _followed(
    follower: TorusFollower, end: _End, others: Sequence[_End], reached: list[_End], tell: Tell
) -> tuple[list[UnbalancedWhirl], str]:
    """The motions behind an end, and what is to be said of them. reached: gets the ends that they come to."""
    from_Hz = hertz(end.torus.omega)
    start = follower.start(end.torus, end.upwards)
    if start is None:
        return [], f"it could not be followed from {from_Hz:.4g} Hz."

    def until(here: TorusPlace, there: TorusPlace) -> str:
        met = [other for other in others if _passes(follower, here, there, other.torus)]
        reached.extend(met)
        return f"They come to those at {hertz(met[0].torus.omega):.4g} Hz." if met else ""

    found = follow_torus(follower, start, until)
    whirls = []
    for each in found.places:
        torus = follower.torus(each.orders, each.place.y)
        machine = follower.course.machine(each.place.y)
        stable = None if each.kind == FOLD else _stable(machine, torus, end.motion.cycle)
        whirls.append(free_whirl(machine, torus, stable, each.kind))
        tell(whirls[-1])
    folds = " and ".join(f"{whirl.speed_Hz:.6g} Hz" for whirl in whirls if whirl.kind == FOLD)
    turn = f"turn back at {folds}. " if folds else "go on. "
    return whirls, f"the whirls from {from_Hz:.4g} Hz on {turn}{found.note}"


def _stable(machine: Machine, torus: Torus, cycle: Array) -> bool | None:
    return is_stable(machine, reduced_space(machine), torus, cycle, MOST_INTERVALS)


def _passes(follower: TorusFollower, here: TorusPlace, there: TorusPlace, torus: Torus) -> bool:
    """Whether the branch passes a motion between two places."""
    ends = here.place.y[-2:] * follower.pace, there.place.y[-2:] * follower.pace
    (nu, omega), (next_nu, next_omega) = ends
    if omega == next_omega or not min(omega, next_omega) <= torus.omega <= max(omega, next_omega):
        return False
    share = (torus.omega - omega) / (next_omega - omega)
    return bool(abs(nu + share * (next_nu - nu) - torus.nu) < SAME * torus.nu)
