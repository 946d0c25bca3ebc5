"""The steady temperatures of a machine: what the films dissipate leaves with the oil and through the walls.

Power and flow of the films follow from their solution, which depends on the viscosities. Between two solutions both are
taken as powers of the viscosity; the exponents begin as those of a concentric film, 1 and -1, and then follow from the
last two solutions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.compiled import Array
from frbcli.errors import NotConverged
from frbcli.thermal.model import HeatModel, clearances_at, rates, viscosities_at

SETTLED = 1e-5  # K: a change of all temperatures below this ends the iteration
ROUNDS, ITERATIONS = 60, 200
LONGEST = 30.0  # K by which a temperature changes in one iteration of Newton's method
DIFFERENCE = 1e-4  # K
POWER_EXPONENTS, FLOW_EXPONENTS = (0.0, 1.5), (-1.5, 0.5)
LEAST_CHANGE = 1e-6  # of a viscosity from which exponents follow
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
    by the oil, given: W to places of given temperature; balance: what is left over of the power, relative."""

    temperatures: Array
    viscosities: Array
    clearances: Array
    films: FilmHeat
    carried: float
    given: float
    balance: float


def steady_heat(
    model: HeatModel, names: tuple[str, ...], solve: Callable[[Array, Array], FilmHeat], start: Array, speeds: Array
) -> SteadyHeat:
    """The temperatures at which the heat of all nodes balances.

    solve: of viscosities and clearances (F,) what the films dissipate, may raise NotConverged; start (n,) K, speeds
    (bodies,) rad/s: to begin from. Raises NotConverged, with the film that boils, freezes or closes.
    """
    temperatures, before = start.copy(), None
    slopes = np.ones(len(names)), -np.ones(len(names))
    for rounds in range(ROUNDS):
        viscosities, clearances = viscosities_at(model, temperatures), clearances_at(model, temperatures, speeds)
        _check(model, names, temperatures, clearances)
        films = solve(viscosities, clearances)
        if before is not None:
            slopes = _exponents(slopes, before, (viscosities, films))
        after = _balanced(model, names, temperatures, viscosities, clearances, films, slopes)
        change = float(np.abs(after - temperatures).max())
        speeds, before = films.speeds, (viscosities, films)
        if change < SETTLED and rounds > 0:
            return _found(model, temperatures, viscosities, clearances, films)
        temperatures = after if rounds < ROUNDS // 2 else 0.5 * (after + temperatures)
    raise NotConverged(f"The temperatures do not settle: they still change by {change:.2g} K after {ROUNDS} rounds.")


def _found(model: HeatModel, t: Array, viscosities: Array, clearances: Array, films: FilmHeat) -> SteadyHeat:
    gain, whole = rates(model, t, films.power, films.flow, clearances), float(films.power.sum())
    held = np.isinf(model.capacity)
    given, left = float(gain[held].sum()), float(gain[~held].sum())
    balance = abs(left) / whole if whole > 0.0 else 0.0
    return SteadyHeat(t, viscosities, clearances, films, whole - given - left, given, balance)


def _exponents(
    slopes: tuple[Array, Array], before: tuple[Array, FilmHeat], now: tuple[Array, FilmHeat]
) -> tuple[Array, Array]:
    """d ln P / d ln eta and d ln Q / d ln eta of each film, by its last two solutions where these differ enough."""
    apart = np.log(now[0] / before[0])
    moved = np.abs(apart) > LEAST_CHANGE
    found = []
    for old, first, last, (least, most) in (
        (slopes[0], before[1].power, now[1].power, POWER_EXPONENTS),
        (slopes[1], before[1].flow, now[1].flow, FLOW_EXPONENTS),
    ):
        known = moved & (first > 0.0) & (last > 0.0)
        ratio = np.log(np.where(known, last, 1.0) / np.where(known, first, 1.0)) / np.where(known, apart, 1.0)
        found.append(np.where(known, np.clip(ratio, least, most), old))
    return found[0], found[1]


def _balanced(
    model: HeatModel, names: tuple[str, ...], start: Array, viscosities: Array, clearances: Array, films: FilmHeat,
    slopes: tuple[Array, Array],
) -> Array:  # fmt: skip
    """The temperatures at which all balances, by Newton's method, with power and flow as powers of the viscosity."""
    free = np.isfinite(model.capacity)
    if free.all() and float(films.flow.sum()) <= 0.0:
        raise NotConverged(_no_way_out(names, films))

    def gain(t: Array) -> Array:
        ratio = viscosities_at(model, t) / viscosities
        return rates(model, t, films.power * ratio ** slopes[0], films.flow * ratio ** slopes[1], clearances)[free]

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
