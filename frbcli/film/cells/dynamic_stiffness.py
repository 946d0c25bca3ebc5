"""The dynamic stiffness Z(s) of mass-conserving films: -F = Z(s) d for a motion d exp(s t) of the journal.

F has c components, two forces and of a film that tilts two moments, d as many coordinates or one more, see LinearFilm.

    Z(s) = push (storage s + flow)^-1 (by_place + s by_rate)

of linearised.py. It is needed at many s, and smooth: a film is projected onto the changes of its oil at a few
frequencies, from the right and from the left, so that Z and its derivative are exact there (two-sided rational Krylov
projection: A. C. Antoulas, Approximation of Large-Scale Dynamical Systems, SIAM 2005, section 11.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.film.cells.linearised import LinearFilm

ROUND_OFF = 1e-11  # of the largest: of directions in which vectors do not reach


@dataclass(frozen=True)
class DynamicStiffness:
    """Z(s) = place + s rate + sum of left_j (right_place_j + s right_rate_j) / (1 + s delay_j), in SI units.

    place, rate: (c, d) of what does not depend on the oil's memory; left: (c, r), right_place, right_rate: (r, d);
    delays: (r,) s of the oil."""

    place: Array
    rate: Array
    left: Complex
    right_place: Complex
    right_rate: Complex
    delays: Complex

    def at(self, s: complex) -> tuple[Complex, Complex]:
        """Z (c, d) at s in 1/s and its derivative by s."""
        share = 1.0 / (1.0 + s * self.delays)
        moved = self.right_place + s * self.right_rate
        slope = self.right_rate - (share * self.delays)[:, None] * moved
        z = self.place + s * self.rate + (self.left * share) @ moved
        return z, self.rate + (self.left * share) @ slope


def without_memory(stiffness: Array, damping: Array) -> DynamicStiffness:
    """The dynamic stiffness of a film of stiffness and damping (c, d)."""
    forces, coordinates = stiffness.shape
    left, right = np.zeros((forces, 0), dtype=complex), np.zeros((0, coordinates), dtype=complex)
    return DynamicStiffness(stiffness, damping, left, right, right, np.zeros(0, dtype=complex))


def weighted(parts: Sequence[tuple[DynamicStiffness, float]]) -> DynamicStiffness:
    """The sum of dynamic stiffnesses, each times its weight."""
    nothing = np.zeros_like(parts[0][0].place)
    return DynamicStiffness(
        sum((weight * part.place for part, weight in parts), nothing),
        sum((weight * part.rate for part, weight in parts), nothing),
        np.concatenate([weight * part.left for part, weight in parts], axis=1),
        np.concatenate([part.right_place for part, _ in parts]),
        np.concatenate([part.right_rate for part, _ in parts]),
        np.concatenate([part.delays for part, _ in parts]),
    )


def stiffness_at(film: LinearFilm, s: complex) -> Complex:
    """Z (c, d) at one s in 1/s, without a projection."""
    right, _ = _changes(film, s)
    return np.asarray(film.push @ right)


def dynamic_stiffness(film: LinearFilm, frequencies: Sequence[float]) -> DynamicStiffness:
    """Z of a film, exact at rest and at the frequencies in rad/s, above 0."""
    rights: list[Array] = []
    lefts: list[Array] = []
    for s in (0.0j, *(1j * frequency for frequency in frequencies)):
        for change, kept in zip(_changes(film, s), (rights, lefts), strict=True):
            kept += [change.real] if s == 0.0 else [change.real, change.imag]
    right, left = (_span(np.concatenate(kept, axis=1)) for kept in (rights, lefts))
    right, left = _filled(right, left), _filled(left, right)
    flow = left.T @ (film.flow @ right)
    storage = left.T @ (film.storage @ right)
    delays, shapes = np.linalg.eig(np.linalg.solve(flow, storage))
    moved = np.linalg.solve(flow, left.T @ np.concatenate([film.by_place, film.by_rate], axis=1))
    by_place, by_rate = np.split(np.linalg.solve(shapes, moved.astype(complex)), 2, axis=1)
    nothing = np.zeros((len(film.push), film.by_place.shape[1]))
    return DynamicStiffness(nothing, nothing, film.push @ right @ shapes, by_place, by_rate, delays.astype(complex))


def _changes(film: LinearFilm, s: complex) -> tuple[Complex, Complex]:
    """(n, d) changes of the cells for unit motions of the journal, and (n, c) what the force takes of their
    balances."""
    from scipy.sparse.linalg import splu  # takes long to load

    # Oil that leaves one cell enters others: the diagonal serves as pivot, as in elimination/block_cyclic.py, and the
    # order is the one for a symmetric matrix.
    matrix, at = film.at(s), s if s.imag else s.real
    solver = splu(
        matrix,
        permc_spec="NATURAL" if film.ordered else "MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    right = solver.solve((film.by_place + at * film.by_rate).astype(matrix.dtype))
    return right, solver.solve(film.push.T.astype(matrix.dtype), "T")


def _span(vectors: Array) -> Array:
    """(n, r) orthonormal basis of vectors (n, m). A film with few cells that are part-filled has few motions of its
    own, and vectors that are sums of others but for round-off lead nowhere."""
    size = np.linalg.norm(vectors, axis=0)
    basis, small = np.linalg.qr(vectors / np.where(size > 0.0, size, 1.0))
    turned, values, _ = np.linalg.svd(small)
    return np.asarray(basis @ turned[:, values > ROUND_OFF * values[0]])


def _filled(basis: Array, other: Array) -> Array:
    """The basis with as many vectors as the other one, the missing ones out of that."""
    missing = other.shape[1] - basis.shape[1]
    if missing <= 0:
        return basis
    rest, small = np.linalg.qr(other - basis @ (basis.T @ other))
    turned, _, _ = np.linalg.svd(small)
    return np.hstack([basis, rest @ turned[:, :missing]])
