"""Static equilibria of machines on the time loop, and their Hopf points.

How fast a small motion grows is known from differences of the time loop, across the kinks that fronts of the oil leave
when they cross cells: it scatters, with oil by some 0.07 1/s between neighbouring speeds. A Hopf point is therefore
where the parabola through the rates of several speeds is zero. Its uncertainty has two parts: how far the rates lie off
the parabola, and how much they change with the size of the disturbance, whose error goes with its square. Without
cells rates do not scatter, and a Hopf point is where they are zero."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.shooting.period_map import wet_at
from frbcli.cycles.shooting.shots import Rest, Shooting
from frbcli.equilibrium import hopf
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import NotConverged
from frbcli.film.parabola import parabola_roots

RESTS = 15  # static equilibria of a diagram


SHARP = 1e-6  # the same where no cells blur the rates


NEAR = 0.02  # relative error of the speed about which a Hopf point is sought


FITTED, AROUND = 12, 0.04  # rates that a parabola goes through, within this of its zero, relative


WIDER = 2.0  # times the disturbance of the differences, once more: how much its size changes the rates


@dataclass(frozen=True)
class RestThreshold:
    """A Hopf point. rest: the static equilibrium there; number: of the eigenvalue that crosses the imaginary axis;
    uncertainty: of its speed in rad/s, NaN where it is not known."""

    rest: Rest
    number: int
    uncertainty: float


def resting(shooting: Shooting, slowest: float, fastest: float) -> list[Rest]:
    """Static equilibria in ascending order of the speed, sought from the fastest on; speeds in rad/s."""
    rests: list[Rest] = []
    for omega in np.linspace(fastest, slowest, RESTS):
        rest = settled(shooting, float(omega))
        if rest is None and rests:
            rest = shooting.rest(rests[-1].wet, float(omega))
        if rest is not None:
            rests.append(rest)
    return rests[::-1]


def settled(shooting: Shooting, omega: float) -> Rest | None:
    """The static equilibrium near the one with the oil at rest, too; None if none is found."""
    system = shooting.flow.system
    try:
        static = resting_position(system, omega)
        return shooting.rest(wet_at(shooting.flow, static.displacements, static.velocities(system), omega), omega)
    except (NotConverged, Unreachable):
        return None


def thresholds(shooting: Shooting, rests: list[Rest]) -> list[RestThreshold]:
    """The Hopf points between static equilibria, of whirls that begin or cease to grow; other whirls may grow there."""
    return [
        located(shooting, low, high, number)
        for low, high in itertools.pairwise(rests)
        for number in range(min(low.growing, high.growing), max(low.growing, high.growing))
    ]


def located(shooting: Shooting, low: Rest, high: Rest, number: int = 0) -> RestThreshold:
    """The Hopf point between two static equilibria of the whirl `number`, from 0, by falling growth; its uncertainty is
    NaN where the rest cannot be followed."""

    def at(omega: float) -> Rest:
        rest = shooting.rest(low.wet, omega)
        if rest is None:
            raise Unreachable
        return rest

    try:
        near = hopf.located(at, low, high, number, SHARP if shooting.flow.smooth else NEAR)
    except Unreachable:
        near = min(low, high, key=lambda one: abs(one.growth_of(number)))
    if shooting.flow.smooth:
        return _threshold(near, math.nan)
    fit = _fitted(shooting, near, number)
    rest = shooting.rest(near.wet, fit.zero)
    if rest is None:
        return _threshold(near, math.nan)
    wider = shooting.rest(rest.wet, fit.zero, WIDER)
    if wider is None:
        return _threshold(rest, math.nan)
    bent = abs(wider.growth_of(number) - rest.growth_of(number)) / (WIDER**2 - 1.0) / abs(fit.slope)
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


def _fitted(shooting: Shooting, near: Rest, number: int) -> _Fit:
    """The parabola through the rates of a whirl about the speed of a static equilibrium.

    The cells lie in different places from one speed to the next: else what they leave changes little between them."""
    places = [Shooting(shooting.flow.lying(place), shooting.unit) for place in shooting.flow.places]
    middle = near.omega
    off, rates = [], []
    for share, one in zip(np.linspace(-1.0, 1.0, FITTED), itertools.cycle([shooting, *places]), strict=False):
        rest = one.rest(near.wet, middle * (1.0 + AROUND * float(share)))
        if rest is not None and math.isfinite(rest.growth_of(number)):
            off.append(float(share))
            rates.append(rest.growth_of(number))
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
