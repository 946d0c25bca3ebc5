"""One implicit stage of the time loop. Compiled.

The rotor is linear. One inverse E = (M + g D + g^2 K)^-1 with g = gamma h turns each implicit stage into an equation
for the velocities u of the journals alone,

    u = u_0 + S F(x(u), u),      x = x_0 + g u,      S = g P E P^T,

which Newton's method solves with the films' analytic derivatives: 2 x 2 for one bearing, however large the rotor is.
The products of E with D, K, G and the loads are made when the step changes, not in every stage (inverse.py).
"""

from __future__ import annotations

import math

from numba import njit

from frbcli.solve.dense import solve_dense
from frbcli.solve.film_forces import film_numbers, follow_channels, join_films, meet_channels, move_film
from frbcli.solve.inverse import E_COS, E_DAMPING, E_GYROSCOPIC, E_SIN, E_STATIC, E_STIFFNESS
from frbcli.solve.state import INVERSE_SPEED

NEWTON_LIMIT = 12  # iterations before a step is tried again with a smaller one
ELASTIC_LIMIT = 1.5  # eccentricity that no journal exceeds even under elastic contact
CLOSEST = 0.5  # share of the remaining gap that one Newton correction may close

# Rows of the scratch arrays: of a stage at the rotor's n degrees of freedom, and at the journals' m = 2 films.
# FREE is the acceleration without the films' forces; LATE the same with the gyroscopic term at the stage's own speed.
V, Q, FREE, LATE, STAGE_ROWS = range(5)
# u, u_0, x_0, forces, Newton's correction, and dF/du of each journal's own film by its x and y.
# OMEGA is omega_J + omega_S of the journal's own film.
U, U_0, X_0, FORCE, CORRECTION, BY_X, BY_Y, OMEGA, JOURNAL_ROWS = range(9)


@njit(cache=True, error_model="numpy")
def norm(x, y):  # type: ignore[no-untyped-def]
    return math.sqrt(x * x + y * y)


@njit(cache=True, error_model="numpy")
def limit_of(contact_stiffness):  # type: ignore[no-untyped-def]
    """Eccentricity that is no state any more: under elastic contact the shell gives way, else it ends at the shell."""
    return ELASTIC_LIMIT if contact_stiffness > 0.0 else 1.0


@njit(cache=True, error_model="numpy", inline="always")
def lagrange(a, b, c, t):  # type: ignore[no-untyped-def]
    """The three weights of the parabola through points at the times a, b, c, at the time t."""
    return (
        (t - b) * (t - c) / ((a - b) * (a - c)),
        (t - a) * (t - c) / ((b - a) * (b - c)),
        (t - a) * (t - b) / ((c - a) * (c - b)),
    )


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
def start_stage(  # type: ignore[no-untyped-def]
    weights, s, step, g, q, v, stage_v, stage_a, products, loads, pick, acceleration, speed, angle, gyroscopic, at, film
):
    """Fill V, Q, FREE of `at` and U_0, X_0 of `film`: what stage s knows before its films do."""
    n = q.shape[0]
    for i in range(n):
        sum_v, sum_a = 0.0, 0.0
        for j in range(s):
            sum_v += weights[s, j] * stage_v[i, j]
            sum_a += weights[s, j] * stage_a[i, j]
        at[V, i] = v[i] + step * sum_a
        at[Q, i] = q[i] + step * sum_v
    # The unbalance (2.3): along the angle with alpha'', outwards with alpha'^2
    sine, cosine = math.sin(angle), math.cos(angle)
    along = acceleration * cosine - speed * speed * sine
    across = acceleration * sine + speed * speed * cosine
    for i in range(n):
        total = loads[E_STATIC, i] + along * loads[E_COS, i] + across * loads[E_SIN, i]
        for j in range(n):
            total -= products[E_DAMPING, i, j] * at[V, j] + products[E_STIFFNESS, i, j] * (at[Q, j] + g * at[V, j])
        if gyroscopic:
            for j in range(n):
                total -= speed * products[E_GYROSCOPIC, i, j] * at[V, j]
        at[FREE, i] = total
    for k in range(pick.shape[0]):
        place, rate = 0.0, 0.0
        for i in range(n):
            place += pick[k, i] * at[Q, i]
            rate += pick[k, i] * (at[V, i] + g * at[FREE, i])
        film[X_0, k], film[U_0, k] = place, rate


@njit(cache=True, error_model="numpy", inline="always")
def begin_lag(numbers, g, speed, at):  # type: ignore[no-untyped-def]
    """The lag of `accelerate` in a stage of a gyroscopic rotor, which begins with the speed of its inverse: LATE."""
    for i in range(at.shape[1]):
        at[LATE, i] = at[FREE, i]
    return g * (speed - numbers[INVERSE_SPEED])


@njit(cache=True, error_model="numpy", inline="always")
def guess(points, three, s, pick, q, clearances, g, t, limit, film):  # type: ignore[no-untyped-def]
    """u of the stage at time t by extrapolation; a guess beyond the shell is drawn back to where the journal is.

    points: (p, 1 + m) times and journals' velocities of this step and the one before; three: (s, 3) which of them carry
    the parabola of stage s.
    """
    i_a, i_b, i_c = three[s, 0], three[s, 1], three[s, 2]
    weight_a, weight_b, weight_c = lagrange(points[i_a, 0], points[i_b, 0], points[i_c, 0], t)
    for i in range(pick.shape[0]):
        film[U, i] = weight_a * points[i_a, 1 + i] + weight_b * points[i_b, 1 + i] + weight_c * points[i_c, 1 + i]
    for f in range(clearances.shape[0]):
        x, y = 2 * f, 2 * f + 1
        if norm(film[X_0, x] + g * film[U, x], film[X_0, y] + g * film[U, y]) > 0.999 * limit * clearances[f]:
            here_x, here_y = 0.0, 0.0
            for i in range(q.shape[0]):
                here_x += pick[x, i] * q[i]
                here_y += pick[y, i] * q[i]
            film[U, x], film[U, y] = (here_x - film[X_0, x]) / g, (here_y - film[X_0, y]) / g


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


@njit(cache=True, error_model="numpy", inline="always")
def accelerate(s, g, lag, products, spread, pick, at, film, stage_v, stage_a):  # type: ignore[no-untyped-def]
    """Velocity and acceleration of stage s from the films' forces; with a lag also LATE and U_0 for the next iteration.

    lag: g times the difference between the stage's speed and that of the inverse, for the rest of the gyroscopic term.
    """
    n, m = at.shape[1], pick.shape[0]
    row = FREE if lag == 0.0 else LATE
    for i in range(n):
        total = at[row, i]
        for j in range(m):
            total += spread[i, j] * film[FORCE, j]
        stage_a[i, s] = total
        stage_v[i, s] = at[V, i] + g * total
    if lag != 0.0:
        for i in range(n):
            total = at[FREE, i]
            for j in range(n):
                total -= lag * products[E_GYROSCOPIC, i, j] * stage_a[j, s]
            at[LATE, i] = total
        for k in range(m):
            rate = 0.0
            for i in range(n):
                rate += pick[k, i] * (at[V, i] + g * at[LATE, i])
            film[U_0, k] = rate
