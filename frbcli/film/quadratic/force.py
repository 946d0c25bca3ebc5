"""Force of a film on quadratic elements and its derivatives by displacement and velocity, for the time loop."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from frbcli.film.quadratic.film import ABSOLUTE_PENALTY, HALF_SOMMERFELD
from frbcli.film.quadratic.half_sommerfeld import clipped_loads, solve_linear
from frbcli.film.quadratic.operator import change_of_force, element_matrices
from frbcli.film.quadratic.penalty import penalty_scales, solve_penalty
from frbcli.film.quadratic.ring_solve import solve


@njit(cache=True, error_model="numpy")
def quadratic_force(film, state, d_x, d_y, v_x, v_y, omega):  # type: ignore[no-untyped-def]
    """Force of one whole bearing on the journal.

    film: QuadraticFilm; state (2 a, 2 k + 1): unknown of the penalty, from which it starts and which it leaves, unused
    by the other laws; d: displacement over the clearance (|d| < 1 is the caller's duty); v: its rate in 1/s; omega:
    omega_J + omega_S in rad/s.
    Returns the force (x, y) in N, its derivatives by d (xx, xy, yx, yy) in N and by v (xx, xy, yx, yy) in N s: ten
    numbers, nan where Newton's method for the penalty does not converge.
    """
    # w = v - (omega/2) J d: the motion seen from a frame that turns with half the speed (4.5)
    w_x, w_y = v_x + 0.5 * omega * d_y, v_y - 0.5 * omega * d_x
    pressure = np.zeros((1, state.shape[0], state.shape[1]))
    adjoint = np.empty((2, state.shape[0], state.shape[1]))
    change, by_w = np.zeros((2, 2)), np.zeros((2, 2))
    element_matrices(film, d_x, d_y)
    steeper_x = steeper_y = 0.0
    if film.law >= ABSOLUTE_PENALTY:
        eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
        a, b = penalty_scales(film, eccentricity, omega)
        slope = np.empty_like(state)
        if solve_penalty(film, state, pressure, slope, w_x, w_y, omega, a, b) == 0:
            pressure[:, :, :] = np.nan
    else:
        solve_linear(film, pressure, w_x, w_y, omega)
    p = pressure[0]
    if film.law == HALF_SOMMERFELD:
        f_x, f_y = clipped_loads(film, p, adjoint)
    else:
        f_x = f_y = 0.0
        for i in range(p.shape[0]):
            for j in range(p.shape[1]):
                for c in range(2):
                    adjoint[c, i, j] = film.moment[c, i, j]
                f_x += film.moment[0, i, j] * p[i, j]
                f_y += film.moment[1, i, j] * p[i, j]
    for i in range(p.shape[0]):
        for j in range(p.shape[1]):
            if film.fixed[i, j] > 0.0:
                adjoint[0, i, j] = adjoint[1, i, j] = 0.0
    solve(film.ring, adjoint)
    change_of_force(film, p, adjoint, change)
    for i in range(p.shape[0]):
        for j in range(p.shape[1]):
            for c in range(2):
                by_w[c, 0] -= adjoint[c, i, j] * film.moment[0, i, j]
                by_w[c, 1] -= adjoint[c, i, j] * film.moment[1, i, j]
    if film.law >= ABSOLUTE_PENALTY and eccentricity > 0.0:
        # b falls with the eccentricity: dq/deps = 2 ln(10) b (P - P_cav) q
        for i in range(p.shape[0]):
            for j in range(p.shape[1]):
                source = film.weight[i, j] * 2.0 * math.log(10.0) * (p[i, j] - film.level) * slope[i, j]
                steeper_x += adjoint[0, i, j] * source
                steeper_y += adjoint[1, i, j] * source
        change[0, 0] += steeper_x * d_x / eccentricity
        change[0, 1] += steeper_x * d_y / eccentricity
        change[1, 0] += steeper_y * d_x / eccentricity
        change[1, 1] += steeper_y * d_y / eccentricity
    scale, half = film.force_scale, 0.5 * omega
    return (
        scale * f_x, scale * f_y,
        scale * (change[0, 0] - half * by_w[0, 1]), scale * (change[0, 1] + half * by_w[0, 0]),
        scale * (change[1, 0] - half * by_w[1, 1]), scale * (change[1, 1] + half * by_w[1, 0]),
        scale * by_w[0, 0], scale * by_w[0, 1], scale * by_w[1, 0], scale * by_w[1, 1],
    )  # fmt: skip
