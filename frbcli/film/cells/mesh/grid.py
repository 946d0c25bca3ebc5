"""Cells of a section, with its grooves, pockets and bores cut out.

Cells along the axis of runs under a journal that tilts, and the weights of their pressures in forces and moments.

The pressure is no parabola there, and is steepest at the ends where the gap is narrowest: cells are finer at the ends.
Their unknowns stand so that every face lies midway between two of them. The fall of the pressure from one to the next
is then that at the face for parabolas as well as for straight lines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cells.balance.boundaries import end_slopes
from frbcli.film.cells.mesh.bores import Cells, Opening, around_bores, groove_opening, hole_opening
from frbcli.film.gap import LEAST, AxialGroove, Section, graded_ring, groove_pressure

FINER_ENDS = 0.55  # share of Chebyshev's spacing: of 0.2 to 1 the most exact on 8 to 12 cells in the mean of 20 states
# Integrals of p, where -p'' = 1, and of (2 z - 1) p, where -p'' = 2 z - 1; p = 0 at the ends.
FORCE, MOMENT = 1.0 / 12.0, 1.0 / 180.0


def tilted_cells(along: int) -> tuple[Array, Array]:
    """(along + 1,) boundaries of cells over the width, and (along,) places of their unknowns.

    The places are the middles of cells between equal ones and Chebyshev's.
    """
    equal = np.linspace(0.0, 1.0, along + 1)
    spread = (1.0 - FINER_ENDS) * equal + FINER_ENDS * 0.5 * (1.0 - np.cos(np.pi * equal))
    height = 0.5 * (spread[1:] + spread[:-1])
    return np.array([0.0, *(0.5 * (height[1:] + height[:-1])), 1.0]), height


def tilted_weights(z: Array, height: Array) -> Array:
    """(k,) weights of the integral over [0, 1] of values at the places `height` (k,) of cells with the boundaries z.

    They start from parabolas through three places each, and are changed as little as it takes for the closed forms of a
    short bearing to hold on these cells: its force in translation, its moment in tilt, which is L^2 / 60 of it, and the
    integral of a constant. On the fewest cells the last ones of these are left out. """
    k, weights = len(height), _of_parabolas(z, height)
    if k < 3:
        return weights
    tilt = 2.0 * height - 1.0
    flat, tilting = np.linalg.solve(_conductances(height), (np.diff(z) * np.array([np.ones(k), tilt])).T).T
    rows, values = np.array([flat, tilt * tilting, np.ones(k)]), np.array([FORCE, MOMENT, 1.0])
    kept = slice((k + 1) // 2)  # as many as there are weights, which are symmetric
    size = np.sqrt(weights)
    change = np.linalg.lstsq(rows[kept] * size, values[kept] - rows[kept] @ weights, rcond=None)[0]
    return np.asarray(weights + size * change)


def _of_parabolas(z: Array, height: Array) -> Array:
    """(k,) weights of the parabolas through the place of each cell and its neighbours."""
    k = len(height)
    if k < 3:
        return np.diff(z)
    weights = np.zeros(k)
    for j in range(k):
        first = min(max(j - 1, 0), k - 3)
        powers = np.vander(height[first : first + 3] - height[j], 3, increasing=True)
        low, high = z[j] - height[j], z[j + 1] - height[j]
        weights[first : first + 3] += np.linalg.solve(powers.T, [(high**n - low**n) / n for n in (1, 2, 3)])
    return weights


def _conductances(height: Array) -> Array:
    """(k, k) what flows out of the cells of a column along a gap of 1 by their pressures."""
    k, steps = len(height), 1.0 / np.diff(height)
    matrix = np.zeros((k, k))
    for j, step in enumerate(steps):
        matrix[j : j + 2, j : j + 2] += step * np.array([[1.0, -1.0], [-1.0, 1.0]])
    for side, slope in zip((1, -1), end_slopes(height), strict=True):
        end, beyond = (0, 1) if side > 0 else (-1, -2)
        matrix[end, end] += slope.rise * (1.0 + slope.bend)
        matrix[end, beyond] -= slope.rise * slope.bend
    return matrix


FEW = 64  # films whose weights are kept: a film is solved often
NEAREST = 1e-3  # of a cell: so near its middle the edge of a groove or hole may come
CHEBYSHEV = 0.35  # share of Chebyshev's spacing along the axis under a journal that tilts
CONTRACTION = 0.3  # exponent on (1 - eps) / (1 + eps): 0.5 is Sommerfeld's angle, which leaves the wide gap coarse


@dataclass(frozen=True, eq=False)
class VolumeGrid:
    """Cells of one section. phi: (m + 1,) boundaries of a turn; z: (k + 1,) boundaries over [0, 1].

    height: (k,) axial positions of the unknowns in [0, 1], the middles of the cells but in a run under a journal that
    tilts, see tilted_cells; fixed: (m, k) cells where the pressure is given; fixed_pressure: (m, k) scaled gauge
    pressure there; around: (m, k) distance in rad over which oil flows through the face after each cell, along: (m, k -
    1) the same over the width, from middle to middle or to the edge of a groove or hole, 0 within one; at: (m, k) angle
    at which the flow around takes its gap, of the face or of the middle of the way to the edge of a bore; area: (m, k)
    by which a cell counts in the balance, over R b, for a given one its whole area; load: (m, k) share of a cell's area
    by which its pressure counts in the force; cover: (m, k) share of it that grooves and holes take. """

    phi: Array
    z: Array
    height: Array
    fixed: NDArray[np.bool_]
    fixed_pressure: Array
    around: Array
    along: Array
    at: Array
    area: Array
    load: Array
    cover: Array

    @property
    def shape(self) -> tuple[int, int]:
        """Cells around and along."""
        return len(self.phi) - 1, len(self.z) - 1

    @property
    def centre(self) -> Array:
        """(m,) angles of the middles of the cells."""
        return 0.5 * (self.phi[1:] + self.phi[:-1])

    @property
    def size(self) -> Array:
        """(m, k) areas of the cells over R b."""
        return np.diff(self.phi)[:, None] * np.diff(self.z)[None, :]

    @property
    def share(self) -> Array:
        """(m, k) of each cell that is film, out of which the surfaces carry oil; 1 of a given one."""
        return np.where(self.fixed | (self.area == self.size), 1.0, 1.0 - self.cover)

    @property
    def excess(self) -> Array:
        """(m, k) excess of the area of a cell over the area of its film, over its length: the surfaces carry the oil
        out of this, too, as far as the gap changes."""
        return np.asarray((self.area - self.share * self.size) / np.diff(self.phi)[:, None])

    @property
    def has_bores(self) -> bool:
        """Whether round holes open to the film, around which flows take the gaps of their cells, too."""
        return bool(np.any(self.load != 1.0))


def fitted_grid(
    section: Section, d: tuple[float, float], around: int, along: int, tilted: bool = False
) -> VolumeGrid:
    """About around x along cells, finer where d narrows the gap; grooves and pockets end on faces.

    Equal ones along: parabolas over the width (axial_weights) are exact on few of them, without finer ones at the ends.
    Under a journal that tilts the pressure is no parabola: there they are finer at the ends, see tilted_ends.
    """
    eccentricity = math.hypot(*d)
    narrowest = math.atan2(-d[0], d[1])  # H = 1 + d_x sin(phi) - d_y cos(phi) is smallest
    contraction = ((1.0 - eccentricity) / (1.0 + eccentricity)) ** CONTRACTION
    spans = [(groove.position, 0.5 * groove.opening) for groove in section.grooves]
    spans += [(hole.position, hole.half_angle) for hole in section.holes if not hole.round]
    edges = [middle + side * half for middle, half in spans for side in (-1.0, 1.0)]
    if section.profile is not None:
        edges += section.profile.edges
    ring = graded_ring(around, narrowest, contraction, np.array(edges))
    return volume_grid(section, ring, tilted_ends(along) if tilted else np.linspace(0.0, 1.0, along + 1))


def tilted_ends(along: int) -> Array:
    """(along + 1,) boundaries of cells over the width, finer at the ends, between equal ones and Chebyshev's.

    The error of forces and moments then falls with the square of the cells' size from the coarsest mesh on, so that it
    can be estimated from half of the cells; on equal ones errors of different orders cancel each other there, and so
    they do on the few cells of a run. """
    equal = np.linspace(0.0, 1.0, along + 1)
    return np.asarray((1.0 - CHEBYSHEV) * equal + CHEBYSHEV * 0.5 * (1.0 - np.cos(np.pi * equal)))


def volume_grid(section: Section, phi: Array, z: Array, height: Array | None = None) -> VolumeGrid:
    """Cells with the section's grooves and holes cut out of those whose middles they hold, their edges where they are.

    height: (k,) see VolumeGrid, by default the middles of the cells. The flow between the middle of a cell and a groove
    or hole runs over the distance to its edge, wherever that lies between the faces: so it changes smoothly as the edge
    moves across the cells. Around a bore flows and areas follow from the local solutions (bores.py). """
    shape = len(phi) - 1, len(z) - 1
    fixed, fixed_pressure, cover = np.zeros(shape, dtype=bool), np.zeros(shape), np.zeros(shape)
    height = middles(z) if height is None else height
    around, along = _distances(phi, height)
    holes = [hole_opening(section, hole, phi, z, height) for hole in section.holes]
    openings = [(groove_opening(g, phi, z), _along_groove(section, g, height)) for g in section.grooves]
    openings += [(o, np.full(shape[1], h.pressure)) for o, h in zip(holes, section.holes, strict=True)]
    for opening, pressure in openings:
        around, along = _to_edge(opening, around, along, phi, z)
        fixed |= opening.inside
        fixed_pressure = np.where(opening.inside, pressure / section.pressure_scale, fixed_pressure)
        cover += opening.cover
    around[fixed & np.roll(fixed, -1, axis=0)] = 0.0
    along[fixed[:, :-1] & fixed[:, 1:]] = 0.0
    cover, faces = np.minimum(cover, 1.0), np.repeat(phi[1:, None], shape[1], axis=1)
    size = np.diff(phi)[:, None] * np.diff(z)[None, :]
    plain = Cells(around, along, faces, size, np.ones(shape))
    near = around_bores(section, phi, z, height, [opening.inside for opening in holes], cover, plain)
    return VolumeGrid(phi, z, height, fixed, fixed_pressure, cover=cover, **near._asdict())


@lru_cache(maxsize=FEW)
def force_weights(section: Section, grid: VolumeGrid) -> Array:
    """(m, k) of the pressures of a section's cells in the integral over its width."""
    middle = np.array_equal(grid.height, middles(grid.z))
    weights = axial_weights(grid.z, section.far == "symmetry") if middle else tilted_weights(grid.z, grid.height)
    return weights + (grid.load - 1.0) * np.diff(grid.z)


def middles(faces: Array) -> Array:
    """(n,) middles of cells with the boundaries (n + 1,)."""
    return 0.5 * (faces[1:] + faces[:-1])


def _along_groove(section: Section, groove: AxialGroove, height: Array) -> Array:
    """(k,) gauge pressure in Pa at axial positions over the section's width."""
    distance = height * section.width
    if section.far != "symmetry":
        distance = np.minimum(distance, section.bearing_width - distance)
    return groove_pressure(section, groove, distance)


def _distances(phi: Array, height: Array) -> tuple[Array, Array]:
    """Between the unknowns of cells: (m, k) through the face after each, (m, k - 1) along."""
    dphi = np.diff(phi)
    around = np.repeat(0.5 * (dphi + np.roll(dphi, -1))[:, None], len(height), axis=1)
    return around, np.repeat(np.diff(height)[None, :], len(dphi), axis=0)


def _to_edge(opening: Opening, around: Array, along: Array, phi: Array, z: Array) -> tuple[Array, Array]:
    """The distances with those between a cell within the opening and one outside replaced by that to its edge."""
    inside = opening.inside
    behind = np.roll(inside, -1, axis=0)
    beyond = np.maximum(opening.around, NEAREST * np.diff(phi)[:, None])
    reach = np.where(inside, np.roll(beyond, -1, axis=0), beyond)
    around = np.where(inside ^ behind, reach, around)
    beyond = np.maximum(opening.along, NEAREST * np.diff(z))
    reach = np.where(inside[:, :-1], beyond[:, 1:], beyond[:, :-1])
    return around, np.where(inside[:, :-1] ^ inside[:, 1:], reach, along)


def run_grid(section: Section, cells: tuple[int, int]) -> VolumeGrid:
    """Equal cells, for the narrowest gap moves: (around, along), but for those that a groove's edges cut. Their number
    around is the given one, or what the pieces between edges need (least_around) if that is more."""
    in_pascal = _equal_cells(replace(section, viscosity=1.0 / 12.0, clearance=section.radius), cells)
    return replace(in_pascal, fixed_pressure=in_pascal.fixed_pressure / section.pressure_scale)


@lru_cache(maxsize=FEW)
def _equal_cells(section: Section, cells: tuple[int, int]) -> VolumeGrid:
    """run_grid of a section whose scale of the pressure is 1. Warm films differ in viscosity and clearance alone, on
    which cells do not depend: their solutions around bores (bores.py) take longer than a film does."""
    around, along = cells
    edges = [groove.position + side * 0.5 * groove.opening for groove in section.grooves for side in (-1.0, 1.0)]
    ring = graded_ring(around, 0.0, 1.0, np.array(edges), exact=True)
    return volume_grid(section, ring, np.linspace(0.0, 1.0, along + 1))


def least_around(section: Section) -> int:
    """Cells around that run_grid makes of a section at least: LEAST in each groove and each land."""
    return 2 * LEAST * len(section.grooves)


def axial_weights(z: Array, mirrored: bool) -> Array:
    """(k,) weights of the integral over [0, 1] of values in the middles of cells with the boundaries z (k + 1,).

    Each cell holds the parabola through its own value and its neighbours'; mirrored: a plane of symmetry at z = 1.
    """
    size = np.diff(z)
    k = len(size)
    if k < 3:
        return size
    middle = 0.5 * (z[1:] + z[:-1])
    weights = size.copy()
    for j in range(k):
        centre = min(max(j, 1), k - 1 if mirrored else k - 2)
        if centre == k - 1:  # the cell beyond the plane of symmetry is the last one again
            before, behind = middle[-1] - middle[-2], 2.0 * (1.0 - middle[-1])
            places = (k - 2, k - 1, k - 1)
        else:
            before, behind = middle[centre] - middle[centre - 1], middle[centre + 1] - middle[centre]
            places = (centre - 1, centre, centre + 1)
        curvature = 2.0 / (before + behind) * np.array([1.0 / before, -1.0 / before - 1.0 / behind, 1.0 / behind])
        for place, value in zip(places, curvature, strict=True):
            weights[place] += size[j] ** 3 / 24.0 * value
    return weights
