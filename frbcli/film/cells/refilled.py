"""The oil of a film on cells when its clearance changes: it stays where it is.

A wider gap has a smaller oil fraction, and from a narrower gap the surplus leaves through the ends.
"""

from __future__ import annotations

import numpy as np

from frbcli.film.cells.film import VolumeFilm
from frbcli.film.grid import Array

HALVINGS = 60  # of the interval in which the unknown of a cell with a given oil fraction lies


def refilled(
    old: VolumeFilm, new: VolumeFilm, d: tuple[float, float], oil: Array, w: Array
) -> tuple[Array, Array]:
    """(m, k) unknowns of the film `new`, and the oil that it is given in its own units, from the oil and unknowns of
    the film `old`, which has another clearance. d: of the journal, over the new clearance."""
    share, free = old.section.clearance / new.section.clearance, ~new.grid.fixed
    pressure = old.scales.reference * old.section.pressure_scale / (new.scales.reference * new.section.pressure_scale)
    given = share * oil
    full = np.maximum(new.full(), pressure * w)  # cells with enough oil keep their pressure
    gap = new.gap(d, new.grid.centre)[:, None]
    return np.where(free, _with_fraction(new, given / gap, full), w), given


def _with_fraction(film: VolumeFilm, fraction: Array, full: Array) -> Array:
    """(m, k) unknowns of cells with given oil fractions, at most `full`: they grow with each other."""
    scales = film.scales
    least = -2.0 - (scales.cavitation + scales.ambient) / scales.reference  # neither oil nor pressure
    low, high = np.full_like(full, least), full.copy()
    enough = film.cells(full).fraction <= fraction
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = film.cells(middle).fraction > fraction
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.where(enough, full, 0.5 * (low + high))
