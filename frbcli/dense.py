"""Small dense systems inside of kernels.

LAPACK would do it, but its bindings alone take a third of the time in which the whole loop is compiled, and systems
here have two to some sixty unknowns.
"""

from __future__ import annotations

from frbcli.arrays import Array
from frbcli.compiled import compiled


@compiled()
def solve_dense(matrix: Array, right: Array) -> None:
    """right (n, r) <- matrix^-1 right by elimination with row pivoting. The first n columns of matrix are overwritten.

    A singular matrix leaves infinities or NaN in `right`: the caller looks at what it does with the result.
    """
    n, columns = matrix.shape[0], right.shape[1]
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(k, n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            for j in range(columns):
                right[k, j], right[pivot, j] = right[pivot, j], right[k, j]
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            if factor != 0.0:
                for j in range(k + 1, n):
                    matrix[i, j] -= factor * matrix[k, j]
                for j in range(columns):
                    right[i, j] -= factor * right[k, j]
    for i in range(n - 1, -1, -1):
        for j in range(columns):
            total = right[i, j]
            for k in range(i + 1, n):
                total -= matrix[i, k] * right[k, j]
            right[i, j] = total / matrix[i, i]
