"""What the conserving models say of oil fraction and pressure, theta(p), as the figures 4.10 and 4.11 show it.

The films themselves solve for another unknown, in which these curves are not steep: see frbcli/film/cavitation/law.py.
"""

from __future__ import annotations

import numpy as np

from frbcli.film.cavitation.law import Array
from frbcli.film.cavitation.two_phase import TwoPhase


def elrod_fraction(ratio: Array, modulus: float) -> Array:
    """theta (3.35) of a full film, 0 below p_cav: at p_cav itself it takes every value up to 1.

    ratio: (n,) p / p_cav; modulus: beta / p_cav, infinite for an incompressible oil.
    """
    return np.asarray(np.where(ratio < 1.0, 0.0, np.exp((ratio - 1.0) / modulus)), dtype=np.float64)


def peeken_fraction(ratio: Array, bunsen: float) -> Array:
    """theta (3.38), (3.39) of oil whose dissolved air comes out below p_cav. ratio: (n,) p / p_cav, above 0."""
    below = np.minimum(ratio, 1.0)
    return np.asarray(below / (below + bunsen * (1.0 - below)), dtype=np.float64)


def two_phase_fraction(ratio: Array, steepness: float) -> Array:
    """theta (4.32) of the smoothed step with steepness x_1 (4.35). ratio: (n,) p / p_cav."""
    return TwoPhase(steepness).fraction(ratio)[0]
