"""Forces of a pressure that is clipped at p_cav between the middles of cells, compiled; see plain/clipped.py."""

from __future__ import annotations

from frbcli.compiled import Array, compiled
from frbcli.film.cells.data import CAVITY, LOAD, PUSH_X, PUSH_Y
from frbcli.film.cells.plain.clipped import CURVED
from frbcli.film.cells.states import PRESSURE, PRESSURE_SLOPE


@compiled()
def _rise(p: float, n: float, s: float) -> tuple[float, float, float, float, float, float, float, float]:
    """For p > 0 >= n and S: what counts in the cell of p and in that of n, and their derivatives by p, n and S."""
    size = p - n
    x = p / size
    y = x * x * (3.0 - 2.0 * x)
    by_p, by_n = -n / (size * size), p / (size * size)
    turn = 6.0 * x * (1.0 - x) * CURVED * s
    own, other = CURVED * y * (1.0 - 0.5 * y), 0.5 * CURVED * y * y
    return (
        0.5 * x * p - own * s, -other * s,
        0.5 * (x + p * by_p) - (1.0 - y) * turn * by_p, 0.5 * p * by_n - (1.0 - y) * turn * by_n, -own,
        -y * turn * by_p, -y * turn * by_n, -other,
    )  # fmt: skip


@compiled()
def clipped_push(
    numbers: Array, ring: Array, cells: Array, states: Array, fields: Array, one: int, other: int
) -> tuple[float, float, float, float, float, float]:
    """Force (x, y) over the film's scale after its own change in fields (m, k, k + SIDES), see film_loads, and its
    derivatives by what two layers of fields are changes with: (x, y) of one, (x, y) of the other."""
    m, k = states.shape[1], states.shape[2]
    cavity = numbers[CAVITY]
    f_x, f_y, one_x, one_y, other_x, other_y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(m):
        b, n = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        z = n + 1 if n + 1 < m else 0
        full, here, after, one_here, one_after, other_here, other_after = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(k):
            at, behind = cells[LOAD, i, j], cells[LOAD, n, j]
            by_i, by_n = states[PRESSURE_SLOPE, i, j], states[PRESSURE_SLOPE, n, j]
            full += at
            p = states[PRESSURE, i, j] + by_i * fields[i, j, k] - cavity
            q = states[PRESSURE, n, j] + by_n * fields[n, j, k] - cavity
            if not (p > 0.0 or q > 0.0):
                continue
            by_b, by_z = states[PRESSURE_SLOPE, b, j], states[PRESSURE_SLOPE, z, j]
            s = states[PRESSURE, b, j] + by_b * fields[b, j, k] + states[PRESSURE, z, j] + by_z * fields[z, j, k]
            s -= p + q + 2.0 * cavity
            a_p, a_q, a_s, c_p, c_q, c_s = 0.5, 0.0, -0.5 * CURVED, 0.0, 0.5, -0.5 * CURVED
            if q <= 0.0:
                to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = _rise(p, q, s)
            elif p <= 0.0:
                to_q, to_p, c_q, c_p, c_s, a_q, a_p, a_s = _rise(q, p, s)
            else:
                to_p, to_q = a_p * p + a_s * s, c_q * q + c_s * s
            here += at * to_p
            after += behind * to_q
            d_p, d_q = by_i * fields[i, j, one], by_n * fields[n, j, one]
            d_s = by_b * fields[b, j, one] + by_z * fields[z, j, one] - d_p - d_q
            one_here += at * (a_p * d_p + a_q * d_q + a_s * d_s)
            one_after += behind * (c_p * d_p + c_q * d_q + c_s * d_s)
            d_p, d_q = by_i * fields[i, j, other], by_n * fields[n, j, other]
            d_s = by_b * fields[b, j, other] + by_z * fields[z, j, other] - d_p - d_q
            other_here += at * (a_p * d_p + a_q * d_q + a_s * d_s)
            other_after += behind * (c_p * d_p + c_q * d_q + c_s * d_s)
        x, y, next_x, next_y = ring[PUSH_X, i], ring[PUSH_Y, i], ring[PUSH_X, n], ring[PUSH_Y, n]
        f_x += x * (full * cavity + here) + next_x * after
        f_y += y * (full * cavity + here) + next_y * after
        one_x += x * one_here + next_x * one_after
        one_y += y * one_here + next_y * one_after
        other_x += x * other_here + next_x * other_after
        other_y += y * other_here + next_y * other_after
    return f_x, f_y, one_x, one_y, other_x, other_y
