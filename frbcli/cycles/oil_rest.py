"""Resting positions of machines whose films keep their oil, and their Hopf points.

How fast a small motion grows is known from differences of the time loop, across the kinks that fronts of the oil leave
when they cross cells: it scatters by some 0.05 1/s between neighbouring speeds. A Hopf point is therefore where the
straight line through the rates of several speeds is zero, and how far they lie off that line is its uncertainty.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from frbcli.cycles.continuation import Unreachable
from frbcli.cycles.period_map import wet_at
from frbcli.cycles.shot_branch import Rest, Shooting
from frbcli.errors import NotConverged
from frbcli.linear.resting import resting_position, ring_speeds
from frbcli.rotor.held import held_rotor

RESTS = 15  # resting positions of a diagram
HALVES, NEAR = 8, 0.02  # evaluations that bring a Hopf point between two speeds so far apart, relative
FITTED, AROUND = 7, 0.015  # rates that the straight line goes through, within this of its zero, relative


@dataclass(frozen=True)
class Threshold:
    """A Hopf point. rest: the resting position there; number: of the rate that crosses zero; uncertainty: of its
    speed in rad/s, the standard error."""

    rest: Rest
    number: int
    uncertainty: float


def resting(shooting: Shooting, slowest: float, fastest: float) -> list[Rest]:
    """Resting positions in ascending order of the speed, sought from the fastest on; speeds in rad/s."""
    found: list[Rest] = []
    for omega in np.linspace(fastest, slowest, RESTS):
        rest = settled(shooting, float(omega))
        if rest is None and found:
            rest = shooting.rest(found[-1].wet, float(omega))
        if rest is not None:
            found.append(rest)
    return found[::-1]


def settled(shooting: Shooting, omega: float) -> Rest | None:
    """The resting position next to that of films whose oil is at rest, too; None if none is found."""
    system = shooting.flow.system
    try:
        q = resting_position(system, omega)
        v = np.zeros_like(q)
        v[list(system.spins)] = ring_speeds(system, held_rotor(system.rotor), omega, system.rotor.journals @ q)
        return shooting.rest(wet_at(shooting.flow, q, v, omega), omega)
    except (NotConverged, Unreachable):
        return None


def thresholds(shooting: Shooting, rests: list[Rest]) -> list[Threshold]:
    """The Hopf points between resting positions, of whirls that begin or cease to grow, others may grow beside them."""
    return [
        located(shooting, low, high, mode)
        for low, high in itertools.pairwise(rests)
        for mode in range(min(low.growing, high.growing), max(low.growing, high.growing))
    ]


def located(shooting: Shooting, low: Rest, high: Rest, mode: int = 0) -> Threshold:
    """The Hopf point between two resting positions of the whirl that grows fastest but for `mode` others."""
    for _ in range(HALVES):
        if abs(high.omega - low.omega) < NEAR * high.omega:
            break
        rest = shooting.rest(low.wet, 0.5 * (low.omega + high.omega))
        if rest is None:
            break
        if (rest.growth_of(mode) > 0.0) == (low.growth_of(mode) > 0.0):
            low = rest
        else:
            high = rest
    share = low.growth_of(mode) / (low.growth_of(mode) - high.growth_of(mode))
    middle = low.omega + share * (high.omega - low.omega)
    speeds, rates = [], []
    for omega in middle * (1.0 + AROUND * np.linspace(-1.0, 1.0, FITTED)):
        rest = shooting.rest(low.wet, float(omega))
        if rest is not None and math.isfinite(rest.growth_of(mode)):
            speeds.append(float(omega))
            rates.append(rest.growth_of(mode))
    uncertainty = math.nan
    if len(speeds) > 3:
        slope, offset = np.polyfit(speeds, rates, 1)
        scatter = math.sqrt(np.square(offset + slope * np.array(speeds) - rates).sum() / (len(speeds) - 2))
        zero = -offset / slope
        if abs(zero - middle) < 2.0 * AROUND * middle:
            middle, uncertainty = float(zero), scatter / abs(slope) / math.sqrt(len(speeds))
    rest = shooting.rest(low.wet, middle)
    rest = min(low, high, key=lambda one: abs(one.growth_of(mode))) if rest is None else rest
    return Threshold(rest, rest.nearest_to_neutral, uncertainty)
