"""The films in one iteration of a stage, compiled: forces, derivatives, and how they follow the journals.

As in films.py, the type of the films decides which kind is meant when the loop is compiled.
"""

from __future__ import annotations

import math
from typing import Any

from frbcli.arrays import Array
from frbcli.compiled import by_types, of_several, type_of
from frbcli.film.cells.tilted.motion import level
from frbcli.film.rectangles.film_force import film_force
from frbcli.solve.films.cell_steps import Work
from frbcli.solve.films.cells import cell_response, left_of_cells, move_even, sheared
from frbcli.solve.films.channels import follow_journals, join, set_laws, set_pressures
from frbcli.solve.films.kinds import CELLS, NONE, TILTED, by_kind, kind_of
from frbcli.solve.films.steps import Scaled
from frbcli.solve.films.tilted import ENDS, end_response, join_ends, meet_ends, move_end, tilted_sheared
from frbcli.solve.stage.equations import FilmMotion

_one_of = of_several(film_force, inline=True)  # one call less is a tenth of the time of a tabulated film


def _scaled(films, work, f, motion, g, s, iteration):  # type: ignore[no-untyped-def]
    """film_response of tabulated films with other scales of their pressures, which equals the force at other
    velocities, and with shares of these pressures."""
    scale, r = work.scales[f], work.shares[f]
    f_x, f_y, k_xx, k_xy, k_yx, k_yy, d_xx, d_xy, d_yx, d_yy = _one_of(
        films, f, motion.d_x, motion.d_y, scale * motion.v_x, scale * motion.v_y, scale * motion.omega
    )
    d_xx, d_xy, d_yx, d_yy = scale * d_xx, scale * d_xy, scale * d_yx, scale * d_yy
    return r * f_x, r * f_y, r * k_xx, r * k_xy, r * k_yx, r * k_yy, r * d_xx, r * d_xy, r * d_yx, r * d_yy


def _answer(films: Any, work: Any, *_: Any) -> Any:
    """How films respond that are not asked at the scale that they were made for."""
    kind = kind_of(films)
    if kind == NONE:  # never asked
        return lambda films, work, f, motion, g, s, iteration: (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if kind == TILTED:
        return lambda films, work, f, motion, g, s, iteration: end_response(films, work, f, g, s, iteration)
    if kind == CELLS:
        kernel: Any = cell_response  # itself, not called from here: what calls is optimised and compiled, too
        return kernel.py_func
    return _scaled if type_of(work) is Scaled else None


@by_types(_answer, inline=False, forceinline=True)
def film_response(films: Any, work: Work, f: int, motion: FilmMotion, g: float, s: int, iteration: int) -> Any:
    """The ten numbers of film_force for film f at what it feels of its journal; for cells the derivatives by the
    velocity contain all.

    A film whose balances hold already, but not in the first iteration of stage s, is settled: its rates are kept, and
    it only follows the journal. One that does not settle goes on with shorter steps.
    """
    return _one_of(films, f, motion.d_x, motion.d_y, motion.v_x, motion.v_y, motion.omega)


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
    return move_even(films, work, f, u_x, u_y, g)


def _sheared(films, work, f, d_x, d_y, factor):  # type: ignore[no-untyped-def]
    """drag_integral of films with cells."""
    return sheared(films, work, f, level(work.grids[f].x, work.grids[f].y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), factor)


@by_kind(
    cells=_meet,
    tilted=lambda films, work, x_0, u, omega, clearances, g, iteration: meet_ends(work, x_0, u, omega, clearances, g),
)
def meet_films(
    films: Any, work: Work, x_0: Array, u: Array, omega: Array, clearances: Array, g: float, iteration: int
) -> None:
    """Before the films are asked in an iteration: the pressures of the coupled channels, by the films as they are; how
    both ends of a journal that tilts move.

    x_0, u, omega: (2 films,), see the rows of equations.py."""


@by_kind(
    cells=_join, tilted=lambda films, work, clearances, force, follows_x, follows_y: join_ends(work, clearances)
)
def join_films(
    films: Any, work: Work, clearances: Array, force: Array, follows_x: Array, follows_y: Array
) -> None:
    """After all films have been asked: what coupled channels make of their forces (2 films,), and work.cross, also of
    both ends of a bearing.

    follows_x, follows_y: (2 films,), see the rows of equations.py."""


@by_kind(cells=_follow)
def follow_channels(films: Any, work: Work, correction: Array, share: float) -> None:
    """Before the films are moved: the coupled channels follow a share of the correction of the journals' velocities."""


@by_kind(
    inline=True,
    cells=_move,
    tilted=lambda films, work, f, u_x, u_y, g: move_end(films, work, f, u_x, u_y, g),
)
def move_film(films: Any, work: Work, f: int, u_x: float, u_y: float, g: float) -> int:
    """Take the film along with a correction u of the velocity that it feels, over the clearance; 1 if not settled."""
    return 0


def _left(films, work, smooth, moved):  # type: ignore[no-untyped-def]
    """left_over of films with cells."""
    return left_of_cells(work.grids, smooth, moved)


@by_kind(inline=True, cells=_left, tilted=_left)
def left_over(films: Any, work: Work, smooth: float, moved: float) -> float:
    """Error of the journals that may be left after a correction by `moved`: `smooth` for forces without kinks, infinite
    as long as films are unsettled."""
    return smooth


@by_kind(inline=True, tilted=lambda films, count: count // ENDS)
def solved(films: Any, count: int) -> int:
    """Films that are solved when the loop has asked `count` times for a force."""
    return count


@by_kind(
    inline=True,
    cells=_sheared,
    tilted=lambda films, work, f, d_x, d_y, factor: tilted_sheared(films, work, f, factor),
)
def drag_integral(films: Any, work: Work, f: int, d_x: float, d_y: float, factor: int) -> float:
    """The integral of 1 / H over the turn, mean over the width, with the cavitation factor where the film knows one:
    Sommerfeld's integral where it has no cells."""
    return 2.0 * math.pi / math.sqrt(max(1.0 - d_x * d_x - d_y * d_y, 1e-6))
