"""The oil balances (3.9), (4.31) of the cells of a film with all derivatives, compiled: Balance.residual in one sweep.

Besides derivatives by w of the cells there are derivatives by the displacement of the journal, so that rotor and film
can be solved together. """

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import wright_omega
from frbcli.film.cells.balance.ends import BEND, PREFACTOR, STEEPNESS
from frbcli.film.cells.balance.resting import rests
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    FRACTION,
    FRACTION_SLOPE,
    PRESSURE,
    PRESSURE_SLOPE,
    SOURCE,
    SOURCE_SLOPE,
    carried_at,
)
from frbcli.film.cells.data import (
    ALONG,
    AREA,
    AROUND,
    BATHED,
    BY_ITSELF,
    BY_X,
    BY_Y,
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
    FED,
    FREE,
    GAP,
    LENGTH,
    SHARE,
    SIDES,
    SIN,
    UNKNOWN,
)
from frbcli.film.cells.diffusion.spread import spread_oil
from frbcli.film.cells.elimination.block_cyclic import ABOVE, BEFORE, BEHIND, BELOW, CENTRE, ENTRIES, UNASKED
from frbcli.film.roughness.rough_gap import flowing_cube, rough_flow, sheared_gap

# Sums over the ends and the given cells: what flows in and out there, the net outflow through the ends and the net
# supply by given cells and grooves; what channels of a ring bring net; free gas that comes in and leaves with the oil,
# and what leaves the solution net, see gas/carry.py; oil that artificial diffusion creates, see spread.py; and the rate
# of the filling of openings with a flow-limited supply, see feed.py.
INFLOW, OUTFLOW, ENDS_NET, SUPPLY_NET, CHANNELS_NET, GAS_IN, GAS_OUT, GAS_RELEASED, CREATED, FILLING, FLOWS = range(11)


class GridMotion(NamedTuple):
    """Motion of the journal relative to a film's grid, in the grid's directions, and its share in a time step.

    d: displacement over the clearance; omega: omega_J + omega_S relative to the grid; spin: angular speed of the grid,
    which turns the velocity v; g: how far a velocity moves the journal within the stage, 0: not at all; rate: of what
    is stored, 1 / g of a film that remembers its oil, else 0.
    """

    d_x: float
    d_y: float
    omega: float
    v_x: float = 0.0
    v_y: float = 0.0
    spin: float = 0.0
    g: float = 0.0
    rate: float = 0.0


@compiled(inline=True)
def section_end(film: np.record, k: int, far: bool) -> tuple[int, int, int, float, float]:
    """The end z = 0 of a section with k cells along, or z = 1: its kind, the last cell and the one beyond it, and how
    the pressure slope there follows from the two, see EndSlope."""
    if far:
        return film.far.kind, k - 1, max(k - 2, 0), film.far.rise, film.far.bend
    return film.near.kind, 0, min(1, k - 1), film.near.rise, film.near.bend


def without_ends(film: np.record) -> np.record:
    """A film of which no oil leaves but into its openings, to sum up what these take."""
    closed = film.copy()
    for end in (closed.near, closed.far):
        if end.kind != FED:
            end.kind = CLOSED
    return closed


@compiled(inline=True)
def felt_at_end(last: float, beyond: float, bend: float, groove: float) -> tuple[float, float, float]:
    """Pressure towards an end above the pressure of the groove there, or of the air, by a parabola through the last
    cell and the one beyond it; and its derivatives by the pressures of the two."""
    rise, change = last - groove, bend * (last - beyond)
    by_last, by_beyond = 1.0 + bend, -bend
    if abs(change) > BEND * abs(rise):
        side = math.copysign(BEND, change) * math.copysign(1.0, rise) if rise != 0.0 else 0.0
        change, by_last, by_beyond = side * rise, 1.0 + side, 0.0
    return rise + change, by_last, by_beyond


@compiled()
def falls_to_air(
    film: np.record, ring: Array, pressures: Array, d_x: float, d_y: float, far: bool, falls: Array
) -> None:  # fmt: skip
    """falls (m,) <- of the pressure from the last cells to a free end, times the steepness b of (4.37): Wright's omega
    function, see ends.py. pressures: (m, k) of the cells; d: of the journal over the clearance."""
    m, k = pressures.shape
    steepness = STEEPNESS / film.scales.ambient
    _, j, b, rise, bend = section_end(film, k, far)
    for i in range(m):
        h = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
        cube, _ = flowing_cube(h, film.roughness)
        felt, _, _ = felt_at_end(pressures[i, j], pressures[i, b], bend, 0.0)
        falls[i] = math.log(PREFACTOR * steepness / (cube * film.aspect * rise)) + steepness * felt
    for i in range(m):  # side by side
        falls[i], _ = wright_omega(falls[i])


@compiled(inline=True)
def end_flow(
    kind: int, last: float, beyond: float, conductance: float, bend: float, groove: float, steepness: float,
    fall: float, bathed: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """(outflow, its derivatives by the pressures of the last cell and of the one beyond it, and by the conductance).

    fall: at a free end, see falls_to_air; bathed: share of it that lies in a bath."""
    felt, by_last, by_beyond = felt_at_end(last, beyond, bend, groove)
    if kind == FREE and bathed < 1.0:
        slope = conductance * fall / (1.0 + fall)
        by_conductance = fall * fall / (steepness * (1.0 + fall))
        out = conductance / steepness * fall
        if bathed > 0.0:
            free = 1.0 - bathed
            slope = free * slope + bathed * conductance
            out, by_conductance = free * out + bathed * conductance * felt, free * by_conductance + bathed * felt
        return out, slope * by_last, slope * by_beyond, by_conductance
    return conductance * felt, conductance * by_last, conductance * by_beyond, felt


@compiled()
def _between_rough(
    h: float, s: float, c: float, roughness: float, through: float, by_x: float, by_y: float
) -> tuple[float, float, float]:
    """A conductance and its derivatives by the displacement, as rough surfaces leave it in the gap h at the angle with
    the sine s and cosine c."""
    factor, rises = rough_flow(h, roughness)
    return factor * through, factor * by_x + rises * s * through, factor * by_y - rises * c * through


@compiled(inline=True)
def _carried(states: Array, i: int, n: int, j: int, forward: bool, diffuses: bool) -> tuple[float, float, float]:
    """carried_at through the face after a cell; with artificial diffusion the mean of both cells."""
    t, t_n = states[FRACTION, i, j], states[FRACTION, n, j]
    if diffuses:
        return 0.5 * (t + t_n), 0.5, 0.5
    return carried_at(t, t_n, states[BEFORE_UPSTREAM, i, j], forward)


@compiled()
def _flow_around(
    film: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: GridMotion, stencil: Array,
    right: Array, flows: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d_x, d_y, omega, g = motion.d_x, motion.d_y, motion.omega, motion.g
    bored, half, roughness = film.bored, 0.5 * omega, film.roughness
    sliding = 0.5 * film.shear * (omega + 2.0 * motion.spin)  # with a shell at rest
    forward, still = omega >= 0.0, omega == 0.0 and roughness == 0.0  # still: the cells turn with the oil
    outflow = 0.0  # by the openings in cells that are film in part
    diffuses = film.diffuses
    for i in range(m):
        n = i + 1 if i + 1 < m else 0
        if rests(states, i) or rests(states, n):
            continue
        s, c = ring[FACE_SIN, i], ring[FACE_COS, i]
        h = ring[FACE_GAP, i] + d_x * s - d_y * c
        cube, cube_x, cube_y = h * h * h, 3.0 * h * h * s, -3.0 * h * h * c
        if bored:
            h_i = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
            h_n = ring[GAP, n] + d_x * ring[SIN, n] - d_y * ring[COS, n]
            cube = h_i * h * h_n
            cube_x = ring[SIN, i] * h * h_n + h_i * s * h_n + h_i * h * ring[SIN, n]
            cube_y = -ring[COS, i] * h * h_n - h_i * c * h_n - h_i * h * ring[COS, n]
        extra, grows = 0.0, 0.0  # of the gap that is swept, by the sliding of rough surfaces
        if roughness > 0.0:
            cube, cube_x, cube_y = _between_rough(h, s, c, roughness, cube, cube_x, cube_y)
            extra, grows = sheared_gap(h, roughness, sliding)
        for j in range(k):  # through the face after the cell
            open_, carried = cells[AROUND, i, j], half * width[0, j]
            swept, pull = carried * h + extra * width[0, j], carried + grows * width[0, j]
            through, by_x, by_y = cube * open_, cube_x * open_, cube_y * open_
            if cells[EDGE, i, j] != 0.0:
                at_s, at_c = cells[EDGE_SIN, i, j], cells[EDGE_COS, i, j]
                at = cells[EDGE_GAP, i, j] + d_x * at_s - d_y * at_c
                square = at * at * cells[EDGE, i, j]
                through, by_x, by_y = at * square, 3.0 * square * at_s, -3.0 * square * at_c
                if roughness > 0.0:
                    through, by_x, by_y = _between_rough(at, at_s, at_c, roughness, through, by_x, by_y)
            fall, slope, slope_n = (
                states[PRESSURE, i, j] - states[PRESSURE, n, j],
                states[PRESSURE_SLOPE, i, j],
                states[PRESSURE_SLOPE, n, j],
            )
            if still and fall == 0.0 and slope == 0.0 and slope_n == 0.0:
                continue  # in a cavity at p_cav
            share, share_n = cells[SHARE, i, j], cells[SHARE, n, j]
            theta, own, other = 0.0, 0.0, 0.0
            if not still:
                theta, here, next_ = _carried(states, i, n, j, forward, diffuses)
                own = swept * here * states[FRACTION_SLOPE, i, j]
                other = swept * next_ * states[FRACTION_SLOPE, n, j]
            pressed, drawn = through * fall, swept * theta
            by_own, by_next = through * slope, through * slope_n
            outflow += (share - share_n) * drawn
            right[i, j, k + BY_ITSELF] -= pressed + share * drawn
            right[n, j, k + BY_ITSELF] += pressed + share_n * drawn
            by_x, by_y = g * by_x * fall, g * by_y * fall
            drawn_x, drawn_y = g * pull * theta * s, -g * pull * theta * c
            right[i, j, k + BY_X] -= by_x + share * drawn_x
            right[n, j, k + BY_X] += by_x + share_n * drawn_x
            right[i, j, k + BY_Y] -= by_y + share * drawn_y
            right[n, j, k + BY_Y] += by_y + share_n * drawn_y
            stencil[CENTRE, i, j] += by_own + share * own
            stencil[BEHIND, i, j] += share * other - by_next
            stencil[CENTRE, n, j] += by_next - share_n * other
            stencil[BEFORE, n, j] -= by_own + share_n * own
    take(outflow, flows)


@compiled()
def take(outflow: float, flows: Array) -> None:
    """Openings take oil out of a film, or give it to it where it is less than 0."""
    flows[SUPPLY_NET] -= outflow
    if outflow > 0.0:
        flows[OUTFLOW] += outflow
    else:
        flows[INFLOW] -= outflow


@compiled()
def _carry_out_of_excess(
    ring: Array, cells: Array, states: Array, motion: GridMotion, stencil: Array, right: Array, flows: Array,
) -> None:  # fmt: skip
    """Oil that the surfaces carry out of the areas that cells around bores have outside of the film, see bores.py."""
    m, k = states.shape[1], states.shape[2]
    d_x, d_y, omega, g = motion.d_x, motion.d_y, motion.omega, motion.g
    half, outflow = 0.5 * omega, 0.0
    for i in range(m):
        b = i - 1 if i > 0 else m - 1
        s, c = half * (ring[FACE_SIN, i] - ring[FACE_SIN, b]), half * (ring[FACE_COS, i] - ring[FACE_COS, b])
        rise = half * (ring[FACE_GAP, i] - ring[FACE_GAP, b]) + d_x * s - d_y * c
        for j in range(k):
            excess = cells[EXCESS, i, j]
            if excess != 0.0:
                oil = excess * states[FRACTION, i, j]
                outflow += oil * rise
                right[i, j, k + BY_ITSELF] -= oil * rise
                right[i, j, k + BY_X] -= g * oil * s
                right[i, j, k + BY_Y] += g * oil * c
                stencil[CENTRE, i, j] += excess * rise * states[FRACTION_SLOPE, i, j]
    take(outflow, flows)


@compiled()
def _flow_along(
    film: np.record, ring: Array, cells: Array, states: Array, motion: GridMotion, stencil: Array, right: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d_x, d_y, g = motion.d_x, motion.d_y, motion.g
    for i in range(m):
        if rests(states, i):
            continue
        s, c = ring[SIN, i], ring[COS, i]
        h = ring[GAP, i] + d_x * s - d_y * c
        cube, square = flowing_cube(h, film.roughness)
        for j in range(k - 1):  # to the cell above
            fall = cells[ALONG, i, j] * (states[PRESSURE, i, j] - states[PRESSURE, i, j + 1])
            flow, by_gap = cube * fall, g * square * fall
            low = cube * cells[ALONG, i, j] * states[PRESSURE_SLOPE, i, j]
            high = cube * cells[ALONG, i, j] * states[PRESSURE_SLOPE, i, j + 1]
            right[i, j, k + BY_ITSELF] -= flow
            right[i, j + 1, k + BY_ITSELF] += flow
            right[i, j, k + BY_X] -= by_gap * s
            right[i, j + 1, k + BY_X] += by_gap * s
            right[i, j, k + BY_Y] += by_gap * c
            right[i, j + 1, k + BY_Y] -= by_gap * c
            stencil[CENTRE, i, j] += low
            stencil[ABOVE, i, j] -= high
            stencil[CENTRE, i, j + 1] += high
            stencil[BELOW, i, j + 1] -= low


@compiled()
def _store(
    ring: Array, cells: Array, states: Array, motion: GridMotion, past: Array, stencil: Array, right: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d_x, d_y, _, v_x, v_y, spin, g, rate = motion
    for i in range(m):
        s, c = ring[SIN, i], ring[COS, i]
        h = ring[GAP, i] + d_x * s - d_y * c
        if rests(states, i):
            for j in range(k):
                right[i, j, k + BY_ITSELF] = cells[AREA, i, j] * (past[i, j] - rate * h * states[FRACTION, i, j])
            continue
        # how the gap's change depends on the velocities: those turn with the grid
        s_v, c_v = s + g * spin * c, c - g * spin * s
        growth = v_x * s - v_y * c
        for j in range(k):
            area, theta = cells[AREA, i, j], states[FRACTION, i, j]
            stored = area * (rate * h * theta - past[i, j] - states[SOURCE, i, j])
            kept = area * (rate * h * states[FRACTION_SLOPE, i, j] - states[SOURCE_SLOPE, i, j])
            by_x, by_y = g * area * rate * theta * s, g * area * rate * theta * c
            if rate == 0.0:
                stored += area * growth * theta
                kept += area * growth * states[FRACTION_SLOPE, i, j]
                by_x, by_y = area * theta * s_v, area * theta * c_v
            if cells[UNKNOWN, i, j] != 0.0:
                right[i, j, k + BY_ITSELF] -= stored
                right[i, j, k + BY_X] -= by_x
                right[i, j, k + BY_Y] += by_y
                stencil[CENTRE, i, j] += kept


@compiled(makes_arrays=True)
def _flow_through_ends(
    film: np.record, ring: Array, cells: Array, states: Array, motion: GridMotion, stencil: Array, right: Array,
    flows: Array,
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d_x, d_y, g = motion.d_x, motion.d_y, motion.g
    steepness, falls = STEEPNESS / film.scales.ambient, np.empty(m)
    for far in (False, True):
        kind, j, b, rise, bend = section_end(film, k, far)
        if kind == CLOSED:
            continue
        groove = film.share * film.far.pressure if far else 0.0
        if kind == FREE:
            falls_to_air(film, ring, states[PRESSURE], d_x, d_y, far, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] == 0.0 or rests(states, i):
                continue
            s, c = ring[SIN, i], ring[COS, i]
            h = ring[GAP, i] + d_x * s - d_y * c
            cube, square = flowing_cube(h, film.roughness)
            unit = film.aspect * ring[LENGTH, i] * rise
            flow, by_last, by_beyond, by_conductance = end_flow(
                kind,
                states[PRESSURE, i, j],
                states[PRESSURE, i, b],
                cube * unit,
                bend,
                groove,
                steepness,
                falls[i],
                ring[BATHED, i],
            )
            by_gap = g * by_conductance * square * unit
            right[i, j, k + BY_ITSELF] -= flow
            right[i, j, k + BY_X] -= by_gap * s
            right[i, j, k + BY_Y] += by_gap * c
            stencil[CENTRE, i, j] += by_last * states[PRESSURE_SLOPE, i, j]
            if b > j:
                stencil[ABOVE, i, j] += by_beyond * states[PRESSURE_SLOPE, i, b]
            elif b < j:
                stencil[BELOW, i, j] += by_beyond * states[PRESSURE_SLOPE, i, b]
            leave(kind, flow, flows)


@compiled()
def leave(kind: int, flow: float, flows: Array) -> None:
    """Oil leaves through an end of a kind, or comes in where the flow is less than 0."""
    if kind == FED:
        flows[SUPPLY_NET] -= flow
    else:
        flows[ENDS_NET] += flow
    if flow > 0.0:
        flows[OUTFLOW] += flow
    else:
        flows[INFLOW] -= flow


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
def balances(
    film: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: GridMotion, past: Array,
    stencil: Array, right: Array, flows: Array,
) -> None:  # fmt: skip
    """The balances of the cells and their derivatives.

    Stored are rate H theta - past (m, k); with rate 0, for a film without memory, the gap's own change with the
    velocity of the motion.
    stencil (ENTRIES, m, k), right (m, k, k + SIDES), its last layers: minus the residual and minus its derivatives by
    the journal's velocities; flows (FLOWS,). Columns that rest, see resting.py, have the residual alone.
    """
    m, k = past.shape
    for entry in range(ENTRIES):
        for i in range(m):
            for j in range(k):
                stencil[entry, i, j] = 0.0
    for i in range(m):
        if rests(states, i):
            stencil[CENTRE, i, 0] = UNASKED
            continue
        for j in range(k):
            for side in range(SIDES):
                right[i, j, k + side] = 0.0
    for flow in range(FLOWS):
        flows[flow] = 0.0
    _flow_around(film, ring, width, cells, states, motion, stencil, right, flows)
    if film.bored:
        _carry_out_of_excess(ring, cells, states, motion, stencil, right, flows)
    _flow_along(film, ring, cells, states, motion, stencil, right)
    if film.diffuses and film.length > 0.0:
        flows[CREATED] = spread_oil(
            film, ring, cells, states, motion.d_x, motion.d_y, motion.omega, motion.g, stencil, right
        )
    _store(ring, cells, states, motion, past, stencil, right)
    _flow_through_ends(film, ring, cells, states, motion, stencil, right, flows)
    hold_given(cells, stencil, right, flows, SIDES)
    if film.given > 0.0:
        flows[FILLING] = (film.given - flows[SUPPLY_NET]) / film.line
