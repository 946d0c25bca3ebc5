"""What the cells of one film hold by its law of cavitation, compiled."""

from __future__ import annotations

import math

from numba import njit

from frbcli.film.cell_law import cell_law
from frbcli.film.volume_data import (
    AMBIENT,
    BY_ECCENTRICITY_AND_SPEED,
    CAVITY,
    FIRST,
    FOLLOWS,
    GIVEN_PRESSURE,
    LAW,
    REFERENCE,
    SECOND,
    STANDS,
    UNKNOWN,
)

# Layers of the states of the cells, their slopes by w last.
PRESSURE, FRACTION, SOURCE, PRESSURE_SLOPE, FRACTION_SLOPE, SOURCE_SLOPE, STATES = range(7)


@njit(cache=True, error_model="numpy")
def law_parameters(numbers, d_x, d_y, speed):  # type: ignore[no-untyped-def]
    """The two parameters of a film's law at the displacement d and the speed omega_J + omega_S, (3.32)."""
    first, second = numbers[FIRST], numbers[SECOND]
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
