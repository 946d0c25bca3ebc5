"""The films in the time loop, compiled. Three kinds ride in it, or none at all, an empty tuple:

- FilmData, one per film: force and derivatives follow from where the journal is and how it moves;
- VolumeFilms, all films together: cells with unknowns of their own, see cell_films.py;
- ElementFilm, the one film of a machine: elements of the published two-phase form, see element_films.py.

Which of them a function means is decided by the type of the films when the loop is compiled. Of cells, oil is the
state: a stage asks for rate H theta - past = -(net outflow), the rates of all stages are added up as those of the
velocities are. What a linearised step leaves of the balance stays in the oil that is carried on, so that none is lost.

Here is what happens at both ends of a stage and of a step; what the films say in between is in film_forces.py.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from frbcli.compiled import AS_KERNELS
from frbcli.film.cells.balance.balances import FLOWS, SIDES
from frbcli.film.cells.balance.states import STATES
from frbcli.film.cells.data import REMEMBERS, SLOT, VolumeFilms
from frbcli.film.cells.elimination.block_cyclic import ENTRIES
from frbcli.film.published.data import ElementFilm
from frbcli.film.state import NOW, OIL, PASSED, RATE, W_BEFORE, W
from frbcli.solve.films.cells import GRIDS, guess_unknowns, oil_fraction
from frbcli.solve.films.elements import (
    MOST_ITERATIONS,
    ElementWork,
    accept_elements,
    begin_elements,
    make_element_work,
    write_element_oil,
)
from frbcli.solve.state import Array

NEWTON_LIMIT = 12  # iterations before a step is tried again with a smaller one
CELL_LIMIT = 24  # the same for films with cells, whose kinks take longer


class Work(NamedTuple):
    """Scratch of the time loop, F films of m x k cells: states (F, STATES, m, k), stencil, blocks, fields (F, m, k,
    k + SIDES + S); w, first, past (F, m, k) of the stage, first being w of the first stage; stage_oil (stages, F, m, k)
    rates of the stages; stage_flows (stages, F, FLOWS); grids (F, GRIDS); slopes (F, 4). Of coupled channels with Q
    feed holes, S of one film at most: channel (F, m, k), answers (Q, 1 + 2 F), changes (F, S), cross (2 F, 2 F), see
    channels.py; all but changes without rows if there are none."""

    states: Array
    stencil: Array
    blocks: Array
    fields: Array
    w: Array
    first: Array
    past: Array
    stage_oil: Array
    stage_flows: Array
    grids: Array
    slopes: Array
    channel: Array
    answers: Array
    changes: Array
    cross: Array


class NoCells(NamedTuple):
    """What loops look for in the work of any films, all of it empty for films without cells."""

    stage_oil: Array
    grids: Array
    cross: Array


class Scaled(NamedTuple):
    """The same for tabulated films of a machine with heat, with scales (F,) of their tables, see film_forces.py."""

    stage_oil: Array
    grids: Array
    cross: Array
    scales: Array


def have_scales(work: Any) -> bool:
    """Whether a type that the compiler knows is that of the work of tabulated films with heat."""
    return getattr(work, "instance_class", None) is Scaled


def have_none(films: Any) -> bool:
    """Whether a type that the compiler knows is that of no films, an empty tuple."""
    return isinstance(films, types.BaseTuple) and len(films) == 0


def have_cells(films: Any) -> bool:
    """Whether a type that the compiler knows is that of films with cells."""
    return getattr(films, "instance_class", None) is VolumeFilms


def have_elements(films: Any) -> bool:
    """Whether a type that the compiler knows is that of a film in the published form."""
    return getattr(films, "instance_class", None) is ElementFilm


def make_work(
    films: Any, wet: Array, stages: int, scales: Array | None = None
) -> Work | ElementWork | NoCells | Scaled:
    """Scratch for films and their state wet (WET, F, m, k). scales: of tabulated films with heat."""
    if isinstance(films, ElementFilm):
        return make_element_work(films, stages)
    if not isinstance(films, VolumeFilms):
        none = NoCells(np.zeros((stages, 0, 0, 0)), np.zeros((0, GRIDS)), np.zeros((0, 0)))
        return none if scales is None else Scaled(*none, scales)
    _, count, m, k = wet.shape
    feed_holes = films.feed_holes.shape[0]
    slots = 1 + int(films.feed_holes[:, SLOT].max()) if feed_holes else 0
    coupled = count if feed_holes else 0
    return Work(
        np.zeros((count, STATES, m, k)),
        np.zeros((ENTRIES, m, k)),
        np.zeros((m, k, k)),
        np.zeros((count, m, k, k + SIDES + slots)),
        np.zeros((count, m, k)),
        np.zeros((count, m, k)),
        np.zeros((count, m, k)),
        np.zeros((stages, count, m, k)),
        np.zeros((stages, count, FLOWS)),
        np.zeros((count, GRIDS)),
        np.zeros((count, 4)),
        np.zeros((coupled, m, k)),
        np.zeros((feed_holes, 1 + 2 * coupled)),
        np.zeros((count, slots)),
        np.zeros((2 * coupled, 2 * coupled)),
    )


def most_iterations(films: Any) -> int:
    """Of Newton's method in a stage."""
    raise NotImplementedError


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


def accept_films(films: Any, work: Work, wet: Array, flows: Array, weights: Array, step: float) -> None:
    """The step is done: the films' state moves on. flows: (2, F, FLOWS) oil that has passed so far, and passes now."""
    raise NotImplementedError


def write_oil(films: Any, work: Work, out_oil: Array, first: int, last: int) -> None:
    """out_oil (rows, F), rows from first up to last: the mean oil fraction (4.46) at the end of an accepted step."""
    raise NotImplementedError


@overload(most_iterations, inline="always")
def _most_iterations(films):  # type: ignore[no-untyped-def]
    most = MOST_ITERATIONS if have_elements(films) else CELL_LIMIT if have_cells(films) else NEWTON_LIMIT
    return lambda films: most


@overload(begin_stage, jit_options=AS_KERNELS)
def _begin_stage(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
    if have_elements(films):
        return begin_elements
    if not have_cells(films):
        return lambda films, work, wet, flows, weights, s, step, g, ahead, lag: None

    def volumes(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
        count, m, k = work.w.shape
        for f in range(count):
            if films.numbers[f, REMEMBERS] == 0.0:
                guess_unknowns(work.w[f], work.first[f], wet[W, f], wet[W_BEFORE, f], weights, s, ahead)
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
            guess_unknowns(work.w[f], work.first[f], wet[W, f], wet[W_BEFORE, f], weights, s, ahead)

    return volumes


@overload(accept_films, jit_options=AS_KERNELS)
def _accept_films(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
    if have_elements(films):
        return accept_elements
    if not have_cells(films):
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


@overload(write_oil, jit_options=AS_KERNELS)
def _write_oil(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
    if have_elements(films):
        return write_element_oil
    if not have_cells(films):
        return lambda films, work, out_oil, first, last: None

    def volumes(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
        if last > first:
            for f in range(work.w.shape[0]):
                oil = oil_fraction(films.cells[f], work.states[f])
                for row in range(first, last):
                    out_oil[row, f] = oil

    return volumes
