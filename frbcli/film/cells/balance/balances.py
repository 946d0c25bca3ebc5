"""The oil balances (3.9), (4.31) of the cells of a film with all derivatives, compiled.

The gap H(phi, z) is linear along the axis: of a journal that does not tilt it is the same everywhere. Besides
derivatives by w of the cells there are derivatives by the velocity of the journal, or by the velocities at both ends of
its bearing, so that rotor and film can be solved together.

Columns of cells are balanced some at a time, one cell after the other, so that loops run on the vector units
(faces.py). The flows through their faces are in rows; gas goes with the same ones (gas/carry.py).
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.diffusion import spread_oil
from frbcli.film.cells.balance.ends import CREATED, FILLING, FLOWS, INFLOW, OUTFLOW, SUPPLY_NET, flow_through_ends, take
from frbcli.film.cells.balance.faces import (
    FaceFlows,
    OwnAndNext,
    Sloped,
    StencilRows,
    balanced,
    cubed,
    drawn,
    pressed,
    stored,
)
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    FRACTION,
    FRACTION_SLOPE,
    PRESSURE,
    PRESSURE_SLOPE,
    SOURCE,
    SOURCE_SLOPE,
    rests,
)
from frbcli.film.cells.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES, UNASKED
from frbcli.film.cells.data import (
    ALL_SIDES,
    ALONG,
    AREA,
    AROUND,
    BY_ITSELF,
    COS,
    EDGE,
    EDGE_COS,
    EDGE_GAP,
    EDGE_SIN,
    EDGES,
    EXCESS,
    FACE_COS,
    FACE_GAP,
    FACE_SIN,
    GAP,
    MIDDLES,
    SHARE,
    SIDES,
    SIN,
    UNKNOWN,
    WIDTHS,
    GridMotion,
    add_by_motion,
    gap_along,
)
from frbcli.film.roughness.contact import flowing_cube, rough_flow, sheared_gap

COLUMNS = 32  # that are balanced at a time: fewer cost a film of the time loop up to a twentieth in calls
# Rows of these columns, one cell after the other, a column behind: FaceFlows around by pressures and by the surfaces,
# then those along, which are 0 into a column.
PRESSED, DRAWN, RAISED, FLOW_ROWS = range(0, 16, 4)
RAISED_BY_GAP = RAISED + 3
# Not behind: gaps at the faces after the cells, at the edges above, and in their middles by bores; cubes of the gap
# through which pressures drive the oil, and their derivatives by it, at those faces and edges; what is swept through
# the faces, and its derivative by the gap; what a cell stores per oil fraction; the balance; and by the gaps what is
# stored, what leaves a cell around, and what enters it.
(
    FACE,
    EDGE_ABOVE,
    MIDDLE,
    CUBE,
    BY_FACE,
    CUBE_ABOVE,
    BY_EDGE,
    SWEPT,
    PULL,
    FACTOR,
    LEFT,
    STORED_BY_GAP,
    OUT_BY_GAP,
    IN_BY_GAP,
    ROWS,
) = range(FLOW_ROWS, FLOW_ROWS + 15)


@compiled()
def meet_gaps(
    film: np.record, ring: Array, places: Array, motion: GridMotion, first: int, last: int, k: int, rows: Array
) -> None:
    """Gaps in the columns from first to last into rows, what flows through them, and by what their cells store oil."""
    m, row, rate = ring.shape[1], 0, motion.rate
    for i in range(first, last):
        s, c = ring[SIN, i], ring[COS, i]
        near, rise = gap_along(ring[GAP, i], s, c, motion)
        near_face, rise_face = gap_along(ring[FACE_GAP, i], ring[FACE_SIN, i], ring[FACE_COS, i], motion)
        kept, kept_rise = rate * near, rate * rise
        if rate == 0.0:
            kept, kept_rise = motion.v_x * s - motion.v_y * c, motion.more_v_x * s - motion.more_v_y * c
        for j in range(k):
            z, pull = places[MIDDLES, j], 0.5 * motion.omega * places[WIDTHS, j]
            h = near_face + z * rise_face
            rows[FACE, row + j], rows[EDGE_ABOVE, row + j] = h, near + places[EDGES, j + 1] * rise
            rows[SWEPT, row + j], rows[PULL, row + j] = pull * h, pull
            rows[FACTOR, row + j] = kept + z * kept_rise
        row += k
    cubed(rows[FACE, :row], rows[CUBE, :row], rows[BY_FACE, :row])
    cubed(rows[EDGE_ABOVE, :row], rows[CUBE_ABOVE, :row], rows[BY_EDGE, :row])
    if film.bored:  # flows take the gaps in the middles of both cells, too
        for column in range(first, last + 1):
            i, row = column % m, (column - first) * k
            near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
            for j in range(k):
                rows[MIDDLE, row + j] = near + places[MIDDLES, j] * rise
        for e in range((last - first) * k):
            rows[BY_FACE, e] = rows[MIDDLE, e] * rows[MIDDLE, e + k]
            rows[CUBE, e] = rows[FACE, e] * rows[BY_FACE, e]
    if film.roughness > 0.0:
        _meet_summits(film, ring, places, motion, first, last, k, rows)


@compiled()
def _meet_summits(
    film: np.record, ring: Array, places: Array, motion: GridMotion, first: int, last: int, k: int, rows: Array
) -> None:
    """What rough surfaces make of the rows of meet_gaps."""
    roughness, sliding = film.roughness, 0.5 * film.shear * (motion.omega + 2.0 * motion.spin)  # with a shell at rest
    tilts = motion.more_x != 0.0 or motion.more_y != 0.0  # else a column has one gap
    factor, rises, cube, slope, extra, grows = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(first, last):
        near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
        for j in range(k):
            e = (i - first) * k + j
            if j == 0 or tilts:
                factor, rises = rough_flow(rows[FACE, e], roughness)
                cube, slope = flowing_cube(near + places[EDGES, j + 1] * rise, roughness)
                extra, grows = sheared_gap(rows[FACE, e], roughness, sliding)
            rows[BY_FACE, e] = factor * rows[BY_FACE, e] + rises * rows[CUBE, e]
            rows[CUBE, e] *= factor
            rows[CUBE_ABOVE, e], rows[BY_EDGE, e] = cube, slope
            rows[SWEPT, e] += extra * places[WIDTHS, j]
            rows[PULL, e] += grows * places[WIDTHS, j]


@compiled(inline=True, internal=True)
def _flows_in(rows: Array, first: int, where: slice) -> FaceFlows:
    """The flows in rows from the row `first` on."""
    return FaceFlows(rows[first, where], rows[first + 1, where], rows[first + 2, where], rows[first + 3, where])


@compiled()
def flow_around(
    film: np.record, cells: Array, states: Array, motion: GridMotion, first: int, last: int, k: int, at: int,
    rows: Array,
) -> float:  # fmt: skip
    """Flows from the columns first to last to the next ones into rows, which hold the gaps from `at` on and the flows
    one column later; returns what openings take of them. The column before the very first is on its own."""
    behind = last % (cells.shape[1] // k) if last == first + 1 else first + 1
    own, next_ = slice(first * k, last * k), slice(behind * k, (behind + last - first) * k)
    by, to = slice(at, at + (last - first) * k), slice(at + k, at + (last - first + 1) * k)
    pressed(
        cells[AROUND, own], rows[CUBE, by], rows[BY_FACE, by], motion.g,
        OwnAndNext(states[PRESSURE, own], states[PRESSURE, next_]),
        OwnAndNext(states[PRESSURE_SLOPE, own], states[PRESSURE_SLOPE, next_]), _flows_in(rows, PRESSED, to),
    )  # fmt: skip
    outflow: float = drawn(
        rows[SWEPT, by], rows[PULL, by], motion.omega >= 0.0, film.diffuses, motion.g,
        OwnAndNext(states[FRACTION, own], states[FRACTION, next_]), states[BEFORE_UPSTREAM, own],
        OwnAndNext(states[FRACTION_SLOPE, own], states[FRACTION_SLOPE, next_]),
        OwnAndNext(cells[SHARE, own], cells[SHARE, next_]), _flows_in(rows, DRAWN, to),
    )  # fmt: skip
    return outflow


@compiled()
def flow_along(cells: Array, states: Array, g: float, first: int, last: int, k: int, rows: Array) -> None:
    """Flows from the cells of the columns first to last to those above into rows, one column later."""
    n = (last - first) * k
    # The last cell of a column has no conductance to the first of the next one.
    up, above = slice(first * k, last * k - 1), slice(first * k + 1, last * k)
    pressed(
        cells[ALONG, up], rows[CUBE_ABOVE, : n - 1], rows[BY_EDGE, : n - 1], g,
        OwnAndNext(states[PRESSURE, up], states[PRESSURE, above]),
        OwnAndNext(states[PRESSURE_SLOPE, up], states[PRESSURE_SLOPE, above]),
        _flows_in(rows, RAISED, slice(k, n + k - 1)),
    )  # fmt: skip
    for layer in range(RAISED, FLOW_ROWS):
        rows[layer, k - 1] = rows[layer, n + k - 1] = 0.0


@compiled()
def _balance(
    cells: Array, states: Array, motion: GridMotion, past: Array, first: int, last: int, k: int, rows: Array,
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
    flow_along(cells, states, g, first, last, k, rows)
    around_in, around_out = _flows_in(rows, PRESSED, here), _flows_in(rows, PRESSED, there)
    carried_in, carried_out = _flows_in(rows, DRAWN, here), _flows_in(rows, DRAWN, there)
    raised_in, raised_out = _flows_in(rows, RAISED, below), _flows_in(rows, RAISED, there)
    by_gaps = OwnAndNext(rows[IN_BY_GAP, here], rows[OUT_BY_GAP, here])
    to = StencilRows(centre, stencil[BEFORE, own], stencil[BEHIND, own], stencil[BELOW, own], stencil[ABOVE, own])
    balanced(share, around_in, around_out, carried_in, carried_out, raised_in, raised_out, by_gaps, left, to)


@compiled(fastmath={"contract"})
def _follow_journal(
    film: np.record, ring: Array, places: Array, motion: GridMotion, first: int, last: int, rows: Array, right: Array
) -> None:
    """right <- the balances of the columns first to last, and what they change with, from the gaps at the faces, in the
    middles and at the edges of the cells to the velocity of the journal, or to those at both ends of its bearing."""
    m, k, e, turns = right.shape[0], right.shape[1], 0, motion.g * motion.spin if motion.rate == 0.0 else 0.0
    bored = film.bored
    for i in range(first, last):
        b, n = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        s, c, s_out, c_out = ring[SIN, i], ring[COS, i], ring[FACE_SIN, i], ring[FACE_COS, i]
        s_in, c_in, raised, raised_far = ring[FACE_SIN, b], ring[FACE_COS, b], 0.0, 0.0
        near, rise = gap_along(ring[GAP, i], s, c, motion)
        near_b, rise_b = gap_along(ring[GAP, b], ring[SIN, b], ring[COS, b], motion)
        near_n, rise_n = gap_along(ring[GAP, n], ring[SIN, n], ring[COS, n], motion)
        s_kept, c_kept = s + turns * c, c - turns * s  # velocities turn with the grid
        for j in range(k):
            z, kept, above = places[MIDDLES, j], rows[STORED_BY_GAP, e], rows[RAISED_BY_GAP, e + k]
            out, into, up = rows[OUT_BY_GAP, e], rows[IN_BY_GAP, e], above - raised
            x, y = out * s_out - into * s_in + kept * s_kept, out * c_out - into * c_in + kept * c_kept
            if bored:  # by the gaps in the middles of both cells, too, of which the flows are multiples
                off, on = motion.g * rows[PRESSED, e + k], motion.g * rows[PRESSED, e]
                own = (off - on) / (near + z * rise)
                off, on = off / (near_n + z * rise_n), on / (near_b + z * rise_b)
                x += own * s + off * ring[SIN, n] - on * ring[SIN, b]
                y += own * c + off * ring[COS, n] - on * ring[COS, b]
            right[i, j, k + BY_ITSELF] = rows[LEFT, e]
            if motion.by_ends:
                above_far = places[EDGES, j + 1] * above
                far, raised_far = above_far - raised_far, above_far
                far_x, far_y = z * x + far * s, z * y + far * c
                right[i, j, k + 1], right[i, j, k + 2] = far_x - x - up * s, y + up * c - far_y
                right[i, j, k + 3], right[i, j, k + 4] = -far_x, far_y
            else:
                right[i, j, k + 1], right[i, j, k + 2] = -x - up * s, y + up * c
            raised = above
            e += 1


@compiled(inline=True)
def edge_cube(
    film: np.record, cells: Array, places: Array, motion: GridMotion, i: int, j: int
) -> tuple[float, float]:
    """phi_x H^3 and its derivative by H next to the edge of an opening, where the flow around takes its gap there."""
    near, more = gap_along(cells[EDGE_GAP, i, j], cells[EDGE_SIN, i, j], cells[EDGE_COS, i, j], motion)
    return flowing_cube(near + places[MIDDLES, j] * more, film.roughness)


@compiled()
def _flow_past_edges(
    film: np.record, cells: Array, places: Array, states: Array, motion: GridMotion, stencil: Array, right: Array
) -> None:
    """Add the flows around next to the edges of openings."""
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        n = i + 1 if i + 1 < m else 0
        for j in range(k):
            open_ = cells[EDGE, i, j]
            if open_ == 0.0:
                continue
            z, s, c = places[MIDDLES, j], cells[EDGE_SIN, i, j], cells[EDGE_COS, i, j]
            (cube, slope), fall = edge_cube(film, cells, places, motion, i, j), states[PRESSURE, i, j]
            fall -= states[PRESSURE, n, j]
            flow, by_gap = cube * open_ * fall, motion.g * slope * open_ * fall
            by_own, by_next = cube * open_ * states[PRESSURE_SLOPE, i, j], cube * open_ * states[PRESSURE_SLOPE, n, j]
            right[i, j, k + BY_ITSELF] -= flow
            right[n, j, k + BY_ITSELF] += flow
            add_by_motion(right, i, j, z, motion.by_ends, -by_gap * s, by_gap * c)
            add_by_motion(right, n, j, z, motion.by_ends, by_gap * s, -by_gap * c)
            stencil[CENTRE, i, j] += by_own
            stencil[BEHIND, i, j] -= by_next
            stencil[CENTRE, n, j] += by_next
            stencil[BEFORE, n, j] -= by_own


@compiled(inline=True)
def opening_rate(ring: Array, i: int, motion: GridMotion) -> tuple[float, float, float, float]:
    """At which the surfaces carry the oil out of column i per area that its cells have outside of the film, see
    bores.py: at the place 0, and how much more at 1; its derivatives by the displacement along x, and minus y."""
    b, half = i - 1 if i > 0 else ring.shape[1] - 1, 0.5 * motion.omega
    s, c = half * (ring[FACE_SIN, i] - ring[FACE_SIN, b]), half * (ring[FACE_COS, i] - ring[FACE_COS, b])
    near, more = gap_along(half * (ring[FACE_GAP, i] - ring[FACE_GAP, b]), s, c, motion)
    return near, more, s, c


@compiled()
def _carry_out_of_excess(
    ring: Array, cells: Array, places: Array, states: Array, motion: GridMotion, stencil: Array, right: Array,
    flows: Array,
) -> None:  # fmt: skip
    """Oil that the surfaces carry out of the areas that cells around bores have outside of the film."""
    m, k = states.shape[1], states.shape[2]
    outflow = 0.0
    for i in range(m):
        near, more, s, c = opening_rate(ring, i, motion)
        for j in range(k):
            excess, z = cells[EXCESS, i, j], places[MIDDLES, j]
            if excess != 0.0:
                oil, grows = excess * states[FRACTION, i, j], near + z * more
                outflow += oil * grows
                right[i, j, k + BY_ITSELF] -= oil * grows
                add_by_motion(right, i, j, z, motion.by_ends, -motion.g * oil * s, motion.g * oil * c)
                stencil[CENTRE, i, j] += excess * grows * states[FRACTION_SLOPE, i, j]
    take(outflow, flows)


@compiled()
def hold_given(cells: Array, stencil: Array, right: Array, flows: Array, sides: int) -> None:
    """Cells with a given pressure keep it; what would leave them is their supply. sides: right-hand sides, the first
    one minus the residual."""
    m, k = cells.shape[1], cells.shape[2]
    for i in range(m):
        for j in range(k):
            if cells[UNKNOWN, i, j] == 0.0:  # no column that rests has any
                fed = -right[i, j, k + BY_ITSELF]
                flows[SUPPLY_NET] += fed
                if fed > 0.0:
                    flows[INFLOW] += fed
                else:
                    flows[OUTFLOW] -= fed
                for entry in range(5):
                    stencil[entry, i, j] = 0.0
                stencil[CENTRE, i, j] = 1.0
                for side in range(sides):
                    right[i, j, k + side] = 0.0


@compiled()
def _stand(
    ring: Array, cells: Array, places: Array, states: Array, motion: GridMotion, past: Array, i: int, stencil: Array,
    right: Array,
) -> None:  # fmt: skip
    """The balance of a column that rests, see states.py: its residual alone."""
    k = past.shape[1]
    near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
    for j in range(k):
        h = near + places[MIDDLES, j] * rise
        right[i, j, k + BY_ITSELF] = cells[AREA, i, j] * (past[i, j] - motion.rate * h * states[FRACTION, i, j])
        for entry in range(ENTRIES):
            stencil[entry, i, j] = 0.0
    stencil[CENTRE, i, 0] = UNASKED


@compiled()
def _flow_between(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, past: Array,
    rows: Array, stencil: Array, right: Array,
) -> float:  # fmt: skip
    """The balances without openings and ends; returns what openings take of the flows around."""
    m, k = past.shape
    of, at, sums = cells.reshape(-1, m * k), states.reshape(-1, m * k), stencil.reshape(-1, m * k)
    meet_gaps(film, ring, places, motion, m - 1, m, k, rows)
    flow_around(film, of, at, motion, m - 1, m, k, 0, rows)
    outflow, first, n = 0.0, 0, k
    while first < m:
        for layer in range(RAISED):  # the flows into the first of these columns
            for j in range(k):
                rows[layer, j] = rows[layer, n + j]
        last = first + 1
        if rests(states, first):
            _stand(ring, cells, places, states, motion, past, first, stencil, right)
            for layer in range(RAISED):
                for j in range(k):
                    rows[layer, k + j] = 0.0
        else:
            while last < min(first + COLUMNS, m) and not rests(states, last):
                last += 1
            meet_gaps(film, ring, places, motion, first, last, k, rows)
            inner = min(last, m - 1)
            if inner > first:
                outflow += flow_around(film, of, at, motion, first, inner, k, 0, rows)
            if last == m:
                outflow += flow_around(film, of, at, motion, m - 1, m, k, (last - first - 1) * k, rows)
            _balance(of, at, motion, past.reshape(-1), first, last, k, rows, sums)
            _follow_journal(film, ring, places, motion, first, last, rows, right)
        n, first = (last - first) * k, last
    return outflow


@compiled(makes_arrays=True)
def balances(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, past: Array,
    stencil: Array, right: Array, flows: Array,
) -> None:  # fmt: skip
    """The balances of the cells and their derivatives.

    Stored are rate H theta - past (m, k); with rate 0, for a film without memory, the gap's own change with the
    velocity of the motion.
    stencil (ENTRIES, m, k), right (m, k, k + SIDES), its last layers: minus the residual and minus its derivatives by
    the journal's velocities, or (m, k, k + ALL_SIDES) by those at both ends; flows (FLOWS,). Columns that rest, see
    resting.py, have the residual alone.
    """
    rows, sides = np.empty((ROWS, (COLUMNS + 1) * past.shape[1])), ALL_SIDES if motion.by_ends else SIDES
    for flow in range(FLOWS):
        flows[flow] = 0.0
    take(_flow_between(film, ring, places, cells, states, motion, past, rows, stencil, right), flows)
    if film.edges:
        _flow_past_edges(film, cells, places, states, motion, stencil, right)
    if film.bored:
        _carry_out_of_excess(ring, cells, places, states, motion, stencil, right, flows)
    if film.diffuses and film.length > 0.0:
        flows[CREATED] = spread_oil(film, ring, places, cells, states, motion, stencil, right)
    flow_through_ends(film, ring, cells, places, states, motion, stencil, right, flows)
    hold_given(cells, stencil, right, flows, sides)
    if film.given > 0.0:
        flows[FILLING] = (film.given - flows[SUPPLY_NET]) / film.line
