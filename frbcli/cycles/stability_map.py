"""A stability map: the curves of Hopf points and of folds over the rotor speed and a second number of the case, and
where the resting position is unstable."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from frbcli.case.schema import Case
from frbcli.cycles.branch import FOLD, HOPF, Cycle, FoldFollower, amplitude, eccentricities
from frbcli.cycles.continuation import Equations, Place, Unreachable, step_from
from frbcli.cycles.criticality import lyapunov_coefficient
from frbcli.cycles.diagram import Walk, criticality_of, cycle_special, hopf_special
from frbcli.cycles.equilibria import OverSpeed, Resting, hopf_at, resting_curve, settled
from frbcli.cycles.family import Family, value_range
from frbcli.cycles.faults import check
from frbcli.cycles.machine import Machine
from frbcli.cycles.plane_curves import (
    MOST_HARMONICS,
    fitted_fold,
    fold_equations,
    follow_both,
    hopf_equations,
    with_harmonics,
)
from frbcli.cycles.result import SPEED, SpecialPoint
from frbcli.errors import Fault, InputError, NotConverged

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

BAUTIN, CUSP = "bautin", "cusp"
SHADED = 41  # values of the second number, and
SPEEDS = 200  # speeds, at which the growth at rest is told
KNOWN = 4e-3  # distance in the plane, over its size, and of the frequency: a point lies on a curve that is known
SMALL = 0.04  # amplitude over the clearance below which a curve of folds has come to that of Hopf points
MET = "It meets the curve of Hopf points."


@dataclass(frozen=True)
class MapPoint:
    """A point of a curve. value: of the second number; eccentricity_max: (F,); criticality, lyapunov: of Hopf points,
    see SpecialPoint; kind: "", "bautin" where the criticality changes, "cusp" where a curve of folds turns back."""

    value: float
    speed_Hz: float
    frequency_Hz: float
    eccentricity_max: Array
    criticality: str | None = None
    lyapunov: float = math.nan
    kind: str = ""


@dataclass(frozen=True)
class MapCurve:
    """A curve of Hopf points or folds; notes: why it ends within the map, if it does."""

    kind: str
    points: tuple[MapPoint, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class MapRow:
    """The special points at one value of the second number, in which curves begin; problem: why there are none, else
    empty."""

    value: float
    special: tuple[SpecialPoint, ...]
    problem: str = ""


@dataclass(frozen=True)
class Growth:
    """values: (V,); speeds_Hz: (S,); rate: (V, S) 1/s, of the whirl that grows fastest at rest, NaN where no resting
    position is known."""

    values: Array
    speeds_Hz: Array
    rate: Array


@dataclass(frozen=True)
class StabilityMap:
    """curves: of Hopf points and folds; rows: ascending in the value of the key, in `unit`."""

    case: Case
    key: str
    unit: str
    films: tuple[str, ...]
    curves: tuple[MapCurve, ...]
    rows: tuple[MapRow, ...]
    growth: Growth

    @property
    def special(self) -> tuple[MapPoint, ...]:
        """The points where the criticality changes, and the cusps."""
        return tuple(point for curve in self.curves for point in curve.points if point.kind)

    def to_pandas(self) -> pd.DataFrame:
        """One row per point of a curve."""
        import pandas as pd

        return pd.DataFrame(
            {
                self.key: point.value,
                "unit": self.unit,
                "curve": number,
                "kind": point.kind or curve.kind,
                "speed_Hz": point.speed_Hz,
                "frequency_Hz": point.frequency_Hz,
                "eccentricity_max": float(point.eccentricity_max.max()),
                "criticality": point.criticality,
                "lyapunov_1_s": point.lyapunov,
            }
            for number, curve in enumerate(self.curves)
            for point in curve.points
        )


def stability_map(
    case: Case, key: str, low: str, high: str, count: int = 3, observe: Callable[[int, int], None] | None = None
) -> StabilityMap:
    """The map of a case over its speed range and a key from `low` to `high`, as text with their unit, above zero.

    count: of values of the key at which diagrams are computed that curves begin in; observe: called with the number of
    each of them and their number. Raises InputError if the values are none, or if the case cannot have one of them.
    """
    slowest, fastest = check(case)
    first, last, unit = value_range(case, key, low, high)
    if first <= 0.0:
        raise InputError(case.name or "case", (Fault(key, low, None, "must be above 0 here.", "Begin above it."),))
    plane = _Plane(Family(case, key, last, unit, fastest), (slowest, fastest), (first / last, 1.0))
    rows, begun = [], _Begun([], [])
    for number, share in enumerate(np.linspace(first / last, 1.0, count)):
        rows.append(_row(plane, float(share), begun))
        if observe is not None:
            observe(number + 1, count)
    curves: list[MapCurve] = []
    for hopf in begun.hopf:
        curves += _new_curve(plane, curves, HOPF, hopf)
    for fold in begun.folds:
        curves += _new_curve(plane, curves, FOLD, fold)
    names = plane.family.machine(1.0).names
    return StabilityMap(case, key, unit, names, tuple(curves), tuple(rows), _growth(plane))


@dataclass(frozen=True)
class _Plane:
    """speeds: rad/s; shares: of the largest value of the second number."""

    family: Family
    speeds: tuple[float, float]
    shares: tuple[float, float]

    @property
    def pace(self) -> float:
        return self.family.omega

    @property
    def corners(self) -> tuple[Array, Array]:
        """The lowest and the highest of the last two unknowns of a curve."""
        low, high = ((speed / self.pace, share) for speed, share in zip(self.speeds, self.shares, strict=True))
        return np.array(low), np.array(high)

    def at(self, y: Array) -> Machine:
        return self.family.machine(float(y[-1]))


@dataclass(frozen=True)
class _Begun:
    """Points that curves begin in, as their unknowns."""

    hopf: list[Array]
    folds: list[Array]


def _row(plane: _Plane, share: float, begun: _Begun) -> MapRow:
    """The special points at a share, which are added to `begun`, too."""
    value, machine = share * plane.family.high, plane.family.machine(share)
    try:
        resting = resting_curve(plane.family.system(share), machine, *plane.speeds)
    except (NotConverged, Unreachable) as error:
        return MapRow(value, (), str(error) or "The resting positions could not be followed.")
    walk = _walk(plane, machine, resting)
    special: list[SpecialPoint] = []
    for number, hopf in enumerate(resting.hopf):
        here = hopf.equilibrium
        begun.hopf.append(np.concatenate([here.u, [hopf.nu / plane.pace, here.omega / plane.pace, share]]))
        special.append(hopf_special(walk, hopf, number))
        branch = walk.branch_from(hopf, _unwatched)
        for cycle in branch.cycles:
            if cycle.kind == FOLD:
                begun.folds.append(np.append(cycle.y, share))
                special.append(cycle_special(walk, cycle, number))
    return MapRow(value, tuple(special))


def _unwatched(_: Cycle) -> None:
    """Branches of a map are not told."""


def _walk(plane: _Plane, machine: Machine, resting: Resting) -> Walk:
    return Walk(
        over=SPEED,
        unit="Hz",
        films=machine.names,
        course=OverSpeed(machine),
        resting=resting,
        scale=0.5 / math.pi,
        follower=FoldFollower(machine, *plane.speeds),
        branch_scale=machine.pace / (2.0 * math.pi),
    )


def _new_curve(plane: _Plane, known: Sequence[MapCurve], kind: str, start: Array) -> list[MapCurve]:
    """The curve through a point, unless it is known or not found."""
    machines, size = plane.family.machine, plane.at(start).size
    if kind == FOLD and (len(start) - 3) // size // 2 > MOST_HARMONICS:
        start = with_harmonics(start, size, MOST_HARMONICS)
    if any(_lies_on(plane, curve, _point(plane, kind, start)) for curve in known if curve.kind == kind):
        return []

    def equations(y: Array) -> Equations:
        return (hopf_equations if kind == HOPF else fold_equations)(machines, y)

    def met(place: Place) -> str:
        return MET if kind == FOLD and amplitude(plane.at(place.y), place.y[:-1]) < SMALL else ""

    if kind == HOPF:
        found = follow_both(equations, start, plane.corners)
    else:
        found = follow_both(equations, start, plane.corners, lambda place: fitted_fold(machines, place), met)
    if found is None:
        return []
    points = [_point(plane, kind, place.y) for place in found.places]
    between = [
        _special_between(plane, equations, kind, pair, ends)
        for pair, ends in zip(itertools.pairwise(found.places), itertools.pairwise(points), strict=True)
    ]
    told = [points[0]]
    for special, point in zip(between, points[1:], strict=True):
        told += [*special, point]
    return [MapCurve(kind, tuple(told), tuple(filter(None, found.notes)))]


def _point(plane: _Plane, kind: str, y: Array) -> MapPoint:
    machine, nu, omega = plane.at(y), float(y[-3] * plane.pace), float(y[-2] * plane.pace)
    value, told = float(y[-1] * plane.family.high), (omega / (2.0 * math.pi), nu / (2.0 * math.pi))
    if kind == FOLD:
        return MapPoint(value, *told, eccentricities(machine, y[:-1]))
    here = settled(machine, y[:-3], omega, omega)
    found = lyapunov_coefficient(machine, hopf_at(machine, here, True, nu))
    d = here.u[: 2 * machine.film_count].reshape(-1, 2)
    return MapPoint(value, *told, np.hypot(d[:, 0], d[:, 1]), criticality_of(found), found.value.real)


def _special_between(
    plane: _Plane,
    equations: Callable[[Array], Equations],
    kind: str,
    pair: tuple[Place, Place],
    ends: tuple[MapPoint, MapPoint],
) -> list[MapPoint]:
    """The point between two places of a curve where the criticality changes, or a cusp."""
    place, other = pair
    if kind == HOPF:
        if not ends[0].lyapunov * ends[1].lyapunov < 0.0:
            return []
        found = _zero(equations, pair, lambda one: _point(plane, HOPF, one.y).lyapunov)
        named = BAUTIN
    else:
        along = place.tangent[-2:]
        if len(place.y) != len(other.y) or not float(along @ other.tangent[-2:]) < 0.0:
            return []
        found = _zero(equations, pair, lambda one: float(along @ one.tangent[-2:]))
        named = CUSP
    if found is None:
        return []
    point = _point(plane, kind, found.y)
    return [MapPoint(point.value, point.speed_Hz, point.frequency_Hz, point.eccentricity_max, kind=named)]


def _zero(
    equations: Callable[[Array], Equations], pair: tuple[Place, Place], told: Callable[[Place], float]
) -> Place | None:
    """Where a number of the places between two changes its sign."""
    from scipy.optimize import brentq

    place, other = pair
    asked, length = equations(place.y), float((other.y - place.y) @ place.tangent)

    def at(along: float) -> Place:
        if along in (0.0, length):
            return place if along == 0.0 else other
        found = step_from(asked, place, along)
        if found is None:
            raise Unreachable
        turned = found.tangent if found.tangent @ place.tangent > 0.0 else -found.tangent
        return Place(found.y, turned)

    try:
        return at(float(brentq(lambda along: told(at(along)), 0.0, length, xtol=1e-6 * abs(length), maxiter=40)))
    except (Unreachable, ValueError, RuntimeError):
        return None


def _lies_on(plane: _Plane, curve: MapCurve, point: MapPoint) -> bool:
    """Whether a point is one of a curve, by its distance from the straight lines between its points."""
    pace = plane.pace / (2.0 * math.pi)

    def placed(one: MapPoint) -> Array:
        return np.array([one.speed_Hz / pace, one.value / plane.family.high, one.frequency_Hz / pace])

    at = placed(point)
    for one, other in itertools.pairwise(curve.points):
        a, along = placed(one), placed(other) - placed(one)
        length = float(along @ along)
        share = min(max(float((at - a) @ along) / length, 0.0), 1.0) if length > 0.0 else 0.0
        if float(np.linalg.norm(at - a - share * along)) < KNOWN:
            return True
    return False


def _growth(plane: _Plane) -> Growth:
    shares = np.linspace(*plane.shares, SHADED)
    speeds = np.linspace(*plane.speeds, SPEEDS)
    rate = np.full((SHADED, SPEEDS), np.nan)
    for row, share in zip(rate, shares, strict=True):
        try:
            machine = plane.family.machine(float(share))
            resting = resting_curve(plane.family.system(float(share)), machine, *plane.speeds)
        except (NotConverged, Unreachable):
            continue
        known = [point.omega for point in resting.points]
        rates = [max(point.growth(0), -1e9) for point in resting.points]
        row[:] = np.interp(speeds, known, rates, left=np.nan)
    return Growth(shares * plane.family.high, speeds / (2.0 * math.pi), rate)

