"""A film whose oil carries gas, linearised about its settled state, with oil and free gas of each cell as states.

The unknowns are w and the free gas c of the cells. The balance of the gas less c times that of the oil is

    A H theta c' + sum_in q (c - c_up) = A H theta (c_e - c) / tau,

which is multiplied by tau / (1 + tau r), so that no rate is too fast or too slow for it (r: see balance.py). Both
balances are sums over next neighbours: cells that are not neighbours of one are moved at the same time for their
derivatives.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.cells.balance.carried import UPWIND
from frbcli.film.cells.balance.states import CARRIED_GAS, FRACTION, PRESSURE, STATES, TURNOVER, cell_states
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.balance import FreeGas, brought, paths_of, with_own_gas
from frbcli.film.cells.gas.carry import PATHS, follow_oil
from frbcli.film.cells.mesh.grid import force_weights
from frbcli.film.cells.motion import Motion
from frbcli.film.grid import Array

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

At = tuple[Array, Array, Motion]  # w, c and the motion of the journal
STEP = 1e-6  # of the differences: balances are nearly linear in it


class LinearStates(NamedTuple):
    """Derivatives of a film of n cells by its states, w and c of all cells: of its balances, flow (2 n, 2 n) and, by
    the rates of the states, storage (2 n, 2 n); by displacement and velocity over the clearance, by_place and by_rate
    (2 n, 2); of the force in N on the journal, push (2, 2 n)."""

    flow: csc_matrix
    storage: csc_matrix
    by_place: Array
    by_rate: Array
    push: Array


def linear_states(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> LinearStates:
    """The film linearised about a settled solution, its journal being at rest."""
    from scipy.sparse import bmat, coo_matrix, diags  # takes long to load

    assert solution.gas is not None
    grid, w, free = film.grid, solution.w, solution.gas.free
    settled = _Settled(film, solution.gas, solution.state.pressure)
    flow: list[list[Any]] = [[0, 0], [0, 0]]
    for cells in _apart(grid.shape):
        step, near, nothing = STEP * np.where(grid.fixed, 0.0, cells), _nearest(cells), np.zeros(grid.shape)
        for column, (by_w, by_free) in enumerate(((step, nothing), (nothing, step))):
            changes = settled.change((w + by_w, free + by_free, motion), (w - by_w, free - by_free, motion))
            for row, change in enumerate(changes):
                entries = change.ravel(), (np.arange(w.size), near.ravel())
                flow[row][column] = flow[row][column] + coo_matrix(entries, shape=(w.size, w.size)).tocsc()
    given = diags(grid.fixed.ravel().astype(np.float64))  # their states stay as they are
    flow[0][0], flow[1][1] = flow[0][0] + given, flow[1][1] + given
    places = [
        settled.change((w, free, _moved(motion, axis, STEP)), (w, free, _moved(motion, axis, -STEP))) for axis in (0, 1)
    ]
    state, gap = settled.state(w, free), settled.gap(motion)
    high, low = settled.state(w, free + STEP), settled.state(w, free - STEP)
    fraction, pressure = (high.fraction - low.fraction) / (2.0 * STEP), (high.pressure - low.pressure) / (2.0 * STEP)
    area = np.where(grid.fixed, 0.0, grid.area)
    oil, mixed = (diags((area * gap * slope).ravel()) for slope in (state.fraction_slope, fraction))
    gas = diags((area * gap * state.fraction * settled.rated * settled.time).ravel())
    rate = [(area * state.fraction * side[:, None]).ravel() for side in (np.sin(grid.centre), -np.cos(grid.centre))]
    return LinearStates(
        bmat(flow, format="csc"),
        bmat([[oil, mixed], [None, gas]], format="csc"),
        np.stack([np.concatenate([each.ravel() for each in place]) for place in places], axis=1),
        np.concatenate([np.stack(rate, axis=1), np.zeros((w.size, 2))]),
        np.concatenate([_push(film, state.pressure_slope), _push(film, pressure)], axis=1),
    )


class _Settled:
    """The balances of a film near a settled solution with the free gas `gas`; rated: 1 / (1 + tau r)."""

    def __init__(self, film: VolumeFilm, gas: FreeGas, pressure: Array) -> None:
        data = volume_films([film])
        self.film, self._own = film, (data.films[0], data.ring[0], data.width[0], data.cells[0])
        self._law = np.append(given_parameters(film.law), np.nan)  # where a cell is empty: not asked for here
        _, self.time = film.law.exchanged(pressure, gas.carried.gas, film.scales)
        self.rated = 1.0 / (1.0 + self.time * gas.carried.turnover)

    def state(self, w: Array, free: Array) -> CellState:
        """Of cells with the free gas (m, k) as it is given."""
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
        own, ring, width, cells = self._own
        states, layers = np.full((STATES, m, k), UPWIND), np.empty((PATHS, m, k))
        states[CARRIED_GAS], states[TURNOVER] = with_own_gas(free)
        cell_states(own, cells, self._law, 0.0, np.ascontiguousarray(w), states)
        x, y = motion.d
        follow_oil(own, ring, width, cells, states, GridMotion(x, y, motion.omega), layers)
        paths = paths_of(layers)
        comes = brought(paths, np.ones_like(free)) + paths.given
        taken = comes * free - brought(paths, free) - paths.given * law.supplied_gas
        target, _ = law.exchanged(states[PRESSURE], free, film.scales)
        held = film.grid.area * self.gap(motion) * states[FRACTION]
        open_ = np.where(film.grid.fixed, 0.0, 1.0)
        gas = open_ * self.rated * (self.time * taken - held * (target - free))
        return open_ * (paths.out - comes), gas


def _apart(shape: tuple[int, int]) -> Iterator[NDArray[np.bool_]]:
    """Sets of cells (m, k) of which no two have a neighbour in common, nor are neighbours."""
    m, k = shape
    column = np.arange(m) % 3
    column[m - m % 3 :] = 3 + np.arange(m % 3)  # where the ring closes
    for around in range(3 + m % 3):
        for along in range(min(3, k)):
            yield (column == around)[:, None] & (np.arange(k) % 3 == along)[None, :]


def _nearest(cells: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(m, k) number of the cell of a set of _apart that is a cell or next to it, 0 where there is none."""
    numbers = np.where(cells, np.arange(cells.size).reshape(cells.shape), 0)
    numbers = np.maximum(numbers, np.maximum(np.roll(numbers, 1, axis=0), np.roll(numbers, -1, axis=0)))
    found = numbers.copy()
    found[:, 1:] = np.maximum(found[:, 1:], numbers[:, :-1])
    found[:, :-1] = np.maximum(found[:, :-1], numbers[:, 1:])
    return found


def _moved(motion: Motion, axis: int, step: float) -> Motion:
    x, y = motion.d
    return replace(motion, d=(x + step, y) if axis == 0 else (x, y + step))


def _push(film: VolumeFilm, slope: Array) -> Array:
    """(2, n) force in N per state that changes the scaled pressures by `slope` (m, k)."""
    section, grid = film.section, film.grid
    weight = section.copies * section.radius * section.width * section.pressure_scale * force_weights(section, grid)
    sides = np.diff(np.cos(grid.phi)), np.diff(np.sin(grid.phi))
    return np.stack([-(side[:, None] * weight * slope).ravel() for side in sides])
