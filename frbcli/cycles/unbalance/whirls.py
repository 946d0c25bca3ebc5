"""The whirls with unbalance near the branches of limit cycles: what stable cycles of nearly half the speed lock in
with, and where the synchronous motion is stable.

A whirl that does not lock in has its own frequency besides the rotor's. It is not computed: a run shows it. """

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.diagram import Observer
from frbcli.cycles.method.balance import moments, motion_along, unpacked
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.cycle import ASKED, FOLD, Cycle
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.result import (
    CycleBranch,
    CyclePoint,
    LimitCycles,
    MissingWhirl,
    SpectralLine,
    UnbalancedWhirl,
    hertz,
)
from frbcli.cycles.unbalance.locked import locked_near, locked_whirl

APART = 1.0 / 40.0  # of the range of speeds: distance between the cycles of a branch that are taken
NEAR_HALF = 0.05  # of the speed: distance of twice the whirl from it up to which the whirl may lock in
ROUNDS, WARM_ENOUGH = 20, 1e-4  # of temperatures and motion in turn, and K by which the last one may differ
LINES, FAINT = 8, 1e-4  # besides whirl and unbalance: how many lines, and the smallest over the clearance
# Why no whirl locks in
FREE = "its frequency is not near half the speed"
NOT_FOUND = "no stable motion of half the speed was found"
UNSETTLED = "its temperatures do not settle"


def whirls_with_unbalance(diagram: LimitCycles, course: MachineCourse, observe: Observer | None = None) -> LimitCycles:
    """A diagram over the speed with the whirls that its stable cycles lock in with.

    course: which the diagram goes over; observe: called with the number of motions so far, the speed in Hz and the
    largest eccentricity of the latest one.
    """
    speeds, branches, count = [point.speed_Hz for point in diagram.equilibria], [], 0
    for branch in diagram.branches:
        near: Cycle | None = None
        whirls, missing = list[UnbalancedWhirl](), list[MissingWhirl]()
        for point in (branch.points[place] for place in spaced(branch, APART * (max(speeds) - min(speeds)))):
            try:
                near = _locked(course, point, near)
            except Unreachable as why:
                near = None
                missing.append(MissingWhirl(point.speed_Hz, str(why) or UNSETTLED))
                continue
            whirls.append(_whirl(near))
            count += 1
            if observe is not None:
                observe(count, point.speed_Hz, float(whirls[-1].eccentricity_max.max()))
        branches.append(replace(branch, with_unbalance=tuple(whirls), missing=tuple(missing)))
    return replace(diagram, branches=tuple(branches))


def spaced(branch: CycleBranch, apart: float) -> list[int]:
    """Places in a branch of stable cycles at some distance from each other in Hz, with those that were asked for."""
    places: list[int] = []
    for place, point in enumerate(branch.points):
        far = not places or abs(point.speed_Hz - branch.points[places[-1]].speed_Hz) >= apart
        if point.stable and (far or point.kind == ASKED):
            places.append(place)
    return places


def nearly_half(point: CyclePoint) -> bool:
    """Whether the whirl of a cycle may lock in."""
    return abs(2.0 * point.frequency_Hz - point.speed_Hz) <= NEAR_HALF * point.speed_Hz


def locked_lines(omega: float, harmonics: Complex) -> tuple[SpectralLine, ...]:
    """The lines of a motion of two periods of the rotor: whirl and unbalance first, then the largest others. omega:
    rad/s; harmonics: (H + 1, 2 F) of the displacements over the clearance."""
    whirl, unbalance, *others = (
        SpectralLine(_multiple_of_half(order), 0.5 * order * hertz(omega), _longer_axis(harmonic))
        for order, harmonic in enumerate(harmonics[1:], start=1)
    )
    others = [line for line in others if line.amplitude.max() > FAINT]
    others.sort(key=lambda line: -float(line.amplitude.max()))
    return (whirl, unbalance, *others[:LINES])


def _locked(course: MachineCourse, point: CyclePoint, near: Cycle | None) -> Cycle:
    """The motion that a cycle locks in with. near: the one before it on the branch. Raises Unreachable, with the reason
    if it is known, where there is none.

    With heat the motion has temperatures of its own, which are found in turn with it: they hardly change each other.
    """
    if not nearly_half(point):
        raise Unreachable(FREE)
    machine = course.machine_at(point.speed_Hz / course.scale)
    motion, omega = _motion_of(machine, point), 2.0 * math.pi * point.speed_Hz
    if course.at_its_heat is None:
        return _locked_at(machine, motion, point, near)
    moved, nu = motion, 2.0 * math.pi * point.frequency_Hz
    for round_ in range(ROUNDS):
        u, rate = motion_along(moved, moments(len(moved) - 1))
        before, machine = machine.temperatures, course.at_its_heat(u, nu * rate, omega)
        if near is not None and round_ and float(np.abs(machine.temperatures - before).max()) < WARM_ENOUGH:
            return near
        near = _locked_at(machine, motion, point, near)
        moved, nu = unpacked(near.y[:-2], machine.size), 0.5 * omega
    raise Unreachable(UNSETTLED)


def _locked_at(machine: Machine, motion: Complex, point: CyclePoint, near: Cycle | None) -> Cycle:
    """The motion that a cycle with harmonics (H + 1, c) locks in with at the temperatures of a machine. Raises
    Unreachable where none is found."""
    nu, omega = 2.0 * math.pi * point.frequency_Hz, 2.0 * math.pi * point.speed_Hz
    locked = None if near is None else locked_near(machine, unpacked(near.y[:-2], machine.size), omega)
    locked = locked or locked_whirl(machine, motion, nu, omega)
    if locked is None:
        raise Unreachable(NOT_FOUND)
    return locked


def _motion_of(machine: Machine, point: CyclePoint) -> Complex:
    """(H + 1, c) harmonics of a cycle, of the ring speeds their mean."""
    films = 2 * machine.film_count
    motion = np.zeros((len(point.harmonics), machine.size), dtype=complex)
    motion[:, :films] = point.harmonics.reshape(len(motion), -1)
    motion[0, films:] = 2.0 * math.pi * point.ring_speeds_Hz / machine.pace
    return motion


def _whirl(cycle: Cycle) -> UnbalancedWhirl:
    """Results of a motion of two periods of the rotor."""
    machine, films = cycle.machine, 2 * cycle.machine.film_count
    motion, omega = unpacked(cycle.y[:-2], machine.size), float(cycle.y[-1] * machine.pace)
    return UnbalancedWhirl(
        speed_Hz=hertz(omega),
        frequency_Hz=0.5 * hertz(omega),
        eccentricity_max=cycle.eccentricity_max,
        ring_speeds_Hz=hertz(machine.pace) * motion[0, films:].real,
        lines=locked_lines(omega, motion[:, :films]),
        stable=cycle.multipliers.stable,
        temperatures_K=machine.temperatures,
    )


def _longer_axis(harmonic: Complex) -> Array:
    """(F,) half the longer axis of the ellipse of 2 Re(harmonic exp(i t)) in each film."""
    x, y = harmonic[0::2], harmonic[1::2]
    return np.asarray(np.abs(x + 1j * y) + np.abs(x - 1j * y))


def _multiple_of_half(order: int) -> str:
    """The name of a multiple of Omega / 2."""
    if order % 2 == 0:
        return "Omega" if order == 2 else f"{order // 2} Omega"
    return "Omega / 2" if order == 1 else f"{order} Omega / 2"


def of_no_whirl(diagram: LimitCycles) -> LimitCycles:
    """A diagram whose whirls with the unbalance were asked for, with what is to be said where none was sought, and
    where the synchronous motion is stable."""
    notes = list(diagram.notes)
    if not any(branch.with_unbalance or branch.missing for branch in diagram.branches):
        notes.append("With unbalance: no branch has a stable cycle, from which a whirl is sought.")
    return replace(diagram, notes=(*notes, *_synchronous(diagram)))


def _synchronous(diagram: LimitCycles) -> list[str]:
    """Where the synchronous motion is stable, in words: each of the branches between its folds by itself."""
    pieces = between_folds(diagram.synchronous)
    if not pieces:
        return []
    if len(pieces) == 1:
        return [f"The synchronous motion is {_stability(pieces[0])}, where it was computed."]
    folds = " and ".join(f"{point.speed_Hz:.6g} Hz" for point in diagram.synchronous if point.kind == FOLD)
    notes = [f"The synchronous motion has {len(pieces)} branches, which meet in folds at {folds}."]
    return notes + [
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
