"""Products and inverses of small dense blocks, compiled; none of the arrays may be part of another."""

from __future__ import annotations

from frbcli.compiled import Array, compiled

FOUR = 4  # rows that are subtracted at once


@compiled(fastmath={"contract"})
def invert(a: Array, pivot: Array) -> None:
    """a (k, k) <- its inverse, by Gauss and Jordan's elimination in place; pivot (k,) is overwritten."""
    k = a.shape[0]
    for p in range(k):
        inverse = 1.0 / a[p, p]
        a[p, p] = 1.0
        for j in range(k):
            a[p, j] *= inverse
            pivot[j] = a[p, j]
        for i in range(k):
            factor = a[i, p]
            if i != p and factor != 0.0:
                a[i, p] = 0.0
                for j in range(k):
                    a[i, j] -= factor * pivot[j]


@compiled(fastmath={"contract"})
def subtract_product(a: Array, b: Array, rest: Array) -> None:
    """rest (m, n) <- rest - a (m, k) b (k, n), four rows of b into two rows at once."""
    rows, k = a.shape
    n, whole, paired = b.shape[1], k - k % FOUR, rows - rows % 2
    for i in range(0, paired, 2):
        for j in range(0, whole, FOUR):
            s0, s1, s2, s3 = a[i, j], a[i, j + 1], a[i, j + 2], a[i, j + 3]
            t0, t1, t2, t3 = a[i + 1, j], a[i + 1, j + 1], a[i + 1, j + 2], a[i + 1, j + 3]
            for c in range(n):
                b0, b1, b2, b3 = b[j, c], b[j + 1, c], b[j + 2, c], b[j + 3, c]
                rest[i, c] -= s0 * b0 + s1 * b1 + s2 * b2 + s3 * b3
                rest[i + 1, c] -= t0 * b0 + t1 * b1 + t2 * b2 + t3 * b3
        for j in range(whole, k):
            s0, t0 = a[i, j], a[i + 1, j]
            for c in range(n):
                rest[i, c] -= s0 * b[j, c]
                rest[i + 1, c] -= t0 * b[j, c]
    for i in range(paired, rows):
        for j in range(k):
            s0 = a[i, j]
            for c in range(n):
                rest[i, c] -= s0 * b[j, c]
