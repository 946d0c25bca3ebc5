"""What the films say in one iteration of a stage, compiled: forces, derivatives, and how they follow the journals.

As in films.py, the type of the films decides which kind is meant when the loop is compiled.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types
from numba.extending import overload

from frbcli.compiled import AS_KERNELS, compiled
from frbcli.film.cells.data import REMEMBERS
from frbcli.film.rectangles.film_force import film_force
from frbcli.solve.films.cells import (
    AHEAD,
    BALANCE,
    GRID_X,
    GRID_Y,
    STAGE,
    cell_numbers,
    left_of_cells,
    move_cells,
    sheared,
    store_ahead,
)
from frbcli.solve.films.channels import follow_journals, join, set_laws, set_pressures
from frbcli.solve.films.elements import back_off, element_numbers, left_of_elements, move_elements
from frbcli.solve.films.steps import Work, have_cells, have_elements, have_none, have_scales
from frbcli.solve.stage.equations import FilmMotion
from frbcli.solve.state import Array


def film_numbers(films: Any, work: Work, f: int, motion: FilmMotion, g: float, s: int, iteration: int) -> Any:
    """The ten numbers of film_force for film f at what it feels of its journal; those of cells hold all in the
    derivatives by the velocity.

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


def join_films(
    films: Any, work: Work, clearances: Array, force: Array, follows_x: Array, follows_y: Array
) -> None:
    """After all films have been asked: what coupled channels make of their forces (2 films,), and work.cross.

    follows_x, follows_y: (2 films,), see the rows of stage.py."""
    raise NotImplementedError


def follow_channels(films: Any, work: Work, correction: Array, share: float) -> None:
    """Before the films are moved: the coupled channels follow a share of the correction of the journals' velocities."""
    raise NotImplementedError


def step_back(films: Any, work: Work, rows: Array) -> bool:
    """After all films have been asked: whether one does not go to where the last correction led, and has taken itself
    and U of the rows of stage.py back by some of it. It is to be asked again."""
    raise NotImplementedError


def move_film(films: Any, work: Work, f: int, u_x: float, u_y: float, share: float, g: float) -> int:
    """Take the film along with a correction u of the velocity that it feels, over the clearance, the given share of
    the full one; 1 if not settled."""
    raise NotImplementedError


def left_over(films: Any, work: Work, smooth: float, moved: float, unsettled: int, allowed: float) -> float:
    """What a correction of the journals by `moved` may leave of their error, of which no more than `allowed` may be
    left: `smooth` for forces without kinks, infinite as long as films are unsettled."""
    raise NotImplementedError


def drag_integral(films: Any, work: Work, f: int, d_x: float, d_y: float, factor: int) -> float:
    """The integral of 1 / H over the turn, mean over the width, with the cavitation factor where the film knows one."""
    raise NotImplementedError


def _one_of(films: Any, f: int, d_x: float, d_y: float, v_x: float, v_y: float, omega: float) -> Any:
    """film_force of film f of a tuple of films of several kinds."""
    raise NotImplementedError


@overload(_one_of, jit_options=AS_KERNELS)
def _first_or_later(films, f, d_x, d_y, v_x, v_y, omega):  # type: ignore[no-untyped-def]
    if isinstance(films, types.UniTuple):
        return lambda films, f, d_x, d_y, v_x, v_y, omega: film_force(films[f], d_x, d_y, v_x, v_y, omega)
    if len(films) == 1:
        return lambda films, f, d_x, d_y, v_x, v_y, omega: film_force(films[0], d_x, d_y, v_x, v_y, omega)

    def several(films, f, d_x, d_y, v_x, v_y, omega):  # type: ignore[no-untyped-def]
        if f == 0:
            return film_force(films[0], d_x, d_y, v_x, v_y, omega)
        return _one_of(films[1:], f - 1, d_x, d_y, v_x, v_y, omega)

    return several


@compiled()
def _scaled(
    films: Any, f: int, scale: float, d_x: float, d_y: float, v_x: float, v_y: float, omega: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """film_force of film f with `scale` times the scale of its pressures: that of as many times the velocities."""
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = _one_of(
        films, f, d_x, d_y, scale * v_x, scale * v_y, scale * omega
    )
    return f_x, f_y, k_xx, k_xy, k_yx, k_yy, scale * d_xx, scale * d_xy, scale * d_yx, scale * d_yy


@overload(film_numbers, jit_options=AS_KERNELS | {"forceinline": True}, strict=False)
def _film_numbers(films, work, f, motion, g, s, iteration):  # type: ignore[no-untyped-def]
    if have_none(films):  # never asked
        return lambda films, work, f, motion, g, s, iteration: (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if have_scales(work):
        if isinstance(films, types.UniTuple):  # one call less per film solve: a tenth of the time of a tabulated film

            def scaled(films, work, f, motion, g, s, iteration):  # type: ignore[no-untyped-def]
                scale = work.scales[f]
                f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = film_force(
                    films[f], motion.d_x, motion.d_y, scale * motion.v_x, scale * motion.v_y, scale * motion.omega
                )
                return f_x, f_y, k_xx, k_xy, k_yx, k_yy, scale * d_xx, scale * d_xy, scale * d_yx, scale * d_yy

            return scaled
        return lambda films, work, f, motion, g, s, iteration: _scaled(
            films, f, work.scales[f], motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega
        )
    if isinstance(films, types.UniTuple):
        return lambda films, work, f, motion, g, s, iteration: film_force(
            films[f], motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega
        )
    if have_elements(films):
        return lambda films, work, f, motion, g, s, iteration: element_numbers(
            films, work, motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega, g, iteration
        )
    if not have_cells(films):  # of several kinds: what the compiler knows of each stands at a fixed place of the tuple
        return lambda films, work, f, motion, g, s, iteration: _one_of(
            films, f, motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega
        )

    kernel: Any = cell_numbers  # itself, not called from here: what calls is optimised and turned to machine code, too
    return kernel.py_func


@overload(meet_channels, jit_options=AS_KERNELS)
def _meet_channels(films, work, x_0, u, omega, clearances, g, iteration):  # type: ignore[no-untyped-def]
    if not have_cells(films):
        return lambda films, work, x_0, u, omega, clearances, g, iteration: None

    def volumes(films, work, x_0, u, omega, clearances, g, iteration):  # type: ignore[no-untyped-def]
        if films.feed_holes.shape[0] > 0:
            if iteration == 0:
                set_laws(films, work.grids, x_0, u, omega, clearances, g)
            set_pressures(films, work.grids, work.w, work.channel)

    return volumes


@overload(join_films, jit_options=AS_KERNELS)
def _join_films(films, work, clearances, force, follows_x, follows_y):  # type: ignore[no-untyped-def]
    if not have_cells(films):
        return lambda films, work, clearances, force, follows_x, follows_y: None

    def volumes(films, work, clearances, force, follows_x, follows_y):  # type: ignore[no-untyped-def]
        if films.feed_holes.shape[0] > 0:
            join(films, work, clearances, follows_x, follows_y, force)

    return volumes


@overload(follow_channels, jit_options=AS_KERNELS)
def _follow_channels(films, work, correction, share):  # type: ignore[no-untyped-def]
    if not have_cells(films):
        return lambda films, work, correction, share: None

    def volumes(films, work, correction, share):  # type: ignore[no-untyped-def]
        if films.feed_holes.shape[0] > 0:
            follow_journals(films, work.answers, correction, share, work.changes)

    return volumes


@overload(step_back, inline="always")
def _step_back(films, work, rows):  # type: ignore[no-untyped-def]
    if have_elements(films):
        return lambda films, work, rows: back_off(work, rows)
    return lambda films, work, rows: False


@overload(left_over, inline="always")
def _left_over(films, work, smooth, moved, unsettled, allowed):  # type: ignore[no-untyped-def]
    if have_elements(films):
        return lambda films, work, smooth, moved, unsettled, allowed: left_of_elements(work, moved, unsettled, allowed)
    if not have_cells(films):
        return lambda films, work, smooth, moved, unsettled, allowed: smooth
    return lambda films, work, smooth, moved, unsettled, allowed: left_of_cells(work.grids, smooth, moved)


@overload(move_film, inline="always")
def _move_film(films, work, f, u_x, u_y, share, g):  # type: ignore[no-untyped-def]
    if have_elements(films):
        return lambda films, work, f, u_x, u_y, share, g: move_elements(films, work, u_x, u_y, share, g)
    if not have_cells(films):
        return lambda films, work, f, u_x, u_y, share, g: 0

    def volumes(films, work, f, u_x, u_y, share, g):  # type: ignore[no-untyped-def]
        unsettled = move_cells(work.w[f], work.states[f], work.fields[f], work.grids[f], u_x, u_y, g, work.changes[f])
        if films.numbers[f, REMEMBERS] != 0.0 and work.grids[f, BALANCE] == AHEAD:
            s = int(work.grids[f, STAGE])
            store_ahead(
                films.ring[f], films.cells[f], work, f, u_x, u_y, g, work.stage_oil[s, f], work.stage_flows[s, f]
            )
        return unsettled

    return volumes


@overload(drag_integral, inline="always")
def _drag_integral(films, work, f, d_x, d_y, factor):  # type: ignore[no-untyped-def]
    if not have_cells(films):
        # of 1 / H over the turn, Sommerfeld's integral
        return lambda films, work, f, d_x, d_y, factor: (
            2.0 * math.pi / math.sqrt(max(1.0 - d_x * d_x - d_y * d_y, 1e-6))
        )

    def volumes(films, work, f, d_x, d_y, factor):  # type: ignore[no-untyped-def]
        return sheared(
            films.ring[f], films.cells[f], work.states[f], work.grids[f, GRID_X], work.grids[f, GRID_Y], factor
        )

    return volumes
