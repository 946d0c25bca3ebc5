"""Derivatives by differences, which others are held to."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Array = np.ndarray


def differences(value: Callable[[Array], Any], at: ArrayLike, steps: ArrayLike) -> Array:
    """(m, n) central differences of a value (m,) by each of the numbers `at` (n,), over steps (n,) or one for all."""
    place = np.asarray(at, dtype=float)
    sizes = np.broadcast_to(np.asarray(steps, dtype=float), place.shape)
    columns = [
        (np.asarray(value(place + step)) - np.asarray(value(place - step))) / (2.0 * size)
        for size, step in zip(sizes, np.diag(sizes), strict=True)
    ]
    return np.stack(columns, axis=-1)
