"""The films at both ends of a stage and of a step of the time loop, compiled; what they do in between is in forces.py.

Which kind of films the time loop has is asked here alone, by the types of the films, when the loop is compiled:

- none at all, an empty tuple;
- a tuple of FilmData, one per film: force and derivatives follow from where the journal is and how it moves;
- VolumeFilms, all films together: cells with unknowns of their own, see cells.py;
- TiltedVolumes, all films together, each of which the loop sees at both ends of its bearing, see tilted.py.

Channels couple the films of a ring, which are solved as one: each film with further right-hand sides, one per channel,
for what a unit of pressure in it does. The pressures of all channels then follow from one small system (Schur's
complement). Equations for the journals alone are left, with the force of a film depending on both films of its ring.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import types

from frbcli.arrays import Array
from frbcli.compiled import Kernel, by_types, compiled, type_of
from frbcli.dense import solve_dense
from frbcli.film.cells.balance.states import follow_law
from frbcli.film.cells.channels import (
    channel_pressures,
    feed_hole_pressure,
    follow_means,
    mean_changes,
    push_of_channel,
)
from frbcli.film.cells.data import BY_ITSELF, SIDES, Records, VolumeFilms
from frbcli.film.cells.tilted_film import TiltedVolumes
from frbcli.solve.films.cell_steps import (
    GRID,
    Work,
    accept_cells,
    begin_cells,
    filling_error,
    make_cell_work,
    write_cell_oil,
)
from frbcli.solve.films.tilted import TiltedWork, make_tilted_work, write_land_oil

NONE, TABLES, CELLS, TILTED = "none", "tables", "cells", "tilted"
_KINDS = {VolumeFilms: CELLS, TiltedVolumes: TILTED}


def kind_of(films: Any) -> str:
    """The kind of films, or of a type of films that the compiler knows."""
    if isinstance(films, tuple | types.BaseTuple) and len(films) == 0:
        return NONE
    return _KINDS.get(type_of(films), TABLES)


def by_kind(inline: bool = False, **answers: Callable[..., Any]) -> Callable[[Kernel], Kernel]:
    """Decorates a question that kernels ask the films, its argument `films`: it is compiled as the answer of their
    kind, that under the name of the kind, else as it stands. inline: the answer is put into the functions that ask."""

    def decorated(question: Kernel) -> Kernel:
        at = list(inspect.signature(question).parameters).index("films")
        return by_types(lambda *given: answers.get(kind_of(given[at])), inline)(question)

    return decorated


NEWTON_LIMIT = 12  # iterations before a step is tried again with a smaller one
CELL_LIMIT = 24  # the same for films with cells, whose kinks take longer


class NoCells(NamedTuple):
    """The parts of the scratch that loops need of any films; all are empty for films without cells."""

    stage_oil: Array
    grids: Records
    cross: Array


class Scaled(NamedTuple):
    """NoCells of tabulated films in a machine with heat or with a supply whose pressure changes: scales (F,) of their
    tables, see forces.py, and shares (F,) of the pressures, see inputs.py."""

    stage_oil: Array
    grids: Records
    cross: Array
    scales: Array
    shares: Array


def make_work(
    films: Any, wet: Array, stages: int, scales: Array | None = None, shares: Array | None = None
) -> Work | TiltedWork | NoCells | Scaled:
    """Scratch for films and their state wet (WET, F, m, k). scales: of tabulated films with heat; shares: of their
    supply pressure, where it changes, which the scales then follow, too."""
    kind = kind_of(films)
    if kind == CELLS:
        return make_cell_work(films, wet, stages)
    if kind == TILTED:
        return make_tilted_work(films, wet, stages)
    none = NoCells(np.zeros((stages, 0, 0, 0)), np.zeros(0, GRID), np.zeros((0, 0)))
    if scales is None:
        return none
    return Scaled(*none, scales, np.ones_like(scales) if shares is None else shares)


@by_kind(inline=True, cells=lambda films: CELL_LIMIT, tilted=lambda films: CELL_LIMIT)
def most_iterations(films: Any) -> int:
    """Limit of the iterations of Newton's method in a stage."""
    return NEWTON_LIMIT


@by_kind(cells=begin_cells, tilted=begin_cells)
def begin_stage(
    films: Any,
    work: Work,
    wet: Array,
    flows: Array,
    weights: Array,
    s: int,
    step: float,
    g: float,
    ahead: float,
    lag: float,
) -> None:
    """Prepare the films for stage s: past, and guesses of w and of the filling of openings. ahead, lag: how far the
    stage and the one before it lie from the start of the step, over the step before and over this one."""


@by_kind(cells=filling_error, tilted=filling_error)
def film_error(films: Any, work: Work, flows: Array, weights: Array, defect: Array, step: float) -> float:
    """Embedded error of what the films have of their own: the filling of openings with a flow-limited supply, over a
    full line. weights, defect: of the method."""
    return 0.0


@by_kind(cells=accept_cells, tilted=accept_cells)
def accept_films(films: Any, work: Work, wet: Array, flows: Array, weights: Array, step: float) -> None:
    """The step is done: the films' state moves on. flows: (2, F, FLOWS) oil that has passed so far, and passes now."""


@by_kind(
    cells=write_cell_oil,
    tilted=lambda films, work, out_oil, first, last: write_land_oil(films, work, out_oil, first, last),
)
def write_oil(films: Any, work: Work, out_oil: Array, first: int, last: int) -> None:
    """out_oil (rows, F), rows from first up to last: the mean oil fraction (4.46) at the end of an accepted step."""


@compiled()
def set_laws(
    films: VolumeFilms, grids: Records, x_0: Array, u: Array, omega: Array, clearances: Array, g: float
) -> None:
    """The parameters of the films' laws where the journals are guessed to be."""
    for f in range(clearances.shape[0]):
        d_x = (x_0[2 * f] + g * u[2 * f]) / clearances[f]
        d_y = (x_0[2 * f + 1] + g * u[2 * f + 1]) / clearances[f]
        v_x, v_y = u[2 * f] / clearances[f], u[2 * f + 1] / clearances[f]
        follow_law(films.films[f], d_x, d_y, v_x, v_y, omega[2 * f], grids[f].law)


@compiled(makes_arrays=True)
def set_pressures(films: VolumeFilms, grids: Records, w: Array, channel: Array) -> None:
    """channel (films, m, k) <- the channels' pressures over the cells of their feed holes, by the films as they are."""
    count = films.feed_holes.shape[0]
    means = np.empty(count)
    for q in range(count):
        f = films.feed_holes[q].film
        means[q] = feed_hole_pressure(
            films.films[f], films.cells[f], grids[f].law, w[f], films.feed_holes[q], films.feed_hole_cells[q]
        )
    channel_pressures(films.channels, films.feed_holes, grids["speed"], means)
    for q in range(count):
        f = films.feed_holes[q].film
        for n in range(films.feed_hole_cells.shape[1]):
            i, j = films.feed_hole_cells[q, n, 0], films.feed_hole_cells[q, n, 1]
            if i >= 0:
                channel[f, i, j] = means[q]


@compiled(makes_arrays=True)
def join(
    films: VolumeFilms, work: Any, clearances: Array, follows_x: Array, follows_y: Array, force: Array
) -> None:
    """Let the solved films feel each other: their forces, and in their work what the channels make of the derivatives
    by the journals' velocities, cross (2 films, 2 films) in N s / m; the changes of the channels' pressures, by
    themselves and per journal velocity in m/s, answers (feed_holes, 1 + 2 films); changes (films, slots): the former.
    """
    grids, states, fields = work.grids, work.states, work.fields
    cross, answers, changes = work.cross, work.answers, work.changes
    count, journals = films.feed_holes.shape[0], cross.shape[0]
    matrix, own = np.zeros((count, count)), np.empty(SIDES + changes.shape[1])
    for q in range(count):
        f = films.feed_holes[q].film
        mean_changes(films.cells[f], states[f], fields[f], films.feed_holes[q], films.feed_hole_cells[q], own)
        for column in range(1 + journals):
            answers[q, column] = 0.0
        answers[q, 0] = own[BY_ITSELF]
        c, s = math.cos(grids[f].turn), math.sin(grids[f].turn)
        x, y = (c * own[1] - s * own[2]) / clearances[f], (s * own[1] + c * own[2]) / clearances[f]
        answers[q, 1 + 2 * f] = follows_x[2 * f] * x + follows_x[2 * f + 1] * y
        answers[q, 2 + 2 * f] = follows_y[2 * f] * x + follows_y[2 * f + 1] * y
        for other in range(count):
            if films.feed_holes[other].film == f:
                matrix[q, other] = own[SIDES + films.feed_holes[other].slot]
    follow_means(films.channels, films.feed_holes, matrix)
    follow_means(films.channels, films.feed_holes, answers)
    for q in range(count):
        for other in range(count):
            matrix[q, other] = -matrix[q, other]
        matrix[q, q] += 1.0
    solve_dense(matrix, answers)
    for i in range(journals):
        for j in range(journals):
            cross[i, j] = 0.0
    for q in range(count):
        f, slot = films.feed_holes[q].film, films.feed_holes[q].slot
        changes[f, slot] = answers[q, 0]
        x, y = push_of_channel(
            films.films[f], films.ring[f], films.cells[f], states[f], fields[f], slot, work.push
        )
        c, s = math.cos(grids[f].turn), math.sin(grids[f].turn)
        push_x, push_y = c * x - s * y, s * x + c * y
        force[2 * f] += push_x * answers[q, 0]
        force[2 * f + 1] += push_y * answers[q, 0]
        for j in range(journals):
            cross[2 * f, j] += push_x * answers[q, 1 + j]
            cross[2 * f + 1, j] += push_y * answers[q, 1 + j]


@compiled()
def follow_journals(films: VolumeFilms, answers: Array, correction: Array, share: float, changes: Array) -> None:
    """changes (films, slots) <- of the channels' pressures with a share of a correction of the journals' velocities."""
    for q in range(films.feed_holes.shape[0]):
        total = answers[q, 0]
        for j in range(correction.shape[0]):
            total += share * answers[q, 1 + j] * correction[j]
        changes[films.feed_holes[q].film, films.feed_holes[q].slot] = total
