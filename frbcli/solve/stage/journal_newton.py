"""Newton's method for the velocities of the journals in a stage, with the films' analytic derivatives. Compiled.

The equations are in equations.py. Films with cells are corrected along with the journals. """

from __future__ import annotations

import math
from typing import Any

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.dense import solve_dense
from frbcli.solve.films.forces import film_response, follow_channels, join_films, meet_films, move_film
from frbcli.solve.stage.equations import (
    BY_X,
    BY_Y,
    CORRECTION,
    FOLLOWS_X,
    FOLLOWS_Y,
    FORCE,
    OMEGA,
    U_0,
    X_0,
    FilmMotion,
    U,
    norm,
)
from frbcli.solve.stage.forces import feel, press, push_back, sharpness, shell_ahead
from frbcli.solve.state import Control

CLOSEST = 0.5  # share of the gap, see shell_ahead, that one Newton correction may close


@compiled()
def _store(
    numbers: tuple[float, ...], felt: tuple[float, ...], motion: FilmMotion, g: float, turning: float, f: int,
    c: float, control: Control, journal: Array,
) -> None:  # fmt: skip
    """FORCE, BY_X, BY_Y, FOLLOWS_X, FOLLOWS_Y of film f by its ten numbers, see film_force, at what it feels of its
    journal, see feel, with the push of an elastic shell."""
    x, y = 2 * f, 2 * f + 1
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = numbers
    _, _, _, _, xx, yy, xy, turn_xx, turn_yy, turn_xy = felt
    s_x, s_y, s_xx, s_yy, s_xy = push_back(
        motion.d_x, motion.d_y, c, control.contact_eccentricity, control.contact_stiffness
    )
    journal[FORCE, x], journal[FORCE, y] = f_x + s_x, f_y + s_y
    rate_xx, rate_yy, rate_xy = xx + turning * turn_xx, yy + turning * turn_yy, xy + turning * turn_xy
    journal[BY_X, x] = (d_xx * rate_xx + d_xy * rate_xy + g * (k_xx * xx + k_xy * xy - s_xx)) / c
    journal[BY_Y, x] = (d_xx * rate_xy + d_xy * rate_yy + g * (k_xx * xy + k_xy * yy - s_xy)) / c
    journal[BY_X, y] = (d_yx * rate_xx + d_yy * rate_xy + g * (k_yx * xx + k_yy * xy - s_xy)) / c
    journal[BY_Y, y] = (d_yx * rate_xy + d_yy * rate_yy + g * (k_yx * xy + k_yy * yy - s_yy)) / c
    journal[FOLLOWS_X, x], journal[FOLLOWS_Y, y] = rate_xx, rate_yy
    journal[FOLLOWS_X, y] = journal[FOLLOWS_Y, x] = rate_xy


@compiled(inline=True)
def _solve_small(matrix: Array, journal: Array) -> None:
    """CORRECTION <- matrix^-1 CORRECTION for the few journals' equations; closed form for one bearing."""
    if matrix.shape[0] == 2:
        det = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
        x, y = journal[CORRECTION, 0], journal[CORRECTION, 1]
        journal[CORRECTION, 0] = (matrix[1, 1] * x - matrix[0, 1] * y) / det
        journal[CORRECTION, 1] = (matrix[0, 0] * y - matrix[1, 0] * x) / det
    elif matrix.shape[0] > 0:
        right = journal[CORRECTION : CORRECTION + 1].reshape(-1, 1)  # a view: solved in place
        solve_dense(matrix, right)


@compiled()
def reach(d_x: float, d_y: float, c_x: float, c_y: float, end: float) -> float:
    """Largest factor <= 1 by which the correction c may be applied: the gap to `end` keeps a share of itself."""
    here = norm(d_x, d_y)
    there = norm(d_x + c_x, d_y + c_y)
    allowed = here + CLOSEST * (end - here)
    factor = 1.0
    while there > allowed and factor > 1e-6:
        factor *= 0.5
        there = norm(d_x + factor * c_x, d_y + factor * c_y)
    return factor


@compiled(inline=True)
def forces(
    films: Any, work: Any, clearances: Array, control: Control, g: float, s: int, iteration: int, journal: Array
) -> None:
    """Fill FORCE, BY_X, BY_Y at the velocities U, and what coupled channels add to them, see join_films."""
    meet_films(films, work, journal[X_0], journal[U], journal[OMEGA], clearances, g, iteration)
    turning = 0.0 if work.grids.shape[0] > 0 else g  # a film with cells has one derivative, of velocity and place
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        d_x, d_y = (journal[X_0, x] + g * journal[U, x]) / c, (journal[X_0, y] + g * journal[U, y]) / c
        motion = FilmMotion(d_x, d_y, journal[U, x] / c, journal[U, y] / c, journal[OMEGA, x])
        felt = feel(d_x, d_y, motion.v_x, motion.v_y, control.contact_eccentricity, control.contact_stiffness)
        at = FilmMotion(felt[0], felt[1], felt[2], felt[3], motion.omega)
        numbers = film_response(films, work, f, at, g, s, iteration)
        _store(numbers, felt, motion, g, turning, f, c, control, journal)
        press(control.rough, f, c, g, journal)
    join_films(films, work, clearances, journal[FORCE], journal[FOLLOWS_X], journal[FOLLOWS_Y])


@compiled(inline=True)
def correct(
    films: Any, work: Any, compliance: Array, clearances: Array, control: Control, g: float, journal: Array,
    newton: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """One correction of U by Newton's method, and of the films' cells with it.

    Returns (share of it that was applied, what may be left of the error of a smooth force, how far the journals moved
    over their clearances). What may be left is infinite for a correction that is not
    finite.
    """
    m, crossed = compliance.shape[0], work.cross.shape[0]
    for i in range(m):
        total = journal[U_0, i] - journal[U, i]
        for j in range(m):
            total += compliance[i, j] * journal[FORCE, j]
            x = j - j % 2
            slope = BY_X + j % 2
            newton[i, j] = -(compliance[i, x] * journal[slope, x] + compliance[i, x + 1] * journal[slope, x + 1])
            for a in range(crossed if j < crossed else 0):  # ports follow the films
                newton[i, j] -= compliance[i, a] * work.cross[a, j]
        newton[i, i] += 1.0
        journal[CORRECTION, i] = total
    _solve_small(newton, journal)
    share, moved, left = 1.0, 0.0, 0.0
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        at_x, at_y = (journal[X_0, x] + g * journal[U, x]) / c, (journal[X_0, y] + g * journal[U, y]) / c
        c_x, c_y = g * journal[CORRECTION, x] / c, g * journal[CORRECTION, y] / c
        move = norm(c_x, c_y)
        if not math.isfinite(move):
            return 0.0, math.inf, math.inf
        moved = max(moved, move)
        here = norm(at_x, at_y)
        end = shell_ahead(here, control.contact_eccentricity, control.contact_stiffness)
        share = min(share, reach(at_x, at_y, c_x, c_y, end))
        # Newton's method squares its error. A film's force bends over the size of the gap and, being proportional to
        # |w|, over the size of w; the force of summits over their height.
        half = 0.5 * journal[OMEGA, x]
        film_speed = norm(journal[U, x] / c + half * at_y, journal[U, y] / c - half * at_x)
        bend = 1.0 / (end - here) + 1.0 / (g * film_speed + 1e-30) + sharpness(control.rough, c)
        left = max(left, move * move * bend)
    for i in range(m):
        journal[U, i] += share * journal[CORRECTION, i]
    for i in range(m):  # the forces at the corrected velocities, to first order: what Newton's equations have used
        x = i - i % 2
        by_itself = journal[BY_X, i] * journal[CORRECTION, x] + journal[BY_Y, i] * journal[CORRECTION, x + 1]
        journal[FORCE, i] += share * by_itself
        for j in range(crossed if i < crossed else 0):
            journal[FORCE, i] += share * work.cross[i, j] * journal[CORRECTION, j]
    follow_channels(films, work, journal[CORRECTION], share)
    for f in range(clearances.shape[0]):
        x, y = 2 * f, 2 * f + 1
        c_x, c_y = share * journal[CORRECTION, x] / clearances[f], share * journal[CORRECTION, y] / clearances[f]
        felt_x = journal[FOLLOWS_X, x] * c_x + journal[FOLLOWS_Y, x] * c_y
        felt_y = journal[FOLLOWS_X, y] * c_x + journal[FOLLOWS_Y, y] * c_y
        move_film(films, work, f, felt_x, felt_y, g)
    return share, min(left, moved), moved
