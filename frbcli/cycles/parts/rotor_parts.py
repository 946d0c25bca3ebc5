"""The rotor behind its films in parts that do not see each other.

A shaft that is the same in all directions turns into two rotors of half its size, for p = (x + i y) / sqrt(2) and
m = (x - i y) / sqrt(2) of its motions x in one plane and y in the other: the motions that circle one way and the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.rotor.linear import LinearRotor

SMALLEST = 16  # degrees of freedom from which on two parts are solved faster than one
ALIKE = 1e-9  # by which planes that count as the same may differ, relative
INDEPENDENT = 1e-13  # share of the largest singular value above which a direction counts


@dataclass(frozen=True)
class Part:
    """matrices: (4, n, n) mass, damping, gyroscopic and stiffness of the part, with the dashpots and springs parallel
    to the films; basis (n, b): of all directions in which films see and load it, shapes (2 F, n) = seen (2 F, b)
    basis^T and pulls (n, 2 F) = basis given (b, 2 F), see transfer of machine.py; others: (n, l) what else loads it;
    symmetric: whether all matrices are; planes: the degrees of freedom (n,) of x and of y that it is made of, None of
    the whole rotor."""

    matrices: Complex
    basis: Complex
    seen: Complex
    given: Complex
    others: Complex
    symmetric: bool
    planes: tuple[NDArray[np.int64], NDArray[np.int64]] | None

    def dynamic(self, s: Complex, omega: Array | float) -> Complex:
        """(m, n, n) between motions exp(s t), s (m,), and loads, at speeds omega in rad/s."""
        shares = np.array([s**2, s, s * omega, np.ones(len(s))])
        return np.asarray((shares.T @ self.matrices.reshape(4, -1)).reshape(-1, *self.matrices.shape[1:]))

    def answers(self, z: Complex) -> tuple[Complex, Complex]:
        """z^-1 basis (H + 1, n, b) and basis^T z^-1 (H + 1, b, n) of matrices z (H + 1, n, n)."""
        wanted = np.broadcast_to(self.basis, (len(z), *self.basis.shape))
        right = np.linalg.solve(z, wanted)
        left = right if self.symmetric else np.linalg.solve(np.swapaxes(z, 1, 2), wanted)
        return np.asarray(right), np.asarray(np.swapaxes(left, 1, 2))


def parts_of(rotor: LinearRotor, springs: Array, dashpots: Array, shapes: Array, loads: Complex) -> tuple[Part, ...]:
    """The whole rotor, or both of its parts. springs, dashpots: (n, n) parallel to the films; loads: (n, 2 F + l), the
    film forces first."""
    matrices = (rotor.mass, rotor.damping + dashpots, rotor.gyroscopic, rotor.stiffness + springs)
    planes = _planes(shapes, matrices) if rotor.size >= SMALLEST else None
    if planes is None:
        return (_part(np.array(matrices, dtype=complex), shapes, loads),)
    x, y = planes
    parts = []
    for turn in (1j, -1j):
        own = np.array([matrix[np.ix_(x, x)] - turn * matrix[np.ix_(x, y)] for matrix in matrices])
        seen, given = shapes[:, x] - turn * shapes[:, y], loads[x] + turn * loads[y]
        parts.append(_part(own, seen / np.sqrt(2.0), given / np.sqrt(2.0), planes))
    return tuple(parts)


def _part(
    matrices: Complex,
    shapes: Array | Complex,
    loads: Complex,
    planes: tuple[NDArray[np.int64], NDArray[np.int64]] | None = None,
) -> Part:
    symmetric = all(np.abs(each - each.T).max() <= ALIKE * np.abs(each).max(initial=0.0) for each in matrices)
    cut = len(shapes)
    directions = np.hstack([shapes.T.astype(complex), loads[:, :cut]])
    sizes = np.linalg.norm(directions, axis=0)
    left, singular, _ = np.linalg.svd(directions / np.where(sizes > 0.0, sizes, 1.0), full_matrices=False)
    basis = left[:, singular > INDEPENDENT * singular[0]]
    shares = np.conj(basis).T @ directions
    return Part(matrices, basis, shares[:, :cut].T, shares[:, cut:], loads[:, cut:], symmetric, planes)


def _planes(shapes: Array, matrices: tuple[Array, ...]) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """The degrees of freedom of both planes, each with its partner; None if they are not found, or not the same."""
    n = shapes.shape[1]
    size = float(np.abs(shapes).max())
    flat = np.abs(shapes[1::2]).max(axis=0) < ALIKE * size
    x, others = np.flatnonzero(flat), np.flatnonzero(~flat)
    if len(x) != len(others):
        return None
    off = np.abs(shapes[0::2, x][:, :, None] - shapes[1::2, others][:, None, :]).max(axis=0)
    y = others[np.argmin(off, axis=1)]
    if len(set(y.tolist())) != len(y) or off.min(axis=1).max(initial=0.0) > ALIKE * size:
        return None
    turned = np.zeros((n, n))
    turned[y, x], turned[x, y] = 1.0, -1.0
    alike = all(
        np.abs(matrix @ turned - turned @ matrix).max() <= ALIKE * np.abs(matrix).max(initial=0.0)
        for matrix in matrices
    )
    return (x, y) if alike else None
