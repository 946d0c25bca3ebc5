"""Films whose journals tilt in one stage of the time loop, compiled.

The loop has the displacements of a journal at both ends of its bearing, as of two journals; both belong to one film,
which is solved when the first of them asks for its force. What the forces at one end change with the motion of the
other is left to work.cross. All else is as for other films with cells, see cells.py. """

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.states import follow_law
from frbcli.film.cells.data import ALL_SIDES, GridMotion, Records
from frbcli.film.cells.tilted_film import TiltedVolumes
from frbcli.solve.films.cell_steps import GRID, cell_arrays, oil_fraction
from frbcli.solve.films.cells import LOCAL_FACTOR, NO_FACTOR, SLOWEST, SOLVED, move_cells, sheared, solve_cells

ENDS = 2  # of a bearing, each of which the loop takes for a journal


class TiltedWork(NamedTuple):
    """Scratch of the time loop for F films of L lands: as Work in cell_steps.py, but of lands; grids (2 F,), of a film
    one after the other. places, rates, moves: (F, 4) coordinates of the journals in the directions of the grids, see
    tilted_film.py, their rates, and their last corrections; omega (F,); push (4, m, k), loads (L, 4), slopes (L, 4, 4),
    unused (4, 4), see film_loads; force (F, 4), by_rate (F, 4, 4) of films; cross (4 F, 4 F); channel and changes of no
    channels."""

    states: Array
    stencil: Array
    blocks: Array
    fields: Array
    w: Array
    first: Array
    past: Array
    stage_oil: Array
    stage_flows: Array
    gas_past: Array
    stage_gas: Array
    gas_paths: Array
    grids: Records
    cross: Array
    places: Array
    rates: Array
    moves: Array
    omega: Array
    push: Array
    loads: Array
    slopes: Array
    unused: Array
    force: Array
    by_rate: Array
    channel: Array
    changes: Array


def make_tilted_work(films: TiltedVolumes, wet: Array, stages: int) -> TiltedWork:
    """Scratch for films whose journals tilt, and their state wet (WET, L, m, k)."""
    _, lands, m, k = wet.shape
    count = len(films.first) - 1
    grids: Records = np.zeros(ENDS * count, GRID)
    grids["balance"] = SOLVED  # also of those that no land has
    return TiltedWork(
        *cell_arrays(wet, ALL_SIDES, stages),
        grids,
        np.zeros((4 * count, 4 * count)),
        np.zeros((count, 4)),
        np.zeros((count, 4)),
        np.zeros((count, 4)),
        np.zeros(count),
        np.zeros((4, m, k)),
        np.zeros((lands, 4)),
        np.zeros((lands, 4, 4)),
        np.zeros((4, 4)),
        np.zeros((count, 4)),
        np.zeros((count, 4, 4)),
        np.zeros((0, m, k)),
        np.zeros(0),
    )


@compiled()
def meet_ends(work: Any, x_0: Array, u: Array, omega: Array, clearances: Array, g: float) -> None:
    """meet_films of forces.py: how all journals stand and move, seen from the grids of their films."""
    for f in range(work.force.shape[0]):
        grid, c = work.grids[ENDS * f], clearances[ENDS * f]
        cosine, sine, spin = math.cos(grid.turn), math.sin(grid.turn), grid.speed
        work.omega[f] = omega[4 * f]
        for x in (0, 2):
            i, j = 4 * f + x, 4 * f + x + 1
            d_x, d_y, v_x, v_y = (x_0[i] + g * u[i]) / c, (x_0[j] + g * u[j]) / c, u[i] / c, u[j] / c
            v_x, v_y = v_x + spin * d_y, v_y - spin * d_x
            work.places[f, x], work.places[f, x + 1] = cosine * d_x + sine * d_y, cosine * d_y - sine * d_x
            work.rates[f, x], work.rates[f, x + 1] = cosine * v_x + sine * v_y, cosine * v_y - sine * v_x


@compiled(inline=True)
def _between(d: Array, v: Array, omega: float, g: float, rate: float) -> GridMotion:
    """The motion of a journal that tilts, from its coordinates (4,), see tilted_film.py, and their rates."""
    more_x, more_y, more_v_x, more_v_y = d[2] - d[0], d[3] - d[1], v[2] - v[0], v[3] - v[1]
    return GridMotion(d[0], d[1], omega, v[0], v[1], 0.0, g, rate, more_x, more_y, more_v_x, more_v_y, True)


@compiled()
def _pace(omega: float, v: Array) -> float:
    """How fast the gap changes, in 1/s, see cell_response."""
    fastest = max(v[0] * v[0] + v[1] * v[1], v[2] * v[2] + v[3] * v[3])
    return 0.5 * abs(omega) + math.sqrt(fastest) + SLOWEST


@compiled()
def _follow(film: np.record, d: Array, v: Array, omega: float, spin: float, law: Array) -> None:
    """law <- what the law is for the motion in the middle of the bearing, without the turning of the grid."""
    x, y = 0.5 * (d[0] + d[2]), 0.5 * (d[1] + d[3])
    follow_law(film, x, y, 0.5 * (v[0] + v[2]) - spin * y, 0.5 * (v[1] + v[3]) + spin * x, omega, law)


@compiled()
def _solve_land(films: TiltedVolumes, work: Any, land: int, f: int, g: float, s: int, iteration: int) -> None:
    """cell_response of cells.py: loads and slopes of a land of film f, in the directions of its grid."""
    film, d, v, grid = films.films[land], work.places[f], work.rates[f], work.grids[ENDS * f + land - films.first[f]]
    omega = work.omega[f] - 2.0 * grid.speed
    if iteration == 0:
        _follow(film, d, v, work.omega[f], grid.speed, grid.law)
    motion = _between(d, v, omega, g, 1.0 / g if film.remembers else 0.0)
    solve_cells(films, work, land, grid, motion, s, iteration, _pace(omega, v))


@compiled()
def _solve_film(films: TiltedVolumes, work: Any, f: int, g: float, s: int, iteration: int) -> None:
    """force and by_rate of film f, back from the directions of its grid."""
    force, by = work.force[f], work.by_rate[f]
    for a in range(4):
        force[a] = 0.0
        for b in range(4):
            by[a, b] = 0.0
    for land in range(films.first[f], films.first[f + 1]):
        _solve_land(films, work, land, f, g, s, iteration)
        for a in range(4):
            force[a] += work.loads[land, a]
            for b in range(4):
                by[a, b] += work.slopes[land, a, b]
    turn = work.grids[ENDS * f].turn
    c, sine = math.cos(turn), math.sin(turn)
    for a in (0, 2):
        force[a], force[a + 1] = c * force[a] - sine * force[a + 1], sine * force[a] + c * force[a + 1]
        for b in (0, 2):
            xx, xy, yx, yy = by[a, b], by[a, b + 1], by[a + 1, b], by[a + 1, b + 1]
            p, q, r, t = c * xx - sine * yx, c * xy - sine * yy, sine * xx + c * yx, sine * xy + c * yy
            by[a, b], by[a, b + 1] = p * c - q * sine, p * sine + q * c
            by[a + 1, b], by[a + 1, b + 1] = r * c - t * sine, r * sine + t * c


@compiled()
def end_response(
    films: TiltedVolumes, work: Any, end: int, g: float, s: int, iteration: int
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """The response, see film_response of forces.py, at one end of a bearing by the motion there."""
    f, x = end // ENDS, 2 * (end % ENDS)
    if x == 0:
        _solve_film(films, work, f, g, s, iteration)
    by = work.by_rate[f]
    return (
        work.force[f, x], work.force[f, x + 1], 0.0, 0.0, 0.0, 0.0,
        by[x, x], by[x, x + 1], by[x + 1, x], by[x + 1, x + 1],
    )  # fmt: skip


@compiled()
def join_ends(work: Any, clearances: Array) -> None:
    """join_films of forces.py: what the forces at one end change with the motion of the other."""
    for f in range(work.force.shape[0]):
        for a in range(2):
            for b in range(2, 4):
                x, y, c = 4 * f + a, 4 * f + b, clearances[ENDS * f]
                work.cross[x, y], work.cross[y, x] = work.by_rate[f, a, b] / c, work.by_rate[f, b, a] / c


@compiled()
def move_end(films: TiltedVolumes, work: Any, end: int, u_x: float, u_y: float, g: float) -> int:
    """move_film of forces.py: with the second end it is known how the film moves, and all its lands follow."""
    f, x = end // ENDS, 2 * (end % ENDS)
    turn, u, unsettled = work.grids[ENDS * f].turn, work.moves[f], 0
    c, s = math.cos(turn), math.sin(turn)
    u[x], u[x + 1] = c * u_x + s * u_y, c * u_y - s * u_x
    if x == 0:
        return 0
    at, moves = _between(work.places[f], u, 0.0, g, 0.0), _between(u, u, 0.0, 0.0, 0.0)
    for land in range(films.first[f], films.first[f + 1]):
        grid = work.grids[ENDS * f + land - films.first[f]]
        unsettled = max(unsettled, move_cells(films, work, land, grid, at, moves, work.changes))
    for a in range(4):
        work.places[f, a] += g * u[a]
    return unsettled


@compiled()
def tilted_sheared(films: TiltedVolumes, work: Any, end: int, factor: int) -> float:
    """drag_integral of forces.py, half of the bearing's for each end; oil that is missing counts where it is missing,
    or not at all."""
    f, mean = end // ENDS, 0.0
    lands, at = films.first[f + 1] - films.first[f], _between(work.places[f], work.places[f], 0.0, 0.0, 0.0)
    for land in range(films.first[f], films.first[f + 1]):
        mean += sheared(films, work, land, at, factor if factor == LOCAL_FACTOR else NO_FACTOR)
    return float(mean / (ENDS * lands))


@compiled()
def write_land_oil(films: TiltedVolumes, work: Any, out_oil: Array, first: int, last: int) -> None:
    """write_oil of steps.py."""
    for f in range(work.force.shape[0] if last > first else 0):
        oil, lands = 0.0, films.first[f + 1] - films.first[f]
        for land in range(films.first[f], films.first[f + 1]):
            oil += oil_fraction(films.cells[land], work.states[land]) / lands
        for row in range(first, last):
            out_oil[row, f] = oil
