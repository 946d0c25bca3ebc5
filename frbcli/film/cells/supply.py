"""A supply pressure that rises from the ambient one when a film is started (4.11)."""

from __future__ import annotations

import math
from dataclasses import replace

from frbcli.film.cells.film import VolumeFilm


def supply_share(time: float, rise_time: float) -> float:
    """f (4.11), the share of the gauge supply pressure after a time in s, with t_1 in s; all of it where t_1 is 0."""
    return -math.expm1(-time / rise_time) if rise_time > 0.0 else 1.0


def supplied(film: VolumeFilm, share: float) -> VolumeFilm:
    """A film whose grooves and holes hold a share of their gauge pressures, which the hydrostatic force follows."""
    section, grid = film.section, film.grid
    section = replace(
        section,
        far_pressure=share * section.far_pressure,
        grooves=tuple(replace(groove, pressure=share * groove.pressure) for groove in section.grooves),
        holes=tuple(replace(hole, pressure=share * hole.pressure) for hole in section.holes),
    )
    grid = replace(grid, fixed_pressure=share * grid.fixed_pressure)
    return VolumeFilm(section, grid, film.law, film.scales.reference)
