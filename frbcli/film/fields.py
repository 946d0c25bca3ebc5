"""Finite-length films of rectangular gaps with any pressure at the edges: tabulated fields, clipped at every call.

Where supply, ambient and cavitation pressure differ, the force is no longer proportional to |w|. But the pressure before
cavitation still is a sum of the fields of a unit w and of a hydrostatic part that does not depend on the gap: the fields are
tabulated over the eccentricity, summed at every call, and clipped and integrated there.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from frbcli.film.clip import clipped_line, force_weights
from frbcli.film.grid import Array, axial_modes, axial_vertices, ring_vertices
from frbcli.film.modal import element_lengths, unit_fields
from frbcli.film.table import DEPTH_STEP, Mesh, eccentricity_axis, half_width_lines

CONTRACTION = 0.35  # one grid for all eccentricities, see ring_vertices
LINES = 8  # Gauss points over half the width: the edge of the cavity crosses them at any slope

# Rows of the grid: element boundaries and lengths; positions and shares of the axial lines (the first LINES columns);
# the six rows of force_weights.
VERTICES, LENGTHS, POSITIONS, SHARES, WEIGHTS = range(5)


def field_vertices(mesh: Mesh) -> Array:
    """(m,) element boundaries of the one grid on which the fields of all eccentricities are tabulated."""
    return ring_vertices(mesh.circumferential, CONTRACTION)


def field_table(mesh: Mesh, radius_to_width: float) -> Array:
    """(n, 4, LINES, m + 1) fields of one section at the axial lines over the half turn 0 <= Theta <= pi.

    Axis 1: field of a unit w_r (even in Theta), of a unit w_t (odd), and their derivatives by x = -ln(1 - eps).
    """
    modes = axial_modes(axial_vertices(mesh.axial))
    shapes = modes.at(half_width_lines(LINES)[0])
    eccentricities, vertices = eccentricity_axis(), field_vertices(mesh)
    table = np.empty((len(eccentricities), 4, LINES, mesh.circumferential + 1))
    for i, eccentricity in enumerate(eccentricities):
        fields = unit_fields(vertices, eccentricity, radius_to_width**2 * modes.eigenvalues, modes.loads)
        fields[2:] *= 1.0 - eccentricity
        table[i] = np.einsum("kl,fkn->fln", shapes, fields[:, :, : mesh.circumferential + 1])
    return table


@njit(cache=True, error_model="numpy")
def _line_fields(table, eccentricity, line, unit):  # type: ignore[no-untyped-def]
    """unit (4, n) <- the two fields on the whole ring at one axial line and their derivatives by the eccentricity."""
    half = table.shape[3]
    n = 2 * (half - 1)
    x = -math.log(1.0 - eccentricity)
    cell = min(int(x / DEPTH_STEP), table.shape[0] - 2)
    a = x / DEPTH_STEP - cell
    h0, h1 = (1 + 2 * a) * (1 - a) ** 2, a * a * (3 - 2 * a)
    h2, h3 = DEPTH_STEP * a * (1 - a) ** 2, DEPTH_STEP * a * a * (a - 1)
    scale = 1.0 / (1.0 - eccentricity)  # dx/deps
    d0, d1 = 6 * a * (a - 1) / DEPTH_STEP * scale, 6 * a * (1 - a) / DEPTH_STEP * scale
    d2, d3 = (1 - a) * (1 - 3 * a) * scale, a * (3 * a - 2) * scale
    for f in range(2):
        low, high = table[cell, f, line], table[cell + 1, f, line]
        low_x, high_x = table[cell, 2 + f, line], table[cell + 1, 2 + f, line]
        for i in range(half):
            unit[f, i] = h0 * low[i] + h1 * high[i] + h2 * low_x[i] + h3 * high_x[i]
            unit[2 + f, i] = d0 * low[i] + d1 * high[i] + d2 * low_x[i] + d3 * high_x[i]
        mirror = 1.0 - 2.0 * f
        for i in range(1, half - 1):
            unit[f, n - i] = mirror * unit[f, i]
            unit[2 + f, n - i] = mirror * unit[2 + f, i]


@njit(cache=True, error_model="numpy")
def fields_force(  # type: ignore[no-untyped-def]
    table, grid, eccentricity, w_r, w_t, sigma, level
):
    """Force of one section, as table_force, with the scaled gauge pressures sigma at z = 1 and `level` in the cavity.

    table: of field_table; grid: of field_grid.
    """
    m = grid.shape[1]
    n = 2 * m
    vertices, lengths, weights = grid[VERTICES], grid[LENGTHS], grid[WEIGHTS:].reshape(2, 3, m)
    unit, line = np.empty((4, n)), np.empty((4, n))
    total = np.zeros((4, 2))
    part = np.empty((4, 2))
    for z in range(table.shape[2]):
        _line_fields(table, eccentricity, z, unit)
        for i in range(n):
            line[1, i], line[2, i] = unit[0, i], unit[1, i]
            line[3, i] = w_r * unit[2, i] + w_t * unit[3, i]
        for side in range(2):
            hydrostatic = sigma * (grid[POSITIONS, z] if side == 0 else 1.0 - grid[POSITIONS, z])
            for i in range(n):
                line[0, i] = w_r * unit[0, i] + w_t * unit[1, i] + hydrostatic
            part[:, :] = 0.0
            clipped_line(line, level, vertices, lengths, weights, part)
            for k in range(4):
                for c in range(2):
                    total[k, c] += 0.5 * grid[SHARES, z] * part[k, c]
    return (total[0, 0], total[0, 1], total[1, 0], total[2, 0], total[1, 1], total[2, 1], total[3, 0], total[3, 1])


def field_grid(mesh: Mesh) -> Array:
    """(10, m) the grid that belongs to field_table, row by row: see VERTICES, LENGTHS, POSITIONS, SHARES, WEIGHTS."""
    vertices = field_vertices(mesh)
    grid = np.zeros((WEIGHTS + 6, mesh.circumferential))
    grid[VERTICES], grid[LENGTHS] = vertices, element_lengths(vertices)
    grid[POSITIONS, :LINES], grid[SHARES, :LINES] = half_width_lines(LINES)
    grid[WEIGHTS:] = force_weights(vertices).reshape(6, -1)
    return grid
