"""Whether the whirl at the threshold begins softly or hard, and from which speed on a disturbance is enough for it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from frbcli.case.schema import Case
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.family import check
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.criticality import lyapunov_coefficient
from frbcli.cycles.method.cycle import FOLD, Cycle
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.follower import FoldFollower
from frbcli.cycles.parts.machine import make_machine
from frbcli.cycles.result import SUBCRITICAL, SUPERCRITICAL, hertz
from frbcli.errors import FrbError
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

BESIDE = 0.03  # relative: range about the threshold in which its Hopf point is looked for


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
        near = resting_curve(system, machine, (1.0 - BESIDE) * omega, (1.0 + BESIDE) * omega)
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
