"""The cases whose limit cycles can be computed, and the machines of a case by one of its numbers."""

from __future__ import annotations

import math
import re

from frbcli.case.rules.machine_keys import machine_fault
from frbcli.case.schema import Case
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import MOST_UNKNOWNS, Changing
from frbcli.cycles.method.mesh_error import other_films
from frbcli.cycles.parts.machine import Machine, make_machine
from frbcli.errors import InputError, input_error
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import CYCLES, SPEED_CYCLES, WHIRLS
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.speeds import default_speeds

LONGEST_SHOWN = 40  # characters of a value in a fault
REMEDY = 'Write e.g. "40 um".'
NUMBER = re.compile(r"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)(.*)", re.DOTALL)


class Family(Changing):
    """The machines of a case at a speed in rad/s, by the value of a key over its largest one, `high` in `unit`;
    settings: of other keys, KEY=VALUE; mesh: number of another mesh of their films, see other_films."""

    most_at_fold = MOST_UNKNOWNS  # each of its equations takes three machines

    def __init__(
        self, case: Case, key: str, high: float, unit: str, omega: float, settings: tuple[str, ...] = (),
        mesh: int | None = None,
    ) -> None:  # fmt: skip
        super().__init__(self._made, omega)
        self.case, self.high, self.speed, self.settings, self.mesh = case, high, omega, settings, mesh
        self.over, self.unit = key, unit

    @property
    def scale(self) -> float:
        """See MachineCourse."""
        return self.high

    def setting(self, share: float) -> str:
        """KEY=VALUE of a share of the largest value."""
        return f"{self.over}={share * self.high!r} {self.unit}".strip()

    def with_setting(self, setting: str) -> Family:
        """The machines with another setting of another key."""
        return Family(self.case, self.over, self.high, self.unit, self.speed, (setting,))

    def on_mesh(self, mesh: int) -> Family:
        """The same machines with films on another mesh."""
        return Family(self.case, self.over, self.high, self.unit, self.speed, self.settings, mesh)

    def case_at(self, share: float) -> Case:
        """The case at a share of the largest value. Raises InputError if it cannot have it."""
        case = self.case.with_settings(*self.settings, self.setting(share))
        check(case)
        return case

    def system(self, share: float) -> System:
        """The system at a share of the largest value. Raises InputError if the case cannot have it."""
        case = self.case_at(share)
        plan = make_plan(case)
        return make_system(case, plan) if self.mesh is None else other_films(plan)[self.mesh].system(case)

    def _made(self, share: float) -> Machine:
        """The machine at a share. Raises Unreachable where the number is not above zero."""
        if not share > 0.0:
            raise Unreachable
        return make_machine(self.system(share), self.speed)


def value_range(case: Case, key: str, low: str, high: str) -> tuple[float, float, str]:
    """The ends of a range of a number of the machine, text with one unit, and that unit. Raises InputError."""
    if fault := machine_fault(key, "--over or --and"):
        raise InputError(case.name or "case", (fault,))
    (first, unit), (last, other) = _number(key, low), _number(key, high)
    if unit != other or not first < last:
        problem, remedy = "is no range of one unit.", f'Write e.g. --from "40 um" --to "90 um", not {low} to {high}.'
        raise input_error(case.name or "case", key, f"{low} to {high}", problem, remedy)
    return first, last, unit


def positive_range(case: Case, key: str, low: str, high: str) -> tuple[float, float, str]:
    """value_range of a key that is followed, whose values are above zero. Raises InputError."""
    first, last, unit = value_range(case, key, low, high)
    if first <= 0.0:
        raise input_error(case.name or "case", key, low, "must be above 0 here.", "Begin above it.")
    return first, last, unit


def _number(key: str, text: str) -> tuple[float, str]:
    """A number and its unit."""
    match = NUMBER.fullmatch(text.strip())
    if match is None or not math.isfinite(float(match[1])):
        raise input_error(key, key, text[:LONGEST_SHOWN], "is no number with a unit.", REMEDY)
    return float(match[1]), match[2].strip()


def check(case: Case, shooting: bool = False, with_unbalance: bool = False) -> tuple[float, float]:
    """The range of speeds of a case in rad/s, the slowest above zero. shooting: whether cycles may be found by shooting
    on the time loop; with_unbalance: whether the whirls with it are asked for as well. Raises InputError."""
    require(case, WHIRLS if with_unbalance else SPEED_CYCLES if shooting else CYCLES)
    speeds = default_speeds(case)
    return 2.0 * math.pi * speeds[0], 2.0 * math.pi * speeds[-1]
