"""Rules, and the analyses that they hold for.

A rule of the gate, with the analyses that it holds for.

The analyses that a case can be asked for, as the gate knows them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from frbcli.case.schema import Case
from frbcli.errors import Fault

Faults = Iterable[Fault]


@dataclass(frozen=True)
class Rule:
    """A rule. of: the faults of a case; analyses: that it holds for; last: whether it is asked only of a case that has
    passed all rules before, since it needs their subjects to be whole; moving: whether it holds for a run, but not for
    the plan of a run that films at rest are made by."""

    of: Callable[[Case], Faults]
    analyses: tuple[str, ...]
    last: bool = False
    moving: bool = False


def refusal(
    analyses: tuple[str, ...], key: str, asked: Callable[[Case], str | None], problem: str, remedy: str
) -> Rule:
    """A rule of one key. asked: its value in a case that is refused, None in others; problem: without the full stop."""

    def faults(case: Case) -> Faults:
        value = asked(case)
        return () if value is None else (Fault(key, value, None, f"{problem}.", remedy),)

    return Rule(faults, analyses)


def oil_flow_signal(case: Case) -> str | None:
    """The signal, where a case asks for the oil that leaves the films."""
    return "oil-flow" if "oil-flow" in case.output.signals else None


def run_omega(case: Case) -> float:
    """Highest speed of the rotor in a run, rad/s."""
    return 2.0 * math.pi * case.speed.top


def sheet_top(case: Case) -> float:
    """Highest speed in Hz of a sheet of bearings. Raises InputError for a case without speeds."""
    if case.given_speed is not None:
        return case.speed.top
    problem, remedy = "is missing.", 'Give --speed, e.g. --speed "900 Hz", or add [speed].'
    raise case.refused(Fault("speed", "", None, problem, remedy))


def motion_omega(case: Case) -> float:
    """Speed in rad/s that a kinematic test refers to: of the journal, else of its motion."""
    motion = case.motion
    return 2.0 * math.pi * abs((motion and (motion.speed or motion.frequency or motion.whirl_speed)) or 1.0)


FILMS = "films"  # whatever needs the films of a case and has no rules of its own
RUN = "run"  # run-up, run-down, sweep, fit and compare
STILL = "plan of films at rest"  # has the rules of a run except for moving films
ROTATION, SQUEEZE, WHIRL = KINEMATIC = "rotation", "squeeze", "whirl"
COMPARISON, LADDER = "comparison", "accuracy"
HEAT = "heat"
SHEETS = BEARING, LOADED, CHART = "bearing sheet", "bearing sheet under a given load", "sheet over the eccentricity"
STABILITY, RANGE = "stability", "stability over the speed range"  # and response and damped modes
CYCLES, SPEED_CYCLES, WHIRLS = "limit cycles", "limit cycles over the speed", "whirls with unbalance"

ALL = (
    FILMS, RUN, *KINEMATIC, COMPARISON, LADDER, HEAT, *SHEETS, STABILITY, RANGE, CYCLES, SPEED_CYCLES, WHIRLS
)  # fmt: skip
EVERY_CYCLE = (CYCLES, SPEED_CYCLES, WHIRLS)
