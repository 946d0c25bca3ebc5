"""The motion of a journal as the kernels of a film see it, and the gap that it makes along the axis. Compiled."""

from __future__ import annotations

from typing import NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.data import BY_ENDS
from frbcli.film.cells.film import Motion


class GridMotion(NamedTuple):
    """Motion of the journal relative to a film's grid, in the grid's directions, and its share in a time step.

    d: displacement over the clearance; omega: omega_J + omega_S relative to the grid; spin: angular speed of the grid,
    which turns the velocity v; g: how far a velocity moves the journal within the stage, 0: not at all; rate: of what
    is stored, 1 / g of a film that remembers its oil, else 0. Of a journal that tilts d and v are at the place 0 along
    the axis, see PLACES, and grow up to the place 1 by `more`; by_ends: whether derivatives are by the velocities at
    both.
    """

    d_x: float
    d_y: float
    omega: float
    v_x: float = 0.0
    v_y: float = 0.0
    spin: float = 0.0
    g: float = 0.0
    rate: float = 0.0
    more_x: float = 0.0
    more_y: float = 0.0
    more_v_x: float = 0.0
    more_v_y: float = 0.0
    by_ends: bool = False


def seen_by_grid(motion: Motion, g: float = 0.0, by_ends: bool = False, still: bool = False) -> GridMotion:
    """A motion over a section whose places begin at its end z = 0. still: without the velocities, which a solver
    stores by itself."""
    (x, y), (more_x, more_y), omega = motion.d, motion.slope, float(motion.omega)
    (v_x, v_y), (more_v_x, more_v_y) = ((0.0, 0.0), (0.0, 0.0)) if still else (motion.v, motion.slope_rate)
    near = (x - 0.5 * more_x, y - 0.5 * more_y), (v_x - 0.5 * more_v_x, v_y - 0.5 * more_v_y)
    (d_x, d_y), (v_x, v_y), (more_x, more_y, more_v_x, more_v_y) = (
        tuple(map(float, each)) for each in (*near, (more_x, more_y, more_v_x, more_v_y))
    )
    return GridMotion(d_x, d_y, omega, v_x, v_y, 0.0, g, 0.0, more_x, more_y, more_v_x, more_v_y, by_ends)


@compiled(inline=True)
def level(
    d_x: float, d_y: float, omega: float, v_x: float, v_y: float, spin: float, g: float, rate: float
) -> GridMotion:
    """The motion of a journal that does not tilt."""
    return GridMotion(d_x, d_y, omega, v_x, v_y, spin, g, rate, 0.0, 0.0, 0.0, 0.0, False)


@compiled(inline=True)
def gap_along(gap: float, s: float, c: float, motion: GridMotion) -> tuple[float, float]:
    """H at the place 0 along the axis, and by how much more it is at 1, from the gap of a centred journal and sine and
    cosine of the angle."""
    return gap + motion.d_x * s - motion.d_y * c, motion.more_x * s - motion.more_y * c


@compiled(inline=True)
def add_by_motion(right: Array, i: int, j: int, z: float, by_ends: bool, by_x: float, by_y: float) -> None:
    """Add what changes with the velocity at the place z along the axis, to the sides by the velocities."""
    first = right.shape[1] + BY_ENDS
    if by_ends:
        far_x, far_y = z * by_x, z * by_y
        right[i, j, first] += by_x - far_x
        right[i, j, first + 1] += by_y - far_y
        right[i, j, first + 2] += far_x
        right[i, j, first + 3] += far_y
    else:
        right[i, j, first] += by_x
        right[i, j, first + 1] += by_y
