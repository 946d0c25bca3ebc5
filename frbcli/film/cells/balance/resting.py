"""Columns of cells with constant oil: cavities at p_cav that turn with the oil, between others like them. Compiled.

Nothing flows through the faces of such a column, whatever its cells hold, so that H theta stays what it was. Its cells
feel no others, and Newton's step of each is a division. A film that empties consists mostly of them.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.states import (
    FRACTION_SLOPE,
    PRESSURE,
    PRESSURE_SLOPE,
    RESTS,
    SOURCE,
    SOURCE_SLOPE,
)
from frbcli.film.cells.data import CLOSED, GIVEN, NO_CLIP, UNKNOWN


@compiled(inline=True)
def rests(states: Array, i: int) -> bool:
    """Whether the oil of column i stays constant."""
    return bool(states[RESTS, i, 0] != 0.0)


@compiled(inline=True)
def _is_cavity(cells: Array, states: Array, p_cav: float, i: int) -> bool:
    """Whether all cells of column i are at p_cav, whatever they hold, and gain no oil by themselves."""
    for j in range(states.shape[2]):
        if states[PRESSURE_SLOPE, i, j] != 0.0 or states[PRESSURE, i, j] != p_cav or cells[UNKNOWN, i, j] == 0.0:
            return False
        if states[SOURCE, i, j] != 0.0 or states[SOURCE_SLOPE, i, j] != 0.0 or states[FRACTION_SLOPE, i, j] == 0.0:
            return False
    return True


@compiled(inline=True)
def _passes_nothing(end: np.record, pressure: float) -> bool:
    """Whether nothing flows through an end of a section next to cells of this pressure."""
    return bool(end.kind == CLOSED or (end.kind == GIVEN and pressure == 0.0))


@compiled()
def find_resting(film: np.record, cells: Array, states: Array, still: bool, fields: Array) -> None:
    """The layer RESTS of states (STATES, m, k) <- in which columns of a film the oil stays constant. still: whether its
    cells turn with the oil. fields (m, k, n) <- 0 of columns that no longer do: nobody has solved for them."""
    m, p_cav = states.shape[1], film.scales.cavitation
    still = still and film.remembers and not film.carries_gas and film.roughness == 0.0 and film.clips == NO_CLIP
    still = still and _passes_nothing(film.near, p_cav) and _passes_nothing(film.far, p_cav)
    before, here = still and _is_cavity(cells, states, p_cav, m - 1), still and _is_cavity(cells, states, p_cav, 0)
    for i in range(m):
        behind = still and _is_cavity(cells, states, p_cav, i + 1 if i + 1 < m else 0)
        rested, keeps = rests(states, i), before and here and behind
        states[RESTS, i, 0] = 1.0 if keeps else 0.0
        if rested and not keeps:
            for j in range(fields.shape[1]):
                for side in range(fields.shape[2]):
                    fields[i, j, side] = 0.0
        before, here = here, behind
