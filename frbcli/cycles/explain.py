"""What limit cycles say of other results: what causes the onset and the end of a whirl in a run, and whether the whirl
at a threshold begins softly or hard, and from which speed on a disturbance is enough for it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from frbcli.case.schema import Case
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.limit_cycles import check
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.equilibria import lyapunov_coefficient, resting_curve
from frbcli.cycles.method.follower import FOLD, HOPF, Cycle, FoldFollower
from frbcli.cycles.method.machine import make_machine
from frbcli.cycles.result import SUBCRITICAL, SUPERCRITICAL, LimitCycles, SpecialPoint, hertz
from frbcli.errors import FrbError
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.units import SpeedUnit

FREQUENCY_WEIGHT = 3.0  # of the frequency against the speed, where it is asked which point an event belongs to
AHEAD = 1.02  # an onset may be seen so much below its cause, by the resolution of events


def explanations(diagram: LimitCycles, events: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """A sentence for each onset and offset of a run's events that a point of the diagram explains."""
    sentences, unit = [], diagram.case.speed_unit
    for event in events:
        if event["kind"] not in ("onset", "offset"):
            continue
        seen = f"{event['kind'].capitalize()} at {unit.words(event['speed_Hz'], 1)}"
        starts = event["kind"] == "onset"
        causes = [point for point in diagram.special if point.kind in (HOPF, FOLD) and not point.synchronous]
        if starts:
            causes = [point for point in causes if point.speed_Hz <= AHEAD * event["speed_Hz"]]
        if not causes:
            sentences.append(f"{seen}: no Hopf point and no fold of the diagram without unbalance causes it.")
            continue
        cause = min(causes, key=lambda point: _distance(point, event))
        sentences.append(f"{seen}: {_sentence(cause, starts, event['speed_Hz'], unit)}")
    return tuple(sentences)


def _distance(point: SpecialPoint, event: Mapping[str, Any]) -> float:
    """How little a point fits to an event: logarithms of the ratios of their speeds and frequencies."""
    frequency = event["frequency_Hz"]
    off = abs(math.log(point.frequency_Hz / frequency)) if frequency else 0.0
    return FREQUENCY_WEIGHT * off + abs(math.log(point.speed_Hz / event["speed_Hz"]))


def _sentence(cause: SpecialPoint, starts: bool, speed_Hz: float, unit: SpeedUnit) -> str:
    where = f"{unit.words(cause.speed_Hz, 1)} ({cause.frequency_Hz:.1f} Hz)"
    off = unit.words(abs(speed_Hz - cause.speed_Hz), 1)
    if starts and cause.kind == HOPF:
        soft = {"supercritical": "soft ", "subcritical": "hard "}.get(cause.criticality or "", "")
        return f"a whirl grows at rest from the {soft}Hopf point at {where} on; it is seen {off} later."
    if starts:
        return f"stable cycles begin in the fold at {where}; a disturbance led there {off} above it."
    if cause.kind == HOPF:
        return f"the cycles shrink to rest in the Hopf point at {where}, {off} away."
    return f"the cycles end in the fold at {where}, {off} away."


SEARCH_RANGE = 0.03  # relative: range about the threshold in which its Hopf point is looked for


@dataclass(frozen=True)
class ThresholdKind:
    """criticality: "supercritical": a soft threshold, the whirl grows with the speed; "subcritical": a hard one, it
    jumps; fold_Hz: then from this speed on, below the threshold, there is a stable whirl that a disturbance leads to;
    None of a soft threshold, or if no fold was found."""

    criticality: str
    fold_Hz: float | None


def threshold_kind(case: Case, threshold_Hz: float) -> ThresholdKind | None:
    """What begins at the threshold in Hz of a case that is stable at rest below it; None where this is not known: for
    films whose force does not follow from the motion alone, or next to the change from one kind to the other."""
    try:
        slowest, fastest = check(case)
        system = make_system(case, make_plan(case))
        machine = make_machine(system, fastest)
        omega = 2.0 * math.pi * threshold_Hz
        near = resting_curve(system, machine, (1.0 - SEARCH_RANGE) * omega, (1.0 + SEARCH_RANGE) * omega)
    except (FrbError, Unreachable):
        return None
    if not near.hopf:
        return None
    hopf = min(near.hopf, key=lambda point: abs(point.equilibrium.omega - omega))
    sign = lyapunov_coefficient(hopf).sign
    if sign == 0:
        return None
    if sign < 0:
        return ThresholdKind(SUPERCRITICAL, None)
    folds: list[float] = []

    def watch(cycle: Cycle) -> bool:
        if cycle.kind == FOLD:
            folds.append(hertz(cycle.y[-1] * machine.pace))
        return bool(folds)

    follow_branch(FoldFollower(MachineCourse(machine), slowest / fastest), first_place(hopf), until=watch)
    return ThresholdKind(SUBCRITICAL, folds[0] if folds and folds[0] < threshold_Hz else None)
