"""The balance of the free gas that oil carries through the cells of a film, in array notation.

With c the free gas per oil and q the flows of oil between cells, each of which carries the gas of the cell that it
leaves, the gas of a cell obeys

    A (rate H theta c - past) + sum_out q c - sum_in q c_up = A H theta (c_e - c) / tau,

c_e and tau being those of the law, see bubbly.py. Openings and baths give oil with the free gas of the supplied oil.
Divided by M = A rate H theta + sum_out q, what is known of the cell and its neighbours is c_in = (A past + sum_in q
c_up) / M, and r = M / (A H theta).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cavitation.law import CellState, Law, Scales
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.motion import Storage
from frbcli.film.grid import Array

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

NONE = 1e-300
STILL = 1e-6


class Carried(NamedTuple):
    """c_in and r of cells (m, k), which the law makes their free gas of."""

    gas: Array
    turnover: Array


class KeptGas(NamedTuple):
    """Gas of a step. past: (m, k) of H theta c, as that of the oil; guess: what is carried at its end, about."""

    past: Array
    guess: Carried


@dataclass(frozen=True)
class FreeGas:
    """The free gas of a solution. free: (m, k) c by its balance; carried: with these; off: the most that the free gas
    by the law differs from it; mean: of c over the oil; inflow, outflow, released, stored: gas per time in scaled units
    (R b C, 1/s) at the saturation pressure, by one section, released being what leaves the solution net; defect: what
    the balances of all cells are off by, in the sum over the gas that the oil carries through the film, dissolved or
    not; of enclosed oil over STILL of the gas that its cells take up or pass on."""

    free: Array
    carried: Carried
    off: float
    mean: float
    inflow: float
    outflow: float
    released: float
    stored: float
    defect: float


class OilPaths(NamedTuple):
    """Flows of oil (m, k) to where each cell of unknown gas has its oil from: onward and backward through the face
    after it around, upward and downward along (m, k - 1); out: all that leaves; given: that comes from outside."""

    onward: Array
    backward: Array
    upward: Array
    downward: Array
    out: Array
    given: Array


def oil_paths(balances: CellBalances, state: CellState) -> OilPaths:
    """The flows of oil of a solution by where they begin.

    Where surfaces carry more out of a cell than into the next one, which is an opening in part, the opening takes the
    difference, or gives it.
    """
    fluxes, _, _ = balances.fluxes(state.pressure, state.fraction)
    share = balances.grid.share
    leaves = fluxes.around + share * fluxes.carried
    enters = fluxes.around + np.roll(share, -1, axis=0) * fluxes.carried
    shared = np.sign(leaves) * np.where(leaves * enters > 0.0, np.minimum(np.abs(leaves), np.abs(enters)), 0.0)
    onward, backward = np.maximum(shared, 0.0), np.maximum(-shared, 0.0)
    upward, downward = np.maximum(fluxes.along, 0.0), np.maximum(-fluxes.along, 0.0)
    out = onward + np.roll(backward, 1, axis=0)
    out[:, :-1] += upward
    out[:, 1:] += downward
    given = np.zeros_like(out)
    outside = [leaves - shared, -np.roll(enters - shared, 1, axis=0), fluxes.excess]
    for at, flow in ((0, fluxes.near), (-1, fluxes.far)):
        outside.append(np.zeros_like(out))
        outside[-1][:, at] = flow
    for flow in outside:
        out += np.maximum(flow, 0.0)
        given += np.maximum(-flow, 0.0)
    return OilPaths(onward, backward, upward, downward, out, given)


def free_gas(
    law: Law, scales: Scales, balances: CellBalances, state: CellState, storage: Storage, gap: Array, past: Array,
    carried: Carried,
) -> FreeGas:  # fmt: skip
    """The gas of a solution `state`, which `carried` has served for.

    storage: of the oil; gap: (m, 1) or (m, k) H of the oil that is kept; past: (m, k) of the gas, as of the oil.
    """
    from scipy.sparse.linalg import spsolve  # takes long to load

    grid, paths = balances.grid, oil_paths(balances, state)
    fixed, oil = grid.fixed, grid.area * gap * state.fraction
    kept = np.where(fixed, 1.0, np.maximum(grid.area * storage.factor * state.fraction + paths.out, NONE))  # M
    known = np.where(fixed, law.supplied_gas, grid.area * past + paths.given * law.supplied_gas)
    settled, time = law.exchanged(state.pressure, carried.gas, scales)
    exchanged = np.where(fixed, 0.0, oil / (oil + time * kept))
    share = (1.0 - exchanged) / kept  # of what comes in, in c
    free = spsolve(_less_brought(share, paths, fixed), (share * known + exchanged * settled).ravel())
    free = free.reshape(grid.shape)
    told = np.where(fixed, law.supplied_gas, law.free_gas(state, scales))
    comes = np.where(fixed, law.supplied_gas, (known + brought(paths, told)) / kept)
    left = np.where(fixed, 0.0, kept * (told - comes - exchanged * (settled - comes)))
    released = np.where(fixed, 0.0, kept * (told - comes))
    stored = np.where(fixed, 0.0, grid.area * (storage.factor * state.fraction * told - past))
    inflow, outflow = _through(law.supplied_gas, paths, told, fixed)
    oil_in, oil_out = _through(1.0, paths, np.ones_like(told), fixed)
    passed = max(oil_in, oil_out, STILL * float(np.where(fixed, 0.0, kept).sum()))
    at = np.where(fixed, law.supplied_gas, (known + brought(paths, free)) / kept)
    return FreeGas(
        free,
        Carried(at, np.where(fixed, 0.0, kept / np.maximum(oil, NONE))),
        float(np.max(np.abs(told - free))),
        float(np.where(fixed, 0.0, oil * told).sum() / np.where(fixed, 0.0, oil).sum()),
        inflow,
        outflow,
        float(released.sum()),
        float(stored.sum()),
        float(np.abs(left).sum()) / max(law.gas_content * passed, NONE),
    )


def brought(paths: OilPaths, free: Array) -> Array:
    """(m, k) gas that other cells bring to each one, sum_in q c_up."""
    found = np.roll(paths.onward * free, 1, axis=0) + paths.backward * np.roll(free, -1, axis=0)
    found[:, 1:] += paths.upward * free[:, :-1]
    found[:, :-1] += paths.downward * free[:, 1:]
    return np.asarray(found)


def _through(supplied: float, paths: OilPaths, free: Array, fixed: NDArray[np.bool_]) -> tuple[float, float]:
    """The gas that comes into the cells of unknown gas from outside and from given cells, and that leaves to there."""
    among = np.where(fixed, 0.0, 1.0)
    inside = np.where(fixed, 0.0, brought(paths, free * among))
    inflow = float((np.where(fixed, 0.0, paths.given * supplied + brought(paths, free * (1.0 - among)))).sum())
    return inflow, float((among * paths.out * free).sum() - inside.sum())


def _less_brought(share: Array, paths: OilPaths, fixed: NDArray[np.bool_]) -> csc_matrix:
    """The sparse matrix of c - share (sum_in q c_up), in fixed cells of c."""
    from scipy.sparse import csc_matrix

    number = np.arange(share.size).reshape(share.shape)
    after, takes = np.roll(number, -1, axis=0), np.where(fixed, 0.0, share).ravel()
    links = (
        (after, number, paths.onward),
        (number, after, paths.backward),
        (number[:, 1:], number[:, :-1], paths.upward),
        (number[:, :-1], number[:, 1:], paths.downward),
    )
    rows = np.concatenate([number.ravel(), *(into.ravel() for into, _, _ in links)])
    columns = np.concatenate([number.ravel(), *(out_of.ravel() for _, out_of, _ in links)])
    entries = [-takes[into.ravel()] * flow.ravel() for into, _, flow in links]
    return csc_matrix((np.concatenate([np.ones(number.size), *entries]), (rows, columns)), shape=(number.size,) * 2)
