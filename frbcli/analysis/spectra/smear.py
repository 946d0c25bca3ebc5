"""Height of a spectral line whose frequency changes within a Hann window."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array

SWEEP_OF_A_PANEL, POINTS = 8.0, 24  # a panel has at most 2 pi of phase, which so many Gauss points integrate exactly


def chirp_height(sweep: Array) -> Array:
    """Height of the line of a motion of amplitude 1 whose frequency rises or falls evenly, at the middle of a window.

    sweep: any shape, r T^2 for a frequency that changes by r Hz/s and a window of T s. With u = t/T from -1/2 to 1/2
    the height is | integral of (1 + cos 2 pi u) exp(i pi r T^2 u^2) du |, twice that of the half from 0. It has a
    closed form of Fresnel integrals, which take a tenth of the time of a picture to import.
    """
    c = np.asarray(sweep, dtype=np.float64)
    panels = 1 + int(np.max(np.abs(c), initial=0.0) / SWEEP_OF_A_PANEL)
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    total = np.zeros(c.shape, dtype=np.complex128)
    for panel in range(panels):
        for point, weight in zip(points, weights, strict=True):
            u = 0.5 * (panel + 0.5 * (1.0 + point)) / panels
            total += 0.5 * weight / panels * (1.0 + np.cos(2.0 * np.pi * u)) * np.exp(1j * np.pi * c * u**2)
    return np.asarray(np.abs(total))
