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
from frbcli.film.cells.balance.balances import CHANNELS_NET, CREATED, ENDS_NET, SUPPLY_NET, GridMotion, balances
from frbcli.film.cells.balance.newton_step import damp, film_loads, imbalance, store_rates
from frbcli.film.cells.balance.resting import find_resting, rests
from frbcli.film.cells.balance.states import FRACTION, FRACTION_SLOPE, PRESSURE_SLOPE, cell_states, follow_law, hold
from frbcli.film.cells.channels.flow import ask_of_channels, exchange
from frbcli.film.cells.data import (
    AREA,
    BY_ITSELF,
    BY_X,
    BY_Y,
    COS,
    GAP,
    SHEARED,
    SIDES,
    SIN,
    UNKNOWN,
    Records,
    VolumeFilms,
)
from frbcli.film.cells.elimination.block_cyclic import solve_ring_at
from frbcli.film.cells.film import ABOVE_KINK
from frbcli.film.cells.gas.carry import store_gas_rates, take_gas_along
from frbcli.film.roughness.rough_gap import stress_factor
from frbcli.solve.films.cell_steps import oil_fraction
from frbcli.solve.films.fillings import follow_filling
from frbcli.solve.stage.equations import FilmMotion

# Layers of fields: the elimination takes the first ones; then two of them keep what the journal's velocities did to the
# cells when the film was last linearised.
KEPT_BY_X, KEPT_BY_Y = range(2)
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
def stray_gas(
    film: np.record, ring: Array, width: Array, cells: Array, states: Array, motion: GridMotion, work: Any, f: int,
    drop: float, w: Array,
) -> float:  # fmt: skip
    """The states of film f at w with the free gas that its flows take along; what it was off by, over all gas."""
    stray = take_gas_along(film, ring, width, cells, states, motion, work.gas_past[f], work.gas_paths[f])
    cell_states(film, cells, work.grids[f].law, drop, w, states)
    return float(stray / film.gas_content)


@compiled()
def store_stage(film: np.record, ring: Array, cells: Array, work: Any, f: int, g: float, flows: Array) -> None:
    """The rates of oil and gas of film f, whose balances hold in this stage, see store_rates and store_gas_rates."""
    states, grid = work.states[f], work.grids[f]
    s = grid.stage
    store_rates(ring, cells, states, grid.x, grid.y, g, work.past[f], work.fields[f], work.stage_oil[s, f])
    if film.carries_gas:
        store_gas_rates(film, cells, states, work.gas_paths[f], work.stage_gas[s, f], flows)


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
    film, ring, width, cells = films.films[f], films.ring[f], films.width[f], films.cells[f]
    w, past, states, fields = work.w[f], work.past[f], work.states[f], work.fields[f]
    stencil, grid, slopes, flows = work.stencil, work.grids[f], work.slopes[f], work.stage_flows[s, f]
    d_x, d_y, v_x, v_y, omega = motion
    turn, spin, remembers, (m, k) = grid.turn, grid.speed, film.remembers, w.shape
    cosine, sine = math.cos(turn), math.sin(turn)
    x, y = cosine * d_x + sine * d_y, cosine * d_y - sine * d_x
    grid.stage, grid.x, grid.y = s, x, y
    against_x, against_y = v_x + spin * d_y, v_y - spin * d_x
    v_f, v_g = cosine * against_x + sine * against_y, cosine * against_y - sine * against_x
    if iteration == 0:  # what the law follows stays as it is at the guess: its derivatives are left out
        follow_law(film, d_x, d_y, v_x, v_y, omega, grid.law)
    drop, rate = film.centrifugal * spin * spin, 1.0 / g if remembers else 0.0
    pace = 0.5 * abs(omega - 2.0 * spin) + math.sqrt(v_f * v_f + v_g * v_g) + SLOWEST
    slots, left = fields.shape[2] - fields.shape[1] - SIDES, 0.0
    against = GridMotion(x, y, omega - 2.0 * spin, v_f, v_g, spin, g, rate)
    for weighing in range(2):
        cell_states(film, cells, grid.law, drop, w, states)
        if iteration == 0:
            hold(states, omega - 2.0 * spin)
        find_resting(film, cells, states, omega == 2.0 * spin and slots == 0, fields)
        stray = stray_gas(film, ring, width, cells, states, against, work, f, drop, w) if film.carries_gas else 0.0
        balances(film, ring, width, cells, states, against, past, stencil, fields, flows)
        if slots > 0:
            exchange(cells, states, work.channel[f], stencil, fields, flows)
        mean, largest = imbalance(cells, fields)
        left = max(mean, (CELL_SHARE if remembers else LOOSE_SHARE) * largest) / (film.settled * pace)
        left = max(left, stray / film.settled)
        if weighing == 1 or left >= 1.0 or film.given == 0.0:
            break
        if not follow_filling(film, grid, flows, g, film.settled * pace):
            break
    balanced = left < 1.0
    if balanced and remembers:
        store_stage(film, ring, cells, work, f, g, flows)
    if balanced and iteration > 0 and grid.ratio < SLOW:
        grid.balance = HELD
        for i in range(m):  # the journal takes the film along as it did before
            for j in range(k):
                fields[i, j, k + BY_ITSELF] = 0.0
                fields[i, j, k + BY_X], fields[i, j, k + BY_Y] = fields[i, j, KEPT_BY_X], fields[i, j, KEPT_BY_Y]
        f_x, f_y, _, _, _, _ = film_loads(film, ring, cells, states, fields)
    else:
        # Films that share oil have to balance as they are: what passes between them is known for that alone. So is gas,
        # and what openings take that give way.
        alone = iteration < PLAIN and slots == 0 and not film.carries_gas
        alone = alone and (film.given == 0.0 or grid.filling == 1.0)
        soon = left < (GAINS_CARRIED if remembers else NEWTON_GAINS) and alone
        grid.balance = SOLVED if balanced else AHEAD if soon else OPEN
        if iteration >= PLAIN:  # kinks make plain steps go to and fro: w is kept back, less and less
            damp(cells, pace * DAMPING ** (iteration - PLAIN), stencil)
        if slots > 0:
            ask_of_channels(cells, fields)
        solve_ring_at(film.solver_at, stencil, work.blocks, fields)
        f_x, f_y, slopes[0], slopes[1], slopes[2], slopes[3] = film_loads(film, ring, cells, states, fields)
        for i in range(m):
            for j in range(0 if rests(states, i) else k):
                fields[i, j, KEPT_BY_X], fields[i, j, KEPT_BY_Y] = fields[i, j, k + BY_X], fields[i, j, k + BY_Y]
    return turned_back(cosine, sine, f_x, f_y, slopes[0], slopes[1], slopes[2], slopes[3])


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


@compiled()
def move_cells(
    ring: Array, cells: Array, w: Array, states: Array, fields: Array, grid: np.record, u_x: float, u_y: float,
    g: float, changes: Array,
) -> int:  # fmt: skip
    """The unknowns w (m, k) follow a correction u of the velocity that the film feels and corrections of its channels'
    pressures, changes (slots,); 1 if the film is to be asked again. Columns that rest follow the gap."""
    m, k = w.shape
    empty = grid.law[EMPTY]
    c, s = math.cos(grid.turn), math.sin(grid.turn)
    x, y = c * u_x + s * u_y, c * u_y - s * u_x
    for i in range(m):
        if rests(states, i):
            per_gap = g / (ring[GAP, i] + grid.x * ring[SIN, i] - grid.y * ring[COS, i])
            grows = x * ring[SIN, i] - y * ring[COS, i]
            for j in range(k):
                before = w[i, j]
                lacks = fields[i, j, k + BY_ITSELF] / cells[AREA, i, j] - states[FRACTION, i, j] * grows
                w[i, j] += per_gap * lacks / states[FRACTION_SLOPE, i, j]
                w[i, j] = held_at_kinks(before, w[i, j], empty, 0.0)
            continue
        for j in range(k):
            before = w[i, j]
            w[i, j] += fields[i, j, k + BY_ITSELF] + x * fields[i, j, k + BY_X] + y * fields[i, j, k + BY_Y]
            for slot in range(changes.shape[0]):
                w[i, j] += fields[i, j, k + SIDES + slot] * changes[slot]
            w[i, j] = held_at_kinks(before, w[i, j], empty, states[PRESSURE_SLOPE, i, j])
    grid.x += g * x
    grid.y += g * y
    return 1 if grid.balance == OPEN else 0


@compiled()
def store_ahead(
    ring: Array, cells: Array, work: Any, f: int, u_x: float, u_y: float, g: float, rates: Array, flows: Array
) -> None:
    """Store the rates, see store_rates, of a film that will balance after move_cells, by its linear equations.

    Cells pass as much to each other as the neighbours take, so that no oil is lost. What the ends pass follows from
    what all cells gain; it contains the small change of the flow through openings.
    """
    m, k = rates.shape
    past, states, fields, grid = work.past[f], work.states[f], work.fields[f], work.grids[f]
    c, s = math.cos(grid.turn), math.sin(grid.turn)
    x, y = c * u_x + s * u_y, c * u_y - s * u_x
    d_x, d_y = grid.x - g * x, grid.y - g * y
    gained = 0.0
    for i in range(m):
        h = ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i]
        grows = g * (x * ring[SIN, i] - y * ring[COS, i])
        if rests(states, i):
            for j in range(k):
                rates[i, j] = 0.0
            continue
        for j in range(k):
            change = fields[i, j, k + BY_ITSELF] + x * fields[i, j, k + BY_X] + y * fields[i, j, k + BY_Y]
            theta = states[FRACTION, i, j]
            content = h * (theta + states[FRACTION_SLOPE, i, j] * change) + theta * grows
            rates[i, j] = content / g - past[i, j] if cells[UNKNOWN, i, j] != 0.0 else 0.0
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
def sheared(film: np.record, ring: Array, cells: Array, states: Array, d_x: float, d_y: float, factor: int) -> float:
    """drag_integral of forces.py for a film with cells."""
    if factor == SIMPLE_FACTOR:  # (4.6): of a plain film
        return 2.0 * math.pi / math.sqrt(max(1.0 - d_x * d_x - d_y * d_y, 1e-6))
    m, k = states.shape[1], states.shape[2]
    whole, weighed = 0.0, 0.0
    for i in range(m):
        h = max(ring[GAP, i] + d_x * ring[SIN, i] - d_y * ring[COS, i], 1e-3)
        per_gap = stress_factor(h, film.roughness) / h
        area, oil = 0.0, 0.0
        for j in range(k):
            area += cells[SHEARED, i, j]
            oil += cells[SHEARED, i, j] * states[FRACTION, i, j]
        whole += per_gap * area
        weighed += per_gap * oil
    if factor == LOCAL_FACTOR:
        return weighed
    return whole * oil_fraction(cells, states) if factor == GLOBAL_FACTOR else whole
