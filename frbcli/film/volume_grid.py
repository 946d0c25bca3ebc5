"""Cells of a section, with its grooves, pockets and bores cut out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.film.gap import Hole, Section, graded_ring, groove_pressure
from frbcli.film.grid import Array

AXIAL_GRADING = 0.5  # share of Chebyshev's spacing in the axial one
NO_HOLE = 0.02
CONTRACTION = 0.3  # exponent on (1 - eps) / (1 + eps): 0.5 is Sommerfeld's angle, which leaves the wide gap coarse


@dataclass(frozen=True)
class VolumeGrid:
    """Cells of one section. phi: (m + 1,) boundaries of a turn; z: (k + 1,) boundaries over [0, 1].

    fixed: (m, k) cells where the pressure is given; fixed_pressure: (m, k) scaled gauge pressure there.
    """

    phi: Array
    z: Array
    fixed: NDArray[np.bool_]
    fixed_pressure: Array

    @property
    def shape(self) -> tuple[int, int]:
        """Cells around and along."""
        return len(self.phi) - 1, len(self.z) - 1

    @property
    def centre(self) -> Array:
        """(m,) angles of the middles of the cells."""
        return 0.5 * (self.phi[1:] + self.phi[:-1])

    @property
    def height(self) -> Array:
        """(k,) axial positions of the middles of the cells in [0, 1]."""
        return 0.5 * (self.z[1:] + self.z[:-1])

    @property
    def area(self) -> Array:
        """(m, k) areas of the cells over R b."""
        return np.diff(self.phi)[:, None] * np.diff(self.z)[None, :]


def fitted_grid(section: Section, d: tuple[float, float], around: int, along: int) -> VolumeGrid:
    """About around x along cells, finer at the ends and where d narrows the gap; grooves and pockets end on faces."""
    eccentricity = math.hypot(*d)
    narrowest = math.atan2(-d[0], d[1])  # H = 1 + d_x sin(phi) - d_y cos(phi) is smallest
    contraction = ((1.0 - eccentricity) / (1.0 + eccentricity)) ** CONTRACTION
    spans = [(groove.position, 0.5 * groove.opening) for groove in section.grooves]
    spans += [(hole.position, hole.half_angle) for hole in section.holes if not hole.round]
    edges = [middle + side * half for middle, half in spans for side in (-1.0, 1.0)]
    ring = graded_ring(around, narrowest, contraction, np.array(edges))
    return volume_grid(section, ring, axial_faces(section, along))


def axial_faces(section: Section, along: int) -> Array:
    """(along + 1,) boundaries over [0, 1], finer where the section ends."""
    even = np.linspace(0.0, 1.0, along + 1)
    turn = 0.5 * np.pi if section.far == "symmetry" else np.pi  # half of Chebyshev's points, or all
    graded = (1.0 - np.cos(turn * even)) / (1.0 - math.cos(turn))
    return AXIAL_GRADING * graded + (1.0 - AXIAL_GRADING) * even


def volume_grid(section: Section, phi: Array, z: Array) -> VolumeGrid:
    """Cells with the section's grooves (by the centres of the cells) and holes (by their area) cut out."""
    grid = VolumeGrid(phi, z, np.zeros((len(phi) - 1, len(z) - 1), dtype=bool), np.zeros((len(phi) - 1, len(z) - 1)))
    for groove in section.grooves:
        inside = np.abs(wrapped(grid.centre - groove.position)) < 0.5 * groove.opening
        grid.fixed[inside] = True
        distance = grid.height * section.width
        if section.far != "symmetry":
            distance = np.minimum(distance, section.bearing_width - distance)
        grid.fixed_pressure[inside] = groove_pressure(groove, distance, section.bearing_width) / section.pressure_scale
    for hole in section.holes:
        inside = _hole_cells(section, hole, grid)
        grid.fixed[inside] = True
        grid.fixed_pressure[inside] = hole.pressure / section.pressure_scale
    return grid


def _hole_cells(section: Section, hole: Hole, grid: VolumeGrid) -> NDArray[np.bool_]:
    """(m, k) cells of a hole: those nearest to its middle, as many as come closest to its area.

    A hole smaller than NO_HOLE of the cells at its middle takes none; a larger one always takes those, so that a coarse
    mesh does not close a supply. Cells at the same distance go together, so that symmetry is kept.
    """
    across = np.abs(wrapped(grid.centre - hole.position))[:, None] / hole.half_angle
    along = np.abs(grid.height * section.width - hole.axial)[None, :] / hole.half_width
    distance = np.round(np.hypot(across, along) if hole.round else np.maximum(across, along), 9)
    area = hole_area(section, hole) / (section.radius * section.width)
    order = np.argsort(distance, axis=None)
    sorted_distance = distance.ravel()[order]
    covered = np.cumsum(grid.area.ravel()[order])
    last = np.flatnonzero(np.append(np.diff(sorted_distance) > 0.0, True))  # the last cell of each distance
    best = last[np.argmin(np.abs(covered[last] - area))]
    reach = sorted_distance[best] if area > NO_HOLE * covered[last[0]] else -1.0
    inside: NDArray[np.bool_] = distance <= reach
    return inside


def hole_area(section: Section, hole: Hole) -> float:
    """Area in m^2 of the part of a hole that lies within the section (a round one on the edge z = 1 of a symmetric
    section counts by half)."""
    square = 4.0 * section.radius * hole.half_angle
    low = max(-1.0, -hole.axial / hole.half_width)
    high = min(1.0, (section.width - hole.axial) / hole.half_width)
    share = 0.25 * (_half_disk(high) - _half_disk(low)) if hole.round else 0.5 * (high - low)
    return square * hole.half_width * share


def _half_disk(t: float) -> float:
    """Area of the unit disk left of the abscissa t in [-1, 1], from its middle."""
    return t * math.sqrt(max(1.0 - t * t, 0.0)) + math.asin(t)


def wrapped(angle: Array) -> Array:
    """Angles brought to [-pi, pi)."""
    return np.mod(angle + math.pi, 2.0 * math.pi) - math.pi
