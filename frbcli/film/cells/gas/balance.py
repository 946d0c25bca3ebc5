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

A film whose oil carries gas, linearised about its settled state, with oil and free gas of each cell as states.

The unknowns are w and the free gas c of the cells. The balance of the gas less c times the balance of the oil is

    A H theta c' + sum_in q (c - c_up) = A H theta (c_e - c) / tau,

which is multiplied by tau / (1 + tau r), so that no rate is too fast or too slow for it (r: see balance.py). Both
balances are sums over next neighbours: cells that are not neighbours of one are moved at the same time for their
derivatives. Both states of a cell are adjacent; the cells are ordered so that an elimination fills little.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.law import CellState, Law, Scales
from frbcli.film.cells.balance.states import (
    CARRIED_GAS,
    FRACTION,
    FREE_GAS,
    PRESSURE,
    STATES,
    TURNOVER,
    UPWIND,
    cell_states,
)
from frbcli.film.cells.data import film_alone, seen_by_grid
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.carry import (
    GAS_PAST,
    HEIGHT,
    KEPT,
    KNOWN,
    NONE,
    PATHS,
    follow_oil,
)
from frbcli.film.cells.loads import pushing
from frbcli.film.cells.mesh.grid import VolumeGrid

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


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


At = tuple[Array, Array, Motion]  # w, c and the motion of the journal
Entries = tuple[Array, NDArray[np.int64], NDArray[np.int64]]  # of a matrix, with their rows and columns
STEP = 1e-6  # of the differences: balances are nearly linear in it


class LinearStates(NamedTuple):
    """Derivatives of a film of n cells by its states, w and c of each cell: of its balances, flow (2 n, 2 n) and, by
    the rates of the states, storage (2 n, 2 n); by displacement and velocity over the clearance, by_place and by_rate
    (2 n, c); by omega_J + omega_S, by_total (2 n,); of the c loads in N, push (c, 2 n), and of the share of Couette's
    torque, sheared (2 n,). c: the 2 of the displacement, or 4 with its growth over the width, see film_changes of
    linearised.py."""

    flow: csc_matrix
    storage: csc_matrix
    by_place: Array
    by_rate: Array
    by_total: Array
    push: Array
    sheared: Array


def linear_states(
    film: VolumeFilm, motion: Motion, solution: VolumeSolution, weights: Array, tilts: bool = False
) -> LinearStates:
    """The film linearised about a settled solution, its journal being at rest. weights: see shear_weights; tilts:
    whether the growth of the displacement over the width counts, too."""
    from scipy.sparse import coo_matrix  # takes long to load

    assert solution.gas is not None
    grid, w, free = film.grid, solution.w, solution.gas.free
    settled, (w_at, c_at) = _Settled(film, solution.gas, solution.state.pressure), _numbers(grid.shape)
    size, at = 2 * w.size, np.concatenate([w_at, c_at])
    given = at[np.tile(grid.fixed.ravel(), 2)]  # their states stay as they are
    flow = [(np.ones(given.size), given, given)]
    for cells in _apart(grid.shape):
        near, near_numbers = _nearest(cells)
        step, nothing = STEP * np.where(grid.fixed, 0.0, cells), np.zeros(grid.shape)
        for by, by_w, by_free in ((w_at, step, nothing), (c_at, nothing, step)):
            changes = settled.change((w + by_w, free + by_free, motion), (w - by_w, free - by_free, motion))
            for row, change in zip((w_at, c_at), changes, strict=True):
                flow.append((change[near], row[near.ravel()], by[near_numbers]))
    shares = (np.ones_like(grid.height), grid.height - 0.5)[: 1 + tilts]
    places = [
        settled.change((w, free, _moved(motion, axis, STEP)), (w, free, _moved(motion, axis, -STEP)))
        for axis in range(2 * len(shares))
    ]
    pace = max(abs(motion.omega), 1.0)
    faster, slower = (replace(motion, omega=motion.omega + side * STEP * pace) for side in (1.0, -1.0))
    turned = settled.change((w, free, faster), (w, free, slower))
    state, gap = settled.state(w, free), settled.gap(motion)
    high, low = settled.state(w, free + STEP), settled.state(w, free - STEP)
    fraction, pressure = (high.fraction - low.fraction) / (2.0 * STEP), (high.pressure - low.pressure) / (2.0 * STEP)
    area = np.where(grid.fixed, 0.0, grid.area)
    stored = ((state.fraction_slope, w_at, w_at), (fraction, w_at, c_at))
    storage = [((area * gap * slope).ravel(), row, by) for slope, row, by in stored]
    storage.append(((area * gap * state.fraction * settled.rated * settled.time).ravel(), c_at, c_at))
    opens = [np.outer(side, share) for share in shares for side in (np.sin(grid.centre), -np.cos(grid.centre))]
    rate = [(area * state.fraction * each).ravel() for each in opens]
    by_place, by_rate = np.zeros((size, len(rate))), np.zeros((size, len(rate)))
    by_total, push = np.zeros(size), np.zeros((len(rate), size))
    by_place[at] = np.stack([np.concatenate([each.ravel() for each in place]) for place in places], axis=1)
    by_rate[w_at] = np.stack(rate, axis=1)
    by_total[at] = np.concatenate([each.ravel() for each in turned]) / pace
    slopes = np.concatenate([state.pressure_slope.ravel(), pressure.ravel()])
    unit = np.concatenate([share * pushing(film) for share in shares])
    push[:, at] = np.tile(unit.reshape(len(rate), -1), 2) * slopes
    sheared = np.zeros(size)
    sheared[at] = np.concatenate([(weights * slope).ravel() for slope in (state.fraction_slope, fraction)])

    def matrix(parts: Sequence[Entries]) -> csc_matrix:
        values, rows, columns = (np.concatenate(each) for each in zip(*parts, strict=True))
        sparse = coo_matrix((values, (rows, columns)), shape=(size, size)).tocsc()
        sparse.eliminate_zeros()  # nothing comes back against the flow
        return sparse

    return LinearStates(matrix(flow), matrix(storage), by_place, by_rate, by_total, push, sheared)


def _numbers(shape: tuple[int, int]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(n,) each: the number of w and c of each cell among the states, the cells ordered by the degree of their graph,
    lowest first (minimum degree)."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import splu

    number, (m, k) = np.arange(shape[0] * shape[1]).reshape(shape), shape
    rows = np.concatenate([number.ravel(), number[:, 1:].ravel()])
    near = np.concatenate([np.roll(number, 1, axis=0).ravel(), number[:, :-1].ravel()])
    one = coo_matrix((np.ones(rows.size), (rows, near)), shape=(m * k, m * k))
    graph = (one + one.T + coo_matrix((np.full(m * k, 5.0), (number.ravel(),) * 2))).tocsc()
    first = 2 * splu(graph, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).perm_c.astype(np.int64)
    return first, first + 1


class _Settled:
    """The balances of a film near a settled solution with the free gas `gas`; rated: 1 / (1 + tau r)."""

    def __init__(self, film: VolumeFilm, gas: FreeGas, pressure: Array) -> None:
        data = film_alone(film)
        self.film, self._own = film, (data.films[0], data.ring[0], data.places[0], data.cells[0])
        self._law = np.append(given_parameters(film.law), np.nan)  # where a cell is empty: not asked for here
        _, self.time = film.law.exchanged(pressure, gas.carried.gas, film.scales)
        self.rated = 1.0 / (1.0 + self.time * gas.carried.turnover)

    def state(self, w: Array, free: Array) -> CellState:
        """State of cells with a given free gas (m, k)."""
        return self.film.cells(w, with_own_gas(free))

    def gap(self, motion: Motion) -> Array:
        """(m, k) H."""
        return self.film.gaps(motion)

    def change(self, high: At, low: At) -> tuple[Array, Array]:
        """Difference quotients (m, k) of both balances."""
        pairs = zip(self.balances(*high), self.balances(*low), strict=True)
        oil, gas = ((up - down) / (2.0 * STEP) for up, down in pairs)
        return oil, gas

    def balances(self, w: Array, free: Array, motion: Motion) -> tuple[Array, Array]:
        """(m, k) each: what leaves the cells net, of their oil, and of their gas as above."""
        film, law, (m, k) = self.film, self.film.law, free.shape
        own, _, _, cells = self._own
        states = np.full((STATES, m, k), UPWIND)
        states[CARRIED_GAS], states[TURNOVER] = with_own_gas(free)
        cell_states(own, cells, self._law, 0.0, np.ascontiguousarray(w), states)
        paths = self._paths(states, motion)
        comes = brought(paths, np.ones_like(free)) + paths.given
        net = comes * free - brought(paths, free) - paths.given * law.supplied_gas
        target, _ = law.exchanged(states[PRESSURE], free, film.scales)
        held = film.grid.area * self.gap(motion) * states[FRACTION]
        open_ = np.where(film.grid.fixed, 0.0, 1.0)
        gas = open_ * self.rated * (self.time * net - held * (target - free))
        return open_ * (paths.out - comes), gas

    def _paths(self, states: Array, motion: Motion) -> OilPaths:
        """Of the oil of the states (STATES, m, k)."""
        layers = np.empty((PATHS, *self.film.grid.shape))
        follow_oil(*self._own, states, seen_by_grid(motion, still=True), layers)
        return paths_of(layers)


def _apart(shape: tuple[int, int]) -> Iterator[NDArray[np.bool_]]:
    """Sets of cells (m, k) of which no two have a neighbour in common, nor are neighbours."""
    m, k = shape
    column = np.arange(m) % 3
    column[m - m % 3 :] = 3 + np.arange(m % 3)  # where the ring closes
    for around in range(3 + m % 3):
        for along in range(min(3, k)):
            yield (column == around)[:, None] & (np.arange(k) % 3 == along)[None, :]


def _nearest(cells: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which cells (m, k) are cells of a set of _apart or next to one, and the numbers of these."""
    numbers = np.where(cells, np.arange(cells.size).reshape(cells.shape), -1)
    numbers = np.maximum(numbers, np.maximum(np.roll(numbers, 1, axis=0), np.roll(numbers, -1, axis=0)))
    marks = numbers.copy()
    marks[:, 1:] = np.maximum(marks[:, 1:], numbers[:, :-1])
    marks[:, :-1] = np.maximum(marks[:, :-1], numbers[:, 1:])
    return marks >= 0, marks[marks >= 0]


def _moved(motion: Motion, axis: int, step: float) -> Motion:
    """A motion with a step of coordinate `axis`: of the displacement, and of its growth over the width."""
    u = [*motion.d, *motion.slope]
    u[axis] += step
    return replace(motion, d=(u[0], u[1]), slope=(u[2], u[3]))
