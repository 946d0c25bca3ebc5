"""Types of the arrays that all rooms pass on: real and complex numbers, truth values; and the size of an orbit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Truths = NDArray[np.bool_]


def larger_semi_axis(motion: Complex) -> Array:
    """(...) of the ellipse that x and y with the complex amplitudes (..., 2) draw: its forward and its backward part
    added up."""
    x, y = motion[..., 0], motion[..., 1]
    return np.asarray(0.5 * (np.abs(x + 1j * y) + np.abs(x - 1j * y)))
