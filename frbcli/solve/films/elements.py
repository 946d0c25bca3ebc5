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
from frbcli.film.cells.data import Records, record
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
from frbcli.solve.films.grid import GRID
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

# Notes on a stage: motion that the film feels, speed being omega_J + omega_S; corrections that were kept, and those
# since the residual was smallest; its size there, its share of its terms there (least) and now (terms); whether that is
# here; share of the last correction that was applied, and what is to be kept of that; how the film is held at the best
# point; the journal's velocity there; sizes of the last residuals.
NOTES = record(
    ("d_x", "f8"),
    ("d_y", "f8"),
    ("v_x", "f8"),
    ("v_y", "f8"),
    ("speed", "f8"),
    ("corrections", "i8"),
    ("since", "i8"),
    ("smallest", "f8"),
    ("least", "f8"),
    ("terms", "f8"),
    ("is_best", "?"),
    ("share", "f8"),
    ("kept", "f8"),
    ("hold", "i8"),
    ("best_u", "f8", (2,)),
    ("sizes", "f8", (MEMORY,)),
)
# How a film is held (notes.hold): it moves, is to be held, has gone back there, has told its force.
FREE, TO_HOLD, RETURNED, ASKED = range(4)
HERE, CHANGE, BEST = range(3)  # unknowns of the stage, their last correction, and where the residual was smallest


class ElementWork(NamedTuple):
    """Scratch of the time loop. w (3, nodes): HERE, CHANGE, BEST; past (e, 9) of theta_t; thetas, rates (stages, e, 9):
    oil fraction and rate; notes (1,) record NOTES. grids, cross: see NoCells of steps.py."""

    room: Room
    w: Array
    past: Array
    thetas: Array
    rates: Array
    notes: Records
    grids: Records
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
        np.zeros(1, NOTES),
        np.zeros(0, GRID),
        np.zeros((0, 0)),
    )


def begin_elements(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
    """begin_stage of steps.py."""
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
def element_response(
    film: ElementFilm, work: ElementWork, d_x: float, d_y: float, v_x: float, v_y: float, omega: float, g: float,
    iteration: int,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """The response of a film in the published form, see film_response of forces.py. The numbers have no meaning where
    the last correction is to be shortened or the film to be held: step_back then takes the correction back."""
    notes = work.notes[0]
    f_x, f_y, xx, xy, yx, yy = math.nan, math.nan, 0.0, 0.0, 0.0, 0.0
    if iteration == 0:
        notes.corrections = notes.since = 0
        notes.smallest = notes.least = math.inf
        notes.is_best, notes.hold = False, FREE
        notes.terms = notes.share = 0.0
        notes.kept = 1.0
    notes.d_x, notes.d_y, notes.v_x, notes.v_y, notes.speed = d_x, d_y, v_x, v_y, omega
    if notes.hold == RETURNED:
        notes.hold = ASKED
        set_pressures(film, work.room, work.w[HERE])
        f_x, f_y = force(film, work.room)
    elif notes.hold == FREE and notes.kept == 1.0 and _takes_place(film, work, g, iteration):
        if notes.corrections < MOST_CORRECTIONS:
            f_x, f_y, xx, xy, yx, yy = solve(film, work.room)
            notes.since += 1
        if not (notes.since <= PATIENCE and math.isfinite(f_x)):
            f_x = math.nan
            if notes.least < TOLERATED:
                notes.hold = TO_HOLD
    return f_x, f_y, 0.0, 0.0, 0.0, 0.0, xx, xy, yx, yy


@compiled(internal=True)
def _takes_place(film: ElementFilm, work: ElementWork, g: float, iteration: int) -> bool:
    """Assemble at where the film is; whether its residual is no reason to shorten the last correction."""
    notes, sizes = work.notes[0], work.notes[0].sizes
    size, notes.terms = residual(
        film, work.room, work.w[HERE], work.past, notes.d_x, notes.d_y, notes.v_x, notes.v_y, notes.speed, g
    )
    if iteration == 0:
        sizes[:] = size
    else:
        largest = sizes[0]
        for k in range(1, sizes.shape[0]):
            largest = max(largest, sizes[k])
        if not (size < largest or notes.share < SMALLEST_SHARE):
            notes.kept = 0.5
            return False
        sizes[notes.corrections % MEMORY] = size
        notes.corrections += 1
    if size < notes.smallest:
        notes.smallest, notes.least, notes.since, notes.is_best = size, notes.terms, 0, True
        for n in range(work.w.shape[1]):
            work.w[BEST, n] = work.w[HERE, n]
    return True


@compiled(internal=True)
def back_off(work: ElementWork, rows: Array) -> bool:
    """step_back of forces.py; rows: of equations.py."""
    notes, w, best_u = work.notes[0], work.w, work.notes[0].best_u
    m, nodes = rows.shape[1], w.shape[1]
    if notes.is_best:
        notes.is_best = False
        for i in range(m):
            best_u[i] = rows[U, i]
    if notes.hold == TO_HOLD:
        notes.hold, notes.kept = RETURNED, 1.0
        for i in range(m):
            rows[U, i] = best_u[i]
        for n in range(nodes):
            w[HERE, n] = w[BEST, n]
        return True
    if notes.kept == 1.0:
        return False
    back = (1.0 - notes.kept) * notes.share
    for i in range(m):
        rows[U, i] -= back * rows[CORRECTION, i]
    for n in range(nodes):
        w[HERE, n] -= back * w[CHANGE, n]
    notes.share *= notes.kept
    notes.kept = 1.0
    return True


@compiled(internal=True)
def move_elements(film: ElementFilm, work: ElementWork, u_x: float, u_y: float, share: float, g: float) -> int:
    """move_film of forces.py."""
    notes, w, change, largest = work.notes[0], work.w[HERE], work.w[CHANGE], 0.0
    notes.d_x += g * u_x
    notes.d_y += g * u_y
    notes.v_x += u_x
    notes.v_y += u_y
    if notes.hold != FREE:
        return 0
    solution = work.room.solution.reshape(-1, RIGHTS)
    for i in range(len(w)):
        change[i] = solution[i, 0] + (solution[i, 1] * u_x + solution[i, 2] * u_y) / share
        w[i] += share * change[i]
        if not film.unknowns.fixed[i]:
            largest = max(largest, abs(change[i]))
    notes.share, notes.kept = share, min(1.0, LARGEST_CORRECTION / (share * largest + 1e-300))
    return 0 if largest < FILM_SETTLED else 1


@compiled(internal=True)
def left_of_elements(work: ElementWork, moved: float, unsettled: int, allowed: float) -> float:
    """left_over of forces.py."""
    notes = work.notes[0]
    if notes.hold != FREE:
        return LEFT_WHERE_HELD * moved
    if unsettled == 0:
        return LEFT_OVER * moved
    if notes.corrections > 0 and notes.terms < ENOUGH and LEFT_OVER * moved < allowed:
        notes.hold = TO_HOLD  # its kinks do not reach the journal
    return math.inf


def accept_elements(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
    """accept_films of steps.py; oil that passes counts at the mean of the flows before and after."""
    last, nodes, notes = weights.shape[0] - 1, films.elements.nodes, work.notes[0]
    _keep_rates(films, work, last, weights[last, last] * step)
    for e in range(nodes.shape[0]):
        for a in range(9):
            wet[OIL, 0, e, a], wet[RATE, 0, e, a] = work.thetas[last, e, a], work.rates[last, e, a]
            wet[W_BEFORE, 0, e, a], wet[W, 0, e, a] = wet[W, 0, e, a], work.w[HERE, nodes[e, a]]
            work.past[e, a] = -work.rates[last, e, a]
    came, left = oil_passing(
        films, work.room, work.w[HERE], work.past, notes.d_x, notes.d_y, notes.v_x, notes.v_y, notes.speed
    )
    passed, now = flows[PASSED, 0], flows[NOW, 0]
    passed[CAME] += 0.5 * step * (now[CAME] + came)
    passed[LEFT] += 0.5 * step * (now[LEFT] + left)
    now[CAME], now[LEFT], now[HELD] = came, left, oil_held(films, notes.d_x, notes.d_y, work.thetas[last])


def write_element_oil(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
    """write_oil of steps.py."""
    oil = mean_oil_fraction(films, work.thetas[work.thetas.shape[0] - 1])
    for row in range(first, last):
        out_oil[row, 0] = oil
