"""Newton's method for the balances of the cells, damped by a time scale that grows as the residual falls.

The law's kinks make plain Newton steps oscillate between sets of cavitated cells. A storage of w in each cell, over a
pseudo-time step that is longer the less there is left to balance (switched evolution relaxation), keeps the steps short
as long as they have to be; the solution does not know of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.errors import FilmUnsolved
from frbcli.film.cells.grid import VolumeGrid
from frbcli.film.cells.plain.balance import Stencil
from frbcli.film.cells.plain.elimination import Elimination, eliminate, plan_elimination
from frbcli.film.grid import Array

ROUND_OFF = 1e-15  # residual of a cell over the terms that it is the sum of
SETTLED = 1e-12  # the same, for a residual that does not fall any more
LARGEST = 1e9  # beyond this, w is the mark of a singular matrix
SHRINK = 0.3  # the pseudo-time step shrinks to no less than this in one iteration


@dataclass(frozen=True)
class Attempt:
    """One way to go. first: the first pseudo-time step times the motion's rate; growth: the most that it grows by in
    one iteration; limit: of iterations."""

    first: float
    growth: float
    limit: int


PLAIN = Attempt(math.inf, 1.0, 20)
DAMPED = Attempt(1.0, 4.0, 150)
GENTLE = Attempt(0.1, 1.5, 300)
ATTEMPTS = (PLAIN, DAMPED, GENTLE)

Assembly = Callable[[Array], tuple[Array, Array, Stencil]]


@dataclass(frozen=True)
class Unknowns:
    """The cells as unknowns of a sparse matrix, whose elimination is planned once.

    free: (m, k) 1 where w is unknown, 0 where the pressure is given; area: (m, k); phi, z: middles of the cells.
    """

    free: Array
    area: Array
    plan: Elimination
    phi: Array
    z: Array

    @classmethod
    def of(cls, grid: VolumeGrid) -> Unknowns:
        """The unknowns of a grid."""
        m, k = grid.shape
        cells = np.arange(m * k).reshape(m, k)
        around = (cells, np.roll(cells, 1, axis=0), np.roll(cells, -1, axis=0))
        rows = np.concatenate([*(cells.ravel() for _ in around), cells[:, 1:].ravel(), cells[:, :-1].ravel()])
        columns = np.concatenate([*(column.ravel() for column in around), cells[:, :-1].ravel(), cells[:, 1:].ravel()])
        free = np.where(grid.fixed, 0.0, 1.0)
        return cls(free, grid.area, plan_elimination(rows, columns, m * k), grid.centre, grid.height)

    def correction(self, stencil: Stencil, residual: Array, pseudo_rate: float) -> Array:
        """(m, k) Newton's correction of w; not finite where the matrix is singular."""
        centre = stencil.centre + pseudo_rate * self.free * self.area
        parts = (centre, stencil.before, stencil.behind, stencil.below[:, 1:], stencil.above[:, :-1])
        w = eliminate(self.plan, np.concatenate([part.ravel() for part in parts]), -residual.ravel())
        corrected: Array = w.reshape(residual.shape)
        return corrected


def solve(unknowns: Unknowns, assemble: Assembly, start: Array, rate: float) -> tuple[Array, int]:
    """w (m, k) with a residual of round-off, and the iterations that it took, by the first of ATTEMPTS that gets there.

    assemble: w -> residual (m, k), size of its terms (m, k), stencil; rate: of the motion in 1/s. Raises FilmUnsolved.
    """
    spent, failure = 0, ""
    for attempt in ATTEMPTS:
        w, iterations, failure = _iterate(unknowns, assemble, start, rate, attempt)
        spent += iterations
        if not failure:
            return w, spent
    tried = "plain, damped, and damped more"
    raise FilmUnsolved(f"the film did not converge in {spent} Newton iterations ({tried}): {failure}")


def _iterate(
    unknowns: Unknowns, assemble: Assembly, w: Array, rate: float, attempt: Attempt
) -> tuple[Array, int, str]:
    """(w, iterations, what is wrong or nothing)."""
    pseudo_rate, left_before = rate / attempt.first, math.inf
    largest_before = math.inf
    worst = np.zeros_like(w)
    for iteration in range(1, attempt.limit + 1):
        residual, size, stencil = assemble(w)
        worst = np.abs(residual) / np.maximum(size + np.abs(stencil.centre) * (1.0 + np.abs(w)), np.finfo(float).tiny)
        largest = float(np.max(worst))
        if largest < ROUND_OFF or 0.5 * largest_before <= largest < SETTLED:
            return w, iteration, ""
        largest_before = largest
        left = float(np.abs(residual).sum())
        if left_before < math.inf:
            pseudo_rate /= min(max(left_before / left, SHRINK), attempt.growth)
        left_before = left
        w = w + unknowns.correction(stencil, residual, pseudo_rate)
        if not np.max(np.abs(w)) < LARGEST:
            return w, iteration, "the equations became singular, as those of a film that no oil can enter are"
    return w, attempt.limit, _where(unknowns, worst)


def _where(unknowns: Unknowns, worst: Array) -> str:
    """Which cells do not balance."""
    i, j = np.unravel_index(int(np.argmax(worst)), worst.shape)
    open_cells = int(np.count_nonzero(worst > SETTLED))
    angle = math.degrees(float(np.mod(unknowns.phi[i], 2.0 * math.pi)))
    return (
        f"{open_cells} of {worst.size} cells do not balance, the worst at phi = {angle:.0f} deg, "
        f"z = {unknowns.z[j]:.2f} of the section by {worst[i, j]:.1e} of its flow"
    )
