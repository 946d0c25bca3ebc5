"""Films with cells in one stage of the time loop, one film at a time, compiled.

A Newton step of the film with what it does per journal velocity as further right-hand sides leaves 2 x 2 equations for
the journal; the journal's correction then moves the film (Schur's complement: the coupling is monolithic).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import EMPTY
from frbcli.film.cavitation.law import ABOVE_KINK
from frbcli.film.cells.balance.balances import balances
from frbcli.film.cells.balance.ends import CHANNELS_NET, CREATED, ENDS_NET, SUPPLY_NET
from frbcli.film.cells.balance.faces import film_loads
from frbcli.film.cells.balance.newton_step import damp, imbalance, store_rates
from frbcli.film.cells.balance.states import (
    FRACTION,
    FRACTION_SLOPE,
    PRESSURE_SLOPE,
    cell_states,
    find_resting,
    follow_law,
    hold,
    rests,
)
from frbcli.film.cells.block_cyclic import solve_ring_at
from frbcli.film.cells.channels import ask_of_channels, exchange
from frbcli.film.cells.data import (
    ALL_SIDES,
    AREA,
    BY_ITSELF,
    COS,
    GAP,
    MIDDLES,
    SHEARED,
    SIDES,
    SIN,
    UNKNOWN,
    GridMotion,
    Records,
    VolumeFilms,
    gap_along,
    level,
)
from frbcli.film.cells.gas.carry import store_gas_rates, take_gas_along
from frbcli.film.roughness.contact import stress_factor
from frbcli.solve.films.cell_steps import follow_filling, oil_fraction
from frbcli.solve.stage.equations import FilmMotion

# The cells balance as they are, and follow the journal by older derivatives, or by current ones; or they will balance
# after the correction that is under way; or they are to be asked again.
HELD, SOLVED, AHEAD, OPEN = range(4)
KEPT = 0.2  # of what a smooth force would leave of an error: a hundredth was seen, of films of all laws
SLOW = 0.2  # RATIO above which a film that balances is linearised anew: its journal does not settle
# By which a correction reduces what does not balance: 20 to 100 in most, 4 where many fronts cross cells. A film that
# remembers carries the rest on.
NEWTON_GAINS, GAINS_CARRIED = 5.0, 10.0
# The largest counts by these: what is left of a cell's balance is carried on by a film that remembers.
CELL_SHARE, LOOSE_SHARE = 0.03, 0.01
PLAIN, DAMPING = 5, 0.5  # iterations without damping; how it goes on from one to the next
SLOWEST = 1.0  # 1/s: a film that is driven more slowly has a negligible pressure
NO_FACTOR, GLOBAL_FACTOR, LOCAL_FACTOR, SIMPLE_FACTOR = range(4)


@compiled()
def _stray_gas(films: Any, work: Any, n: int, motion: GridMotion, law: Array, drop: float) -> float:
    """The states of field n with the free gas that its flows take along; what it was off by, over all gas."""
    film, ring, places, cells, states = films.films[n], films.ring[n], films.places[n], films.cells[n], work.states[n]
    stray = take_gas_along(film, ring, places, cells, states, motion, work.gas_past[n], work.gas_paths[n])
    cell_states(film, cells, law, drop, work.w[n], states)
    return float(stray / film.gas_content)


@compiled()
def _store_stage(films: Any, work: Any, n: int, s: int, motion: GridMotion, flows: Array) -> None:
    """The rates of oil and gas of field n, whose balances hold in stage s, see store_rates and store_gas_rates."""
    film, states, cells = films.films[n], work.states[n], films.cells[n]
    past, fields, rates = work.past[n], work.fields[n], work.stage_oil[s, n]
    store_rates(films.ring[n], films.places[n], cells, states, motion, past, fields, rates)
    if film.carries_gas:
        store_gas_rates(film, cells, states, work.gas_paths[n], work.stage_gas[s, n], flows)


@compiled()
def solve_cells(
    films: Any, work: Any, n: int, grid: np.record, motion: GridMotion, s: int, iteration: int, pace: float
) -> None:
    """A step of Newton's method of field n in stage s: its changes in work.fields, grid.balance, and its loads with
    their derivatives, which are older ones of a field that is held. pace: at which the gap changes, 1/s."""
    film, ring, places, cells = films.films[n], films.ring[n], films.places[n], films.cells[n]
    w, states, fields, stencil, flows = work.w[n], work.states[n], work.fields[n], work.stencil, work.stage_flows[s, n]
    (m, k), sides, remembers = w.shape, ALL_SIDES if motion.by_ends else SIDES, film.remembers
    drop, slots, left = film.centrifugal * grid.speed * grid.speed, fields.shape[2] - k - sides, 0.0
    grid.stage = s
    for weighing in range(2):
        cell_states(film, cells, grid.law, drop, w, states)
        if iteration == 0:
            hold(states, motion.omega)
        find_resting(film, cells, states, motion.omega == 0.0 and slots == 0 and not motion.by_ends, fields)
        stray = _stray_gas(films, work, n, motion, grid.law, drop) if film.carries_gas else 0.0
        balances(film, ring, places, cells, states, motion, work.past[n], stencil, fields, flows)
        if slots > 0:
            exchange(cells, states, work.channel[n], stencil, fields, flows)
        mean, largest = imbalance(cells, fields)
        left = max(mean, (CELL_SHARE if remembers else LOOSE_SHARE) * largest) / (film.settled * pace)
        left = max(left, stray / film.settled)
        if weighing == 1 or left >= 1.0 or film.given == 0.0:
            break
        if not follow_filling(film, grid, flows, motion.g, film.settled * pace):
            break
    balanced = left < 1.0
    if balanced and remembers:
        _store_stage(films, work, n, s, motion, flows)
    if balanced and iteration > 0 and grid.ratio < SLOW:
        grid.balance = HELD
        for i in range(m):  # the journal takes the film along as it did before, which the first layers keep
            for j in range(k):
                fields[i, j, k + BY_ITSELF] = 0.0
                fields[i, j, k + 1], fields[i, j, k + 2] = fields[i, j, 0], fields[i, j, 1]
                if motion.by_ends:
                    fields[i, j, k + 3], fields[i, j, k + 4] = fields[i, j, 2], fields[i, j, 3]
        film_loads(film, ring, places, cells, states, fields, work.push, work.loads[n], work.unused)
        return
    # Films that share oil have to balance as they are: what passes between them is known for that alone. So is gas, and
    # what openings take that give way.
    alone = iteration < PLAIN and slots == 0 and not film.carries_gas
    alone = alone and (film.given == 0.0 or grid.filling == 1.0)
    soon = left < (GAINS_CARRIED if remembers else NEWTON_GAINS) and alone
    grid.balance = SOLVED if balanced else AHEAD if soon else OPEN
    if iteration >= PLAIN:  # kinks make plain steps go to and fro: w is kept back, less and less
        damp(cells, pace * DAMPING ** (iteration - PLAIN), stencil)
    if slots > 0:
        ask_of_channels(cells, fields)
    solve_ring_at(film.solver_at, stencil, work.blocks, fields)
    for i in range(m):
        for j in range(0 if rests(states, i) else k):
            fields[i, j, 0], fields[i, j, 1] = fields[i, j, k + 1], fields[i, j, k + 2]
            if motion.by_ends:
                fields[i, j, 2], fields[i, j, 3] = fields[i, j, k + 3], fields[i, j, k + 4]
    film_loads(film, ring, places, cells, states, fields, work.push, work.loads[n], work.slopes[n])


@compiled(inline=True)
def turned_back(
    cosine: float, sine: float, f_x: float, f_y: float, xx: float, xy: float, yx: float, yy: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """The response of a film in whose grid's directions a force and its slopes, B, are: with Q^T B Q."""
    a, b, p, q = cosine * xx - sine * yx, cosine * xy - sine * yy, sine * xx + cosine * yx, sine * xy + cosine * yy
    return (
        cosine * f_x - sine * f_y,
        sine * f_x + cosine * f_y,
        0.0,
        0.0,
        0.0,
        0.0,
        a * cosine - b * sine,
        a * sine + b * cosine,
        p * cosine - q * sine,
        p * sine + q * cosine,
    )


@compiled()
def cell_response(
    films: VolumeFilms, work: Any, f: int, motion: FilmMotion, g: float, s: int, iteration: int
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """The response, see film_response of forces.py, of a film with cells."""
    film, grid, loads, slopes = films.films[f], work.grids[f], work.loads[f], work.slopes[f]
    d_x, d_y, v_x, v_y, omega = motion
    turn, spin = grid.turn, grid.speed
    cosine, sine = math.cos(turn), math.sin(turn)
    grid.x, grid.y = cosine * d_x + sine * d_y, cosine * d_y - sine * d_x
    against_x, against_y = v_x + spin * d_y, v_y - spin * d_x
    v_f, v_g = cosine * against_x + sine * against_y, cosine * against_y - sine * against_x
    if iteration == 0:  # what the law follows stays as it is at the guess: its derivatives are left out
        follow_law(film, d_x, d_y, v_x, v_y, omega, grid.law)
    pace = 0.5 * abs(omega - 2.0 * spin) + math.sqrt(v_f * v_f + v_g * v_g) + SLOWEST
    against = level(grid.x, grid.y, omega - 2.0 * spin, v_f, v_g, spin, g, 1.0 / g if film.remembers else 0.0)
    solve_cells(films, work, f, grid, against, s, iteration, pace)
    return turned_back(
        cosine, sine, loads[0], loads[1], slopes[0, 0], slopes[0, 1], slopes[1, 0], slopes[1, 1]
    )  # fmt: skip


@compiled(inline=True)
def held_at_kinks(before: float, after: float, empty: float, pressure_slope: float) -> float:
    """The unknown of a cell after a correction, kept from leaping over the kinks of its law.

    Of a small gap in a short step the oil counts far more than its flow, and a cell's oil is an S over w: steep between
    empty and full, flat on both sides. From one flat side Newton's method would leap to the other and back for ever; a
    cell that leaps over all of the steep part stops in its middle, from where it gets to its end directly.

    In a cavity at p_cav w is a source or missing oil, and its size says nothing of a pressure: a cell that becomes full
    begins with p_cav, as its neighbours and the forces take it. Else a spurious peak of the pressure opens a free end.
    """
    if max(before, after) > 0.0 and min(before, after) < empty:
        after = 0.5 * empty
    return ABOVE_KINK if after > 0.0 and pressure_slope == 0.0 else after


@compiled(inline=True)
def _step_of(fields: Array, i: int, j: int, moves: GridMotion, changes: Array) -> float:
    """By how much the unknown of a cell changes with a correction of the velocities, see move_cells."""
    first = fields.shape[1]
    step = fields[i, j, first + BY_ITSELF] + moves.d_x * fields[i, j, first + 1] + moves.d_y * fields[i, j, first + 2]
    if moves.by_ends:
        far_x, far_y = moves.d_x + moves.more_x, moves.d_y + moves.more_y
        step += far_x * fields[i, j, first + 3] + far_y * fields[i, j, first + 4]
    for slot in range(changes.shape[0]):
        step += fields[i, j, first + SIDES + slot] * changes[slot]
    return float(step)


@compiled()
def move_cells(
    films: Any, work: Any, n: int, grid: np.record, at: GridMotion, moves: GridMotion, changes: Array
) -> int:
    """The unknowns of field n follow a correction of the velocities that the film feels, the displacements of `moves`,
    and corrections of its channels' pressures, changes (slots,); 1 if the film is to be asked again. at: how the film
    was linearised. Columns that rest follow the gap. The rates are stored, too, if the film will balance then."""
    ring, places, cells = films.ring[n], films.places[n], films.cells[n]
    w, states, fields, empty = work.w[n], work.states[n], work.fields[n], grid.law[EMPTY]
    if films.films[n].remembers and grid.balance == AHEAD:
        s = grid.stage
        _store_ahead(ring, places, cells, states, fields, at, moves, work.past[n], work.stage_oil[s, n],
                     work.stage_flows[s, n])  # fmt: skip
    m, k = w.shape
    for i in range(m):
        if rests(states, i):
            near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], at)
            opens, rises = gap_along(0.0, ring[SIN, i], ring[COS, i], moves)
            for j in range(k):
                z, before = places[MIDDLES, j], w[i, j]
                lacks = fields[i, j, k + BY_ITSELF] / cells[AREA, i, j] - states[FRACTION, i, j] * (opens + z * rises)
                w[i, j] += at.g / (near + z * rise) * lacks / states[FRACTION_SLOPE, i, j]
                w[i, j] = held_at_kinks(before, w[i, j], empty, 0.0)
            continue
        for j in range(k):
            moved = w[i, j] + _step_of(fields, i, j, moves, changes)
            w[i, j] = held_at_kinks(w[i, j], moved, empty, states[PRESSURE_SLOPE, i, j])
    return 1 if grid.balance == OPEN else 0


@compiled()
def move_even(films: VolumeFilms, work: Any, f: int, u_x: float, u_y: float, g: float) -> int:
    """move_film of forces.py for a film whose journal does not tilt."""
    grid = work.grids[f]
    c, s = math.cos(grid.turn), math.sin(grid.turn)
    x, y = c * u_x + s * u_y, c * u_y - s * u_x
    at, moves = level(grid.x, grid.y, 0.0, 0.0, 0.0, 0.0, g, 0.0), level(x, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    unsettled = move_cells(films, work, f, grid, at, moves, work.changes[f])
    grid.x += g * x
    grid.y += g * y
    return unsettled


@compiled()
def _store_ahead(
    ring: Array, places: Array, cells: Array, states: Array, fields: Array, at: GridMotion, moves: GridMotion,
    past: Array, rates: Array, flows: Array,
) -> None:  # fmt: skip
    """Store the rates, see store_rates, of a field that will balance after a correction, by its linear equations.

    Cells pass as much to each other as the neighbours take, so that no oil is lost. What the ends pass follows from
    what all cells gain; it contains the small change of the flow through openings.
    """
    (m, k), g, gained = rates.shape, at.g, 0.0
    for i in range(m):
        near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], at)
        opens, rises = gap_along(0.0, ring[SIN, i], ring[COS, i], moves)
        for j in range(k):
            rates[i, j], z, theta = 0.0, places[MIDDLES, j], states[FRACTION, i, j]
            if cells[UNKNOWN, i, j] != 0.0 and not rests(states, i):
                change = states[FRACTION_SLOPE, i, j] * _step_of(fields, i, j, moves, fields[0, 0, :0])
                content = (near + z * rise) * (theta + change) + theta * (g * (opens + z * rises))
                rates[i, j] = content / g - past[i, j]
            gained += cells[AREA, i, j] * rates[i, j]
    flows[ENDS_NET] = flows[SUPPLY_NET] + flows[CHANNELS_NET] + flows[CREATED] - gained


@compiled()
def left_of_cells(grids: Records, smooth: float, moved: float) -> float:
    """Error of the journals that may be left after a correction by `moved`.

    Behind films that have all been linearised where they were, that is `smooth`, as without cells. One that balanced
    already has followed with older slopes: then corrections become smaller by the same ratio again and again.
    """
    left = KEPT * smooth
    for f in range(grids.shape[0]):
        held = grids[f].balance == HELD
        before = max(grids[f].moved if held else moved, 1e-300)
        grids[f].ratio = min((moved if held else smooth) / before, 1.0)
        grids[f].moved = moved
        if grids[f].balance == OPEN:
            left = math.inf
        elif held:
            left = max(left, moved * grids[f].ratio)
    return left


@compiled()
def sheared(films: Any, work: Any, n: int, at: GridMotion, factor: int) -> float:
    """drag_integral of forces.py for field n with the journal where it is."""
    if factor == SIMPLE_FACTOR:  # (4.6): of a plain film
        return 2.0 * math.pi / math.sqrt(max(1.0 - at.d_x * at.d_x - at.d_y * at.d_y, 1e-6))
    film, ring, places, cells, states = films.films[n], films.ring[n], films.places[n], films.cells[n], work.states[n]
    whole, weighed, per_gap, tilts = 0.0, 0.0, 0.0, at.more_x != 0.0 or at.more_y != 0.0
    for i in range(states.shape[1]):
        near, rise = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], at)
        for j in range(states.shape[2]):
            if j == 0 or tilts:
                h = max(near + places[MIDDLES, j] * rise, 1e-3)
                per_gap = stress_factor(h, film.roughness) / h
            whole += per_gap * cells[SHEARED, i, j]
            weighed += per_gap * cells[SHEARED, i, j] * states[FRACTION, i, j]
    if factor == LOCAL_FACTOR:
        return weighed
    return whole * oil_fraction(cells, states) if factor == GLOBAL_FACTOR else whole
