"""The rotor behind its films in parts that do not see each other.

A shaft that is the same in all directions turns into two rotors of half its size, for p = (x + i y) / sqrt(2) and
m = (x - i y) / sqrt(2) of its motions x in one plane and y in the other: the motions that circle one way and the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.rotor.linear import LinearRotor

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SMALLEST = 16  # degrees of freedom from which on two parts are solved faster than one
ALIKE = 1e-9  # by which planes that count as the same may differ, relative


@dataclass(frozen=True)
class Part:
    """mass, flow, gyroscopic, stiffness: (n, n) of the part, flow with the dashpots beside the films and stiffness with
    the springs there; shapes (2 F, n) and loads (n, l): see transfer of machine.py; symmetric: whether all matrices
    are."""

    mass: Complex
    flow: Complex
    gyroscopic: Complex
    stiffness: Complex
    shapes: Complex
    loads: Complex
    symmetric: bool

    def answers(self, z: Complex) -> tuple[Complex, Complex]:
        """z^-1 loads (H + 1, n, l) and shapes z^-1 (H + 1, 2 F, n) of matrices z (H + 1, n, n) made of those here."""
        wanted, count = self.loads, len(z)
        if self.symmetric:
            both = np.hstack([wanted, self.shapes.T])
            found = np.linalg.solve(z, np.broadcast_to(both, (count, *both.shape)))
            cut = wanted.shape[1]
            return np.asarray(found[:, :, :cut]), np.asarray(np.swapaxes(found[:, :, cut:], 1, 2))
        across = np.broadcast_to(self.shapes.T, (count, *self.shapes.T.shape))
        left = np.linalg.solve(np.swapaxes(z, 1, 2), across)
        answer = np.linalg.solve(z, np.broadcast_to(wanted, (count, *wanted.shape)))
        return np.asarray(answer), np.asarray(np.swapaxes(left, 1, 2))


def parts_of(rotor: LinearRotor, springs: Array, dashpots: Array, shapes: Array, loads: Complex) -> tuple[Part, ...]:
    """The whole rotor, or both of its parts. springs, dashpots: (n, n) beside the films."""
    matrices = (rotor.mass, rotor.damping + dashpots, rotor.gyroscopic, rotor.stiffness + springs)
    planes = _planes(shapes, matrices) if rotor.size >= SMALLEST else None
    if planes is None:
        return (_part([matrix.astype(complex) for matrix in matrices], shapes, loads),)
    x, y = planes
    found = []
    for turn in (1j, -1j):
        own = [matrix[np.ix_(x, x)] - turn * matrix[np.ix_(x, y)] for matrix in matrices]
        seen, given = shapes[:, x] - turn * shapes[:, y], loads[x] + turn * loads[y]
        found.append(_part(own, seen / np.sqrt(2.0), given / np.sqrt(2.0)))
    return tuple(found)


def _part(matrices: list[Complex], shapes: Array | Complex, loads: Complex) -> Part:
    mass, flow, gyroscopic, stiffness = matrices
    symmetric = all(np.abs(each - each.T).max() <= ALIKE * np.abs(each).max(initial=0.0) for each in matrices)
    return Part(mass, flow, gyroscopic, stiffness, shapes.astype(complex), loads.astype(complex), symmetric)


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
