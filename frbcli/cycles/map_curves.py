"""The planes of stability maps, the rotor speed and a number of the case or two numbers of the case at one speed; and
the curves of Hopf points and of folds in them.

Both are curves of solutions as in continuation.py, with one equation more than the static equilibria or the cycles that
lie on them. That a matrix A is singular is asked by g = 0 of

    [A  b; c^H 0] [v; g] = [0; 1],

which is regular on the curve if b and c are near to the vectors that A has no part of (Govaerts, Numerical Methods for
Bifurcations of Dynamical Equilibria, 2000). Of a Hopf point A = 1 - T_1 (dg/du + i nu dg/du' + kappa), as small as the
films; of a fold, the derivative of the harmonic balance by the motion and its frequency at a constant speed.

The unknowns end with both numbers over their largest values, which for the speed is the pace.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import ClassVar

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from frbcli.arrays import Array, Complex
from frbcli.cycles.columns import SPEED, hertz
from frbcli.cycles.diagram import Walk
from frbcli.cycles.limit_cycles import Family, resting_over
from frbcli.cycles.method.balance import Balance, left_out, unpacked
from frbcli.cycles.method.continuation import (
    Equations,
    Place,
    Strides,
    Unreachable,
    at_value,
    corrected,
    halved_until,
    next_length,
    oriented,
    step_from,
    unit_vector,
)
from frbcli.cycles.method.equilibria import MachineCourse, resting_curve
from frbcli.cycles.method.equilibria import equations as resting_equations
from frbcli.cycles.method.follower import FoldFollower, with_harmonics
from frbcli.cycles.method.machine import Machine, film_loads, transfer

FAMILIES = 8  # that are kept, of values of the second number


class MapPlane(ABC):
    """over, unit: name and unit of the first number, which times `scale` is in it; second: the machines over the second
    number; corners: the lowest and the highest of both numbers; by_difference: places of the numbers from the end that
    derivatives are differences by; shaded: values of the second number at which the growth at rest is computed."""

    by_difference: ClassVar[tuple[int, ...]]
    shaded: ClassVar[int]

    def __init__(self, over: str, unit: str, scale: float, second: Family, corners: tuple[Array, Array]) -> None:
        self.over, self.unit, self.scale, self.second, self.corners = over, unit, scale, second, corners

    @abstractmethod
    def machine(self, y: Array) -> Machine:
        """The machine at unknowns that end with both numbers."""

    @abstractmethod
    def cycle(self, y: Array) -> Array:
        """The unknowns with the speed of the rotor over the pace instead of both numbers."""

    @abstractmethod
    def walk(self, share: float) -> Walk:
        """Over the first number at a value of the second. Raises NotConverged, Unreachable."""


class SpeedPlane(MapPlane):
    """The speed of the rotor, between two in rad/s, and a number from a share of its largest value on."""

    by_difference, shaded = (-1,), 41

    def __init__(self, second: Family, speeds: tuple[float, float], lowest: float) -> None:
        slowest, fastest = (speed / second.speed for speed in speeds)
        corners = np.array([slowest, lowest]), np.array([fastest, 1.0])
        super().__init__(SPEED, "Hz", hertz(second.speed), second, corners)
        self.speeds = speeds

    def machine(self, y: Array) -> Machine:
        """See MapPlane."""
        return self.second.machine_at(float(y[-1]))

    def cycle(self, y: Array) -> Array:
        """See MapPlane."""
        return y[:-1]

    def walk(self, share: float) -> Walk:
        """See MapPlane."""
        machine, lowest = self.second.machine_at(share), float(self.corners[0][0])
        resting = resting_curve(self.second.system(share), machine, *self.speeds)
        return Walk(resting, FoldFollower(MachineCourse(machine), lowest))


class KeyPlane(MapPlane):
    """Two numbers at one speed. first: the machines over the first one at the largest value of the second; lowest: of
    both over their largest values."""

    by_difference, shaded = (-2, -1), 15

    def __init__(self, first: Family, second: Family, lowest: tuple[float, float]) -> None:
        super().__init__(first.over, first.unit, first.high, second, (np.array(lowest), np.ones(2)))
        self._omega, self._lowest = first.speed, lowest[0]
        self._family = lru_cache(FAMILIES)(lambda share: first.with_setting(second.setting(share)))

    def machine(self, y: Array) -> Machine:
        """See MapPlane."""
        return self._family(float(y[-1])).machine_at(float(y[-2]))

    def cycle(self, y: Array) -> Array:
        """See MapPlane."""
        return np.append(y[:-2], self._omega / self.machine(y).pace)

    def walk(self, share: float) -> Walk:
        """See MapPlane."""
        family, lowest = self._family(share), self._lowest
        return Walk(resting_over(family, lowest), FoldFollower(family, lowest))


STRIDES = Strides(first=0.02, shortest=1e-5, longest=0.06, points=300)
DIFFERENCE = 1e-5  # of the unknowns of Hopf points, of numbers of the case, and along the vector v of folds
MOST_HARMONICS, TAIL = 48, 1e-6  # of folds; what the harmonics left out may have of the clearance


@dataclass(frozen=True)
class Curve:
    """places: in their order; notes: why the first and the last place do not lie on the border, empty if they do."""

    places: tuple[Place, ...]
    notes: tuple[str, str]


def hopf_equations(plane: MapPlane, y: Array) -> Equations:
    """Equations of a Hopf point y = (u, nu / pace, numbers), with the bordering vectors of a y near to it."""
    left, _, right = np.linalg.svd(_at_rest(plane, y))
    b, c = left[:, -1], right[-1].conj()

    def residual(y: Array) -> Array:
        machine, here = plane.machine(y), plane.cycle(y)
        rest, _ = resting_equations(machine)(np.append(here[:-2], here[-1]))
        size = len(b)
        matrix = np.zeros((size + 1, size + 1), dtype=complex)
        matrix[:size, :size], matrix[:size, size], matrix[size, :size] = _at_rest(plane, y), b, c.conj()
        g = np.linalg.solve(matrix, np.eye(size + 1)[-1])[-1]
        return np.concatenate([rest, [g.real, g.imag]])

    def equations(y: Array) -> tuple[Array, Array]:
        require_positive(y)
        steps = DIFFERENCE * np.eye(len(y))
        columns = [(residual(y + step) - residual(y - step)) / (2.0 * DIFFERENCE) for step in steps]
        return residual(y), np.transpose(columns)

    return equations


def require_positive(y: Array) -> None:
    """Raises Unreachable where a number of the plane is not above zero."""
    if not np.all(y[-2:] > DIFFERENCE):
        raise Unreachable


def _at_rest(plane: MapPlane, y: Array) -> Complex:
    """1 - T_1 (dg/du + i nu dg/du' + kappa) at rest."""
    machine, here = plane.machine(y), plane.cycle(y)
    nu, omega = float(here[-2] * machine.pace), float(here[-1] * machine.pace)
    passing = transfer(machine, np.array([nu]), omega)
    u = here[None, :-2]
    loads = film_loads(machine, u, np.zeros_like(u), omega)
    inner = loads.by_u[0] + 1j * nu * loads.by_v[0] + np.diag(passing.kappa[0])
    return np.asarray(np.eye(len(inner)) - passing.values[0] @ inner)


def fold_equations(plane: MapPlane, y: Array) -> Equations:
    """Equations of a fold y = (motion, nu / pace, numbers), see balance.py, with the bordering vectors and the phase of
    a y near to it."""
    reference = unpacked(y[:-3], plane.machine(y).size)

    def balance(y: Array) -> tuple[Array, Array]:
        return Balance(plane.machine(y), reference)(plane.cycle(y))

    _, slope = balance(y)
    b, c, n = _nearly_null(slope[:, :-1].T), _nearly_null(slope[:, :-1]), len(y) - 2
    last = np.eye(n + 1)[-1]

    def equations(y: Array) -> tuple[Array, Array]:
        require_positive(y)
        residual, slope = balance(y)
        bordered = np.zeros((n + 1, n + 1))
        bordered[:n, :n], bordered[:n, n], bordered[n, :n] = slope[:, :-1], b, c
        v, w = np.linalg.solve(bordered, last), np.linalg.solve(bordered.T, last)
        along = np.zeros(len(y))
        along[:n] = v[:n] / np.linalg.norm(v[:n])
        ahead, behind = (balance(y + side * DIFFERENCE * along) for side in (1.0, -1.0))
        matrix = np.zeros((n + 1, n + 2))
        matrix[:n, :-1] = slope
        scale = np.linalg.norm(v[:n]) / (2.0 * DIFFERENCE)
        matrix[n, :-1] = -scale * w[:n] @ (ahead[1] - behind[1])
        for number in plane.by_difference:
            step = DIFFERENCE * unit_vector(len(y), number)
            more, less = balance(y + step), balance(y - step)
            matrix[:n, number] = (more[0] - less[0]) / (2.0 * DIFFERENCE)
            matrix[n, number] = -w[:n] @ (more[1] - less[1])[:, :-1] @ v[:n] / (2.0 * DIFFERENCE)
        return np.append(residual, v[n]), matrix

    return equations


def _nearly_null(matrix: Array) -> Array:
    """The unit vector of which a nearly singular matrix makes least, by inverse iteration."""
    factors = lu_factor(matrix)
    vector = np.ones(len(matrix))
    for side in (1, 0, 1, 0):  # of the transposed matrix and of its own, for the smallest singular value
        vector = lu_solve(factors, vector, trans=side)
        vector /= np.linalg.norm(vector)
    return np.asarray(vector)


def follow_both(
    equations: Callable[[Array], Equations],
    start: Array,
    corners: tuple[Array, Array],
    fitted: Callable[[Place], Place | None] = lambda place: place,
    ends: Callable[[Place], str] = lambda _: "",
) -> Curve | None:
    """The curve through a place near to `start` inside of a rectangle of its last two unknowns, up to its border; None
    if there is none.

    fitted: a place with as many unknowns as it needs; ends: why a curve ends in a place, or nothing.
    """
    asked, size = equations(start), len(start)
    place = corrected(asked, start, unit_vector(size)) or corrected(asked, start, unit_vector(size, -2))
    place = None if place is None else fitted(place)
    if place is None:
        return None
    sides = [_followed(equations, oriented(place, way * place.tangent), corners, fitted, ends) for way in (-1.0, 1.0)]
    (back, first), (on, last) = sides
    back = [replace(one, tangent=-one.tangent, side=-one.side) for one in reversed(back)]
    return Curve((*back, place, *on), (first, last))


def _followed(
    equations: Callable[[Array], Equations],
    place: Place,
    corners: tuple[Array, Array],
    fitted: Callable[[Place], Place | None],
    ends: Callable[[Place], str],
) -> tuple[list[Place], str]:
    places: list[Place] = []
    length = STRIDES.first
    for _ in range(STRIDES.points):
        stepped = partial(_stepped, equations, place, fitted)
        there, length = halved_until(stepped, length, STRIDES.shortest)
        if there is None:
            return places, "The steps became too short."
        if not (np.all(there.y[-2:] >= corners[0]) and np.all(there.y[-2:] <= corners[1])):
            return [*places, _on_border(equations, there, corners)], ""
        places.append(there)
        if note := ends(there):
            return places, note
        if len(place.y) == len(there.y):
            length = next_length(length, STRIDES, place, there)
        place = there
    return places, f"It was followed over {STRIDES.points} points and goes on."


def _on_border(equations: Callable[[Array], Equations], there: Place, corners: tuple[Array, Array]) -> Place:
    """The place next to one outside of the rectangle in which the curve leaves it."""
    at, limits = there.y[-2:], np.clip(there.y[-2:], *corners)
    number = int(np.argmax(np.abs(at - limits))) - 2
    border = at_value(equations(there.y), there, limits[number], number)
    return there if border is None else border


def _stepped(
    equations: Callable[[Array], Equations], place: Place, fitted: Callable[[Place], Place | None], length: float
) -> Place | None:
    try:
        ahead = step_from(equations(place.y), place, length)
        return None if ahead is None else fitted(oriented(ahead, place.tangent))
    except Unreachable:
        return None


def fitted(plane: MapPlane, equations: Callable[[Array], Equations], place: Place) -> Place | None:
    """A place with as many harmonics as its motion needs, up to a largest number."""
    for _ in range(8):
        machine = plane.machine(place.y)
        harmonics = (len(place.y) - 3) // machine.size // 2
        if harmonics >= MOST_HARMONICS or left_out(machine, plane.cycle(place.y)) < TAIL:
            return place
        more = min(MOST_HARMONICS, harmonics + max(2, harmonics // 3))
        y, tangent = (with_harmonics(vector, machine.size, more, 3) for vector in (place.y, place.tangent))
        solved = corrected(equations(y), y, tangent / np.linalg.norm(tangent))
        if solved is None:
            return None
        place = oriented(solved, tangent)
    return place
