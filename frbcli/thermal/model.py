"""The lumped model of heat: nodes with one temperature each, conductances between them, and films as heat sources.

Of a film f with the power P that journal and shell put into it and the oil flow Q through its ends

    C dT/dt = P - s Q (T - T_in)/m - s Q_fed (T - T_in) - sum over walls of h A (T - T_wall),   h = Nu k / C_r,

where s is the volumetric heat capacity of the oil, A = 2 pi R B, C_r the radial clearance, and Q_fed what films take
that are fed from this one. All other nodes have conductances only; a node of infinite capacity keeps its temperature.
The films are the first nodes.

The steady temperatures of a machine: what the films dissipate leaves with the oil and through the walls.

Power and flow of the films follow from their solution. Next to it both are taken as for concentric films, whose power
is in proportion to the viscosity and whose flow to its inverse; what the temperatures that then balance lack follows
from one solution to the next, and from one speed to the next (Broyden, Math. Comp. 19, 1965).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.errors import NotConverged

FROM_SUPPLY = -1
OIL_AT = 353.15, 393.15  # K between which the heat capacity of the oil is taken as linear
AT_ZERO, SLOPE = range(2)  # volumetric heat capacity AT_ZERO + SLOPE T, J/(m^3 K), T in K


class HeatModel(NamedTuple):
    """n nodes, the first F of them films, l links. capacity (n,) J/K, infinite where a temperature is given; links
    (l, 2) nodes, conductance (l,) W/K at the clearances `reference` (F,), of_film (l,) the film whose clearance it
    divides by, -1: none; supply (F,) K; inlet (F,) the film that feeds this one, or FROM_SUPPLY; mixing: m; oil_heat
    (2,): AT_ZERO, SLOPE; viscosity (3,): eta_0, A, C of Vogel's law; clearance (F,) m at no temperature and speed,
    expansion (F, n) m/K and growth (F, bodies) m s^2 by the squares of the speeds of rotor and rings, see
    clearances_at; hottest: K; balanced: whether films are in balance at each instant of a run."""

    capacity: Array
    links: NDArray[np.int64]
    conductance: Array
    of_film: NDArray[np.int64]
    supply: Array
    inlet: NDArray[np.int64]
    mixing: float
    oil_heat: Array
    viscosity: Array
    clearance: Array
    reference: Array
    expansion: Array
    growth: Array
    hottest: float
    balanced: bool = False


def clearances_at(model: HeatModel, temperatures: Array, speeds: Array) -> Array:
    """(F,) m: C + sum of expansion T + sum of growth omega^2, (4.24), with the temperatures (n,) in K and the speeds
    (bodies,) in rad/s."""
    return np.asarray(model.clearance + model.expansion @ temperatures + model.growth @ np.square(speeds))


def viscosities_at(model: HeatModel, temperatures: Array) -> Array:
    """(F,) Pa s of the films at the temperatures (n,) in K of all nodes, (3.12)."""
    eta_0, a, c = model.viscosity
    return np.asarray(eta_0 * np.exp(a / (temperatures[: len(model.supply)] + c)))


def rates(model: HeatModel, temperatures: Array, power: Array, flow: Array, clearances: Array) -> Array:
    """(n,) W that each node gains; power, flow: (F,) W and m^3/s; clearances (F,) m."""
    films, t = len(power), temperatures
    fed = model.inlet >= 0
    at = np.where(fed, t[model.inlet], model.supply)
    rise = t[:films] - at
    heat = (model.oil_heat[AT_ZERO] + model.oil_heat[SLOPE] * (at + 0.5 * rise / model.mixing)) * flow
    gain = np.zeros(len(t))
    gain[:films] = power - heat * rise / model.mixing
    np.subtract.at(gain, model.inlet[fed], (heat * (t[model.inlet] - model.supply[model.inlet]))[fed])
    conductance = model.conductance.copy()
    of_film = model.of_film >= 0
    conductance[of_film] *= (model.reference / clearances)[model.of_film[of_film]]
    passed = conductance * (t[model.links[:, 0]] - t[model.links[:, 1]])
    np.subtract.at(gain, model.links[:, 0], passed)
    np.add.at(gain, model.links[:, 1], passed)
    return gain


SETTLED = 1e-6  # K: a step of all temperatures below this ends the iteration
ROUNDS, ITERATIONS = 60, 200
LONGEST = 30.0  # K by which a temperature changes in one iteration of Newton's method
FURTHEST = 100.0  # K by which it changes from one solution of the films to the next
DIFFERENCE = 1e-4  # K
LEAST_CHANGE = 1e-9  # K from which a change resolves a slope
COLDEST = 5.0  # K above the pole of the viscosity law


@dataclass(frozen=True)
class FilmHeat:
    """What solved films dissipate and let out: power (F,) W, flow (F,) m^3/s, speeds (bodies,) rad/s of the rotor and
    the rings."""

    power: Array
    flow: Array
    speeds: Array


@dataclass(frozen=True)
class SteadyHeat:
    """Steady temperatures (n,) K; viscosities (F,) Pa s, clearances (F,) m; films: what they dissipate then; carried: W
    by the oil, given: W to places of given temperature; balance: what is left over of the power, relative; slope:
    (n, n) of what balances less the temperatures themselves, by the latter."""

    temperatures: Array
    viscosities: Array
    clearances: Array
    films: FilmHeat
    carried: float
    given: float
    balance: float
    slope: Array


def steady_heat(
    model: HeatModel,
    names: tuple[str, ...],
    solve: Callable[[Array, Array], FilmHeat],
    start: Array,
    speeds: Array,
    slope: Array | None = None,
) -> SteadyHeat:
    """The temperatures at which the heat of all nodes balances.

    solve: of viscosities and clearances (F,) what the films dissipate, may raise NotConverged; start (n,) K, speeds
    (bodies,) rad/s, slope (n, n) of SteadyHeat: to begin from. Raises NotConverged, with the film that boils, freezes
    or closes.
    """
    temperatures, slope = start.copy(), -np.eye(len(start)) if slope is None else slope
    step: Array = np.zeros(len(start))
    change: Array = np.zeros(len(start))
    for rounds in range(ROUNDS):
        viscosities, clearances = viscosities_at(model, temperatures), clearances_at(model, temperatures, speeds)
        _check(model, names, temperatures, clearances)
        films, before = solve(viscosities, clearances), change
        change = _balanced(model, names, temperatures, viscosities, clearances, films) - temperatures
        if rounds > 0 and (size := float(step @ step)) > LEAST_CHANGE**2:
            slope = slope + np.outer(change - before - slope @ step, step) / size
        step = np.asarray(np.linalg.lstsq(slope, -change, rcond=None)[0])
        left, speeds = float(np.abs(step).max()), films.speeds
        if left < SETTLED and rounds > 0:
            return _with_losses(model, temperatures, viscosities, clearances, films, slope)
        if rounds >= ROUNDS // 2:
            step = 0.5 * change
        step *= min(1.0, FURTHEST / max(left, 1e-300))
        temperatures = temperatures + step
    raise NotConverged(f"The temperatures do not settle: they still change by {left:.2g} K after {ROUNDS} rounds.")


def _with_losses(
    model: HeatModel, t: Array, viscosities: Array, clearances: Array, films: FilmHeat, slope: Array
) -> SteadyHeat:
    gain, whole = rates(model, t, films.power, films.flow, clearances), float(films.power.sum())
    held = np.isinf(model.capacity)
    given, left = float(gain[held].sum()), float(gain[~held].sum())
    balance = abs(left) / whole if whole > 0.0 else 0.0
    return SteadyHeat(t, viscosities, clearances, films, whole - given - left, given, balance, slope)


def _balanced(
    model: HeatModel, names: tuple[str, ...], start: Array, viscosities: Array, clearances: Array, films: FilmHeat
) -> Array:
    """The temperatures at which all balances, by Newton's method, with power and flow as concentric films have them."""
    free = np.isfinite(model.capacity)
    if free.all() and float(films.flow.sum()) <= 0.0:
        raise NotConverged(_no_way_out(names, films))

    def gain(t: Array) -> Array:
        ratio = viscosities_at(model, t) / viscosities
        return rates(model, t, films.power * ratio, films.flow / ratio, clearances)[free]

    t, lowest = start.copy(), COLDEST - float(model.viscosity[2])
    places = np.flatnonzero(free)
    for _ in range(ITERATIONS):
        residual = gain(t)
        slope = np.empty((len(places), len(places)))
        for column, place in enumerate(places):
            ahead, behind = t.copy(), t.copy()
            ahead[place] += DIFFERENCE
            behind[place] -= DIFFERENCE
            slope[:, column] = (gain(ahead) - gain(behind)) / (2.0 * DIFFERENCE)
        if not np.isfinite(slope).all() or np.linalg.cond(slope) > 1e12:
            raise NotConverged(_no_way_out(names, films))
        step = -np.linalg.solve(slope, residual)
        step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
        t[places] = np.maximum(t[places] + step, lowest)
        if float(t[: len(names)].max()) > model.hottest + LONGEST:
            raise NotConverged(_hot(names[int(np.argmax(t[: len(names)]))], model.hottest))
        if float(np.abs(step).max()) < 0.01 * SETTLED:
            return t
    raise NotConverged(f"The heat of the films does not balance after {ITERATIONS} iterations.")


def _check(model: HeatModel, names: tuple[str, ...], temperatures: Array, clearances: Array) -> None:
    """Raise NotConverged where a film boils or its gap closes."""
    for name, temperature, clearance in zip(names, temperatures, clearances, strict=False):
        if temperature >= model.hottest:
            raise NotConverged(_hot(name, model.hottest))
        if clearance <= 0.0:
            raise NotConverged(closed_gap(name))


def closed_gap(name: str, when: str = "") -> str:
    """What to say of a film whose gap heat closes."""
    where = f"{_film(name)} {when}".rstrip()
    return f"Heat closes the gap of {where}. Give it more clearance, or shaft and shell of nearer temperatures."


def _hot(name: str, hottest: float) -> str:
    return (
        f"The oil in {_film(name)} becomes hotter than {hottest - 273.15:.4g} degC (thermal.hottest_film): overheated. "
        "Give it more flow, a cooler supply, or a wall that takes heat."
    )


def _no_way_out(names: tuple[str, ...], films: FilmHeat) -> str:
    dry = [name for name, flow in zip(names, films.flow, strict=True) if flow <= 0.0]
    where = ", ".join(_film(name) for name in dry) or "the films"
    return (
        f"The heat of {where} has no way out: no oil leaves at the ends, and the walls are adiabatic. "
        "Give a supply pressure above the ambient one, a load, or a wall with a temperature."
    )


def _film(name: str) -> str:
    return f"the film {name}" if name else "the film"
