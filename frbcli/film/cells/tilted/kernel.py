"""The oil balances of the cells of a land whose gap changes along the axis, with all derivatives, compiled.

They are those of balance/balances.py at a gap that is linear in z: see there for the flows. The plain form is the same,
balance/plain.py. Derivatives are by the velocities of the journal at both ends of its bearing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.compiled import Array, compiled
from frbcli.film.cells.balance.balances import (
    FLOWS,
    end_flow,
    falls_to_air,
    hold_given,
    leave,
    section_end,
    take,
)
from frbcli.film.cells.balance.carried import carried_at
from frbcli.film.cells.balance.ends import STEEPNESS
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    FRACTION,
    FRACTION_SLOPE,
    PRESSURE,
    PRESSURE_SLOPE,
    SOURCE,
    SOURCE_SLOPE,
)
from frbcli.film.cells.data import (
    ALONG,
    AREA,
    AROUND,
    BATHED,
    CLOSED,
    COS,
    EDGE,
    EDGE_COS,
    EDGE_GAP,
    EDGE_SIN,
    EXCESS,
    FACE_COS,
    FACE_GAP,
    FACE_SIN,
    FREE,
    GAP,
    LENGTH,
    SHARE,
    SIN,
    UNKNOWN,
)
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE
from frbcli.film.cells.tilted.data import EDGES, MIDDLES, WIDTHS

# The right-hand sides: its own, and by the velocities of the coordinates of data.py.
BY_ITSELF, BY_ENDS = range(2)
ALL_SIDES = 5


class EndsMotion(NamedTuple):
    """d, v: (4,) coordinates of the journal, see data.py, and their rates in 1/s; omega: omega_J + omega_S relative to
    the grid; g, rate: see GridMotion."""

    d: Array
    v: Array
    omega: float
    g: float
    rate: float


@compiled(inline=True)
def gap_at_ends(gap: float, s: float, c: float, d: Array) -> tuple[float, float]:
    """H at the near end of the bearing, and by how much more it is at the far one, from that of a centred journal and
    sine and cosine of the angle."""
    near = gap + d[0] * s - d[1] * c
    return near, gap + d[2] * s - d[3] * c - near


@compiled(inline=True)
def add_by_ends(right: Array, i: int, j: int, z: float, by_x: float, by_y: float) -> None:
    """Add what changes with the velocity at the place z along the axis, to the sides by those at the ends."""
    first = right.shape[1] + BY_ENDS
    far_x, far_y = z * by_x, z * by_y
    right[i, j, first] += by_x - far_x
    right[i, j, first + 1] += by_y - far_y
    right[i, j, first + 2] += far_x
    right[i, j, first + 3] += far_y


@compiled()
def _flow_around(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, stencil: Array,
    right: Array, flows: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, omega, g = motion.d, motion.omega, motion.g
    bored, half, forward, taken = film.bored, 0.5 * omega, omega >= 0.0, 0.0
    for i in range(m):
        n = i + 1 if i + 1 < m else 0
        s, c = ring[FACE_SIN, i], ring[FACE_COS, i]
        near, rise = gap_at_ends(ring[FACE_GAP, i], s, c, d)
        s_i, c_i, s_n, c_n = ring[SIN, i], ring[COS, i], ring[SIN, n], ring[COS, n]
        near_i, rise_i = gap_at_ends(ring[GAP, i], s_i, c_i, d)
        near_n, rise_n = gap_at_ends(ring[GAP, n], s_n, c_n, d)
        for j in range(k):  # through the face after the cell
            z, open_, carried = places[MIDDLES, j], cells[AROUND, i, j], half * places[WIDTHS, j]
            h = near + z * rise
            square = h * h * open_
            through, by_x, by_y = h * square, 3.0 * square * s, -3.0 * square * c
            if bored:
                h_i, h_n = near_i + z * rise_i, near_n + z * rise_n
                through = open_ * h_i * h * h_n
                by_x = open_ * (s_i * h * h_n + h_i * s * h_n + h_i * h * s_n)
                by_y = -open_ * (c_i * h * h_n + h_i * c * h_n + h_i * h * c_n)
            if cells[EDGE, i, j] != 0.0:
                at_s, at_c = cells[EDGE_SIN, i, j], cells[EDGE_COS, i, j]
                at_near, at_rise = gap_at_ends(cells[EDGE_GAP, i, j], at_s, at_c, d)
                at = at_near + z * at_rise
                square = at * at * cells[EDGE, i, j]
                through, by_x, by_y = at * square, 3.0 * square * at_s, -3.0 * square * at_c
            share, share_n = cells[SHARE, i, j], cells[SHARE, n, j]
            theta, here, next_ = carried_at(
                states[FRACTION, i, j], states[FRACTION, n, j], states[BEFORE_UPSTREAM, i, j], forward
            )
            fall = states[PRESSURE, i, j] - states[PRESSURE, n, j]
            pressed, drawn = through * fall, carried * h * theta
            own = carried * h * here * states[FRACTION_SLOPE, i, j]
            other = carried * h * next_ * states[FRACTION_SLOPE, n, j]
            by_own, by_next = through * states[PRESSURE_SLOPE, i, j], through * states[PRESSURE_SLOPE, n, j]
            taken += (share - share_n) * drawn
            right[i, j, k + BY_ITSELF] -= pressed + share * drawn
            right[n, j, k + BY_ITSELF] += pressed + share_n * drawn
            by_x, by_y = g * by_x * fall, g * by_y * fall
            drawn_x, drawn_y = g * carried * theta * s, -g * carried * theta * c
            right[i, j, k + BY_ENDS] -= by_x + share * drawn_x
            right[n, j, k + BY_ENDS] += by_x + share_n * drawn_x
            right[i, j, k + BY_ENDS + 1] -= by_y + share * drawn_y
            right[n, j, k + BY_ENDS + 1] += by_y + share_n * drawn_y
            stencil[CENTRE, i, j] += by_own + share * own
            stencil[BEHIND, i, j] += share * other - by_next
            stencil[CENTRE, n, j] += by_next - share_n * other
            stencil[BEFORE, n, j] -= by_own + share_n * own
    take(taken, flows)


@compiled()
def _carry_out_of_excess(
    ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, stencil: Array, right: Array,
    flows: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, g, half, taken = motion.d, motion.g, 0.5 * motion.omega, 0.0
    for i in range(m):
        b = i - 1 if i > 0 else m - 1
        s, c = half * (ring[FACE_SIN, i] - ring[FACE_SIN, b]), half * (ring[FACE_COS, i] - ring[FACE_COS, b])
        near, rise = gap_at_ends(half * (ring[FACE_GAP, i] - ring[FACE_GAP, b]), s, c, d)
        for j in range(k):
            excess, z = cells[EXCESS, i, j], places[MIDDLES, j]
            if excess != 0.0:
                oil, grows = excess * states[FRACTION, i, j], near + z * rise
                taken += oil * grows
                right[i, j, k + BY_ITSELF] -= oil * grows
                right[i, j, k + BY_ENDS] -= g * oil * s
                right[i, j, k + BY_ENDS + 1] += g * oil * c
                stencil[CENTRE, i, j] += excess * grows * states[FRACTION_SLOPE, i, j]
    take(taken, flows)


@compiled()
def _share_between_ends(places: Array, right: Array) -> None:
    """What changes with the velocity in the middle of each cell, by x and y in the first two of the sides by the ends,
    to these."""
    m, k = right.shape[0], right.shape[1]
    for i in range(m):
        for j in range(k):
            z, first = places[MIDDLES, j], k + BY_ENDS
            far_x, far_y = z * right[i, j, first], z * right[i, j, first + 1]
            right[i, j, first] -= far_x
            right[i, j, first + 1] -= far_y
            right[i, j, first + 2], right[i, j, first + 3] = far_x, far_y


@compiled()
def _flow_along(
    ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, stencil: Array, right: Array
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, g = motion.d, motion.g
    for i in range(m):
        s, c = ring[SIN, i], ring[COS, i]
        near, rise = gap_at_ends(ring[GAP, i], s, c, d)
        for j in range(k - 1):  # to the cell above
            z = places[EDGES, j + 1]
            h = near + z * rise
            square = h * h * cells[ALONG, i, j]
            fall = states[PRESSURE, i, j] - states[PRESSURE, i, j + 1]
            flow, by_gap = h * square * fall, 3.0 * g * square * fall
            low, high = h * square * states[PRESSURE_SLOPE, i, j], h * square * states[PRESSURE_SLOPE, i, j + 1]
            right[i, j, k + BY_ITSELF] -= flow
            right[i, j + 1, k + BY_ITSELF] += flow
            add_by_ends(right, i, j, z, -by_gap * s, by_gap * c)
            add_by_ends(right, i, j + 1, z, by_gap * s, -by_gap * c)
            stencil[CENTRE, i, j] += low
            stencil[ABOVE, i, j] -= high
            stencil[CENTRE, i, j + 1] += high
            stencil[BELOW, i, j + 1] -= low


@compiled()
def _store(
    ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, past: Array, stencil: Array,
    right: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, v, _, g, rate = motion
    for i in range(m):
        s, c = ring[SIN, i], ring[COS, i]
        near, rise = gap_at_ends(ring[GAP, i], s, c, d)
        opens, rises = gap_at_ends(0.0, s, c, v)
        for j in range(k):
            if cells[UNKNOWN, i, j] == 0.0:
                continue
            area, theta, z = cells[AREA, i, j], states[FRACTION, i, j], places[MIDDLES, j]
            factor = rate * (near + z * rise) if rate != 0.0 else opens + z * rises
            by_gap = area * theta * (g * rate if rate != 0.0 else 1.0)
            right[i, j, k + BY_ITSELF] -= area * (factor * theta - past[i, j] - states[SOURCE, i, j])
            right[i, j, k + BY_ENDS] -= by_gap * s
            right[i, j, k + BY_ENDS + 1] += by_gap * c
            stencil[CENTRE, i, j] += area * (factor * states[FRACTION_SLOPE, i, j] - states[SOURCE_SLOPE, i, j])


@compiled(makes_arrays=True)
def _flow_through_ends(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, stencil: Array,
    right: Array, flows: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, g = motion.d, motion.g
    steepness, falls = STEEPNESS / film.scales.ambient, np.empty(m)
    for far in (False, True):
        kind, j, b, slope, bend = section_end(film, k, far)
        if kind == CLOSED:
            continue
        groove, z = film.far.pressure if far else 0.0, places[EDGES, k if far else 0]
        if kind == FREE:
            d_x, d_y = d[0] + z * (d[2] - d[0]), d[1] + z * (d[3] - d[1])
            falls_to_air(film, ring, states[PRESSURE], d_x, d_y, far, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] == 0.0:
                continue
            s, c = ring[SIN, i], ring[COS, i]
            near, rise = gap_at_ends(ring[GAP, i], s, c, d)
            h, unit = near + z * rise, film.aspect * ring[LENGTH, i] * slope
            flow, by_last, by_beyond, by_conductance = end_flow(
                kind,
                states[PRESSURE, i, j],
                states[PRESSURE, i, b],
                h * h * h * unit,
                bend,
                groove,
                steepness,
                falls[i],
                ring[BATHED, i],
            )
            by_gap = 3.0 * g * by_conductance * h * h * unit
            right[i, j, k + BY_ITSELF] -= flow
            add_by_ends(right, i, j, z, -by_gap * s, by_gap * c)
            stencil[CENTRE, i, j] += by_last * states[PRESSURE_SLOPE, i, j]
            if b > j:
                stencil[ABOVE, i, j] += by_beyond * states[PRESSURE_SLOPE, i, b]
            elif b < j:
                stencil[BELOW, i, j] += by_beyond * states[PRESSURE_SLOPE, i, b]
            leave(kind, flow, flows)


@compiled()
def land_balances(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, past: Array,
    stencil: Array, right: Array, flows: Array,
) -> None:  # fmt: skip
    """The balances of the cells of a land and their derivatives, see `balances`. right: (m, k, k + ALL_SIDES)."""
    m, k = past.shape
    for i in range(m):
        for j in range(k):
            for entry in range(5):
                stencil[entry, i, j] = 0.0
            for side in range(ALL_SIDES):
                right[i, j, k + side] = 0.0
    for flow in range(FLOWS):
        flows[flow] = 0.0
    _flow_around(film, ring, cells, places, states, motion, stencil, right, flows)
    if film.bored:
        _carry_out_of_excess(ring, cells, places, states, motion, stencil, right, flows)
    _store(ring, cells, places, states, motion, past, stencil, right)
    _share_between_ends(places, right)
    _flow_along(ring, cells, places, states, motion, stencil, right)
    _flow_through_ends(film, ring, cells, places, states, motion, stencil, right, flows)
    hold_given(cells, stencil, right, flows, ALL_SIDES)
