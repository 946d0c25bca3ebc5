"""The oil balances of the cells of a land whose gap changes along the axis, with all derivatives, compiled.

They equal the balances of balance/balances.py, which describes the flows, at a gap that is linear in z. The plain form
is the same, balance/plain.py. Derivatives are by the velocities of the journal at both ends of its bearing. """

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import (
    FLOWS,
    end_flow,
    falls_to_air,
    hold_given,
    leave,
    section_end,
    take,
)
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
from frbcli.film.cells.tilted.faces import (
    FaceFlows,
    OwnAndNext,
    Sloped,
    StencilRows,
    balanced,
    coupled,
    drawn,
    pressed,
    stored,
    total,
)

# The right-hand sides: its own, and by the velocities of the coordinates of data.py.
BY_ITSELF, BY_ENDS = range(2)
ALL_SIDES = 5
COLUMNS = 8  # that are balanced at a time: what they pass to each other stays near the processor
# Of these columns, one cell after the other, a column behind: FaceFlows around by pressures and by the surfaces, then
# those along, which are 0 into a column.
PRESSED, DRAWN, RAISED, FLOW_ROWS = range(0, 16, 4)
RAISED_BY_GAP = RAISED + 3
# Not behind: gaps at the faces after the cells, in their middles next to bores and at their edges above; what a cell
# stores per oil fraction; flow that is drawn through a gap of 1; the balance; and by the gaps what is stored, what
# leaves a cell around, and what enters it.
(
    FACE,
    MIDDLE,
    EDGE_ABOVE,
    FACTOR,
    PULL,
    LEFT,
    STORED_BY_GAP,
    OUT_BY_GAP,
    IN_BY_GAP,
    ROWS,
) = range(FLOW_ROWS, FLOW_ROWS + 10)


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
    """H at the near end of the bearing, and by how much more it is at the far one, from the gap of a centred journal
    and sine and cosine of the angle."""
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
def _meet_gaps(
    ring: Array, places: Array, motion: EndsMotion, bored: bool, first: int, last: int, k: int, rows: Array
) -> None:
    """Gaps in the columns from first to last into rows, and by what their cells store oil."""
    m, row = ring.shape[1], 0
    d, v, omega, _, rate = motion
    for i in range(first, last):
        s, c = ring[SIN, i], ring[COS, i]
        near, rise = gap_at_ends(ring[GAP, i], s, c, d)
        near_face, rise_face = gap_at_ends(ring[FACE_GAP, i], ring[FACE_SIN, i], ring[FACE_COS, i], d)
        kept, kept_rise = rate * near, rate * rise
        if rate == 0.0:
            kept, kept_rise = gap_at_ends(0.0, s, c, v)
        for j in range(k):
            z = places[MIDDLES, j]
            rows[FACE, row + j] = near_face + z * rise_face
            rows[EDGE_ABOVE, row + j] = near + places[EDGES, j + 1] * rise
            rows[FACTOR, row + j] = kept + z * kept_rise
            rows[PULL, row + j] = 0.5 * omega * places[WIDTHS, j]
        row += k
    if bored:  # flows take the gaps in the middles of both cells, too
        for column in range(first, last + 1):
            i, row = column % m, (column - first) * k
            near, rise = gap_at_ends(ring[GAP, i], ring[SIN, i], ring[COS, i], d)
            for j in range(k):
                rows[MIDDLE, row + j] = near + places[MIDDLES, j] * rise


@compiled(inline=True, internal=True)
def _flows_in(rows: Array, first: int, where: slice) -> FaceFlows:
    """The flows in rows from the row `first` on."""
    return FaceFlows(rows[first, where], rows[first + 1, where], rows[first + 2, where], rows[first + 3, where])


@compiled()
def _flow_around(
    bored: bool, cells: Array, states: Array, motion: EndsMotion, first: int, last: int, k: int, at: int, rows: Array
) -> float:
    """Flows from the columns first to last to the next ones into rows, which hold the gaps from `at` on and the flows
    one column later; returns what openings take of them. The column before the very first is on its own."""
    behind = last % (cells.shape[1] // k) if last == first + 1 else first + 1
    own, next_ = slice(first * k, last * k), slice(behind * k, (behind + last - first) * k)
    by, to = slice(at, at + (last - first) * k), slice(at + k, at + (last - first + 1) * k)
    g, gaps, others, growth = motion.g, rows[FACE, by], OwnAndNext(rows[FACE, by], rows[FACE, by]), 3.0 * motion.g
    if bored:
        others, growth = OwnAndNext(rows[MIDDLE, by], rows[MIDDLE, to]), g
    pressed(
        cells[AROUND, own], gaps, others, growth, OwnAndNext(states[PRESSURE, own], states[PRESSURE, next_]),
        OwnAndNext(states[PRESSURE_SLOPE, own], states[PRESSURE_SLOPE, next_]), _flows_in(rows, PRESSED, to),
    )  # fmt: skip
    outflow: float = drawn(
        gaps, rows[PULL, by], motion.omega >= 0.0, g, OwnAndNext(states[FRACTION, own], states[FRACTION, next_]),
        states[BEFORE_UPSTREAM, own], OwnAndNext(states[FRACTION_SLOPE, own], states[FRACTION_SLOPE, next_]),
        OwnAndNext(cells[SHARE, own], cells[SHARE, next_]), _flows_in(rows, DRAWN, to),
    )  # fmt: skip
    return outflow


@compiled()
def _balance(
    cells: Array, states: Array, motion: EndsMotion, past: Array, first: int, last: int, k: int, rows: Array,
    stencil: Array,
) -> None:  # fmt: skip
    """The balances of the columns first to last without flows through ends, and the entries of the stencil."""
    n, g, rate = (last - first) * k, motion.g, motion.rate
    own, here, there, below = slice(first * k, last * k), slice(0, n), slice(k, n + k), slice(k - 1, n + k - 1)
    share, centre, left = cells[SHARE, own], stencil[CENTRE, own], rows[LEFT, here]
    stored(
        cells[AREA, own], cells[UNKNOWN, own], rows[FACTOR, here], g * rate if rate != 0.0 else 1.0, past[own],
        Sloped(states[FRACTION, own], states[FRACTION_SLOPE, own]),
        Sloped(states[SOURCE, own], states[SOURCE_SLOPE, own]), left, centre, rows[STORED_BY_GAP, here],
    )  # fmt: skip
    # The last cell of a column has no conductance to the first of the next one.
    up, above, gaps = slice(first * k, last * k - 1), slice(first * k + 1, last * k), rows[EDGE_ABOVE, : n - 1]
    pressed(
        cells[ALONG, up], gaps, OwnAndNext(gaps, gaps), 3.0 * g,
        OwnAndNext(states[PRESSURE, up], states[PRESSURE, above]),
        OwnAndNext(states[PRESSURE_SLOPE, up], states[PRESSURE_SLOPE, above]),
        _flows_in(rows, RAISED, slice(k, n + k - 1)),
    )  # fmt: skip
    for layer in range(RAISED, FLOW_ROWS):
        rows[layer, k - 1] = rows[layer, n + k - 1] = 0.0
    around_in, around_out = _flows_in(rows, PRESSED, here), _flows_in(rows, PRESSED, there)
    carried_in, carried_out = _flows_in(rows, DRAWN, here), _flows_in(rows, DRAWN, there)
    raised_in, raised_out = _flows_in(rows, RAISED, below), _flows_in(rows, RAISED, there)
    balanced(
        share, around_in, around_out, carried_in, carried_out, raised_in, raised_out, left, rows[IN_BY_GAP, here],
        rows[OUT_BY_GAP, here],
    )  # fmt: skip
    to = StencilRows(centre, stencil[BEFORE, own], stencil[BEHIND, own], stencil[BELOW, own], stencil[ABOVE, own])
    coupled(share, around_in, around_out, carried_in, carried_out, raised_in, raised_out, to)


@compiled(fastmath={"contract"})
def _share_between_ends(ring: Array, places: Array, first: int, last: int, rows: Array, right: Array) -> None:
    """right <- the balances of the columns first to last, and what they change with, from the gaps at the faces, in the
    middles and at the edges of the cells to the velocities at both ends of the bearing."""
    m, k, e = right.shape[0], right.shape[1], 0
    for i in range(first, last):
        b = i - 1 if i > 0 else m - 1
        s, c, s_out, c_out = ring[SIN, i], ring[COS, i], ring[FACE_SIN, i], ring[FACE_COS, i]
        s_in, c_in, raised, raised_far = ring[FACE_SIN, b], ring[FACE_COS, b], 0.0, 0.0
        for j in range(k):
            z, kept, above = places[MIDDLES, j], rows[STORED_BY_GAP, e], rows[RAISED_BY_GAP, e + k]
            above_far = places[EDGES, j + 1] * above
            middle, far = kept + above - raised, z * kept + above_far - raised_far
            out, into, raised, raised_far = rows[OUT_BY_GAP, e], rows[IN_BY_GAP, e], above, above_far
            x, y = out * s_out - into * s_in, out * c_out - into * c_in
            far_x, far_y = z * x + far * s, z * y + far * c
            right[i, j, k + BY_ITSELF] = rows[LEFT, e]
            right[i, j, k + BY_ENDS] = far_x - x - middle * s
            right[i, j, k + BY_ENDS + 1] = y + middle * c - far_y
            right[i, j, k + BY_ENDS + 2] = -far_x
            right[i, j, k + BY_ENDS + 3] = far_y
            e += 1


@compiled()
def _flow_past_edges(
    cells: Array, places: Array, states: Array, motion: EndsMotion, stencil: Array, right: Array
) -> None:
    """Add the flows around next to the edges of openings, which take their gap there."""
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        n = i + 1 if i + 1 < m else 0
        for j in range(k):
            if cells[EDGE, i, j] == 0.0:
                continue
            z, s, c = places[MIDDLES, j], cells[EDGE_SIN, i, j], cells[EDGE_COS, i, j]
            near, rise = gap_at_ends(cells[EDGE_GAP, i, j], s, c, motion.d)
            h = near + z * rise
            square, fall = h * h * cells[EDGE, i, j], states[PRESSURE, i, j] - states[PRESSURE, n, j]
            flow, by_gap = h * square * fall, 3.0 * motion.g * square * fall
            by_own, by_next = h * square * states[PRESSURE_SLOPE, i, j], h * square * states[PRESSURE_SLOPE, n, j]
            right[i, j, k + BY_ITSELF] -= flow
            right[n, j, k + BY_ITSELF] += flow
            add_by_ends(right, i, j, z, -by_gap * s, by_gap * c)
            add_by_ends(right, n, j, z, by_gap * s, -by_gap * c)
            stencil[CENTRE, i, j] += by_own
            stencil[BEHIND, i, j] -= by_next
            stencil[CENTRE, n, j] += by_next
            stencil[BEFORE, n, j] -= by_own


@compiled()
def _follow_middles(ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, right: Array) -> None:
    """Add what flows around change with by the gaps in the middles of both cells, which apply next to bores."""
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        n = i + 1 if i + 1 < m else 0
        near, rise = gap_at_ends(ring[FACE_GAP, i], ring[FACE_SIN, i], ring[FACE_COS, i], motion.d)
        near_i, rise_i = gap_at_ends(ring[GAP, i], ring[SIN, i], ring[COS, i], motion.d)
        near_n, rise_n = gap_at_ends(ring[GAP, n], ring[SIN, n], ring[COS, n], motion.d)
        for j in range(k):
            z, fall = places[MIDDLES, j], states[PRESSURE, i, j] - states[PRESSURE, n, j]
            by_square = motion.g * cells[AROUND, i, j] * fall * (near + z * rise)
            own, other = by_square * (near_n + z * rise_n), by_square * (near_i + z * rise_i)
            x, y = own * ring[SIN, i] + other * ring[SIN, n], own * ring[COS, i] + other * ring[COS, n]
            add_by_ends(right, i, j, z, -x, y)
            add_by_ends(right, n, j, z, x, -y)


@compiled()
def _carry_out_of_excess(
    ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, stencil: Array, right: Array,
    flows: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, g, half, outflow = motion.d, motion.g, 0.5 * motion.omega, 0.0
    for i in range(m):
        b = i - 1 if i > 0 else m - 1
        s, c = half * (ring[FACE_SIN, i] - ring[FACE_SIN, b]), half * (ring[FACE_COS, i] - ring[FACE_COS, b])
        near, rise = gap_at_ends(half * (ring[FACE_GAP, i] - ring[FACE_GAP, b]), s, c, d)
        for j in range(k):
            excess, z = cells[EXCESS, i, j], places[MIDDLES, j]
            if excess != 0.0:
                oil, grows = excess * states[FRACTION, i, j], near + z * rise
                outflow += oil * grows
                right[i, j, k + BY_ITSELF] -= oil * grows
                add_by_ends(right, i, j, z, -g * oil * s, g * oil * c)
                stencil[CENTRE, i, j] += excess * grows * states[FRACTION_SLOPE, i, j]
    take(outflow, flows)


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
        groove, z = film.share * film.far.pressure if far else 0.0, places[EDGES, k if far else 0]
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


@compiled(makes_arrays=True)
def land_balances(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, past: Array,
    stencil: Array, right: Array, flows: Array,
) -> None:  # fmt: skip
    """The balances of the cells of a land and their derivatives, see `balances`. right: (m, k, k + ALL_SIDES)."""
    m, k = past.shape
    rows = np.empty((ROWS, (COLUMNS + 1) * k))
    bored, of, at, sums = film.bored, cells.reshape(-1, m * k), states.reshape(-1, m * k), stencil.reshape(-1, m * k)
    for flow in range(FLOWS):
        flows[flow] = 0.0
    _meet_gaps(ring, places, motion, bored, m - 1, m, k, rows)
    _flow_around(bored, of, at, motion, m - 1, m, k, 0, rows)
    outflow, first, n = 0.0, 0, k
    while first < m:
        for layer in range(RAISED):  # the flows into the first of these columns
            for j in range(k):
                rows[layer, j] = rows[layer, n + j]
        last = min(first + COLUMNS, m)
        n = (last - first) * k
        _meet_gaps(ring, places, motion, bored, first, last, k, rows)
        inner = min(last, m - 1)
        if inner > first:
            outflow += _flow_around(bored, of, at, motion, first, inner, k, 0, rows)
        if last == m:
            outflow += _flow_around(bored, of, at, motion, m - 1, m, k, n - k, rows)
        _balance(of, at, motion, past.reshape(-1), first, last, k, rows, sums)
        _share_between_ends(ring, places, first, last, rows, right)
        first = last
    take(outflow, flows)
    if total(of[EDGE]) > 0.0:
        _flow_past_edges(cells, places, states, motion, stencil, right)
    if bored:
        _follow_middles(ring, cells, places, states, motion, right)
        _carry_out_of_excess(ring, cells, places, states, motion, stencil, right, flows)
    _flow_through_ends(film, ring, cells, places, states, motion, stencil, right, flows)
    hold_given(cells, stencil, right, flows, ALL_SIDES)
