"""Gaussian elimination of the cells' equations in an order that is found once for a grid, compiled.

Without pivoting: oil that leaves one cell enters others, so that no diagonal entry is smaller than the others of its
column together, but for what a closing gap takes away and what a law makes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.compiled import compiled
from frbcli.film.grid import Array


class Elimination(NamedTuple):
    """The order of elimination and the places of all entries that arise.

    order: (n,) new index of each unknown; starts (n + 1,), columns (e,): the rows of L and U together, columns rising;
    diagonal: (n,) places of the diagonal; places: where the entries of the matrix go, in the order in which they come.
    """

    order: NDArray[np.int64]
    starts: NDArray[np.int64]
    columns: NDArray[np.int64]
    diagonal: NDArray[np.int64]
    places: NDArray[np.int64]


def plan_elimination(rows: NDArray[np.int64], columns: NDArray[np.int64], size: int) -> Elimination:
    """The elimination, by minimum degree, of a matrix with entries at rows and columns (e,) in a symmetric pattern."""
    from scipy.sparse import csc_matrix, csr_matrix
    from scipy.sparse.linalg import splu

    values = np.where(rows == columns, 10.0, -1.0)  # no entry of L cancels
    pattern = csc_matrix((values, (rows, columns)), shape=(size, size))
    factors = splu(pattern, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    lower = abs(factors.L)
    both = csr_matrix(lower + lower.T)
    both.sort_indices()
    order = factors.perm_c.astype(np.int64)
    numbered = csr_matrix((np.arange(1, both.nnz + 1), both.indices, both.indptr), shape=both.shape)
    places = np.asarray(numbered[order[rows], order[columns]]).ravel() - 1
    diagonal = numbered.diagonal() - 1
    wide = (array.astype(np.int64) for array in (both.indptr, both.indices, diagonal, places))
    return Elimination(order, *wide)


@compiled()
def eliminate(plan: Elimination, entries: Array, right: Array) -> Array:
    """(n,) solution for the entries (e,) of the matrix and its right side (n,); not finite where it is singular."""
    n = len(plan.order)
    starts, columns, diagonal = plan.starts, plan.columns, plan.diagonal
    factors = np.zeros(len(columns))
    for entry in range(len(entries)):
        factors[plan.places[entry]] = entries[entry]
    work = np.zeros(n)
    y = np.empty(n)
    for i in range(n):
        y[plan.order[i]] = right[i]
    for i in range(n):
        for place in range(starts[i], starts[i + 1]):
            work[columns[place]] = factors[place]
        for place in range(starts[i], diagonal[i]):
            k = columns[place]
            share = work[k] / factors[diagonal[k]]
            if share != 0.0:
                work[k] = share
                y[i] -= share * y[k]
                for above in range(diagonal[k] + 1, starts[k + 1]):
                    work[columns[above]] -= share * factors[above]
        for place in range(starts[i], starts[i + 1]):
            factors[place] = work[columns[place]]
            work[columns[place]] = 0.0
    for i in range(n - 1, -1, -1):
        for place in range(diagonal[i] + 1, starts[i + 1]):
            y[i] -= factors[place] * y[columns[place]]
        y[i] /= factors[diagonal[i]]
    return y[plan.order]
