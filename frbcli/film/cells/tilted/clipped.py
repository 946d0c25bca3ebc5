"""By how much the pressures that forces are taken from change with the unknowns of the cells, also at the edges of a
cavity, where they are clipped between the middles of cells (plain_clipped.py)."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.plain_clipped import CURVED
from frbcli.film.cells.film import VolumeFilm


def mean_change(film: VolumeFilm, state: CellState, change: Array) -> Array:
    """(m, k) by how much the mean pressures of a film change with a small change (m, k) of its unknown."""
    pressure = state.pressure_slope * change
    if film.clips_between:
        return clipped_changes(state.pressure - film.scales.cavitation, pressure)
    return np.where(state.pressure > film.scales.cavitation, pressure, 0.0) if film.law.clips else pressure


def clipped_changes(above: Array, change: Array) -> Array:
    """(m, k) by how much clipped_means changes with a small change (m, k) of the pressures."""
    before, after, beyond = (np.roll(above, by, axis=0) for by in (1, -1, -2))
    d_before, d_after, d_beyond = (np.roll(change, by, axis=0) for by in (1, -1, -2))
    here_full, after_full = above > 0.0, after > 0.0
    edge = here_full ^ after_full
    size = np.where(edge, np.abs(above) + np.abs(after), 1.0)
    x = np.where(here_full & after_full, 1.0, np.where(edge, np.where(here_full, above, after) / size, 0.0))
    falls = np.where(here_full, (1.0 - x) * change + x * d_after, (1.0 - x) * d_after + x * change)
    dx = np.where(edge, falls / size, 0.0)
    y, dy = x**2 * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) * dx
    s, ds = before - above - after + beyond, d_before - change - d_after + d_beyond
    share, by_share = np.where(here_full, 1.0 - 0.5 * y, 0.5 * y), np.where(here_full, -0.5 * dy, 0.5 * dy)
    curved, by_curved = CURVED * y * s, CURVED * (dy * s + y * ds)
    to_here = 0.5 * np.where(here_full, dx * above + x * change, 0.0) - by_curved * share - curved * by_share
    to_after = 0.5 * np.where(after_full, dx * after + x * d_after, 0.0) - by_curved * (1.0 - share) + curved * by_share
    return np.asarray(to_here + np.roll(to_after, 1, axis=0))
