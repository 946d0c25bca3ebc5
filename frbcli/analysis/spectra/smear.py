"""Height of a spectral line whose frequency changes within a Hann window."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import fresnel

Values = NDArray[np.float64]

LEAST_SWEEP = 1e-4  # below it the height is 1 to ten digits, and the closed form loses its own


def chirp_height(sweep: Values) -> Values:
    """Height of the line of a motion of amplitude 1 whose frequency rises or falls evenly, at the middle of a window.

    sweep: any shape, r T^2 for a frequency that changes by r Hz/s and a window of T s. With u = t/T from -1/2 to 1/2
    the height is | integral of (1 + cos 2 pi u) exp(i pi r T^2 u^2) du |: Fresnel integrals, for the cosine is two
    exponentials that complete the square.
    """
    c = np.maximum(np.abs(np.asarray(sweep, dtype=np.float64)), LEAST_SWEEP)
    shifted = np.exp(-1j * np.pi / c) * _chirp(c, 1.0 / c)
    return np.asarray(np.where(np.abs(sweep) < LEAST_SWEEP, 1.0, np.abs(_chirp(c, np.zeros_like(c)) + shifted)))


def _chirp(c: Values, shift: Values) -> NDArray[np.complex128]:
    """The integral of exp(i pi c (u + shift)^2) over u from -1/2 to 1/2."""
    scale = np.sqrt(2.0 * c)
    (upper_sine, upper_cosine), (lower_sine, lower_cosine) = (fresnel(scale * (shift + u)) for u in (0.5, -0.5))
    return np.asarray(((upper_cosine - lower_cosine) + 1j * (upper_sine - lower_sine)) / scale)
