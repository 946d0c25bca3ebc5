"""Films with cells at both ends of a stage and of a step of the time loop, compiled.

Oil is the state of cells: a stage asks for rate H theta - past = -(net outflow), and the rates of all stages are added
up as for the velocities. What a linearised step leaves of the balance stays in the oil that is carried on, so that none
is lost.

The filling of openings with a flow-limited supply, see boundaries.py, in one stage of the time loop. It is a state as
the oil of the cells is: filling' = (given - taken) / line, so that a stage asks for filling = past + g filling'. What a
film takes is known once its cells balance. A step changes the filling far less than the line could be emptied in that
time: what the equation leaves then becomes a small correction, by the secant of two of them.

The grid of a film in the time loop: its place, and the progress of its cells in a stage.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cells.balance.boundaries import RESPONSE
from frbcli.film.cells.balance.ends import FILLING, FLOWS
from frbcli.film.cells.balance.states import (
    CARRIED_GAS,
    FRACTION,
    STATES,
    TURNOVER,
    fill_openings,
)
from frbcli.film.cells.block_cyclic import ENTRIES
from frbcli.film.cells.data import (
    GAS,
    GAS_RATE,
    NOW,
    OIL,
    PASSED,
    RATE,
    SHEARED,
    SIDES,
    W_BEFORE,
    WET,
    Records,
    VolumeFilms,
    W,
    record,
)
from frbcli.film.cells.gas.carry import NONE, PATHS
from frbcli.solve.stage.equations import lagrange

Three = tuple[Array, Array, Array]


CellArrays = tuple[*Three, *Three, *Three, *Three]


class Work(NamedTuple):
    """Scratch of the time loop, F films of m x k cells: states (F, STATES, m, k), stencil, blocks, fields (F, m, k, k +
    SIDES + S); w, first, past (F, m, k) of the stage, first being w of the first stage; stage_oil (stages, F, m, k)
    rates of the stages; stage_flows (stages, F, FLOWS); of oil that carries gas, else without films, gas_past (F, m,
    k), stage_gas (stages, F, m, k) and gas_paths (F, PATHS, m, k), as of the oil and see carry.py; grids (F,) records
    GRID; push (4, m, k), loads (F, 2), slopes (F, 2, 2), unused (2, 2), see film_loads. Coupled channels with Q feed
    holes, S of one film at most, need channel (F, m, k), answers (Q, 1 + 2 F), changes (F, S), cross (2 F, 2 F), see
    steps.py; all but changes have no rows if there are none."""

    states: Array
    stencil: Array
    blocks: Array
    fields: Array
    w: Array
    first: Array
    past: Array
    stage_oil: Array
    stage_flows: Array
    gas_past: Array
    stage_gas: Array
    gas_paths: Array
    grids: Records
    push: Array
    loads: Array
    slopes: Array
    unused: Array
    channel: Array
    answers: Array
    changes: Array
    cross: Array


def cell_arrays(wet: Array, sides: int, stages: int) -> CellArrays:
    """The first twelve of Work, from states to gas_paths. sides: of the right-hand sides of the balances."""
    _, count, m, k = wet.shape
    gassy = count if len(wet) > WET else 0
    return (
        np.zeros((count, STATES, m, k)),
        np.zeros((ENTRIES, m, k)),
        np.zeros((m, k, k)),
        np.zeros((count, m, k, k + sides)),
        np.zeros((count, m, k)),
        np.zeros((count, m, k)),
        np.zeros((count, m, k)),
        np.zeros((stages, count, m, k)),
        np.zeros((stages, count, FLOWS)),
        np.zeros((gassy, m, k)),
        np.zeros((stages, gassy, m, k)),
        np.zeros((gassy, PATHS, m, k)),
    )


def make_cell_work(films: VolumeFilms, wet: Array, stages: int) -> Work:
    """Scratch for finite-volume films and their state wet (WET, F, m, k)."""
    _, count, m, k = wet.shape
    feed_holes = films.feed_holes.shape[0]
    slots = 1 + int(films.feed_holes["slot"].max()) if feed_holes else 0
    coupled = count if feed_holes else 0
    return Work(
        *cell_arrays(wet, SIDES + slots, stages),
        np.zeros(count, GRID),
        np.zeros((4, m, k)),
        np.zeros((count, 2)),
        np.zeros((count, 2, 2)),
        np.zeros((2, 2)),
        np.zeros((coupled, m, k)),
        np.zeros((feed_holes, 1 + 2 * coupled)),
        np.zeros((count, slots)),
        np.zeros((2 * coupled, 2 * coupled)),
    )


@compiled()
def guess_unknowns(w: Array, first: Array, start: Array, before: Array, weights: Array, s: int, ahead: float) -> None:
    """w of stage s: by the straight line through the step before, and once that serves as a third point by parabolas,
    through both steps and the first stage, later through the last stage instead of the step before.

    w, first: of the last and of the first stage, the latter is kept here; weights: of the method; ahead: how far the
    stage lies from the start of the step, over the step before.
    """
    m, k = w.shape
    if s == 1:
        for i in range(m):
            for j in range(k):
                w[i, j] = start[i, j] + ahead * (start[i, j] - before[i, j])
        return
    at = at_first = at_last = 0.0
    for p in range(weights.shape[1]):  # numba's own sum and copy take seconds to compile
        at, at_first, at_last = at + weights[s, p], at_first + weights[1, p], at_last + weights[s - 1, p]
    if s == 2:
        a, b, c = lagrange(-at / ahead, 0.0, at_first, at)
        for i in range(m):
            for j in range(k):
                first[i, j] = w[i, j]
                w[i, j] = a * before[i, j] + b * start[i, j] + c * w[i, j]
        return
    a, b, c = lagrange(0.0, at_first, at_last, at)
    for i in range(m):
        for j in range(k):
            w[i, j] = a * start[i, j] + b * first[i, j] + c * w[i, j]


def begin_cells(films, work, wet, flows, weights, s, step, g, ahead, lag):  # type: ignore[no-untyped-def]
    """begin_stage of steps.py."""
    count, m, k = work.w.shape
    for f in range(count):
        if not films.films[f].remembers:
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
        if films.films[f].given > 0.0:
            begin_filling(films.films[f], work.grids[f], f, flows, work.stage_flows, weights, s, step, g)
        guess_unknowns(work.w[f], work.first[f], wet[W, f], wet[W_BEFORE, f], weights, s, ahead)
        if films.films[f].carries_gas:
            _begin_gas(work, wet, weights, s, step, g, f)


@compiled()
def _begin_gas(work: Any, wet: Array, weights: Array, s: int, step: float, g: float, f: int) -> None:
    """begin_cells for the gas of film f. In the first stage oil is guessed to come with the gas that it has, and to be
    replaced by what the step stores alone."""
    _, m, k = work.w.shape
    for i in range(m):
        for j in range(k):
            if s == 1:
                work.stage_gas[0, f, i, j] = wet[GAS_RATE, f, i, j]
                work.states[f, CARRIED_GAS, i, j] = wet[GAS, f, i, j] / max(wet[OIL, f, i, j], NONE)
                work.states[f, TURNOVER, i, j] = 1.0 / g
            total = 0.0
            for p in range(s):
                total += weights[s, p] * work.stage_gas[p, f, i, j]
            work.gas_past[f, i, j] = (wet[GAS, f, i, j] + step * total) / g


@compiled()
def _accept_gas(work: Any, wet: Array, weights: Array, step: float, f: int) -> None:
    """accept_cells for the gas of film f."""
    _, m, k = work.w.shape
    last = weights.shape[0] - 1
    for i in range(m):
        for j in range(k):
            for p in range(last + 1):
                wet[GAS, f, i, j] += step * weights[last, p] * work.stage_gas[p, f, i, j]
            wet[GAS_RATE, f, i, j] = work.stage_gas[last, f, i, j]


def accept_cells(films, work, wet, flows, weights, step):  # type: ignore[no-untyped-def]
    """accept_films of steps.py."""
    count, m, k = work.w.shape
    last = weights.shape[0] - 1
    for f in range(count):
        for i in range(m):
            for j in range(k):
                wet[W_BEFORE, f, i, j], wet[W, f, i, j] = wet[W, f, i, j], work.w[f, i, j]
        if not films.films[f].remembers:
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
        if films.films[f].given > 0.0:
            flows[PASSED, f, FILLING] = within(films.films[f], flows[PASSED, f, FILLING])
        if films.films[f].carries_gas:
            _accept_gas(work, wet, weights, step, f)


@compiled()
def oil_fraction(cells: Array, states: Array) -> float:
    """The mean oil fraction of a film, (4.46)."""
    m, k = states.shape[1], states.shape[2]
    area, oil = 0.0, 0.0
    for i in range(m):
        for j in range(k):
            area += cells[SHEARED, i, j]
            oil += cells[SHEARED, i, j] * states[FRACTION, i, j]
    return oil / area


def write_cell_oil(films, work, out_oil, first, last):  # type: ignore[no-untyped-def]
    """write_oil of steps.py."""
    if last > first:
        for f in range(work.w.shape[0]):
            oil = oil_fraction(films.cells[f], work.states[f])
            for row in range(first, last):
                out_oil[row, f] = oil


PLAIN = 1.0  # by how much less a filling is off after it has risen by 1, at the least: the film takes the more


def filling_error(films, work, flows, weights, defect, step):  # type: ignore[no-untyped-def]
    """film_error of steps.py; a line that stays full has none."""
    largest, last = 0.0, weights.shape[0] - 1
    for f in range(films.films.shape[0]):
        if films.films[f].given > 0.0:
            filling, off = flows[PASSED, f, FILLING], 0.0
            for p in range(last + 1):
                filling += step * weights[last, p] * work.stage_flows[p, f, FILLING]
                off += step * defect[p] * work.stage_flows[p, f, FILLING]
            largest = max(largest, abs(within(films.films[f], filling) - within(films.films[f], filling - off)))
    return largest


@compiled(inline=True)
def within(film: np.record, filling: float) -> float:
    """A filling within its bounds: what a full line cannot take up stays in the supply."""
    return float(min(max(filling, film.lowest), 1.0))


@compiled()
def begin_filling(
    film: np.record, grid: np.record, f: int, flows: Array, stage_flows: Array, weights: Array, s: int, step: float,
    g: float,
) -> None:  # fmt: skip
    """The openings of film f at stage s <- a guess of their filling, by the rates of the stages before."""
    total = at = at_first = at_last = 0.0
    for p in range(weights.shape[1]):
        at, at_first, at_last = at + weights[s, p], at_first + weights[1, p], at_last + weights[s - 1, p]
    for p in range(s):
        total += weights[s, p] * stage_flows[p, f, FILLING]
    start, first, last = stage_flows[0, f, FILLING], stage_flows[1, f, FILLING], stage_flows[s - 1, f, FILLING]
    if s == 1:
        rate, grid.per_filling = start, PLAIN
    elif s == 2:
        rate = start + (first - start) * at / at_first
    else:
        a, b, c = lagrange(0.0, at_first, at_last, at)
        rate = a * start + b * first + c * last
    grid.filling_past = flows[PASSED, f, FILLING] + step * total
    grid.filling, grid.filling_off = within(film, grid.filling_past + g * rate), 0.0
    fill_openings(film, grid.filling)


@compiled()
def follow_filling(film: np.record, grid: np.record, flows: Array, g: float, allowed: float) -> bool:
    """Correct the filling of openings that are off their equation by more than a flow in 1/s; flows (FLOWS,) of cells
    that balance. Returns whether the openings have changed."""
    off = within(film, grid.filling_past + g * flows[FILLING]) - grid.filling
    if abs(off) * film.line <= RESPONSE * allowed:
        return False
    if grid.filling_off != 0.0:
        grid.per_filling = max((grid.filling_off - off) / (grid.filling - grid.filling_before), PLAIN)
    grid.filling_off, grid.filling_before = off, grid.filling
    grid.filling = within(film, grid.filling + off / grid.per_filling)
    fill_openings(film, grid.filling)
    return True


# A film in the loop: the angle of its grid, and its speed; where the journal is in it (x, y); whether its cells balance
# (see OPEN); how far the journals were moved last, and its ratio to the time before; the stage; of its openings their
# filling, and what the stages before make of it; the one before, and what it was off by; by how much less it is off per
# filling. Its law by follow_law.
GRID = record(
    ("turn", "f8"),
    ("speed", "f8"),
    ("x", "f8"),
    ("y", "f8"),
    ("moved", "f8"),
    ("ratio", "f8"),
    ("balance", "i8"),
    ("stage", "i8"),
    ("filling", "f8"),
    ("filling_past", "f8"),
    ("filling_before", "f8"),
    ("filling_off", "f8"),
    ("per_filling", "f8"),
    ("law", "f8", (LAW_NUMBERS,)),
)
