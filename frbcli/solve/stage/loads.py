"""Loads that change with the angle of the rotor or with time, in a stage of the time loop. Compiled. Two kinds:

- an empty tuple: a machine without them, for which nothing is computed;
- VaryingLoads: they join the acceleration FREE of each stage, see equations.py.

Which of them a function means is decided by the type of the loads when the loop is compiled, as in heat.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.compiled import compiled, compiled_for
from frbcli.dense import solve_dense
from frbcli.rotor.loads import Harmonic, Load, Tabulated
from frbcli.solve.stage.equations import FREE, U_0, add_table
from frbcli.solve.state import RotorData

ORDER, FREQUENCY = range(2)  # of a harmonic


class VaryingLoads(NamedTuple):
    """The h harmonic and then the k tabulated loads of rotor/loads.py.

    columns: (2 (h + k), n) N; turns: (h, 2) ORDER and FREQUENCY in rad/s; first: (k + 1,) row of each table, and their
    number; times: (rows,) s of all tables; cubics: (rows, 2, 4); response: as columns, m/s^2, of the inverse E of
    equations.py with them; elimination: (2, n, 2 n + columns) to work in.
    """

    columns: Array
    turns: Array
    first: NDArray[np.int64]
    times: Array
    cubics: Array
    response: Array
    elimination: Array


def varying_loads(loads: Sequence[Load]) -> VaryingLoads | tuple[()]:
    """The loads of a machine as the time loop takes them."""
    if not loads:
        return ()
    harmonics = [load for load in loads if isinstance(load, Harmonic)]
    tables = [load for load in loads if isinstance(load, Tabulated)]
    columns = np.concatenate([load.columns for load in (*harmonics, *tables)])
    count, n = columns.shape
    nothing = np.zeros((1, 2, 4))  # behind the end of each table
    return VaryingLoads(
        columns,
        np.array([[load.order, load.frequency] for load in harmonics]).reshape(-1, 2),
        np.cumsum([0, *(len(table.times) for table in tables)]),
        np.concatenate([np.zeros(0), *(table.times for table in tables)]),
        np.concatenate([nothing[:0], *(part for table in tables for part in (table.cubics, nothing))]),
        np.zeros((count, n)),
        np.zeros((2, n, 2 * n + count)),
    )


@compiled_for(VaryingLoads)
def prepare_loads(loads: VaryingLoads, rotor: RotorData, g: float, speed: float) -> None:
    """The inverse of `prepare` for this g and speed with the loads."""
    solve_columns(loads.columns, loads.response, loads.elimination, rotor, g, speed)


@compiled()
def solve_columns(
    columns: Array, response: Array, elimination: Array, rotor: RotorData, g: float, speed: float
) -> None:
    """response <- the inverse E of equations.py for this g and speed with columns (c, n) of forces."""
    n, count = rotor.mass.shape[0], columns.shape[0]
    dynamic, right = elimination[0], elimination[1]  # the forces lie behind the columns of add_table
    for i in range(n):
        for j in range(n):
            dynamic[i, j] = rotor.mass[i, j] + g * (
                rotor.damping[i, j] + speed * rotor.gyroscopic[i, j] + g * rotor.stiffness[i, j]
            )
        for k in range(count):
            right[i, 2 * n + k] = columns[k, i]
    if rotor.table_speeds.shape[0] > 0:
        add_table(rotor, g, speed, dynamic, right)
    solve_dense(dynamic, right)
    for i in range(n):
        for k in range(count):
            response[k, i] = right[i, 2 * n + k]


@compiled()
def row_at(times: Array, first: int, end: int, t: float) -> int:
    """The row of a table, of rows from first up to end, whose piece holds the time t."""
    low, high = first, end - 1
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@compiled()
def _cubic(coefficients: Array, s: float) -> float:
    return float(coefficients[0] + s * (coefficients[1] + s * (coefficients[2] + s * coefficients[3])))


@compiled_for(VaryingLoads)
def add_loads(
    loads: VaryingLoads, t: float, angle: float, g: float, selection: Array, at: Array, journal: Array
) -> None:
    """Add the loads at the time t in s and the angle of the rotor then to FREE of `at` and U_0 of `journal`."""
    harmonics = loads.turns.shape[0]
    for k in range(harmonics + loads.first.shape[0] - 1):
        if k < harmonics:
            theta = loads.turns[k, ORDER] * angle + loads.turns[k, FREQUENCY] * t
            one, other = math.cos(theta), math.sin(theta)
        else:
            row = row_at(loads.times, loads.first[k - harmonics], loads.first[k - harmonics + 1], t)
            since = t - loads.times[row]
            one, other = _cubic(loads.cubics[row, 0], since), _cubic(loads.cubics[row, 1], since)
        for i in range(at.shape[1]):
            more = one * loads.response[2 * k, i] + other * loads.response[2 * k + 1, i]
            at[FREE, i] += more
            for j in range(selection.shape[0]):
                journal[U_0, j] += g * selection[j, i] * more
