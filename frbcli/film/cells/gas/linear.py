"""A film whose oil carries gas, linearised about its settled state, with oil and free gas of each cell as states.

The unknowns are w and the free gas c of the cells. The balance of the gas less c times the balance of the oil is

    A H theta c' + sum_in q (c - c_up) = A H theta (c_e - c) / tau,

which is multiplied by tau / (1 + tau r), so that no rate is too fast or too slow for it (r: see balance.py). Both
balances are sums over next neighbours: cells that are not neighbours of one are moved at the same time for their
derivatives. Both states of a cell are adjacent; the cells are ordered so that an elimination fills little. """

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.states import CARRIED_GAS, FRACTION, PRESSURE, STATES, TURNOVER, UPWIND, cell_states
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.balance import FreeGas, OilPaths, brought, paths_of, with_own_gas
from frbcli.film.cells.gas.carry import PATHS, follow_oil
from frbcli.film.cells.loads import pushing
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.tilted.motion import seen_by_grid

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

At = tuple[Array, Array, Motion]  # w, c and the motion of the journal
Entries = tuple[Array, NDArray[np.int64], NDArray[np.int64]]  # of a matrix, with their rows and columns
STEP = 1e-6  # of the differences: balances are nearly linear in it


class LinearStates(NamedTuple):
    """Derivatives of a film of n cells by its states, w and c of each cell: of its balances, flow (2 n, 2 n) and, by
    the rates of the states, storage (2 n, 2 n); by displacement and velocity over the clearance, by_place and by_rate
    (2 n, c); by omega_J + omega_S, by_total (2 n,); of the c loads in N, push (c, 2 n), and of the share of Couette's
    torque, sheared (2 n,). c: the 2 of the displacement, or 4 with its growth over the width, see film_changes of
    steady_force.py."""

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
        data = volume_films([film])
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
