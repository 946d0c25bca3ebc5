"""Heat in the time loop, compiled. There are two kinds:

- NoHeat: every film keeps its viscosity and clearance, and nothing is computed;
- LumpedHeat: after each accepted step films, rings and walls take up what the films have dissipated in it. Each stage
  of the next one has viscosities and clearances at the temperatures that go on as they have changed in the last step.

Which of them a function means is decided by the type of the heat when the loop is compiled.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import by_types, compiled, type_of
from frbcli.solve.films.forces import drag_integral, keep_oil, leaving, oil_share, set_scale
from frbcli.solve.films.steps import CELLS, kind_of
from frbcli.solve.stage.equations import FORCE, OMEGA, X_0, U
from frbcli.solve.stage.forces import feel, rubbing
from frbcli.solve.state import OVERHEATED, RUNNING, SLIP, RotorData
from frbcli.thermal.exchange import (
    BOOKS,
    BY_FORMULA,
    CHANGES,
    CLEARANCE,
    CLEARANCE_BEFORE,
    DRAG,
    ETA,
    FLOW,
    FLOW_BEFORE,
    FORMULA,
    HOT,
    HOTTEST,
    LENGTH,
    POWER,
    POWER_BEFORE,
    REFERENCE,
    SCALE,
    SHARE,
    SHARE_OF_SUPPLY,
    VISCOSITY,
    HeatArrays,
    heat_step,
    viscosity_at,
    write_clearances,
)

COLUMNS = 5  # columns of a film in the output: temperature, viscosity, clearance, power, flow; then all other nodes
NARROWEST = 0.02  # of its reference: a clearance below this share has closed


class NoHeat(NamedTuple):
    """A machine that keeps its temperatures. now: empty."""

    now: Array


class LumpedHeat(NamedTuple):
    """model: see HeatArrays; ends: of each film its EndFlow, or CellEnds; state (BOOKS + bodies + n,): what a run
    carries on: books, speeds of rotor and rings, temperatures; last (CHANGES + n,): of its last step; ahead: a state
    in a stage of the next; now (FILM_ROWS, F); gain (n,)."""

    model: HeatArrays
    ends: Any
    state: Array
    last: Array
    ahead: Array
    now: Array
    gain: Array


NO_HEAT = NoHeat(np.zeros((0, 0)))


def have_heat(heat: Any) -> bool:
    """Whether the heat of a machine, or its type, is one that is computed."""
    return type_of(heat) is LumpedHeat


def columns_of(heat: Any) -> int:
    """Columns of heat in the output of a run."""
    return (COLUMNS - 1) * heat.now.shape[1] + heat.gain.shape[0] if isinstance(heat, LumpedHeat) else 0


def begin_heat(heat: Any, films: Any, rotor: RotorData, wet: Array) -> None:
    """Viscosities and clearances at the temperatures that the state has, before the loop goes on."""
    if isinstance(heat, LumpedHeat):
        follow_temperatures(heat, films, rotor.drag, rotor.clearances, wet)
        heat.now[CLEARANCE_BEFORE] = heat.now[CLEARANCE]


class AcceptedStep(NamedTuple):
    """The step that was taken: its length, g of its stages, the cavitation factor of Couette's torque, where contact
    begins, and Control.rough."""

    step: float
    g: float
    factor: int
    contact_at: float
    contact_stiffness: float
    rough: Any


@compiled()
def _warm(
    heat: LumpedHeat, films: Any, drag: Array, clearances: Array, wet: Any, bodies: Array, since: float
) -> None:  # fmt: skip
    """warm_stage of LumpedHeat: the temperatures go on as in the last step."""
    state, ahead, last, count = heat.state, heat.ahead, heat.last, bodies.shape[0]
    ratio = since / last[LENGTH] if last[LENGTH] > 0.0 else 0.0
    for b in range(count):
        ahead[BOOKS + b] = bodies[b]
    for i in range(heat.gain.shape[0]):
        ahead[BOOKS + count + i] = state[BOOKS + count + i] + ratio * last[CHANGES + i]
    _follow(heat, ahead, films, drag, clearances, wet, False)


@compiled()
def _carry(
    heat: LumpedHeat, films: Any, work: Any, turning: Array, journal: Array, bodies: Array, wet: Any,
    accepted: AcceptedStep, clearances: Array, drag: Array,
) -> int:  # fmt: skip
    """carry_heat of LumpedHeat: P = K slip^2 + (e x F) omega/2 - F . e', see docs/heat.md."""
    _, _, made, numbers, _ = heat.model
    ends, state, last, now, gain = heat.ends, heat.state, heat.last, heat.now, heat.gain
    step, g, factor, contact_at, contact_stiffness, rough = accepted
    count = clearances.shape[0]
    for b in range(bodies.shape[0]):
        state[BOOKS + b] = bodies[b]
    for f in range(count):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        v_x, v_y, total = journal[U, x], journal[U, y], journal[OMEGA, x]
        e_x, e_y = journal[X_0, x] + g * v_x, journal[X_0, y] + g * v_y
        slip = 0.0
        for b in range(bodies.shape[0]):
            slip += turning[f, SLIP, b] * bodies[b]
        d_x, d_y, r_x, r_y, _, _, _, _, _, _ = feel(e_x / c, e_y / c, v_x / c, v_y / c, contact_at, contact_stiffness)
        summits = rubbing(rough, f, c, g, journal)
        f_x, f_y = journal[FORCE, x] - summits.f_x, journal[FORCE, y] - summits.f_y
        moved = e_x * f_y - e_y * f_x
        now[POWER_BEFORE, f], now[FLOW_BEFORE, f] = now[POWER, f], now[FLOW, f]
        now[POWER, f] = drag[f] * drag_integral(films, work, f, d_x, d_y, factor) * slip * slip
        now[POWER, f] += 0.5 * moved * total - f_x * v_x - f_y * v_y + summits.power
        if numbers[BY_FORMULA] != 0.0:
            now[FLOW, f] = now[SHARE_OF_SUPPLY, f] * made[FORMULA, f] * c * c * c / now[ETA, f]
        else:
            scale = now[SCALE, f] / now[SHARE_OF_SUPPLY, f]
            now[FLOW, f] = c * leaving(ends, films, work, f, d_x, d_y, r_x, r_y, total, scale)
        now[SHARE, f] = oil_share(films, work, f)
        if last[LENGTH] == 0.0:  # nothing is known before the first step
            now[POWER_BEFORE, f], now[FLOW_BEFORE, f] = now[POWER, f], now[FLOW, f]
    first = BOOKS + bodies.shape[0]
    heat_step(heat.model, now, step, state[first:], heat.ahead[first:], last, gain, state)
    return int(_follow(heat, state, films, drag, clearances, wet, True))


@compiled(inline=True)
def _follow(
    heat: LumpedHeat, state: Array, films: Any, drag: Array, clearances: Array, wet: Any, ended: bool
) -> int:
    """Viscosities, clearances and what follows from them <- values at the temperatures of a state. ended: whether a
    step has ended; it conserves the volume of the oil in the films. Returns OVERHEATED, with the film in the books of
    the state, for one too hot or closed, else RUNNING."""
    capacity, _, made, numbers, growth = heat.model
    ends, now, count = heat.ends, heat.now, clearances.shape[0]
    bodies = state.shape[0] - BOOKS - capacity.shape[0]
    write_clearances(made, growth, bodies, state, now)
    for f in range(count):
        temperature, c, reference = state[BOOKS + bodies + f], now[CLEARANCE, f], made[REFERENCE, f]
        if not (temperature < numbers[HOTTEST] and c > NARROWEST * reference):
            state[HOT] = 1.0 + f
            return OVERHEATED
        thicker, narrower = viscosity_at(numbers, temperature) / made[VISCOSITY, f], reference / c
        now[ETA, f], now[SCALE, f] = thicker * made[VISCOSITY, f], thicker * narrower * narrower
        drag[f] = made[DRAG, f] * thicker * narrower
        if ended:
            keep_oil(films, wet, f, now[CLEARANCE_BEFORE, f] / c)
        clearances[f] = c
        set_scale(ends, films, f, now, reference)
    return RUNNING


@compiled()
def follow_temperatures(
    heat: LumpedHeat, films: Any, drag: Array, clearances: Array, wet: Array
) -> int:
    """_follow for the state of a run between two steps, for a call from Python."""
    return int(_follow(heat, heat.state, films, drag, clearances, wet, False))


@compiled()
def _write(
    numbers: Array, state: Array, change: Array, now: Array, out_heat: Array, first: int, last: int, until_end: float,
    every: float, step: float,
) -> None:  # fmt: skip
    """write_heat of LumpedHeat."""
    n, count = change.shape[0] - CHANGES, now.shape[1]
    begin = state.shape[0] - n
    for row in range(first, last):
        back = min((until_end + (last - 1 - row) * every) / step, 1.0)
        for i in range(n):
            temperature = state[begin + i] - back * change[CHANGES + i]
            if i >= count:
                out_heat[row, (COLUMNS - 1) * count + i] = temperature
                continue
            out_heat[row, COLUMNS * i], out_heat[row, COLUMNS * i + 1] = temperature, viscosity_at(numbers, temperature)
            for column, at in enumerate((CLEARANCE, POWER, FLOW)):
                before = (CLEARANCE_BEFORE, POWER_BEFORE, FLOW_BEFORE)[column]
                out_heat[row, COLUMNS * i + 2 + column] = now[at, i] + back * (now[before, i] - now[at, i])
    for f in range(count):
        now[CLEARANCE_BEFORE, f] = now[CLEARANCE, f]


def _warm_films(heat: Any, films: Any, *_: Any) -> Any:
    if not have_heat(heat):
        return None
    if kind_of(films) == CELLS:
        return lambda heat, films, drag, clearances, wet, bodies, since: _warm(
            heat, films, drag, clearances, wet, bodies, since
        )
    return lambda heat, films, drag, clearances, wet, bodies, since: _warm(heat, 0, drag, clearances, 0, bodies, since)


@by_types(_warm_films)
def warm_stage(
    heat: Any, films: Any, drag: Array, clearances: Array, wet: Array, bodies: Array, since: float
) -> None:  # fmt: skip
    """Viscosities and clearances <- values of a stage `since` s after the start of a step, in which rotor and rings
    have the speeds `bodies`."""


def _carry_films(heat: Any, films: Any, *_: Any) -> Any:
    if not have_heat(heat):
        return None
    if kind_of(films) == CELLS:
        return lambda heat, films, work, turning, journal, bodies, wet, accepted, clearances, drag: _carry(
            heat, films, work, turning, journal, bodies, wet, accepted, clearances, drag
        )
    # Only what tabulated films need is handed on: a call with the arrays of all films takes as long as their heat does.
    return lambda heat, films, work, turning, journal, bodies, wet, accepted, clearances, drag: _carry(
        heat, 0, 0, turning, journal, bodies, 0, accepted, clearances, drag
    )


@by_types(_carry_films)
def carry_heat(
    heat: Any, films: Any, work: Any, turning: Array, journal: Array, bodies: Array, wet: Array,
    accepted: AcceptedStep, clearances: Array, drag: Array,
) -> int:  # fmt: skip
    """Temperatures, viscosities and clearances move on after an accepted step. Returns RUNNING or OVERHEATED. journal:
    the rows of stage/equations.py in the last stage; bodies: its speeds of rotor and rings."""
    return RUNNING


def _write_numbers(heat, out_heat, first, last, until_end, every, step):  # type: ignore[no-untyped-def]
    _write(heat.model.numbers, heat.state, heat.last, heat.now, out_heat, first, last, until_end, every, step)


@by_types(lambda heat, *_: _write_numbers if have_heat(heat) else None)
def write_heat(heat: Any, out_heat: Array, first: int, last: int, until_end: float, every: float, step: float) -> None:
    """out_heat (rows, columns_of(heat)), rows from first up to last: temperatures and what the films do, linear
    over the step that was taken. until_end: time in s from the last row to the end of the step; every: from row to
    row."""
