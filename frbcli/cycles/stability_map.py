"""A stability map: the curves of Hopf points and of folds over two numbers, the rotor speed and one of the case or two
of the case, and where the static equilibrium is unstable."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, table_of
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.columns import SpecialPoint, hertz, map_columns
from frbcli.cycles.diagram import criticality_of, cycle_special, hopf_special
from frbcli.cycles.limit_cycles import Family, check, positive_range
from frbcli.cycles.map_curves import (
    MOST_HARMONICS,
    KeyPlane,
    MapPlane,
    SpeedPlane,
    fitted,
    fold_equations,
    follow_both,
    hopf_equations,
)
from frbcli.cycles.method.continuation import Equations, Place, Unreachable, located
from frbcli.cycles.method.equilibria import MachineCourse, hopf_at, lyapunov_coefficient, settled
from frbcli.cycles.method.follower import FOLD, HOPF, amplitude, eccentricities, with_harmonics
from frbcli.errors import NotConverged, input_error

BAUTIN, CUSP = "bautin", "cusp"
ACROSS = 200  # values of the first number at which the growth at rest is evaluated
KNOWN = 4e-3  # distance in the plane, over its size, and of the frequency: a point lies on a curve that is known
SMALL = 0.04  # amplitude over the clearance below which a curve of folds has reached the curve of Hopf points
SHARP = 1e-6  # of a step: how closely a cusp or a change of the criticality is located
MET = "It meets the curve of Hopf points."


@dataclass(frozen=True)
class MapPoint:
    """A point of a curve. over, value: of the first and the second number, the speed in Hz; eccentricity_max: (F,);
    criticality, lyapunov: of Hopf points, see SpecialPoint; kind: "", "bautin" where the criticality changes, "cusp"
    where a curve of folds turns back."""

    over: float
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
    """values: (V,) of the second number; over: (S,) of the first; rate: (V, S) 1/s, of the whirl that grows fastest at
    rest, NaN where no static equilibrium is known."""

    values: Array
    over: Array
    rate: Array


@dataclass(frozen=True, repr=False)
class StabilityMap(Tabular):
    """over, over_unit: the first number, "speed" in Hz or a key; key, unit: the second one; curves: of Hopf points and
    folds; rows: ascending in the value of the key, in `unit`."""

    case: Case
    over: str
    over_unit: str
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

    def table(self) -> Table:
        """One row per point of a curve."""
        columns = map_columns(self.over, self.over_unit, self.key, self.unit)
        points = ((number, curve, point) for number, curve in enumerate(self.curves) for point in curve.points)
        return table_of(columns, points)


@dataclass(frozen=True)
class Across:
    """A first number of a map instead of the speed: a key from `low` to `high`, text with units, above zero, at a speed
    of the rotor in Hz."""

    key: str
    low: str
    high: str
    speed_Hz: float


def stability_map(
    case: Case,
    key: str,
    low: str,
    high: str,
    count: int = 3,
    observe: Callable[[int, int], None] | None = None,
    across: Across | None = None,
) -> StabilityMap:
    """Map Hopf points and folds of limit cycles over the speed and a key of the case.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    key : str
        A number of the machine.
    low, high : str
        Values between which it varies, with units, above zero.
    count : int
        Values of the key at which diagrams are computed that curves begin in.
    observe : callable, optional
        Called with the number of each of them and their number.
    across : Across, optional
        Another number, instead of the speed.

    Returns
    -------
    StabilityMap
        Curves of Hopf points and folds.

    Raises
    ------
    InputError
        If the values are none, or if the case cannot have one of them.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.stability_map(case, "oil.viscosity", "8 mPa*s", "14 mPa*s")  # doctest: +SKIP
    """
    plane = _plane(case, (key, low, high), across)
    lowest = float(plane.corners[0][1])
    rows, begun = [], _Begun([], [])
    for number, share in enumerate(np.linspace(lowest, 1.0, count)):
        rows.append(_row(plane, float(share), begun))
        if observe is not None:
            observe(number + 1, count)
    return StabilityMap(
        case=case,
        over=plane.over,
        over_unit=plane.unit,
        key=key,
        unit=plane.second.unit,
        films=plane.machine(plane.corners[1]).names,
        curves=_curves(plane, begun),
        rows=tuple(rows),
        growth=_growth(plane),
    )


def _plane(case: Case, second: tuple[str, str, str], across: Across | None) -> MapPlane:
    slowest, fastest = check(case)
    key = second[0]
    low, high, unit = positive_range(case, *second)
    if across is None:
        family = Family(case, key, high, unit, fastest)
        return SpeedPlane(family, (slowest, fastest), low / high)
    if across.key == key:
        problem, remedy = "is both numbers of the map.", "Name another key."
        raise input_error(case.name or "case", key, across.key, problem, remedy)
    least, most, other = positive_range(case, across.key, across.low, across.high)
    omega = 2.0 * math.pi * across.speed_Hz
    family = Family(case, key, high, unit, omega)
    first = Family(case, across.key, most, other, omega)
    return KeyPlane(first, family, (least / most, low / high))


@dataclass(frozen=True)
class _Begun:
    """Points that curves begin in, as their unknowns."""

    hopf: list[Array]
    folds: list[Array]


def _row(plane: MapPlane, share: float, begun: _Begun) -> MapRow:
    """The special points at a share, which are added to `begun`, too."""
    value = share * plane.second.high
    try:
        walk = plane.walk(share)
    except (NotConverged, Unreachable) as error:
        return MapRow(value, (), str(error) or "The static equilibria could not be followed.")
    special: list[SpecialPoint] = []
    for number, hopf in enumerate(walk.resting.hopf):
        here = hopf.equilibrium
        begun.hopf.append(np.concatenate([here.u, [hopf.nu / here.machine.pace, here.value, share]]))
        special.append(hopf_special(walk, hopf, number))
        branch = follow_branch(walk.follower, first_place(hopf))
        for cycle in branch.cycles:
            if cycle.kind == FOLD:
                begun.folds.append(np.append(cycle.place.y, share))
                special.append(cycle_special(walk, cycle, number))
    return MapRow(value, tuple(special))


def _curves(plane: MapPlane, begun: _Begun) -> tuple[MapCurve, ...]:
    """The curves through the points, each once."""
    curves: list[MapCurve] = []
    for hopf in begun.hopf:
        curves += _new_curve(plane, curves, HOPF, hopf)
    for fold in begun.folds:
        curves += _new_curve(plane, curves, FOLD, fold)
    return tuple(curves)


def _new_curve(plane: MapPlane, known: Sequence[MapCurve], kind: str, start: Array) -> list[MapCurve]:
    """The curve through a point, unless it is known or not found."""
    size = plane.machine(start).size
    if kind == FOLD and (len(start) - 3) // size // 2 > MOST_HARMONICS:
        start = with_harmonics(start, size, MOST_HARMONICS, 3)
    if any(_lies_on(plane, curve, _point(plane, kind, start)) for curve in known if curve.kind == kind):
        return []

    def equations(y: Array) -> Equations:
        return (hopf_equations if kind == HOPF else fold_equations)(plane, y)

    def met(place: Place) -> str:
        return MET if kind == FOLD and amplitude(plane.machine(place.y), plane.cycle(place.y)) < SMALL else ""

    if kind == HOPF:
        both = follow_both(equations, start, plane.corners)
    else:
        both = follow_both(equations, start, plane.corners, partial(fitted, plane, equations), met)
    if both is None:
        return []
    points = [_point(plane, kind, place.y) for place in both.places]
    between = [
        _special_between(plane, equations, kind, pair, ends)
        for pair, ends in zip(itertools.pairwise(both.places), itertools.pairwise(points), strict=True)
    ]
    members = [points[0]]
    for special, point in zip(between, points[1:], strict=True):
        members += [*special, point]
    return [MapCurve(kind, tuple(members), tuple(filter(None, both.notes)))]


def _point(plane: MapPlane, kind: str, y: Array) -> MapPoint:
    machine, here = plane.machine(y), plane.cycle(y)
    nu, omega = float(here[-2] * machine.pace), float(here[-1] * machine.pace)
    position = (float(y[-2] * plane.scale), float(y[-1] * plane.second.high), hertz(omega), hertz(nu))
    if kind == FOLD:
        return MapPoint(*position, eccentricities(machine, here))
    rest = settled(MachineCourse(machine), here[:-2], here[-1])
    lyapunov = lyapunov_coefficient(hopf_at(rest, True, nu))
    d = rest.u[: 2 * machine.film_count].reshape(-1, 2)
    return MapPoint(*position, np.hypot(d[:, 0], d[:, 1]), criticality_of(lyapunov), lyapunov.value.real)


def _special_between(
    plane: MapPlane,
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
        zero = _zero(equations, pair, lambda one: _point(plane, HOPF, one.y).lyapunov)
        named = BAUTIN
    else:
        along = place.tangent[-2:]
        if len(place.y) != len(other.y) or not float(along @ other.tangent[-2:]) < 0.0:
            return []
        zero = _zero(equations, pair, lambda one: float(along @ one.tangent[-2:]))
        named = CUSP
    if zero is None:
        return []
    return [replace(_point(plane, kind, zero.y), criticality=None, lyapunov=math.nan, kind=named)]


def _zero(
    equations: Callable[[Array], Equations], pair: tuple[Place, Place], criterion: Callable[[Place], float]
) -> Place | None:
    """Where a number of the places between two changes its sign."""
    place, other = pair
    length = float((other.y - place.y) @ place.tangent)
    known = {0.0: criterion(place), length: criterion(other)}
    return located(equations(place.y), place, length, criterion, SHARP * abs(length), known)


def _lies_on(plane: MapPlane, curve: MapCurve, point: MapPoint) -> bool:
    """Whether a point is one of a curve, by its distance from the straight lines between its points."""

    def placed(one: MapPoint) -> Array:
        return np.array([one.over / plane.scale, one.value / plane.second.high, one.frequency_Hz / pace])

    pace = max(one.speed_Hz for one in (point, *curve.points))
    at = placed(point)
    for one, other in itertools.pairwise(curve.points):
        a, along = placed(one), placed(other) - placed(one)
        length = float(along @ along)
        share = min(max(float((at - a) @ along) / length, 0.0), 1.0) if length > 0.0 else 0.0
        if float(np.linalg.norm(at - a - share * along)) < KNOWN:
            return True
    return False


def _growth(plane: MapPlane) -> Growth:
    low, high = plane.corners
    shares, over = np.linspace(low[1], high[1], plane.shaded), plane.scale * np.linspace(low[0], high[0], ACROSS)
    rate = np.full((len(shares), ACROSS), np.nan)
    for row, share in zip(rate, shares, strict=True):
        try:
            walk = plane.walk(float(share))
        except (NotConverged, Unreachable):
            continue
        known = [walk.value(point) for point in walk.resting.points]
        rates = [max(point.growth_of(0), -1e9) for point in walk.resting.points]
        row[:] = np.interp(over, known, rates, left=np.nan)
    return Growth(shares * plane.second.high, over, rate)
