"""The films in the time loop, compiled. Two kinds ride in it:

- FilmData, one per film: force and derivatives follow from where the journal is and how it moves;
- VolumeFilms, all films together: cells with unknowns of their own, see cell_passengers.py.

Which of the two a function means is decided by the type of the films when the loop is compiled. Oil is the state: a
stage asks for rate H theta - past = -(net outflow), the rates of all stages are added up as those of the velocities
are. What a linearised step leaves of the balance stays in the oil that is carried on, so that none is lost.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from frbcli.film.block_cyclic import ENTRIES
from frbcli.film.cell_balances import FLOWS, SIDES
from frbcli.film.cell_states import STATES
from frbcli.film.kernel import film_force
from frbcli.film.volume_data import REMEMBERS, SLOT, VolumeFilms
from frbcli.solve.cell_channels import follow_journals, join, set_law, set_pressures
from frbcli.solve.cell_passengers import (
    GRID_X,
    GRID_Y,
    GRIDS,
    cell_numbers,
    guess_unknowns,
    move_cells,
    oil_fraction,
    sheared,
)
from frbcli.solve.state import Array

# Layers of the films' state: unknown w now and at the start of the step before, oil H theta, its rate.
W, W_BEFORE, OIL, RATE, WET = range(5)
PASSED, NOW = range(2)


class Work(NamedTuple):
    """Scratch of the time loop, F films of m x k cells: states (F, STATES, m, k), stencil, blocks, fields (F, m, k,
    k + SIDES + S); w, past (F, m, k) of the stage; stage_oil (stages, F, m, k) rates of the stages; stage_flows
    (stages, F, FLOWS); grids (GRIDS, F); slopes (F, 4); all without rows for films without cells. Of coupled channels
    with Q mouths, S of a film at most: channel (F, m, k), answers (Q, 1 + 2 F), changes (F, S), cross (2 F, 2 F), see
    cell_channels.py; all but changes without rows if there are none."""

    states: Array
    stencil: Array
    blocks: Array
    fields: Array
    w: Array
    past: Array
    stage_oil: Array
    stage_flows: Array
    grids: Array
    slopes: Array
    channel: Array
    answers: Array
    changes: Array
    cross: Array


def _volumes(films: Any) -> bool:
    return getattr(films, "instance_class", None) is VolumeFilms


def mouth_counts(films: Any) -> tuple[int, int]:
    """How many mouths coupled channels have, and how many of them in one film at most."""
    raise NotImplementedError


@overload(mouth_counts)
def _mouth_counts(films):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films: (0, 0)

    def volumes(films):  # type: ignore[no-untyped-def]
        slots = 0
        for q in range(films.mouths.shape[0]):
            slots = max(slots, 1 + int(films.mouths[q, SLOT]))
        return films.mouths.shape[0], slots

    return volumes


@njit(cache=True, error_model="numpy")
def make_work(films, wet, stages):  # type: ignore[no-untyped-def]
    """Scratch for films and their state wet (WET, F, m, k)."""
    count, m, k = wet.shape[1], wet.shape[2], wet.shape[3]
    mouths, slots = mouth_counts(films)
    coupled = count if mouths > 0 else 0
    return Work(
        np.zeros((count, STATES, m, k)),
        np.zeros((ENTRIES, m, k)),
        np.zeros((m, k, k)),
        np.zeros((count, m, k, k + SIDES + slots)),
        np.zeros((count, m, k)),
        np.zeros((count, m, k)),
        np.zeros((stages, count, m, k)),
        np.zeros((stages, count, FLOWS)),
        np.zeros((GRIDS, count)),
        np.zeros((count, 4)),
        np.zeros((coupled, m, k)),
        np.zeros((mouths, 1 + 2 * coupled)),
        np.zeros((count, slots)),
        np.zeros((2 * coupled, 2 * coupled)),
    )


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
    """What stage s knows of the films before it is solved: past, and a guess of w. ahead, lag: how far the stage and
    the one before it lie from the start of the step, over the step before and over this one."""
    raise NotImplementedError


def film_numbers(
    films: Any,
    work: Work,
    f: int,
    d_x: float,
    d_y: float,
    v_x: float,
    v_y: float,
    omega: float,
    g: float,
    s: int,
    iteration: int,
) -> Any:
    """The ten numbers of film_force for film f; those of cells hold all in the derivatives by the velocity.

    A film whose balances hold already, but not in the first iteration of stage s, is settled: its rates are kept, and
    it only follows the journal. One that does not settle goes on with shorter steps.
    """
    raise NotImplementedError


def meet_channels(
    films: Any, work: Work, x_0: Array, u: Array, omega: Array, clearances: Array, g: float, iteration: int
) -> None:
    """Before the films are asked in an iteration: the pressures of the coupled channels, by the films as they are.

    x_0, u, omega: (2 films,), see the rows of stage.py."""
    raise NotImplementedError


def join_films(films: Any, work: Work, clearances: Array, force: Array) -> None:
    """After all films have been asked: what coupled channels make of their forces (2 films,), and work.cross."""
    raise NotImplementedError


def follow_channels(films: Any, work: Work, correction: Array, share: float) -> None:
    """Before the films are moved: the coupled channels follow a share of the correction of the journals' velocities."""
    raise NotImplementedError


def move_film(films: Any, work: Work, f: int, u_x: float, u_y: float, g: float) -> int:
    """Take the film along with a correction u of the journal's velocity over the clearance; 1 if it had not settled."""
    raise NotImplementedError


def write_oil(films: Any, work: Work, out_oil: Array, first: int, last: int) -> None:
    """out_oil (rows, F), rows from first up to last: the mean oil fraction (4.46) of the last stage."""
    raise NotImplementedError


def accept_films(films: Any, work: Work, wet: Array, flows: Array, weights: Array, step: float) -> None:
    """The step is done: the films' state moves on. flows: (2, F, FLOWS) oil that has passed so far, and passes now."""
    raise NotImplementedError


def drag_integral(films: Any, work: Work, f: int, d_x: float, d_y: float, factor: int) -> float:
    """The integral of 1 / H over the turn, mean over the width, with the cavitation factor where the film knows one."""
    raise NotImplementedError


@overload(begin_stage)
def _begin_stage(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, wet, flows, weights, s, step, g, ahead, lag: None

    def volumes(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
        count, m, k = work.w.shape
        for f in range(count):
            if films.numbers[f, REMEMBERS] == 0.0:
                guess_unknowns(work.w[f], wet[W, f], wet[W_BEFORE, f], s, ahead, lag)
                continue
            if s == 1:
                for i in range(m):
                    for j in range(k):
                        work.stage_oil[0, f, i, j] = wet[RATE, f, i, j]
                for flow in range(FLOWS):
                    work.stage_flows[0, f, flow] = flows[NOW, f, flow]
            for i in range(m):
                for j in range(k):
                    total = 0.0
                    for p in range(s):
                        total += weights[s, p] * work.stage_oil[p, f, i, j]
                    work.past[f, i, j] = (wet[OIL, f, i, j] + step * total) / g
            guess_unknowns(work.w[f], wet[W, f], wet[W_BEFORE, f], s, ahead, lag)

    return volumes


@overload(film_numbers, inline="always")
def _film_numbers(films, work, f, d_x, d_y, v_x, v_y, omega, g, s, iteration):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, f, d_x, d_y, v_x, v_y, omega, g, s, iteration: film_force(
            films[f], d_x, d_y, v_x, v_y, omega
        )

    def volumes(films, work, f, d_x, d_y, v_x, v_y, omega, g, s, iteration):  # type: ignore[no-untyped-def]
        return cell_numbers(
            films.numbers[f],
            films.ring[f],
            films.width[f],
            films.cells[f],
            work.w[f],
            work.past[f],
            work.states[f],
            work.stencil,
            work.blocks,
            work.fields[f],
            work.stage_oil[s, f],
            work.stage_flows[s, f],
            work.grids[:, f],
            work.slopes[f],
            work.channel[f] if work.channel.shape[0] > 0 else work.w[f],
            d_x,
            d_y,
            v_x,
            v_y,
            omega,
            g,
            iteration,
        )

    return volumes


@overload(meet_channels)
def _meet_channels(films, work, x_0, u, omega, clearances, g, iteration):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, x_0, u, omega, clearances, g, iteration: None

    def volumes(films, work, x_0, u, omega, clearances, g, iteration):  # type: ignore[no-untyped-def]
        if films.mouths.shape[0] > 0:
            if iteration == 0:
                set_law(films, work.grids, x_0, u, omega, clearances, g)
            set_pressures(films, work.grids, work.w, work.channel)

    return volumes


@overload(join_films)
def _join_films(films, work, clearances, force):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, clearances, force: None

    def volumes(films, work, clearances, force):  # type: ignore[no-untyped-def]
        if films.mouths.shape[0] > 0:
            join(
                films, work.grids, work.states, work.fields, clearances, force, work.cross, work.answers, work.changes
            )

    return volumes


@overload(follow_channels)
def _follow_channels(films, work, correction, share):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, correction, share: None

    def volumes(films, work, correction, share):  # type: ignore[no-untyped-def]
        if films.mouths.shape[0] > 0:
            follow_journals(films, work.answers, correction, share, work.changes)

    return volumes


@overload(move_film, inline="always")
def _move_film(films, work, f, u_x, u_y, g):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, f, u_x, u_y, g: 0

    def volumes(films, work, f, u_x, u_y, g):  # type: ignore[no-untyped-def]
        return move_cells(work.w[f], work.fields[f], work.grids[:, f], u_x, u_y, g, work.changes[f])

    return volumes


@overload(accept_films)
def _accept_films(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, wet, flows, weights, step: None

    def volumes(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
        count, m, k = work.w.shape
        last = weights.shape[0] - 1
        for f in range(count):
            for i in range(m):
                for j in range(k):
                    wet[W_BEFORE, f, i, j], wet[W, f, i, j] = wet[W, f, i, j], work.w[f, i, j]
            if films.numbers[f, REMEMBERS] == 0.0:
                continue
            for p in range(last + 1):
                share = step * weights[last, p]
                for i in range(m):
                    for j in range(k):
                        wet[OIL, f, i, j] += share * work.stage_oil[p, f, i, j]
                for flow in range(FLOWS):
                    flows[PASSED, f, flow] += share * work.stage_flows[p, f, flow]
            for i in range(m):
                for j in range(k):
                    wet[RATE, f, i, j] = work.stage_oil[last, f, i, j]
            for flow in range(FLOWS):
                flows[NOW, f, flow] = work.stage_flows[last, f, flow]

    return volumes


@overload(write_oil)
def _write_oil(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        return lambda films, work, out_oil, first, last: None

    def volumes(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
        if last > first:
            for f in range(work.w.shape[0]):
                oil = oil_fraction(films.cells[f], work.states[f])
                for row in range(first, last):
                    out_oil[row, f] = oil

    return volumes


@overload(drag_integral, inline="always")
def _drag_integral(films, work, f, d_x, d_y, factor):  # type: ignore[no-untyped-def]
    if not _volumes(films):
        # of 1 / H over the turn, Sommerfeld's integral
        return lambda films, work, f, d_x, d_y, factor: (
            2.0 * math.pi / math.sqrt(max(1.0 - d_x * d_x - d_y * d_y, 1e-6))
        )

    def volumes(films, work, f, d_x, d_y, factor):  # type: ignore[no-untyped-def]
        return sheared(
            films.ring[f], films.cells[f], work.states[f], work.grids[GRID_X, f], work.grids[GRID_Y, f], factor
        )

    return volumes
