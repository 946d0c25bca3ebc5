"""Films in the published two-phase form in the time loop, compiled: what joins film/published to a stage.

As with cells, a Newton step of a film with what it does per journal velocity as further right-hand sides leaves 2 x 2
equations for its journal. A correction is shortened, of all films alike, where the residual of one grows: a steep step
theta(p) has kinks. Where no correction makes the residual smaller, a film is held at the best point found, if little is
left there, and so where its kinks do not reach the journal.

State.wet is (WET, F, e, 9): unknowns of the nodes of each element, now and at the start of the step before; oil
fraction and its rate at the points. State.flows is (2, F, BOOKS). Elements stand as the openings of their film do.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.cells.data import Records, record
from frbcli.film.published.data import CAME, HELD, LEFT, RIGHTS, ElementFilm, Room, make_room
from frbcli.film.published.moving import (
    force,
    mean_oil_fraction,
    oil_held,
    oil_passing,
    residual,
    set_oil_fraction,
    set_openings,
    set_pressures,
    sheared,
    solve,
)
from frbcli.film.state import NOW, OIL, PASSED, RATE, W_BEFORE, W
from frbcli.solve.films.cells import GLOBAL_FACTOR, LOCAL_FACTOR, SIMPLE_FACTOR, turned_back
from frbcli.solve.films.grid import GRID
from frbcli.solve.stage.equations import CORRECTION, FilmMotion, U, norm
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

# Notes on a stage, of a film: its number; motion that the film feels, seen from its openings, speed being omega_J +
# omega_S; corrections that were kept, and those since the residual was smallest; its size there, its share of its terms
# there (least) and now (terms); whether that is here; share of the last correction that was applied, and what is to be
# kept of that; whether the last one was small; how the film is held at the best point, and how far its journal has
# moved from there; the journal's velocity there; sizes of the last residuals. Whether the last answer has been noted
# in those, in place of which size, and the corrections since the smallest one before.
NOTES = record(
    ("stage", "i8"),
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
    ("settled", "?"),
    ("hold", "i8"),
    ("away_x", "f8"),
    ("away_y", "f8"),
    ("best_u", "f8", (2,)),
    ("sizes", "f8", (MEMORY,)),
    ("noted", "?"),
    ("replaced", "f8"),
    ("since_before", "i8"),
)
# How a film is held (notes.hold): it moves, is to be held, has gone back there, cannot be held any longer.
FREE, TO_HOLD, RETURNED, FAILED = range(4)
HERE, CHANGE, BEST = range(3)  # unknowns of the stage, their last correction, and where the residual was smallest


class ElementRoom(NamedTuple):
    """Scratch of a film. w (3, nodes): HERE, CHANGE, BEST; past (e, 9) of theta_t; theta (e, 9): oil fraction; notes
    (1,) record NOTES."""

    room: Room
    w: Array
    past: Array
    theta: Array
    notes: Records


class ElementWork(NamedTuple):
    """Scratch of the time loop. films: one room each; stage_oil (stages, F, e, 9): rates of the oil fractions; grids
    (F,) records GRID; cross: see NoCells of steps.py."""

    films: tuple[ElementRoom, ...]
    stage_oil: Array
    grids: Records
    cross: Array


def make_element_work(films: tuple[ElementFilm, ...], stages: int) -> ElementWork:
    """Scratch for films and the stages of a method."""
    points = films[0].height.shape
    rooms = tuple(
        ElementRoom(
            make_room(film),
            np.zeros((3, film.weights.shape[0])),
            np.zeros(points),
            np.zeros(points),
            np.zeros(1, NOTES),
        )
        for film in films
    )
    return ElementWork(rooms, np.zeros((stages, len(films), *points)), np.zeros(len(films), GRID), np.zeros((0, 0)))


def begin_elements(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
    """begin_stage of steps.py."""
    for f in range(len(films)):
        reach = ahead if s == 1 else lag
        begin_element_film(films[f], work.films[f], work.stage_oil, wet, weights, f, s, step, g, reach)


@compiled(internal=True)
def begin_element_film(
    film: ElementFilm, own: ElementRoom, stage_oil: Array, wet: Array, weights: Array, f: int, s: int, step: float,
    g: float, reach: float,
) -> None:  # fmt: skip
    """begin_elements of film f. reach: `ahead` of the first stage, `lag` of the others."""
    now, before, nodes, w, guess = wet[W, f], wet[W_BEFORE, f], film.elements.nodes, own.w[HERE], own.w[CHANGE]
    if s == 1:
        for e in range(nodes.shape[0]):
            for a in range(9):
                stage_oil[0, f, e, a] = wet[RATE, f, e, a]
    for e in range(nodes.shape[0]):
        for a in range(9):
            total, n = 0.0, nodes[e, a]
            for p in range(s):
                total += weights[s, p] * stage_oil[p, f, e, a]
            own.past[e, a] = (wet[OIL, f, e, a] + step * total) / g
            change = reach * (now[e, a] - before[e, a] if s == 1 else w[n] - now[e, a])
            guess[n] = now[e, a] + min(max(change, -LARGEST_GUESS), LARGEST_GUESS)
    for n in range(w.shape[0]):
        w[n] = guess[n]


@compiled(internal=True)
def element_response(
    film: ElementFilm, own: ElementRoom, grid: np.record, motion: FilmMotion, g: float, s: int, iteration: int
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """The response of a film in the published form, see film_response of forces.py. The numbers have no meaning where
    the last correction is to be shortened or the film to be held: step_back then takes the correction back."""
    notes = own.notes[0]
    f_x, f_y, xx, xy, yx, yy = math.nan, math.nan, 0.0, 0.0, 0.0, 0.0
    if iteration == 0:
        notes.stage = s
        notes.corrections = notes.since = 0
        notes.smallest = notes.least = math.inf
        notes.is_best = notes.settled = False
        notes.hold = FREE
        notes.terms = notes.share = 0.0
        notes.kept = 1.0
    cosine, sine, spin = math.cos(grid.turn), math.sin(grid.turn), grid.speed
    against_x, against_y = motion.v_x + spin * motion.d_y, motion.v_y - spin * motion.d_x
    notes.d_x, notes.d_y = cosine * motion.d_x + sine * motion.d_y, cosine * motion.d_y - sine * motion.d_x
    notes.v_x, notes.v_y = cosine * against_x + sine * against_y, cosine * against_y - sine * against_x
    notes.speed = motion.omega - 2.0 * spin
    notes.noted, notes.since_before = False, notes.since
    set_openings(film, own.room, spin)
    if notes.hold == RETURNED:
        set_pressures(film, own.room, own.w[HERE])
        f_x, f_y = force(film, own.room)
    elif notes.hold == FREE and notes.kept == 1.0 and _takes_place(film, own, spin, g, iteration):
        if notes.corrections < MOST_CORRECTIONS:
            f_x, f_y, xx, xy, yx, yy = solve(film, own.room)
            notes.since += 1
        if not (notes.since <= PATIENCE and math.isfinite(f_x)):
            f_x = math.nan
            if notes.least < TOLERATED:
                notes.hold = TO_HOLD
    return turned_back(cosine, sine, f_x, f_y, xx, xy, yx, yy)


@compiled(internal=True)
def _takes_place(film: ElementFilm, own: ElementRoom, spin: float, g: float, iteration: int) -> bool:
    """Assemble at where the film is; whether its residual is no reason to shorten the last correction."""
    notes, sizes = own.notes[0], own.notes[0].sizes
    motion = GridMotion(notes.d_x, notes.d_y, notes.speed, notes.v_x, notes.v_y, spin, g, 1.0 / g)
    size, notes.terms = residual(film, own.room, own.w[HERE], own.past, motion)
    if iteration == 0:
        sizes[:] = size
    else:
        largest = sizes[0]
        for k in range(1, sizes.shape[0]):
            largest = max(largest, sizes[k])
        if not (size < largest or notes.share < SMALLEST_SHARE):
            notes.kept = 0.5
            return False
        notes.noted, notes.replaced = True, sizes[notes.corrections % MEMORY]
        sizes[notes.corrections % MEMORY] = size
        notes.corrections += 1
    if size < notes.smallest:
        notes.smallest, notes.least, notes.since, notes.is_best = size, notes.terms, 0, True
        for n in range(own.w.shape[1]):
            own.w[BEST, n] = own.w[HERE, n]
    return True


@compiled(internal=True)
def back_off(work: ElementWork, rows: Array) -> bool:
    """step_back of forces.py; rows: of equations.py."""
    kept, share, returned = 1.0, 1.0, False
    for f in range(len(work.films)):
        notes, w, best_u = work.films[f].notes[0], work.films[f].w, work.films[f].notes[0].best_u
        x, y = 2 * f, 2 * f + 1
        if notes.is_best:
            notes.is_best = False
            best_u[0], best_u[1] = rows[U, x], rows[U, y]
        if notes.hold == TO_HOLD:
            notes.hold, notes.kept, returned = RETURNED, 1.0, True
            notes.away_x = notes.away_y = 0.0
            rows[U, x], rows[U, y] = best_u[0], best_u[1]
            for n in range(w.shape[1]):
                w[HERE, n] = w[BEST, n]
        if notes.kept < kept:
            kept, share = notes.kept, notes.share
    if not returned and kept == 1.0:
        return False
    back = 0.0 if returned else (1.0 - kept) * share
    for i in range(rows.shape[1]):
        rows[U, i] -= back * rows[CORRECTION, i]
    for f in range(len(work.films)):
        notes, w = work.films[f].notes[0], work.films[f].w
        if notes.noted:  # asked in vain: it is asked again elsewhere, since another film was not content
            notes.corrections -= 1
            notes.sizes[notes.corrections % MEMORY], notes.since = notes.replaced, min(notes.since, notes.since_before)
        if notes.hold == FREE and not returned:
            for n in range(w.shape[1]):
                w[HERE, n] -= back * w[CHANGE, n]
            notes.share *= kept
            notes.kept = 1.0
    return True


@compiled(internal=True)
def move_elements(
    film: ElementFilm, own: ElementRoom, grid: np.record, rates: Array, u_x: float, u_y: float, share: float, g: float
) -> int:  # fmt: skip
    """move_film of forces.py; rates (e, 9) <- of the oil fractions in the stage where the film has settled."""
    notes, w, change, largest = own.notes[0], own.w[HERE], own.w[CHANGE], 0.0
    cosine, sine, turned = math.cos(grid.turn), math.sin(grid.turn), g * grid.speed
    x, y = cosine * u_x + sine * u_y, cosine * u_y - sine * u_x
    notes.d_x += g * x
    notes.d_y += g * y
    notes.v_x += x + turned * y
    notes.v_y += y - turned * x
    if notes.hold == FREE:
        solution = own.room.solution.reshape(-1, RIGHTS)
        for i in range(len(w)):
            change[i] = solution[i, 0] + (solution[i, 1] * x + solution[i, 2] * y) / share
            w[i] += share * change[i]
            if not film.unknowns.fixed[i]:
                largest = max(largest, abs(change[i]))
        notes.share, notes.kept = share, min(1.0, LARGEST_CORRECTION / (share * largest + 1e-300))
        notes.settled = largest < FILM_SETTLED
        if not notes.settled:
            return 1
    else:
        notes.away_x += g * x
        notes.away_y += g * y
    set_oil_fraction(film, own.room, w, own.theta)
    for e in range(rates.shape[0]):
        for a in range(9):
            rates[e, a] = own.theta[e, a] / g - own.past[e, a]
    return 0


@compiled(internal=True)
def left_of_elements(work: ElementWork, moved: float, allowed: float) -> float:
    """left_over of forces.py."""
    left, small = 0.0, LEFT_OVER * moved < allowed
    for f in range(len(work.films)):
        notes = work.films[f].notes[0]
        if notes.hold != FREE:
            off = LEFT_WHERE_HELD * norm(notes.away_x, notes.away_y)
            if small and off >= allowed:
                notes.hold = FAILED
            left = max(left, off)
        elif notes.settled:
            left = max(left, LEFT_OVER * moved)
        else:
            if notes.corrections > 0 and notes.terms < ENOUGH and small:
                notes.hold = TO_HOLD  # its kinks do not reach the journal
                notes.away_x = notes.away_y = 0.0
            left = math.inf
    return left


def accept_elements(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
    """accept_films of steps.py; oil that passes counts at the mean of the flows before and after."""
    for f in range(len(films)):
        accept_element_film(films[f], work.films[f], work.stage_oil[weights.shape[0] - 1, f], wet, flows, f, step)


@compiled(internal=True)
def accept_element_film(
    film: ElementFilm, own: ElementRoom, rates: Array, wet: Array, flows: Array, f: int, step: float
) -> None:
    """accept_elements of film f; rates (e, 9): of its oil fractions in the last stage."""
    nodes, notes = film.elements.nodes, own.notes[0]
    for e in range(nodes.shape[0]):
        for a in range(9):
            wet[OIL, f, e, a], wet[RATE, f, e, a] = own.theta[e, a], rates[e, a]
            wet[W_BEFORE, f, e, a], wet[W, f, e, a] = wet[W, f, e, a], own.w[HERE, nodes[e, a]]
            own.past[e, a] = -rates[e, a]
    came, left = oil_passing(
        film, own.room, own.w[HERE], own.past, notes.d_x, notes.d_y, notes.v_x, notes.v_y, notes.speed
    )
    passed, now = flows[PASSED, f], flows[NOW, f]
    passed[CAME] += 0.5 * step * (now[CAME] + came)
    passed[LEFT] += 0.5 * step * (now[LEFT] + left)
    now[CAME], now[LEFT], now[HELD] = came, left, oil_held(film, notes.d_x, notes.d_y, own.theta)


def write_element_oil(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
    """write_oil of steps.py."""
    for f in range(len(films)):
        oil = mean_oil_fraction(films[f], work.films[f].theta)
        for row in range(first, last):
            out_oil[row, f] = oil


@compiled(internal=True)
def element_drag(film: ElementFilm, own: ElementRoom, d_x: float, d_y: float, factor: int) -> float:
    """drag_integral of forces.py."""
    if factor == SIMPLE_FACTOR:  # (4.6): of a plain film
        return 2.0 * math.pi / math.sqrt(max(1.0 - d_x * d_x - d_y * d_y, 1e-6))
    notes = own.notes[0]
    whole = sheared(film, own.theta, notes.d_x, notes.d_y, factor == LOCAL_FACTOR)
    return whole * mean_oil_fraction(film, own.theta) if factor == GLOBAL_FACTOR else whole


