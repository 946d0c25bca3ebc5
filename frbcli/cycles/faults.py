"""What limit cycles cannot be computed of, told before anything is."""

from __future__ import annotations

import math

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.linear.stability import default_speeds
from frbcli.scene.gate.analysis import CYCLES, SPEED_CYCLES
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.static import by_shooting
from frbcli.scene.keys import cavitation_keys
from frbcli.scene.shafts.table import shaft_of


def check(case: Case, shooting: bool = False) -> tuple[float, float]:
    """The range of speeds of a case in rad/s, the slowest above zero. shooting: whether cycles may be found by shooting
    on the time loop. Raises InputError."""
    require(case, SPEED_CYCLES if shooting else CYCLES)
    speeds = default_speeds(case)
    if not speeds or not speeds[-1] > speeds[0]:
        problem, remedy = "leaves no range of speeds above zero.", 'Write e.g. speed.to = "300 Hz".'
        fault = Fault("speed.to", f"{case.speed.end:g} Hz", None, problem, remedy)
        raise InputError(case.name or "case", (fault,))
    return 2.0 * math.pi * speeds[0], 2.0 * math.pi * speeds[-1]


def check_unbalance(case: Case) -> None:
    """Raises InputError if the whirl of a case with unbalance cannot be told."""
    faults = []
    if not has_unbalance(case):
        problem, remedy = "is zero: no whirl has two frequencies.", 'Write e.g. rotor.unbalance = "3 g*mm".'
        faults.append(Fault("disk.unbalance" if case.disks else "rotor.unbalance", "0 g*mm", None, problem, remedy))
    if by_shooting(case):
        problem = "keeps its oil, or has a force with kinks: its whirl with unbalance is not computed."
        remedy = "Take half-sommerfeld without openings but grooves here, and a run-up for this model."
        faults += [Fault(key, name, None, problem, remedy) for key, name in cavitation_keys(case)]
    if faults:
        raise InputError(case.name or "case", tuple(faults))


def has_unbalance(case: Case) -> bool:
    """Whether the rotor of a case has one."""
    return shaft_of(case).eccentricity != 0.0
