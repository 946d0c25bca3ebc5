"""The one linear system that every rotor builds.

M q'' + (D + Omega G) q' + K q = f_static + unbalance(alpha) + sum over films of P^T F
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearRotor:
    """A rotor with n degrees of freedom, SI units.

    mass, damping, gyroscopic, stiffness: (n, n); gyroscopic is multiplied by the rotor speed in rad/s.
    static_load: (n,) N. unbalance_cos, unbalance_sin: (n,) kg m: the unbalance pulls (2.3) with
    unbalance_cos (alpha'' cos alpha - alpha'^2 sin alpha) + unbalance_sin (alpha'' sin alpha + alpha'^2 cos alpha).
    journals: (films, 2, n): P, the x- and y-displacement of each film's journal relative to its shell.
    multiplicity: (films,) how many equal bearings one film stands for (2 in a symmetric rotor).
    points: names and (2, n) maps of the points that a run records and whose error is controlled.
    """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    static_load: Array
    unbalance_cos: Array
    unbalance_sin: Array
    journals: Array
    multiplicity: Array
    points: tuple[tuple[str, Array], ...]

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)


def planar(degrees: int, x: int, y: int) -> Array:
    """(2, degrees) map that picks the degrees of freedom x and y."""
    selection = np.zeros((2, degrees))
    selection[0, x] = selection[1, y] = 1.0
    return selection
