"""The free gas that comes into each cell of a film with its oil, compiled; see balance.py for the balance.

Newton's method for the pressures asks for it in every iteration, so that film and gas are solved together. The flows
follow from the current pressures; the gas goes with them from cell to cell, in the direction in which the surfaces
carry the oil, until it changes no more. What a cell keeps of the gas that comes in follows from the law's derivative.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import (
    COLUMNS,
    DRAWN,
    PRESSED,
    RAISED,
    ROWS,
    edge_cube,
    flow_along,
    flow_around,
    meet_gaps,
    opening_rate,
)
from frbcli.film.cells.balance.ends import GAS_IN, GAS_OUT, GAS_RELEASED, falls_to_air, flow_at_end, section_end
from frbcli.film.cells.balance.states import CARRIED_GAS, FRACTION, FREE_GAS, PASSED_ON, PRESSURE, TURNOVER
from frbcli.film.cells.data import (
    AREA,
    CLOSED,
    COS,
    EDGE,
    EXCESS,
    GAP,
    MIDDLES,
    SHARE,
    SIN,
    UNKNOWN,
    GridMotion,
    gap_along,
)

# Layers of the paths of the oil: to the next cell and back through the face after each cell around and along, all that
# leaves a cell, what comes into it from outside (OilPaths of balance.py); M, see there, and the gas that is known to
# come; gap, rate at which it is stored, and the past of the gas, which are given; 1 / M; the free gas of a cell into
# which none comes; and in the first cell of a column the most that gas which comes into it has changed by.
(
    ONWARD,
    BACKWARD,
    UPWARD,
    DOWNWARD,
    OUT,
    GIVEN,
    KEPT,
    KNOWN,
    HEIGHT,
    FACTOR,
    GAS_PAST,
    PER_KEPT,
    OWN,
    AWAITED,
    PATHS,
) = range(15)
NONE = 1e-300
SHARP, SWEEPS = 0.01, 50  # until gas changes by this share of its change in the first sweep, at most so many sweeps
LITTLE = 0.1  # of what a film in a time step may be off by: sweeps that change less are the last


@compiled(inline=True)
def outside(flow: float, i: int, j: int, paths: Array) -> None:
    """Oil leaves cell (i, j) for an opening or an end, or comes from there where the flow is less than 0."""
    if flow > 0.0:
        paths[OUT, i, j] += flow
    else:
        paths[GIVEN, i, j] -= flow


@compiled(inline=True)
def pass_around(pressed: float, drawn: float, cells: Array, i: int, n: int, j: int, paths: Array) -> None:
    """Oil that pressure and walls take from cell (i, j) to the next one around, (n, j); what openings between them give
    or take comes from outside."""
    share, share_n = cells[SHARE, i, j], cells[SHARE, n, j]
    leaves = shared = pressed + share * drawn
    if share != 1.0 or share_n != 1.0:
        enters = pressed + share_n * drawn
        shared = math.copysign(min(abs(leaves), abs(enters)), leaves) if leaves * enters > 0.0 else 0.0
        outside(leaves - shared, i, j, paths)
        outside(shared - enters, n, j, paths)
    onward, backward = max(shared, 0.0), max(-shared, 0.0)
    paths[ONWARD, i, j], paths[BACKWARD, i, j] = onward, backward
    paths[OUT, i, j] += onward
    paths[OUT, n, j] += backward


@compiled(inline=True)
def pass_along(flow: float, i: int, j: int, paths: Array) -> None:
    """Oil that pressure drives from cell (i, j) to the next one along, (i, j + 1)."""
    paths[UPWARD, i, j], paths[DOWNWARD, i, j] = max(flow, 0.0), max(-flow, 0.0)
    paths[OUT, i, j] += paths[UPWARD, i, j]
    paths[OUT, i, j + 1] += paths[DOWNWARD, i, j]


@compiled()
def _pass_columns(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, first: int, last: int,
    rows: Array, paths: Array,
) -> None:  # fmt: skip
    """The flows of rows, a column behind, out of the columns first to last."""
    m, k, e = states.shape[1], states.shape[2], states.shape[2]
    for i in range(first, last):
        n, (near, more, _, _) = i + 1 if i + 1 < m else 0, opening_rate(ring, i, motion)
        for j in range(k):
            flow = rows[PRESSED, e]
            if cells[EDGE, i, j] != 0.0:
                cube, _ = edge_cube(film, cells, places, motion, i, j)
                flow += cube * cells[EDGE, i, j] * (states[PRESSURE, i, j] - states[PRESSURE, n, j])
            pass_around(flow, rows[DRAWN, e], cells, i, n, j, paths)
            if j < k - 1:
                pass_along(rows[RAISED, e], i, j, paths)
            if cells[EXCESS, i, j] != 0.0:
                outside(cells[EXCESS, i, j] * states[FRACTION, i, j] * (near + places[MIDDLES, j] * more), i, j, paths)
            e += 1


@compiled(makes_arrays=True)
def follow_oil(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, paths: Array
) -> None:  # fmt: skip
    """The layers ONWARD to GIVEN of paths (PATHS, m, k) <- of the oil of states, see OilPaths of balance.py.

    Where surfaces carry more out of a cell than into the next one, which is an opening in part, the opening takes the
    difference, or gives it."""
    m, k = states.shape[1], states.shape[2]
    rows, falls, first = np.empty((ROWS, (COLUMNS + 1) * k)), np.empty(m), 0
    of, at = cells.reshape(-1, m * k), states.reshape(-1, m * k)
    for i in range(m):
        for j in range(k):
            paths[OUT, i, j] = paths[GIVEN, i, j] = 0.0
    while first < m:
        last = min(first + COLUMNS, m)
        meet_gaps(film, ring, places, motion, first, last, k, rows)
        inner = min(last, m - 1)
        if inner > first:
            flow_around(film, of, at, motion, first, inner, k, 0, rows)
        if last == m:
            flow_around(film, of, at, motion, m - 1, m, k, (last - first - 1) * k, rows)
        flow_along(of, at, motion.g, first, last, k, rows)
        _pass_columns(film, ring, places, cells, states, motion, first, last, rows, paths)
        first = last
    for far in (False, True):
        end = section_end(film, places, k, far)
        if end.kind != CLOSED:
            falls_to_air(end, ring, states[PRESSURE], motion, falls)
            for i in range(m):
                if cells[UNKNOWN, i, end.last] != 0.0:
                    flow, _, _, _ = flow_at_end(end, ring, states[PRESSURE], motion, falls[i], i)
                    outside(flow, i, end.last, paths)


@compiled()
def replace_oil(film: np.record, cells: Array, states: Array, paths: Array) -> float:
    """KEPT, KNOWN, PER_KEPT and OWN of paths, and the layer TURNOVER of states <- by the flows; PASSED_ON of given
    cells <- 0. Returns the most that free gas changes by, to first order, since the oil of its cell is replaced at
    another rate than before."""
    m, k = states.shape[1], states.shape[2]
    most, supplied = 0.0, film.supplied_gas
    for i in range(m):
        for j in range(k):
            unknown, area, theta = cells[UNKNOWN, i, j], cells[AREA, i, j], states[FRACTION, i, j]
            if unknown == 0.0:
                states[FREE_GAS, i, j] = states[CARRIED_GAS, i, j] = supplied
            kept = max(area * paths[FACTOR, i, j] * theta + paths[OUT, i, j], NONE)
            oil, passed = max(area * paths[HEIGHT, i, j] * theta, NONE), unknown * states[PASSED_ON, i, j]
            free, carried, before = states[FREE_GAS, i, j], states[CARRIED_GAS, i, j], states[TURNOVER, i, j]
            kept, per_kept = unknown * kept, unknown / kept
            most = max(most, abs((free - carried) * passed * (1.0 - before * oil * per_kept)))
            states[TURNOVER, i, j], states[PASSED_ON, i, j] = kept / oil, passed
            paths[KEPT, i, j], paths[PER_KEPT, i, j], paths[OWN, i, j] = kept, per_kept, free - passed * carried
            paths[KNOWN, i, j] = unknown * (area * paths[GAS_PAST, i, j] + supplied * paths[GIVEN, i, j])
    return most


@compiled(inline=True)
def _renew_along(
    i: int, b: int, n: int, down: bool, back: bool, most_gas: float, paths: Array, states: Array
) -> float:  # fmt: skip
    """Gas comes into the cells of column i from the columns b and n, and along the axis, downwards or upwards; back:
    into those alone into which oil flows that way. Returns the most that free gas changes by.

    No oil carries less than no gas, or more than all of its gas: pressures that are far from a solution may ask for it.
    What the cell before gives stands apart from all else, so that a processor has this ready when it comes."""
    k, last, most = states.shape[2], 0.0, 0.0
    for turn in range(k):
        j = k - 1 - turn if down else turn
        flow = paths[DOWNWARD, i, j] if down else (paths[UPWARD, i, j - 1] if j > 0 else 0.0)
        before, per_kept = states[FREE_GAS, i, j], paths[PER_KEPT, i, j]
        if back and flow == 0.0:
            last = before
            continue
        others = paths[KNOWN, i, j] + paths[ONWARD, b, j] * states[FREE_GAS, b, j]
        others += paths[BACKWARD, i, j] * states[FREE_GAS, n, j]
        if down:
            others += paths[UPWARD, i, j - 1] * states[FREE_GAS, i, j - 1] if j > 0 else 0.0
        else:
            others += paths[DOWNWARD, i, j] * states[FREE_GAS, i, j + 1] if j + 1 < k else 0.0
        own, passed = paths[OWN, i, j], states[PASSED_ON, i, j]
        least, largest = max(own, 0.0), min(own + passed * most_gas, most_gas)
        arriving = passed * per_kept
        free = (own + arriving * others) + (arriving * flow) * last
        states[CARRIED_GAS, i, j] = min(max(per_kept * others + (per_kept * flow) * last, 0.0), most_gas)
        last = states[FREE_GAS, i, j] = min(max(free, least), largest)
        most = max(most, abs(last - before))
    return most


@compiled(inline=True)
def _renew_column(i: int, b: int, n: int, most_gas: float, paths: Array, states: Array) -> float:
    """See _renew_along: as the oil of the first cell flows, and back where other oil does."""
    if paths[DOWNWARD, i, 0] > 0.0:
        most = _renew_along(i, b, n, True, False, most_gas, paths, states)
        return max(most, _renew_along(i, b, n, False, True, most_gas, paths, states))
    most = _renew_along(i, b, n, False, False, most_gas, paths, states)
    return max(most, _renew_along(i, b, n, True, True, most_gas, paths, states))


@compiled(inline=True)
def _await(layer: int, face: int, i: int, change: float, paths: Array) -> None:
    """The gas of a column has changed: column i awaits it if oil comes through the face."""
    for j in range(paths.shape[2]):
        if paths[layer, face, j] > 0.0:
            paths[AWAITED, i, 0] = max(paths[AWAITED, i, 0], change)
            break


@compiled()
def carry_gas(film: np.record, forward: bool, close: float, paths: Array, states: Array) -> float:
    """The layers CARRIED_GAS and FREE_GAS of states <- with the flows of paths from cell to cell; forward: whether the
    surfaces go round in the order of the cells; close: changes of free gas by less need not be carried on. Returns the
    most that free gas has changed by.

    Once around, and then into columns alone whose neighbours have changed since, and send them oil."""
    m, most_gas, first = states.shape[1], film.gas_content, 0.0
    for sweep in range(SWEEPS):
        little, renewed = max(SHARP * first, close), False
        for step in range(m):
            i = step if forward else m - 1 - step
            if sweep > 0 and paths[AWAITED, i, 0] <= little:
                continue
            b, n = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
            change, renewed = _renew_column(i, b, n, most_gas, paths, states), True
            paths[AWAITED, i, 0] = 0.0
            _await(ONWARD, i, n, change, paths)
            _await(BACKWARD, b, b, change, paths)
            if sweep == 0:
                first = max(first, change)
        if not renewed:
            break
    return first


@compiled(inline=True)
def bring_gas(film: np.record, cells: Array, forward: bool, paths: Array, states: Array) -> float:
    """The gas of states <- of a film in a time step with the flows of paths, see carry_gas. Returns the most that free
    gas has changed by."""
    off = replace_oil(film, cells, states, paths)
    close = LITTLE * film.settled * film.gas_content
    return max(off, carry_gas(film, forward, close, paths, states))


@compiled()
def take_gas_along(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, past: Array,
    paths: Array,
) -> float:  # fmt: skip
    """All of the above for a film in a time step: paths (PATHS, m, k) and the gas of states follow the oil of states as
    they are. past: (m, k) of the gas, as for the oil. Returns the largest change of free gas."""
    m, k = past.shape
    for i in range(m):
        near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
        for j in range(k):
            h = near + places[MIDDLES, j] * rise
            paths[HEIGHT, i, j], paths[FACTOR, i, j], paths[GAS_PAST, i, j] = h, motion.rate * h, past[i, j]
    follow_oil(film, ring, places, cells, states, motion, paths)
    return bring_gas(film, cells, motion.omega >= 0.0, paths, states)


@compiled(inline=True)
def _brought(
    i: int, j: int, flow: float, cells: Array, states: Array, outside: float, inside: float
) -> tuple[float, float]:
    """Gas that comes from given cells and from others, with what a flow brings from cell (i, j)."""
    gas = flow * states[FREE_GAS, i, j]
    return (outside + gas, inside) if cells[UNKNOWN, i, j] == 0.0 else (outside, inside + gas)


@compiled()
def store_gas_rates(film: np.record, cells: Array, states: Array, paths: Array, rates: Array, flows: Array) -> None:
    """rates (m, k) <- of the gas H theta c of each cell; GAS_IN, GAS_OUT and GAS_RELEASED of flows <- their sums.

    What cells pass to each other is the same for both, and what leaves the solution counts in full: so no gas is lost
    however far the balance is from zero."""
    m, k = rates.shape
    came, left, freed = 0.0, 0.0, 0.0
    for i in range(m):
        b, n = i - 1 if i > 0 else m - 1, i + 1 if i + 1 < m else 0
        for j in range(k):
            rates[i, j] = 0.0
            if cells[UNKNOWN, i, j] == 0.0:
                continue
            outside, inside = film.supplied_gas * paths[GIVEN, i, j], 0.0
            outside, inside = _brought(b, j, paths[ONWARD, b, j], cells, states, outside, inside)
            outside, inside = _brought(n, j, paths[BACKWARD, i, j], cells, states, outside, inside)
            if j > 0:
                outside, inside = _brought(i, j - 1, paths[UPWARD, i, j - 1], cells, states, outside, inside)
            if j + 1 < k:
                outside, inside = _brought(i, j + 1, paths[DOWNWARD, i, j], cells, states, outside, inside)
            leaves = paths[OUT, i, j] * states[FREE_GAS, i, j]
            released = paths[KEPT, i, j] * (states[FREE_GAS, i, j] - states[CARRIED_GAS, i, j])
            rates[i, j] = (outside + inside - leaves + released) / cells[AREA, i, j]
            came, left, freed = came + outside, left + leaves - inside, freed + released
    flows[GAS_IN], flows[GAS_OUT], flows[GAS_RELEASED] = came, left, freed
