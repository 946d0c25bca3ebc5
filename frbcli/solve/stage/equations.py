"""One implicit stage of the time loop. Compiled.

The rotor is linear. One inverse E = (M + g D + g^2 K)^-1 with g = gamma h turns each implicit stage into an equation
for the velocities u of the journals alone,

    u = u_0 + S F(x(u), u),      x = x_0 + g u,      S = g P E P^T,

which Newton's method solves (journal_newton.py): 2 x 2 for one bearing, however large the rotor is. The products of E
with D, K, G and the loads are made when the step changes, not in every stage (prepare).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import Indices, compiled
from frbcli.dense import solve_dense
from frbcli.film.roughness.contact import ELASTIC_LIMIT
from frbcli.solve.state import INVERSE_G, INVERSE_SPEED, RotorData

LASTS = 0.01  # relative change of the speed over which a gyroscopic rotor keeps its inverse
LAG_SWEEPS = 2  # iterations that bring the rest of the gyroscopic term below 1e-8: each gains a factor of 1000

# Products of the inverse E with the matrices and the loads.
E_DAMPING, E_STIFFNESS, E_GYROSCOPIC = range(3)
E_STATIC, E_COS, E_SIN = range(3)


@compiled(inline=True)
def outdated(numbers: Array, g: float, speed: float, gyroscopic: bool, follows_speed: bool) -> bool:
    """Whether the inverse noted in the numbers does not serve a stage with this g and speed."""
    if follows_speed:
        return bool(g != numbers[INVERSE_G] or speed != numbers[INVERSE_SPEED])
    return g != numbers[INVERSE_G] or (gyroscopic and abs(speed - numbers[INVERSE_SPEED]) > LASTS * abs(speed))


@compiled()
def add_table(rotor: RotorData, g: float, speed: float, dynamic: Array, right: Array) -> None:
    """Add what elements put on the rotor at this speed to M + g D + g^2 K, and to the columns of D and K in `right`."""
    n, last, below = rotor.mass.shape[0], rotor.table_speeds.shape[0] - 1, 0
    while below < last and rotor.table_speeds[below + 1] <= speed:
        below += 1
    above = min(below + 1, last)
    width = rotor.table_speeds[above] - rotor.table_speeds[below]
    share = max(speed - rotor.table_speeds[below], 0.0) / width if width > 0.0 else 0.0
    for i in range(n):
        for j in range(n):
            m, d = rotor.table_mass[below, i, j], rotor.table_damping[below, i, j]
            k = rotor.table_stiffness[below, i, j]
            m += share * (rotor.table_mass[above, i, j] - m)
            d += share * (rotor.table_damping[above, i, j] - d)
            k += share * (rotor.table_stiffness[above, i, j] - k)
            dynamic[i, j] += m + g * (d + g * k)
            right[i, j] += d
            right[i, n + j] += k


@compiled()
def prepare(
    rotor: RotorData, selection: Array, numbers: Array, g: float, speed: float, products: Array, loads: Array,
    spread: Array, compliance: Array, elimination: Array,
) -> None:  # fmt: skip
    """Make the inverse E for this g and speed, keep its products, and book in the numbers for what they are.

    products (3, n, n), loads (3, n): of E with the matrices and loads in the order of E_...; spread (n, m): with the
    forces on the journals; compliance (m, m): S of equations.py; elimination (2, n, 3 n + 3 + m): to work in.
    """
    n, m = rotor.mass.shape[0], selection.shape[0]
    numbers[INVERSE_G], numbers[INVERSE_SPEED] = g, speed
    # One elimination for all right-hand sides: the three matrices, the three loads, the journals.
    dynamic, right = elimination[0], elimination[1]
    for i in range(n):
        for j in range(n):
            dynamic[i, j] = rotor.mass[i, j] + g * (
                rotor.damping[i, j] + speed * rotor.gyroscopic[i, j] + g * rotor.stiffness[i, j]
            )
            right[i, j] = rotor.damping[i, j]
            right[i, n + j] = rotor.stiffness[i, j]
            right[i, 2 * n + j] = rotor.gyroscopic[i, j]
        right[i, 3 * n] = rotor.static_load[i]
        right[i, 3 * n + 1] = rotor.unbalance_cos[i]
        right[i, 3 * n + 2] = rotor.unbalance_sin[i]
        for k in range(m):
            right[i, 3 * n + 3 + k] = selection[k, i] * rotor.multiplicity[k // 2]
    if rotor.table_speeds.shape[0] > 0:
        add_table(rotor, g, speed, dynamic, right)
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
                total += selection[k, i] * spread[i, j]
            compliance[k, j] = g * total


# Rows of the scratch arrays: of a stage at the rotor's n degrees of freedom, and at the journals' m = 2 films.
# FREE is the acceleration without the films' forces; LATE the same with the gyroscopic term at the stage's own speed.
V, Q, FREE, LATE, STAGE_ROWS = range(5)
# u, u_0, x_0, forces, Newton's correction, and dF/du of each journal's own film by its x and y. OMEGA is omega_J +
# omega_S of the journal's own film. FOLLOWS_X, FOLLOWS_Y: the change of the velocity that the film feels by the
# journal's, see contact.py. STANDING: see RotorData.
U, U_0, X_0, FORCE, CORRECTION, BY_X, BY_Y, OMEGA, FOLLOWS_X, FOLLOWS_Y, STANDING, JOURNAL_ROWS = range(12)


class FilmMotion(NamedTuple):
    """Motion of the journal as a film feels it: displacement d and velocity v over the clearance, omega_J + omega_S."""

    d_x: float
    d_y: float
    v_x: float
    v_y: float
    omega: float


@compiled()
def norm(x: float, y: float) -> float:
    """Length of a vector."""
    return math.sqrt(x * x + y * y)


@compiled()
def limit_of(contact_stiffness: float) -> float:
    """Eccentricity that is no state any more: under elastic contact the shell gives way, else it ends at the shell."""
    return ELASTIC_LIMIT if contact_stiffness > 0.0 else 1.0


@compiled(inline=True)
def lagrange(a: float, b: float, c: float, t: float) -> tuple[float, float, float]:
    """The three weights of the parabola through points at the times a, b, c, at the time t."""
    return (
        (t - b) * (t - c) / ((a - b) * (a - c)),
        (t - a) * (t - c) / ((b - a) * (b - c)),
        (t - a) * (t - b) / ((c - a) * (c - b)),
    )


@compiled(inline=True)
def predict(weights: Array, s: int, step: float, q: Array, v: Array, stage_v: Array, stage_a: Array, at: Array) -> None:
    """V, Q of `at`: the rotor at stage s by the stages before it."""
    for i in range(q.shape[0]):
        sum_v, sum_a = 0.0, 0.0
        for j in range(s):
            sum_v += weights[s, j] * stage_v[i, j]
            sum_a += weights[s, j] * stage_a[i, j]
        at[V, i] = v[i] + step * sum_a
        at[Q, i] = q[i] + step * sum_v


@compiled(inline=True)
def start_stage(
    acceleration: float, speed: float, angle: float, g: float, gyroscopic: bool, products: Array, loads: Array,
    selection: Array, at: Array, journal: Array,
) -> None:  # fmt: skip
    """Fill FREE of `at` and U_0, X_0 of `journal`: what a stage knows before its films do."""
    n = at.shape[1]
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
    for k in range(selection.shape[0]):
        place, rate = journal[STANDING, k], 0.0
        for i in range(n):
            place += selection[k, i] * at[Q, i]
            rate += selection[k, i] * (at[V, i] + g * at[FREE, i])
        journal[X_0, k], journal[U_0, k] = place, rate


@compiled(inline=True)
def begin_lag(numbers: Array, g: float, speed: float, at: Array) -> float:
    """The lag of `accelerate` in a stage of a gyroscopic rotor, which begins with the speed of its inverse: LATE."""
    for i in range(at.shape[1]):
        at[LATE, i] = at[FREE, i]
    return g * (speed - float(numbers[INVERSE_SPEED]))


@compiled(inline=True)
def guess(
    points: Array, three: Indices, s: int, selection: Array, q: Array, clearances: Array, g: float, t: float,
    limit: float, journal: Array,
) -> None:  # fmt: skip
    """u of the stage at time t by extrapolation; a guess beyond the shell is drawn back to where the journal is.

    points: (p, 1 + m) times and journals' velocities of this step and the one before; three: (s, 3) which of them carry
    the parabola of stage s.
    """
    i_a, i_b, i_c = three[s, 0], three[s, 1], three[s, 2]
    weight_a, weight_b, weight_c = lagrange(points[i_a, 0], points[i_b, 0], points[i_c, 0], t)
    for i in range(selection.shape[0]):
        journal[U, i] = weight_a * points[i_a, 1 + i] + weight_b * points[i_b, 1 + i] + weight_c * points[i_c, 1 + i]
    for f in range(clearances.shape[0]):
        x, y = 2 * f, 2 * f + 1
        eccentricity = norm(journal[X_0, x] + g * journal[U, x], journal[X_0, y] + g * journal[U, y])
        if eccentricity > 0.999 * limit * clearances[f]:
            here_x, here_y = journal[STANDING, x], journal[STANDING, y]
            for i in range(q.shape[0]):
                here_x += selection[x, i] * q[i]
                here_y += selection[y, i] * q[i]
            journal[U, x], journal[U, y] = (here_x - journal[X_0, x]) / g, (here_y - journal[X_0, y]) / g


@compiled(inline=True)
def accelerate(
    s: int, g: float, lag: float, products: Array, spread: Array, selection: Array, at: Array, journal: Array,
    stage_v: Array, stage_a: Array,
) -> float:  # fmt: skip
    """Velocity and acceleration of stage s from the films' forces; with a lag also LATE and U_0 for the next iteration.
    Returns the largest change of U_0 in m/s.

    lag: g times the difference between the stage's speed and the inverse's, for the rest of the gyroscopic term. """
    n, m, change = at.shape[1], selection.shape[0], 0.0
    row = FREE if lag == 0.0 else LATE
    for i in range(n):
        total = at[row, i]
        for j in range(m):
            total += spread[i, j] * journal[FORCE, j]
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
                rate += selection[k, i] * (at[V, i] + g * at[LATE, i])
            change = max(change, abs(rate - journal[U_0, k]))
            journal[U_0, k] = rate
    return change
