"""The time loop of a co-simulation (section 5.2.1): rotor and films advanced in turn, each by its own steps. Compiled.

Gauss and Seidel's sequence, the rotor being the master. In a macro step the rotor takes one step of its own with the
films' forces extrapolated by a parabola; then the films follow with as many steps as they need (micro_step.py). Nothing
is repeated once the films have moved: the method is explicit, and the macro step has to stay below what the stiffness
and the damping of the films allow.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from frbcli.rotor.excitation import rotation
from frbcli.solve.dense import solve_dense
from frbcli.solve.march import ELASTIC_LIMIT, ERROR_MEMORY, INVERSE_LASTS, LAG_SWEEPS
from frbcli.solve.micro_step import SMALLEST_STEP, films_follow, parabola
from frbcli.solve.passengers import make_work, write_oil
from frbcli.solve.ring_spin import spin_up
from frbcli.solve.stage import (
    FORCE,
    FREE,
    JOURNAL_ROWS,
    LATE,
    STAGE_ROWS,
    X_0,
    U,
    V,
    accelerate,
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
    INVERSE_G,
    INVERSE_SPEED,
    LARGEST_EPS,
    PIECE,
    REJECTED,
    RUNNING,
    STEP,
    STEP_BEFORE,
    STEPS,
    STUCK,
    TIME,
    TURNS,
)
from frbcli.solve.step import SAFETY, local_error, step_after, step_to_take, write_outputs

GROWTH = 1.25  # of a macro step at most: it cannot be taken back
SLOWEST = 100.0  # rad/s: errors of the journals' velocities count against what else drives the films, at least this


@njit(cache=True, error_model="numpy")
def _tell(pick, spins, clearances, q, v, motion):  # type: ignore[no-untyped-def]
    """motion <- what the films are told of the rotor: journals' displacements and velocities, then angles and speeds of
    the rings. Returns the largest eccentricity."""
    m, rings, largest = pick.shape[0], spins.shape[0], 0.0
    for k in range(m):
        place, rate = 0.0, 0.0
        for i in range(q.shape[0]):
            place += pick[k, i] * q[i]
            rate += pick[k, i] * v[i]
        motion[k], motion[m + k] = place, rate
    for r in range(rings):
        motion[2 * m + r], motion[2 * m + rings + r] = q[spins[r]], v[spins[r]]
    for f in range(clearances.shape[0]):
        largest = max(largest, norm(motion[2 * f], motion[2 * f + 1]) / clearances[f])
    return largest


@njit(cache=True, error_model="numpy")
def advance_in_turn(rotor, films, tableau, control, state, budget, out_q, out_v, out_oil):  # type: ignore[no-untyped-def]
    """As march.advance, for rotor and films that are solved apart; the state comes from cosimulation.in_turn.

    control.longest_step is the longest macro step. state.past: (3, 1 + 6 films + 3 rings) at the last macro times:
    time; the journals' displacements and velocities; the rings' angles and speeds; the films' forces, the rings'
    torques.
    """
    numbers, q, v, a, past = state.numbers, state.q, state.v, state.a, state.past
    wet, flows, work = state.wet, state.flows, make_work(films, state.wet, tableau.times.shape[0])
    spins, times, speeds, angles = rotor.spins, rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    clearances, observed, gyroscopic = rotor.clearances, rotor.observed, rotor.has_gyroscopic
    weights, moments, defect = tableau.stage, tableau.times, tableau.defect
    tolerance, contact_at, stiffness = control.tolerance, control.contact_eccentricity, control.contact_stiffness
    n, m, stages, rings = q.shape[0], 2 * clearances.shape[0], moments.shape[0], spins.shape[0]
    gamma, last, order, told = weights[1, 1], stages - 1, float(tableau.error_order), 2 * m + 2 * rings
    limit = ELASTIC_LIMIT if stiffness > 0.0 else 1.0

    pick, inertia, pull = np.empty((m, n)), rotor.mass.copy(), np.zeros((n, m + rings))
    for k in range(m):
        pick[k] = rotor.journals[k // 2, k % 2]
        for i in range(n):
            pull[i, k] = pick[k, i] * rotor.multiplicity[k // 2]
    for r in range(rings):
        pull[spins[r], m + r] = 1.0
    solve_dense(inertia, pull)  # what a force or a torque does to the accelerations
    products, loads = np.zeros((3, n, n)), np.zeros((3, n))
    spread, compliance = np.zeros((n, m)), np.zeros((m, m))
    at, film, unused_at = np.zeros((STAGE_ROWS, n)), np.zeros((JOURNAL_ROWS, m)), np.zeros((STAGE_ROWS, n))
    stage_v, stage_a, unused = np.zeros((n, stages)), np.zeros((n, stages)), np.zeros((n, 1))
    q_new, lagrange, three, motions = np.zeros(n), np.zeros(3), np.zeros(3), np.zeros((3, told))
    bodies, turned, torque, given = np.zeros(1 + rings), np.zeros(1 + rings), np.zeros(rings), np.zeros(m + rings)
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
        _, speed, _ = rotation(times, speeds, angles, piece, t)
        h, step = step_to_take(
            numbers[STEP], numbers[STEP_BEFORE], times[piece + 1] - t, speed, control.steps_per_revolution,
            control.longest_step)
        if written + int(step / control.output_step) + 2 > out_q.shape[0]:
            return RUNNING, written

        for i in range(n):
            stage_v[i, 0], stage_a[i, 0] = v[i], a[i]
        g = gamma * step
        for s in range(1, stages):
            t_s = t + moments[s] * step
            acceleration, speed, angle = rotation(times, speeds, angles, piece, t_s)
            if g != inverse_g or (gyroscopic and abs(speed - inverse_speed) > INVERSE_LASTS * abs(speed)):
                inverse_g, inverse_speed = g, speed
                numbers[INVERSE_G], numbers[INVERSE_SPEED] = g, speed
                prepare(rotor, pick, g, speed, products, loads, spread, compliance)
            start_stage(weights, s, step, g, q, v, stage_v, stage_a, products, loads, pick, acceleration, speed, angle,
                        gyroscopic, at, film)
            parabola(past[:, 0], t_s, lagrange)
            for k in range(m + rings):
                given[k] = 0.0
                for p in range(3):
                    given[k] += lagrange[p] * past[p, 1 + told + k]
            for k in range(m):
                film[FORCE, k] = given[k]
            lag = g * (speed - inverse_speed) if gyroscopic else 0.0
            for i in range(n):
                at[LATE, i] = at[FREE, i]
            for _ in range(1 if lag == 0.0 else 1 + LAG_SWEEPS):
                accelerate(s, g, lag, products, spread, pick, at, film, stage_v, stage_a)
            for r in range(rings):
                stage_a[spins[r], s] = given[m + r] / rotor.mass[spins[r], spins[r]]
                stage_v[spins[r], s] = at[V, spins[r]] + g * stage_a[spins[r], s]
        error = local_error(defect, observed, stage_v, stage_a, step, g) / tolerance
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

        for p in range(2):
            three[p] = past[1 + p, 0]
            for k in range(told):
                motions[p, k] = past[1 + p, 1 + k]
        three[2] = t_new
        largest = _tell(pick, spins, clearances, q_new, stage_v[:, last], motions[2])
        if not largest < limit:  # the films cannot be asked there any more
            return CONTACT if stiffness == 0.0 and math.isfinite(largest) else STUCK, written
        if not films_follow(
            films, work, wet, flows, numbers, weights, moments, defect, order, tolerance, times, speeds, angles, piece,
            rotor.turning, clearances, contact_at, stiffness, motions, three, film, bodies, turned
        ):
            return STUCK, written
        if rings > 0:  # only its torques are wanted, with the journals where they are now
            for k in range(m):
                film[X_0, k], film[U, k] = motions[2, k], 0.0
            spin_up(films, work, rotor, 0, 0.0, clearances, unused_at, film, bodies, turned, torque, unused, unused)

        before = written
        written = write_outputs(numbers, stage_v, control.output_step, t, step, t_new, q, q_new, out_q, out_v, written)
        write_oil(films, work, out_oil, before, written)
        past[0], past[1] = past[1], past[2]
        past[2, 0] = t_new
        for k in range(told):
            past[2, 1 + k] = motions[2, k]
        for k in range(m + rings):
            past[2, 1 + told + k] = film[FORCE, k] if k < m else torque[k - m]
            given[k] = past[2, 1 + told + k] - given[k]  # what the extrapolation to t_new was off by
        for i in range(n):
            q[i], v[i], a[i] = q_new[i], stage_v[i, last], stage_a[i, last]
            for k in range(m + rings):
                a[i] += pull[i, k] * given[k]
        off = 0.0
        for k in range(m):
            rate = 0.0
            for j in range(m):
                rate += compliance[k, j] * given[j]
            off = max(off, abs(rate) / clearances[k // 2])
        drift = error * tolerance + off * step
        error += off / (abs(speed) + SLOWEST) / tolerance
        numbers[TIME] = t_new
        numbers[STEPS] += 1
        numbers[TURNS] += abs(speed) * step / (2.0 * math.pi)
        numbers[ERROR_NOW] = numbers[ERROR_NOW] * math.exp(-step / ERROR_MEMORY) + drift
        numbers[ERROR_LARGEST] = max(numbers[ERROR_LARGEST], numbers[ERROR_NOW])
        numbers[LARGEST_EPS] = max(numbers[LARGEST_EPS], largest)
        done += 1
        if stiffness == 0.0 and largest >= contact_at:
            return CONTACT, written
        numbers[STEP] = min(step_after(h, error, numbers[ERROR_BEFORE], order), GROWTH * h)
        numbers[ERROR_BEFORE] = error
        numbers[STEP_BEFORE] = h
        if numbers[STEP] < SMALLEST_STEP:
            return STUCK, written
    return RUNNING, written
