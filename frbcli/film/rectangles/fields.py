"""Finite-length films of rectangular gaps with any pressure at the edges: tabulated fields, clipped at every call.

Where supply, ambient and cavitation pressure differ, the force is no longer proportional to |w|. But the pressure
before cavitation still is a sum of the fields of a unit w and of a hydrostatic part that does not depend on the gap:
the fields are tabulated over the eccentricity, summed at every call, and clipped and integrated there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.grid import NO_SEALS, Mesh, axial_modes, axial_vertices, ring_vertices
from frbcli.film.parabola import hermite
from frbcli.film.rectangles.modal import cut_element, element_lengths, force_weights, unit_fields
from frbcli.film.rectangles.short import sealed_shape
from frbcli.film.rectangles.table import DEPTH_STEP, axial_lines, eccentricity_axis

CONTRACTION = 0.35  # one grid for all eccentricities, see ring_vertices
LINES = 8  # Gauss points over half the width: the edge of the cavity crosses them at any slope

# Rows of the grid: element boundaries and lengths; positions, where sealed the share of the supply pressure there, and
# shares of the axial lines (the first columns);
# the six rows of force_weights.
VERTICES, LENGTHS, POSITIONS, SHARES, WEIGHTS = range(5)


class FieldsFilm(NamedTuple):
    """A film whose pressure fields are tabulated. table, grid: of field_table and field_grid; sigma, level: scaled
    gauge pressures of supply and cavity, 1/s; force_scale as in ShortFilm."""

    force_scale: float
    sigma: float
    level: float
    table: Array
    grid: Array


def field_vertices(mesh: Mesh) -> Array:
    """(m,) element boundaries of the one grid on which the fields of all eccentricities are tabulated."""
    return ring_vertices(mesh.circumferential, CONTRACTION)


def field_table(mesh: Mesh, radius_to_width: float, seals: tuple[float, float] = NO_SEALS) -> Array:
    """(n, 4, lines, m + 1) fields of one section at the axial lines over the half turn 0 <= Theta <= pi.

    Axis 1: field of a unit w_r (even in Theta), of a unit w_t (odd), and their derivatives by x = -ln(1 - eps).
    """
    modes = axial_modes(axial_vertices(mesh.axial), seals)
    positions, _ = axial_lines(seals, mesh.lines * LINES)
    shapes = modes.at(positions)
    eccentricities, vertices = eccentricity_axis(), field_vertices(mesh)
    table = np.empty((len(eccentricities), 4, len(positions), mesh.circumferential + 1))
    for i, eccentricity in enumerate(eccentricities):
        fields = unit_fields(vertices, eccentricity, radius_to_width**2 * modes.eigenvalues, modes.loads)
        fields[2:] *= 1.0 - eccentricity
        table[i] = np.einsum("kl,fkn->fln", shapes, fields[:, :, : mesh.circumferential + 1])
    return table


@compiled()
def _line_fields(table: Array, eccentricity: float, line: int, unit: Array) -> None:
    """unit (4, m + 1) <- the two fields on the half ring at one axial line and their derivatives by the
    eccentricity."""
    x = -math.log(1.0 - eccentricity)
    cell = min(int(x / DEPTH_STEP), table.shape[0] - 2)
    a = x / DEPTH_STEP - cell
    (h0, h1, h2, h3), (d1, d2, d3) = hermite(a, DEPTH_STEP)
    scale = 1.0 / (1.0 - eccentricity)  # dx/deps
    d1, d2, d3 = d1 * scale, d2 * scale, d3 * scale
    for f in range(2):
        low, high = table[cell, f, line], table[cell + 1, f, line]
        low_x, high_x = table[cell, 2 + f, line], table[cell + 1, 2 + f, line]
        for i in range(low.shape[0]):
            unit[f, i] = h0 * low[i] + h1 * high[i] + h2 * low_x[i] + h3 * high_x[i]
            unit[2 + f, i] = d1 * (high[i] - low[i]) + d2 * low_x[i] + d3 * high_x[i]


@compiled()
def _ring(unit: Array, w_r: float, w_t: float, excess: float, pressure: Array) -> float:
    """pressure (n + 1,) <- pressure over the level all around, its first node again at the end. Returns the largest."""
    half = unit.shape[1]
    n = 2 * (half - 1)
    largest = -math.inf
    for i in range(half):
        even, odd = w_r * unit[0, i] + excess, w_t * unit[1, i]
        pressure[i], pressure[n - i] = even + odd, even - odd
        largest = max(largest, even + abs(odd))
    return largest


@compiled()
def _sort_elements(
    unit: Array, w_r: float, w_t: float, pressure: Array, grid: Array, weights: Array, active: Array, cut: Array,
    part: Array,
) -> None:  # fmt: skip
    """active (2, n + 1) <- weights of the nodes for the elements that lie above the level as a whole; part (4, 2) +=
    the share of the elements that the level crosses. cut: (4, 3) scratch."""
    half, m = unit.shape[1], grid.shape[1]
    carried_c = carried_s = 0.0  # the share of a node that the element before it gives
    for e in range(m):
        i = 2 * e
        p0, p1, p2 = pressure[i], pressure[i + 1], pressure[i + 2]
        whole = 1.0 if min(p0, p1, p2) >= 0.0 else 0.0
        active[0, i], active[1, i] = carried_c + whole * weights[0, 0, e], carried_s + whole * weights[1, 0, e]
        active[0, i + 1], active[1, i + 1] = whole * weights[0, 1, e], whole * weights[1, 1, e]
        carried_c, carried_s = whole * weights[0, 2, e], whole * weights[1, 2, e]
        if whole == 0.0 and max(p0, p1, p2) > 0.0:
            for j in range(3):
                at, sign = (i + j, 1.0) if i + j < half else (2 * (half - 1) - i - j, -1.0)
                cut[0, j] = pressure[i + j]
                cut[1, j], cut[2, j] = unit[0, at], sign * unit[1, at]
                cut[3, j] = w_r * unit[2, at] + w_t * sign * unit[3, at]
            cut_element(cut, 0, 1, 2, p0, p1, p2, grid[VERTICES, e], grid[LENGTHS, e], part)
    active[0, 2 * m], active[1, 2 * m] = carried_c, carried_s


@compiled(fastmath={"reassoc", "contract"})
def _weighted(unit: Array, active: Array, sums: Array) -> None:
    """sums (5, 2) <- the four fields (even, odd, even, odd) and one, summed with the weights of the nodes."""
    half = unit.shape[1]
    n = 2 * (half - 1)
    for c in range(2):
        r = t = r_e = t_e = one = 0.0
        for i in range(half):
            even, odd = active[c, i] + active[c, n - i], active[c, i] - active[c, n - i]
            r += unit[0, i] * even
            t += unit[1, i] * odd
            r_e += unit[2, i] * even
            t_e += unit[3, i] * odd
            one += even
        # The node opposite the start is its own mirror image and was counted twice.
        middle = active[c, half - 1]
        sums[0, c] = r - unit[0, half - 1] * middle
        sums[1, c] = t + unit[1, half - 1] * middle
        sums[2, c] = r_e - unit[2, half - 1] * middle
        sums[3, c] = t_e + unit[3, half - 1] * middle
        sums[4, c] = one - middle


@compiled(makes_arrays=True)
def fields_force(
    table: Array, grid: Array, eccentricity: float, w_r: float, w_t: float, sigma: float, level: float,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Force of one section, as table_force, with the scaled gauge pressures sigma at z = 1 and `level` in the cavity.

    table: of field_table; grid: of field_grid.
    """
    m = grid.shape[1]
    weights = grid[WEIGHTS:].reshape(2, 3, m)
    unit, pressure, active = np.empty((4, m + 1)), np.empty(2 * m + 1), np.empty((2, 2 * m + 1))
    sums, cut, part, total = np.empty((5, 2)), np.empty((4, 3)), np.zeros((4, 2)), np.zeros((4, 2))
    for z in range(table.shape[2]):
        _line_fields(table, eccentricity, z, unit)
        for side in range(2 if grid[POSITIONS, table.shape[2] - 1] <= 0.5 else 1):  # lines over half or all the width
            excess = sigma * (grid[POSITIONS, z] if side == 0 else 1.0 - grid[POSITIONS, z]) - level
            if _ring(unit, w_r, w_t, excess, pressure) <= 0.0:
                continue
            part[:, :] = 0.0
            _sort_elements(unit, w_r, w_t, pressure, grid, weights, active, cut, part)
            _weighted(unit, active, sums)
            for c in range(2):
                share = 0.5 * grid[SHARES, z]
                total[0, c] += share * (part[0, c] + w_r * sums[0, c] + w_t * sums[1, c] + excess * sums[4, c])
                total[1, c] += share * (part[1, c] + sums[0, c])
                total[2, c] += share * (part[2, c] + sums[1, c])
                total[3, c] += share * (part[3, c] + w_r * sums[2, c] + w_t * sums[3, c])
    return (total[0, 0], total[0, 1], total[1, 0], total[2, 0], total[1, 1], total[2, 1], total[3, 0], total[3, 1])


def field_grid(mesh: Mesh, seals: tuple[float, float] = NO_SEALS) -> Array:
    """(10, m) the grid that belongs to field_table, row by row: see VERTICES, LENGTHS, POSITIONS, SHARES, WEIGHTS."""
    vertices = field_vertices(mesh)
    grid = np.zeros((WEIGHTS + 6, mesh.circumferential))
    grid[VERTICES], grid[LENGTHS] = vertices, element_lengths(vertices)
    positions, shares = axial_lines(seals, mesh.lines * LINES)
    lines, (a, b) = len(positions), sealed_shape(seals)
    if seals[0] != seals[1]:  # what the supply adds there; and one side of each line alone counts
        positions, shares = a + b * positions, 2.0 * shares
    grid[POSITIONS, :lines], grid[SHARES, :lines] = positions, shares
    grid[WEIGHTS:] = force_weights(vertices).reshape(6, -1)
    return grid
