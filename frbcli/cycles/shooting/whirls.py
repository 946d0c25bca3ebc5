"""The whirls of a branch in finite-volume films with the unbalance: what its stable cycles of nearly half the speed
lock in with, if a run comes to it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.diagram import Observer
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.result import CycleBranch, MissingWhirl, UnbalancedWhirl, hertz
from frbcli.cycles.shooting.period_map import SAMPLES, STEPS_PER_REVOLUTION, Wet
from frbcli.cycles.shooting.shots import Shooting, Shot, largest
from frbcli.cycles.unbalance.synchronous import WHIRLS
from frbcli.cycles.unbalance.whirls import FREE, locked_lines, nearly_half, spaced

APART = 1.0 / 10.0  # of the range of speeds: distance between the cycles of a branch that are followed
SETTLING = 150  # pairs of periods of the rotor in a run, after which a whirl that locks in nearly repeats
RUNS = 5  # each of as many periods, as long as the whirl nearly repeats
LAST, PER_PERIOD = 100, 32  # of them, in which a whirl is watched, and its moments in each
REPEATS = 0.02  # change of the state in one or two periods above which a motion does not nearly repeat


def whirls_of_branch(
    shooting: Shooting, branch: CycleBranch, shots: Sequence[Shot], range_: float, observe: Observer | None
) -> CycleBranch:
    """A branch with its whirls. shots: of its points but the first, which is at rest; range_: of the speeds in rad/s;
    observe: see limit_cycles."""
    driven, whirls, missing = shooting.with_all_unbalance, list[UnbalancedWhirl](), list[MissingWhirl]()
    for place in spaced(branch, APART * hertz(range_)):
        if place == 0:
            continue
        point, shot = branch.points[place], shots[place - 1]
        if not nearly_half(point):
            missing.append(MissingWhirl(point.speed_Hz, FREE))
            continue
        run, locked = _locking(driven, shot.wet, driven.unit * math.exp(shot.p[1]))
        if locked is None:
            missing.append(MissingWhirl(point.speed_Hz, _why(run)))
            continue
        whirls.append(_whirl(driven, locked))
        if observe is not None:
            observe(len(whirls), point.speed_Hz, float(whirls[-1].eccentricity_max.max()))
    return replace(branch, with_unbalance=tuple(whirls), missing=tuple(missing))


@dataclass(frozen=True)
class HeldRun:
    """What the time loop makes of a cycle with the unbalance. omega: rad/s; wet: the machine after SETTLING pairs of
    periods of the rotor; moved: how far its state then goes in one and in two periods; last: (t, J, 2) displacements
    over the last LAST periods before; frequency: rad/s, their whirl's."""

    omega: float
    wet: Wet
    moved: tuple[float, float]
    last: Array
    frequency: float


def _run(driven: Shooting, wet: Wet, omega: float) -> HeldRun | None:
    """What a motion becomes in the time loop; None if that ends before."""
    flow = driven.flow
    try:
        for _ in range(SETTLING - LAST // 2):
            wet = flow.passage(wet, 4.0 * math.pi / omega, omega, 2 * STEPS_PER_REVOLUTION, 1).end
        time = 2.0 * math.pi * LAST / omega
        passage = flow.passage(wet, time, omega, LAST * STEPS_PER_REVOLUTION, LAST * PER_PERIOD)
        ends = [passage.end]
        for _ in range(2):
            ends.append(flow.passage(ends[-1], 2.0 * math.pi / omega, omega, STEPS_PER_REVOLUTION, 1).end)
    except Unreachable:
        return None
    first, *others = (flow.packed(end, driven.unit) for end in ends)
    once, twice = (float(np.linalg.norm(other - first)) for other in others)
    d = passage.displacements[:, int(np.ptp(passage.displacements, axis=0).max(axis=1).argmax())]
    turned = np.unwrap(np.arctan2(*(d - d.mean(axis=0)).T[::-1]))
    return HeldRun(omega, passage.end, (once, twice), passage.displacements, float(turned[-1] - turned[0]) / time)


def _why(run: HeldRun | None) -> str:
    """Why no whirl locks in, by what the time loop makes of the cycle."""
    if run is None:
        return "a run from the cycle ends early, as where a journal touches its shell"
    if run.moved[0] < REPEATS:
        return "a run from the cycle comes back to the synchronous motion"
    if run.moved[1] < REPEATS:
        return "a run from the cycle nearly repeats after two turns of the rotor, and slowly goes on"
    seen = f"{abs(hertz(run.frequency)):.4g} Hz and an eccentricity of {np.hypot(*run.last.T).max():.3f}"
    return f"a run from the cycle whirls on with {seen}"


def _locking(driven: Shooting, wet: Wet, omega: float) -> tuple[HeldRun | None, Shot | None]:
    """A run of a motion, and the motion of two periods of the rotor that it ends in. It goes on where it nearly repeats
    after two periods, and not after one, without being close enough: a whirl that just locks in settles slowly."""
    for _ in range(RUNS):
        run = _run(driven, wet, omega)
        locked = None if run is None else _locked(driven, run)
        if run is None or locked is not None or run.moved[0] < REPEATS or run.moved[1] > REPEATS:
            break
        wet = run.wet
    return run, locked


def _locked(driven: Shooting, run: HeldRun) -> Shot | None:
    """The motion of two periods of the rotor that a run of a cycle ends in; None if it does not."""
    if run.moved[1] > REPEATS:
        return None
    locked = driven.locked_in(run.wet, run.omega)
    if locked is None or not locked.multipliers.stable:
        return None
    half = np.fft.rfft(locked.displacements[:-1], axis=0, norm="forward")[1::2]
    return locked if float(np.abs(half).max()) > WHIRLS else None


def _whirl(driven: Shooting, shot: Shot) -> UnbalancedWhirl:
    middles, speed = driven.flow.middles(shot.displacements), driven.speed_Hz(shot)
    harmonics = np.fft.rfft(middles[:SAMPLES], axis=0, norm="forward")[: SAMPLES // 4]
    return UnbalancedWhirl(
        speed_Hz=speed,
        frequency_Hz=0.5 * speed,
        eccentricity_max=largest(middles),
        ring_speeds_Hz=shot.wet.v[list(driven.flow.system.spins)] / (2.0 * math.pi),
        lines=locked_lines(2.0 * math.pi * speed, harmonics.reshape(len(harmonics), -1)),
        stable=shot.multipliers.stable,
    )
