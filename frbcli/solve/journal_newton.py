"""Newton's method for the velocities of the journals in a stage, with the films' analytic derivatives. Compiled.

The equations are those of stage.py. Films with cells are corrected along with the journals.
"""

from __future__ import annotations

import math

from numba import njit

from frbcli.solve.dense import solve_dense
from frbcli.solve.film_forces import film_numbers, follow_channels, join_films, meet_channels, move_film
from frbcli.solve.stage import BY_X, BY_Y, CORRECTION, FORCE, OMEGA, U_0, X_0, U, norm

NEWTON_LIMIT = 12  # iterations before a step is tried again with a smaller one
CLOSEST = 0.5  # share of the remaining gap that one Newton correction may close


@njit(cache=True, error_model="numpy", inline="always")
def _bearing(  # type: ignore[no-untyped-def]
    films, work, f, d_x, d_y, v_x, v_y, speed, g, s, iteration, clearance, contact_at, contact_stiffness
):
    """The film's force plus, beyond the contact eccentricity, the elastic contact of the case."""
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = film_numbers(
        films, work, f, d_x, d_y, v_x, v_y, speed, g, s, iteration
    )
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if contact_stiffness > 0.0 and eccentricity > contact_at:
        k = contact_stiffness * clearance
        along = k * (1.0 - contact_at / eccentricity)
        n_x, n_y = d_x / eccentricity, d_y / eccentricity
        f_x -= along * d_x
        f_y -= along * d_y
        k_xx -= along + (k - along) * n_x * n_x
        k_xy -= (k - along) * n_x * n_y
        k_yx -= (k - along) * n_x * n_y
        k_yy -= along + (k - along) * n_y * n_y
    return f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy


@njit(cache=True, error_model="numpy", inline="always")
def _solve_small(matrix, film):  # type: ignore[no-untyped-def]
    """CORRECTION <- matrix^-1 CORRECTION for the few journals' equations; closed form for one bearing."""
    if matrix.shape[0] == 2:
        det = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
        x, y = film[CORRECTION, 0], film[CORRECTION, 1]
        film[CORRECTION, 0] = (matrix[1, 1] * x - matrix[0, 1] * y) / det
        film[CORRECTION, 1] = (matrix[0, 0] * y - matrix[1, 0] * x) / det
    else:
        right = film[CORRECTION : CORRECTION + 1].reshape(-1, 1)  # a view: solved in place
        solve_dense(matrix, right)


@njit(cache=True, error_model="numpy")
def reach(d_x, d_y, c_x, c_y, limit):  # type: ignore[no-untyped-def]
    """Largest factor <= 1 by which the correction c may be applied: the gap to `limit` keeps a share of itself."""
    here = norm(d_x, d_y)
    there = norm(d_x + c_x, d_y + c_y)
    allowed = here + CLOSEST * (limit - here)
    factor = 1.0
    while there > allowed and factor > 1e-6:
        factor *= 0.5
        there = norm(d_x + factor * c_x, d_y + factor * c_y)
    return factor


@njit(cache=True, error_model="numpy", inline="always")
def forces(films, work, clearances, contact_at, contact_stiffness, g, s, iteration, film):  # type: ignore[no-untyped-def]
    """Fill FORCE, BY_X, BY_Y at the velocities U, and what coupled channels add to them, see join_films."""
    meet_channels(films, work, film[X_0], film[U], film[OMEGA], clearances, g, iteration)
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = _bearing(
            films,
            work,
            f,
            (film[X_0, x] + g * film[U, x]) / c,
            (film[X_0, y] + g * film[U, y]) / c,
            film[U, x] / c,
            film[U, y] / c,
            film[OMEGA, x],
            g,
            s,
            iteration,
            c,
            contact_at,
            contact_stiffness,
        )
        film[FORCE, x], film[FORCE, y] = f_x, f_y
        film[BY_X, x], film[BY_Y, x] = (d_xx + g * k_xx) / c, (d_xy + g * k_xy) / c
        film[BY_X, y], film[BY_Y, y] = (d_yx + g * k_yx) / c, (d_yy + g * k_yy) / c
    join_films(films, work, clearances, film[FORCE])


@njit(cache=True, error_model="numpy", inline="always")
def correct(films, work, compliance, clearances, g, limit, film, newton):  # type: ignore[no-untyped-def]
    """One correction of U by Newton's method, and of the films' cells with it.

    Returns (share of it that was applied, what may be left of the error of a smooth force, how far the journals moved
    over their clearances, films whose cells had not settled). What may be left is infinite for a correction that is
    not finite.
    """
    m, crossed = compliance.shape[0], work.cross.shape[0]
    for i in range(m):
        total = film[U_0, i] - film[U, i]
        for j in range(m):
            total += compliance[i, j] * film[FORCE, j]
            x = j - j % 2
            slope = BY_X + j % 2
            newton[i, j] = -(compliance[i, x] * film[slope, x] + compliance[i, x + 1] * film[slope, x + 1])
            for a in range(crossed):
                newton[i, j] -= compliance[i, a] * work.cross[a, j]
        newton[i, i] += 1.0
        film[CORRECTION, i] = total
    _solve_small(newton, film)
    share, moved, left, unsettled = 1.0, 0.0, 0.0, 0
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        at_x, at_y = (film[X_0, x] + g * film[U, x]) / c, (film[X_0, y] + g * film[U, y]) / c
        c_x, c_y = g * film[CORRECTION, x] / c, g * film[CORRECTION, y] / c
        move = norm(c_x, c_y)
        if not math.isfinite(move):
            return 0.0, math.inf, math.inf, 0
        moved = max(moved, move)
        share = min(share, reach(at_x, at_y, c_x, c_y, limit))
        # Newton's method squares its error. A film's force bends over the size of the gap and, being proportional to
        # |w|, over the size of w.
        half = 0.5 * film[OMEGA, x]
        film_speed = norm(film[U, x] / c + half * at_y, film[U, y] / c - half * at_x)
        left = max(left, move * move * (1.0 / (limit - norm(at_x, at_y)) + 1.0 / (g * film_speed + 1e-30)))
    for i in range(m):
        film[U, i] += share * film[CORRECTION, i]
    for i in range(m):  # the forces at the corrected velocities, to first order: what Newton's equations have used
        x = i - i % 2
        film[FORCE, i] += share * (film[BY_X, i] * film[CORRECTION, x] + film[BY_Y, i] * film[CORRECTION, x + 1])
        for j in range(crossed):
            film[FORCE, i] += share * work.cross[i, j] * film[CORRECTION, j]
    follow_channels(films, work, film[CORRECTION], share)
    for f in range(clearances.shape[0]):
        c = clearances[f]
        unsettled += move_film(
            films, work, f, share * film[CORRECTION, 2 * f] / c, share * film[CORRECTION, 2 * f + 1] / c, g
        )
    return share, min(left, moved), moved, unsettled
