"""Heat in the time loop, compiled. Two kinds ride in it:

- NoHeat: every film keeps its viscosity and clearance, and nothing is computed;
- LumpedHeat: after each accepted step films, rings and walls take up what the films have dissipated in it, and
  viscosities and clearances follow for the next one. Films settle in milliseconds, hundreds of steps, so that a
  viscosity changes by some 1e-5 from step to step.

Which of them a function means is decided by the type of the heat when the loop is compiled.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from frbcli.compiled import AS_KERNELS, Array, compiled
from frbcli.film.bearing_model.film import CLEARANCE as MODEL_CLEARANCE
from frbcli.film.bearing_model.film import VISCOSITY as MODEL_VISCOSITY
from frbcli.film.bearing_model.film import model_flow
from frbcli.film.cells.balance.side_flow import side_flow
from frbcli.film.cells.cell_ends import CellEnds
from frbcli.film.cells.data import (
    GIVEN_PRESSURE,
    VolumeFilms,
)
from frbcli.film.rectangles.end_flow import end_flow
from frbcli.film.state import OIL
from frbcli.solve.films.cell_steps import oil_fraction
from frbcli.solve.films.forces import drag_integral
from frbcli.solve.films.kinds import CELLS, MODELS, by_kind, kind_of
from frbcli.solve.stage.contact import feel
from frbcli.solve.stage.equations import FORCE, OMEGA, X_0, U
from frbcli.solve.stage.rough_contact import rubbing
from frbcli.solve.state import OVERHEATED, RUNNING, SLIP, RotorData
from frbcli.thermal.exchange import (
    BOOKS,
    BY_FORMULA,
    CLEARANCE,
    DRAG,
    ETA,
    FLOW,
    FORMULA,
    HOT,
    HOTTEST,
    POWER,
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

TOLD = 5  # columns of a film in the output: temperature, viscosity, clearance, power, flow; then all other nodes
NARROWEST = 0.02  # of its reference: a clearance below this share has closed


class NoHeat(NamedTuple):
    """A machine that keeps its temperatures. now: empty."""

    now: Array


class LumpedHeat(NamedTuple):
    """model: see HeatArrays; ends: of each film its EndFlow, or CellEnds; state (BOOKS + bodies + n,): what a run
    carries on: books, speeds of rotor and rings, temperatures; now (FILM_ROWS, F); gain (n,)."""

    model: HeatArrays
    ends: Any
    state: Array
    now: Array
    gain: Array


NO_HEAT = NoHeat(np.zeros((0, 0)))


def have_heat(heat: Any) -> bool:
    """Whether a type that the compiler knows is that of a machine with heat."""
    return getattr(heat, "instance_class", None) is LumpedHeat


def columns_of(heat: Any) -> int:
    """Columns of heat in the output of a run."""
    return (TOLD - 1) * heat.now.shape[1] + heat.gain.shape[0] if isinstance(heat, LumpedHeat) else 0


def begin_heat(heat: Any, films: Any, rotor: RotorData, wet: Array) -> None:
    """Viscosities and clearances at the temperatures that the state has, before the loop goes on."""
    if isinstance(heat, LumpedHeat):
        follow_temperatures(heat, films, rotor.drag, rotor.clearances, wet, False)


class Taken(NamedTuple):
    """The step that was taken: its length, g of its stages, the cavitation factor of Couette's torque, where contact
    begins, and Control.rough."""

    step: float
    g: float
    factor: int
    contact_at: float
    contact_stiffness: float
    rough: Any


def carry_heat(
    heat: Any, films: Any, work: Any, turning: Array, journal: Array, bodies: Array, wet: Array, taken: Taken,
    clearances: Array, drag: Array,
) -> int:  # fmt: skip
    """Temperatures, viscosities and clearances move on after an accepted step. Returns RUNNING or OVERHEATED. journal:
    the rows of stage/equations.py in the last stage; bodies: its speeds of rotor and rings."""
    raise NotImplementedError


def write_heat(heat: Any, out_heat: Array, first: int, last: int) -> None:
    """out_heat (rows, columns_of(heat)), rows from first up to last: temperatures and what the films do now."""
    raise NotImplementedError


@overload(carry_heat, jit_options=AS_KERNELS, inline="always")
def _carry_heat(heat, films, work, turning, journal, bodies, wet, taken, clearances, drag):  # type: ignore[no-untyped-def]
    if not have_heat(heat):
        return lambda heat, films, work, turning, journal, bodies, wet, taken, clearances, drag: RUNNING
    if kind_of(films) in (CELLS, MODELS):
        return lambda heat, films, work, turning, journal, bodies, wet, taken, clearances, drag: _carry(
            heat, films, work, turning, journal, bodies, wet, taken, clearances, drag
        )
    # Only what tabulated films need is handed on: a call with the arrays of all films takes as long as their heat does.
    return lambda heat, films, work, turning, journal, bodies, wet, taken, clearances, drag: _carry(
        heat, 0, 0, turning, journal, bodies, 0, taken, clearances, drag
    )


@overload(write_heat, jit_options=AS_KERNELS, inline="always")
def _write_heat(heat, out_heat, first, last):  # type: ignore[no-untyped-def]
    if not have_heat(heat):
        return lambda heat, out_heat, first, last: None
    return lambda heat, out_heat, first, last: _write(heat.state, heat.now, heat.gain, out_heat, first, last)


@compiled()
def _carry(
    heat: LumpedHeat, films: Any, work: Any, turning: Array, journal: Array, bodies: Array, wet: Any, taken: Taken,
    clearances: Array, drag: Array,
) -> int:  # fmt: skip
    """carry_heat of LumpedHeat: P = K slip^2 + (e x F) omega/2 - F . e', see docs/heat.md."""
    capacity, links, made, numbers, _ = heat.model
    ends, state, now, gain = heat.ends, heat.state, heat.now, heat.gain
    step, g, factor, contact_at, contact_stiffness, rough = taken
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
        now[POWER, f] = drag[f] * drag_integral(films, work, f, d_x, d_y, factor) * slip * slip
        now[POWER, f] += 0.5 * moved * total - f_x * v_x - f_y * v_y + summits.power
        if numbers[BY_FORMULA] != 0.0:
            now[FLOW, f] = now[SHARE_OF_SUPPLY, f] * made[FORMULA, f] * c * c * c / now[ETA, f]
        else:
            scale = now[SCALE, f] / now[SHARE_OF_SUPPLY, f]
            now[FLOW, f] = c * leaving(ends, films, work, f, d_x, d_y, r_x, r_y, total, scale)
        now[SHARE, f] = oil_share(films, work, f)
    heat_step(capacity, links, made, numbers, now, step, state[BOOKS + bodies.shape[0] :], gain, state)
    return int(_follow(heat, films, drag, clearances, wet, True))


@compiled(inline=True)
def _follow(
    heat: LumpedHeat, films: Any, drag: Array, clearances: Array, wet: Any, moved: bool
) -> int:
    """Viscosities, clearances and what follows from them <- those of the temperatures. moved: whether films keep the
    volume of their oil. Returns OVERHEATED, with the film in the books, for one too hot or closed, else RUNNING."""
    capacity, _, made, numbers, growth = heat.model
    ends, state, now, count = heat.ends, heat.state, heat.now, clearances.shape[0]
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
        if moved:
            keep_oil(films, wet, f, clearances[f] / c)
        clearances[f] = c
        set_scale(ends, films, f, now, reference)
    return RUNNING


@compiled()
def follow_temperatures(
    heat: LumpedHeat, films: Any, drag: Array, clearances: Array, wet: Array, moved: bool
) -> int:
    """_follow, for a call from Python."""
    return int(_follow(heat, films, drag, clearances, wet, moved))


@compiled()
def _write(state: Array, now: Array, gain: Array, out_heat: Array, first: int, last: int) -> None:
    """write_heat of LumpedHeat."""
    n, count = gain.shape[0], now.shape[1]
    begin = state.shape[0] - n
    for row in range(first, last):
        for f in range(count):
            out_heat[row, TOLD * f] = state[begin + f]
            out_heat[row, TOLD * f + 1], out_heat[row, TOLD * f + 2] = now[ETA, f], now[CLEARANCE, f]
            out_heat[row, TOLD * f + 3], out_heat[row, TOLD * f + 4] = now[POWER, f], now[FLOW, f]
        for i in range(count, n):
            out_heat[row, (TOLD - 1) * count + i] = state[begin + i]


def leaving(
    ends: Any, films: Any, work: Any, f: int, d_x: float, d_y: float, v_x: float, v_y: float, total: float,
    scale: float,
) -> float:  # fmt: skip
    """Flow through the ends of film f over its clearance, m^2/s, see end_flow; total: omega_J + omega_S."""
    raise NotImplementedError


def oil_share(films: Any, work: Any, f: int) -> float:
    """Share of the gap of film f that is oil."""
    raise NotImplementedError


def keep_oil(films: Any, wet: Any, f: int, narrower: float) -> None:
    """The oil of film f and its rate, over the clearance, times `narrower`: the clearance before over that now."""
    raise NotImplementedError


@compiled()
def _scale_oil(wet: Array, f: int, factor: float) -> None:
    """keep_oil of films on cells."""
    if factor != 1.0:
        for layer in range(OIL, wet.shape[0]):  # oil and gas with their rates
            for i in range(wet.shape[2]):
                for j in range(wet.shape[3]):
                    wet[layer, f, i, j] *= factor


def set_scale(ends: Any, films: Any, f: int, now: Array, reference: float) -> None:
    """Films on cells <- pressures and law of film f at its scale, bearing models <- viscosity and clearance; tabulated
    films are asked for scaled velocities."""
    raise NotImplementedError


@overload(leaving, jit_options=AS_KERNELS, inline="always")
def _leaving(ends, films, work, f, d_x, d_y, v_x, v_y, total, scale):  # type: ignore[no-untyped-def]
    if kind_of(films) == CELLS:
        return lambda ends, films, work, f, d_x, d_y, v_x, v_y, total, scale: (
            ends.units[f]
            * side_flow(
                films.films[f], films.ring[f], films.cells[f], work.states[f],
                work.grids[f].x, work.grids[f].y, ends.far_open[f] != 0,
            )
        )  # fmt: skip
    if kind_of(films) == MODELS:
        return lambda ends, films, work, f, d_x, d_y, v_x, v_y, total, scale: (
            model_flow(films[f], d_x, d_y, v_x, v_y, total) / films[f].parameters[MODEL_CLEARANCE]
        )
    return lambda ends, films, work, f, d_x, d_y, v_x, v_y, total, scale: _flow_of(
        ends, f, d_x, d_y, v_x + 0.5 * total * d_y, v_y - 0.5 * total * d_x, scale
    )


def _flow_of(ends: Any, f: int, d_x: float, d_y: float, w_x: float, w_y: float, scale: float) -> float:
    """end_flow of film f of those whose outflow follows from w."""
    raise NotImplementedError


@overload(_flow_of, jit_options=AS_KERNELS, inline="always")
def _flow_of_one(ends, f, d_x, d_y, w_x, w_y, scale):  # type: ignore[no-untyped-def]
    if isinstance(ends, types.UniTuple):
        return lambda ends, f, d_x, d_y, w_x, w_y, scale: end_flow(ends[f], d_x, d_y, w_x, w_y, scale)
    if len(ends) == 1:
        return lambda ends, f, d_x, d_y, w_x, w_y, scale: end_flow(ends[0], d_x, d_y, w_x, w_y, scale)

    def several(ends, f, d_x, d_y, w_x, w_y, scale):  # type: ignore[no-untyped-def]
        if f == 0:
            return end_flow(ends[0], d_x, d_y, w_x, w_y, scale)
        return _flow_of(ends[1:], f - 1, d_x, d_y, w_x, w_y, scale)

    return several


@compiled()
def _set_model(parameters: Array, now: Array, f: int) -> None:
    """set_scale of bearing models."""
    parameters[MODEL_VISCOSITY], parameters[MODEL_CLEARANCE] = now[ETA, f], now[CLEARANCE, f]


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


by_kind(
    keep_oil,
    inline=True,
    others=lambda films, wet, f, narrower: None,
    cells=lambda films, wet, f, narrower: _scale_oil(wet, f, narrower),
)
by_kind(
    oil_share,
    inline=True,
    others=lambda films, work, f: 1.0,
    cells=lambda films, work, f: oil_fraction(films.cells[f], work.states[f]),
)
by_kind(
    set_scale,
    inline=True,
    others=lambda ends, films, f, now, reference: None,
    models=lambda ends, films, f, now, reference: _set_model(films[f].parameters, now, f),
    cells=lambda ends, films, f, now, reference: _scale_cells(ends, films, f, now, reference),
)
