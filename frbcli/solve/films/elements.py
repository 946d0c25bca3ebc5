"""A film in the published two-phase form in the time loop, compiled: what joins film/published to a stage.

As with cells, a Newton step of the film with what it does per journal velocity as further right-hand sides leaves 2 x 2
equations for the journal. A correction is shortened where the residual of the film grows: a steep step theta(p) has
kinks. Where no correction makes the residual smaller, the film is held at the best point found, if little is left
there, and so where its kinks do not reach the journal.

State.wet is (WET, 1, e, 9): unknowns of the nodes of each element, now and at the start of the step before; oil
fraction and its rate at the points. State.flows is (2, 1, BOOKS).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.compiled import compiled
from frbcli.film.published.data import CAME, HELD, LEFT, RIGHTS, ElementFilm, Room, make_room
from frbcli.film.published.moving import (
    force,
    mean_oil_fraction,
    oil_held,
    oil_passing,
    residual,
    set_oil_fraction,
    set_pressures,
    solve,
)
from frbcli.film.state import NOW, OIL, PASSED, RATE, W_BEFORE, W
from frbcli.solve.films.cells import GRIDS
from frbcli.solve.stage.equations import CORRECTION, U
from frbcli.solve.state import Array

MOST_CORRECTIONS = 20
MOST_ITERATIONS = 120  # trials of shortened corrections counted
MEMORY = 4  # a residual has to be smaller than the largest of so many before it
SMALLEST_SHARE = 0.06  # of a correction
LARGEST_CORRECTION = 1.0  # of an unknown: the whole of a step theta(p)
LARGEST_GUESS = 0.5  # of an unknown's change by extrapolation: further, and a step theta(p) is overshot
PATIENCE = 5  # corrections without a smaller residual
FILM_SETTLED = 1e-3  # correction of a node's unknown, of the order of 1, whose square is put up with
# Residual over the sum of its terms that is put up with where no correction makes it smaller, see film.TOLERATED.
TOLERATED = 1e-2
ENOUGH = 2e-3  # the same where the journal does not move any more
# Of how far a journal has moved, what may be left of its error: its square is far less, and a film that is held moves
# its journal no more.
LEFT_OVER, LEFT_WHERE_HELD = 0.2, 0.02

# Notes on a stage: motion that the film feels, with omega_J + omega_S; corrections that were kept, and those since the
# residual was smallest; its size there, its share of its terms there and now; whether that is here; share of the last
# correction that was applied, and what is to be kept of that; how the film is held at the best point; the journal's
# velocity there; sizes of the last residuals.
(D_X, D_Y, V_X, V_Y, SPEED, CORRECTIONS, SINCE, SMALLEST, LEAST, TERMS, IS_BEST, SHARE, KEPT, HOLD, BEST_U) = range(15)
SIZES = BEST_U + 2
NOTES = SIZES + MEMORY
FREE, TO_HOLD, RETURNED, ASKED = range(4)  # of HOLD: it moves, is to be held, has gone back there, has told its force
HERE, CHANGE, BEST = range(3)  # unknowns of the stage, their last correction, and where the residual was smallest


class ElementWork(NamedTuple):
    """Scratch of the time loop. w (3, nodes): HERE, CHANGE, BEST; past (e, 9) of theta_t; thetas, rates (stages, e, 9):
    oil fraction and rate; notes (NOTES,). grids, cross: see NoCells of films.py."""

    room: Room
    w: Array
    past: Array
    thetas: Array
    rates: Array
    notes: Array
    grids: Array
    cross: Array


def make_element_work(film: ElementFilm, stages: int) -> ElementWork:
    """Scratch for a film and the stages of a method."""
    points = film.height.shape
    return ElementWork(
        make_room(film),
        np.zeros((3, film.weights.shape[0])),
        np.zeros(points),
        np.zeros((stages, *points)),
        np.zeros((stages, *points)),
        np.zeros(NOTES),
        np.zeros((0, GRIDS)),
        np.zeros((0, 0)),
    )


def begin_elements(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
    """begin_stage of films.py."""
    now, before, nodes, w, guess = wet[W, 0], wet[W_BEFORE, 0], films.elements.nodes, work.w[HERE], work.w[CHANGE]
    if s == 1:
        for e in range(nodes.shape[0]):
            for a in range(9):
                work.rates[0, e, a] = wet[RATE, 0, e, a]
    else:
        _keep_rates(films, work, s - 1, g)
    for e in range(nodes.shape[0]):
        for a in range(9):
            total, n = 0.0, nodes[e, a]
            for p in range(s):
                total += weights[s, p] * work.rates[p, e, a]
            work.past[e, a] = (wet[OIL, 0, e, a] + step * total) / g
            change = ahead * (now[e, a] - before[e, a]) if s == 1 else lag * (w[n] - now[e, a])
            guess[n] = now[e, a] + min(max(change, -LARGEST_GUESS), LARGEST_GUESS)
    for n in range(w.shape[0]):
        w[n] = guess[n]


@compiled(internal=True)
def _keep_rates(film: ElementFilm, work: ElementWork, s: int, g: float) -> None:
    """Oil fraction and rate of stage s, which is solved."""
    set_oil_fraction(film, work.room, work.w[HERE], work.thetas[s])
    for e in range(work.past.shape[0]):
        for a in range(9):
            work.rates[s, e, a] = work.thetas[s, e, a] / g - work.past[e, a]


@compiled(internal=True)
def element_numbers(
    film: ElementFilm, work: ElementWork, d_x: float, d_y: float, v_x: float, v_y: float, omega: float, g: float,
    iteration: int,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """film_numbers of film_forces.py. Where the last correction is to be shortened, or the film to be held, the numbers
    are of no meaning: step_back then takes the correction back."""
    notes = work.notes
    f_x, f_y, xx, xy, yx, yy = math.nan, math.nan, 0.0, 0.0, 0.0, 0.0
    if iteration == 0:
        notes[:] = 0.0
        notes[SMALLEST] = notes[LEAST] = math.inf
        notes[KEPT] = 1.0
    notes[D_X], notes[D_Y], notes[V_X], notes[V_Y], notes[SPEED] = d_x, d_y, v_x, v_y, omega
    if notes[HOLD] == RETURNED:
        notes[HOLD] = ASKED
        set_pressures(film, work.room, work.w[HERE])
        f_x, f_y = force(film, work.room)
    elif notes[HOLD] == FREE and notes[KEPT] == 1.0 and _takes_place(film, work, g, iteration):
        if notes[CORRECTIONS] < MOST_CORRECTIONS:
            f_x, f_y, xx, xy, yx, yy = solve(film, work.room)
            notes[SINCE] += 1.0
        if not (notes[SINCE] <= PATIENCE and math.isfinite(f_x)):
            f_x = math.nan
            if notes[LEAST] < TOLERATED:
                notes[HOLD] = TO_HOLD
    return f_x, f_y, 0.0, 0.0, 0.0, 0.0, xx, xy, yx, yy


@compiled(internal=True)
def _takes_place(film: ElementFilm, work: ElementWork, g: float, iteration: int) -> bool:
    """Assemble at where the film is; whether its residual is no reason to shorten the last correction."""
    notes, sizes = work.notes, work.notes[SIZES:]
    size, notes[TERMS] = residual(
        film, work.room, work.w[HERE], work.past, notes[D_X], notes[D_Y], notes[V_X], notes[V_Y], notes[SPEED], g
    )
    if iteration == 0:
        sizes[:] = size
    else:
        largest = sizes[0]
        for k in range(1, sizes.shape[0]):
            largest = max(largest, sizes[k])
        if not (size < largest or notes[SHARE] < SMALLEST_SHARE):
            notes[KEPT] = 0.5
            return False
        sizes[int(notes[CORRECTIONS]) % MEMORY] = size
        notes[CORRECTIONS] += 1.0
    if size < notes[SMALLEST]:
        notes[SMALLEST], notes[LEAST], notes[SINCE], notes[IS_BEST] = size, notes[TERMS], 0.0, 1.0
        for n in range(work.w.shape[1]):
            work.w[BEST, n] = work.w[HERE, n]
    return True


@compiled(internal=True)
def back_off(work: ElementWork, rows: Array) -> bool:
    """step_back of film_forces.py; rows: of stage.py."""
    notes, w, best_u = work.notes, work.w, work.notes[BEST_U:SIZES]
    m, nodes = rows.shape[1], w.shape[1]
    if notes[IS_BEST] != 0.0:
        notes[IS_BEST] = 0.0
        for i in range(m):
            best_u[i] = rows[U, i]
    if notes[HOLD] == TO_HOLD:
        notes[HOLD], notes[KEPT] = RETURNED, 1.0
        for i in range(m):
            rows[U, i] = best_u[i]
        for n in range(nodes):
            w[HERE, n] = w[BEST, n]
        return True
    if notes[KEPT] == 1.0:
        return False
    back = (1.0 - notes[KEPT]) * notes[SHARE]
    for i in range(m):
        rows[U, i] -= back * rows[CORRECTION, i]
    for n in range(nodes):
        w[HERE, n] -= back * w[CHANGE, n]
    notes[SHARE] *= notes[KEPT]
    notes[KEPT] = 1.0
    return True


@compiled(internal=True)
def move_elements(film: ElementFilm, work: ElementWork, u_x: float, u_y: float, share: float, g: float) -> int:
    """move_film of film_forces.py."""
    notes, w, change, largest = work.notes, work.w[HERE], work.w[CHANGE], 0.0
    notes[D_X] += g * u_x
    notes[D_Y] += g * u_y
    notes[V_X] += u_x
    notes[V_Y] += u_y
    if notes[HOLD] != FREE:
        return 0
    solution = work.room.solution.reshape(-1, RIGHTS)
    for i in range(len(w)):
        change[i] = solution[i, 0] + (solution[i, 1] * u_x + solution[i, 2] * u_y) / share
        w[i] += share * change[i]
        if not film.unknowns.fixed[i]:
            largest = max(largest, abs(change[i]))
    notes[SHARE], notes[KEPT] = share, min(1.0, LARGEST_CORRECTION / (share * largest + 1e-300))
    return 0 if largest < FILM_SETTLED else 1


@compiled(internal=True)
def left_of_elements(work: ElementWork, moved: float, unsettled: int, allowed: float) -> float:
    """left_over of film_forces.py."""
    notes = work.notes
    if notes[HOLD] != FREE:
        return LEFT_WHERE_HELD * moved
    if unsettled == 0:
        return LEFT_OVER * moved
    if notes[CORRECTIONS] > 0.0 and notes[TERMS] < ENOUGH and LEFT_OVER * moved < allowed:
        notes[HOLD] = TO_HOLD  # its kinks do not reach the journal
    return math.inf


def accept_elements(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
    """accept_films of films.py; oil that passes counts at the mean of the flows before and after."""
    last, nodes, notes = weights.shape[0] - 1, films.elements.nodes, work.notes
    _keep_rates(films, work, last, weights[last, last] * step)
    for e in range(nodes.shape[0]):
        for a in range(9):
            wet[OIL, 0, e, a], wet[RATE, 0, e, a] = work.thetas[last, e, a], work.rates[last, e, a]
            wet[W_BEFORE, 0, e, a], wet[W, 0, e, a] = wet[W, 0, e, a], work.w[HERE, nodes[e, a]]
            work.past[e, a] = -work.rates[last, e, a]
    came, left = oil_passing(
        films, work.room, work.w[HERE], work.past, notes[D_X], notes[D_Y], notes[V_X], notes[V_Y], notes[SPEED]
    )
    passed, now = flows[PASSED, 0], flows[NOW, 0]
    passed[CAME] += 0.5 * step * (now[CAME] + came)
    passed[LEFT] += 0.5 * step * (now[LEFT] + left)
    now[CAME], now[LEFT], now[HELD] = came, left, oil_held(films, notes[D_X], notes[D_Y], work.thetas[last])


def write_element_oil(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
    """write_oil of films.py."""
    oil = mean_oil_fraction(films, work.thetas[work.thetas.shape[0] - 1])
    for row in range(first, last):
        out_oil[row, 0] = oil
