"""Forces of a pressure that is clipped at p_cav between the middles of cells, compiled; see plain_clipped.py."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.plain_clipped import CURVED
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE
from frbcli.film.cells.data import LOAD, PUSH_X, PUSH_Y


@compiled()
def rise(p: float, n: float, s: float) -> tuple[float, float, float, float, float, float, float, float]:
    """Shares that count in the cells of p and of n, p > 0 >= n, and their derivatives by p, n and S.

    The derivatives of x are (1 - x) and x over p - n. They enter with p or S, which over p - n are of usual size even
    in a film that begins at 1e-314 Pa, the square of which is nothing.
    """
    size = p - n
    x = p / size
    y = x * x * (3.0 - 2.0 * x)
    turn = 6.0 * x * (1.0 - x) * CURVED * (s / size)
    own, other = CURVED * y * (1.0 - 0.5 * y), 0.5 * CURVED * y * y
    return (
        0.5 * x * p - own * s, -other * s,
        0.5 * x * (2.0 - x) - (1.0 - y) * turn * (1.0 - x), 0.5 * x * x - (1.0 - y) * turn * x, -own,
        -y * turn * (1.0 - x), -y * turn * x, -other,
    )  # fmt: skip


@compiled(inline=True)
def shared(p: float, q: float, s: float) -> tuple[float, float, float, float, float, float, float, float]:
    """Shares that count in the cells of p and of q, one of which at least is positive, and their derivatives by p, q
    and S."""
    a_p, a_q, a_s, c_p, c_q, c_s = 0.5, 0.0, -0.5 * CURVED, 0.0, 0.5, -0.5 * CURVED
    if q <= 0.0:
        to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = rise(p, q, s)
    elif p <= 0.0:
        to_q, to_p, c_q, c_p, c_s, a_q, a_p, a_s = rise(q, p, s)
    else:
        to_p, to_q = a_p * p + a_s * s, c_q * q + c_s * s
    return to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s


@compiled()
def _above(
    cavity: float, states: Array, fields: Array, i: int, j: int, one: int, other: int
) -> tuple[float, float, float]:
    """Pressure of a cell above p_cav after its own change in fields, and what it changes with by two layers of them."""
    slope = states[PRESSURE_SLOPE, i, j]
    own = states[PRESSURE, i, j] + slope * fields[i, j, states.shape[2]] - cavity
    return own, slope * fields[i, j, one], slope * fields[i, j, other]


@compiled()
def clipped_push(
    film: np.record, ring: Array, cells: Array, states: Array, fields: Array, one: int, other: int
) -> tuple[float, float, float, float, float, float]:
    """Force (x, y) over the film's scale after its own change in fields (m, k, k + SIDES), see film_loads, and its
    derivatives by what two layers of fields are changes with: (x, y) of one, (x, y) of the other."""
    m, k = states.shape[1], states.shape[2]
    cavity = film.scales.cavitation
    f_x, f_y, one_x, one_y, other_x, other_y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(k):  # four cells in a row: b, p, q, z
        b, one_b, other_b = _above(cavity, states, fields, m - 1, j, one, other)
        p, one_p, other_p = _above(cavity, states, fields, 0, j, one, other)
        q, one_q, other_q = _above(cavity, states, fields, 1, j, one, other)
        for i in range(m):
            n = i + 1 if i + 1 < m else 0
            z, one_z, other_z = _above(cavity, states, fields, n + 1 if n + 1 < m else 0, j, one, other)
            at, behind = cells[LOAD, i, j], cells[LOAD, n, j]
            f_x += ring[PUSH_X, i] * at * cavity
            f_y += ring[PUSH_Y, i] * at * cavity
            if p > 0.0 or q > 0.0:
                s = b + z - p - q
                to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = shared(p, q, s)
                at_x, at_y = at * ring[PUSH_X, i], at * ring[PUSH_Y, i]
                behind_x, behind_y = behind * ring[PUSH_X, n], behind * ring[PUSH_Y, n]
                f_x += at_x * to_p + behind_x * to_q
                f_y += at_y * to_p + behind_y * to_q
                by_p, by_q = at_x * a_p + behind_x * c_p, at_x * a_q + behind_x * c_q
                by_s = at_x * a_s + behind_x * c_s
                one_x += by_p * one_p + by_q * one_q + by_s * (one_b + one_z - one_p - one_q)
                other_x += by_p * other_p + by_q * other_q + by_s * (other_b + other_z - other_p - other_q)
                by_p, by_q = at_y * a_p + behind_y * c_p, at_y * a_q + behind_y * c_q
                by_s = at_y * a_s + behind_y * c_s
                one_y += by_p * one_p + by_q * one_q + by_s * (one_b + one_z - one_p - one_q)
                other_y += by_p * other_p + by_q * other_q + by_s * (other_b + other_z - other_p - other_q)
            b, one_b, other_b = p, one_p, other_p
            p, one_p, other_p = q, one_q, other_q
            q, one_q, other_q = z, one_z, other_z
    return f_x, f_y, one_x, one_y, other_x, other_y
