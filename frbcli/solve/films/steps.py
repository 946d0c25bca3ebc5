"""The films at both ends of a stage and of a step of the time loop, compiled.

Each kind of films has its own answers (kinds.py). What the films do in between is in forces.py.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.data import Records
from frbcli.solve.films.cell_steps import Work, accept_cells, begin_cells, make_cell_work, write_cell_oil
from frbcli.solve.films.fillings import GRID, filling_error
from frbcli.solve.films.kinds import CELLS, TILTED, by_kind, kind_of
from frbcli.solve.films.tilted import TiltedWork, make_tilted_work, write_land_oil

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
