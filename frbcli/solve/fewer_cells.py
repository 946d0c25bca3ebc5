"""The error that the cells of a run leave, from the same run on fewer of them.

Film forces at single states tell too little where a film lives on its own oil and errors add up on a way that lasts:
how far a run on fewer cells has gone elsewhere holds all of it. It costs 0.3 to 0.7 of the time loop of the run.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from frbcli.errors import NotConverged
from frbcli.scene.film_choice import FEWEST_CELLS
from frbcli.scene.plan import Plan
from frbcli.scene.system import System
from frbcli.solve.state import RUNNING, Array

if TYPE_CHECKING:
    from frbcli.solve.under_way import March, Progress

    Observer = Callable[[Progress], None]

SHARE, SHARE_WITH_HOLES = 1 / 2, 2 / 3  # of the cells in each direction; fewer would make holes of another size
COARSER_BY = 1.2  # times as few around, at least: what is nearer says little
ORDER = 0.66  # in which errors fall with the cells, at least: that of films that fill again after they starved


@dataclass(frozen=True)
class CellErrors:
    """Largest errors of a run by its cells: of eccentricities, of displacements over the clearance, of the speeds of
    rings over the largest one of the rotor, of the mean oil fractions."""

    eccentricity: float
    displacement: float
    ring_speed: float
    oil_fraction: float


@dataclass(frozen=True)
class FewerCells:
    """A run on fewer cells. ratio: of the cells in a direction, the geometric mean of both; samples: at the same times
    as those of the run, see March; the last ones may be missing."""

    ratio: float
    samples: Array

    def at(self, there: NDArray[np.bool_]) -> FewerCells:
        """The same at some of the times only, (m,) whether at each time of the run."""
        return replace(self, samples=self.samples[there[: len(self.samples)].nonzero()])

    def error(self, samples: Array, system: System) -> CellErrors | None:
        """Errors of a run in its samples; None if the run on fewer cells does not reach that far."""
        if len(samples) > len(self.samples):
            return None
        n, rotor = system.rotor.size, system.rotor
        other = self.samples[: len(samples)]
        apart = samples - other
        films = [_largest(apart[:, :n], *film) for film in zip(rotor.journals, system.clearances, strict=True)]
        eccentric = films
        if system.ring_count:  # nothing is said of the directions of films between rings
            runs = samples[:, :n], other[:, :n]
            eccentric = [_parted(*runs, *film) for film in zip(rotor.journals, system.clearances, strict=True)]
        points = [_largest(apart[:, :n], pick, system.clearances[0]) for _, pick in rotor.points]
        spins = np.abs(apart[:, [n + spin for spin in system.spins]]).max(initial=0.0)
        top = max(float(np.abs(samples[:, 2 * n]).max(initial=0.0)), 1e-300)
        oil = np.abs(apart[:, 2 * n + 1 :][:, list(system.remembering)]).max(initial=0.0)
        # e(ratio h) - e(h) = e(h) (ratio^ORDER - 1)
        share = 1.0 / (self.ratio**ORDER - 1.0)
        found = max(eccentric), max([*films, *points]), float(spins) / top, float(oil)
        return CellErrors(*(share * off for off in found))


def _largest(apart: Array, pick: Array, room: float) -> float:
    return float(np.hypot(*(apart @ pick.T).T).max(initial=0.0)) / room


def _parted(one: Array, other: Array, pick: Array, room: float) -> float:
    lengths = (np.hypot(*(q @ pick.T).T) for q in (one, other))
    return float(np.abs(np.subtract(*lengths)).max(initial=0.0)) / room


def on_fewer_cells(march: March, until: float, observe: Observer | None = None) -> FewerCells | None:
    """The run of `march` from its beginning to a time in s on fewer cells; None for films that have none, too few, or
    that do not begin on fewer. observe: called some times a second."""
    cells = fewer_cells(march.plan, march.system)
    if cells is None or march.plan.cells is None:
        return None
    try:
        other = march.again(replace(march.plan, cells=cells))
    except NotConverged:
        return None
    status = RUNNING
    while status == RUNNING and other.time <= until:
        status, _ = other.chunk()
        if observe is not None:
            observe(other.progress(until))
    return FewerCells(math.sqrt(math.prod(march.plan.cells) / math.prod(cells)), other.samples)


def fewer_cells(plan: Plan, system: System) -> tuple[int, int] | None:
    """Cells (around, along) that a run is compared on, None if there are no fewer."""
    if plan.cells is None or not system.volumes:
        return None
    share = SHARE_WITH_HOLES if any(film.section.holes for film in system.volumes) else SHARE
    around = max(4 * math.ceil(0.25 * share * plan.cells[0]), FEWEST_CELLS[0])
    along = min(max(round(share * plan.cells[1]), FEWEST_CELLS[1]), plan.cells[1])
    return (around, along) if plan.cells[0] >= COARSER_BY * around else None
