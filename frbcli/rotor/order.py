"""Order and choice among numbers that are equal but for round-off: by a rule, the same on every processor.

Equal eigenvalues, motions on a circle and shapes that are symmetric leave to round-off which of them comes first or is
the largest. Here numbers that are as near to each other as EQUAL count as one, and the next rule decides.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array

EQUAL = 1e-9  # of the largest size


def ranks(values: Array, size: float | None = None) -> NDArray[np.intp]:
    """(n,) ranks of numbers (n,) in ascending order, from 0; neighbours nearer than EQUAL times `size`, default the
    largest size, share one."""
    if not len(values):
        return np.zeros(0, dtype=np.intp)
    order = np.argsort(values, kind="stable")
    apart = np.diff(values[order]) > EQUAL * (float(np.max(np.abs(values))) if size is None else size)
    found = np.empty(len(values), dtype=np.intp)
    found[order] = np.concatenate([[0], np.cumsum(apart)])
    return found


def fastest_first(eigenvalues: NDArray[np.complex128]) -> NDArray[np.intp]:
    """(n,) order of eigenvalues by falling real part; those that grow alike in ascending order of the frequency, of a
    pair the one with positive imaginary part first."""
    size = float(np.max(np.abs(eigenvalues), initial=0.0))
    by_frequency = ranks(np.abs(eigenvalues.imag), size)
    return np.lexsort((-eigenvalues.imag, by_frequency, ranks(-eigenvalues.real, size)))


def largest_first(multipliers: NDArray[np.complex128]) -> NDArray[np.intp]:
    """(n,) order of multipliers by falling size; those of one size in ascending order of the angle, of a pair the one
    with positive imaginary part first."""
    by_angle = ranks(np.abs(np.angle(multipliers)), np.pi)
    return np.lexsort((-multipliers.imag, by_angle, ranks(-np.abs(multipliers))))


def first_largest(values: NDArray[np.complex128] | Array) -> int:
    """Index of the largest size: the first one of those that are equal to it."""
    size = np.abs(values)
    return int(np.argmax(size >= (1.0 - EQUAL) * size.max()))
