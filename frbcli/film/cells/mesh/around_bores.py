"""Which cells lie around the bores of a section, and what the local solutions (bores.py) make of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cells.mesh.bores import BoreFit, Mask, Patch, fit
from frbcli.film.cells.mesh.openings import wrapped
from frbcli.film.gap import Hole, Section

REACH = 2.5  # cells around a bore whose flows follow the local solutions; no more than half-way to the next opening
MOST = 1000  # cells of a patch: a bore that is so much larger than a cell needs none
WHOLE = 1e-9  # by which the middle of a bore may miss a plane of symmetry, or its shape a circle


class Cells(NamedTuple):
    """The parts of a grid that bores change, see VolumeGrid: around, at, area, load (m, k), along (m, k - 1)."""

    around: Array
    along: Array
    at: Array
    area: Array
    load: Array


class CellsAtBore(NamedTuple):
    """Columns and rows of the cells around a bore, and these."""

    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    patch: Patch


def around_bores(
    section: Section, phi: Array, z: Array, height: Array, inside: Sequence[Mask], cover: Array, plain: Cells
) -> Cells:
    """The cells with the flows and areas around the bores by the local solutions.

    phi (m + 1,), z (k + 1,): boundaries; height: (k,) of the unknowns; inside: (m, k) the cells that stand for each
    hole of the section; cover: (m, k) share of a cell that openings take; plain: the cells without.
    """
    around, along, at, area, load = (values.copy() for values in plain)
    found: dict[bytes, BoreFit] = {}
    width = section.width / section.radius
    for number in range(len(section.holes)):
        place = _place(section, phi, z, height, number, inside[number], cover)
        if place is None:
            continue
        columns, rows, patch = place
        cells, faces, between = np.ix_(columns, rows), np.ix_(columns[:-1], rows), np.ix_(columns, rows[:-1])
        dx, dy = patch.dx[:, None], patch.dy[None, :]
        at[faces] = _gap_places(at[faces], 0.5 * patch.dx, around[faces], patch.held)
        key = np.round(np.concatenate([patch.x, patch.y, patch.open_.ravel(), patch.held.ravel()]), 9).tobytes()
        if key not in found:  # the bores of a ring often lie alike
            found[key] = fit(patch, _over(dy, around[faces]), _over(dx, width * along[between]))
        near = found[key]
        around[faces], along[between] = _over(dy, near.around), _over(dx, width * near.along)
        area[cells] = np.where(patch.held, area[cells], near.source / width)
        load[cells] = near.load / (dx * dy)
    return Cells(around, along, at, area, load)


def _gap_places(faces: Array, half: Array, around: Array, held: Mask) -> Array:
    """(nx - 1, ny) angles at which flows around take their gap: the faces (nx - 1, ny) between the cells, or half way
    from the middle of a cell to the edge of the bore. half: (nx,) of the cells' lengths; around: their distances."""
    before, behind = ~held[:-1] & held[1:], held[:-1] & ~held[1:]
    places = np.where(before, faces - half[:-1, None] + 0.5 * around, faces)
    return np.where(behind, faces + half[1:, None] - 0.5 * around, places)


def _over(length: Array, distance: Array) -> Array:
    """Conductances of faces of a length by distances, or the reverse; both 0 within an opening."""
    return np.where(distance > 0.0, length / np.where(distance > 0.0, distance, 1.0), 0.0)


def _place(
    section: Section, phi: Array, z: Array, height: Array, number: int, inside: Mask, cover: Array
) -> CellsAtBore | None:
    """The cells around a hole; None where it is no bore, or has no room for them."""
    hole, width = section.holes[number], section.width / section.radius
    a, middle, room = hole.half_angle, hole.axial / section.width, 0.5 * _distance_to_next(section, number)
    dx, dy = np.diff(phi), np.diff(z) * width
    x, y = wrapped(0.5 * (phi[1:] + phi[:-1]) - hole.position), (height - middle) * width
    around_it = np.abs(x) < a + dx  # the longer sides of the cells count
    reach = a + min(REACH * max(dx[around_it].max(), dy.max()), room)
    near_x, near_y = np.abs(x) < reach, np.abs(y) < reach
    columns, rows = np.flatnonzero(near_x), np.flatnonzero(near_y)
    columns = columns[np.argsort(x[columns])]
    held = inside[np.ix_(columns, rows)]
    has_room = len(columns) <= len(x) - 3 and held.size <= MOST and held.sum() == inside.sum() > 0
    if not (_is_bore(section, hole) and has_room and room >= max(dx[columns].max(), dy[rows].max())):
        return None
    beyond = np.array([columns[0] - 1, *columns, columns[-1] + 1]) % len(x)
    steps = 0.5 * (dx[beyond[1:]] + dx[beyond[:-1]])
    xs = x[columns[0]] - steps[0] + np.concatenate([[0.0], np.cumsum(steps)])
    low = y[rows[0] - 1] if rows[0] > 0 else y[0] - dy[0]
    high = y[rows[-1] + 1] if rows[-1] + 1 < len(y) else y[-1] + dy[-1]
    open_ = (1.0 - cover[np.ix_(columns, rows)]) * np.outer(dx[columns], dy[rows])
    ys = np.array([low, *y[rows], high])
    return CellsAtBore(columns, rows, Patch(a, xs, ys, dx[columns], dy[rows], held, open_, _mirrored(section, hole)))


def _mirrored(section: Section, hole: Hole) -> bool:
    return section.far == "symmetry" and abs(hole.axial - section.width) < WHOLE * section.width


def _is_bore(section: Section, hole: Hole) -> bool:
    """Whether a hole is round and no end cuts it."""
    circle = hole.round and abs(hole.half_width / section.radius - hole.half_angle) < WHOLE * hole.half_angle
    within = hole.half_width <= hole.axial and hole.axial + hole.half_width <= section.width
    return circle and (within or _mirrored(section, hole))


def _distance_to_next(section: Section, number: int) -> float:
    """Distance from the edge of a hole to that of the nearest other groove or hole, over R."""
    hole = section.holes[number]
    found = [math.pi - hole.half_angle]
    for groove in section.grooves:
        found.append(_between(groove.position, hole.position) - 0.5 * groove.opening - hole.half_angle)
    for other in section.holes[:number] + section.holes[number + 1 :]:
        across = max(_between(other.position, hole.position) - other.half_angle, 0.0)
        above = max(abs(other.axial - hole.axial) - other.half_width, 0.0) / section.radius
        found.append(math.hypot(across, above) - hole.half_angle)
    return max(min(found), 0.0)


def _between(one: float, other: float) -> float:
    """Angle between two, at most half a turn."""
    return abs(math.remainder(one - other, 2.0 * math.pi))
