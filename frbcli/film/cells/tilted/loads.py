"""Forces at both ends of a bearing by the pressures of a land, with derivatives, compiled.

They do the same virtual work as the pressures on a journal that moves and tilts: a pressure at the place z along the
axis pushes with the share z at the far end, and with the rest at the near one.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.clipped import shared
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE
from frbcli.film.cells.data import BETWEEN_MIDDLES, LOAD, NO_CLIP, PUSH_X, PUSH_Y
from frbcli.film.cells.tilted.data import MIDDLES
from frbcli.film.cells.tilted.kernel import BY_ENDS, BY_ITSELF


@compiled()
def _pressed(film: np.record, ring: Array, cells: Array, states: Array, fields: Array, push: Array) -> None:
    """push[2] (m, k) <- pressures of the cells as forces take them, times their weights; push[:2] <- by what forces
    along x and y change with each."""
    m, k = states.shape[1], states.shape[2]
    cavity, clips = film.scales.cavitation, film.clips != NO_CLIP
    for i in range(m):
        for j in range(k):
            here = states[PRESSURE, i, j] + states[PRESSURE_SLOPE, i, j] * fields[i, j, k + BY_ITSELF]
            counts = not clips or here >= cavity
            push[2, i, j] = cells[LOAD, i, j] * (here if counts else cavity)
            push[0, i, j] = ring[PUSH_X, i] * cells[LOAD, i, j] if counts else 0.0
            push[1, i, j] = ring[PUSH_Y, i] * cells[LOAD, i, j] if counts else 0.0


@compiled()
def _pressed_between(film: np.record, ring: Array, cells: Array, states: Array, fields: Array, push: Array) -> None:
    """_pressed of a pressure that is clipped between the middles of cells, see clipped_push."""
    m, k = states.shape[1], states.shape[2]
    cavity = film.scales.cavitation
    for i in range(m):
        for j in range(k):
            own = states[PRESSURE_SLOPE, i, j] * fields[i, j, k + BY_ITSELF]
            push[3, i, j] = states[PRESSURE, i, j] + own - cavity
            push[0, i, j] = push[1, i, j] = 0.0
            push[2, i, j] = cells[LOAD, i, j] * cavity
    for i in range(m):
        before, n = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        after = n + 1 if n + 1 < m else 0
        for j in range(k):
            p, q = push[3, i, j], push[3, n, j]
            if p <= 0.0 and q <= 0.0:
                continue
            s = push[3, before, j] + push[3, after, j] - p - q
            to_p, to_q, a_p, a_q, a_s, c_p, c_q, c_s = shared(p, q, s)
            at, behind = cells[LOAD, i, j], cells[LOAD, n, j]
            push[2, i, j] += at * to_p
            push[2, n, j] += behind * to_q
            for side in range(2):
                here, there = at * ring[PUSH_X + side, i], behind * ring[PUSH_X + side, n]
                by_s = here * a_s + there * c_s
                push[side, i, j] += here * a_p + there * c_p - by_s
                push[side, n, j] += here * a_q + there * c_q - by_s
                push[side, before, j] += by_s
                push[side, after, j] += by_s


@compiled()
def land_loads(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, fields: Array, push: Array,
    loads: Array, slopes: Array,
) -> None:  # fmt: skip
    """loads (4,) <- of the land in N after the film's own change in fields (m, k, k + ALL_SIDES), see data.py for their
    order; slopes (4, 4) <- their derivatives by the rates of the coordinates in N s. push: (4, m, k) to work in."""
    m, k = states.shape[1], states.shape[2]
    if film.clips == BETWEEN_MIDDLES:
        _pressed_between(film, ring, cells, states, fields, push)
    else:
        _pressed(film, ring, cells, states, fields, push)
    first = k + BY_ENDS
    for a in range(4):
        loads[a] = 0.0
        for b in range(4):
            slopes[a, b] = 0.0
    for j in range(k):  # sums of a circumference stay in registers
        x, y, x_0, x_1, x_2, x_3, y_0, y_1, y_2, y_3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(m):
            slope, p = states[PRESSURE_SLOPE, i, j], push[2, i, j]
            x += ring[PUSH_X, i] * p
            y += ring[PUSH_Y, i] * p
            by_x, by_y = slope * push[0, i, j], slope * push[1, i, j]
            u_0, u_1 = fields[i, j, first], fields[i, j, first + 1]
            u_2, u_3 = fields[i, j, first + 2], fields[i, j, first + 3]
            x_0, x_1, x_2, x_3 = x_0 + by_x * u_0, x_1 + by_x * u_1, x_2 + by_x * u_2, x_3 + by_x * u_3
            y_0, y_1, y_2, y_3 = y_0 + by_y * u_0, y_1 + by_y * u_1, y_2 + by_y * u_2, y_3 + by_y * u_3
        near, far = film.force_scale * (1.0 - places[MIDDLES, j]), film.force_scale * places[MIDDLES, j]
        for a, share in ((0, near), (2, far)):
            loads[a] += share * x
            loads[a + 1] += share * y
            slopes[a, 0] += share * x_0
            slopes[a, 1] += share * x_1
            slopes[a, 2] += share * x_2
            slopes[a, 3] += share * x_3
            slopes[a + 1, 0] += share * y_0
            slopes[a + 1, 1] += share * y_1
            slopes[a + 1, 2] += share * y_2
            slopes[a + 1, 3] += share * y_3
