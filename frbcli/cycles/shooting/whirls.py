"""The whirls of a branch in films on cells with the unbalance: what its stable cycles become, motions of two
frequencies (invariant_curve.py) or such as have locked in at half the speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from frbcli.cycles.method.continuation import Unreachable, halved_until
from frbcli.cycles.result import CycleBranch, UnbalancedWhirl, hertz
from frbcli.cycles.shooting.invariant_curve import InvariantCurve, along_cycle, invariant_curve
from frbcli.cycles.shooting.period_map import SAMPLES, STEPS_PER_REVOLUTION, Wet
from frbcli.cycles.shooting.shots import Shooting, Shot, largest
from frbcli.cycles.unbalance.branches import not_found, taken
from frbcli.cycles.unbalance.synchronous import WHIRLS
from frbcli.cycles.unbalance.whirls import free_lines, locked_lines, nearly_half

Observer = Callable[[int, float, float], None]

SMALLEST = 0.25  # share of the unbalance in a step, where one does not lead to all of it
APART = 1.0 / 10.0  # of the range of speeds: distance between the cycles of a branch that are taken
SETTLING = 150  # pairs of periods of the rotor after which a whirl that locks in nearly repeats
REPEATS = 0.02  # change of the state in two periods above which it has not locked in


def whirls_of_branch(
    shooting: Shooting, branch: CycleBranch, shots: Sequence[Shot], range_: float, observe: Observer | None
) -> CycleBranch:
    """A branch with its whirls. shots: of its points but the first, which is at rest; range_: of the speeds in rad/s;
    observe: see limit_cycles."""
    driven, whirls, missing = shooting.with_all_unbalance, [], []
    before: InvariantCurve | None = None
    for place in taken(branch, APART * hertz(range_)):
        if place == 0:
            continue
        point, shot = branch.points[place], shots[place - 1]
        locked = _locked(driven, shot)
        if locked is not None:
            whirls.append(_locked_whirl(driven, locked))
        else:
            found = _curve(shooting, shot, before)
            if found is None:
                missing.append(point.speed_Hz)
                continue
            before = found
            whirls.append(_free_whirl(driven, found))
        if observe is not None:
            observe(len(whirls), point.speed_Hz, float(whirls[-1].eccentricity_max.max()))
    remarks = [f"With unbalance {remark}" for remark in not_found(missing)]
    return replace(branch, with_unbalance=tuple(whirls), note=" ".join([branch.note, *remarks]).strip())


def _curve(shooting: Shooting, shot: Shot, before: InvariantCurve | None) -> InvariantCurve | None:
    """The curve that a cycle becomes: from the cycle, else from the curve before, else with the unbalance raised in
    steps."""
    flow, omega = shooting.with_all_unbalance.flow, shooting.unit * math.exp(shot.p[1])
    try:
        start = along_cycle(shooting, shot)
    except Unreachable:
        return None
    starts = [start] if before is None else [start, (before.wets, before.rho)]
    for each in starts:
        found = invariant_curve(flow, shooting.unit, omega, each)
        if found is not None:
            return found
    share = 0.0

    def raised(by: float) -> InvariantCurve | None:
        return invariant_curve(replace(flow, driven=share + by), shooting.unit, omega, start)

    while share < 1.0:
        found, step = halved_until(raised, min(1.0 - share, 0.5), SMALLEST)
        if found is None:
            return None
        start, share = (found.wets, found.rho), share + step
    return found


def _locked(driven: Shooting, shot: Shot) -> Shot | None:
    """The motion of two periods of the rotor that a cycle ends in; None if it does not."""
    omega = driven.unit * math.exp(shot.p[1])
    if not nearly_half(driven.unit * 2.0 * math.pi * math.exp(-shot.p[0]), omega):
        return None
    wet, before = shot.wet, shot.x
    try:
        for _ in range(SETTLING):
            before = driven.flow.packed(wet, driven.unit)
            wet = driven.flow.passage(wet, 4.0 * math.pi / omega, omega, 2 * STEPS_PER_REVOLUTION, 1).end
    except Unreachable:
        return None
    if float(np.linalg.norm(driven.flow.packed(wet, driven.unit) - before)) > REPEATS:
        return None
    found = driven.locked_in(wet, omega)
    if found is None or not found.multipliers.stable:
        return None
    half = np.fft.rfft(found.displacements[:-1], axis=0, norm="forward")[1::2]
    return found if float(np.abs(half).max()) > WHIRLS else None


def _free_whirl(driven: Shooting, curve: InvariantCurve) -> UnbalancedWhirl:
    middles = driven.flow.middles(curve.displacements)
    orders, harmonics = curve.harmonics(middles)
    return UnbalancedWhirl(
        speed_Hz=hertz(curve.omega),
        frequency_Hz=hertz(curve.rho * curve.omega),
        locked=False,
        eccentricity_max=replace(curve, displacements=middles).largest,
        ring_speeds_Hz=np.mean([_turning(driven, wet) for wet in curve.wets], axis=0),
        lines=free_lines(orders, curve.omega * (orders @ [curve.rho, 1.0]), harmonics.reshape(len(orders), -1)),
        stable=curve.stable,
    )


def _locked_whirl(driven: Shooting, shot: Shot) -> UnbalancedWhirl:
    middles, speed = driven.flow.middles(shot.displacements), driven.speed_Hz(shot)
    harmonics = np.fft.rfft(middles[:SAMPLES], axis=0, norm="forward")[: SAMPLES // 4]
    return UnbalancedWhirl(
        speed_Hz=speed,
        frequency_Hz=0.5 * speed,
        locked=True,
        eccentricity_max=largest(middles),
        ring_speeds_Hz=_turning(driven, shot.wet),
        lines=locked_lines(2.0 * math.pi * speed, harmonics.reshape(len(harmonics), -1)),
        stable=shot.multipliers.stable,
    )


def _turning(driven: Shooting, wet: Wet) -> np.ndarray:
    return np.asarray(wet.v[list(driven.flow.system.spins)] / (2.0 * math.pi))
