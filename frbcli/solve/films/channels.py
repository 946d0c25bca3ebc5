"""Coupled channels in one stage of the time loop, compiled: the films of a ring solved as one.

Each film is solved with further right-hand sides, one per channel: what a unit of pressure in it does. The pressures of
all channels then follow from one small system (Schur's complement), which leaves equations for the journals alone, now
with the force of a film depending on the journals of both films of its ring.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.dense import solve_dense
from frbcli.film.cells.balance.states import follow_law
from frbcli.film.cells.channels.flow import (
    channel_pressures,
    feed_hole_pressure,
    follow_means,
    mean_changes,
    push_of_channel,
)
from frbcli.film.cells.data import BY_ITSELF, SIDES, Records, VolumeFilms


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
