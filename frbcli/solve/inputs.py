"""Inputs over time in the time loop, compiled. There are two kinds:

- an empty tuple: a machine whose inputs stay as they are, for which nothing is computed;
- Inputs: each step has the pressures in its middle and the temperatures at its end.

With r times its gauge pressures a film has the pressures of the velocity w / r, r times as large: one table serves all
pressures of a supply, as one serves all viscosities. Finite-volume films are given their pressures.

Which of them a function means is decided by the type of the inputs when the loop is compiled, as in heat.py.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import Indices, by_types, compiled, compiled_for, type_of
from frbcli.film.cells.cavity_edge import CellEnds
from frbcli.film.cells.data import GIVEN_PRESSURE, VolumeFilms
from frbcli.solve.films.steps import by_kind
from frbcli.solve.heat import LumpedHeat, NoHeat, have_heat
from frbcli.solve.stage.forces import row_at
from frbcli.thermal.exchange import SCALE, SHARE_OF_SUPPLY, SUPPLY


class Inputs(NamedTuple):
    """k tables over time: first (k + 1,) row of each, and their number; times, values (rows,) of all.

    supplies, walls, pressures (.., 2): number of a table, and the film whose supply has this temperature in K, the node
    with this temperature, the film whose supply has this absolute pressure in Pa. ambient: Pa; least: share of a gauge
    pressure that counts as none; largest (F,): gauge pressures in Pa that the films were made with; shares (F,): of
    these now; scales (F,): by which the velocities of tabulated films are multiplied now; ends: finite-volume films as
    they were made, see Films.heat_ends. """

    first: Indices
    times: Array
    values: Array
    supplies: Indices
    walls: Indices
    pressures: Indices
    ambient: float
    least: float
    largest: Array
    shares: Array
    scales: Array
    ends: Any


@compiled()
def value_at(inputs: Inputs, table: int, t: float) -> float:
    """The value of a table at a time in s, linear between its rows."""
    row = row_at(inputs.times, inputs.first[table], inputs.first[table + 1], t)
    before, after = inputs.values[row], inputs.values[row + 1]
    since = (t - inputs.times[row]) / (inputs.times[row + 1] - inputs.times[row])
    return float(before + since * (after - before))


def _give(inputs, heat, t):  # type: ignore[no-untyped-def]
    for i in range(inputs.supplies.shape[0]):
        heat.model.films[SUPPLY, inputs.supplies[i, 1]] = value_at(inputs, inputs.supplies[i, 0], t)
    begin = heat.state.shape[0] - heat.gain.shape[0]
    for i in range(inputs.walls.shape[0]):
        heat.state[begin + inputs.walls[i, 1]] = value_at(inputs, inputs.walls[i, 0], t)


@by_types(lambda inputs, heat, t: _give if have_heat(heat) else None)
def give_temperatures(inputs: Inputs, heat: LumpedHeat | NoHeat, t: float) -> None:
    """The heat <- temperatures of supplies and walls at the time t in s."""


@compiled()
def _supply_cells(films: VolumeFilms, ends: CellEnds, f: int, share: float, scale: float) -> None:
    """supplied of finite-volume films."""
    films.films[f].far.pressure = ends.films[f].far.pressure * share / scale
    films.films[f].supply = ends.films[f].supply * share / scale
    for i in range(films.cells.shape[2]):
        for j in range(films.cells.shape[3]):
            films.cells[f, GIVEN_PRESSURE, i, j] = ends.given[f, i, j] * share / scale
    for k in range(films.channels.shape[0]):  # an outer film comes behind its inner one
        if films.feed_holes[films.channels[k].inner].film + 1 == f:
            films.channels[k].groove_pressure = ends.groove_pressure[k] * share


@by_kind(
    inline=True, cells=lambda films, ends, f, share, scale: _supply_cells(films, ends, f, share, scale)
)
def supplied(films: Any, ends: Any, f: int, share: float, scale: float) -> None:
    """Finite-volume films <- a share of the gauge pressures of film f; tabulated films are asked for scaled
    velocities."""


@compiled()
def _supply(inputs: Inputs, films: Any, heat: Any) -> None:
    now = heat.now
    for f in range(inputs.shares.shape[0] if inputs.pressures.shape[0] > 0 else 0):
        share, scale = inputs.shares[f], 1.0
        if now.shape[0] > 0:
            scale = now[SCALE, f]
            now[SHARE_OF_SUPPLY, f] = share
        inputs.scales[f] = scale / share
        supplied(films, inputs.ends, f, share, scale)


@compiled_for(Inputs)
def set_inputs(inputs: Inputs, films: Any, heat: Any, t: float, step: float) -> None:
    """Films and heat <- the inputs of a step from the time t in s on."""
    give_temperatures(inputs, heat, t + step)
    for i in range(inputs.pressures.shape[0]):
        f = inputs.pressures[i, 1]
        gauge = value_at(inputs, inputs.pressures[i, 0], t + 0.5 * step) - inputs.ambient
        inputs.shares[f] = max(gauge / inputs.largest[f], inputs.least)
    _supply(inputs, films, heat)


def _supply_at(inputs, films, heat):  # type: ignore[no-untyped-def]
    _supply(inputs, films, heat)


@by_types(lambda inputs, films, heat: _supply_at if type_of(inputs) is Inputs and have_heat(heat) else None)
def supply_warm(inputs: Any, films: Any, heat: Any) -> None:
    """Films <- the pressures of the step at the viscosities of a stage."""


