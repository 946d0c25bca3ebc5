"""The films in one iteration of a stage, compiled: forces, derivatives, and how they follow the journals.

As in films.py, the type of the films decides which kind is meant when the loop is compiled.

What heat asks of the films of the time loop, and what it makes of them: the oil that leaves them, their oil and
their scale. Compiled; as in steps.py, the type of the films decides which kind is meant.
"""

from __future__ import annotations

import math
from typing import Any

from frbcli.arrays import Array
from frbcli.compiled import by_types, compiled, of_several, type_of
from frbcli.film.cells.balance.ends import side_flow
from frbcli.film.cells.cavity_edge import CellEnds
from frbcli.film.cells.data import GIVEN_PRESSURE, OIL, VolumeFilms, level
from frbcli.film.rectangles.end_flow import end_flow
from frbcli.film.rectangles.film_force import film_force
from frbcli.solve.films.cell_steps import Work, oil_fraction
from frbcli.solve.films.cells import cell_response, left_of_cells, move_even, sheared
from frbcli.solve.films.steps import (
    CELLS,
    NONE,
    TILTED,
    Scaled,
    by_kind,
    follow_journals,
    join,
    kind_of,
    set_laws,
    set_pressures,
)
from frbcli.solve.films.tilted import ENDS, end_response, join_ends, meet_ends, move_end, tilted_sheared
from frbcli.solve.stage.equations import FilmMotion
from frbcli.thermal.exchange import CLEARANCE, ETA, SCALE

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


_flow_of = of_several(end_flow, inline=True)


def _leaving_cells(ends, films, work, f, d_x, d_y, v_x, v_y, total, scale):  # type: ignore[no-untyped-def]
    return ends.units[f] * side_flow(
        films.films[f], films.ring[f], films.places[f], films.cells[f], work.states[f],
        level(work.grids[f].x, work.grids[f].y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        ends.far_open[f] != 0,
    )  # fmt: skip


@by_kind(inline=True, cells=_leaving_cells)
def leaving(
    ends: Any, films: Any, work: Any, f: int, d_x: float, d_y: float, v_x: float, v_y: float, total: float,
    scale: float,
) -> Any:  # fmt: skip
    """Flow through the ends of film f over its clearance, m^2/s, see end_flow; total: omega_J + omega_S."""
    return _flow_of(ends, f, d_x, d_y, v_x + 0.5 * total * d_y, v_y - 0.5 * total * d_x, scale)


@by_kind(inline=True, cells=lambda films, work, f: oil_fraction(films.cells[f], work.states[f]))
def oil_share(films: Any, work: Any, f: int) -> float:
    """Share of the gap of film f that is oil."""
    return 1.0


@compiled()
def _scale_oil(wet: Array, f: int, factor: float) -> None:
    """keep_oil of finite-volume films."""
    if factor != 1.0:
        for layer in range(OIL, wet.shape[0]):  # oil and gas with their rates
            for i in range(wet.shape[2]):
                for j in range(wet.shape[3]):
                    wet[layer, f, i, j] *= factor


@by_kind(inline=True, cells=lambda films, wet, f, narrower: _scale_oil(wet, f, narrower))
def keep_oil(films: Any, wet: Any, f: int, narrower: float) -> None:
    """The oil of film f and its rate, over the clearance, times `narrower`: the clearance before over that now."""


@compiled()
def _scale_cells(ends: CellEnds, films: VolumeFilms, f: int, now: Array, reference: float) -> None:
    """Scaled pressures are those in Pa over 12 eta / psi^2: what is given in Pa falls with the scale, forces rise."""
    scale = now[SCALE, f]
    film, made = films.films[f], ends.films[f]
    film.scales.cavitation, film.scales.ambient = made.scales.cavitation / scale, made.scales.ambient / scale
    film.far.pressure, film.supply = made.far.pressure / scale, made.supply / scale
    film.centrifugal = made.centrifugal / scale
    film.force_scale, film.roughness = made.force_scale * scale, made.roughness * reference / now[CLEARANCE, f]
    film.given = made.given * reference / now[CLEARANCE, f]
    film.line = made.line * reference / now[CLEARANCE, f]
    for p in range(ends.exponents.shape[1]):
        if ends.exponents[f, p] != 0.0:
            film.parameters[p] = made.parameters[p] * scale ** ends.exponents[f, p]
    for i in range(films.cells.shape[2]):
        for j in range(films.cells.shape[3]):
            films.cells[f, GIVEN_PRESSURE, i, j] = ends.given[f, i, j] / scale
    for q in range(films.feed_holes.shape[0]):
        hole, at_first = films.feed_holes[q], ends.feed_holes[q]
        if hole.film == f:
            hole.pressure_scale = at_first.pressure_scale * scale
            hole.flow_scale = at_first.flow_scale * now[CLEARANCE, f] / reference
    for k in range(films.channels.shape[0]):  # filled with the oil of the outer film, or of a groove
        channel = films.channels[k]
        filled_from = channel.outer if channel.outer >= 0 else channel.inner
        if films.feed_holes[filled_from].film == f:
            channel.resistance = ends.resistance[k] * now[ETA, f]


@by_kind(inline=True, cells=lambda ends, films, f, now, reference: _scale_cells(ends, films, f, now, reference))
def set_scale(ends: Any, films: Any, f: int, now: Array, reference: float) -> None:
    """Finite-volume films <- pressures and law of film f at its scale; tabulated ones are asked for scaled
    velocities."""
