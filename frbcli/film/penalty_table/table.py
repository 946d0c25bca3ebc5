"""Films whose law makes oil where the pressure falls too low, tabulated over eccentricity, direction and speed.

The force of such a film without openings follows from the eccentricity and from the velocity w of the journal in the
frame that turns with half the speed, seen along and across the line of centres. Unlike the force of a clipped film it
is not proportional to |w|, for the law brings its own pressure: |w| is the third axis. Where the law's pressure follows
the speed of rotation (dimensionless penalty), w and the force count over it.

Of a steepness b the force leaves proportion where b |w| is small, and slowly: cubic splines in (|w| + L)^-ROOT with L
of some 1 / b need few nodes, and hold down to rest.

Forces of a film whose law makes oil, at one eccentricity, for many velocities. Compiled.

Seen from a frame that turns with half the speed, the balance of the cells is A p + load = q(p): the matrix A depends on
the gap alone, the load is linear in the velocity, and only the source q of a cell follows its own pressure. So the
equations are assembled once for an eccentricity, and Newton's method changes their diagonal scaling only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import compiled_cell
from frbcli.film.cavitation.law import Scales
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cells.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES, solve_blocks
from frbcli.film.gap import LARGEST_ECCENTRICITY

DEPTH_STEP = 0.2  # step of x = -ln(1 - eps)
DIRECTIONS = 13  # over half a turn; the other half is its mirror image
SPEEDS = 9
SLOWEST = 100.0  # L of the centred journal times the steepness there
SHRINK = 0.5  # L falls with (1 - eps)^SHRINK: the narrower the gap, the more pressure a speed makes
FASTEST = 4e4  # the largest |w| + L over L
ROOT = 0.25  # of |w| + L that the third axis counts in
STRETCH = 0.25  # w_t is scaled by (1 - eps)^STRETCH: keeps the force smooth in the direction of w up to contact
AT_REST = 1e-3  # of L: below this speed the direction of w is arbitrary, and does not matter

# Numbers of a table: L of the centred journal; the step of the third axis; whether w and the force count over the speed
# of rotation.
SLOW, STEP, RELATIVE, TABLE_NUMBERS = range(4)


class PenaltyTableFilm(NamedTuple):
    """A penalty film in a table. table, numbers: of source_table and table_numbers; force_scale as in ShortFilm."""

    force_scale: float
    table: Array
    numbers: Array


def table_numbers(steepness: float, relative: bool) -> Array:
    """(1, TABLE_NUMBERS) of a law with this steepness at the centre, s, or 1 if relative."""
    step = (FASTEST**-ROOT - 1.0) / (SPEEDS - 1)
    return np.array([[SLOWEST / steepness, step, float(relative)]])


def depth_axis() -> Array:
    """(n,) x = -ln(1 - eps) of the table."""
    end = -math.log(1.0 - LARGEST_ECCENTRICITY)
    return np.asarray(DEPTH_STEP * np.arange(math.ceil(end / DEPTH_STEP) + 1), dtype=np.float64)


def slow_speed(x: float, numbers: Array) -> float:
    """L at the depth x."""
    return float(numbers[0, SLOW]) * math.exp(-SHRINK * x)


def speed_axis(x: float, numbers: Array) -> Array:
    """(SPEEDS,) |w| + L of the table at the depth x, rising."""
    speeds: Array = slow_speed(x, numbers) * (1.0 + numbers[0, STEP] * np.arange(SPEEDS)) ** (-1.0 / ROOT)
    return speeds


def table_velocities(x: float, numbers: Array) -> Array:
    """(DIRECTIONS, SPEEDS, 2) velocities along and across the line of centres at the depth x, the largest first."""
    directions = np.linspace(0.0, np.pi, DIRECTIONS)
    sizes = speed_axis(x, numbers)[::-1] - slow_speed(x, numbers)
    across = math.exp(STRETCH * x) * np.sin(directions)
    return np.stack([np.outer(np.cos(directions), sizes), np.outer(across, sizes)], axis=2)


def source_table(forces: Callable[[float, Array], Array], numbers: Array) -> Array:
    """(n + 2, DIRECTIONS + 2, SPEEDS + 2, 2) coefficients of cubic B-splines through the forces of a film.

    forces: (eccentricity, (d, l, 2) velocities, the largest first) -> (d, l, 2) integrals of P (cos Theta, sin Theta)
    dz dTheta over one section. Tabulated are forces over |w| + L.
    """
    depths = [float(x) for x in depth_axis()]
    values = np.empty((len(depths), DIRECTIONS, SPEEDS, 2))
    for row, x in zip(values, depths, strict=True):
        at = forces(1.0 - math.exp(-x), table_velocities(x, numbers))
        row[:] = at[:, ::-1] / speed_axis(x, numbers)[:, None]
    return _along_all_axes(values, _coefficients)


def with_half_the_nodes(table: Array) -> Array:
    """The table of a film with splines through every other node of each axis, as a table of all of them: how far both
    are apart shows what its steps leave."""
    values = table
    for axis in range(3):
        values = np.moveaxis(values, axis, 0)
        values = np.moveaxis((values[:-2] + 4.0 * values[1:-1] + values[2:]) / 6.0, 0, axis)
    return _along_all_axes(_along_all_axes(values, _every_other), _coefficients)


def _along_all_axes(values: Array, of: Callable[[Array, int, Callable[[Array], None]], Array]) -> Array:
    """Apply a function of values, an axis and its end conditions along all axes of a table."""
    table = of(of(values, 0, _ends_free), 2, _ends_free)
    even, odd = of(table[..., :1], 1, _ends_even), of(table[..., 1:], 1, _ends_odd)
    return np.ascontiguousarray(np.concatenate([even, odd], axis=3))


def _every_other(values: Array, axis: int, ends: Callable[[Array], None]) -> Array:
    """Values between which every other one, from the last one on, is taken from the spline through the rest."""
    refined = np.moveaxis(values, axis, 0).copy()
    first = (len(refined) - 1) % 2
    c = _coefficients(refined[first::2], 0, ends)
    refined[first + 1 :: 2] = (c[:-3] + 23.0 * (c[1:-2] + c[2:-1]) + c[3:]) / 48.0
    return np.moveaxis(refined, 0, axis)


def _coefficients(values: Array, axis: int, ends: Callable[[Array], None]) -> Array:
    """Coefficients, two more than values along an axis, of the spline through them with these end conditions."""
    n = values.shape[axis]
    matrix = np.zeros((n + 2, n + 2))
    for i in range(n):
        matrix[i + 1, i : i + 3] = 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0
    ends(matrix)
    inverse = np.linalg.inv(matrix)[:, 1:-1]
    return np.moveaxis(np.tensordot(inverse, values, (1, axis)), 0, axis)


def _ends_free(matrix: Array) -> None:
    """The third derivative does not jump at the node next to an end."""
    matrix[0, :5] = matrix[-1, -5:] = 1.0, -4.0, 6.0, -4.0, 1.0


def _ends_even(matrix: Array) -> None:
    matrix[0, [0, 2]] = matrix[-1, [-1, -3]] = 1.0, -1.0


def _ends_odd(matrix: Array) -> None:
    matrix[0, [0, 2]] = matrix[-1, [-1, -3]] = 1.0, 1.0


@compiled()
def source_force(
    table: Array, numbers: Array, eccentricity: float, w_r: float, w_t: float, omega: float,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Force from source_table as table_force returns it: eight numbers. omega: omega_J + omega_S in rad/s."""
    rate = max(abs(omega), 1.0) if numbers[0, RELATIVE] != 0.0 else 1.0
    step_c = numbers[0, STEP]
    n_x, n_a, n_c = table.shape[0] - 2, table.shape[1] - 2, table.shape[2] - 2
    x = -math.log(1.0 - eccentricity)
    stretch, slow = math.exp(-STRETCH * x), numbers[0, SLOW] * math.exp(-SHRINK * x)
    u_r, u_t = w_r / rate, abs(w_t) * stretch / rate
    mirror = -1.0 if w_t < 0.0 else 1.0
    speed = math.sqrt(u_r * u_r + u_t * u_t)
    cosine, sine = (u_r / speed, u_t / speed) if speed > 0.0 else (1.0, 0.0)
    step_a = math.pi / (n_a - 1)
    a, b = x / DEPTH_STEP, math.atan2(u_t, u_r) / step_a
    root = (1.0 + speed / slow) ** -ROOT
    c = (root - 1.0) / step_c
    fast = c > n_c - 1.0  # beyond, the force is taken as proportional to |w| + L
    c = min(c, n_c - 1.0)
    i, j, k = min(int(a), n_x - 2), min(int(b), n_a - 2), min(int(c), n_c - 2)
    g_r, x_r, p_r, l_r, g_t, x_t, p_t, l_t = spline(table, i, j, k, a - i, b - j, c - k)
    size = speed + slow
    turned = size / max(speed, AT_REST * slow) / step_a
    p_r, p_t = turned * p_r, turned * p_t
    bend = 0.0 if fast else -ROOT * root / step_c
    o_r, o_t = g_r + bend * l_r, g_t + bend * l_t  # of (speed + L) g by speed
    by_u_r, by_u_t = o_r * sine + p_r * cosine, o_t * sine + p_t * cosine
    x_r = size * x_r / DEPTH_STEP - SHRINK * (slow * g_r - bend * speed * l_r)
    x_t = size * x_t / DEPTH_STEP - SHRINK * (slow * g_t - bend * speed * l_t)
    depth = rate / (1.0 - eccentricity)  # dx/deps
    return (
        rate * size * g_r,
        mirror * rate * size * g_t,
        o_r * cosine - p_r * sine,
        mirror * by_u_r * stretch,
        mirror * (o_t * cosine - p_t * sine),
        by_u_t * stretch,
        depth * (x_r - STRETCH * by_u_r * u_t),
        mirror * depth * (x_t - STRETCH * by_u_t * u_t),
    )


@compiled()
def _basis(s: float) -> tuple[float, float, float, float, float, float, float, float]:
    """The four cubic B-splines that are not zero at s in [0, 1], and their slopes."""
    r = 1.0 - s
    return (
        r * r * r / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        (4.0 - 6.0 * r * r + 3.0 * r * r * r) / 6.0,
        s * s * s / 6.0,
        -0.5 * r * r,
        0.5 * s * (3.0 * s - 4.0),
        0.5 * r * (4.0 - 3.0 * r),
        0.5 * s * s,
    )


@compiled()
def spline(
    table: Array, i: int, j: int, k: int, a: float, b: float, c: float,
) -> tuple[float, float, float, float, float, float, float, float]:  # fmt: skip
    """Both components, one after the other: value and derivatives by the three axes, in steps, at (a, b, c) in the
    cell (i, j, k)."""
    basis_a, basis_b = _basis(a), _basis(b)
    c0, c1, c2, c3, d0, d1, d2, d3 = _basis(c)
    v_r = x_r = p_r = l_r = v_t = x_t = p_t = l_t = 0.0
    for p in range(4):
        s_r = t_r = m_r = s_t = t_t = m_t = 0.0
        for q in range(4):
            y, z = i + p, j + q
            r_0, r_1, r_2, r_3 = table[y, z, k, 0], table[y, z, k + 1, 0], table[y, z, k + 2, 0], table[y, z, k + 3, 0]
            t_0, t_1, t_2, t_3 = table[y, z, k, 1], table[y, z, k + 1, 1], table[y, z, k + 2, 1], table[y, z, k + 3, 1]
            f_r, f_t = c0 * r_0 + c1 * r_1 + c2 * r_2 + c3 * r_3, c0 * t_0 + c1 * t_1 + c2 * t_2 + c3 * t_3
            w, u = basis_b[q], basis_b[q + 4]
            s_r += w * f_r
            t_r += u * f_r
            m_r += w * (d0 * r_0 + d1 * r_1 + d2 * r_2 + d3 * r_3)
            s_t += w * f_t
            t_t += u * f_t
            m_t += w * (d0 * t_0 + d1 * t_1 + d2 * t_2 + d3 * t_3)
        w, u = basis_a[p], basis_a[p + 4]
        v_r += w * s_r
        x_r += u * s_r
        p_r += w * t_r
        l_r += w * m_r
        v_t += w * s_t
        x_t += u * s_t
        p_t += w * t_t
        l_t += w * m_t
    return v_r, x_r, p_r, l_r, v_t, x_t, p_t, l_t


SETTLED = 2e-4  # of the largest pressure: a correction after which what is left is its square
PLAIN, DAMPING, LIMIT = 8, 0.5, 60  # iterations without damping; how it goes on from one to the next; all
# Layers of the states of the cells: pressure above p_cav and source, and their slopes by w.
ABOVE_CAVITY, SOURCE, RISE, FALL, LAYERS = range(5)
penalty_cell = compiled_cell(Penalty)


@compiled()
def _residual(stencil: Array, loads: Array, area: Array, v_r: float, v_t: float, cells: Array, right: Array) -> None:
    """The last layer of right (m, k, k + 1) <- minus what does not balance."""
    m, k = area.shape
    above = cells[ABOVE_CAVITY]
    for i in range(m):
        before, behind = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        for j in range(k):
            off = loads[0, i, j] + v_r * loads[1, i, j] + v_t * loads[2, i, j] - area[i, j] * cells[SOURCE, i, j]
            off += stencil[CENTRE, i, j] * above[i, j] + stencil[BEFORE, i, j] * above[before, j]
            off += stencil[BEHIND, i, j] * above[behind, j]
            if j > 0:
                off += stencil[BELOW, i, j] * above[i, j - 1]
            if j + 1 < k:
                off += stencil[ABOVE, i, j] * above[i, j + 1]
            right[i, j, k] = -off


@compiled()
def _matrix(stencil: Array, area: Array, cells: Array, damping: float, newton: Array) -> None:
    """newton (ENTRIES, m, k) <- Newton's matrix by w, which is kept back by the damping in 1/s."""
    m, k = area.shape
    rise = cells[RISE]
    for i in range(m):
        before, behind = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        for j in range(k):
            newton[CENTRE, i, j] = stencil[CENTRE, i, j] * rise[i, j] + area[i, j] * (damping - cells[FALL, i, j])
            newton[BEFORE, i, j] = stencil[BEFORE, i, j] * rise[before, j]
            newton[BEHIND, i, j] = stencil[BEHIND, i, j] * rise[behind, j]
            if j > 0:
                newton[BELOW, i, j] = stencil[BELOW, i, j] * rise[i, j - 1]
            if j + 1 < k:
                newton[ABOVE, i, j] = stencil[ABOVE, i, j] * rise[i, j + 1]


@compiled()
def _settle(
    law: Array, stencil: Array, loads: Array, area: Array, unit: float, velocity: tuple[float, float], w: Array,
    scratch: tuple[Array, Array, Array, Array],
) -> int:  # fmt: skip
    """w (m, k) <- unknowns, in units of `unit`, of the film that moves with the velocity; scratch: cells (LAYERS, m, k)
    <- its states, matrix, blocks and right sides of the equations. Returns the iterations, LIMIT if it has not
    settled."""
    m, k = w.shape
    v_r, v_t = velocity
    cells, newton, blocks, right = scratch
    parameters, scales = (law[0], law[1], law[2]), Scales(unit, 0.0, 0.0)
    speed = math.sqrt(v_r * v_r + v_t * v_t) + law[0]
    for iteration in range(LIMIT):
        largest, change = 0.0, 0.0
        for i in range(m):
            for j in range(k):
                p, _, q, p_w, _, q_w = penalty_cell(w[i, j], parameters, scales)
                change = max(change, abs(p - cells[ABOVE_CAVITY, i, j]))
                largest = max(largest, abs(p))
                cells[ABOVE_CAVITY, i, j], cells[SOURCE, i, j] = p, q
                cells[RISE, i, j], cells[FALL, i, j] = p_w, q_w
        if iteration > 0 and change < SETTLED * largest:
            return iteration
        _residual(stencil, loads, area, v_r, v_t, cells, right)
        _matrix(stencil, area, cells, speed * DAMPING ** (iteration - PLAIN) if iteration >= PLAIN else 0.0, newton)
        solve_blocks(newton, blocks, right, newton[0, 0], right[0, 0])
        for i in range(m):
            for j in range(k):
                w[i, j] += right[i, j, k]
    return LIMIT


@compiled(makes_arrays=True)
def row_forces(
    law: Array, unit: float, stencil: Array, loads: Array, area: Array, push: Array, width: Array,
    velocities: Array, forces: Array,
) -> int:  # fmt: skip
    """forces (d, l, 2) <- integrals of the pressure above p_cav for the velocities (d, l, 2).

    law: (3,) parameters of the penalty; unit: of w, next to the size of the velocity, 1/s; stencil, loads, area, push,
    width: of RowEquations. Along l velocities are best sorted by size, the largest first: each begins where the one
    before it has led. Returns the most iterations of one, LIMIT if it has not settled. """
    m, k = area.shape
    cells, newton = np.zeros((LAYERS, m, k)), np.zeros((ENTRIES, m, k))
    blocks, right = np.zeros((m, k, k)), np.zeros((m, k, k + 1))
    scratch = (cells, newton, blocks, right)
    w, begun, before = np.zeros((m, k)), np.zeros((m, k)), np.zeros((m, k))
    most = 0
    for a in range(velocities.shape[0]):
        for b in range(velocities.shape[1]):
            v_r, v_t = velocities[a, b, 0], velocities[a, b, 1]
            for i in range(m):
                for j in range(k):
                    now = w[i, j]
                    w[i, j] = begun[i, j] if b == 0 else now if b == 1 else 2.0 * now - before[i, j]
                    before[i, j] = now
            size = math.sqrt(v_r * v_r + v_t * v_t) + unit
            most = max(most, _settle(law, stencil, loads, area, size, (v_r, v_t), w, scratch))
            if b == 0:
                begun[:] = w
            f_r, f_t = 0.0, 0.0
            for i in range(m):
                p = 0.0
                for j in range(k):
                    p += width[j] * cells[ABOVE_CAVITY, i, j]
                f_r += push[0, i] * p
                f_t += push[1, i] * p
            forces[a, b, 0], forces[a, b, 1] = f_r, f_t
    return most
