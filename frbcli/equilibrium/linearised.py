"""The machine linearised at rest: its matrices on films of eight coefficients each, and its state matrix."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from frbcli.rotor.linear import LinearRotor

Array = NDArray[np.float64]


def linearised(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> tuple[Array, Array, Array]:
    """(n, n) mass, damping and stiffness at omega rad/s, the damping with the gyroscopic term, on films of stiffness
    and damping (films, c, c), SI units, by the c coordinates that the films see."""
    here = rotor.at(omega)
    bearings = here.multiplicity[:, None, None] * np.swapaxes(here.journals, 1, 2)
    k = here.stiffness + (bearings @ stiffness @ here.journals).sum(axis=0)
    d = here.damping + omega * here.gyroscopic + (bearings @ damping @ here.journals).sum(axis=0)
    return here.mass, d, k


def state_matrix(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Array:
    """(2 n, 2 n) of the states (q, q'), as `linearised`."""
    return first_order(*linearised(rotor, omega, stiffness, damping))


def first_order(mass: Array, damping: Array, stiffness: Array) -> Array:
    """(2 n, 2 n) A of x' = A x, x = (q, q'), for M q'' + D q' + K q = 0 with matrices (n, n)."""
    n = len(mass)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, np.hstack([stiffness, damping]))]])
