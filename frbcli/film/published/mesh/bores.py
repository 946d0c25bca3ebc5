"""Bores on a mesh of rectangles: a box of the same area, whose nodes then move onto the ellipse."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cells.mesh.openings import hole_area, wrapped
from frbcli.film.gap import Hole, Section
from frbcli.film.grid import Array

ROOM = 1.3  # to the next given pressure, in half extents of the box from its middle: with less it stays a box


class Box(NamedTuple):
    """middle, half_angle: rad; low, high: edges in shares of the width; round: whether it may become an ellipse."""

    middle: float
    half_angle: float
    low: float
    high: float
    round: bool


def hole_box(section: Section, hole: Hole) -> Box:
    """The rectangle with the area of a hole within the section, and with its proportions."""
    shrink = 0.5 * math.sqrt(math.pi) if hole.round else 1.0
    low = max((hole.axial - shrink * hole.half_width) / section.width, 0.0)
    high = min((hole.axial + shrink * hole.half_width) / section.width, 1.0)
    half_angle = 0.5 * hole_area(section, hole) / (section.radius * section.width * (high - low))
    whole = hole.axial + hole.half_width <= section.width * (1.0 + 1e-9)
    halved = abs(hole.axial - section.width) <= 1e-9 * section.width
    return Box(hole.position, half_angle, low, high, hole.round and (whole or halved))


def rounded(
    section: Section, hole: Hole, box: Box, phi: Array, z: Array, fixed: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """The nodes (2 a + 1, 2 k + 1) of the mesh with those of the box on the ellipse, the others giving way.

    The area of the isoparametric elements within is exact.
    """
    half = 0.5 * math.sqrt(math.pi) * hole.half_width / section.width
    x, y = wrapped(phi - box.middle) / box.half_angle, (z - hole.axial / section.width) / half
    reach = np.maximum(np.abs(x), np.abs(y))
    outer = fixed & (reach > 1.0 + 1e-6)
    room = float(np.min(reach[outer])) if outer.any() else 2.0
    if room < ROOM:
        return phi, z
    ring = np.maximum(reach, 1.0)
    u, v = x / ring, y / ring  # on the square; the square goes onto the disk
    on_x, on_y = u * np.sqrt(1.0 - 0.5 * v**2), v * np.sqrt(1.0 - 0.5 * u**2)
    inside = reach < 1.0 + 1e-6
    scale = math.sqrt(_box_area(x, y, inside) / _box_area(on_x, on_y, inside))
    fade = np.clip(1.0 - (ring - 1.0) / min(0.9 * (room - 1.0), 1.0), 0.0, 1.0)
    return phi + box.half_angle * fade * (scale * on_x - u), z + half * fade * (scale * on_y - v)


def _box_area(x: Array, y: Array, inside: NDArray[np.bool_]) -> float:
    """Area within the outermost nodes of a block, whose sides are parabolas through the nodes of each element."""
    turns = np.flatnonzero(inside.any(axis=1))
    # The block may lie across the seam, where the last line is the first one again.
    if len(turns) and turns[-1] - turns[0] + 1 > len(turns):
        cut = int(np.flatnonzero(np.diff(turns) > 1)[0])
        turns = np.concatenate([turns[cut + 1 : -1], turns[: cut + 1]])
    rows = np.flatnonzero(inside.any(axis=0))
    block_x, block_y = x[np.ix_(turns, rows)], y[np.ix_(turns, rows)]
    sides = (np.s_[:, 0], np.s_[-1], np.s_[::-1, -1], np.s_[0, ::-1])
    return sum(_under(block_x[side], block_y[side]) for side in sides)


def _under(x: Array, y: Array) -> float:
    """Integral of x dy along parabolas through three nodes each."""
    a, b, c = x[:-2:2], x[1:-1:2], x[2::2]
    p, q, r = y[:-2:2], y[1:-1:2], y[2::2]
    return float(np.sum(a * (-3 * p + 4 * q - r) + 4 * b * (r - p) + c * (p - 4 * q + 3 * r))) / 6.0
