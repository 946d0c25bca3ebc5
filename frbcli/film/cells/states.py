"""What the cells of one film hold by its law of cavitation, compiled."""

from __future__ import annotations

import math

from numba import njit

from frbcli.film.cavitation.compiled import cell_law
from frbcli.film.cells.data import (
    AMBIENT,
    BY_ECCENTRICITY_AND_SPEED,
    BY_WHIRL,
    CAVITY,
    FIRST,
    FOLLOWS,
    GIVEN_PRESSURE,
    LAW,
    REFERENCE,
    SECOND,
    STANDS,
    UNKNOWN,
    WHIRLING,
)

# Layers of the states of the cells, their slopes by w last.
PRESSURE, FRACTION, SOURCE, PRESSURE_SLOPE, FRACTION_SLOPE, SOURCE_SLOPE, STATES = range(7)
CENTRE = 1e-6  # of the clearance, squared: a journal in the centre does not whirl
WHIRL_EDGE, WHIRL_STEP = 0.3, 0.15  # distance from 0.5 where no whirl is left, and over which it fades


@njit(cache=True, error_model="numpy")
def whirl_share(d_x, d_y, v_x, v_y, speed):  # type: ignore[no-untyped-def]
    """How far a journal is in half-frequency whirl, 0 to 1, by the rate of its attitude angle over omega_J + omega_S.

    1 between 0.35 and 0.65, 0 below 0.2 and above 0.8, a cubic step between: a synchronous orbit has 0 in the mean
    if it stays on one side of the centre, and 1 about the centre.
    """
    ratio = (d_x * v_y - d_y * v_x) / ((d_x * d_x + d_y * d_y + CENTRE) * (speed if speed != 0.0 else CENTRE))
    place = min(max((WHIRL_EDGE - abs(ratio - 0.5)) / WHIRL_STEP, 0.0), 1.0)
    return place * place * (3.0 - 2.0 * place)


@njit(cache=True, error_model="numpy")
def law_parameters(numbers, d_x, d_y, v_x, v_y, speed):  # type: ignore[no-untyped-def]
    """The two parameters of a film's law at the displacement d, its rate v and the speed omega_J + omega_S, (3.32)."""
    first, second = numbers[FIRST], numbers[SECOND]
    if numbers[FOLLOWS] == BY_WHIRL:
        return first + (numbers[WHIRLING] - first) * whirl_share(d_x, d_y, v_x, v_y, speed), second
    if numbers[FOLLOWS] != STANDS:
        second *= 10.0 ** (-2.0 * math.sqrt(d_x * d_x + d_y * d_y))
    if numbers[FOLLOWS] == BY_ECCENTRICITY_AND_SPEED:
        rate = max(abs(speed), 1.0)
        first, second = first * rate, second / rate
    return first, second


@njit(cache=True, error_model="numpy")
def cell_states(numbers, cells, first, second, drop, w, states):  # type: ignore[no-untyped-def]
    """states (STATES, m, k) <- of the cells with the unknowns w (m, k) by the law with these parameters. drop: by which
    the given pressures are lower than they were made."""
    m, k = w.shape
    kind = int(numbers[LAW])
    reference, cavity, ambient = numbers[REFERENCE], numbers[CAVITY], numbers[AMBIENT]
    for i in range(m):
        for j in range(k):
            if cells[UNKNOWN, i, j] == 0.0:
                states[PRESSURE, i, j], states[FRACTION, i, j], states[SOURCE, i, j] = (
                    cells[GIVEN_PRESSURE, i, j] - drop,
                    1.0,
                    0.0,
                )
                for layer in range(PRESSURE_SLOPE, STATES):
                    states[layer, i, j] = 0.0
            else:
                p, theta, q, p_w, theta_w, q_w = cell_law(kind, first, second, w[i, j], reference, cavity, ambient)
                states[PRESSURE, i, j], states[FRACTION, i, j], states[SOURCE, i, j] = p, theta, q
                states[PRESSURE_SLOPE, i, j], states[FRACTION_SLOPE, i, j] = p_w, theta_w
                states[SOURCE_SLOPE, i, j] = q_w
