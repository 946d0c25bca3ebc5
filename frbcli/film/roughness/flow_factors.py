"""How oil flows between rough surfaces of no direction, and how it resists their sliding, over the gap of their mean
planes by the combined roughness, x = h / sigma: the equations on arrays, which readers and tests hold kernels to.

Source: Patir, Cheng: An average flow model for determining effects of three-dimensional roughness on partial
hydrodynamic lubrication. J. Lubr. Technol. 100 (1978), 12-17; Application of average flow model to lubrication between
rough sliding surfaces. J. Lubr. Technol. 101 (1979), 220-230. Their fits hold for gaps of at least half the roughness.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array

# Isotropic surfaces. Flow of the pressure: 1 - DEPTH exp(-RATE x)
DEPTH, RATE = 0.90, 0.56
# Flow that a rough surface carries in addition to its mean plane: A x^B exp(-C x + D x^2) up to FAR, then falling with
# exp(-FADES x), from 1.126 exp(-5 / 4) on
A, B, C, D, FAR, FADES = 1.899, 0.98, 0.92, 0.05, 5.0, 0.25
# Stress in addition to the local gap's: A x^B exp(-C x + D x^2) up to LAST_STRESS, then none
STRESS_A, STRESS_B, STRESS_C, STRESS_D, LAST_STRESS = 11.1, 2.31, 2.38, 0.11, 7.0
SPREAD = 3.0  # largest height over the roughness, of heights with the density (35 / 32) (1 - s^2)^3, s over it
CUT = 1.0 / 300.0  # local gap over the largest height, below which surfaces touch and shear no oil
SERIES, TERMS = 3.0, 8  # gap over the largest height from which the moments of the heights serve, and their number


def shear_stress(x: Array) -> Array:
    """phi_f + Phi_fs: force that resists the sliding, over that between smooth surfaces.

    phi_f = h <1 / h_T> is of the local gaps h_T. A rough surface that slides presses oil through its narrow places: the
    stress on the smooth one is larger by Phi_fs, that on itself less, and what pushes on its flanks twice as large. So
    both feel the same force, whichever of them is rough.
    """
    z = np.asarray(x) / SPREAD
    near = np.minimum(z, SERIES)
    low = np.where(near > 1.0, near - 1.0, CUT)
    # (1 - (u - z)^2)^3 in powers of u = z + s
    a, b = 1.0 - near**2, 2.0 * near
    powers = (3.0 * a**2 * b, 3.0 * a * b**2 - 3.0 * a**2, b**3 - 6.0 * a * b, 3.0 * a - 3.0 * b**2, 3.0 * b, -1.0)
    high = 1.0 + near
    whole = a**3 * np.log(high / low)
    for k, power in enumerate(powers, start=1):
        whole = whole + power * (high**k - low**k) / k
    local = 35.0 / 32.0 * near * whole
    series, moment = np.ones_like(near), 1.0
    for k in range(1, TERMS + 1):
        moment *= (2.0 * k - 1.0) / (2.0 * k + 7.0)
        series = series + moment / np.maximum(z, SERIES) ** (2 * k)
    close = np.minimum(x, LAST_STRESS)
    moving = STRESS_A * close**STRESS_B * np.exp(-STRESS_C * close + STRESS_D * close**2)
    return np.asarray(np.where(z > SERIES, series, local) + np.where(x < LAST_STRESS, moving, 0.0))
