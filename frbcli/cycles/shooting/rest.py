"""Resting positions of machines whose films keep their oil, and their Hopf points.

How fast a small motion grows is known from differences of the time loop, across the kinks that fronts of the oil leave
when they cross cells: it scatters by some 0.07 1/s between neighbouring speeds. A Hopf point is therefore where the
parabola through the rates of several speeds is zero. Its uncertainty has two parts: how far the rates lie off the
parabola, and how much they change with the size of the disturbance, whose error goes with its square.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.shooting.period_map import wet_at
from frbcli.cycles.shooting.shots import AT_REST_DIFFERENCE, PLACES, Rest, Shooting
from frbcli.equilibrium.resting import resting_position, ring_speeds
from frbcli.errors import NotConverged
from frbcli.film.parabola import parabola_roots
from frbcli.rotor.held import held_rotor

RESTS = 15  # resting positions of a diagram
HALVES, NEAR = 8, 0.02  # evaluations that bring a Hopf point between two speeds so far apart, relative
FITTED, AROUND = 12, 0.04  # rates that a parabola goes through, within this of its zero, relative
WIDER = 2.0  # times the disturbance of the differences, once more: how much its size changes the rates


@dataclass(frozen=True)
class RestThreshold:
    """A Hopf point. rest: the resting position there; number: of the rate that crosses zero; uncertainty: of its
    speed in rad/s, NaN where it is not known."""

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
        v[list(system.spins)] = ring_speeds(system, held_rotor(system.rotor, omega), omega, system.rotor.journals @ q)
        return shooting.rest(wet_at(shooting.flow, q, v, omega), omega)
    except (NotConverged, Unreachable):
        return None


def thresholds(shooting: Shooting, rests: list[Rest]) -> list[RestThreshold]:
    """The Hopf points between resting positions, of whirls that begin or cease to grow, others may grow beside them."""
    return [
        located(shooting, low, high, mode)
        for low, high in itertools.pairwise(rests)
        for mode in range(min(low.growing, high.growing), max(low.growing, high.growing))
    ]


def located(shooting: Shooting, low: Rest, high: Rest, mode: int = 0) -> RestThreshold:
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
    fit = _fitted(shooting, low, middle, mode)
    rest = shooting.rest(low.wet, fit.zero)
    if rest is None:
        return _threshold(min(low, high, key=lambda one: abs(one.growth_of(mode))), math.nan)
    wider = shooting.rest(rest.wet, fit.zero, WIDER * AT_REST_DIFFERENCE)
    if wider is None:
        return _threshold(rest, math.nan)
    bent = abs(wider.growth_of(mode) - rest.growth_of(mode)) / (WIDER**2 - 1.0) / abs(fit.slope)
    return _threshold(rest, math.hypot(fit.uncertainty, bent))


def _threshold(rest: Rest, uncertainty: float) -> RestThreshold:
    return RestThreshold(rest, rest.nearest_to_neutral, uncertainty)


@dataclass(frozen=True)
class _Fit:
    """Where the parabola through rates is zero in rad/s, its slope there in 1/s over rad/s, and by how much the scatter
    of the rates makes the zero uncertain, in rad/s: NaN both where no parabola was found."""

    zero: float
    slope: float = math.nan
    uncertainty: float = math.nan


def _fitted(shooting: Shooting, near: Rest, middle: float, mode: int) -> _Fit:
    """The parabola through the rates of a whirl about a speed.

    The cells lie in different places from one speed to the next: else what they leave changes little between them."""
    places = [Shooting(shooting.flow.lying(place), shooting.unit) for place in PLACES]
    off, rates = [], []
    for share, one in zip(np.linspace(-1.0, 1.0, FITTED), itertools.cycle([shooting, *places]), strict=False):
        rest = one.rest(near.wet, middle * (1.0 + AROUND * float(share)))
        if rest is not None and math.isfinite(rest.growth_of(mode)):
            off.append(float(share))
            rates.append(rest.growth_of(mode))
    if len(off) > FITTED // 2:
        curve = np.polynomial.Polynomial.fit(off, rates, 2, domain=[-1.0, 1.0])
        c, b, a = curve.coef.tolist()
        zero = min(parabola_roots(a, b, c), key=abs)  # a is round-off where the rates lie on a straight line
        if abs(zero) < 1.0:
            scatter = math.sqrt(np.square(curve(np.array(off)) - rates).sum() / (len(off) - 3))
            slope = (b + 2.0 * a * zero) / (middle * AROUND)
            blur = 1.5 * scatter / abs(slope) / math.sqrt(len(off))  # of its value in the middle
            return _Fit(middle * (1.0 + AROUND * zero), slope, blur)
    return _Fit(middle)
