"""Fillings of openings, and the grid of films in the loop.

The filling of openings with a flow-limited supply, see boundaries.py, in one stage of the time loop. Compiled.

It is a state as the oil of the cells is: filling' = (given - taken) / line, so that a stage asks for filling = past +
g filling'. What a film takes is known once its cells balance. A step changes the filling far less than the line could
be emptied in that time: what the equation leaves then becomes a small correction, by the secant of two of them.

The grid of a film in the time loop: its place, and the progress of its cells in a stage.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import LAW_NUMBERS
from frbcli.film.cells.balance.boundaries import RESPONSE
from frbcli.film.cells.balance.ends import FILLING
from frbcli.film.cells.balance.states import fill_openings
from frbcli.film.cells.data import PASSED, record
from frbcli.solve.stage.equations import lagrange

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
# (see OPEN); how far the journals were moved last, and its ratio to the time before; the stage; of its openings, see
# fillings.py: their filling, and what the stages before make of it; the one before, and what it was off by; by how much
# less it is off per filling. Its law by follow_law.
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
