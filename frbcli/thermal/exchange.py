"""The balance of heat in a time step, compiled; rates and clearances as in model.py, which tests hold them to.

The kernels are given arrays, not records: to take a record of many arrays apart costs more than a balance does.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.dense import solve_dense
from frbcli.thermal.model import AT_ZERO, SLOPE, HeatModel

# Rows of the links: two nodes, conductance at the reference clearance W/K, the film whose clearance divides it or -1.
FIRST, SECOND, CONDUCTANCE, OF_FILM = range(4)
# Rows of the films: temperature of the supply K, film that feeds it or -1, clearance at no temperature and speed m; as
# they were made: clearance m, viscosity Pa s, Couette's resistance N m s; Q eta / C^3 of the formula m Pa s / s.
SUPPLY, INLET, BASE, REFERENCE, VISCOSITY, DRAG, FORMULA = range(7)
# Numbers: volumetric heat capacity of the oil at 0 K and its slope, m, hottest film K, Vogel's law (3.12); 1 where the
# side flow follows from the formula; 1 where films are in balance at each instant.
HEAT_AT_ZERO, HEAT_SLOPE, MIXING, HOTTEST, ETA_0, A, C, BY_FORMULA, BALANCED = range(9)
# What a run has gone through so far, in J: dissipated by the films, carried away by the oil, taken by nodes of given
# temperature, kept by the films; and 1 + the film that became too hot, 0 if none.
DISSIPATED, CARRIED, GIVEN, IN_FILMS, HOT, BOOKS = range(6)
# Rows of what a film is now: power W, flow m^3/s, viscosity Pa s, clearance m, scale of its pressures over the table's,
# share of its gap that is oil, heat that its oil takes along W/K, share of its gauge supply pressure; the first two and
# the clearance at the start of the last step.
POWER, FLOW, ETA, CLEARANCE, SCALE, SHARE, OIL_HEAT, SHARE_OF_SUPPLY = range(8)
POWER_BEFORE, FLOW_BEFORE, CLEARANCE_BEFORE, FILM_ROWS = range(8, 12)
# What the last step has added to the books, its length in s, and then what it has added to the temperatures of n nodes.
LENGTH, CHANGES = HOT, HOT + 1
LONGEST = 0.2  # of the shortest time constant: an explicit step
ITERATIONS, FURTHEST, SETTLED = 30, 30.0, 1e-9  # of a film in balance: the steps of Newton's method and its end, K


class HeatArrays(NamedTuple):
    """A HeatModel of n nodes, the first F of them films: capacity (n,) J/K; links (4, l), films (7, F), numbers (9,)
    with the rows above; growth (F, bodies + n) m s^2 and m/K of the clearances, see write_clearances."""

    capacity: Array
    links: Array
    films: Array
    numbers: Array
    growth: Array


def arrays_of(model: HeatModel, viscosity: Array, drag: Array, formula: Array, by_formula: bool) -> HeatArrays:
    """The model as the kernels take it. viscosity (F,) Pa s, drag (F,) N m s: of the films as they were made; formula
    (F,): Q eta / C^3 of a concentric film, the side flow where by_formula."""
    links = np.vstack([model.links.T, model.conductance, model.of_film]).astype(np.float64, order="C")
    made = (model.reference, viscosity, drag, formula)
    films = np.vstack([model.supply, model.inlet, model.clearance, *made]).astype(np.float64, order="C")
    oil = (model.oil_heat[AT_ZERO], model.oil_heat[SLOPE])
    numbers = np.array([*oil, model.mixing, model.hottest, *model.viscosity, float(by_formula), float(model.balanced)])
    return HeatArrays(model.capacity, links, films, numbers, np.hstack([model.growth, model.expansion]))


@compiled(inline=True)
def viscosity_at(numbers: Array, temperature: float) -> float:
    """Vogel's law (3.12), Pa s."""
    return float(numbers[ETA_0]) * math.exp(float(numbers[A]) / (temperature + float(numbers[C])))


@compiled(inline=True)
def write_clearances(films: Array, growth: Array, bodies: int, state: Array, now: Array) -> None:
    """Clearances of now (FILM_ROWS, F) <- (4.24) with temperatures in K, and the growth of bodies with their speeds in
    rad/s. state: after the books it has the speeds of `bodies` bodies, then the temperatures."""
    for f in range(films.shape[1]):
        total = films[BASE, f]
        for i in range(growth.shape[1]):
            at = state[BOOKS + i]
            total += growth[f, i] * (at * at if i < bodies else at)
        now[CLEARANCE, f] = total


@compiled(inline=True)
def write_rates(
    capacity: Array, links: Array, films: Array, numbers: Array, now: Array, temperatures: Array, gain: Array
) -> tuple[float, float]:
    """gain (n,) <- W that each node gains from what the films do now (FILM_ROWS, F), whose OIL_HEAT is written.

    Returns what the oil carries away and what nodes of given temperature take, W.
    """
    for f in range(films.shape[1]):
        source = int(films[INLET, f])
        at = temperatures[source] if source >= 0 else films[SUPPLY, f]
        rise = temperatures[f] - at
        mean = at + 0.5 * rise / numbers[MIXING]
        now[OIL_HEAT, f] = (numbers[HEAT_AT_ZERO] + numbers[HEAT_SLOPE] * mean) * now[FLOW, f]
    return _write_gains(capacity, links, films, numbers[MIXING], now, temperatures, gain)


@compiled(inline=True)
def _write_gains(
    capacity: Array, links: Array, films: Array, mixing: float, now: Array, temperatures: Array, gain: Array
) -> tuple[float, float]:
    """write_rates with the OIL_HEAT that is there: linear in the temperatures."""
    count, carried, given = films.shape[1], 0.0, 0.0
    for i in range(gain.shape[0]):
        gain[i] = now[POWER, i] if i < count else 0.0
    for f in range(count):
        source = int(films[INLET, f])
        at = temperatures[source] if source >= 0 else films[SUPPLY, f]
        rise, heat = temperatures[f] - at, now[OIL_HEAT, f]
        gain[f] -= heat * rise / mixing
        carried += heat * rise / mixing
        if source >= 0:  # this oil has come through the film that feeds this one
            warmer = temperatures[source] - films[SUPPLY, source]
            gain[source] -= heat * warmer
            carried += heat * warmer
    for k in range(links.shape[1]):
        i, j, film = int(links[FIRST, k]), int(links[SECOND, k]), int(links[OF_FILM, k])
        passed = links[CONDUCTANCE, k] * (temperatures[i] - temperatures[j])
        if film >= 0:
            passed *= films[REFERENCE, film] / now[CLEARANCE, film]
        gain[i] -= passed
        gain[j] += passed
    for i in range(gain.shape[0]):
        if capacity[i] == math.inf:
            given += gain[i]
    return carried, given


@compiled(inline=True)
def fastest(capacity: Array, links: Array, films: Array, numbers: Array, now: Array, total: Array) -> float:
    """An upper bound of the rates at which nodes follow each other, 1/s. now: (FILM_ROWS, F); total: (n,) scratch."""
    largest, count = 0.0, films.shape[1]
    through = (numbers[HEAT_AT_ZERO] + numbers[HEAT_SLOPE] * numbers[HOTTEST]) / numbers[MIXING]
    for i in range(total.shape[0]):
        total[i] = through * now[FLOW, i] if i < count else 0.0
    for k in range(links.shape[1]):
        film, passed = int(links[OF_FILM, k]), links[CONDUCTANCE, k]
        if film >= 0:
            passed *= films[REFERENCE, film] / now[CLEARANCE, film]
        total[int(links[FIRST, k])] += passed
        total[int(links[SECOND, k])] += passed
    for i in range(count if numbers[BALANCED] != 0.0 else 0, total.shape[0]):
        share = held_share(films, now, i) if i < count else 1.0
        largest = max(largest, total[i] / (share * capacity[i]))
    return largest


@compiled(inline=True)
def held_share(films: Array, now: Array, f: int) -> float:
    """Oil in a film over the oil of its full gap at the reference clearance."""
    return float(max(now[SHARE, f], 1e-3) * now[CLEARANCE, f] / films[REFERENCE, f])


@compiled()
def balance_films(links: Array, films: Array, numbers: Array, now: Array, temperatures: Array) -> None:
    """The films of temperatures (n,) <- those at which they gain nothing from what they do now (FILM_ROWS, F), by
    Newton's method, with the power proportional to the viscosity and the flow to its inverse."""
    for f in range(films.shape[1] - 1, -1, -1):  # a film that feeds another one comes behind it
        source, t = int(films[INLET, f]), temperatures[f]
        at = temperatures[source] if source >= 0 else films[SUPPLY, f]
        held = given = 0.0  # W/K to all that keeps its temperature here, and W from it
        for k in range(links.shape[1]):
            i, j, film = int(links[FIRST, k]), int(links[SECOND, k]), int(links[OF_FILM, k])
            if f in (i, j):
                passed = links[CONDUCTANCE, k]
                if film >= 0:
                    passed *= films[REFERENCE, film] / now[CLEARANCE, film]
                held += passed
                given += passed * temperatures[i + j - f]
        for i in range(films.shape[1]):
            if int(films[INLET, i]) == f:  # oil that it hands on
                passed = (numbers[HEAT_AT_ZERO] + numbers[HEAT_SLOPE] * films[SUPPLY, f]) * now[FLOW, i]
                held += passed
                given += passed * films[SUPPLY, f]
        for _ in range(ITERATIONS):
            rise, below = (t - at) / numbers[MIXING], t + numbers[C]
            thicker = viscosity_at(numbers, t) / now[ETA, f]
            flow, slope = now[FLOW, f] / thicker, -numbers[A] / (below * below)  # slope: of the logarithm of thicker
            heat = (numbers[HEAT_AT_ZERO] + numbers[HEAT_SLOPE] * (at + 0.5 * rise)) * flow
            left = now[POWER, f] * thicker - heat * rise - held * t + given
            by_t = (now[POWER, f] * thicker + heat * rise) * slope - held
            by_t -= (heat + 0.5 * numbers[HEAT_SLOPE] * flow * rise) / numbers[MIXING]
            change = FURTHEST if by_t >= 0.0 else min(max(-left / by_t, -FURTHEST), FURTHEST)
            t = min(t + change, numbers[HOTTEST])
            if abs(change) < SETTLED or t == numbers[HOTTEST]:
                break
        temperatures[f] = t


@compiled(makes_arrays=True)
def _follow_implicitly(
    capacity: Array, links: Array, films: Array, numbers: Array, now: Array, step: float, begun: Array, ahead: Array,
    gain: Array,
) -> None:  # fmt: skip
    """ahead (n,) <- temperatures after a step of Euler's implicit formula from `begun`; gain (n,): of those that were
    ahead, as write_rates has left it."""
    n, count, balanced = ahead.shape[0], films.shape[1], numbers[BALANCED] != 0.0
    matrix, change = np.zeros((n, n)), np.zeros((n, 1))
    for f in range(count):
        source, heat = int(films[INLET, f]), now[OIL_HEAT, f]
        matrix[f, f] += heat / numbers[MIXING]
        if source >= 0:
            matrix[f, source] -= heat / numbers[MIXING]
            matrix[source, source] += heat
    for k in range(links.shape[1]):
        i, j, film = int(links[FIRST, k]), int(links[SECOND, k]), int(links[OF_FILM, k])
        passed = links[CONDUCTANCE, k]
        if film >= 0:
            passed *= films[REFERENCE, film] / now[CLEARANCE, film]
        matrix[i, i] += passed
        matrix[j, j] += passed
        matrix[i, j] -= passed
        matrix[j, i] -= passed
    for i in range(n):
        if capacity[i] == math.inf or (balanced and i < count):  # keeps its temperature
            for j in range(n):
                matrix[i, j] = 1.0 if i == j else 0.0
        else:
            stored = (held_share(films, now, i) if i < count else 1.0) * capacity[i] / step
            matrix[i, i] += stored
            change[i, 0] = gain[i] - stored * (ahead[i] - begun[i])
    solve_dense(matrix, change)
    for i in range(n):
        ahead[i] += change[i, 0]


@compiled(inline=True)
def heat_step(
    model: HeatArrays, now: Array, step: float, temperatures: Array, ahead: Array, last: Array, gain: Array,
    books: Array,
) -> None:  # fmt: skip
    """temperatures (n,) <- after a step in s, at whose end films of the temperatures `ahead` dissipate and let out what
    `now` says; books (BOOKS,) add up where the heat goes. last (CHANGES + n,): of the step before, then of this one;
    ahead, gain (n,): scratch.

    The backward differentiation formula of second order for steps of any length is Euler's implicit formula for a
    shorter step that begins where a share of the last change has led. What follows from it for temperatures holds for
    the books, too: what one node loses is what others gain, to round-off. Rates are taken at `ahead`, which
    extrapolates the temperatures, or where a step is not short against the time constants of all nodes, at its end:
    nodes of little capacity are in balance then. """
    capacity, links, films, numbers, _ = model
    balanced, count, n = numbers[BALANCED] != 0.0, films.shape[1], temperatures.shape[0]
    ratio = step / last[LENGTH] if last[LENGTH] > 0.0 else 0.0
    share = ratio * ratio / (1.0 + 2.0 * ratio)
    length = step * (1.0 + ratio) / (1.0 + 2.0 * ratio)
    if balanced:
        balance_films(links, films, numbers, now, ahead)
    short = length * fastest(capacity, links, films, numbers, now, gain) <= LONGEST
    carried, given = write_rates(capacity, links, films, numbers, now, ahead, gain)
    dissipated = in_films = 0.0
    for i in range(n):
        change = share * last[CHANGES + i]
        last[CHANGES + i] = temperatures[i]
        if capacity[i] != math.inf and not (balanced and i < count):
            temperatures[i] += change  # where Euler's formula begins
    if not short:
        _follow_implicitly(capacity, links, films, numbers, now, length, temperatures, ahead, gain)
        carried, given = _write_gains(capacity, links, films, numbers[MIXING], now, ahead, gain)
    for i in range(n):
        if i < count:
            dissipated += now[POWER, i]
            in_films += 0.0 if balanced else gain[i]
        if not short or (balanced and i < count):
            temperatures[i] = ahead[i]
        elif capacity[i] != math.inf:
            held = held_share(films, now, i) if i < count else 1.0
            temperatures[i] += length * gain[i] / (held * capacity[i])
        last[CHANGES + i] = temperatures[i] - last[CHANGES + i]
    last[LENGTH] = step
    for book, rate in ((DISSIPATED, dissipated), (CARRIED, carried), (GIVEN, given), (IN_FILMS, in_films)):
        last[book] = share * last[book] + length * rate
        books[book] += last[book]
