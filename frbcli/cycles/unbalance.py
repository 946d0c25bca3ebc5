"""Limit cycles with unbalance, nonlinear: the synchronous response, motions of the rotor's own period or of two of its
periods, stable or not; whirls of nearly half the speed that lock in with the unbalance; and the whirls near the
branches of limit cycles: what stable cycles of nearly half the speed lock in with, and where the synchronous motion is
stable.

The equations of a cycle (balance.py) apply with nu = Omega, or 2 nu = Omega, instead of the phase condition, and with
the unbalance in the first or second harmonic, Omega^2 times the motion that it makes behind the films. A force of the
order k acts in k times that harmonic.

With an unbalance at 2 mu, which is shifted against the whirl by an angle theta, a cycle of some frequency mu(theta)
exists; it goes on from the one without unbalance, mu = nu. Where mu = Omega / 2 for some theta the whirl locks in, for
one theta with a stable motion, for another one with an unstable one. If there is no such theta, the whirl does not lock
in. It then has its own frequency besides the rotor's and is not computed: a run shows it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.branch import Branch, follow_branch
from frbcli.cycles.columns import (
    CycleBranch,
    CyclePoint,
    LimitCycles,
    MissingWhirl,
    SpectralLine,
    UnbalancedWhirl,
    hertz,
)
from frbcli.cycles.diagram import Observer
from frbcli.cycles.method.balance import (
    FEWEST_INTERVALS,
    INTERVALS_PER_HARMONIC,
    Balance,
    Multipliers,
    moments,
    monodromy,
    motion_along,
    packed,
    unpacked,
)
from frbcli.cycles.method.continuation import Equations, Place, Unreachable, corrected, oriented, unit_vector
from frbcli.cycles.method.equilibria import EquationsOf, Equilibrium, MachineCourse
from frbcli.cycles.method.follower import ASKED, FIRST_HARMONICS, FOLD, Cycle, Follower, largest
from frbcli.cycles.method.machine import Machine, driven_motions
from frbcli.rotor.loads import largest_first

DIFFERENCE = 1e-6  # of the pace
WHIRLS = 1e-3  # of the clearance: harmonic of the whirl in a motion that is not the synchronous one
ANGLES = 12  # at which theta is tried
SMALLEST = 1.0 / 64.0  # share of the unbalance, and step to a larger one, at which it is tried last
SHARP = 1e-5  # of theta
PERIODS = 2  # of the rotor in one of the motion
APART = 1.0 / 40.0  # of the range of speeds: distance between the cycles of a branch that are taken
NEAR_HALF = 0.05  # of the speed: distance of twice the whirl from it up to which the whirl may lock in
ROUNDS, WARM_ENOUGH = 20, 1e-4  # of temperatures and motion in turn, and K by which the last one may differ
LINES, FAINT = 8, 1e-4  # besides whirl and unbalance: how many lines, and the smallest over the clearance
# Why no whirl locks in
FREE = "its frequency is not near half the speed"
NOT_FOUND = "no stable motion of half the speed was found"
UNSETTLED = "its temperatures do not settle"


class Synchronous(Follower):
    """Follows motions of some periods of the rotor with a share of the unbalance; of one period and with all of it they
    are the synchronous response."""

    free = False

    def __init__(
        self, course: MachineCourse, lowest: float, highest: float = 1.0, periods: int = 1, share: float = 1.0
    ) -> None:
        super().__init__(course, lowest, highest)
        self._motion = partial(driven_equations, periods=periods, share=share)

    def motion(self, place: Place) -> EquationsOf:
        """See Follower. The motion itself is the reference: the unbalance holds its phase."""
        return partial(self._motion, reference=unpacked(place.y[:-2], self.machine.size))

    def fast_multipliers(self, machine: Machine, y: Array, _near: Multipliers | None, _enough: float) -> Multipliers:
        """The multipliers of a motion y; none is trivial, since the unbalance holds it in time; the first one is set to
        1."""
        harmonics = (len(y) - 2) // machine.size // 2
        count = max(FEWEST_INTERVALS, INTERVALS_PER_HARMONIC * harmonics)
        values = np.linalg.eigvals(monodromy(machine, self.course.states(machine), y, count)).astype(complex)
        return Multipliers(np.concatenate([[1.0 + 0.0j], values[largest_first(values)]]), 0.0)


def driven_equations(
    machine: Machine, reference: Complex, periods: int = 1, share: float = 1.0, theta: float | None = None
) -> Equations:
    """Equations of motions of some periods of the rotor with a share of the unbalance: residual (n,), n = c (2 H + 1) +
    1, the last of periods nu = Omega. theta: of cycles that are not locked in, by which the rotor is ahead of them;
    their last residual is the phase against the reference."""
    balance = Balance(machine, reference)

    def driven(speed: float) -> Array:
        return share * driven_motion(machine, balance.harmonics, periods, speed, theta or 0.0)

    def at(y: Array) -> tuple[Array, Array]:
        residual, slope = balance(y)
        residual[:-1] -= driven(float(y[-1]))
        ahead, behind = (driven(float(y[-1]) + side * DIFFERENCE) for side in (1.0, -1.0))
        slope[:-1, -1] -= (ahead - behind) / (2.0 * DIFFERENCE)
        if theta is None:
            residual[-1], slope[-1] = periods * y[-2] - y[-1], 0.0
            slope[-1, -2:] = periods, -1.0
        return residual, slope

    return at


def synchronous_response(follower: Synchronous, resting: Equilibrium) -> Branch | None:
    """The response from the speed of a static equilibrium down to the slowest one that a follower of such motions has;
    None if it does not begin."""
    machine = follower.machine
    motion = np.zeros((first_harmonics(machine, 1) + 1, machine.size), dtype=complex)
    motion[0] = resting.u
    share = resting.omega / machine.pace
    guess = np.concatenate([packed(motion), [share, share]])
    along = -unit_vector(len(guess))
    start = corrected(follower.equations(Place(guess, along)), guess, along)
    if start is None:
        return None
    place = follower.refitted(oriented(start, along))
    if place is None:
        return None
    branch = follow_branch(follower, place)
    return replace(branch, cycles=(follower.cycle(place), *branch.cycles))


def driven_motion(machine: Machine, harmonics: int, periods: int, share: float, theta: float = 0.0) -> Array:
    """The packed motion that unbalance and forces make at a speed over the pace, with the rotor ahead by theta."""
    motion = np.zeros((harmonics + 1, machine.size), dtype=complex)
    for order, driven in driven_motions(machine, share * machine.pace):
        if periods * order <= harmonics:
            motion[periods * order] += np.exp(1j * order * theta) * driven
    return packed(motion)


def first_harmonics(machine: Machine, periods: int) -> int:
    """Harmonics that the motion of some periods of the rotor begins with: enough for all that drives it."""
    return max(FIRST_HARMONICS, periods * max(machine.orders))


def locked_whirl(machine: Machine, motion: Complex, nu: float, omega: float) -> Cycle | None:
    """The stable motion of two periods of the rotor with the unbalance that a cycle locks in with, None if none was
    found. motion: (H + 1, c) harmonics of the cycle; nu: its frequency; omega: rad/s.

    Where it cannot be reached with the whole unbalance it is looked for with a part of it, which is raised then.
    """
    motion = padded(motion, first_harmonics(machine, PERIODS))
    share = 1.0
    while share >= SMALLEST:
        try:
            guesses = _guesses(machine, motion, nu, omega, share)
        except Unreachable:
            share *= 0.5
            continue
        for guess in guesses:
            locked = locked_near(machine, guess, omega, share)
            if locked is not None:
                return _raised(machine, locked, omega, share)
        return None
    return None


def locked_near(machine: Machine, motion: Complex, omega: float, share: float = 1.0) -> Cycle | None:
    """The stable motion of two periods of the rotor next to one with harmonics (H + 1, c); None if there is none."""
    follower, speed = Synchronous(MachineCourse(machine), 0.0, 1.0, PERIODS, share), omega / machine.pace
    guess = np.concatenate([packed(motion), [0.5 * speed, speed]])
    along = unit_vector(len(guess))
    place = corrected(follower.equations(Place(guess, along)), guess, along)
    near = None if place is None else follower.refitted(oriented(place, along))
    fitted = None if near is None else follower.entered(near.y, speed)
    if fitted is None or largest(machine, fitted.y) > 1.0:
        return None
    whirl = unpacked(fitted.y[:-2], machine.size)[1::2, : 2 * machine.film_count]
    cycle = follower.cycle(fitted)
    return cycle if cycle.multipliers.stable and np.abs(whirl).max() > WHIRLS else None


def _raised(machine: Machine, locked: Cycle, omega: float, share: float) -> Cycle | None:
    """The motion with the whole unbalance that goes on from one with a share of it."""
    step = share
    while share < 1.0:
        higher = min(1.0, share + step)
        there = locked_near(machine, unpacked(locked.y[:-2], machine.size), omega, higher)
        if there is not None:
            locked, share, step = there, higher, 2.0 * step
        elif step < SMALLEST:
            return None
        else:
            step *= 0.5
    return locked


def _guesses(machine: Machine, motion: Complex, nu: float, omega: float, share: float) -> list[Complex]:
    """The cycles with a share of the unbalance and mu = Omega / 2, shifted in time so that theta is zero. Raises
    Unreachable."""
    from scipy.optimize import brentq

    angles = 2.0 * np.pi * np.arange(ANGLES + 1) / ANGLES
    known = dict(zip(angles, shifted(machine, motion, nu, omega, share, angles), strict=True))

    def off(theta: float) -> float:
        if theta not in known:
            near = known[min(known, key=lambda other: abs(other - theta))]
            known[theta] = _shifted(machine, motion, near, share, theta)
        return float(known[theta][-2]) - 0.5 * omega / machine.pace

    guesses, orders = [], np.arange(len(motion))[:, None]
    for low, high in itertools.pairwise(angles):
        if off(low) * off(high) <= 0.0:
            theta = float(brentq(off, low, high, xtol=SHARP))
            off(theta)
            guesses.append(unpacked(known[theta][:-2], machine.size) * np.exp(-0.5j * theta * orders))
    return guesses


def shifted(machine: Machine, motion: Complex, nu: float, omega: float, share: float, angles: Array) -> list[Array]:
    """The cycles with a share of the unbalance shifted by angles theta, each from the one before it. Raises
    Unreachable."""
    y, cycles = np.concatenate([packed(motion), [nu / machine.pace, omega / machine.pace]]), []
    for theta in angles:
        y = _shifted(machine, motion, y, share, float(theta))
        cycles.append(y)
    return cycles


def _shifted(machine: Machine, reference: Complex, y: Array, share: float, theta: float) -> Array:
    """The cycle with a share of the unbalance shifted by theta, next to y; its phase is the phase of the reference.
    Raises Unreachable."""
    place = corrected(driven_equations(machine, reference, PERIODS, share, theta), y, unit_vector(len(y)))
    if place is None:
        raise Unreachable
    return place.y


def padded(motion: Complex, harmonics: int) -> Complex:
    """(H + 1, c) harmonics with zeros behind them, so that H is not below `harmonics`."""
    more = max(0, harmonics + 1 - len(motion))
    return np.concatenate([motion, np.zeros((more, motion.shape[1]))])


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
