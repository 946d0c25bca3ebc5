"""Newton's method for the elements' equations, and the way from a gentle step theta(p) to a steep one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.film.grid import Array
from frbcli.film.published.equations.assembly import DIRECTIONS, Elements, Gap, assemble
from frbcli.film.published.equations.law import Step
from frbcli.film.published.equations.ring import make_ring, solve_ring
from frbcli.film.published.equations.unknown import Unknowns, make_unknowns, pressures_of, unknowns_of
from frbcli.film.published.mesh.quadratic import QuadraticMesh

NONE = 1e-6  # residual over the sum of its terms that counts as none
REFERENCES = (1.0, 0.1)  # of the unknown over p_cav, tried one after the other
SETTLED = 1e-9  # last correction of the unknown, which is of the order of 1
ITERATIONS = 25
PATIENCE = 15  # iterations without a smaller residual
MEMORY = 4  # a residual has to be smaller than the largest of so many before it
SMALLEST_SHARE = 0.06  # of a correction

GENTLEST = 30.0  # 1 - x_1 of the first step on the way: pressures below p_cav hardly change theta
PACE, FASTEST, SLOWEST = 5.0, 6.0, 1.2  # by which 1 - x_1 becomes smaller from one step to the next
MOST = 1200  # assemblies on the way


@dataclass(frozen=True)
class Equations:
    """Equations that a solution satisfies: theta_t = rate theta - past, past (e, 9), in this gap with this step."""

    gap: Gap
    step: Step
    rate: float
    past: Array


@dataclass(frozen=True)
class Point:
    """Unknowns (nodes,) with their pressures, and the size of their residual, as a vector and over its terms; cost:
    assemblies that led to it."""

    w: Array
    pressure: Array
    slope: Array
    size: float
    share: float
    cost: int


class Newton:
    """The equations of a mesh, and the room that they are solved in."""

    def __init__(self, mesh: QuadraticMesh, elements: Elements, step: Step) -> None:
        self._nodes, self._elements = mesh.nodes, elements
        fixed = elements.fixed
        self._unknowns = [make_unknowns(mesh, fixed, step, share * step.cavity) for share in REFERENCES]
        size = len(mesh.nodes)
        self._matrix, self._solution = np.zeros((size, 9, 9)), {}
        self._room = {}
        for rights in (1, 1 + DIRECTIONS):
            self._room[rights] = (make_ring(mesh.around, mesh.along, rights), np.zeros((size, 9, rights)))
            self._solution[rights] = np.zeros((*mesh.phi.shape, rights))

    def solve(self, equations: Equations, pressure: Array) -> Point:
        """The best point found from the pressures (nodes,)."""
        best, cost = None, 0
        for unknowns in self._unknowns:
            point = self._iterate(unknowns, equations, unknowns_of(unknowns, equations.step, pressure))
            cost += point.cost
            if best is None or point.share < best.share:
                best = point
            if best.share < NONE:
                break
        assert best is not None
        return _with_cost(best, cost)

    def approach(self, equations: Callable[[float], Equations], distance: float, pressure: Array) -> Point:
        """Solve from far away, by steps less steep than that with 1 - x_1 = distance.

        equations: of 1 - x_1.
        """
        reached = GENTLEST
        point, pace = self.solve(equations(reached), pressure), PACE
        while reached > distance:
            following = max(reached / pace, distance)
            start = _scaled(point.pressure, equations(reached).step.cavitation, following / reached)
            trial = self.solve(equations(following), start)
            cost = point.cost + trial.cost
            if trial.share < NONE or pace < SLOWEST or cost > MOST:
                point, reached, pace = trial, following, min(pace**1.5, FASTEST)
            else:
                pace = pace**0.5
            point = _with_cost(point, cost)
        return point

    def changes(self, equations: Equations, point: Point) -> Array:
        """(nodes, 5) changes of the pressures that the residual and its derivatives by d_x, d_y, v_x, v_y call for."""
        rights = 1 + DIRECTIONS
        self._assemble(equations, point.pressure, point.slope, rights)
        return np.asarray(point.slope[:, None] * self._corrections(rights), dtype=np.float64)

    def _iterate(self, unknowns: Unknowns, equations: Equations, w: Array) -> Point:
        """The point with the smallest residual that shortened corrections lead to."""
        point = best = self._point(unknowns, equations, w, 1)
        sizes, since = [point.size], 0
        for _ in range(ITERATIONS):
            correction = self._corrections(1)[:, 0]
            largest, share = float(np.max(np.abs(correction))), 1.0
            if not largest < np.inf:
                break
            while True:
                point = self._point(unknowns, equations, w + share * correction, point.cost + 1)
                if point.size < max(sizes[-MEMORY:]) or largest < SETTLED or share < SMALLEST_SHARE:
                    break
                share *= 0.5
            w = point.w
            sizes.append(point.size)
            since = 0 if point.size < best.size else since + 1
            best = point if since == 0 or largest < SETTLED else best
            if largest < SETTLED or since == PATIENCE:
                break
        return _with_cost(best, point.cost)

    def _point(self, unknowns: Unknowns, equations: Equations, w: Array, cost: int) -> Point:
        pressure, slope = pressures_of(unknowns, equations.step, w)
        right = self._assemble(equations, pressure, slope, 1)[..., 0]
        left = np.bincount(self._nodes.ravel(), weights=right.ravel(), minlength=w.size)
        terms = max(float(np.abs(right).sum()), np.finfo(float).tiny)
        with np.errstate(over="ignore", invalid="ignore"):  # a correction may lead far astray
            return Point(w, pressure, slope, float(np.sqrt(left @ left)), float(np.abs(left).sum()) / terms, cost)

    def _assemble(self, equations: Equations, pressure: Array, slope: Array, rights: int) -> Array:
        right, (gap, step) = self._room[rights][1], (equations.gap, equations.step)
        assemble(self._elements, step, gap, pressure, slope, equations.rate, equations.past, self._matrix, right)
        return right

    def _corrections(self, rights: int) -> Array:
        """(nodes, rights) of the unknowns, from the equations assembled last."""
        ring, right = self._room[rights]
        solution = self._solution[rights]
        solve_ring(ring, self._matrix, right, solution)
        return np.asarray(solution.reshape(-1, rights), dtype=np.float64)


def _with_cost(point: Point, cost: int) -> Point:
    return Point(point.w, point.pressure, point.slope, point.size, point.share, cost)


def _scaled(pressure: Array, cavitation: float, share: float) -> Array:
    """Pressures below p_cav so much nearer to it that a steeper step has the same oil fractions there."""
    depth = pressure - cavitation
    return np.asarray(cavitation + np.where(depth < 0.0, share * depth, depth), dtype=np.float64)
