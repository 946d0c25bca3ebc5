"""States of the cells of one film by its cavitation law, compiled: pressure, oil fraction, what is carried, what rests.

The oil fraction that the surfaces carry through a face is theta_u + L(a, b): theta_u of the cell upstream of the face,
a the difference from the cell before that one, b the difference across the face. L = 0 (upwind) has an error of first
order, which acts as a diffusion of the oil; L = b / 2 is of second order, but overshoots at fronts. Between these
chooses the limiter of van Albada,

    L = a b (a + b) / (2 (a^2 + b^2)) where a b > 0, else 0.

The oil fraction before the upstream cell is held at a guess while Newton's method solves: so the equations keep their
two neighbours around, and their derivatives are exact. Oil that is compressed is no part of it, see balances.py.

A column of cells rests if it is a cavity at p_cav that turns with the oil, between others like it. Nothing flows
through its faces, so that H theta stays what it was; it feels no other cells, and Newton's step of each of its cells is
a division. A film that empties consists mostly of such columns.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import ECCENTRICITY, LAW_NUMBERS, MOTION, SPEED, WHIRL, call_cells, call_follow
from frbcli.film.cells.data import CLOSED, GIVEN, GIVEN_PRESSURE, NO_CLIP, UNKNOWN

# Layers of the states of the cells: of the law, the slopes by w last; the free gas that comes into the cell, and the
# rate of its oil, as the law takes them, see balance.py in gas/, the free gas of the cell and how much of the incoming
# gas it has at the same pressure; the oil fraction before the cell upstream of the face after each cell, as it is held,
# see limited; and, in the first cell of a column, whether the oil of the column stays constant.
(
    PRESSURE,
    FRACTION,
    SOURCE,
    PRESSURE_SLOPE,
    FRACTION_SLOPE,
    SOURCE_SLOPE,
    CARRIED_GAS,
    TURNOVER,
    FREE_GAS,
    PASSED_ON,
    BEFORE_UPSTREAM,
    RESTS,
    STATES,
) = range(13)
CENTRE = 1e-6  # of the clearance, squared: a journal in the centre does not whirl
WHIRL_EDGE, WHIRL_STEP = 0.3, 0.15  # distance from 0.5 where no whirl is left, and over which it fades


@compiled()
def whirl_share(d_x: float, d_y: float, v_x: float, v_y: float, speed: float) -> float:
    """Share of half-frequency whirl in a journal's motion, 0 to 1, by the rate of its attitude angle over omega_J +
    omega_S.

    1 between 0.35 and 0.65, 0 below 0.2 and above 0.8, a cubic step between: a synchronous orbit has 0 in the mean
    if it stays on one side of the centre, and 1 about the centre.
    """
    ratio = (d_x * v_y - d_y * v_x) / ((d_x * d_x + d_y * d_y + CENTRE) * (speed if speed != 0.0 else CENTRE))
    place = min(max((WHIRL_EDGE - abs(ratio - 0.5)) / WHIRL_STEP, 0.0), 1.0)
    return place * place * (3.0 - 2.0 * place)


@compiled(makes_arrays=True)
def follow_law(film: np.record, d_x: float, d_y: float, v_x: float, v_y: float, speed: float, law: Array) -> None:
    """law (LAW_NUMBERS,) <- what a film's law is at the displacement d, its rate v and the speed omega_J + omega_S."""
    motion = np.empty(MOTION)
    motion[ECCENTRICITY], motion[SPEED] = math.sqrt(d_x * d_x + d_y * d_y), speed
    motion[WHIRL] = whirl_share(d_x, d_y, v_x, v_y, speed)
    call_follow(film.follow_at, film.parameters, motion, film.scales, law)


@compiled()
def cell_states(film: np.record, cells: Array, law: Array, drop: float, w: Array, states: Array) -> None:
    """states (STATES, m, k) <- of the cells with the unknowns w (m, k) by the law of follow_law; all arrays in
    one piece. drop: reduction of the given pressures."""
    m, k = w.shape
    call_cells(film.cells_at, m * k, law, film.scales, w, states)
    for i in range(m):
        for j in range(k):
            if cells[UNKNOWN, i, j] == 0.0:
                states[PRESSURE, i, j], states[FRACTION, i, j], states[SOURCE, i, j] = (
                    film.share * cells[GIVEN_PRESSURE, i, j] - drop,
                    film.fraction,
                    0.0,
                )
                for layer in range(PRESSURE_SLOPE, CARRIED_GAS):
                    states[layer, i, j] = 0.0


@compiled(makes_arrays=True)
def fill_openings(film: np.record, filling: float) -> None:
    """film <- the share of the given pressures and the oil fraction of its openings: feed_at of boundaries.py,
    which is kept within its bounds."""
    held, film.share, film.fraction = min(max(filling, film.lowest), 1.0), 1.0, 1.0
    if held > 0.0:
        if held < 1.0:
            cavity = film.scales.cavitation
            film.share = (cavity + held * (film.supply - cavity)) / film.supply
        return
    unknown, state, law = np.empty(1), np.zeros(STATES), np.zeros(LAW_NUMBERS)
    unknown[0] = held
    for p in range(film.parameters.shape[0]):
        law[p] = film.parameters[p]
    call_cells(film.cells_at, 1, law, film.scales, unknown, state)
    film.share, film.fraction = state[PRESSURE] / film.supply, min(max(state[FRACTION], 0.0), 1.0)


@compiled()
def hold(states: Array, omega: float) -> None:
    """The layer BEFORE_UPSTREAM of states (STATES, m, k) <- before_upstream of their oil fractions."""
    m, k = states.shape[1], states.shape[2]
    for i in range(m):
        before = i - 1 if omega >= 0.0 else i + 2
        if before < 0:
            before += m
        elif before >= m:
            before -= m
        for j in range(k):
            states[BEFORE_UPSTREAM, i, j] = min(states[FRACTION, before, j], 1.0)


@compiled(makes_arrays=True)
def pressure_of(film: np.record, law: Array, w: float) -> float:
    """Pressure of one cell with the unknown w."""
    unknown, state = np.empty(1), np.zeros(STATES)
    unknown[0] = w
    call_cells(film.cells_at, 1, law, film.scales, unknown, state)
    return float(state[PRESSURE])


UPWIND = np.nan  # held instead of an oil fraction: L is 0 at that face


def before_upstream(theta: Array, omega: float) -> Array:
    """(m, k) oil fraction of the cell before the upstream one of the face after each cell, full at most.

    theta: (m, k); omega: of what carries the oil, its sign counts."""
    loose = np.minimum(theta, 1.0)
    return np.roll(loose, 1, axis=0) if omega >= 0.0 else np.roll(loose, -2, axis=0)


@compiled()
def limited_at(a: float, b: float) -> tuple[float, float, float]:
    """L and its derivatives by a and b at one face."""
    if not a * b > 0.0:
        return 0.0, 0.0, 0.0
    half = 0.5 / (a * a + b * b)
    value = half * a * b * (a + b)
    return value, half * (b * (2.0 * a + b) - 4.0 * a * value), half * (a * (a + 2.0 * b) - 4.0 * b * value)


@compiled(inline=True)
def carried_at(t: float, t_n: float, before: float, forward: bool) -> tuple[float, float, float]:
    """The oil fraction that the surfaces carry through the face between a cell of the oil fraction t and the next one
    around, t_n, and its derivatives by both; before: see before_upstream. Of compressed oil it is the mean."""
    over, over_n = max(t - 1.0, 0.0), max(t_n - 1.0, 0.0)
    loose, loose_n = t - over, t_n - over_n
    upstream, across = (loose, loose_n - loose) if forward else (loose_n, loose - loose_n)
    more, by_before, by_across = limited_at(upstream - before, across)
    theta = upstream + more + 0.5 * (over + over_n)
    by_upstream = 1.0 + by_before - by_across
    here, next_ = (by_upstream, by_across) if forward else (by_across, by_upstream)
    return theta, 0.5 if t > 1.0 else here, 0.5 if t_n > 1.0 else next_


@compiled(inline=True)
def rests(states: Array, i: int) -> bool:
    """Whether the oil of column i stays constant."""
    return bool(states[RESTS, i, 0] != 0.0)


@compiled(inline=True)
def _is_cavity(cells: Array, states: Array, p_cav: float, i: int) -> bool:
    """Whether all cells of column i are at p_cav, whatever they hold, and gain no oil by themselves."""
    for j in range(states.shape[2]):
        if states[PRESSURE_SLOPE, i, j] != 0.0 or states[PRESSURE, i, j] != p_cav or cells[UNKNOWN, i, j] == 0.0:
            return False
        if states[SOURCE, i, j] != 0.0 or states[SOURCE_SLOPE, i, j] != 0.0 or states[FRACTION_SLOPE, i, j] == 0.0:
            return False
    return True


@compiled(inline=True)
def _passes_nothing(end: np.record, pressure: float) -> bool:
    """Whether nothing flows through an end of a section next to cells of this pressure."""
    return bool(end.kind == CLOSED or (end.kind == GIVEN and pressure == 0.0))


@compiled()
def find_resting(film: np.record, cells: Array, states: Array, still: bool, fields: Array) -> None:
    """The layer RESTS of states (STATES, m, k) <- in which columns of a film the oil stays constant. still: whether its
    cells turn with the oil. fields (m, k, n) <- 0 of columns that no longer do: nobody has solved for them."""
    m, p_cav = states.shape[1], film.scales.cavitation
    still = still and film.remembers and not film.carries_gas and film.roughness == 0.0 and film.clips == NO_CLIP
    still = still and _passes_nothing(film.near, p_cav) and _passes_nothing(film.far, p_cav)
    before, here = still and _is_cavity(cells, states, p_cav, m - 1), still and _is_cavity(cells, states, p_cav, 0)
    for i in range(m):
        behind = still and _is_cavity(cells, states, p_cav, i + 1 if i + 1 < m else 0)
        rested, keeps = rests(states, i), before and here and behind
        states[RESTS, i, 0] = 1.0 if keeps else 0.0
        if rested and not keeps:
            for j in range(fields.shape[1]):
                for side in range(fields.shape[2]):
                    fields[i, j, side] = 0.0
        before, here = here, behind
