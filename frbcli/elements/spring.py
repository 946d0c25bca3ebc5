"""Springs between places of a machine: linear ones, cubic ones, and stops with a gap, against which a rotor rubs.

With the displacement r = |d| and the depth e = r - gap > 0 the force along d is -N, N = k e + c e^3 + C e'; a stop does
not pull, and rubs with mu N against the sliding u = R Omega + v_t of the surface of a shaft of the radius R, whose
centre moves with v_t across d. With R the friction has the torque -mu N R on the shaft, and the power mu N u is lost. A
linear spring is part of the machine's matrices.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.case.over_time import node_at
from frbcli.case.schema import Case
from frbcli.case.surroundings import Spring
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.forces import equal_places
from frbcli.errors import Fault
from frbcli.rotor.assembly import GROUND, Link
from frbcli.rotor.loads import LinearPart
from frbcli.rotor.port import (
    D_X,
    D_Y,
    F_X,
    F_Y,
    GRIP,
    SPEED,
    TORQUE,
    V_X,
    V_XX,
    V_XY,
    V_Y,
    V_YX,
    V_YY,
    XX,
    XY,
    YX,
    YY,
    ForceLaw,
    fingerprint,
    problem_of,
)  # fmt: skip
from frbcli.units import display

STIFFNESS, CUBIC, GAP, DAMPING, FRICTION, RADIUS = range(6)  # of the numbers of a law
STICKS = 1e-3  # m/s: sliding below which friction falls to nothing, tanh(u / STICKS)
SMALL = 1e-5  # m: over which a spring without a gap counts
LAWS = "force_laws"  # among the versions of a run


@dataclass(frozen=True)
class SpringForce(ForceLaw):
    """The force of a spring that is not linear."""

    given: Spring

    @property
    def numbers(self) -> Array:
        given = self.given
        radius = -1.0 if given.radius is None else given.radius
        return np.array([given.stiffness or 0.0, given.cubic, given.gap, given.damping, given.friction, radius])

    @property
    def length(self) -> float:
        """The gap; of a cubic spring the displacement at which its stiffness has changed by three halves."""
        given = self.given
        if given.gap:
            return given.gap
        return math.sqrt(0.5 * given.stiffness / given.cubic) if given.stiffness else SMALL

    @property
    def brakes(self) -> bool:  # type: ignore[override]
        """See ForceLaw: friction with a known lever."""
        return self.given.friction > 0.0 and self.given.radius is not None

    @staticmethod
    def force(numbers: Any, memory: Any, motion: Any, answer: Any) -> None:
        d_x, d_y, v_x, v_y = motion[D_X], motion[D_Y], motion[V_X], motion[V_Y]
        gap, damping = numbers[GAP], numbers[DAMPING]
        r = math.sqrt(d_x * d_x + d_y * d_y)
        depth = r - gap
        for i in range(len(answer)):
            answer[i] = 0.0
        if gap == 0.0:  # the force along d, and the damper in all directions
            along = numbers[STIFFNESS] + numbers[CUBIC] * r * r
            answer[F_X], answer[F_Y] = -along * d_x - damping * v_x, -along * d_y - damping * v_y
            answer[XX] = -along - 2.0 * numbers[CUBIC] * d_x * d_x
            answer[YY] = -along - 2.0 * numbers[CUBIC] * d_y * d_y
            answer[XY] = answer[YX] = -2.0 * numbers[CUBIC] * d_x * d_y
            answer[V_XX] = answer[V_YY] = -damping
            return
        if depth <= 0.0:
            return
        n_x, n_y = d_x / r, d_y / r
        approach, across = n_x * v_x + n_y * v_y, n_x * v_y - n_y * v_x
        pushed = numbers[STIFFNESS] * depth + numbers[CUBIC] * depth**3 + damping * approach
        if pushed <= 0.0:
            return
        slope = numbers[STIFFNESS] + 3.0 * numbers[CUBIC] * depth * depth
        # N = N(r, r'), of which r' = n . v turns with n: the normal force by d and by v
        n_dx, n_dy = slope * n_x - damping * across * n_y / r, slope * n_y + damping * across * n_x / r
        rub, rub_slope = _friction(numbers, motion[SPEED], across)
        # The force is -N (n + rub t) with t = (-n_y, n_x), n and t turn with d, and rub follows v_t = t . v
        t_x, t_y = -n_y, n_x
        e_x, e_y = n_x + rub * t_x, n_y + rub * t_y
        b_x, b_y = pushed / r * (t_x - rub * n_x), pushed / r * (t_y - rub * n_y)  # N d(n + rub t) by the angle, over r
        w = pushed * rub_slope
        s = -w * approach / r  # v_t falls by r' over r as d turns
        answer[F_X], answer[F_Y] = -pushed * e_x, -pushed * e_y
        lever = max(numbers[RADIUS], 0.0)
        answer[TORQUE], answer[GRIP] = -lever * pushed * rub, lever * lever * w
        answer[XX] = -(e_x * n_dx + b_x * t_x + s * t_x * t_x)
        answer[XY] = -(e_x * n_dy + b_x * t_y + s * t_x * t_y)
        answer[YX] = -(e_y * n_dx + b_y * t_x + s * t_y * t_x)
        answer[YY] = -(e_y * n_dy + b_y * t_y + s * t_y * t_y)
        answer[V_XX] = -(damping * e_x * n_x + w * t_x * t_x)
        answer[V_XY] = -(damping * e_x * n_y + w * t_x * t_y)
        answer[V_YX] = -(damping * e_y * n_x + w * t_y * t_x)
        answer[V_YY] = -(damping * e_y * n_y + w * t_y * t_y)


def _friction(numbers: Any, speed: float, across: float) -> tuple[float, float]:
    """Friction over the normal force, and its slope by the velocity v_t across the gap in s/m."""
    if numbers[FRICTION] == 0.0:
        return 0.0, 0.0
    if numbers[RADIUS] < 0.0 and speed != 0.0:
        return math.copysign(numbers[FRICTION], speed), 0.0
    share = math.tanh((max(numbers[RADIUS], 0.0) * speed + across) / STICKS)
    return numbers[FRICTION] * share, numbers[FRICTION] * (1.0 - share * share) / STICKS


@dataclass(frozen=True)
class SpringElement(MachineElement):
    """A spring between two nodes, the second of which may be the ground. number: in the case, from 1."""

    number: int
    nodes: tuple[str, str]
    given: Spring

    arrow: ClassVar[tuple[str, str] | None] = ("K", "a spring or a stop")
    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for number, spring in enumerate(case.springs):
            first, second = (node_at(case, each) if each else GROUND for each in spring.ends)
            yield cls(f"spring.{number}", number + 1, (first, second), spring)

    @property
    def acts_on(self) -> str:
        return self.nodes[0]

    def parts(self, site: Site) -> Parts:
        ends = [equal_places(node, site) for node in self.nodes if node != GROUND]
        count = 1.0 if any(node.startswith("disk") for node in self.nodes) else max(ends)
        given, link = self.given, Link(*self.nodes, count)
        if not given.linear:
            law = given.own_law if given.law else SpringForce(given)
            signal = law.quantity or ("stop_force" if given.gap else "spring_force")
            return Parts(ports=((f"{signal}_{self.number}", link, law),))
        part = LinearPart.of((given.stiffness or 0.0) * np.eye(2), given.damping * np.eye(2))
        return Parts(links=((link, part),))

    def faults(self) -> list[Fault]:
        problem = problem_of(self.given.own_law) if self.given.law else ""
        return [Fault(self.key, self.given.law, None, problem, "Correct the law.")] if problem else []

    def plan_line(self, site: Site) -> Line:
        given, (first, second) = self.given, (each.replace("_", " ") or "the ground" for each in self.nodes)
        values = [display(given.stiffness, "N/m")] if given.stiffness else []
        values += [display(given.cubic, "N/m^3")] if given.cubic else []
        values += [display(given.damping, "N*s/m")] if given.damping else []
        reason = "linear, part of the rotor's matrices" if given.linear else "not linear; at rest by its slope there"
        if given.gap:
            reason = f"touches beyond {display(given.gap, 'm')}"
            reason += f", rubs with a coefficient of {given.friction:g}" if given.friction else ""
        if given.law:
            values, reason = [given.law], "a force law added from Python"
        return "spring", f"{first}: {', '.join(values)}", f"against {second}; {reason}"


def law_record(case: Case) -> dict[str, str]:
    """The record of the force laws of a run that were added from Python; empty without any."""
    laws = (spring for spring in case.springs if spring.law)
    words = ", ".join(f"{spring.law} with forces {fingerprint(spring.own_law)}" for spring in laws)
    return {LAWS: words} if words else {}
