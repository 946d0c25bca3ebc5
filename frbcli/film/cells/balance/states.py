"""Pressures and oil fractions of the cells of one film by its cavitation law, compiled."""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import ECCENTRICITY, LAW_NUMBERS, MOTION, SPEED, WHIRL, call_cells, call_follow
from frbcli.film.cells.data import GIVEN_PRESSURE, UNKNOWN

# Layers of the states of the cells: of the law, the slopes by w last; the free gas that comes into the cell, and the
# rate of its oil, as the law takes them, see balance.py in gas/, the free gas of the cell and how much of that which
# comes in it has at the same pressure; the oil fraction before the cell upstream of the face after each cell, as it is
# held, see carried.py; and, in the first cell of a column, whether the column keeps its oil, see resting.py.
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
    """states (STATES, m, k) <- of the cells with the unknowns w (m, k) by the law as follow_law has it; all arrays in
    one piece. drop: by which the given pressures are lower than they were made."""
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
    """film <- the share of the given pressures and the oil fraction of its openings at a filling: feed_at of feed.py,
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
