"""What the theory of the short bearing knows of a film before anything is solved: the error of its force, how a journal
falls, and where it rests."""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.case.film_geometry import FilmGeometry

# The mean error of a short section is SHORT (b/D)^2 (1 - eps)^-SHORT_POWER, to 20 % for b/D <= 0.4.
SHORT, SHORT_POWER = 0.45, 1.3
CLOSEST = 0.02  # smallest gap over the clearance that is told


def slenderness_of(film: FilmGeometry) -> float:
    """Width of a section over the diameter."""
    return film.width / film.diameter / (2 if film.supply.splits else 1)


def short_error(slender: float, eccentricity: float) -> float:
    """Relative error of the force of the short-bearing theory, for sections of b/D = slender."""
    return float(SHORT * slender**2 * (1.0 - eccentricity) ** -SHORT_POWER)


def mobility(e: Array, slender: float) -> Array:
    """(2,) velocity over the clearance of a journal at e (2,) in a film that cavitates, under a load W along -y, over
    psi^2 W / (b D eta), beside that with which the oil turns.

    The mobility of the short bearing (Booker, "Dynamically loaded journal bearings: mobility method of solution",
    J. Basic Eng. 87, 1965), and more by the force that a longer bearing lacks.
    """
    room = max(1.0 - float(np.hypot(*e)), CLOSEST)
    along, left = -e[1], e[0]  # of the load, and to the left of it
    ahead = max(1.0 - along, CLOSEST)
    size = (1.0 + short_error(slender, 1.0 - room)) / slender**2
    return size * np.array([-4.0 * left * ahead**1.5 / math.pi**2, -(ahead**2.5) / math.pi])


def resting_load(eccentricity: float, slender: float) -> float:
    """Load of a journal at rest over b D eta omega / psi^2, omega being the mean speed of both surfaces: Ocvirk's, less
    by the error of the short bearing."""
    e = eccentricity
    short = slender**2 * e * math.hypot(4.0 * e, math.pi * math.sqrt(1.0 - e * e)) / (1.0 - e * e) ** 2
    return short / (1.0 + short_error(slender, e))
