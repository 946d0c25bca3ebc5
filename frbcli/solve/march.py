"""The time loop: rotor and films advanced together by an implicit Runge-Kutta method with error control. Compiled.

The rotor is linear. One inverse E = (M + g D + g^2 K)^-1 with g = gamma h turns each implicit stage into an equation
for the velocities u of the journals alone,

    u = u_0 + S F(x(u), u),      x = x_0 + g u,      S = g P E P^T,

which Newton's method solves with the films' analytic derivatives: 2 x 2 for one bearing, however large the rotor is.
The products of E with D, K, G and the loads are made when the step changes, not in every stage.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from frbcli.film.kernel import film_force
from frbcli.rotor.excitation import rotation
from frbcli.solve.dense import solve_dense

Array = NDArray[np.float64]

RUNNING, FINISHED, CONTACT, STUCK = range(4)
NEWTON_LIMIT = 12  # iterations before a step is tried again with a smaller one
NEWTON_SHARE = 0.02  # of the tolerance that Newton's method may leave undone
SAFETY = 0.9  # of the step that the error estimate would allow
GROWTH = 1.2  # a step is enlarged only if it pays for the new inverse
LASTING = 0.95  # of the longest allowed step: a step chosen there lasts a while before the speed outgrows it
SMALLEST_STEP = 1e-12  # s
ERROR_MEMORY = 0.1  # s: how long a local error is taken to live on in a damped rotor
UNSOLVED = 1e3  # stands for the error of a step that Newton's method did not solve
ELASTIC_LIMIT = 1.5  # eccentricity that no journal exceeds even under elastic contact
INVERSE_LASTS = 0.01  # relative change of the speed over which a gyroscopic rotor keeps its inverse
LAG_SWEEPS = 2  # iterations that bring the rest of the gyroscopic term below 1e-8: each gains a factor of 1000
CLOSEST = 0.5  # share of the remaining gap that one Newton correction may close


class RotorData(NamedTuple):
    """The arrays of a LinearRotor, its speed profile and clearances; see LinearRotor for shapes and units."""

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    static_load: Array
    unbalance_cos: Array
    unbalance_sin: Array
    journals: Array
    multiplicity: Array
    clearances: Array
    observed: Array  # (p, n) displacements under error control, over their clearance
    has_gyroscopic: bool
    profile_times: Array
    profile_speeds: Array
    profile_angles: Array


class Control(NamedTuple):
    """What the time loop may do. tolerance: local error of a displacement over the clearance; longest_step in s;
    steps_per_revolution: at least; output_step in s; contact_eccentricity; contact_stiffness in N/m, 0: stop there."""

    tolerance: float
    steps_per_revolution: float
    longest_step: float
    output_step: float
    contact_eccentricity: float
    contact_stiffness: float


# Positions in the state's array of numbers; what a run must keep to go on as if it had not stopped.
(TIME, STEP, ERROR_BEFORE, PIECE, OUTPUTS, STEPS, REJECTED, SOLVES, TURNS, ERROR_NOW, ERROR_LARGEST, LARGEST_EPS,
 INVERSE_G, INVERSE_SPEED, STEP_BEFORE, NUMBERS) = range(16)
HISTORY = 3  # stages remembered to predict the next one


class State(NamedTuple):
    """Everything that changes. numbers: (NUMBERS,); q, v, a: (n,) displacement, velocity, acceleration;
    past: (HISTORY, 1 + 2 films) time and journals' velocities of the last stages."""

    numbers: Array
    q: Array
    v: Array
    a: Array
    past: Array


# Rows of the scratch arrays: of a stage at the rotor's n degrees of freedom, and at the journals' m = 2 films.
# FREE is the acceleration without the films' forces; LATE the same with the gyroscopic term at the stage's own speed.
V, Q, FREE, LATE, STAGE_ROWS = range(5)
# u, u_0, x_0, forces, Newton's correction, and dF/du of each journal's own film by its x and y.
U, U_0, X_0, FORCE, CORRECTION, BY_X, BY_Y, JOURNAL_ROWS = range(8)
# Products of the inverse E with the matrices and the loads.
E_DAMPING, E_STIFFNESS, E_GYROSCOPIC = range(3)
E_STATIC, E_COS, E_SIN = range(3)


@njit(cache=True, error_model="numpy")
def _norm(x, y):  # type: ignore[no-untyped-def]
    return math.sqrt(x * x + y * y)


@njit(cache=True, error_model="numpy", inline="always")
def _bearing(film, d_x, d_y, v_x, v_y, speed, clearance, contact_at, contact_stiffness):  # type: ignore[no-untyped-def]
    """film_force plus, beyond the contact eccentricity, the elastic contact of the case."""
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = film_force(film, d_x, d_y, v_x, v_y, speed)
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
def _reach(d_x, d_y, c_x, c_y, limit):  # type: ignore[no-untyped-def]
    """Largest factor <= 1 by which the correction c may be applied: the gap to `limit` keeps a share of itself."""
    here = _norm(d_x, d_y)
    there = _norm(d_x + c_x, d_y + c_y)
    allowed = here + CLOSEST * (limit - here)
    factor = 1.0
    while there > allowed and factor > 1e-6:
        factor *= 0.5
        there = _norm(d_x + factor * c_x, d_y + factor * c_y)
    return factor


@njit(cache=True, error_model="numpy")
def _prepare(rotor, pick, g, speed, products, loads, spread, compliance):  # type: ignore[no-untyped-def]
    """Make the inverse E for this g and speed and keep its products, see advance for their shapes."""
    n, m = rotor.mass.shape[0], pick.shape[0]
    # One elimination for all right-hand sides: the three matrices, the three loads, the journals.
    dynamic, right = np.empty((n, n)), np.empty((n, 3 * n + 3 + m))
    for i in range(n):
        for j in range(n):
            dynamic[i, j] = rotor.mass[i, j] + g * (
                rotor.damping[i, j] + speed * rotor.gyroscopic[i, j] + g * rotor.stiffness[i, j])
            right[i, j] = rotor.damping[i, j]
            right[i, n + j] = rotor.stiffness[i, j]
            right[i, 2 * n + j] = rotor.gyroscopic[i, j]
        right[i, 3 * n] = rotor.static_load[i]
        right[i, 3 * n + 1] = rotor.unbalance_cos[i]
        right[i, 3 * n + 2] = rotor.unbalance_sin[i]
        for k in range(m):
            right[i, 3 * n + 3 + k] = pick[k, i] * rotor.multiplicity[k // 2]
    solve_dense(dynamic, right)
    for i in range(n):
        for j in range(n):
            products[E_DAMPING, i, j] = right[i, j]
            products[E_STIFFNESS, i, j] = right[i, n + j]
            products[E_GYROSCOPIC, i, j] = right[i, 2 * n + j]
        for k in range(3):
            loads[k, i] = right[i, 3 * n + k]
        for k in range(m):
            spread[i, k] = right[i, 3 * n + 3 + k]
    for k in range(m):
        for j in range(m):
            total = 0.0
            for i in range(n):
                total += pick[k, i] * spread[i, j]
            compliance[k, j] = g * total


@njit(cache=True, error_model="numpy", inline="always")
def _start_stage(  # type: ignore[no-untyped-def]
    weights, s, step, g, q, v, stage_v, stage_a, products, loads, pick, acceleration, speed, angle, gyroscopic, at, film
):
    """Fill V, Q, FREE of `at` and U_0, X_0 of `film`: what stage s knows before its films do. weights: (s,) its row."""
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
def _guess(past, pick, q, clearances, g, t, limit, film):  # type: ignore[no-untyped-def]
    """u of the stage at time t by extrapolation; a guess beyond the shell is drawn back to where the journal is.

    past: (HISTORY, 1 + m) times and velocities of the last stages; the parabola through them is continued.
    """
    a, b, c = past[0, 0], past[1, 0], past[2, 0]
    weight_a = (t - b) * (t - c) / ((a - b) * (a - c))
    weight_b = (t - a) * (t - c) / ((b - a) * (b - c))
    weight_c = (t - a) * (t - b) / ((c - a) * (c - b))
    for i in range(pick.shape[0]):
        film[U, i] = weight_a * past[0, 1 + i] + weight_b * past[1, 1 + i] + weight_c * past[2, 1 + i]
    for f in range(clearances.shape[0]):
        x, y = 2 * f, 2 * f + 1
        if _norm(film[X_0, x] + g * film[U, x], film[X_0, y] + g * film[U, y]) > 0.999 * limit * clearances[f]:
            here_x, here_y = 0.0, 0.0
            for i in range(q.shape[0]):
                here_x += pick[x, i] * q[i]
                here_y += pick[y, i] * q[i]
            film[U, x], film[U, y] = (here_x - film[X_0, x]) / g, (here_y - film[X_0, y]) / g


@njit(cache=True, error_model="numpy", inline="always")
def _forces(films, clearances, contact_at, contact_stiffness, g, speed, film):  # type: ignore[no-untyped-def]
    """Fill FORCE, BY_X, BY_Y at the velocities U."""
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = _bearing(
            films[f], (film[X_0, x] + g * film[U, x]) / c, (film[X_0, y] + g * film[U, y]) / c,
            film[U, x] / c, film[U, y] / c, speed, c, contact_at, contact_stiffness)
        film[FORCE, x], film[FORCE, y] = f_x, f_y
        film[BY_X, x], film[BY_Y, x] = (d_xx + g * k_xx) / c, (d_xy + g * k_xy) / c
        film[BY_X, y], film[BY_Y, y] = (d_yx + g * k_yx) / c, (d_yy + g * k_yy) / c


@njit(cache=True, error_model="numpy", inline="always")
def _correct(compliance, clearances, g, speed, limit, film, newton):  # type: ignore[no-untyped-def]
    """One correction of U by Newton's method. Returns (share of it that was applied, what may be left of the error).

    What may be left is infinite for a correction that is not finite.
    """
    m = compliance.shape[0]
    for i in range(m):
        total = film[U_0, i] - film[U, i]
        for j in range(m):
            total += compliance[i, j] * film[FORCE, j]
            x = j - j % 2
            slope = BY_X + j % 2
            newton[i, j] = -(compliance[i, x] * film[slope, x] + compliance[i, x + 1] * film[slope, x + 1])
        newton[i, i] += 1.0
        film[CORRECTION, i] = total
    _solve_small(newton, film)
    share, moved, left = 1.0, 0.0, 0.0
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        at_x, at_y = (film[X_0, x] + g * film[U, x]) / c, (film[X_0, y] + g * film[U, y]) / c
        c_x, c_y = g * film[CORRECTION, x] / c, g * film[CORRECTION, y] / c
        move = _norm(c_x, c_y)
        if not math.isfinite(move):
            return 0.0, math.inf
        moved = max(moved, move)
        share = min(share, _reach(at_x, at_y, c_x, c_y, limit))
        # Newton's method squares its error. A film's force bends over the size of the gap and, being proportional to
        # |w|, over the size of w.
        film_speed = _norm(film[U, x] / c + 0.5 * speed * at_y, film[U, y] / c - 0.5 * speed * at_x)
        left = max(left, move * move * (1.0 / (limit - _norm(at_x, at_y)) + 1.0 / (g * film_speed + 1e-30)))
    for i in range(m):
        film[U, i] += share * film[CORRECTION, i]
    for i in range(m):  # the forces at the corrected velocities, to first order: what Newton's equations have used
        x = i - i % 2
        film[FORCE, i] += share * (film[BY_X, i] * film[CORRECTION, x] + film[BY_Y, i] * film[CORRECTION, x + 1])
    return share, min(left, moved)


@njit(cache=True, error_model="numpy", inline="always")
def _accelerate(s, g, lag, products, spread, pick, at, film, stage_v, stage_a):  # type: ignore[no-untyped-def]
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


@njit(cache=True, error_model="numpy")
def _local_error(defect, observed, stage_v, stage_a, step, g):  # type: ignore[no-untyped-def]
    """Largest embedded error of the observed displacements, over their clearances; velocities count times g."""
    n, stages = stage_v.shape
    error = 0.0
    for p in range(observed.shape[0]):
        in_q, in_v = 0.0, 0.0
        for i in range(n):
            if observed[p, i] != 0.0:
                defect_q, defect_v = 0.0, 0.0
                for j in range(stages):
                    defect_q += defect[j] * stage_v[i, j]
                    defect_v += defect[j] * stage_a[i, j]
                in_q += observed[p, i] * defect_q
                in_v += observed[p, i] * defect_v
        error = max(error, abs(step * in_q), abs(step * g * in_v))
    return error


@njit(cache=True, error_model="numpy")
def _write_outputs(numbers, stage_v, output_step, t, step, t_new, q, q_new, out_q, out_v, written):  # type: ignore[no-untyped-def]
    """Dense output: the cubic through displacements and velocities at both ends of a step. Returns rows written."""
    last = stage_v.shape[1] - 1
    while numbers[OUTPUTS] * output_step <= t_new * (1.0 + 1e-12):
        x = min(max((numbers[OUTPUTS] * output_step - t) / step, 0.0), 1.0)
        for i in range(q.shape[0]):
            left, right, rise = step * stage_v[i, 0], step * stage_v[i, last], q_new[i] - q[i]
            square, cube = 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise
            out_q[written, i] = q[i] + x * (left + x * (square + x * cube))
            out_v[written, i] = (left + x * (2.0 * square + 3.0 * x * cube)) / step
        written += 1
        numbers[OUTPUTS] += 1
    return written


@njit(cache=True, error_model="numpy")
def _step_after(h, error, before, order):  # type: ignore[no-untyped-def]
    """Proportional-integral control: the step after an accepted one; errors over the tolerance, now and before."""
    ratio = SAFETY * max(error, 1e-8) ** (-0.7 / order) * max(before, 1e-8) ** (0.3 / order)
    ratio = min(5.0, max(0.2, ratio))
    return h * ratio if ratio < 1.0 or ratio > GROWTH else h


@njit(cache=True, error_model="numpy")
def _step_to_take(h, before, remaining, speed, steps_per_revolution, longest):  # type: ignore[no-untyped-def]
    """(step that the controller keeps, step to take now): some of a revolution, and never across a kink of the profile.

    A step near the one before is the one before: a new step costs a new inverse.
    """
    if speed != 0.0:
        longest = min(longest, 2.0 * math.pi / (abs(speed) * steps_per_revolution))
    if h > longest:
        h = before if LASTING**2 * longest < before <= longest else LASTING * longest
    if h > remaining * (1.0 - 1e-9):
        return h, remaining
    if h > 0.5 * remaining:
        return h, 0.5 * remaining
    return h, h


@njit(cache=True, error_model="numpy")
def _largest_eccentricity(clearances, pick, q):  # type: ignore[no-untyped-def]
    largest = 0.0
    for f in range(clearances.shape[0]):
        x, y = 0.0, 0.0
        for i in range(q.shape[0]):
            x += pick[2 * f, i] * q[i]
            y += pick[2 * f + 1, i] * q[i]
        largest = max(largest, _norm(x, y) / clearances[f])
    return largest


@njit(cache=True, error_model="numpy")
def advance(rotor, films, tableau, control, state, budget, out_q, out_v):  # type: ignore[no-untyped-def]
    """Advance the state until the output buffers are full, `budget` steps are done, or the run ends.

    out_q, out_v: (rows, n) buffers for displacements and velocities at the output times; there must be two rows more
    than one step can write. Returns (status, rows written). The course of the steps does not depend on how often this
    is called.
    """
    # The parts of the tuples are taken out once: to pass a tuple on costs more than a stage does.
    numbers, q, v, a, past_now = state.numbers, state.q, state.v, state.a, state.past
    times, speeds, angles = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    clearances, observed, gyroscopic = rotor.clearances, rotor.observed, rotor.has_gyroscopic
    weights, moments, defect = tableau.stage, tableau.times, tableau.defect
    tolerance, contact_at, contact_stiffness = (
        control.tolerance, control.contact_eccentricity, control.contact_stiffness)
    n, m, stages = q.shape[0], 2 * clearances.shape[0], moments.shape[0]
    gamma, last, order = weights[1, 1], stages - 1, tableau.order + 1.0
    # Under elastic contact the shell gives way; without, a journal beyond the shell is no state at all.
    limit = ELASTIC_LIMIT if contact_stiffness > 0.0 else 1.0

    pick = np.empty((m, n))
    for k in range(m):
        pick[k] = rotor.journals[k // 2, k % 2]
    products, loads = np.zeros((3, n, n)), np.zeros((3, n))
    spread, compliance, newton = np.zeros((n, m)), np.zeros((m, m)), np.zeros((m, m))
    at, film = np.zeros((STAGE_ROWS, n)), np.zeros((JOURNAL_ROWS, m))
    stage_v, stage_a = np.zeros((n, stages)), np.zeros((n, stages))
    past, q_new = np.zeros((HISTORY, 1 + m)), np.zeros(n)
    inverse_g, inverse_speed = numbers[INVERSE_G], numbers[INVERSE_SPEED]
    if inverse_g > 0.0:
        _prepare(rotor, pick, inverse_g, inverse_speed, products, loads, spread, compliance)
    written, done = 0, 0

    while done < budget:
        t, piece = numbers[TIME], int(numbers[PIECE])
        if t >= times[piece + 1] and piece + 2 < times.shape[0]:
            piece += 1
            numbers[PIECE] = piece
        if t >= times[-1]:
            return FINISHED, written
        acceleration, speed, angle = rotation(times, speeds, angles, piece, t)
        h, step = _step_to_take(
            numbers[STEP], numbers[STEP_BEFORE], times[piece + 1] - t, speed, control.steps_per_revolution,
            control.longest_step)
        if written + int(step / control.output_step) + 2 > out_q.shape[0]:
            return RUNNING, written

        for k in range(HISTORY):
            for i in range(1 + m):
                past[k, i] = past_now[k, i]
        for i in range(n):
            stage_v[i, 0], stage_a[i, 0] = v[i], a[i]
        g, solved = gamma * step, True
        for s in range(1, stages):
            t_s = t + moments[s] * step
            acceleration, speed, angle = rotation(times, speeds, angles, piece, t_s)
            if g != inverse_g or (gyroscopic and abs(speed - inverse_speed) > INVERSE_LASTS * abs(speed)):
                inverse_g, inverse_speed = g, speed
                numbers[INVERSE_G], numbers[INVERSE_SPEED] = g, speed
                _prepare(rotor, pick, g, speed, products, loads, spread, compliance)
            _start_stage(weights, s, step, g, q, v, stage_v, stage_a, products, loads, pick, acceleration, speed, angle,
                         gyroscopic, at, film)
            _guess(past, pick, q, clearances, g, t_s, limit, film)
            lag = g * (speed - inverse_speed) if gyroscopic else 0.0
            if lag != 0.0:  # begin with the acceleration of the stage before
                for i in range(n):
                    at[LATE, i] = at[FREE, i]
            solved = False
            for iteration in range(NEWTON_LIMIT):
                _forces(films, clearances, contact_at, contact_stiffness, g, speed, film)
                numbers[SOLVES] += m // 2
                share, left = _correct(compliance, clearances, g, speed, limit, film, newton)
                if left == math.inf:
                    break
                if share == 1.0:
                    _accelerate(s, g, lag, products, spread, pick, at, film, stage_v, stage_a)
                    if left < NEWTON_SHARE * tolerance and (lag == 0.0 or iteration >= LAG_SWEEPS):
                        solved = True
                        break
            if not solved:
                break
            for i in range(1 + m):
                past[0, i], past[1, i] = past[1, i], past[2, i]
            past[2, 0] = t_s
            for i in range(m):
                past[2, 1 + i] = film[U, i]
        error = _local_error(defect, observed, stage_v, stage_a, step, g) / tolerance if solved else UNSOLVED
        if not error <= 1.0:  # not a number counts as too large
            numbers[REJECTED] += 1
            shrink = SAFETY * error ** (-1.0 / order) if math.isfinite(error) else 0.0
            numbers[STEP] = step * max(0.2, shrink)
            if numbers[STEP] < SMALLEST_STEP:
                return STUCK, written
            continue

        t_new = t + step
        if t_new >= times[piece + 1] * (1.0 - 1e-15):
            t_new = times[piece + 1]
        for i in range(n):
            total = 0.0
            for j in range(stages):
                total += weights[last, j] * stage_v[i, j]
            q_new[i] = q[i] + step * total
        written = _write_outputs(numbers, stage_v, control.output_step, t, step, t_new, q, q_new, out_q, out_v, written)
        for i in range(n):
            q[i], v[i], a[i] = q_new[i], stage_v[i, last], stage_a[i, last]
        for k in range(HISTORY):
            for i in range(1 + m):
                past_now[k, i] = past[k, i]
        numbers[TIME] = t_new
        numbers[STEPS] += 1
        numbers[TURNS] += abs(speed) * step / (2.0 * math.pi)
        numbers[ERROR_NOW] = numbers[ERROR_NOW] * math.exp(-step / ERROR_MEMORY) + error * tolerance
        numbers[ERROR_LARGEST] = max(numbers[ERROR_LARGEST], numbers[ERROR_NOW])
        largest = _largest_eccentricity(clearances, pick, q)
        numbers[LARGEST_EPS] = max(numbers[LARGEST_EPS], largest)
        done += 1
        if contact_stiffness == 0.0 and largest >= contact_at:
            return CONTACT, written
        numbers[STEP] = _step_after(h, error, numbers[ERROR_BEFORE], order)
        numbers[ERROR_BEFORE] = error
        numbers[STEP_BEFORE] = h
    return RUNNING, written
