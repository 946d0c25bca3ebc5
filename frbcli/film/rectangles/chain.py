"""Finite-length films between axial grooves: axial modes times chains of quadratic elements along phi.

Between two axial grooves the gap is a rectangle, and H depends on phi alone: the axial modes of `modal.py` split the
problem as they do for a closed ring, but each piece begins and ends at a groove with the pressure (6.2) of the groove.
The grooves stand still, so that nothing can be tabulated over the line of centres: the chains are solved at every call.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.grid import CHAIN_MODES, NO_SEALS, Mesh, axial_modes, axial_vertices
from frbcli.film.rectangles.modal import GAUSS_POINTS, GAUSS_WEIGHTS, SHAPE, SLOPE, cut_element
from frbcli.film.rectangles.table import half_width_lines

LINES = 6  # Gauss points over half the width

# Rows of the grid, one column per element: its first angle and its length, whether it begins (1), ends (2) or is (3) a
# piece, the integrals of its three shape functions times n_x and n_y, and n_x and n_y at its three quadrature points.
START, LENGTH, PLACE, WEIGHTS, NORMALS = 0, 1, 2, 3, 9
# The entries of the upper triangle of an element matrix.
FIRST_NODE, SECOND_NODE = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])
SLOPES = GAUSS_WEIGHTS * SLOPE[FIRST_NODE] * SLOPE[SECOND_NODE]  # (entry, point)
VALUES = GAUSS_WEIGHTS * SHAPE[FIRST_NODE] * SHAPE[SECOND_NODE]
# Rows of the axial table: (R/B)^2 lambda_k, load and groove pressure of each mode; weights of the lines; constant force
# of the grooves (two columns); from SHAPES on the modes at the lines, one row each.
DECAY, LOAD, GROOVE, SHARE, CONSTANT, SHAPES = range(6)


class ChainFilm(NamedTuple):
    """A film between axial grooves. table, grid: of chain_table and chain_grid; level: scaled gauge pressure of the
    cavity, 1/s; force_scale, clipped as in ShortFilm."""

    force_scale: float
    clipped: int
    level: float
    table: Array
    grid: Array


def chain_grid(edges: Array, elements: int) -> Array:
    """(15, m) grid of the pieces between grooves. edges: (p, 2) first and last angle of each piece, rad."""
    total = float(np.sum(edges[:, 1] - edges[:, 0]))
    columns = []
    for first, last in edges:
        count = max(2, round(elements * (last - first) / total))
        ends = np.linspace(first, last, count + 1)
        place = np.zeros(count)
        place[0] += 1
        place[-1] += 2
        lengths = np.diff(ends)
        angles = ends[:-1, None] + lengths[:, None] * GAUSS_POINTS
        share = lengths[:, None] * GAUSS_WEIGHTS
        normals = (np.sin(angles), -np.cos(angles))
        weights = [np.einsum("eg,ig->ie", share * normal, SHAPE) for normal in normals]
        columns.append(np.vstack([ends[:-1], lengths, place, *weights, *(normal.T for normal in normals)]))
    return np.ascontiguousarray(np.hstack(columns))


def chain_table(
    mesh: Mesh, radius_to_width: float, profile: Callable[[Array], Array], constant: Array,
    seals: tuple[float, float] = NO_SEALS,
) -> Array:  # fmt: skip
    """(1, 1, SHAPES + CHAIN_MODES, c) axial table.

    profile: scaled gauge pressure in the grooves at the axial positions (n,) in [0, 1]; constant: (2,) integral of n
    times pressure over all that is not solved: the grooves.
    """
    modes = axial_modes(axial_vertices(mesh.axial), seals)
    kept = min(CHAIN_MODES, len(modes.loads))
    lines = mesh.lines * LINES
    positions, weights = half_width_lines(lines)
    table = np.zeros((SHAPES + kept, max(kept, lines)))
    table[DECAY, :kept] = radius_to_width**2 * modes.eigenvalues[:kept]
    table[LOAD, :kept] = modes.loads[:kept]
    table[GROOVE, :kept] = modes.project(profile(modes.nodes))[:kept]
    table[SHARE, :lines] = weights
    table[CONSTANT, :2] = constant
    table[SHAPES:, :lines] = modes.at(positions)[:kept]
    return table[None, None]


@compiled()
def element_matrices(grid: Array, d_x: float, d_y: float, along: Array, across: Array) -> None:
    """Element matrices of H^3 and of its derivatives by d_x and d_y, without the mode's share.

    Fills along and across (m, 3, 6): upper triangles of the parts with and without derivatives by phi.
    """
    for e in range(grid.shape[1]):
        length = grid[LENGTH, e]
        for t in range(3):
            for entry in range(6):
                along[e, t, entry] = across[e, t, entry] = 0.0
        for g in range(3):
            n_x, n_y = grid[NORMALS + g, e], grid[NORMALS + 3 + g, e]
            gap = 1.0 + d_x * n_x + d_y * n_y
            change = 3.0 * gap * gap
            for t in range(3):
                weight = gap * gap * gap if t == 0 else change * (n_x if t == 1 else n_y)
                for entry in range(6):
                    along[e, t, entry] += weight / length * SLOPES[entry, g]
                    across[e, t, entry] += weight * length * VALUES[entry, g]


@compiled()
def _solve_chain(
    stiff: Array, first: int, count: int, row: int, rows: int, fields: Array, diagonal: Array, upper: Array,
) -> None:  # fmt: skip
    """Solve one piece of `count` elements from `first` on for the right-hand sides fields[row : row + rows], in place.

    stiff: (m, 6) upper triangle of each element matrix; diagonal, upper: (m + 1,) scratch. The ends of the piece hold
    their given pressure. The middles are condensed, the ends form a tridiagonal system.
    """
    base, last = 2 * first, row + rows
    for e in range(count + 1):
        diagonal[e] = 0.0
    for e in range(count):
        f = first + e
        a, b = stiff[f, 1] / stiff[f, 3], stiff[f, 4] / stiff[f, 3]
        diagonal[e] += stiff[f, 0] - stiff[f, 1] * a
        diagonal[e + 1] += stiff[f, 5] - stiff[f, 4] * b
        upper[e] = stiff[f, 2] - stiff[f, 1] * b
        for r in range(row, last):
            middle = fields[r, base + 2 * e + 1]
            if e > 0:
                fields[r, base + 2 * e] -= a * middle
            if e + 1 < count:
                fields[r, base + 2 * e + 2] -= b * middle
    end = base + 2 * count
    for r in range(row, last):
        if count > 1:
            fields[r, base + 2] -= upper[0] * fields[r, base]
            fields[r, end - 2] -= upper[count - 1] * fields[r, end]
    for e in range(2, count):
        factor = upper[e - 1] / diagonal[e - 1]
        diagonal[e] -= factor * upper[e - 1]
        for r in range(row, last):
            fields[r, base + 2 * e] -= factor * fields[r, base + 2 * e - 2]
    for e in range(count - 1, 0, -1):
        inverse = 1.0 / diagonal[e]
        for r in range(row, last):
            if e < count - 1:
                fields[r, base + 2 * e] -= upper[e] * fields[r, base + 2 * e + 2]
            fields[r, base + 2 * e] *= inverse
    for e in range(count):
        f, i = first + e, base + 2 * e
        inverse = 1.0 / stiff[f, 3]
        for r in range(row, last):
            fields[r, i + 1] = inverse * (
                fields[r, i + 1] - stiff[f, 1] * fields[r, i] - stiff[f, 4] * fields[r, i + 2]
            )


@compiled()
def mode_fields(
    grid: Array, along: Array, across: Array, w_x: float, w_y: float, decay: float, load: float, groove: float,
    scratch: tuple[Array, Array, Array], fields: Array,
) -> None:  # fmt: skip
    """fields (5, 2 m + 1) <- pressure, its derivatives by w_x and w_y, and by d_x and d_y, of one mode.

    Neighbouring pieces share the node of the groove between them: both hold its pressure there.
    """
    m = grid.shape[1]
    stiff, diagonal, upper = scratch
    fields[:, :] = 0.0
    for e in range(m):
        for entry in range(6):
            stiff[e, entry] = along[e, 0, entry] + decay * across[e, 0, entry]
        for i in range(3):
            fields[1, 2 * e + i] -= load * grid[WEIGHTS + i, e]
            fields[2, 2 * e + i] -= load * grid[WEIGHTS + 3 + i, e]
    first = 0
    for e in range(m):
        if grid[PLACE, e] >= 2.0:
            fields[0, 2 * first] = fields[0, 2 * e + 2] = groove
            for r in range(1, 3):
                fields[r, 2 * first] = fields[r, 2 * e + 2] = 0.0
            _solve_chain(stiff, first, e - first + 1, 0, 3, fields, diagonal, upper)
            for i in range(2 * first, 2 * e + 3):
                fields[0, i] += w_x * fields[1, i] + w_y * fields[2, i]
            first = e + 1
    # K' P + K P' = 0
    for e in range(m):
        a, b, c = fields[0, 2 * e], fields[0, 2 * e + 1], fields[0, 2 * e + 2]
        for t in range(1, 3):
            s_0 = along[e, t, 0] + decay * across[e, t, 0]
            s_1 = along[e, t, 1] + decay * across[e, t, 1]
            s_2 = along[e, t, 2] + decay * across[e, t, 2]
            s_3 = along[e, t, 3] + decay * across[e, t, 3]
            s_4 = along[e, t, 4] + decay * across[e, t, 4]
            s_5 = along[e, t, 5] + decay * across[e, t, 5]
            fields[2 + t, 2 * e] -= s_0 * a + s_1 * b + s_2 * c
            fields[2 + t, 2 * e + 1] -= s_1 * a + s_3 * b + s_4 * c
            fields[2 + t, 2 * e + 2] -= s_2 * a + s_4 * b + s_5 * c
    first = 0
    for e in range(m):
        if grid[PLACE, e] >= 2.0:
            for r in range(3, 5):
                fields[r, 2 * first] = fields[r, 2 * e + 2] = 0.0
            _solve_chain(stiff, first, e - first + 1, 3, 2, fields, diagonal, upper)
            first = e + 1


@compiled(makes_arrays=True)
def chain_force(
    table: Array, grid: Array, d_x: float, d_y: float, w_x: float, w_y: float, level: float, clipped: bool,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """Integrals of P n dz dphi over the bearing, with P clipped at `level` (scaled, gauge) if clipped.

    Returns the force (x, y), its derivatives by w (xx, xy, yx, yy) and by d at fixed w (xx, xy, yx, yy): ten numbers.
    """
    m, modes = grid.shape[1], table.shape[2] - SHAPES
    axial = table[0, 0]
    nodes = 2 * m + 1
    fields, line = np.empty((modes, 5, nodes)), np.empty((5, nodes))
    along, across = np.empty((m, 3, 6)), np.empty((m, 3, 6))
    scratch = (np.empty((m, 6)), np.empty(m + 1), np.empty(m + 1))
    element_matrices(grid, d_x, d_y, along, across)
    for k in range(modes):
        mode_fields(
            grid, along, across, w_x, w_y, axial[DECAY, k], axial[LOAD, k], axial[GROOVE, k], scratch, fields[k]
        )
    total, part = np.zeros((5, 2)), np.empty((5, 2))
    for z in range(axial.shape[1]):
        if axial[SHARE, z] == 0.0:  # columns of modes beyond the lines
            break
        line[:, :] = 0.0
        for k in range(modes):
            shape = axial[SHAPES + k, z]
            for r in range(5):
                for i in range(nodes):
                    line[r, i] += shape * fields[k, r, i]
        part[:, :] = 0.0
        for e in range(m):
            i = 2 * e
            p0, p1, p2 = line[0, i] - level, line[0, i + 1] - level, line[0, i + 2] - level
            if not clipped or min(p0, p1, p2) >= 0.0:
                for c in range(2):
                    w0, w1, w2 = grid[WEIGHTS + 3 * c, e], grid[WEIGHTS + 3 * c + 1, e], grid[WEIGHTS + 3 * c + 2, e]
                    part[0, c] += w0 * p0 + w1 * p1 + w2 * p2
                    for r in range(1, 5):
                        part[r, c] += w0 * line[r, i] + w1 * line[r, i + 1] + w2 * line[r, i + 2]
            elif max(p0, p1, p2) > 0.0:
                # cut_element integrates with cos and sin: n = (sin phi, -cos phi) belongs to phi - pi/2
                cut_element(line, i, i + 1, i + 2, p0, p1, p2, grid[START, e] - 0.5 * math.pi, grid[LENGTH, e], part)
        for r in range(5):
            for c in range(2):
                total[r, c] += axial[SHARE, z] * part[r, c]
    return (
        total[0, 0] + axial[CONSTANT, 0], total[0, 1] + axial[CONSTANT, 1],
        total[1, 0], total[2, 0], total[1, 1], total[2, 1],
        total[3, 0], total[4, 0], total[3, 1], total[4, 1],
    )  # fmt: skip
