"""Solution on a ring of columns of quadratic elements from the factors that ring.py leaves, compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from frbcli.film.grid import Array
from frbcli.film.quadratic.ring import Ring


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def solve(ring: Ring, right: Array) -> None:
    """Overwrite right (r, 2 a, 2 k + 1), sums over the elements at the nodes, with the r solutions, 0 at the ends."""
    work = np.zeros(3 * ring.padded)
    for r in range(right.shape[0]):
        x = right[r]
        _condense_columns(ring, x)
        _forward(ring, x, work)
        _backward(ring, x, work)
        for line in range(2 * ring.around):
            x[line, 0] = 0.0
            if ring.unknowns < 2 * ring.along:
                x[line, 2 * ring.along] = 0.0
        _fill_columns(ring, x)


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _condense_columns(ring, x):  # type: ignore[no-untyped-def]
    """Take the middle nodes of the elements and the middle lines out of the right side x (2 a, 2 k + 1)."""
    n, padded = ring.unknowns, ring.padded
    for i in range(ring.around):
        low, middle, high = x[2 * i], x[2 * i + 1], x[(2 * i + 2) % (2 * ring.around)]
        for j in range(ring.along):
            centre = ring.centre[i * ring.along + j]
            share = middle[2 * j + 1] * centre[4]
            for q in range(3):
                low[2 * j + q] -= centre[q] * share
                high[2 * j + q] -= centre[6 + q] * share
            middle[2 * j] -= centre[3] * share
            middle[2 * j + 2] -= centre[5] * share
        for m in range(n // 2):
            share = middle[2 * m + 2] * ring.pivot[i, m]
            if m + 1 < n // 2:
                middle[2 * m + 4] -= ring.next[i, m] * share
            for u in range(n):
                low[1 + u] -= ring.crossing[i, m, u] * share
                high[1 + u] -= ring.crossing[i, m, padded + u] * share


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _forward(ring, x, work):  # type: ignore[no-untyped-def]
    """Take line after line out of the right side x (2 a, 2 k + 1); work (3 N,)."""
    a, n, padded = ring.around, ring.unknowns, ring.padded
    for u in range(n):
        work[u], work[padded + u], work[2 * padded + u] = x[2, 1 + u], 0.0, x[0, 1 + u]
    for i in range(1, a):
        if i + 1 < a:
            for u in range(n):
                work[padded + u] = x[2 * i + 2, 1 + u]
        for p in range(n):
            share = work[p] * ring.inverse[i, p]
            for c in range(p + 1, 3 * padded):
                work[c] -= ring.lines[i, p, c] * share
        for u in range(n):
            x[2 * i, 1 + u], work[u] = work[u], work[padded + u]
    for p in range(n):
        share = work[2 * padded + p] * ring.inverse[0, p]
        for c in range(p + 1, n):
            work[2 * padded + c] -= ring.lines[0, p, c] * share


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _backward(ring, x, work):  # type: ignore[no-untyped-def]
    """Solution on the lines, into x (2 a, 2 k + 1), from what _forward has left in x and work (3 N,)."""
    n, padded = ring.unknowns, ring.padded
    for p in range(n - 1, -1, -1):
        value = work[2 * padded + p]
        for c in range(p + 1, n):
            value -= ring.lines[0, p, c] * work[2 * padded + c]
        work[2 * padded + p] = value * ring.inverse[0, p]
    for u in range(n):
        x[0, 1 + u], work[u] = work[2 * padded + u], 0.0
    for i in range(ring.around - 1, 0, -1):
        for u in range(n):
            work[padded + u], work[u] = work[u], x[2 * i, 1 + u]
        for p in range(n - 1, -1, -1):
            value = work[p]
            for c in range(p + 1, 3 * padded):
                value -= ring.lines[i, p, c] * work[c]
            work[p] = value * ring.inverse[i, p]
        for u in range(n):
            x[2 * i, 1 + u] = work[u]


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _fill_columns(ring, x):  # type: ignore[no-untyped-def]
    """Solution within the columns of elements, into x (2 a, 2 k + 1), from that on the lines; 0 at the ends."""
    n, padded = ring.unknowns, ring.padded
    for i in range(ring.around):
        low, middle, high = x[2 * i], x[2 * i + 1], x[(2 * i + 2) % (2 * ring.around)]
        for m in range(n // 2 - 1, -1, -1):
            value = middle[2 * m + 2]
            if m + 1 < n // 2:
                value -= ring.next[i, m] * middle[2 * m + 4]
            for u in range(n):
                value -= ring.crossing[i, m, u] * low[1 + u] + ring.crossing[i, m, padded + u] * high[1 + u]
            middle[2 * m + 2] = value * ring.pivot[i, m]
        for j in range(ring.along):
            centre = ring.centre[i * ring.along + j]
            value = middle[2 * j + 1] - centre[3] * middle[2 * j] - centre[5] * middle[2 * j + 2]
            for q in range(3):
                value -= centre[q] * low[2 * j + q] + centre[6 + q] * high[2 * j + q]
            middle[2 * j + 1] = value * centre[4]
