"""The time loop of a co-simulation (section 5.2.1): rotor and films advanced in turn, each by its own steps. Compiled.

Gauss and Seidel's sequence, the rotor being the master. In a macro step the rotor takes one step of its own with the
films' forces extrapolated by a parabola; then the films follow with as many steps as they need (films_follow). Nothing
is repeated once the films have moved: the method is explicit, and the macro step has to stay below what the stiffness
and the damping of the films allow.

The slave of a co-simulation: all films on their way through one macro step of the rotor. Compiled.

The journals' motion is a parabola through the last three macro time points (section 5.2.1), so that it is interpolated.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices, compiled
from frbcli.solve.films.forces import move_film
from frbcli.solve.films.steps import accept_films, begin_stage, most_iterations, write_oil
from frbcli.solve.heat import NO_HEAT, AcceptedStep, begin_heat, carry_heat, warm_stage, write_heat
from frbcli.solve.inputs import set_inputs, supply_warm
from frbcli.solve.ring_spin import Rings, make_rings, pinned, set_speeds, spin_up
from frbcli.solve.scratch import Scratch, make_scratch, rotation
from frbcli.solve.stage.equations import (
    FORCE,
    LAG_SWEEPS,
    STAGE_ROWS,
    X_0,
    Q,
    U,
    V,
    accelerate,
    begin_lag,
    lagrange,
    limit_of,
    norm,
    outdated,
    predict,
    prepare,
    start_stage,
)
from frbcli.solve.stage.forces import add_loads, prepare_cones, prepare_loads, solve_columns, turn_cones
from frbcli.solve.stage.journal_newton import forces
from frbcli.solve.state import (
    CONTACT,
    HISTORY,
    INVERSE_SPEED,
    NUMBERS,
    OUTPUTS,
    RUNNING,
    SOLVES,
    STEP,
    STEP_DONE,
    STUCK,
    Control,
    LoopOutput,
    RotorData,
    State,
    Tableau,
)
from frbcli.solve.step import (
    SMALLEST_STEP,
    begin_stages,
    begin_step,
    choose_next,
    count_step,
    displace,
    end_of_step,
    local_error,
    move_on,
    reject,
    shorter,
    step_after,
    write_outputs,
)
from frbcli.solve.time_loop import films_work

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
    times (3,), the films being at the second one."""

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
    """Take the films through a macro step; FORCE is then theirs. exchange: see Exchange. Returns whether that
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


GROWTH = 1.25  # of a macro step at most: it cannot be taken back
SLOWEST = 100.0  # rad/s: errors of the journals' velocities count against what else drives the films, at least this


class Exchange(NamedTuple):
    """The quantities that rotor and films exchange: columns (m + rings, n) of the films' forces and the torques on the
    rings, responses, as they: what each does to the accelerations, elimination (2, n, 2 n + m + rings) to work in;
    given (m + rings,) forces and torques; recent motion of the rotor; the rings; the scratch of the stages, and another
    one to ask the films for torques alone."""

    columns: Array
    responses: Array
    elimination: Array
    given: Array
    recent: RotorMotion
    rings: Rings
    scratch: Scratch
    aside: Scratch


def make_exchange(rotor: RotorData, scratch: Scratch) -> Exchange:
    """The exchange of a rotor and the scratch of its stages."""
    (m, n), rings = scratch.selection.shape, rotor.spins.shape[0]
    unused, columns = np.zeros((n, 1)), np.zeros((m + rings, n))
    columns[:m] = np.repeat(rotor.multiplicity, 2)[:, None] * scratch.selection
    columns[np.arange(m, m + rings), rotor.spins] = 1.0
    return Exchange(
        columns,
        np.zeros((m + rings, n)),
        np.zeros((2, n, 2 * n + m + rings)),
        np.zeros(m + rings),
        RotorMotion(np.zeros(3), np.zeros((3, 2 * m + 2 * rings))),
        make_rings(rings),
        scratch,
        scratch._replace(at=np.zeros((STAGE_ROWS, n)), stage_v=unused, stage_a=unused),
    )


@compiled()
def _set_motion(selection: Array, spins: Indices, clearances: Array, q: Array, v: Array, motion: Array) -> float:
    """motion <- displacements and velocities of the journals, then angles and speeds of the rings, at this moment.

    Returns the largest eccentricity."""
    m, rings, largest = selection.shape[0], spins.shape[0], 0.0
    for k in range(m):
        place, rate = 0.0, 0.0
        for i in range(q.shape[0]):
            place += selection[k, i] * q[i]
            rate += selection[k, i] * v[i]
        motion[k], motion[m + k] = place, rate
    for r in range(rings):
        motion[2 * m + r], motion[2 * m + rings + r] = q[spins[r]], v[spins[r]]
    for f in range(clearances.shape[0]):
        largest = max(largest, norm(motion[2 * f], motion[2 * f + 1]) / clearances[f])
    return largest


@compiled()
def _extrapolate(past: Array, t: float, lagrange: Array, given: Array, journal: Array) -> None:
    """given (m + rings,) <- forces of the films and torques on the rings at the time t by the parabola; FORCE too."""
    parabola(past[:, 0], t, lagrange)
    first = past.shape[1] - given.shape[0]
    for k in range(given.shape[0]):
        given[k] = 0.0
        for p in range(HISTORY):
            given[k] += lagrange[p] * past[p, first + k]
    for k in range(journal.shape[1]):
        journal[FORCE, k] = given[k]


@compiled()
def _recall(past: Array, recent: RotorMotion) -> None:
    """recent <- the last two macro times."""
    for p in range(2):
        recent.times[p] = past[1 + p, 0]
        for k in range(recent.motions.shape[1]):
            recent.motions[p, k] = past[1 + p, 1 + k]


@compiled()
def _remember(past: Array, t_new: float, motion: Array, journal: Array, torque: Array, given: Array) -> None:
    """past moves on to t_new; given <- what the extrapolated forces and torques were off by."""
    motions, m = motion.shape[0], journal.shape[1]
    for k in range(past.shape[1]):
        past[0, k], past[1, k] = past[1, k], past[2, k]
    past[2, 0] = t_new
    for k in range(motions):
        past[2, 1 + k] = motion[k]
    for k in range(given.shape[0]):
        past[2, 1 + motions + k] = journal[FORCE, k] if k < m else torque[k - m]
        given[k] = past[2, 1 + motions + k] - given[k]


@compiled()
def _amend(rotor: RotorData, speed: float, exchange: Exchange, compliance: Array, a: Array) -> float:
    """Make the accelerations a (n,) consistent with forces that were off by `given`. Returns the largest velocity of a
    journal, over its clearance, that they were off by in a stage."""
    responses, given, clearances = exchange.responses, exchange.given, rotor.clearances
    if rotor.table_speeds.shape[0] > 0:  # the mass that bearings add may change with the speed
        solve_columns(exchange.columns, responses, exchange.elimination, rotor, 0.0, speed)
    for i in range(a.shape[0]):
        for k in range(given.shape[0]):
            a[i] += responses[k, i] * given[k]
    off = 0.0
    for k in range(compliance.shape[0]):
        rate = 0.0
        for j in range(compliance.shape[0]):
            rate += compliance[k, j] * given[j]
        off = max(off, abs(rate) / clearances[k // 2])
    return off


@compiled()
def _turn_rings(
    spins: Indices, pins: Array, mass: Array, s: int, g: float, given: Array, at: Array, stage_v: Array,
    stage_a: Array, bodies: Array,
) -> None:  # fmt: skip
    """Accelerations and speeds of the rings in stage s, also in `bodies`, from the torques on them, the last of
    `given`, and their pins."""
    first = given.shape[0] - spins.shape[0]
    for r in range(spins.shape[0]):
        i = spins[r]
        stage_a[i, s] = given[first + r] / mass[i, i]
        if pins.shape[0] > 0:
            stage_a[i, s] = pinned(pins[r], at[Q, i], at[V, i], g, mass[i, i], given[first + r])
        stage_v[i, s] = bodies[1 + r] = at[V, i] + g * stage_a[i, s]


@compiled()
def _move_rotor(
    rotor: RotorData, numbers: Array, s: int, g: float, speed: float, given: Array, bodies: Array, scratch: Scratch
) -> None:
    """Velocities and accelerations of the rotor and the rings in stage s, from forces and torques that are given."""
    spins, pins, mass, journal, at = rotor.spins, rotor.pins, rotor.mass, scratch.journal, scratch.at
    selection, stage_v, stage_a = scratch.selection, scratch.stage_v, scratch.stage_a
    _turn_rings(spins, pins, mass, s, g, given, at, stage_v, stage_a, bodies)
    turned = turn_cones(rotor.cones, bodies, s, s - 1, g, selection, at, stage_a, journal)
    lag = begin_lag(numbers, g, speed, at) if rotor.has_gyroscopic else 0.0
    sweeps = 0 if lag == 0.0 and turned == 0.0 else LAG_SWEEPS
    for sweep in range(1 + sweeps):
        accelerate(s, g, lag, scratch.products, scratch.spread, selection, at, journal, stage_v, stage_a)
        if sweep < sweeps:
            turn_cones(rotor.cones, bodies, s, s, g, selection, at, stage_a, journal)
    _turn_rings(spins, pins, mass, s, g, given, at, stage_v, stage_a, bodies)


@compiled()
def _stand(motion: Array, journal: Array) -> None:
    """X_0 and U of the journals where they are now and how they move, see _set_motion; with g = 0."""
    m = journal.shape[1]
    for k in range(m):
        journal[X_0, k], journal[U, k] = motion[k], motion[m + k]


@compiled()
def _warm_up(
    heat: Any, films: Any, work: Any, rotor: RotorData, control: Control, state: State, step: float, exchange: Exchange
) -> int:
    """carry_heat over a macro step, with the journals where they are now, which rows of equations.py then say."""
    journal, bodies, wet = exchange.scratch.journal, exchange.rings.bodies, state.wet
    _stand(exchange.recent.motions[2], journal)
    accepted = AcceptedStep(
        step, 0.0, rotor.torque_terms[1], control.contact_eccentricity, control.contact_stiffness, ()
    )
    turning, clearances, drag = rotor.turning, rotor.clearances, rotor.drag
    return carry_heat(heat, films, work, turning, journal, bodies, wet, accepted, clearances, drag)


@compiled()
def _ask_for_torques(
    films: Any, work: Any, rotor: RotorData, control: Control, aside: Scratch, rings: Rings
) -> None:
    """The torques on the rings with the journals where _warm_up has them."""
    if rotor.spins.shape[0] > 0:
        spin_up(films, work, rotor, 0, 0.0, control, aside, rings)


def advance_in_turn(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, budget: int, output: LoopOutput,
    heat: Any = NO_HEAT,
) -> tuple[int, int]:  # fmt: skip
    """Advance rotor and films that are solved apart, see advance of time_loop.py; the state comes from in_turn of
    runs/start.py.

    Temperatures move on once in a macro step, by the power and the flow at its end. control.longest_step is the longest
    macro step. state.past: (3, 1 + 6 films + 3 rings) at the last macro times: time; the journals' displacements and
    velocities; the rings' angles and speeds; the films' forces, the rings' torques.
    """
    stages = tableau.times.shape[0]
    begin_heat(heat, films, rotor, state.wet)
    work = films_work(rotor, films, state, stages, heat)
    exchange = make_exchange(rotor, make_scratch(rotor, state.numbers, stages))
    status, rows = _advance(rotor, films, tableau, control, state, work, exchange, budget, output, heat)
    return int(status), int(rows)


@compiled(makes_arrays=True)
def _advance(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, work: Any, exchange: Exchange,
    budget: int, output: LoopOutput, heat: Any,
) -> tuple[int, int]:  # fmt: skip
    """advance_in_turn with the arrays that it works in."""
    numbers, q, v, a, past = state.numbers, state.q, state.v, state.a, state.past
    spins, times, speeds, angles = rotor.spins, rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    clearances, observed = rotor.clearances, rotor.observed
    weights, moments, defect, stages = tableau.stage, tableau.times, tableau.defect, tableau.times.shape[0]
    tolerance, stiffness = control.tolerance, control.contact_stiffness
    gamma, order, limit = weights[1, 1], float(tableau.error_order), limit_of(stiffness)
    _, _, _, given, recent, turning, scratch, aside = exchange
    selection, products, loads, spread, compliance, elimination, at, journal, stage_v, stage_a = scratch
    lagrange, q_new, out_q, out_v, out_oil = np.zeros(3), np.zeros(q.shape[0]), output.q, output.v, output.oil
    written, done = 0, 0
    solve_columns(exchange.columns, exchange.responses, exchange.elimination, rotor, 0.0, numbers[INVERSE_SPEED])

    while done < budget:
        status, t, piece, h, step = begin_step((), v, numbers, times, speeds, angles, control, len(out_q) - written)
        if step == 0.0:
            return status, written
        set_inputs(rotor.inputs, films, heat, t, step)
        begin_stages(v, a, stage_v, stage_a)
        g, speed = gamma * step, 0.0
        for s in range(1, stages):
            t_s = t + moments[s] * step
            acceleration, speed, angle = rotation(times, speeds, angles, piece, t_s)
            if outdated(numbers, g, speed, rotor.has_gyroscopic, rotor.follows_speed):
                prepare(rotor, selection, numbers, g, speed, products, loads, spread, compliance, elimination)
                prepare_loads(rotor.loads, rotor, g, speed)
                prepare_cones(rotor.cones, rotor, g, speed)
            predict(weights, s, step, q, v, stage_v, stage_a, at)
            start_stage(acceleration, speed, angle, g, rotor.has_gyroscopic, products, loads, selection, at, journal)
            add_loads(rotor.loads, t_s, angle, g, selection, at, journal)
            _extrapolate(past, t_s, lagrange, given, journal)
            _move_rotor(rotor, numbers, s, g, speed, given, turning.bodies, scratch)
        error = local_error(defect, observed, stage_v, stage_a, step, g) / tolerance
        if not error <= 1.0:  # not a number counts as too large
            if reject(numbers, step, error, order):
                continue
            return STUCK, written

        t_new = end_of_step(t, step, times[piece + 1])
        displace(weights[stages - 1], stage_v, step, q, q_new)
        _recall(past, recent)
        recent.times[2] = t_new
        largest = _set_motion(selection, spins, clearances, q_new, stage_v[:, stages - 1], recent.motions[2])
        if not largest < limit:  # the films cannot be asked there any more
            return CONTACT if stiffness == 0.0 and math.isfinite(largest) else STUCK, written
        if not films_follow(films, work, rotor, tableau, control, state, heat, piece, recent, exchange):
            return STUCK, written
        before = written
        written = write_outputs(numbers, stage_v, control.output_step, step, t_new, q, q_new, out_q, out_v, written)
        write_oil(films, work, out_oil, before, written)
        hot = _warm_up(heat, films, work, rotor, control, state, step, exchange)
        until_end = t_new - (numbers[OUTPUTS] - 1.0) * control.output_step
        write_heat(heat, output.heat, before, written, until_end, control.output_step, step)
        _ask_for_torques(films, work, rotor, control, aside, turning)
        move_on(q, v, a, q_new, stage_v, stage_a)
        _remember(past, t_new, recent.motions[2], journal, turning.torque, given)
        off = _amend(rotor, speed, exchange, compliance, a)
        done += 1
        status = count_step(numbers, state.errors, control, t_new, step, speed, error * tolerance + off * step, largest)
        if status != RUNNING or hot != RUNNING:
            return status if status != RUNNING else hot, written
        error += off / (abs(speed) + SLOWEST) / tolerance
        choose_next(numbers, h, error, order, GROWTH * h)
        if numbers[STEP] < SMALLEST_STEP:
            return STUCK, written
    return RUNNING, written
