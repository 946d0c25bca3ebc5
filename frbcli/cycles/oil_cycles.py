"""Limit cycles of a case whose films keep their oil, over its speed: resting positions with the motions of their oil,
Hopf points, and from each the branch of cycles by shooting."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence

import numpy as np

from frbcli.case.schema import Case
from frbcli.cycles.branch import AT_REST, FLIP, FOLD, HOPF, TORUS
from frbcli.cycles.continuation import Unreachable
from frbcli.cycles.diagram import SAME, Observer
from frbcli.cycles.period_map import SAMPLES, period_map, wet_at
from frbcli.cycles.result import (
    SPEED,
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
from frbcli.cycles.shot_branch import PLACES, Rest, Shooting, Shot, follow_shots
from frbcli.errors import NotConverged
from frbcli.linear.resting import resting_position, ring_speeds
from frbcli.rotor.held import held_rotor

SLOWLY = 1e-3  # rate of growth over the frequency that the Hopf point may have by its own pair
RESTS = 15  # resting positions of a diagram
LOCATED, NEAREST = 12, 1e-5  # evaluations that locate a Hopf point; its speed, relative
FIRST_SIZES = (0.1, 0.2, 0.05)  # of the first cycle beside a Hopf point


def limit_cycles_with_oil(
    case: Case, slowest: float, fastest: float, asked: Sequence[float], observe: Observer | None = None
) -> LimitCycles:
    """As limit_cycles, for films that keep their oil; speeds in rad/s, asked: at which cycles are computed exactly.

    Raises NotConverged where no resting position is found.
    """
    begun = time.process_time()
    flow = period_map(case)
    shooting = Shooting(flow, fastest)
    rests = _resting(shooting, slowest, fastest)
    if not rests:
        raise NotConverged(f"No resting position was found between {hertz(slowest):.4g} and {hertz(fastest):.4g} Hz.")
    hopf = [
        _located(shooting, low, high)
        for low, high in itertools.pairwise(rests)
        if (low.growth > 0.0) != (high.growth > 0.0)
    ]
    told = 0

    def tell(shot: Shot) -> None:
        nonlocal told
        told += 1
        if observe is not None:
            observe(told, shooting.speed_Hz(shot), float(shot.eccentricity_max.max()))

    branches: list[CycleBranch] = []
    special: list[SpecialPoint] = []
    ends: list[float] = []
    for rest in hopf:
        if any(abs(end - rest.omega) < SAME * rest.omega for end in ends):
            special.append(_hopf(rest, None, None))
            continue
        shots, note = _branch(shooting, rest, (slowest, fastest), asked, tell)
        if note == AT_REST:
            ends.append(2.0 * math.pi * shooting.speed_Hz(shots[-1]))
        special.append(_hopf(rest, len(branches), shots[0] if shots else None))
        branches.append(CycleBranch(len(special) - 1, _points(shooting, rest, shots), _with_lost_places(note, shots)))
    for number, branch in enumerate(branches):
        special += [_special(point, number) for point in branch.points if point.kind in (FOLD, FLIP, TORUS)]
    return LimitCycles(
        case=case,
        over=SPEED,
        unit="Hz",
        films=flow.system.names,
        equilibria=tuple(_rest(shooting, rest) for rest in rests),
        branches=tuple(branches),
        special=tuple(special),
        notes=tuple(_notes(shooting, rests, hopf)),
        cost=Cost(time.process_time() - begun, told),
    )


def _resting(shooting: Shooting, slowest: float, fastest: float) -> list[Rest]:
    """Resting positions in ascending order of the speed, sought from the fastest on."""
    found: list[Rest] = []
    for omega in np.linspace(fastest, slowest, RESTS):
        rest = _settled(shooting, float(omega))
        if rest is None and found:
            rest = shooting.rest(found[-1].wet, float(omega))
        if rest is not None:
            found.append(rest)
    return found[::-1]


def _settled(shooting: Shooting, omega: float) -> Rest | None:
    """The resting position next to that of films whose oil is at rest, too."""
    system = shooting.flow.system
    try:
        q = resting_position(system, omega)
        v = np.zeros_like(q)
        v[list(system.spins)] = ring_speeds(system, held_rotor(system.rotor), omega, system.rotor.journals @ q)
        return shooting.rest(wet_at(shooting.flow, q, v, omega), omega)
    except (NotConverged, Unreachable):
        return None


def _located(shooting: Shooting, low: Rest, high: Rest) -> Rest:
    """The resting position at which a whirl begins to grow, by halves of straight lines."""
    best = min(low, high, key=lambda rest: abs(rest.growth))
    for _ in range(LOCATED):
        share = min(max(low.growth / (low.growth - high.growth), 0.1), 0.9)
        rest = shooting.rest(low.wet, low.omega + share * (high.omega - low.omega))
        if rest is None:
            break
        best = min(best, rest, key=lambda one: abs(one.growth))
        if (rest.growth > 0.0) == (low.growth > 0.0):
            low = rest
        else:
            high = rest
        if abs(high.omega - low.omega) < NEAREST * high.omega:
            break
    return best


def _branch(
    shooting: Shooting, rest: Rest, speeds: tuple[float, float], asked: Sequence[float], tell: Callable[[Shot], None]
) -> tuple[tuple[Shot, ...], str]:
    for size in FIRST_SIZES:
        first = shooting.from_rest(rest, size)
        if first is not None:
            return follow_shots(shooting, first, speeds, asked, tell)
    return (), "No cycle was found beside the Hopf point."


def _with_lost_places(note: str, shots: Sequence[Shot]) -> str:
    """The note of a branch, which says where the mean of a cycle lacks places of its cells."""
    lacking = sum(len(shot.others) < len(PLACES) for shot in shots)
    if lacking == 0:
        return note
    told = f"{lacking} of {len(shots)} cycles are the mean over fewer than {1 + len(PLACES)} places of the cells."
    return f"{note} {told}".strip()


def _notes(shooting: Shooting, rests: Sequence[Rest], hopf: Sequence[Rest]) -> list[str]:
    around, along = shooting.flow.films.cells.shape[2:]
    notes = [
        f"The films keep their oil, on {around} x {along} cells: cycles are found by shooting on the time loop, "
        "with the error of the cells; multipliers are known to 5e-3."
    ]
    between = f"{hertz(rests[0].omega):.4g} and {hertz(rests[-1].omega):.4g} Hz"
    if hopf:
        return notes
    if all(rest.stable for rest in rests):
        return [*notes, f"No whirl begins between {between}: every small motion decays there."]
    return [*notes, f"No whirl begins between {between}, where small motions grow: branches begin in Hopf points only."]


def _rest(shooting: Shooting, rest: Rest) -> RestingPoint:
    speed, spins = hertz(rest.omega), list(shooting.flow.system.spins)
    return RestingPoint(speed, speed, rest.displacement, rest.wet.v[spins] / (2.0 * math.pi), rest.rates, rest.stable)


def _hopf(rest: Rest, branch: int | None, first: Shot | None) -> SpecialPoint:
    """criticality: by the first cycle, where its stability is clear."""
    number = rest.whirling
    criticality = None
    if first is not None and len(first.multipliers.others):
        largest, blur = float(np.abs(first.multipliers.others[0])), first.multipliers.defect
        criticality = SUBCRITICAL if largest > 1.0 + blur else SUPERCRITICAL if largest < 1.0 - blur else None
    return SpecialPoint(
        kind=HOPF,
        branch=branch,
        value=hertz(rest.omega),
        speed_Hz=hertz(rest.omega),
        frequency_Hz=hertz(float(rest.rates[number].imag)) if number is not None else math.nan,
        eccentricity_max=np.hypot(*rest.displacement.T),
        criticality=criticality,
    )


def _points(shooting: Shooting, rest: Rest, shots: Sequence[Shot]) -> tuple[CyclePoint, ...]:
    """The cycles of a branch from its Hopf point on, where they have no size."""
    return (_born(shooting, rest), *(_cycle(shooting, shot) for shot in shots)) if shots else ()


def _born(shooting: Shooting, rest: Rest) -> CyclePoint:
    number, speed, spins = rest.whirling, hertz(rest.omega), list(shooting.flow.system.spins)
    assert number is not None
    nu = float(rest.rates[number].imag)
    values = np.exp(np.delete(rest.rates, number) * 2.0 * math.pi / nu)
    harmonics = np.zeros((SAMPLES // 4, *rest.displacement.shape), dtype=complex)
    harmonics[0] = rest.displacement
    return CyclePoint(
        value=speed,
        speed_Hz=speed,
        frequency_Hz=hertz(nu),
        eccentricity_max=np.hypot(*rest.displacement.T),
        ring_speeds_Hz=rest.wet.v[spins] / (2.0 * math.pi),
        torque_N_m=math.nan,
        stable=bool(np.all(np.delete(rest.rates, number).real < SLOWLY * nu)),
        multipliers=np.concatenate([[1.0 + 0.0j], values]),
        harmonics=harmonics,
    )


def _cycle(shooting: Shooting, shot: Shot) -> CyclePoint:
    speed, spins = shooting.speed_Hz(shot), list(shooting.flow.system.spins)
    return CyclePoint(
        value=speed,
        speed_Hz=speed,
        frequency_Hz=shooting.unit * math.exp(-shot.mean_p[0]),
        eccentricity_max=shot.eccentricity_max,
        ring_speeds_Hz=shot.wet.v[spins] / (2.0 * math.pi),
        torque_N_m=math.nan,
        stable=shot.multipliers.stable,
        multipliers=shot.multipliers.values,
        harmonics=np.fft.rfft(shot.mean_displacements[:SAMPLES], axis=0)[: SAMPLES // 4] / SAMPLES,
        kind=shot.kind,
    )


def _special(point: CyclePoint, branch: int) -> SpecialPoint:
    return SpecialPoint(point.kind, branch, point.value, point.speed_Hz, point.frequency_Hz, point.eccentricity_max)
