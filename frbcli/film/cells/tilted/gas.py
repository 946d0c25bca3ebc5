"""The free gas that comes into each cell of a land with its oil, compiled: gas/carry.py at a gap that is linear in z.

The flows are as in kernel.py, one after the other, by where their oil begins. """

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import end_flow, falls_to_air, section_end
from frbcli.film.cells.balance.ends import STEEPNESS
from frbcli.film.cells.balance.states import BEFORE_UPSTREAM, FRACTION, PRESSURE, limited_at
from frbcli.film.cells.data import (
    ALONG,
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
    SIN,
    UNKNOWN,
)
from frbcli.film.cells.gas.carry import (
    FACTOR,
    GAS_PAST,
    GIVEN,
    HEIGHT,
    OUT,
    bring_gas,
    outside,
    pass_along,
    pass_around,
)
from frbcli.film.cells.tilted.data import EDGES, MIDDLES, WIDTHS
from frbcli.film.cells.tilted.kernel import EndsMotion, gap_at_ends


@compiled()
def _around(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, paths: Array
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, half, forward = motion.d, 0.5 * motion.omega, motion.omega >= 0.0
    for i in range(m):
        n, b = i + 1 if i + 1 < m else 0, i - 1 if i > 0 else m - 1
        near, rise = gap_at_ends(ring[FACE_GAP, i], ring[FACE_SIN, i], ring[FACE_COS, i], d)
        near_b, rise_b = gap_at_ends(ring[FACE_GAP, b], ring[FACE_SIN, b], ring[FACE_COS, b], d)
        near_i, rise_i = gap_at_ends(ring[GAP, i], ring[SIN, i], ring[COS, i], d)
        near_n, rise_n = gap_at_ends(ring[GAP, n], ring[SIN, n], ring[COS, n], d)
        for j in range(k):
            z = places[MIDDLES, j]
            h = near + z * rise
            through = h * h * h * cells[AROUND, i, j]
            if film.bored:
                through = (near_i + z * rise_i) * h * (near_n + z * rise_n) * cells[AROUND, i, j]
            if cells[EDGE, i, j] != 0.0:
                edge, more = gap_at_ends(cells[EDGE_GAP, i, j], cells[EDGE_SIN, i, j], cells[EDGE_COS, i, j], d)
                at = edge + z * more
                through = at * at * at * cells[EDGE, i, j]
            t, t_n = states[FRACTION, i, j], states[FRACTION, n, j]
            over, over_n = max(t - 1.0, 0.0), max(t_n - 1.0, 0.0)
            upstream, downstream = (t - over, t_n - over_n) if forward else (t_n - over_n, t - over)
            beyond, _, _ = limited_at(upstream - states[BEFORE_UPSTREAM, i, j], downstream - upstream)
            drawn = half * places[WIDTHS, j] * h * (upstream + beyond + 0.5 * (over + over_n))
            pressed = through * (states[PRESSURE, i, j] - states[PRESSURE, n, j])
            pass_around(pressed, drawn, cells, i, n, j, paths)
            if cells[EXCESS, i, j] != 0.0:
                outside(cells[EXCESS, i, j] * half * (h - near_b - z * rise_b) * t, i, j, paths)


@compiled()
def _along(ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, paths: Array) -> None:
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        near, rise = gap_at_ends(ring[GAP, i], ring[SIN, i], ring[COS, i], motion.d)
        for j in range(k - 1):
            h = near + places[EDGES, j + 1] * rise
            flow = h * h * h * cells[ALONG, i, j] * (states[PRESSURE, i, j] - states[PRESSURE, i, j + 1])
            pass_along(flow, i, j, paths)


@compiled(makes_arrays=True)
def _through_ends(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, paths: Array
) -> None:  # fmt: skip
    m, k = states.shape[1], states.shape[2]
    d, steepness, falls = motion.d, STEEPNESS / film.scales.ambient, np.empty(m)
    for far in (False, True):
        kind, j, b, slope, bend = section_end(film, k, far)
        if kind == CLOSED:
            continue
        groove, z = film.share * film.far.pressure if far else 0.0, places[EDGES, k if far else 0]
        if kind == FREE:
            d_x, d_y = d[0] + z * (d[2] - d[0]), d[1] + z * (d[3] - d[1])
            falls_to_air(film, ring, states[PRESSURE], d_x, d_y, far, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] != 0.0:
                near, rise = gap_at_ends(ring[GAP, i], ring[SIN, i], ring[COS, i], d)
                h = near + z * rise
                conductance = h * h * h * film.aspect * ring[LENGTH, i] * slope
                flow, _, _, _ = end_flow(
                    kind, states[PRESSURE, i, j], states[PRESSURE, i, b], conductance, bend, groove, steepness,
                    falls[i], ring[BATHED, i],
                )  # fmt: skip
                outside(flow, i, j, paths)


@compiled()
def follow_land_oil(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, paths: Array
) -> None:  # fmt: skip
    """follow_oil of carry.py."""
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        for j in range(k):
            paths[OUT, i, j] = paths[GIVEN, i, j] = 0.0
    _around(film, ring, cells, places, states, motion, paths)
    _along(ring, cells, places, states, motion, paths)
    _through_ends(film, ring, cells, places, states, motion, paths)


@compiled()
def take_land_gas_along(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: EndsMotion, past: Array,
    paths: Array,
) -> float:  # fmt: skip
    """take_gas_along of carry.py."""
    m, k = past.shape
    for i in range(m):
        near, rise = gap_at_ends(ring[GAP, i], ring[SIN, i], ring[COS, i], motion.d)
        for j in range(k):
            h = near + places[MIDDLES, j] * rise
            paths[HEIGHT, i, j], paths[FACTOR, i, j], paths[GAS_PAST, i, j] = h, motion.rate * h, past[i, j]
    follow_land_oil(film, ring, cells, places, states, motion, paths)
    return bring_gas(film, cells, motion.omega >= 0.0, paths, states)
