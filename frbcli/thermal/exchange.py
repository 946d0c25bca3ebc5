"""The balance of heat in a time step, compiled; rates and clearances as in model.py, which tests hold them to."""

from __future__ import annotations

import math

from frbcli.compiled import Array, compiled
from frbcli.thermal.model import AT_ZERO, SLOPE, HeatModel

ETA_0, A, C = range(3)  # of Vogel's law (3.12)
# What a run has gone through so far, in J: dissipated by the films, carried away by the oil, taken by nodes of given
# temperature, kept by the films; and 1 + the film that became too hot, 0 if none.
DISSIPATED, CARRIED, GIVEN, IN_FILMS, HOT, BOOKS = range(6)
# Rows of what a film is now: power W, flow m^3/s, viscosity Pa s, clearance m, scale of its pressures over that of its
# table, share of its gap that is oil.
POWER, FLOW, ETA, CLEARANCE, SCALE, SHARE, FILM_ROWS = range(7)
LONGEST = 0.2  # of a time constant: explicit steps between nodes


@compiled(inline=True)
def viscosity_at(law: Array, temperature: float) -> float:
    """Vogel's law (3.12), Pa s."""
    return float(law[ETA_0]) * math.exp(float(law[A]) / (temperature + float(law[C])))


@compiled(inline=True)
def write_clearances(model: HeatModel, temperatures: Array, speeds: Array, clearances: Array) -> None:
    """clearances (F,) <- (4.24) with the temperatures (n,) in K, and the growth of bodies with the speeds in rad/s."""
    for f in range(clearances.shape[0]):
        total = model.clearance[f]
        for i in range(temperatures.shape[0]):
            total += model.expansion[f, i] * temperatures[i]
        for b in range(speeds.shape[0]):
            total += model.growth[f, b] * speeds[b] * speeds[b]
        clearances[f] = total


@compiled(inline=True)
def write_rates(
    model: HeatModel, temperatures: Array, power: Array, flow: Array, clearances: Array, gain: Array
) -> tuple[float, float]:
    """gain (n,) <- W that each node gains. power, flow: (F,) W and m^3/s; clearances (F,) m.

    Returns what the oil carries away and what nodes of given temperature take, W.
    """
    films, carried, given = power.shape[0], 0.0, 0.0
    for i in range(gain.shape[0]):
        gain[i] = power[i] if i < films else 0.0
    for f in range(films):
        source = model.inlet[f]
        at = temperatures[source] if source >= 0 else model.supply[f]
        rise = temperatures[f] - at
        heat = (model.oil_heat[AT_ZERO] + model.oil_heat[SLOPE] * (at + 0.5 * rise / model.mixing)) * flow[f]
        gain[f] -= heat * rise / model.mixing
        carried += heat * rise / model.mixing
        if source >= 0:  # this oil has come through the film that feeds this one
            warmer = temperatures[source] - model.supply[source]
            gain[source] -= heat * warmer
            carried += heat * warmer
    for k in range(model.links.shape[0]):
        i, j = model.links[k, 0], model.links[k, 1]
        film = model.of_film[k]
        narrowed = model.reference[film] / clearances[film] if film >= 0 else 1.0
        passed = model.conductance[k] * narrowed * (temperatures[i] - temperatures[j])
        gain[i] -= passed
        gain[j] += passed
    for i in range(gain.shape[0]):
        if model.capacity[i] == math.inf:
            given += gain[i]
    return carried, given


@compiled(inline=True)
def fastest(model: HeatModel, now: Array) -> float:
    """An upper bound of the rates at which nodes follow each other, 1/s. now: (FILM_ROWS, F)."""
    largest, films = 0.0, now.shape[1]
    for i in range(model.capacity.shape[0]):
        total = 0.0
        for k in range(model.links.shape[0]):
            if model.links[k, 0] == i or model.links[k, 1] == i:
                f = model.of_film[k]
                total += model.conductance[k] * (model.reference[f] / now[CLEARANCE, f] if f >= 0 else 1.0)
        share = 1.0
        if i < films:
            total += (model.oil_heat[AT_ZERO] + model.oil_heat[SLOPE] * model.hottest) * now[FLOW, i] / model.mixing
            share = held_share(model, now, i)
        largest = max(largest, total / (share * model.capacity[i]))
    return largest


@compiled(inline=True)
def held_share(model: HeatModel, now: Array, f: int) -> float:
    """Oil in a film over that of its full gap at the reference clearance."""
    return float(max(now[SHARE, f], 1e-3) * now[CLEARANCE, f] / model.reference[f])


@compiled(inline=True)
def heat_step(model: HeatModel, now: Array, step: float, temperatures: Array, gain: Array, books: Array) -> None:
    """temperatures (n,) <- after a step in s in which the films dissipate and let out what `now` says; books (BOOKS,)
    add up where the heat goes. gain: (n,) scratch.

    Explicit steps, a share of the shortest time constant each: what one node loses is what others gain, to round-off.
    """
    films = now.shape[1]
    count = 1 + int(step * fastest(model, now) / LONGEST)
    part = step / count
    for _ in range(count):
        carried, given = write_rates(model, temperatures, now[POWER], now[FLOW], now[CLEARANCE], gain)
        books[CARRIED] += part * carried
        books[GIVEN] += part * given
        for i in range(temperatures.shape[0]):
            if i < films:
                books[DISSIPATED] += part * now[POWER, i]
                books[IN_FILMS] += part * gain[i]
                temperatures[i] += part * gain[i] / (held_share(model, now, i) * model.capacity[i])
            elif model.capacity[i] != math.inf:
                temperatures[i] += part * gain[i] / model.capacity[i]
