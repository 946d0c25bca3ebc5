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
    GAS_IN,
    GAS_OUT,
    GAS_RELEASED,
    GridMotion,
    end_flow,
    falls_to_air,
    section_end,
)
from frbcli.film.cells.balance.ends import STEEPNESS
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    FRACTION,
    FREE_GAS,
    PASSED_ON,
    PRESSURE,
    TURNOVER,
    limited_at,
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
from frbcli.film.roughness.rough_gap import flowing_cube, rough_flow, sheared_gap

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


@compiled()
def _around(
    film: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: GridMotion, paths: Array
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d_x, d_y, omega = motion.d_x, motion.d_y, motion.omega
    forward = omega >= 0.0
    for i in range(m):
        n, b = i + 1 if i + 1 < m else 0, i - 1 if i > 0 else m - 1
        h = ring[FACE_GAP, i] + d_x * ring[FACE_SIN, i] - d_y * ring[FACE_COS, i]
        h_b = ring[FACE_GAP, b] + d_x * ring[FACE_SIN, b] - d_y * ring[FACE_COS, b]
        cube = h * h * h
        if film.bored:
            h_i = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
            h_n = ring[GAP, n] + d_x * ring[SIN, n] - d_y * ring[COS, n]
            cube = h_i * h * h_n
        extra = 0.0
        if film.roughness > 0.0:
            cube *= rough_flow(h, film.roughness)[0]
            extra, _ = sheared_gap(h, film.roughness, 0.5 * film.shear * (omega + 2.0 * motion.spin))
        for j in range(k):
            through = cube * cells[AROUND, i, j]
            if cells[EDGE, i, j] != 0.0:
                at = cells[EDGE_GAP, i, j] + d_x * cells[EDGE_SIN, i, j] - d_y * cells[EDGE_COS, i, j]
                through = flowing_cube(at, film.roughness)[0] * cells[EDGE, i, j]
            t, t_n = states[FRACTION, i, j], states[FRACTION, n, j]
            over, over_n = max(t - 1.0, 0.0), max(t_n - 1.0, 0.0)
            upstream, downstream = (t - over, t_n - over_n) if forward else (t_n - over_n, t - over)
            more, _, _ = limited_at(upstream - states[BEFORE_UPSTREAM, i, j], downstream - upstream)
            swept = 0.5 * omega * width[0, j] * h + extra * width[0, j]
            drawn = swept * (upstream + more + 0.5 * (over + over_n))
            pressed = through * (states[PRESSURE, i, j] - states[PRESSURE, n, j])
            pass_around(pressed, drawn, cells, i, n, j, paths)
            if cells[EXCESS, i, j] != 0.0:
                outside(cells[EXCESS, i, j] * 0.5 * omega * (h - h_b) * t, i, j, paths)


@compiled(inline=True)
def pass_along(flow: float, i: int, j: int, paths: Array) -> None:
    """Oil that pressure drives from cell (i, j) to the next one along, (i, j + 1)."""
    paths[UPWARD, i, j], paths[DOWNWARD, i, j] = max(flow, 0.0), max(-flow, 0.0)
    paths[OUT, i, j] += paths[UPWARD, i, j]
    paths[OUT, i, j + 1] += paths[DOWNWARD, i, j]


@compiled()
def _along(
    film: np.record, ring: Array, cells: Array, states: Array, motion: GridMotion, paths: Array
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        h = ring[GAP, i] + motion.d_x * ring[SIN, i] - motion.d_y * ring[COS, i]
        cube, _ = flowing_cube(h, film.roughness)
        for j in range(k - 1):
            flow = cube * cells[ALONG, i, j] * (states[PRESSURE, i, j] - states[PRESSURE, i, j + 1])
            pass_along(flow, i, j, paths)


@compiled(makes_arrays=True)
def _through_ends(
    film: np.record, ring: Array, cells: Array, states: Array, motion: GridMotion, paths: Array
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    steepness, falls = STEEPNESS / film.scales.ambient, np.empty(m)
    for far in (False, True):
        kind, j, b, rise, bend = section_end(film, k, far)
        if kind == CLOSED:
            continue
        if kind == FREE:
            falls_to_air(film, ring, states[PRESSURE], motion.d_x, motion.d_y, far, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] != 0.0:
                h = ring[GAP, i] + motion.d_x * ring[SIN, i] - motion.d_y * ring[COS, i]
                cube, _ = flowing_cube(h, film.roughness)
                conductance = cube * film.aspect * ring[LENGTH, i] * rise
                groove = film.share * film.far.pressure if far else 0.0
                flow, _, _, _ = end_flow(
                    kind, states[PRESSURE, i, j], states[PRESSURE, i, b], conductance, bend, groove, steepness,
                    falls[i], ring[BATHED, i],
                )  # fmt: skip
                outside(flow, i, j, paths)


@compiled()
def follow_oil(
    film: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: GridMotion, paths: Array
) -> None:  # fmt: skip
    """The layers ONWARD to GIVEN of paths (PATHS, m, k) <- of the oil of states, see oil_paths of balance.py."""
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        for j in range(k):
            paths[OUT, i, j] = paths[GIVEN, i, j] = 0.0
    _around(film, ring, width, cells, states, motion, paths)
    _along(film, ring, cells, states, motion, paths)
    _through_ends(film, ring, cells, states, motion, paths)


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
    film: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: GridMotion, past: Array,
    paths: Array,
) -> float:  # fmt: skip
    """All of the above for a film in a time step: paths (PATHS, m, k) and the gas of states follow the oil of states as
    they are. past: (m, k) of the gas, as for the oil. Returns the largest change of free gas."""
    m, k = past.shape
    for i in range(m):
        h = ring[GAP, i] + motion.d_x * ring[SIN, i] - motion.d_y * ring[COS, i]
        for j in range(k):
            paths[HEIGHT, i, j], paths[FACTOR, i, j], paths[GAS_PAST, i, j] = h, motion.rate * h, past[i, j]
    follow_oil(film, ring, width, cells, states, motion, paths)
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
