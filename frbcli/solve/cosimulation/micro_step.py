"""The slave of a co-simulation: all films on their way through one macro step of the rotor. Compiled.

The journals' motion is a parabola through the last three macro time points (section 5.2.1), so that it is interpolated.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.solve.films.forces import move_film
from frbcli.solve.films.steps import accept_films, begin_stage, most_iterations
from frbcli.solve.heat import warm_stage
from frbcli.solve.inputs import supply_warm
from frbcli.solve.ring_spin import set_speeds
from frbcli.solve.scratch import rotation
from frbcli.solve.stage.equations import FORCE, X_0, U, lagrange
from frbcli.solve.stage.journal_newton import forces
from frbcli.solve.state import NUMBERS, SOLVES, STEP_DONE, Control, RotorData, State
from frbcli.solve.step import SMALLEST_STEP, shorter, step_after
from frbcli.solve.tableau import Tableau

# Behind the numbers of a state: steps of the films, how many of them were repeated, the next one in s, and whether the
# films are mass-conserving: those that do not are solved once per macro step.
MICRO_STEPS, MICRO_REJECTED, MICRO_STEP, FILMS_REMEMBER, CO_NUMBERS = range(NUMBERS, NUMBERS + 5)
UNSOLVED_SHARE = 0.25  # of a step whose films were not solved, to be tried instead


@compiled()
def parabola(times: Array, t: float, weights: Array) -> None:
    """weights (3,) <- of Lagrange's parabola through three times (3,), at the time t."""
    weights[0], weights[1], weights[2] = lagrange(times[0], times[1], times[2], t)


class RotorMotion(NamedTuple):
    """The motion of the rotor as the films know it: motions (3, 4 films + 2 rings) of journals and rings at the macro
    times (3,), the films being at the second one: see macro_step.py."""

    times: Array
    motions: Array


@compiled()
def _move_journals(
    recent: RotorMotion, t: float, g: float, journal: Array, bodies: Array, angles: Array, lagrange: Array
) -> None:
    """U of the journals at the time t and X_0, g U short of where they are; speeds and angles of the rings."""
    motions, m, rings = recent.motions, journal.shape[1], bodies.shape[0] - 1
    parabola(recent.times, t, lagrange)
    for k in range(m):
        place, rate = 0.0, 0.0
        for p in range(3):
            place += lagrange[p] * motions[p, k]
            rate += lagrange[p] * motions[p, m + k]
        journal[U, k], journal[X_0, k] = rate, place - g * rate
    for r in range(rings):
        angles[1 + r], bodies[1 + r] = 0.0, 0.0
        for p in range(3):
            angles[1 + r] += lagrange[p] * motions[p, 2 * m + r]
            bodies[1 + r] += lagrange[p] * motions[p, 2 * m + rings + r]


@compiled()
def _solve_films(films: Any, work: Any, clearances: Array, control: Control, g: float, s: int, journal: Array) -> int:
    """Newton's method for all films under given journals; FORCE. Returns the iterations, 0: not solved."""
    for iteration in range(most_iterations(films)):
        forces(films, work, clearances, control, g, s, iteration, journal)
        unsettled = 0
        for f in range(clearances.shape[0]):
            if not math.isfinite(journal[FORCE, 2 * f] + journal[FORCE, 2 * f + 1]):
                return 0
            unsettled += move_film(films, work, f, 0.0, 0.0, g)
        if unsettled == 0:
            return iteration + 1
    return 0


@compiled()
def _oil_error(defect: Array, stage_oil: Array, step: float) -> float:
    """Largest embedded error of the oil of a cell, H theta."""
    stages, count, m, k = stage_oil.shape
    error = 0.0
    for f in range(count):
        for i in range(m):
            for j in range(k):
                total = 0.0
                for p in range(stages):
                    total += defect[p] * stage_oil[p, f, i, j]
                error = max(error, abs(step * total))
    return error


@compiled(makes_arrays=True)
def films_follow(
    films: Any, work: Any, rotor: RotorData, tableau: Tableau, control: Control, state: State, heat: Any, piece: int,
    recent: RotorMotion, exchange: Any,
) -> bool:  # fmt: skip
    """Take the films through a macro step; FORCE is then theirs. exchange: see macro_step.py. Returns whether that
    succeeded."""
    times, speeds, profile_angles = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    turning, clearances, numbers = rotor.turning, rotor.clearances, state.numbers
    weights, moments, order, tolerance = tableau.stage, tableau.times, float(tableau.error_order), control.tolerance
    journal, bodies, angles = exchange.scratch.journal, exchange.rings.bodies, exchange.rings.angles
    remembers = numbers[FILMS_REMEMBER] != 0.0
    lagrange = recent.times.copy()
    stages, gamma, t, end = moments.shape[0] if remembers else 2, weights[1, 1], recent.times[1], recent.times[2]
    wanted = min(numbers[MICRO_STEP], end - t) if remembers else end - t
    while t < end:
        step = end - t
        if wanted < (1.0 - 1e-9) * step:
            step = min(wanted, 0.5 * step)
        g, solved = gamma * step, True
        for s in range(1, stages):
            reach = moments[s] * step if remembers else step
            _, bodies[0], angles[0] = rotation(times, speeds, profile_angles, piece, t + reach)
            _move_journals(recent, t + reach, g, journal, bodies, angles, lagrange)
            set_speeds(turning, bodies, angles, journal, work.grids)
            warm_stage(heat, films, rotor.drag, clearances, state.wet, bodies, t + reach - recent.times[1])
            supply_warm(rotor.inputs, films, heat)
            lag = moments[s] / moments[s - 1] if moments[s - 1] > 0.0 else 1.0
            begin_stage(films, work, state.wet, state.flows, weights, s, step, g, reach / numbers[STEP_DONE], lag)
            iterations = _solve_films(films, work, clearances, control, g, s, journal)
            numbers[SOLVES] += iterations * clearances.shape[0]
            if iterations == 0:
                solved = False
                break
        error = _oil_error(tableau.defect, work.stage_oil, step) / tolerance if solved and remembers else 0.0
        if not solved or not error <= 1.0:
            numbers[MICRO_REJECTED] += 1
            wanted = shorter(step, error, order) if solved else UNSOLVED_SHARE * step
            if wanted < SMALLEST_STEP or not remembers:
                return False
            continue
        accept_films(films, work, state.wet, state.flows, weights, step)
        numbers[STEP_DONE] = step
        numbers[MICRO_STEPS] += 1
        t = t + step if step < end - t else end
        wanted = step_after(max(wanted, step), error, error, order)
    numbers[MICRO_STEP] = wanted
    return True
