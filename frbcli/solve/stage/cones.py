"""Gyroscopic moments of rings that turn and tilt, cartridges, in a stage of the time loop. Compiled. Two kinds:

- an empty tuple: a machine without them, for which nothing is computed;
- Cones: a ring of polar inertia I that turns with w and has the slopes s pulls with -w I (s_y', -s_x') on them, which
  joins the acceleration FREE of each stage, see equations.py, by the velocities of the iteration before.

Which of them a function means is decided by the type of the cones when the loop is compiled, as in loads.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.compiled import compiled_for
from frbcli.solve.stage.equations import FREE, LATE, U_0, V
from frbcli.solve.stage.loads import solve_columns
from frbcli.solve.state import RotorData


class Cones(NamedTuple):
    """rings: (c,) numbers of the rings; columns: (2 c, n) their slopes in x and y times the root of the inertia;
    response: as columns, of the inverse E of inverse.py with them; pulls: (2 c,) of the iteration before; elimination:
    (2, n, 2 n + columns) to work in."""

    rings: NDArray[np.int64]
    columns: Array
    response: Array
    pulls: Array
    elimination: Array


def make_cones(cones: Sequence[tuple[int, Array]], first: int) -> Cones | tuple[()]:
    """The cones of a LinearRotor as the time loop takes them. first: degree of freedom of the first ring's angle."""
    if not cones:
        return ()
    columns = np.concatenate([cone for _, cone in cones])
    count, n = columns.shape
    rings = np.array([spin - first for spin, _ in cones], dtype=np.int64)
    return Cones(rings, columns, np.zeros((count, n)), np.zeros(count), np.zeros((2, n, 2 * n + count)))


@compiled_for(Cones)
def prepare_cones(cones: Cones, rotor: RotorData, g: float, speed: float) -> None:
    """The inverse of `prepare` for this g and speed with the cones."""
    solve_columns(cones.columns, cones.response, cones.elimination, rotor, g, speed)


@compiled_for(Cones, 0.0)
def turn_cones(
    cones: Cones, bodies: Array, s: int, known: int, g: float, selection: Array, at: Array, stage_a: Array,
    journal: Array,
) -> float:  # fmt: skip
    """Renew the pulls in stage s: in FREE and LATE of `at` and U_0 of `journal`. Returns the largest change of U_0 in
    m/s.

    bodies: speeds of the rotor and the rings; known: the stage whose accelerations the velocities follow from, at first
    the one before.
    """
    change = 0.0
    for c in range(cones.rings.shape[0]):
        x, y, speed = 2 * c, 2 * c + 1, bodies[1 + cones.rings[c]]
        slope_x, slope_y = 0.0, 0.0
        for i in range(at.shape[1]):
            rate = at[V, i] + g * stage_a[i, known]
            slope_x += cones.columns[x, i] * rate
            slope_y += cones.columns[y, i] * rate
        before_x, before_y = (cones.pulls[x], cones.pulls[y]) if known == s else (0.0, 0.0)
        cones.pulls[x], cones.pulls[y] = -speed * slope_y, speed * slope_x
        more_x, more_y = cones.pulls[x] - before_x, cones.pulls[y] - before_y
        for i in range(at.shape[1]):
            more = more_x * cones.response[x, i] + more_y * cones.response[y, i]
            at[FREE, i] += more
            at[LATE, i] += more
        for k in range(selection.shape[0]):
            rate = 0.0
            for i in range(at.shape[1]):
                rate += selection[k, i] * (more_x * cones.response[x, i] + more_y * cones.response[y, i])
            journal[U_0, k] += g * rate
            change = max(change, abs(g * rate))
    return change
