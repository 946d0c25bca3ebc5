"""Limit cycles of a case by the time loop, over its speed: static equilibria with the motions of the oil that
films keep, Hopf points, and from each the branch of cycles by shooting. With unbalance: what the stable cycles of
nearly half the speed of a branch lock in with, if a run comes to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.compiled import working_time
from frbcli.cycles.branch import AT_REST, LEFT
from frbcli.cycles.columns import (
    SPEED,
    SUBCRITICAL,
    SUPERCRITICAL,
    Cost,
    CycleBranch,
    CyclePoint,
    LimitCycles,
    MissingWhirl,
    RestingPoint,
    SpecialPoint,
    UnbalancedWhirl,
    hertz,
)
from frbcli.cycles.diagram import SAME, CycleCount, Observer, special_cycles, with_error
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.follower import FLIP, HOPF, TORUS
from frbcli.cycles.shooting.branch import (
    OtherCells,
    follow_shots,
    other_cells,
    shot_errors,
    synchronous_shots,
    threshold_errors,
)
from frbcli.cycles.shooting.period_map import SAMPLES, STEPS_PER_REVOLUTION, PeriodMap, Wet, period_map
from frbcli.cycles.shooting.rest import RestThreshold, resting, thresholds
from frbcli.cycles.shooting.shots import Rest, Shooting, Shot, largest
from frbcli.cycles.unbalance import FREE, WHIRLS, locked_lines, nearly_half, spaced
from frbcli.errors import NotConverged

APART = 1.0 / 10.0  # of the range of speeds: distance between the cycles of a branch that are followed
SETTLING = 150  # pairs of periods of the rotor in a run, after which a whirl that locks in nearly repeats
RUNS = 5  # each of as many periods, as long as the whirl nearly repeats
LAST, PER_PERIOD = 100, 32  # of them, in which a whirl is watched, and its moments in each
REPEATS = 0.02  # change of the state in one or two periods above which a motion does not nearly repeat
SLOWLY = 1e-3  # rate of growth over the frequency that the Hopf point may have by its own pair
HELD = 0.05  # error of the trivial multiplier from which on it is stated
FIRST_SIZES = (0.1, 0.2, 0.05)  # of the first cycle next to a Hopf point


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


def limit_cycles_by_shooting(
    case: Case,
    slowest: float,
    fastest: float,
    asked: Sequence[float],
    observe: Observer | None = None,
    with_unbalance: bool = False,
) -> LimitCycles:
    """As limit_cycles, for films that are mass-conserving or whose force has kinks, and with other forces that are not
    linear; speeds in rad/s, asked: those at which cycles are computed exactly.

    Raises NotConverged where no static equilibrium is found. """
    begun = working_time().cpu_s
    flow = period_map(case)
    shooting = Shooting(flow, fastest)
    rests = resting(shooting, slowest, fastest)
    if not rests:
        raise NotConverged(f"No static equilibrium was found between {hertz(slowest):.4g} and {hertz(fastest):.4g} Hz.")
    hopf = thresholds(shooting, rests)
    count = CycleCount(observe)

    def record(shot: Shot) -> None:
        count(shooting.speed_Hz(shot), shot.eccentricity_max)

    other = other_cells(case, shooting)
    branches: list[CycleBranch] = []
    special: list[SpecialPoint] = []
    ends: list[float] = []
    for begin in hopf:
        if any(abs(end - begin.rest.omega) < SAME * begin.rest.omega for end in ends):
            special.append(_hopf(shooting, other, begin, None, None))
            continue
        shots, note = _branch(shooting, begin, (slowest, fastest), asked, record)
        if note == AT_REST:
            ends.append(2.0 * math.pi * shooting.speed_Hz(shots[-1]))
        special.append(_hopf(shooting, other, begin, len(branches), shots[0] if shots else None))
        points = _points(shooting, other, begin, shots)
        branches.append(CycleBranch(len(special) - 1, points, _with_cells(flow, note, shots)))
        if with_unbalance:
            branches[-1] = whirls_of_branch(shooting, branches[-1], shots, fastest - slowest, observe)
    response, remarks = _response(shooting, rests, (slowest, fastest), asked, record) if with_unbalance else ((), [])
    return LimitCycles(
        case=case,
        over=SPEED,
        unit="Hz",
        films=flow.names,
        equilibria=tuple(_rest(shooting, rest) for rest in rests),
        branches=tuple(branches),
        special=(*special, *special_cycles(branches, response)),
        notes=(*_notes(shooting, other, rests, hopf), *remarks),
        cost=Cost(working_time().cpu_s - begun, count.count),
        synchronous=response,
    )


def _response(
    shooting: Shooting,
    rests: Sequence[Rest],
    speeds: tuple[float, float],
    asked: Sequence[float],
    record: Callable[[Shot], None],
) -> tuple[tuple[CyclePoint, ...], list[str]]:
    """The synchronous response to the unbalance by falling speed, and what is to be said of it."""
    driven = shooting.with_all_unbalance
    shots, note = synchronous_shots(driven, rests, speeds, asked, record)
    names = {TORUS: "in a torus point", FLIP: "in a flip"}
    remarks = [] if note == LEFT else [f"Synchronous response: {note}"]
    remarks += [
        f"The synchronous response changes its stability {names[shot.kind]} at {driven.speed_Hz(shot):.4g} Hz."
        for shot in shots
        if shot.kind in names
    ]
    return tuple(_cycle(driven, shot) for shot in shots), remarks


def _branch(
    shooting: Shooting,
    begin: RestThreshold,
    speeds: tuple[float, float],
    asked: Sequence[float],
    record: Callable[[Shot], None],
) -> tuple[tuple[Shot, ...], str]:
    for size in FIRST_SIZES:
        first = shooting.from_rest(begin.rest, begin.number, size)
        if first is not None:
            return follow_shots(shooting, first, speeds, asked, record)
    return (), "No cycle was found next to the Hopf point."


def _with_cells(flow: PeriodMap, note: str, shots: Sequence[Shot]) -> str:
    """The note of a branch, which says where the mean of a cycle lacks places of its cells, and where these hold it."""
    remarks, places = [note], 1 + len(flow.places)
    lacking = sum(len(shot.others) < len(flow.places) for shot in shots)
    if lacking > 0:
        remarks.append(f"{lacking} of {len(shots)} cycles are the mean over fewer than {places} places of the cells.")
    held = max((shot.multipliers.defect for shot in shots), default=0.0)
    if held > HELD and not flow.smooth:
        remarks.append(f"Cells hold the whirl, trivial multipliers are off by {held:.2g}: take more (accuracy.mesh).")
    return " ".join(remarks).strip()


def _notes(
    shooting: Shooting, other: OtherCells | None, rests: Sequence[Rest], hopf: Sequence[RestThreshold]
) -> list[str]:
    notes = [_method(shooting, other)]
    between = f"{hertz(rests[0].omega):.4g} and {hertz(rests[-1].omega):.4g} Hz"
    if hopf:
        return notes
    if all(rest.stable for rest in rests):
        return [*notes, f"No whirl begins between {between}: every small motion decays there."]
    if not any(rest.stable for rest in rests):
        why = "small motions grow at all of these speeds, and branches begin in Hopf points. Begin at a lower speed."
        return [*notes, f"No whirl begins between {between}: {why}"]
    return [*notes, f"No whirl begins between {between}, where small motions grow: branches begin in Hopf points only."]


def _method(shooting: Shooting, other: OtherCells | None) -> str:
    if shooting.flow.smooth:
        return (
            "Forces other than film forces are not linear: cycles are found by shooting on the time loop, with an "
            "error of 1e-5 by its steps; multipliers are known to 2e-5. Errors by the films are not known."
        )
    around, along = shooting.flow.films.cells.shape[2:]
    kept = "are mass-conserving, on" if shooting.flow.held.any() else "are on"
    return (
        f"The films {kept} {around} x {along} cells: cycles are found by shooting on the time loop, "
        f"with the error of the cells; multipliers are known to 5e-3. {_errors_of(other)}"
    )


def _errors_of(other: OtherCells | None) -> str:
    if other is None:
        return "Errors by the cells are not known: there are no fewer ones to compare with."
    around, along = other.cells
    return f"Errors by the cells are from the same points and cycles on {around} x {along} of them."


def _rest(shooting: Shooting, rest: Rest) -> RestingPoint:
    speed, spins = hertz(rest.omega), list(shooting.flow.system.spins)
    turning = rest.wet.v[spins] / (2.0 * math.pi)
    return RestingPoint(
        speed, speed, shooting.flow.middles(rest.displacement), turning, rest.eigenvalues, rest.stable,
        end_eccentricity=shooting.flow.at_ends(np.hypot(*rest.displacement.T)),
    )  # fmt: skip


def _hopf(
    shooting: Shooting, other: OtherCells | None, begin: RestThreshold, branch: int | None, first: Shot | None
) -> SpecialPoint:
    """criticality: by the first cycle, where its stability is clear."""
    speed, frequency = 0.0, math.nan
    if other is not None and first is not None:
        speed, frequency = threshold_errors(shooting, other, first)
    rest, middles = begin.rest, shooting.flow.middles(begin.rest.displacement)
    criticality = None
    if first is not None and len(first.multipliers.others):
        size, blur = float(np.abs(first.multipliers.others[0])), first.multipliers.defect
        criticality = SUBCRITICAL if size > 1.0 + blur else SUPERCRITICAL if size < 1.0 - blur else None
    return SpecialPoint(
        kind=HOPF,
        branch=branch,
        value=hertz(rest.omega),
        speed_Hz=hertz(rest.omega),
        frequency_Hz=hertz(float(rest.eigenvalues[begin.number].imag)),
        eccentricity_max=np.hypot(*middles.T),
        criticality=criticality,
        value_uncertainty=hertz(math.hypot(begin.uncertainty, speed * rest.omega)),
        frequency_uncertainty_Hz=frequency * hertz(float(rest.eigenvalues[begin.number].imag)),
    )


def _points(
    shooting: Shooting, other: OtherCells | None, begin: RestThreshold, shots: Sequence[Shot]
) -> tuple[CyclePoint, ...]:
    """The cycles of a branch from its Hopf point on, where they have no size."""
    if not shots:
        return ()
    points = [_cycle(shooting, shot) for shot in shots]
    if other is not None:
        points = list(map(with_error, points, shot_errors(shooting, other, shots)))
    return _born(shooting, begin), *points


def _born(shooting: Shooting, begin: RestThreshold) -> CyclePoint:
    rest, number = begin.rest, begin.number
    speed, spins = hertz(rest.omega), list(shooting.flow.system.spins)
    nu = float(rest.eigenvalues[number].imag)
    values = np.exp(np.delete(rest.eigenvalues, number) * 2.0 * math.pi / nu)
    middles = shooting.flow.middles(rest.displacement)
    harmonics = np.zeros((SAMPLES // 4, *middles.shape), dtype=complex)
    harmonics[0] = middles
    return CyclePoint(
        value=speed,
        speed_Hz=speed,
        frequency_Hz=hertz(nu),
        eccentricity_max=np.hypot(*middles.T),
        ring_speeds_Hz=rest.wet.v[spins] / (2.0 * math.pi),
        torque_N_m=math.nan,
        stable=bool(np.all(np.delete(rest.eigenvalues, number).real < SLOWLY * nu)),
        multipliers=np.concatenate([[1.0 + 0.0j], values]),
        harmonics=harmonics,
        end_eccentricity_max=shooting.flow.at_ends(np.hypot(*rest.displacement.T)),
    )


def _cycle(shooting: Shooting, shot: Shot) -> CyclePoint:
    speed, spins = shooting.speed_Hz(shot), list(shooting.flow.system.spins)
    orbits = [shooting.flow.middles(orbit) for orbit in shot.orbits]
    return CyclePoint(
        value=speed,
        speed_Hz=speed,
        frequency_Hz=shooting.unit * math.exp(-shot.mean_p[0]),
        eccentricity_max=np.mean([largest(orbit) for orbit in orbits], axis=0),
        ring_speeds_Hz=shot.wet.v[spins] / (2.0 * math.pi),
        torque_N_m=math.nan,
        stable=shot.multipliers.stable,
        multipliers=shot.multipliers.values,
        harmonics=np.fft.rfft(np.mean(orbits, axis=0)[:SAMPLES], axis=0)[: SAMPLES // 4] / SAMPLES,
        kind=shot.kind,
        end_eccentricity_max=shooting.flow.at_ends(shot.eccentricity_max),
    )
