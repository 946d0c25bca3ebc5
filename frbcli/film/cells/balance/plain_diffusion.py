"""The artificial diffusion of the published form in array notation: what diffusion.py must equal; see there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.film import Motion, gap_on
from frbcli.film.cells.mesh.bores import bathed
from frbcli.film.cells.mesh.grid import VolumeGrid
from frbcli.film.gap import Section

GAMMA, PECLET = 0.5, 3.0  # of (4.42) and (4.43)
NO_DISTANCE = 1e-30  # between two cells of a groove: nothing flows there


class Spread(NamedTuple):
    """What goes from cells to the next ones, and its derivatives by the unknowns of both."""

    flow: Array
    by_own: Array
    by_next: Array


class Spreads(NamedTuple):
    """Spread around (m, k) through the face after each cell, along (m, k - 1), and out at the ends, near and far (m,)
    each, where the next cell is the oil there."""

    around: Spread
    along: Spread
    near: Spread
    far: Spread

    def net_outflow(self) -> Array:
        """(m, k) outflow of each cell."""
        net = self.around.flow - np.roll(self.around.flow, 1, axis=0)
        net[:, :-1] += self.along.flow
        net[:, 1:] -= self.along.flow
        net[:, 0] += self.near.flow
        net[:, -1] += self.far.flow
        return np.asarray(net)

    def created(self, fixed: NDArray[np.bool_]) -> float:
        """What comes into the film from where the oil fraction is given: the ends, and the `fixed` cells (m, k)."""
        return float(self.net_outflow()[fixed].sum() - self.near.flow.sum() - self.far.flow.sum())


def diffusing(section: Section, grid: VolumeGrid) -> tuple[float, float]:
    """L of the diffusion of a film in rad, at least the mean length of its cells, and by how much more it acts along
    than around, whose coordinate counts over the width of the section; 0 where there is none."""
    given = section.diffusion
    if given is None or given.length == 0.0:
        return 0.0, 0.0
    along = (section.bearing_width / section.width) ** 2 if given.along else 0.0
    return max(given.length, 2.0 * math.pi / grid.shape[0]), along


def end_reaches(height: Array, seals: tuple[float, float]) -> tuple[float, float]:
    """1 over the distances of the last unknowns, at `height` (k,), from the oil beyond the ends z = 0 and z = 1."""
    return 1.0 / (float(height[0]) + seals[0]), 1.0 / (1.0 - float(height[-1]) + seals[1])


def spreads(section: Section, grid: VolumeGrid, motion: Motion, state: CellState) -> Spreads:
    """The diffusion of a film with such a term."""
    length, along = diffusing(section, grid)
    reach = 0.5 * GAMMA * length * abs(motion.omega)
    face, centre = (gap_on(section, motion, phi, grid.height) for phi in (grid.phi[1:], grid.centre))
    edges = gap_on(section, motion, grid.centre, grid.z)
    dphi, dz = np.diff(grid.phi)[:, None], np.diff(grid.z)
    open_around, open_along = (
        np.where(distance > 0.0, size / np.maximum(distance, NO_DISTANCE), 0.0)
        for size, distance in ((dz, grid.around), (along * dphi, grid.along))
    )
    layers = np.stack([state.fraction, state.pressure, state.fraction_slope, state.pressure_slope])
    beyond = np.zeros((4, grid.shape[0]))
    beyond[0] = 1.0
    groove = beyond.copy()
    groove[1] = section.far_pressure / section.pressure_scale
    near, far = end_reaches(grid.height, section.seals)
    free = ~grid.fixed
    ends = (
        along * dphi[:, 0] * _full(section, grid, edge) * reach_out * free[:, last]
        for edge, reach_out, last in ((section.near, near, 0), (section.far, far, -1))
    )
    at_near, at_far = ends
    return Spreads(
        _spread(layers, np.roll(layers, -1, axis=1), face, open_around, reach),
        _spread(layers[:, :, :-1], layers[:, :, 1:], edges[:, 1:-1], open_along, reach),
        _spread(layers[:, :, 0], beyond, centre[:, 0], at_near, reach),
        _spread(layers[:, :, -1], groove if section.far == "groove" else beyond, centre[:, -1], at_far, reach),
    )


def _full(section: Section, grid: VolumeGrid, edge: str) -> Array:
    """(m,) share of an end beyond which there is oil."""
    if edge == "free-to-air":
        return bathed(section, grid.phi)
    return np.full(grid.shape[0], 0.0 if edge == "symmetry" else 1.0)


def _spread(own: Array, other: Array, gap: Array, opened: Array, reach: float) -> Spread:
    """own, other: (4, ...) oil fractions, pressures, their slopes; opened: conductances; reach: gamma L omega/2."""
    (t, p, by_t, by_p), (t_n, p_n, by_t_n, by_p_n) = own, other
    by_t, by_t_n = (np.where(each < 1.0, slope, 0.0) for each, slope in ((t, by_t), (t_n, by_t_n)))
    fall, drop = np.minimum(t, 1.0) - np.minimum(t_n, 1.0), p - p_n
    tangent = np.divide(by_t, by_p, out=np.zeros_like(by_t), where=by_p > 0.0)
    chord = np.divide(fall, drop, out=np.zeros_like(fall), where=drop != 0.0)
    steep = np.where(drop != 0.0, np.maximum(chord, 0.0), tangent)
    peclet = reach / (GAMMA * gap**2) * steep
    root = np.hypot(PECLET, peclet)
    share, turn, size = peclet / root, peclet * PECLET**2 / root**3, opened * reach * gap
    return Spread(
        size * share * fall,
        size * (share * by_t + turn * (by_t - steep * by_p)),
        -size * (share * by_t_n + turn * (by_t_n - steep * by_p_n)),
    )
