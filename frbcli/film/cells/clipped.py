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
    numbers: Array, ring: Array, cells: Array, states: Array, fields: Array, layer: int
) -> tuple[float, float, float, float]:
    """Force (x, y) over the film's scale after its own change in fields (m, k, k + SIDES), see film_loads, and its
    derivative by what the layer of fields is a change with."""
    m, k = states.shape[1], states.shape[2]
    cavity = numbers[CAVITY]
    f_x, f_y, by_x, by_y = 0.0, 0.0, 0.0, 0.0
    for i in range(m):
        b, n, z = (i - 1) % m, (i + 1) % m, (i + 2) % m
        for j in range(k):
            here_x, here_y = ring[PUSH_X, i] * cells[LOAD, i, j], ring[PUSH_Y, i] * cells[LOAD, i, j]
            next_x, next_y = ring[PUSH_X, n] * cells[LOAD, n, j], ring[PUSH_Y, n] * cells[LOAD, n, j]
            f_x += here_x * cavity
            f_y += here_y * cavity
            p = states[PRESSURE, i, j] + states[PRESSURE_SLOPE, i, j] * fields[i, j, k] - cavity
            q = states[PRESSURE, n, j] + states[PRESSURE_SLOPE, n, j] * fields[n, j, k] - cavity
            if not (p > 0.0 or q > 0.0):
                continue
            s = states[PRESSURE, b, j] + states[PRESSURE_SLOPE, b, j] * fields[b, j, k] - p - q - cavity
            s += states[PRESSURE, z, j] + states[PRESSURE_SLOPE, z, j] * fields[z, j, k] - cavity
            d_p = states[PRESSURE_SLOPE, i, j] * fields[i, j, layer]
            d_q = states[PRESSURE_SLOPE, n, j] * fields[n, j, layer]
            d_s = states[PRESSURE_SLOPE, b, j] * fields[b, j, layer] - d_p - d_q
            d_s += states[PRESSURE_SLOPE, z, j] * fields[z, j, layer]
            if p > 0.0 and q > 0.0:
                here, after = 0.5 * (p - CURVED * s), 0.5 * (q - CURVED * s)
                d_here, d_after = 0.5 * (d_p - CURVED * d_s), 0.5 * (d_q - CURVED * d_s)
            elif p > 0.0:
                here, after, a_p, a_q, a_s, c_p, c_q, c_s = _rise(p, q, s)
                d_here, d_after = a_p * d_p + a_q * d_q + a_s * d_s, c_p * d_p + c_q * d_q + c_s * d_s
            else:
                after, here, a_q, a_p, a_s, c_q, c_p, c_s = _rise(q, p, s)
                d_after, d_here = a_p * d_p + a_q * d_q + a_s * d_s, c_p * d_p + c_q * d_q + c_s * d_s
            f_x += here_x * here + next_x * after
            f_y += here_y * here + next_y * after
            by_x += here_x * d_here + next_x * d_after
            by_y += here_y * d_here + next_y * d_after
    return f_x, f_y, by_x, by_y
