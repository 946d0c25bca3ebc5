"""The error of a run by its cells, from two runs of the same machine on different cells."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array, Truths
from frbcli.scene.machine.system import System
from frbcli.scene.planning.cell_choice import gap_ratio

CLOSER = 3.0  # most that a smaller gap than was expected counts


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
    """A run on fewer cells. share: of the difference between the runs that the error of the finer one may be; samples:
    at the same times as the samples of the run, see March; the last ones may be missing; least: error of the
    eccentricity that is stated even if both runs agree, which they may by chance; no more than the largest
    eccentricity. expected: eccentricity that `least` holds for; a run with a smaller gap states more."""

    share: float
    samples: Array
    least: float = 0.0
    expected: float | None = None

    def at(self, there: Truths) -> FewerCells:
        """These errors at some of the times only, (m,) whether at each time of the run."""
        return replace(self, samples=self.samples[there[: len(self.samples)].nonzero()])

    def error(self, samples: Array, system: System) -> CellErrors | None:
        """Errors of a run in its samples; None if the run on fewer cells does not reach that far."""
        if len(samples) > len(self.samples):
            return None
        n, rotor, stations = system.rotor.size, system.rotor, system.films.stations
        journals = list(
            zip(system.films.seen(rotor.journals), np.repeat(system.clearances, stations).tolist(), strict=True)
        )
        other = self.samples[: len(samples)]
        apart = samples - other
        films = [_largest(apart[:, :n], *film) for film in journals]
        runs = samples[:, :n], other[:, :n]
        eccentric = [_parted(*runs, *film) for film in journals]
        points = [_largest(apart[:, :n], selection, system.length) for _, selection in rotor.points]
        spins = float(np.abs(apart[:, [n + spin for spin in system.spins]]).max(initial=0.0))
        top = max(float(np.abs(samples[:, 2 * n]).max(initial=0.0)), 1e-300)
        first = 2 * n + 1
        oil = float(np.abs(apart[:, first : first + len(system.names)][:, list(system.remembering)]).max(initial=0.0))
        reach = max(_largest(samples[:, :n], *film) for film in journals)
        closer = 1.0 if self.expected is None else min(gap_ratio(self.expected, reach), CLOSER)
        least = min(closer * self.least, reach)
        eccentricity, displacement = (max(least, self.share * off) for off in (max(eccentric), max([*films, *points])))
        return CellErrors(eccentricity, displacement, self.share * spins / top, self.share * oil)


def _largest(apart: Array, selection: Array, room: float) -> float:
    return float(np.hypot(*(apart @ selection.T).T).max(initial=0.0)) / room


def _parted(one: Array, other: Array, selection: Array, room: float) -> float:
    lengths = (np.hypot(*(q @ selection.T).T) for q in (one, other))
    return float(np.abs(np.subtract(*lengths)).max(initial=0.0)) / room
