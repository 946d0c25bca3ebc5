"""The time loop: rotor and films advanced together by an implicit Runge-Kutta method with error control. Compiled.

A step is a few stages (stage.py), an error estimate and dense output (step.py). All that it is given and carries along
is in state.py, the methods in tableau.py.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from frbcli.rotor.excitation import rotation
from frbcli.solve.passengers import accept_films, begin_stage, make_work, write_oil
from frbcli.solve.ring_spin import set_speeds, spin_up
from frbcli.solve.stage import (
    FREE,
    JOURNAL_ROWS,
    LATE,
    STAGE_ROWS,
    Q,
    U,
    V,
    accelerate,
    correct,
    forces,
    guess,
    norm,
    prepare,
    start_stage,
)
from frbcli.solve.state import (
    CONTACT,
    ERROR_BEFORE,
    ERROR_LARGEST,
    ERROR_NOW,
    FINISHED,
    HISTORY,
    INVERSE_G,
    INVERSE_SPEED,
    LARGEST_EPS,
    PIECE,
    REJECTED,
    RUNNING,
    SOLVES,
    STEP,
    STEP_BEFORE,
    STEP_DONE,
    STEPS,
    STUCK,
    TIME,
    TURNS,
)
from frbcli.solve.step import SAFETY, local_error, step_after, step_to_take, write_outputs

NEWTON_LIMIT = 12  # iterations before a step is tried again with a smaller one
CELL_LIMIT = 24  # the same for films with cells, whose kinks take longer
NEWTON_SHARE = 0.02  # of the tolerance that Newton's method may leave undone
SMALLEST_STEP = 1e-12  # s
ERROR_MEMORY = 0.1  # s: how long a local error is taken to live on in a damped rotor
UNSOLVED = 1e3  # stands for the error of a step that Newton's method did not solve
ELASTIC_LIMIT = 1.5  # eccentricity that no journal exceeds even under elastic contact
INVERSE_LASTS = 0.01  # relative change of the speed over which a gyroscopic rotor keeps its inverse
LAG_SWEEPS = 2  # iterations that bring the rest of the gyroscopic term below 1e-8: each gains a factor of 1000


@njit(cache=True, error_model="numpy")
def _largest_eccentricity(clearances, pick, q):  # type: ignore[no-untyped-def]
    largest = 0.0
    for f in range(clearances.shape[0]):
        x, y = 0.0, 0.0
        for i in range(q.shape[0]):
            x += pick[2 * f, i] * q[i]
            y += pick[2 * f + 1, i] * q[i]
        largest = max(largest, norm(x, y) / clearances[f])
    return largest


@njit(cache=True, error_model="numpy")
def advance(rotor, films, tableau, control, state, budget, out_q, out_v, out_oil):  # type: ignore[no-untyped-def]
    """Advance the state until the output buffers are full, `budget` steps are done, or the run ends.

    out_q, out_v: (rows, n) buffers for displacements and velocities at the output times; there must be two rows more
    than one step can write; out_oil: (rows, films) for the oil fraction of films with cells. Returns (status,
    rows written). The course of
    the steps does not depend on how often this is called.
    """
    # The parts of the tuples are taken out once: to pass a tuple on costs more than a stage does.
    numbers, q, v, a, past_now = state.numbers, state.q, state.v, state.a, state.past
    wet, flows, work = state.wet, state.flows, make_work(films, state.wet, tableau.times.shape[0])
    spins, turning, grids = rotor.spins, rotor.turning, work.grids
    times, speeds, angles = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    clearances, observed, gyroscopic = rotor.clearances, rotor.observed, rotor.has_gyroscopic
    weights, moments, defect, three = tableau.stage, tableau.times, tableau.defect, tableau.guess
    tolerance, contact_at, contact_stiffness = (
        control.tolerance, control.contact_eccentricity, control.contact_stiffness)
    linearised = control.linearised
    n, m, stages = q.shape[0], 2 * clearances.shape[0], moments.shape[0]
    gamma, last, order = weights[1, 1], stages - 1, float(tableau.error_order)
    # Under elastic contact the shell gives way; without, a journal beyond the shell is no state at all.
    limit = ELASTIC_LIMIT if contact_stiffness > 0.0 else 1.0

    pick = np.empty((m, n))
    for k in range(m):
        pick[k] = rotor.journals[k // 2, k % 2]
    products, loads = np.zeros((3, n, n)), np.zeros((3, n))
    spread, compliance, newton = np.zeros((n, m)), np.zeros((m, m)), np.zeros((m, m))
    at, film = np.zeros((STAGE_ROWS, n)), np.zeros((JOURNAL_ROWS, m))
    stage_v, stage_a = np.zeros((n, stages)), np.zeros((n, stages))
    past, q_new = np.zeros((HISTORY + stages - 1, 1 + m)), np.zeros(n)
    bodies, angles_now, torque = np.zeros(1 + spins.shape[0]), np.zeros(1 + spins.shape[0]), np.zeros(spins.shape[0])
    has_cells = wet.shape[1] > 0
    inverse_g, inverse_speed = numbers[INVERSE_G], numbers[INVERSE_SPEED]
    if inverse_g > 0.0:
        prepare(rotor, pick, inverse_g, inverse_speed, products, loads, spread, compliance)
    written, done = 0, 0

    while done < budget:
        t, piece = numbers[TIME], int(numbers[PIECE])
        if t >= times[piece + 1] and piece + 2 < times.shape[0]:
            piece += 1
            numbers[PIECE] = piece
        if t >= times[-1]:
            return FINISHED, written
        acceleration, speed, angle = rotation(times, speeds, angles, piece, t)
        h, step = step_to_take(
            numbers[STEP], numbers[STEP_BEFORE], times[piece + 1] - t, speed, control.steps_per_revolution,
            control.longest_step)
        if written + int(step / control.output_step) + 2 > out_q.shape[0]:
            return RUNNING, written

        for k in range(HISTORY):
            for i in range(1 + m):
                past[k, i] = past_now[k, i]
        for i in range(n):
            stage_v[i, 0], stage_a[i, 0] = v[i], a[i]
        g, solved = gamma * step, True
        for s in range(1, stages):
            t_s = t + moments[s] * step
            acceleration, speed, angle = rotation(times, speeds, angles, piece, t_s)
            if g != inverse_g or (gyroscopic and abs(speed - inverse_speed) > INVERSE_LASTS * abs(speed)):
                inverse_g, inverse_speed = g, speed
                numbers[INVERSE_G], numbers[INVERSE_SPEED] = g, speed
                prepare(rotor, pick, g, speed, products, loads, spread, compliance)
            start_stage(weights, s, step, g, q, v, stage_v, stage_a, products, loads, pick, acceleration, speed, angle,
                         gyroscopic, at, film)
            guess(past, three, s, pick, q, clearances, g, t_s, limit, film)
            bodies[0], angles_now[0] = speed, angle
            for r in range(spins.shape[0]):  # a ring goes on as it did in the stage before
                i = spins[r]
                bodies[1 + r] = at[V, i] + g * stage_a[i, s - 1]
                angles_now[1 + r] = at[Q, i] + g * bodies[1 + r]
            set_speeds(turning, bodies, angles_now, film, grids)
            begin_stage(films, work, wet, flows, weights, s, step, g, moments[s] * step / numbers[STEP_DONE],
                        moments[s] / moments[s - 1] if s > 1 else 1.0)
            lag = g * (speed - inverse_speed) if gyroscopic else 0.0
            if lag != 0.0:  # begin with the acceleration of the stage before
                for i in range(n):
                    at[LATE, i] = at[FREE, i]
            solved = False
            for iteration in range(CELL_LIMIT if has_cells else NEWTON_LIMIT):
                forces(films, work, clearances, contact_at, contact_stiffness, g, s, iteration, film)
                numbers[SOLVES] += m // 2
                share, left, moved, unsettled = correct(films, work, compliance, clearances, g, limit, film, newton)
                if left == math.inf:
                    break
                if has_cells:  # a film with cells has kinks: no guess at what is left, but the balances themselves
                    left = math.inf if unsettled > 0 else moved
                if share == 1.0:
                    accelerate(s, g, lag, products, spread, pick, at, film, stage_v, stage_a)
                    if spins.shape[0] > 0:
                        turned = spin_up(
                            films, work, rotor, s, g, clearances, at, film, bodies, angles_now, torque,
                            stage_v, stage_a)
                        left = max(left, turned)
                        set_speeds(turning, bodies, angles_now, film, grids)
                    if (linearised or left < NEWTON_SHARE * tolerance) and (lag == 0.0 or iteration >= LAG_SWEEPS):
                        solved = True
                        break
            if not solved:
                break
            past[HISTORY + s - 1, 0] = t_s
            for i in range(m):
                past[HISTORY + s - 1, 1 + i] = film[U, i]
        error = local_error(defect, observed, stage_v, stage_a, step, g) / tolerance if solved else UNSOLVED
        if not error <= 1.0:  # not a number counts as too large
            numbers[REJECTED] += 1
            shrink = SAFETY * error ** (-1.0 / order) if math.isfinite(error) else 0.0
            numbers[STEP] = step * max(0.2, shrink)
            if numbers[STEP] < SMALLEST_STEP:
                return STUCK, written
            continue

        t_new = t + step
        if t_new >= times[piece + 1] * (1.0 - 1e-15):
            t_new = times[piece + 1]
        for i in range(n):
            total = 0.0
            for j in range(stages):
                total += weights[last, j] * stage_v[i, j]
            q_new[i] = q[i] + step * total
        before = written
        written = write_outputs(numbers, stage_v, control.output_step, t, step, t_new, q, q_new, out_q, out_v, written)
        write_oil(films, work, out_oil, before, written)
        accept_films(films, work, wet, flows, weights, step)
        numbers[STEP_DONE] = step
        for i in range(n):
            q[i], v[i], a[i] = q_new[i], stage_v[i, last], stage_a[i, last]
        for i in range(1 + m):  # the start of this step, its first stage, and its end
            past_now[0, i], past_now[1, i] = past[2, i], past[3, i]
            past_now[2, i] = past[HISTORY + last - 1, i]
        numbers[TIME] = t_new
        numbers[STEPS] += 1
        numbers[TURNS] += abs(speed) * step / (2.0 * math.pi)
        numbers[ERROR_NOW] = numbers[ERROR_NOW] * math.exp(-step / ERROR_MEMORY) + error * tolerance
        numbers[ERROR_LARGEST] = max(numbers[ERROR_LARGEST], numbers[ERROR_NOW])
        largest = _largest_eccentricity(clearances, pick, q)
        numbers[LARGEST_EPS] = max(numbers[LARGEST_EPS], largest)
        done += 1
        if contact_stiffness == 0.0 and largest >= contact_at:
            return CONTACT, written
        numbers[STEP] = step_after(h, error, numbers[ERROR_BEFORE], order)
        numbers[ERROR_BEFORE] = error
        numbers[STEP_BEFORE] = h
    return RUNNING, written
