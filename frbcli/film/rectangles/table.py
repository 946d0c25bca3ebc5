"""Finite-length films of rectangular gaps, tabulated over the eccentricity.

Where all pressures at the edges equal the cavitation pressure the force of a rectangular film is proportional to |w|
and depends, in the frame of the line of centres, on the eccentricity and the direction of w alone. That table is made
from the compiled solver of `modal.py` in some 30 ms before a run starts, and evaluated a few hundred thousand times
during it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.grid import NO_SEALS, Mesh, axial_modes, axial_vertices, ring_vertices
from frbcli.film.parabola import Slopes, Values, hermite
from frbcli.film.rectangles.modal import clipped_line, element_lengths, force_weights, unit_fields

DEPTH_STEP = 0.1  # step of x = -ln(1 - eps): forces grow at most like exp(2.5 x), interpolated to 1e-5
DIRECTIONS = 33  # of w, over half a turn; the other half is its mirror image
LINES = 8  # Gauss points over half the width
STRETCH = 0.25  # w_t is scaled by (1 - eps)^STRETCH: keeps the force smooth in the direction of w up to contact


class TableFilm(NamedTuple):
    """A film in a table over the eccentricity, of force_table; force_scale as in ShortFilm."""

    force_scale: float
    table: Array


def eccentricity_axis() -> Array:
    """(n,) eccentricities of the tables, equidistant in x = -ln(1 - eps)."""
    end = -math.log(1.0 - LARGEST_ECCENTRICITY)
    eccentricities: Array = 1.0 - np.exp(-DEPTH_STEP * np.arange(math.ceil(end / DEPTH_STEP) + 1))
    return eccentricities


def half_width_lines(lines: int = LINES) -> tuple[Array, Array]:
    """Axial positions in [0, 1/2] and the weights that integrate an axially symmetric function over [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(lines)
    return 0.25 * (points + 1.0), 0.5 * weights


def axial_lines(seals: tuple[float, float], lines: int = LINES) -> tuple[Array, Array]:
    """Axial positions and weights that integrate the pressure over [0, 1]: on half the width, where both ends are
    alike, else on twice as many lines."""
    if seals[0] == seals[1]:
        return half_width_lines(lines)
    points, weights = np.polynomial.legendre.leggauss(2 * lines)
    return 0.5 * (points + 1.0), 0.5 * weights


def ring_contraction(eccentricity: float) -> float:
    """Contraction of the grid around the narrowest gap that suits one eccentricity, see ring_vertices."""
    return float(max((1.0 - eccentricity) / (1.0 + eccentricity), 1e-6) ** 0.3)


def clipped_forces(
    fields: Array, shapes: Array, weights_z: Array, directions: Array, stretch: float, stretch_rate: float,
    vertices: Array, clipped: bool,
) -> Array:  # fmt: skip
    """(d, 3, 2) force of unit w in each direction, its derivatives by the direction and by the eccentricity.

    fields: (4, k, n) of unit_fields; shapes: (k, l) modes at the axial lines with weights_z (l,); directions: (d,)
    angles of (w_r, stretch * w_t). Axis 2: components along and across the line of centres.
    """
    unit = np.einsum("kl,fkn->lfn", shapes, fields)
    # The tangential field of a unit stretched w_t.
    unit[:, 3] = unit[:, 3] / stretch - unit[:, 1] * stretch_rate / stretch**2
    unit[:, 1] /= stretch
    result, line, part = np.zeros((len(directions), 3, 2)), np.empty((3, unit.shape[2])), np.empty((3, 2))
    weights, lengths = force_weights(vertices), element_lengths(vertices)
    _add_forces(unit, weights_z, directions, vertices, lengths, weights, clipped, (line, part), result)
    return result


@compiled()
def _add_forces(
    fields: Array, weights_z: Array, directions: Array, vertices: Array, lengths: Array, weights: Array, clipped: bool,
    work: tuple[Array, Array], result: Array,
) -> None:  # fmt: skip
    """result += forces as in clipped_forces; fields (l, 4, n) of a unit stretched w on the axial lines."""
    line, part = work
    n = line.shape[1]
    level = 0.0 if clipped else -1e300
    for z in range(fields.shape[0]):
        unit = fields[z]
        for j in range(directions.shape[0]):
            cosine, sine = math.cos(directions[j]), math.sin(directions[j])
            for i in range(n):
                line[0, i] = cosine * unit[0, i] + sine * unit[1, i]
                line[1, i] = cosine * unit[1, i] - sine * unit[0, i]
                line[2, i] = cosine * unit[2, i] + sine * unit[3, i]
            for a in range(3):
                part[a, 0] = part[a, 1] = 0.0
            clipped_line(line, level, vertices, lengths, weights, part)
            if not clipped:  # the level itself integrates to zero in exact arithmetic only
                part[0, 0] = part[0, 1] = 0.0
                for e in range(lengths.shape[0]):
                    e2 = 2 * e + 2 if 2 * e + 2 < n else 0
                    for c in range(2):
                        part[0, c] += (
                            weights[c, 0, e] * line[0, 2 * e]
                            + weights[c, 1, e] * line[0, 2 * e + 1]
                            + weights[c, 2, e] * line[0, e2]
                        )
            for a in range(3):
                for c in range(2):
                    result[j, a, c] += weights_z[z] * part[a, c]


def force_table(
    mesh: Mesh, radius_to_width: float, clipped: bool, seals: tuple[float, float] = NO_SEALS
) -> Array:
    """(n, DIRECTIONS, 2, 4) force of one section: value, derivative by x, by the direction psi, and by both.

    Radial component even in psi, tangential odd. Entries are integrals of P (cos Theta, sin Theta) dz dTheta for |w| =
    1/s, with w measured as (w_r, w_t (1 - eps)^STRETCH).
    """
    modes = axial_modes(axial_vertices(mesh.axial), seals)
    lines, weights = axial_lines(seals, mesh.lines * LINES)
    shapes = modes.at(lines)
    eccentricities = eccentricity_axis()
    directions = np.linspace(0.0, np.pi, DIRECTIONS)
    table = np.empty((len(eccentricities), DIRECTIONS, 2, 4))
    for i, eccentricity in enumerate(eccentricities):
        vertices = ring_vertices(mesh.circumferential, ring_contraction(eccentricity))
        fields = unit_fields(vertices, eccentricity, radius_to_width**2 * modes.eigenvalues, modes.loads)
        stretch = (1.0 - eccentricity) ** STRETCH
        forces = clipped_forces(
            fields, shapes, weights, directions, stretch, -STRETCH * stretch / (1.0 - eccentricity), vertices, clipped
        )
        table[i, :, :, 0] = forces[:, 0]
        table[i, :, :, 1] = forces[:, 2] * (1.0 - eccentricity)
        table[i, :, :, 2] = forces[:, 1]
    for c, parity in enumerate((1.0, -1.0)):
        table[:, :, c, 3] = _slopes(table[:, :, c, 1], directions[1], parity)
    return table


def _slopes(values: Array, step: float, parity: float) -> Array:
    """(n, d) slopes of the cubic splines through values (n, d) over half a turn, mirrored at both ends with this
    parity.

    Between neighbours s' + 4 s + s'' = 3 (f'' - f') / step; beyond an end the slope of an even function is mirrored
    with the other sign and is zero there; the slope of an odd function with the same sign. """
    from scipy.linalg import solve_banded

    n = values.shape[1]
    bands = np.ones((3, n))
    bands[1] = 4.0
    right = np.empty_like(values)
    right[:, 1:-1] = 3.0 / step * (values[:, 2:] - values[:, :-2])
    if parity > 0.0:
        bands[0, 1] = bands[2, -2] = 0.0
        right[:, 0] = right[:, -1] = 0.0
    else:
        bands[0, 1] = bands[2, -2] = 2.0
        right[:, 0], right[:, -1] = 6.0 / step * values[:, 1], -6.0 / step * values[:, -2]
    slopes: Array = solve_banded((1, 1), bands, right.T).T
    return slopes


@compiled()
def table_force(
    table: Array, eccentricity: float, w_r: float, w_t: float,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Bicubic Hermite interpolation of force_table.

    Returns, in the frame of the line of centres, the force (r, t), its derivatives by w (rr, rt, tr, tt) and by the
    eccentricity (r, t): eight numbers.
    """
    n, directions = table.shape[0], table.shape[1]
    x = -math.log(1.0 - eccentricity)
    stretch = math.exp(-STRETCH * x)
    u_t = abs(w_t) * stretch
    speed = math.sqrt(w_r * w_r + u_t * u_t)
    cosine, sine = (w_r / speed, u_t / speed) if speed > 0.0 else (1.0, 0.0)
    step_psi = math.pi / (directions - 1)
    a, b = x / DEPTH_STEP, math.atan2(u_t, w_r) / step_psi
    i, j = min(int(a), n - 2), min(int(b), directions - 2)
    a -= i
    b -= j
    along_x, slope_x = hermite(a, DEPTH_STEP)
    along_psi, slope_psi = hermite(b, step_psi)
    mirror = -1.0 if w_t < 0.0 else 1.0
    g_r, x_r, p_r = _hermite(table, i, j, 0, along_x, slope_x, along_psi, slope_psi)
    g_t, x_t, p_t = _hermite(table, i, j, 1, along_x, slope_x, along_psi, slope_psi)
    by_u_r, by_u_t = g_r * sine + p_r * cosine, g_t * sine + p_t * cosine
    # d(u_t)/dx = -STRETCH u_t; dx/deps = 1 / (1 - eps)
    depth = 1.0 / (1.0 - eccentricity)
    return (
        speed * g_r,
        mirror * speed * g_t,
        g_r * cosine - p_r * sine,
        mirror * by_u_r * stretch,
        mirror * (g_t * cosine - p_t * sine),
        by_u_t * stretch,
        depth * (speed * x_r - STRETCH * by_u_r * u_t),
        mirror * depth * (speed * x_t - STRETCH * by_u_t * u_t),
    )


@compiled()
def _hermite(
    table: Array, i: int, j: int, c: int, along_x: Values, slope_x: Slopes, along_psi: Values, slope_psi: Slopes,
) -> tuple[float, float, float]:  # fmt: skip
    """Value, derivative by x and by psi of component c in the cell (i, j); polynomials and their slopes."""
    a0, a1, a2, a3 = along_x
    c1, c2, c3 = slope_x
    # along psi first, at both ends of the cell in x: the value, its derivative by x, and the psi-slopes of both
    v0, p0 = _along_psi(table, i, j, c, 0, along_psi, slope_psi)
    v1, p1 = _along_psi(table, i + 1, j, c, 0, along_psi, slope_psi)
    x0, q0 = _along_psi(table, i, j, c, 1, along_psi, slope_psi)
    x1, q1 = _along_psi(table, i + 1, j, c, 1, along_psi, slope_psi)
    return (
        a0 * v0 + a1 * v1 + a2 * x0 + a3 * x1,
        c1 * (v1 - v0) + c2 * x0 + c3 * x1,
        a0 * p0 + a1 * p1 + a2 * q0 + a3 * q1,
    )


@compiled()
def _along_psi(
    table: Array, i: int, j: int, c: int, entry: int, along_psi: Values, slope_psi: Slopes,
) -> tuple[float, float]:  # fmt: skip
    """An entry of the table, 0: value, 1: its derivative by x, in line i between j and j + 1, and its slope."""
    b0, b1, b2, b3 = along_psi
    d1, d2, d3 = slope_psi
    f, g = table[i, j, c, entry], table[i, j + 1, c, entry]
    f_psi, g_psi = table[i, j, c, entry + 2], table[i, j + 1, c, entry + 2]
    return b0 * f + b1 * g + b2 * f_psi + b3 * g_psi, d1 * (g - f) + d2 * f_psi + d3 * g_psi
