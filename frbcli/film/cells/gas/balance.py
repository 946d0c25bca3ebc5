"""Free gas that the oil carries: its balance and mixing.

The balance of the free gas that oil carries through the cells of a film, in array notation.

With c the free gas per oil and q the flows of oil between cells, each of which carries the gas of the cell that it
leaves, the gas of a cell obeys

    A (rate H theta c - past) + sum_out q c - sum_in q c_up = A H theta (c_e - c) / tau,

c_e and tau follow from the law, see bubbly.py. Openings and baths give oil with the free gas of the supplied oil.
Divided by M = A rate H theta + sum_out q, what is known of the cell and its neighbours is c_in = (A past + sum_in q
c_up) / M, and r = M / (A H theta).

What cells are given of their gas in the next iteration of a film, from how it changed in the last ones.

Pressures and gas that are solved in turn tend to a solution by a fixed ratio, if they do: on fine cells the gas answers
a change with a larger one that is opposite. A mean over the last iterations, in which their changes cancel each other,
needs a few of them for either (D. G. Anderson, J. ACM 12, 1965, 547-560).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cells.balance.states import CARRIED_GAS, FRACTION, FREE_GAS, PRESSURE, TURNOVER
from frbcli.film.cells.gas.carry import (
    GAS_PAST,
    HEIGHT,
    KEPT,
    KNOWN,
    NONE,
)
from frbcli.film.cells.mesh.grid import VolumeGrid

STILL = 1e-6
AT_ONCE = 1e60  # 1/s: oil that is replaced so fast keeps the gas that it comes with


class Carried(NamedTuple):
    """c_in and r of cells (m, k), which the law makes their free gas of."""

    gas: Array
    turnover: Array


def with_own_gas(free: Array) -> Carried:
    """What the law takes of cells whose free gas (m, k) is given: their oil is replaced too fast for an exchange."""
    return Carried(free, np.full_like(free, AT_ONCE))


class KeptGas(NamedTuple):
    """Gas of a step. past: (m, k) of H theta c, as for the oil; guess: what is carried at its end, about."""

    past: Array
    guess: Carried


@dataclass(frozen=True)
class FreeGas:
    """The free gas of a solution. free: (m, k) c; carried: what the law has made it of; off: the most that c differs
    from its balance; oil: (m, k) A H theta; paths: of the oil; kept, known: M and the gas that is known to come; past:
    (m, k) A past; fixed: cells of given gas. Gas per time is in scaled units (R b C, 1/s) at the saturation
    pressure, by one section."""

    law: Law
    scales: Scales
    pressure: Array
    free: Array
    carried: Carried
    off: float
    oil: Array
    paths: OilPaths
    kept: Array
    known: Array
    past: Array
    fixed: NDArray[np.bool_]

    @property
    def mean(self) -> float:
        """Mean of c over the oil."""
        return float((self.oil * self.free).sum() / self.oil.sum())

    @property
    def inflow(self) -> float:
        """Gas that comes in with the oil."""
        return self._through(self.law.supplied_gas, self.free)[0]

    @property
    def outflow(self) -> float:
        """Gas that leaves with the oil."""
        return self._through(self.law.supplied_gas, self.free)[1]

    @property
    def released(self) -> float:
        """Gas that leaves the solution net."""
        return float((self.kept * (self.free - self._comes)).sum())

    @property
    def stored(self) -> float:
        """Gas by which the content of the cells grows."""
        return float((np.where(self.fixed, 0.0, self.kept - self.paths.out) * self.free - self.past).sum())

    @property
    def defect(self) -> float:
        """What the balances of all cells are off by, in the sum over the gas that the oil carries through the film,
        dissolved or not; of enclosed oil over STILL of the gas that its cells take up or pass on."""
        comes = self._comes
        settled, time = self.law.exchanged(self.pressure, comes, self.scales)
        exchanged = self.oil / np.maximum(self.oil + time * self.kept, NONE)
        left = float(np.abs(self.kept * (self.free - comes - exchanged * (settled - comes))).sum())
        passed = max(*self._through(1.0, np.ones_like(self.free)), STILL * float(self.kept.sum()))
        return left / max(self.law.gas_content * passed, NONE)

    @property
    def _comes(self) -> Array:
        """(m, k) c_in by the flows as they are."""
        return np.asarray((self.known + brought(self.paths, self.free)) / np.maximum(self.kept, NONE))

    def _through(self, supplied: float, free: Array) -> tuple[float, float]:
        """What comes into the cells of unknown gas from outside and from given cells, and what leaves to there."""
        among, paths = np.where(self.fixed, 0.0, 1.0), self.paths
        inflow = (among * (paths.given * supplied + brought(paths, free * (1.0 - among)))).sum()
        outflow = (among * (paths.out * free - brought(paths, free * among))).sum()
        return float(inflow), float(outflow)


class OilPaths(NamedTuple):
    """Flows of oil (m, k) to where each cell of unknown gas has its oil from: onward and backward through the face
    after it around, upward and downward along (m, k - 1); out: all that leaves; given: that comes from outside."""

    onward: Array
    backward: Array
    upward: Array
    downward: Array
    out: Array
    given: Array


def free_gas(law: Law, scales: Scales, grid: VolumeGrid, states: Array, paths: Array, off: float) -> FreeGas:
    """The gas of a solution with the states (STATES, m, k), with the `paths` (PATHS, m, k) of carry.py."""
    layers, states = paths.copy(), states.copy()
    area = np.where(grid.fixed, 0.0, grid.area)
    return FreeGas(
        law,
        scales,
        states[PRESSURE],
        states[FREE_GAS],
        Carried(states[CARRIED_GAS], states[TURNOVER]),
        off,
        area * layers[HEIGHT] * states[FRACTION],
        paths_of(layers),
        layers[KEPT],
        layers[KNOWN],
        area * layers[GAS_PAST],
        grid.fixed,
    )


def paths_of(layers: Array) -> OilPaths:
    """The paths in array notation of the layers of carry.py (PATHS, m, k)."""
    onward, backward, upward, downward, out, given = layers[:KEPT]
    return OilPaths(onward, backward, upward[:, :-1], downward[:, :-1], out, given)


def brought(paths: OilPaths, free: Array) -> Array:
    """(m, k) gas that other cells bring to each one, sum_in q c_up."""
    arriving = np.roll(paths.onward * free, 1, axis=0) + paths.backward * np.roll(free, -1, axis=0)
    arriving[:, 1:] += paths.upward * free[:, :-1]
    arriving[:, :-1] += paths.downward * free[:, 1:]
    return np.asarray(arriving)


MEMORY = 5  # iterations
DEPENDENT = 1e-10  # of the largest: changes that are so small by themselves say nothing


class GasMixing:
    """The gas of a film over its iterations. most: all gas of the oil, beyond which none is given."""

    def __init__(self, most: float) -> None:
        self._most = most
        self._last: tuple[Array, Array] | None = None
        self._changes: list[Array] = []
        self._given: list[Array] = []

    def mixed(self, before: Array, after: Array, share: float) -> Array:
        """(2, m, k) c_in and r that cells are given, see balance.py, where an iteration made `after` of `before`.

        share: below 1, cells follow this share of the change alone.
        """
        off = after[0] - before[0]
        if self._last is not None:
            self._changes = [*self._changes, (off - self._last[0]).ravel()][-MEMORY:]
            self._given = [*self._given, after - self._last[1]][-MEMORY:]
        self._last = off, after.copy()
        if share < 1.0 or not self._changes:
            return np.asarray(before + share * (after - before))
        changes = np.array(self._changes)
        weights, *_ = np.linalg.lstsq(changes @ changes.T, changes @ off.ravel(), rcond=DEPENDENT)
        gas, turnover = after - np.tensordot(weights, np.array(self._given), 1)
        return np.stack([np.clip(gas, 0.0, self._most), np.maximum(turnover, 0.0)])
