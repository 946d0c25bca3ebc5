"""The films in one iteration of a stage, compiled: forces, derivatives, and how they follow the journals.

As in films.py, the type of the films decides which kind is meant when the loop is compiled.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types
from numba.extending import overload

from frbcli.arrays import Array
from frbcli.compiled import AS_KERNELS, compiled
from frbcli.film.rectangles.film_force import film_force
from frbcli.solve.films.cell_steps import Work
from frbcli.solve.films.cells import (
    AHEAD,
    cell_response,
    left_of_cells,
    move_cells,
    sheared,
    store_ahead,
)
from frbcli.solve.films.channels import follow_journals, join, set_laws, set_pressures
from frbcli.solve.films.kinds import CELLS, NONE, TILTED, by_kind, kind_of
from frbcli.solve.films.steps import Scaled, Supplied
from frbcli.solve.films.tilted import ENDS, end_response, join_ends, meet_ends, move_end, tilted_sheared
from frbcli.solve.stage.equations import FilmMotion


def film_response(films: Any, work: Work, f: int, motion: FilmMotion, g: float, s: int, iteration: int) -> Any:
    """The ten numbers of film_force for film f at what it feels of its journal; for cells the derivatives by the
    velocity contain all.

    A film whose balances hold already, but not in the first iteration of stage s, is settled: its rates are kept, and
    it only follows the journal. One that does not settle goes on with shorter steps.
    """
    raise NotImplementedError


def meet_films(
    films: Any, work: Work, x_0: Array, u: Array, omega: Array, clearances: Array, g: float, iteration: int
) -> None:
    """Before the films are asked in an iteration: the pressures of the coupled channels, by the films as they are; how
    both ends of a journal that tilts move.

    x_0, u, omega: (2 films,), see the rows of equations.py."""
    raise NotImplementedError


def join_films(
    films: Any, work: Work, clearances: Array, force: Array, follows_x: Array, follows_y: Array
) -> None:
    """After all films have been asked: what coupled channels make of their forces (2 films,), and work.cross, also of
    both ends of a bearing.

    follows_x, follows_y: (2 films,), see the rows of equations.py."""
    raise NotImplementedError


def follow_channels(films: Any, work: Work, correction: Array, share: float) -> None:
    """Before the films are moved: the coupled channels follow a share of the correction of the journals' velocities."""
    raise NotImplementedError


def move_film(films: Any, work: Work, f: int, u_x: float, u_y: float, g: float) -> int:
    """Take the film along with a correction u of the velocity that it feels, over the clearance; 1 if not settled."""
    raise NotImplementedError


def left_over(films: Any, work: Work, smooth: float, moved: float) -> float:
    """Error of the journals that may be left after a correction by `moved`: `smooth` for forces without kinks, infinite
    as long as films are unsettled."""
    raise NotImplementedError


def solved(films: Any, count: int) -> int:
    """Films that are solved when the loop has asked `count` times for a force."""
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
    """film_force of film f with `scale` times the scale of its pressures: equals the force at `scale` times the
    velocities."""
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = _one_of(
        films, f, d_x, d_y, scale * v_x, scale * v_y, scale * omega
    )
    return f_x, f_y, k_xx, k_xy, k_yx, k_yy, scale * d_xx, scale * d_xy, scale * d_yx, scale * d_yy


@compiled()
def _supplied(
    films: Any, f: int, scale: float, share: float, d_x: float, d_y: float, v_x: float, v_y: float, omega: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """_scaled with forces of a share of the pressures of the table."""
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = _scaled(films, f, scale, d_x, d_y, v_x, v_y, omega)
    r = share
    return r * f_x, r * f_y, r * k_xx, r * k_xy, r * k_yx, r * k_yy, r * d_xx, r * d_xy, r * d_yx, r * d_yy


@overload(film_response, jit_options=AS_KERNELS | {"forceinline": True}, strict=False)
def _film_response(films, work, f, motion, g, s, iteration):  # type: ignore[no-untyped-def]
    kind = kind_of(films)
    if kind == NONE:  # never asked
        return lambda films, work, f, motion, g, s, iteration: (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if getattr(work, "instance_class", None) is Scaled:
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
    if getattr(work, "instance_class", None) is Supplied:
        return lambda films, work, f, motion, g, s, iteration: _supplied(
            films, f, work.scales[f], work.shares[f], motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega
        )
    if isinstance(films, types.UniTuple):
        return lambda films, work, f, motion, g, s, iteration: film_force(
            films[f], motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega
        )
    if kind == TILTED:
        return lambda films, work, f, motion, g, s, iteration: end_response(films, work, f, g, s, iteration)
    if kind != CELLS:  # of several kinds: what the compiler knows of each stands at a fixed place of the tuple
        return lambda films, work, f, motion, g, s, iteration: _one_of(
            films, f, motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega
        )

    kernel: Any = cell_response  # itself, not called from here: what calls is optimised and turned to machine code, too
    return kernel.py_func


def _meet(films, work, x_0, u, omega, clearances, g, iteration):  # type: ignore[no-untyped-def]
    """meet_films of films with cells."""
    if films.feed_holes.shape[0] > 0:
        if iteration == 0:
            set_laws(films, work.grids, x_0, u, omega, clearances, g)
        set_pressures(films, work.grids, work.w, work.channel)


def _join(films, work, clearances, force, follows_x, follows_y):  # type: ignore[no-untyped-def]
    """join_films of films with cells."""
    if films.feed_holes.shape[0] > 0:
        join(films, work, clearances, follows_x, follows_y, force)


def _follow(films, work, correction, share):  # type: ignore[no-untyped-def]
    """follow_channels of films with cells."""
    if films.feed_holes.shape[0] > 0:
        follow_journals(films, work.answers, correction, share, work.changes)


def _move(films, work, f, u_x, u_y, g):  # type: ignore[no-untyped-def]
    """move_film of films with cells."""
    unsettled = move_cells(
        films.ring[f], films.cells[f], work.w[f], work.states[f], work.fields[f], work.grids[f], u_x, u_y, g,
        work.changes[f],
    )  # fmt: skip
    if films.films[f].remembers and work.grids[f].balance == AHEAD:
        s = work.grids[f].stage
        store_ahead(
            films.ring[f], films.cells[f], work, f, u_x, u_y, g, work.stage_oil[s, f], work.stage_flows[s, f]
        )
    return unsettled


def _sheared(films, work, f, d_x, d_y, factor):  # type: ignore[no-untyped-def]
    """drag_integral of films with cells."""
    return sheared(
        films.films[f], films.ring[f], films.cells[f], work.states[f], work.grids[f].x, work.grids[f].y, factor
    )


by_kind(
    meet_films, others=lambda films, work, x_0, u, omega, clearances, g, iteration: None, cells=_meet,
    tilted=lambda films, work, x_0, u, omega, clearances, g, iteration: meet_ends(work, x_0, u, omega, clearances, g),
)  # fmt: skip
by_kind(
    join_films,
    others=lambda films, work, clearances, force, follows_x, follows_y: None,
    cells=_join,
    tilted=lambda films, work, clearances, force, follows_x, follows_y: join_ends(work, clearances),
)
by_kind(follow_channels, others=lambda films, work, correction, share: None, cells=_follow)
by_kind(
    left_over,
    inline=True,
    others=lambda films, work, smooth, moved: smooth,
    cells=lambda films, work, smooth, moved: left_of_cells(work.grids, smooth, moved),
    tilted=lambda films, work, smooth, moved: left_of_cells(work.grids, smooth, moved),
)
by_kind(
    move_film,
    inline=True,
    others=lambda films, work, f, u_x, u_y, g: 0,
    cells=_move,
    tilted=lambda films, work, f, u_x, u_y, g: move_end(films, work, f, u_x, u_y, g),
)
by_kind(
    drag_integral,
    inline=True,
    # of 1 / H over the turn, Sommerfeld's integral
    others=lambda films, work, f, d_x, d_y, factor: 2.0 * math.pi / math.sqrt(max(1.0 - d_x * d_x - d_y * d_y, 1e-6)),
    cells=_sheared,
    tilted=lambda films, work, f, d_x, d_y, factor: tilted_sheared(films, work, f, factor),
)
by_kind(solved, inline=True, others=lambda films, count: count, tilted=lambda films, count: count // ENDS)
